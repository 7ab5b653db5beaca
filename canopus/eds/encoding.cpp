#include "canopus/eds/encoding.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <type_traits>

#include <iconv.h>

#include "canopus/ascii/words.hpp"

namespace canopus::eds {
namespace {

constexpr Encoding utf16_little{"UTF-16LE", "\xFF\xFE"};
constexpr Encoding utf16_big{"UTF-16BE", "\xFE\xFF"};
constexpr std::string_view windows_latin_name = "Windows Latin";

/// The names of XML, in lower case, and those of the C library.
struct Name {
  std::string_view of_xml;
  std::string_view of_library;
};
constexpr Name names[] = {
    {"gb2312", "GB18030"},
    {"gbk", "GB18030"},
    {"gb18030", "GB18030"},
    {"shift_jis", "CP932"},
    {"shift-jis", "CP932"},
    {"windows-31j", "CP932"},
    {"cp932", "CP932"},
    {"euc-jp", "EUC-JP"},
    {"big5", "BIG5"},
    {"euc-kr", "CP949"},
    {"ks_c_5601-1987", "CP949"},
    {"windows-1250", "CP1250"},
    {"windows-1251", "CP1251"},
    {"windows-1253", "CP1253"},
    {"windows-1254", "CP1254"},
    {"iso-8859-2", "ISO-8859-2"},
    {"iso-8859-5", "ISO-8859-5"},
    {"iso-8859-9", "ISO-8859-9"},
    {"iso-8859-7", "ISO-8859-7"},
    {"iso-8859-13", "ISO-8859-13"},
    {"windows-1257", "CP1257"},
    {"koi8-r", "KOI8-R"},
    {"us-ascii", windows_latin_name},
    {"windows-1252", windows_latin_name},
    {"iso-8859-1", windows_latin_name},
    {"iso-8859-15", windows_latin_name},
};

/// Converts the whole text, or nothing.
std::optional<std::string> converted(std::string_view text, std::string_view to, std::string_view from) {
  const std::string to_name(to);
  const std::string from_name(from);
  const iconv_t opened = iconv_open(to_name.c_str(), from_name.c_str());
  if (opened == reinterpret_cast<iconv_t>(-1)) return std::nullopt;  // NOLINT
  const std::unique_ptr<std::remove_pointer_t<iconv_t>, int (*)(iconv_t)> converter(opened, iconv_close);
  std::string input(text);
  std::string output;
  char* in = input.data();
  std::size_t in_left = input.size();
  while (true) {
    std::array<char, 4096> piece{};
    char* out = piece.data();
    std::size_t out_left = piece.size();
    const std::size_t irreversible = iconv(converter.get(), &in, &in_left, &out, &out_left);
    const int error = errno;
    output.append(piece.data(), piece.size() - out_left);
    const bool is_failed = irreversible == static_cast<std::size_t>(-1);
    if (!is_failed)
      return irreversible == 0 && in_left == 0 ? std::optional(std::move(output)) : std::nullopt;
    if (error != E2BIG) return std::nullopt;
  }
}

unsigned byte(std::string_view text, std::size_t i) noexcept { return static_cast<unsigned char>(text[i]); }

/// How many letters of two bytes a text has in an encoding, and how many of them are usual ones.
struct Letters {
  std::size_t all = 0;
  std::size_t usual = 0;

  [[nodiscard]] bool are_usual() const noexcept { return all >= 2 && usual * 10 >= all * 9; }
};

/// The most usual letters and the signs of GB 2312; all other letters of GB18030 are rare in device files.
Letters letters_of_gb(std::string_view text) noexcept {
  Letters letters;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    const unsigned first = byte(text, i);
    if (first < 0x80) continue;
    const unsigned second = byte(text, ++i);
    ++letters.all;
    const bool is_usual = (first >= 0xB0 && first <= 0xD7) || (first >= 0xA1 && first <= 0xA3);
    letters.usual += is_usual && second >= 0xA1 && second <= 0xFE ? 1 : 0;
  }
  return letters;
}

/// Signs, kana and the most usual kanji of JIS X 0208. Half-width kana are single bytes, and not counted as usual.
Letters letters_of_jis(std::string_view text) noexcept {
  Letters letters;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const unsigned first = byte(text, i);
    if (first < 0x80) continue;
    ++letters.all;
    if (first >= 0xA0 && first <= 0xDF) continue;
    if (++i >= text.size()) break;
    const unsigned second = byte(text, i);
    const bool is_usual = (first >= 0x81 && first <= 0x83) || (first >= 0x88 && first <= 0x97);
    letters.usual += is_usual && second >= 0x40 ? 1 : 0;
  }
  return letters;
}

// 80H to 9FH of CP1252; 0: no letter.
constexpr std::array<std::uint16_t, 32> windows_latin = {
    0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017D, 0,      0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
    0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};

}  // namespace

std::optional<Encoding> find_encoding(std::string_view bytes) {
  for (const Encoding& encoding : {utf16_little, utf16_big}) {
    if (bytes.starts_with(encoding.mark)) return encoding;
  }
  for (const auto& [name, letters] :
       {std::pair{"GB18030", letters_of_gb(bytes)}, std::pair{"CP932", letters_of_jis(bytes)}}) {
    const Encoding guess{name, {}, true};
    if (letters.are_usual() && decode(bytes, guess)) return guess;
  }
  return std::nullopt;
}

std::optional<Encoding> encoding_of_name(std::string_view name) {
  const auto* const known = std::ranges::find(names, ascii::lower(name), &Name::of_xml);
  return known == std::end(names) ? std::nullopt : std::optional(Encoding{known->of_library, {}});
}

std::optional<std::string> decode(std::string_view bytes, const Encoding& encoding) {
  if (encoding.name == windows_latin_name) return from_latin(bytes);
  auto text = converted(bytes.substr(encoding.mark.size()), "UTF-8", encoding.name);
  return text && encode(*text, encoding) == bytes ? std::move(text) : std::nullopt;
}

std::optional<std::string> encode(std::string_view text, const Encoding& encoding) {
  if (encoding.name == windows_latin_name) return to_latin(text);
  auto bytes = converted(text, encoding.name, "UTF-8");
  return bytes ? std::optional(std::string(encoding.mark) + *bytes) : std::nullopt;
}

std::string from_latin(std::string_view bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const unsigned code = byte(bytes, i);
    const unsigned letter =
        code >= 0x80 && code < 0xA0 && windows_latin[code - 0x80] != 0 ? windows_latin[code - 0x80] : code;
    if (letter < 0x80) {
      text += static_cast<char>(letter);
    } else if (letter < 0x800) {
      text += static_cast<char>(0xC0 | letter >> 6);
      text += static_cast<char>(0x80 | (letter & 0x3F));
    } else {
      text += static_cast<char>(0xE0 | letter >> 12);
      text += static_cast<char>(0x80 | (letter >> 6 & 0x3F));
      text += static_cast<char>(0x80 | (letter & 0x3F));
    }
  }
  return text;
}

std::optional<std::string> to_latin(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size();) {
    const unsigned first = byte(text, i);
    const std::size_t length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    if (i + length > text.size()) return std::nullopt;
    unsigned letter = length == 1 ? first : first & (0x7FU >> length);
    for (std::size_t k = 1; k < length; ++k) letter = letter << 6 | (byte(text, i + k) & 0x3F);
    i += length;
    const auto* const special = std::ranges::find(windows_latin, letter);
    const bool is_special = letter >= 0x100 && special != windows_latin.end();
    if (is_special) letter = 0x80 + static_cast<unsigned>(special - windows_latin.begin());
    if (letter > 0xFF) return std::nullopt;
    bytes += static_cast<char>(letter);
  }
  return bytes;
}

}  // namespace canopus::eds
