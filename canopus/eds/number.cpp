#include "canopus/eds/number.hpp"

#include <algorithm>
#include <cmath>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

using ascii::parse_number;

/// A number without sign and blanks, in lower case.
std::optional<Number> unsigned_number(std::string_view text) {
  Number number;
  if (text.starts_with("0x")) {
    const auto value = parse_number<std::uint64_t>(text.substr(2), 16);
    if (!value) return std::nullopt;
    number.magnitude = *value;
    number.hexadecimal = true;
    return number;
  }
  if (std::ranges::all_of(text, ascii::is_digit)) {
    const bool is_octal =
        text.size() > 1 && text.front() == '0' && text.find_first_of("89") == std::string_view::npos;
    const auto value = parse_number<std::uint64_t>(text, is_octal ? 8 : 10);
    if (!value) return std::nullopt;
    number.magnitude = *value;
    if (is_octal && *value > 7) number.overlooked = "a leading 0 makes it octal";
    return number;
  }
  if (const std::size_t end = text.find_last_not_of("ul");
      end != std::string_view::npos && end + 1 < text.size() && end + 4 > text.size()) {
    if (const auto value = parse_number<std::uint64_t>(text.substr(0, end + 1))) {
      number.magnitude = *value;
      number.overlooked = "letters behind the number";
      return number;
    }
  }
  std::string_view hex = text;
  if (hex.ends_with('h')) hex.remove_suffix(1);
  if (ascii::is_hex(hex)) {
    const auto value = parse_number<std::uint64_t>(hex, 16);
    if (!value) return std::nullopt;
    number.magnitude = *value;
    number.hexadecimal = true;
    number.overlooked = "hexadecimal without 0x";
    return number;
  }
  if (const auto real = read_real(text); real && std::isfinite(*real) && *real >= 0 && *real < 1e19) {
    number.magnitude = static_cast<std::uint64_t>(std::llround(std::min(*real, 9e18)));
    number.overlooked = "a fraction where a whole number belongs";
    return number;
  }
  return std::nullopt;
}

std::optional<Number> signed_number(std::string_view text) {
  bool negative = false;
  if (text.starts_with('-') || text.starts_with('+')) {
    negative = text.front() == '-';
    text.remove_prefix(1);
  }
  auto number = unsigned_number(text);
  if (number) number->negative = negative && number->magnitude != 0;
  return number;
}

/// A number as nearly all are written: 1..16 digits behind 0x, or 1..19 decimal ones that do not begin with
/// 0. Nothing for others, which the full parser reads.
std::optional<Number> usual_number(std::string_view text) noexcept {
  Number number;
  number.hexadecimal = text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
  if (number.hexadecimal) text.remove_prefix(2);
  if (text.empty() || text.size() > (number.hexadecimal ? 16U : 19U)) return std::nullopt;
  if (!number.hexadecimal && text.front() == '0' && text.size() > 1) return std::nullopt;
  for (const char c : text) {
    const auto digit = static_cast<unsigned char>(c - '0');
    if (!number.hexadecimal) {
      if (digit > 9) return std::nullopt;
      number.magnitude = number.magnitude * 10 + digit;
      continue;
    }
    const auto letter = static_cast<unsigned char>((c | 0x20) - 'a');
    if (digit > 9 && letter > 5) return std::nullopt;
    number.magnitude = number.magnitude << 4U | (digit <= 9 ? digit : letter + 10U);
  }
  return number;
}

}  // namespace

std::string_view without_comment(std::string_view text) noexcept {
  return trim(text.substr(0, text.find(';')));
}

std::optional<Number> read_number(std::string_view text) {
  if (const auto usual = usual_number(text)) return usual;
  std::string_view overlooked;
  const std::string_view bare = without_comment(text);
  if (bare.size() != trim(text).size()) overlooked = "a comment behind the number";
  std::string word = ascii::lower(bare);
  if (word.size() >= 2 && word.front() == '"' && word.back() == '"') {
    word = word.substr(1, word.size() - 2);
    overlooked = "quotes round the number";
  }
  const std::size_t length = word.size();
  std::erase_if(word, ascii::is_blank);
  if (word.size() != length) overlooked = "blanks inside";

  bool adds_node_id = false;
  for (const std::string_view spelling : {"$nodeid", "$node_id", "$node-id", "nodeid"}) {
    const std::size_t place = word.find(spelling);
    if (place == std::string::npos) continue;
    adds_node_id = true;
    const std::string before = word.substr(0, place);
    const std::string after = word.substr(place + spelling.size());
    if (before.empty()) {
      if (!after.empty() && after.front() != '+' && after.front() != '-') return std::nullopt;
      word = after.empty() ? "0" : after;
    } else if (after.empty() && before.ends_with('+')) {
      word = before.substr(0, before.size() - 1);
    } else {
      return std::nullopt;
    }
    if (!bare.starts_with("$NODEID") || bare.find_first_of(" \t") != std::string_view::npos) {
      overlooked = "not written as $NODEID+number";
    }
    break;
  }

  auto number = signed_number(word);
  if (!number) return std::nullopt;
  number->adds_node_id = adds_node_id;
  if (!overlooked.empty()) number->overlooked = overlooked;
  return number;
}

std::optional<double> read_real(std::string_view text) {
  std::string word = ascii::lower(trim(text));
  std::ranges::replace(word, ',', '.');
  if (word.starts_with('+')) word.erase(0, 1);
  if (word.ends_with('f') && word.find('.') != std::string::npos) word.pop_back();  // 1.0f
  return parse_number<double>(word);
}

}  // namespace canopus::eds
