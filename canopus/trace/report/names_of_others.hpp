#pragma once
// Names from device files and plant files made fit for files of other programs.

#include <cstddef>
#include <set>
#include <string>
#include <string_view>

namespace canopus::trace {

/// The text as UTF-8 without what is no text: each octet that is none, and each control character, is a '?'.
[[nodiscard]] std::string plain_text(std::string_view text);
/// The beginning of a text, at most this number of characters.
[[nodiscard]] std::string clipped_text(std::string_view text, std::size_t characters);
/// plain_text() for XML.
[[nodiscard]] std::string xml_text(std::string_view text);
/// plain_text() as a string of Lua, with its quotes.
[[nodiscard]] std::string lua_string(std::string_view text);
/// plain_text() as a string of a DBC file, with its quotes: printable ASCII alone.
[[nodiscard]] std::string dbc_string(std::string_view text);

/// Makes identifiers of C: letters, digits and underlines, 32 characters at most, none of them twice.
class Identifiers {
 public:
  /// `otherwise`: when nothing is left of the text. Keywords of DBC are not given.
  [[nodiscard]] std::string make(std::string_view text, std::string_view otherwise);

 private:
  std::set<std::string> used_;
};

}  // namespace canopus::trace
