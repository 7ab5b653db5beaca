#pragma once
// Device files that are not UTF-8: the encoding that a file names, or that its bytes look like.

#include <optional>
#include <string>
#include <string_view>

namespace canopus::eds {

/// An encoding by its name in the C library, or Windows Latin; texts are converted there and back without a difference, or not at all.
struct Encoding {
  std::string_view name;  ///< "UTF-16LE", "GB18030", "CP932" ...
  std::string_view mark;  ///< bytes before the text that tell it; empty: none
  bool is_guess = false;  ///< from the bytes
};

/// Of a text that is read in another way than line by line as UTF-8 or Windows Latin: one with a mark of UTF-16, or with
/// Chinese (GB18030) or Japanese (CP932, also called Windows-31J, Shift JIS) letters. Of a guess at least 9 of 10
/// letters are usual ones. Nothing: any other text.
[[nodiscard]] std::optional<Encoding> find_encoding(std::string_view bytes);

/// The one that an XML declaration names, such as "gb2312" or "Windows-1252", in any case; nothing: none that is read
/// here. ISO 8859-1 and -15 are read as Windows Latin.
[[nodiscard]] std::optional<Encoding> encoding_of_name(std::string_view name);

/// The text as UTF-8, without the mark. Nothing: it is not in this encoding, or this machine does not have it.
[[nodiscard]] std::optional<std::string> decode(std::string_view bytes, const Encoding& encoding);
/// UTF-8 text in this encoding, with the mark. Nothing: the encoding lacks a letter of it.
[[nodiscard]] std::optional<std::string> encode(std::string_view text, const Encoding& encoding);

/// Bytes of Windows Latin (CP1252) as UTF-8; what it has no letter for is a control character of ISO 8859-1.
[[nodiscard]] std::string from_latin(std::string_view bytes);
/// UTF-8 text as Windows Latin; nothing: it lacks a letter of it.
[[nodiscard]] std::optional<std::string> to_latin(std::string_view text);

}  // namespace canopus::eds
