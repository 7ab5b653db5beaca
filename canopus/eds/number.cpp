#include "canopus/eds/number.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

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
std::optional<Number> small_number(std::string_view text) noexcept {
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

bool is_plain_number(std::string_view text) noexcept {
  return !text.empty() &&
         std::ranges::all_of(text, [](char c) { return ascii::is_letter(c) || ascii::is_digit(c); });
}

/// A sum of terms, each a product of factors, in lower case and without blanks. It has a value for every node-ID: a
/// number, to which the node-ID is added once or not at all.
class Formula {
 public:
  explicit Formula(std::string_view text) : rest_(text) {}

  std::optional<Number> read() {
    const auto value = sum(0);
    if (!value || !rest_.empty() || value->node_ids < 0 || value->node_ids > 1) return std::nullopt;
    // A number alone is read above: 12-10-2024 and 1-2 are none, and no formula either.
    if (!has_prefix_ && value->node_ids == 0) return std::nullopt;
    Number number = value->number;
    number.negative = number.negative && number.magnitude != 0;
    number.hexadecimal = has_hexadecimal_;
    number.adds_node_id = value->node_ids == 1;
    number.overlooked = overlooked_;
    return number;
  }

 private:
  struct Value {
    Number number;
    int node_ids = 0;  // how often the node-ID is added
  };
  static constexpr int most_levels = 8;    // of parentheses; files have none or one
  static constexpr int most_node_ids = 9;  // in between; 1 at the end

  static std::optional<Value> added(const Value& a, const Value& b) {
    Value total{{}, a.node_ids + b.node_ids};
    if (std::abs(total.node_ids) > most_node_ids) return std::nullopt;
    if (a.number.negative == b.number.negative) {
      total.number.negative = a.number.negative;
      if (__builtin_add_overflow(a.number.magnitude, b.number.magnitude, &total.number.magnitude))
        return std::nullopt;
      return total;
    }
    const bool is_a_larger = a.number.magnitude >= b.number.magnitude;
    total.number.negative = is_a_larger ? a.number.negative : b.number.negative;
    total.number.magnitude =
        is_a_larger ? a.number.magnitude - b.number.magnitude : b.number.magnitude - a.number.magnitude;
    return total;
  }

  static std::optional<Value> multiplied(const Value& a, const Value& b) {
    if (a.node_ids != 0 && b.node_ids != 0) return std::nullopt;
    const Value& constant = a.node_ids == 0 ? a : b;
    const Value& other = a.node_ids == 0 ? b : a;
    if (other.node_ids != 0 && constant.number.magnitude > most_node_ids) return std::nullopt;
    Value product;
    product.number.negative = a.number.negative != b.number.negative;
    if (__builtin_mul_overflow(a.number.magnitude, b.number.magnitude, &product.number.magnitude))
      return std::nullopt;
    const int times = other.node_ids == 0 ? 0 : static_cast<int>(constant.number.magnitude);
    product.node_ids = other.node_ids * (constant.number.negative ? -times : times);
    return product;
  }

  static Value negated(Value value) {
    value.number.negative = !value.number.negative;
    value.node_ids = -value.node_ids;
    return value;
  }

  bool skip(char c) {
    if (!rest_.starts_with(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }

  std::optional<Value> sum(int level) {
    std::optional<Value> total = Value{};
    bool is_first = true;
    while (total) {
      const bool is_negative = skip('-');
      if (!is_negative && !skip('+') && !is_first) break;
      is_first = false;
      const auto next = product(level);
      if (!next) return std::nullopt;
      total = added(*total, is_negative ? negated(*next) : *next);
    }
    return total;
  }

  std::optional<Value> product(int level) {
    std::optional<Value> total = factor(level);
    while (total && skip('*')) {
      const auto next = factor(level);
      total = next ? multiplied(*total, *next) : std::nullopt;
    }
    return total;
  }

  std::optional<Value> factor(int level) {
    if (skip('(')) {
      const auto inner = level < most_levels ? sum(level + 1) : std::nullopt;
      return skip(')') ? inner : std::nullopt;
    }
    for (const std::string_view spelling : {"$nodeid", "$node_id", "$node-id", "nodeid"}) {
      if (!rest_.starts_with(spelling)) continue;
      rest_.remove_prefix(spelling.size());
      return Value{{}, 1};
    }
    const std::size_t end = std::min(rest_.find_first_of("+-*()$"), rest_.size());
    const auto number = unsigned_number(rest_.substr(0, end));
    if (!number) return std::nullopt;
    has_prefix_ = has_prefix_ || rest_.starts_with("0x");
    has_hexadecimal_ = has_hexadecimal_ || number->hexadecimal;
    if (overlooked_.empty()) overlooked_ = number->overlooked;
    rest_.remove_prefix(end);
    return Value{*number, 0};
  }

  std::string_view rest_;
  bool has_prefix_ = false;  // one of the numbers begins with 0x
  bool has_hexadecimal_ = false;
  std::string_view overlooked_;  // of the first number that has it
};

}  // namespace

std::string_view without_comment(std::string_view text) noexcept {
  return trim(text.substr(0, text.find(';')));
}

std::optional<Number> read_number(std::string_view text) {
  if (const auto usual = small_number(text)) return usual;
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

  auto number = signed_number(word);
  if (!number) {
    number = Formula(word).read();
    if (!number) return std::nullopt;
    const bool is_exact =
        bare == "$NODEID" || (bare.starts_with("$NODEID+") && is_plain_number(bare.substr(8)));
    if (!number->adds_node_id) {
      overlooked = "a formula where a number belongs";
    } else if (!is_exact) {
      overlooked = "not written as $NODEID+number";
    }
  }
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
