#pragma once
// An XDD or XDC [CiA 311] as the equivalent sections and keys of CiA 306: one reader, and one set of checks,
// for both kinds of device files.

#include <optional>
#include <string>
#include <string_view>

#include "canopus/eds/encoding.hpp"
#include "canopus/eds/ini.hpp"

namespace canopus::eds {

/// True when a text begins like XML: with '<', behind blanks and a byte order mark.
[[nodiscard]] bool is_xml(std::string_view text) noexcept;

/// The text of an XML file as UTF-8.
struct XmlText {
  std::string text;
  std::optional<Encoding> encoding{};  ///< that the XML declaration names; nothing: UTF-8, or UTF-16
};
/// UTF-16 and what the XML declaration names are converted, with a note. Nothing, after an error, when it is neither.
[[nodiscard]] std::optional<XmlText> xml_text(std::string_view text, Problems& problems);

/// The number of an index or subIndex attribute: hexadecimal with or without 0x, at most `highest`. Zeros before it do
/// not count: CANopenEditor writes sub-indexes with four digits.
[[nodiscard]] std::optional<unsigned> read_hexadecimal(std::string_view text, unsigned highest);

/// The sections, their keys called as in the file, with the places they have in it. What an object has no attribute
/// for comes from the parameter that its uniqueIDRef names. Nothing, after an error, when this is no CANopen device's.
[[nodiscard]] std::optional<IniFile> read_xdd(std::string_view text, Problems& problems);

}  // namespace canopus::eds
