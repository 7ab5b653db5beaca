#include "canopus/trace/report/names_of_others.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"

namespace canopus::trace {
namespace {

constexpr std::size_t longest_identifier = 32;  // that all readers of DBC take

constexpr std::array<std::string_view, 26> dbc_keywords{
    "VERSION",     "NS_",        "BS_",          "BU_",        "BO_",       "SG_",          "VAL_TABLE_",
    "VAL_",        "CM_",        "BA_DEF_",      "BA_",        "EV_",       "ENVVAR_DATA_", "SGTYPE_",
    "BA_DEF_DEF_", "SIG_GROUP_", "SIG_VALTYPE_", "BO_TX_BU_",  "CAT_DEF_",  "CAT_",         "FILTER",
    "BA_DEF_REL_", "BA_REL_",    "BU_SG_REL_",   "BU_EV_REL_", "BU_BO_REL_"};

using ascii::is_digit;
using ascii::is_letter;

/// Length of the UTF-8 character that begins here; 0: none begins.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return 0;
  }
  // Overlong forms, surrogates, what is beyond the last character; C1; noncharacters that XML refuses.
  if (first == 0xE0 && byte(1) < 0xA0) return 0;
  if (first == 0xED && byte(1) >= 0xA0) return 0;
  if (first == 0xF0 && byte(1) < 0x90) return 0;
  if (first == 0xF4 && byte(1) >= 0x90) return 0;
  if (first == 0xC2 && byte(1) < 0xA0) return 0;
  if (first == 0xEF && byte(1) == 0xBF && byte(2) >= 0xBE) return 0;
  return length;
}

}  // namespace

std::string plain_text(std::string_view text) {
  std::string plain;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const auto first = static_cast<unsigned char>(text.front());
    if (length == 0 || first < 0x20 || first == 0x7F) {
      plain += '?';
    } else {
      plain += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return plain;
}

std::string clipped_text(std::string_view text, std::size_t characters) {
  const std::string plain = plain_text(text);
  std::string_view rest = plain;
  std::string clipped;
  for (; !rest.empty() && characters > 0; --characters) {
    const std::size_t length = std::max<std::size_t>(character_length(rest), 1);
    clipped += rest.substr(0, length);
    rest.remove_prefix(length);
  }
  return rest.empty() ? clipped : clipped + "..";
}

std::string xml_text(std::string_view text) {
  std::string result;
  for (const char c : plain_text(text)) {
    switch (c) {
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '&': result += "&amp;"; break;
      case '"': result += "&quot;"; break;
      default: result += c;
    }
  }
  return result;
}

std::string lua_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : plain_text(text)) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

std::string dbc_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : plain_text(text)) {
    const bool printable = c >= 0x20 && c < 0x7F;
    result += !printable ? '?' : c == '"' || c == '\\' ? '\'' : c;
  }
  return result + '"';
}

std::string Identifiers::make(std::string_view text, std::string_view otherwise) {
  std::string name;
  for (const char c : text) {
    if (is_letter(c) || is_digit(c)) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (name.ends_with('_')) name.pop_back();
  if (name.empty()) name = otherwise;
  if (is_digit(name.front())) name.insert(0, "_");
  name = name.substr(0, longest_identifier);
  if (std::ranges::find(dbc_keywords, name) != dbc_keywords.end()) name += '_';
  std::string unique = name;
  for (unsigned number = 2; !used_.insert(unique).second; ++number) {
    const std::string ending = fmt::format("_{}", number);
    unique = name.substr(0, longest_identifier - ending.size()) + ending;
  }
  return unique;
}

}  // namespace canopus::trace
