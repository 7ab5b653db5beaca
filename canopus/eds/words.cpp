#include "canopus/eds/words.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "canopus/ascii/words.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/eds/encoding.hpp"

namespace canopus::eds {
namespace {

using canopen::Access;
using canopen::DataType;
using canopen::ObjectCode;

constexpr bool is_blank(char c) noexcept { return ascii::is_blank(c) || c == '\v' || c == '\f' || c == '\r'; }

/// The result of folded() for a character: one, or none.
struct Folding {
  char letter = 0;
  std::uint8_t length = 1;
};
constexpr std::array<Folding, 256> foldings = [] {
  std::array<Folding, 256> all{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const char c = static_cast<char>(i);
    all[i].letter = ascii::lower(c);
    all[i].length = is_blank(c) || c == '_' || c == '-' ? 0 : 1;
  }
  return all;
}();

/// A number, as most files have it: no word.
constexpr bool begins_with_digit(std::string_view word) noexcept {
  return !word.empty() && ascii::is_digit(word.front());
}

struct TypeName {
  DataType type;
  std::string_view name;
};
constexpr TypeName type_names[] = {
    {DataType::boolean, "BOOLEAN"},
    {DataType::integer8, "INTEGER8"},
    {DataType::integer16, "INTEGER16"},
    {DataType::integer32, "INTEGER32"},
    {DataType::unsigned8, "UNSIGNED8"},
    {DataType::unsigned16, "UNSIGNED16"},
    {DataType::unsigned32, "UNSIGNED32"},
    {DataType::real32, "REAL32"},
    {DataType::visible_string, "VISIBLE_STRING"},
    {DataType::octet_string, "OCTET_STRING"},
    {DataType::unicode_string, "UNICODE_STRING"},
    {DataType::time_of_day, "TIME_OF_DAY"},
    {DataType::time_difference, "TIME_DIFFERENCE"},
    {DataType::domain, "DOMAIN"},
    {DataType::integer24, "INTEGER24"},
    {DataType::real64, "REAL64"},
    {DataType::integer40, "INTEGER40"},
    {DataType::integer48, "INTEGER48"},
    {DataType::integer56, "INTEGER56"},
    {DataType::integer64, "INTEGER64"},
    {DataType::unsigned24, "UNSIGNED24"},
    {DataType::unsigned40, "UNSIGNED40"},
    {DataType::unsigned48, "UNSIGNED48"},
    {DataType::unsigned56, "UNSIGNED56"},
    {DataType::unsigned64, "UNSIGNED64"},
};

struct CodeName {
  ObjectCode code;
  std::string_view name;
};
constexpr CodeName code_names[] = {
    {ObjectCode::null, "NULL"},
    {ObjectCode::domain, "DOMAIN"},
    {ObjectCode::type_definition, "DEFTYPE"},
    {ObjectCode::structure_definition, "DEFSTRUCT"},
    {ObjectCode::variable, "VAR"},
    {ObjectCode::array, "ARRAY"},
    {ObjectCode::record, "RECORD"},
};

struct AccessWord {
  std::string_view word;
  Access access;
  bool exact;
};
constexpr AccessWord access_words[] = {
    {"ro", Access::read_only, true},          {"wo", Access::write_only, true},
    {"rw", Access::read_write, true},         {"rwr", Access::read_write_input, true},
    {"rww", Access::read_write_output, true}, {"const", Access::constant, true},
    {"r", Access::read_only, false},          {"read", Access::read_only, false},
    {"readonly", Access::read_only, false},   {"w", Access::write_only, false},
    {"write", Access::write_only, false},     {"writeonly", Access::write_only, false},
    {"r/w", Access::read_write, false},       {"wr", Access::read_write, false},
    {"readwrite", Access::read_write, false}, {"read/write", Access::read_write, false},
    {"constant", Access::constant, false},
};

/// Eight characters of ASCII.
bool is_plain(const char* text) noexcept {
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, text, sizeof bytes);
  return (bytes & 0x8080'8080'8080'8080) == 0;
}

/// Length of the UTF-8 sequence at the start of `text`, 0 when it is none.
std::size_t utf8_length(std::string_view text) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  if ((first == 0xE0 && byte(1) < 0xA0) || (first == 0xED && byte(1) > 0x9F) ||
      (first == 0xF0 && byte(1) < 0x90) || (first == 0xF4 && byte(1) > 0x8F)) {
    return 0;
  }
  return length;
}

}  // namespace

std::string_view trim(std::string_view text) noexcept { return ascii::trim(text, is_blank); }

std::string folded(std::string_view text) {
  std::string result(text);
  std::size_t length = 0;
  for (const char c : text) {
    const Folding& folding = foldings[static_cast<unsigned char>(c)];
    result[length] = folding.letter;
    length += folding.length;
  }
  result.resize(length);
  return result;
}

bool is_misspelt(std::string_view word, std::string_view meant) {
  const std::size_t allowed = meant.size() >= 8 ? 2 : meant.size() >= 5 ? 1 : 0;
  if (allowed == 0 || word.size() + allowed < meant.size() || meant.size() + allowed < word.size())
    return false;
  // Edit distance with swaps of neighbours, three rows at a time.
  std::vector<std::size_t> before_last(meant.size() + 1);
  std::vector<std::size_t> last(meant.size() + 1);
  std::vector<std::size_t> row(meant.size() + 1);
  for (std::size_t j = 0; j <= meant.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= word.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= meant.size(); ++j) {
      const std::size_t other = word[i - 1] == meant[j - 1] ? 0 : 1;
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + other});
      if (i > 1 && j > 1 && word[i - 1] == meant[j - 2] && word[i - 2] == meant[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last[meant.size()] <= allowed;
}

std::string_view nearest(std::string_view word, std::span<const std::string_view> known) {
  for (const std::string_view candidate : known) {
    if (is_misspelt(word, candidate)) return candidate;
  }
  return {};
}

bool is_utf8(std::string_view text) noexcept {
  while (!text.empty()) {
    while (text.size() >= 8 && is_plain(text.data())) text.remove_prefix(8);
    if (text.empty()) break;
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string to_utf8(std::string_view text) { return is_utf8(text) ? std::string(text) : from_latin(text); }

std::string from_utf16(std::string_view text, bool big_endian) {
  std::string result;
  const auto unit = [&](std::size_t i) {
    const auto a = static_cast<unsigned char>(text[i]);
    const auto b = static_cast<unsigned char>(text[i + 1]);
    return static_cast<std::uint32_t>(big_endian ? a << 8 | b : b << 8 | a);
  };
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    std::uint32_t code = unit(i);
    if (code >= 0xD800 && code < 0xDC00 && i + 3 < text.size()) {
      const std::uint32_t low = unit(i + 2);
      if (low >= 0xDC00 && low < 0xE000) {
        code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
        i += 2;
      }
    }
    if (code >= 0xD800 && code < 0xE000) code = 0xFFFD;
    if (code < 0x80) {
      result += static_cast<char>(code);
    } else if (code < 0x800) {
      result += static_cast<char>(0xC0 | code >> 6);
      result += static_cast<char>(0x80 | (code & 0x3F));
    } else if (code < 0x10000) {
      result += static_cast<char>(0xE0 | code >> 12);
      result += static_cast<char>(0x80 | (code >> 6 & 0x3F));
      result += static_cast<char>(0x80 | (code & 0x3F));
    } else {
      result += static_cast<char>(0xF0 | code >> 18);
      result += static_cast<char>(0x80 | (code >> 12 & 0x3F));
      result += static_cast<char>(0x80 | (code >> 6 & 0x3F));
      result += static_cast<char>(0x80 | (code & 0x3F));
    }
  }
  return result;
}

std::string_view name(DataType type) noexcept {
  for (const TypeName& known : type_names) {
    if (known.type == type) return known.name;
  }
  return "unknown";
}

std::optional<DataType> data_type(std::string_view word) {
  if (begins_with_digit(word)) return std::nullopt;
  const std::string asked = folded(word);
  for (const TypeName& known : type_names) {
    if (asked == folded(known.name)) return known.type;
  }
  constexpr std::pair<std::string_view, std::string_view> stems[] = {
      {"uint", "UNSIGNED"}, {"u", "UNSIGNED"}, {"int", "INTEGER"}, {"i", "INTEGER"}, {"float", "REAL"}};
  for (const auto& [stem, full] : stems) {
    if (!asked.starts_with(stem)) continue;
    std::string_view bits = std::string_view(asked).substr(stem.size());
    if (bits.ends_with("t")) bits.remove_suffix(1);  // uint8_t
    for (const TypeName& known : type_names) {
      if (known.name == std::string(full) + std::string(bits)) return known.type;
    }
  }
  if (asked == "bool") return DataType::boolean;
  if (asked == "float") return DataType::real32;
  if (asked == "double") return DataType::real64;
  if (asked == "string") return DataType::visible_string;
  return std::nullopt;
}

bool is_data_type(std::uint64_t index) noexcept {
  return std::ranges::any_of(
      type_names, [&](const TypeName& known) { return static_cast<std::uint64_t>(known.type) == index; });
}

std::optional<ObjectCode> object_code(std::string_view word) {
  if (begins_with_digit(word)) return std::nullopt;
  const std::string asked = folded(word);
  for (const CodeName& known : code_names) {
    if (asked == ascii::lower(known.name)) return known.code;
  }
  if (asked == "variable") return ObjectCode::variable;
  if (asked == "struct") return ObjectCode::record;
  return std::nullopt;
}

bool is_object_code(std::uint64_t code) noexcept {
  return std::ranges::any_of(
      code_names, [&](const CodeName& known) { return static_cast<std::uint64_t>(known.code) == code; });
}

std::string_view name(ObjectCode code) noexcept {
  for (const CodeName& known : code_names) {
    if (known.code == code) return known.name;
  }
  return "unknown";
}

std::string_view name(Access access) noexcept {
  const auto* const found = std::ranges::find(access_words, access, &AccessWord::access);
  return found->word;
}

std::optional<Access> access(std::string_view word, bool& exact) {
  for (const AccessWord& known : access_words) {
    if (!known.exact) break;  // those come first
    if (word != known.word) continue;
    exact = true;
    return known.access;
  }
  const std::string asked = folded(word);
  for (const AccessWord& known : access_words) {
    if (asked != known.word) continue;
    exact = known.exact;
    return known.access;
  }
  return std::nullopt;
}

}  // namespace canopus::eds
