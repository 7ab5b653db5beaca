#include "canopus/eds/value.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/eds/number.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

using canopen::bit_length;
using canopen::byte_length;
using canopen::DataType;
using canopen::is_signed;
using canopen::little_endian;

std::string hex_text(std::uint64_t value, unsigned digits = 1) {
  return "0x" + ascii::hex(value, static_cast<int>(digits));
}

std::uint64_t sign_extended(std::uint64_t value, unsigned bits) noexcept {
  const unsigned unused = 64 - bits;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(value << unused) >> unused);
}

std::optional<Number> number_of(const Place& place) {
  const auto number = read_number(place.item.value);
  if (number && !number->overlooked.empty()) place.note(number->overlooked);
  return number;
}

bool is_real(DataType type) noexcept { return type == DataType::real32 || type == DataType::real64; }

/// Does the number fit the integer type? A hexadecimal one is a bit pattern of the type's width.
bool fits(const Number& number, DataType type) noexcept {
  const unsigned bits = bit_length(type);
  if (!is_signed(type)) return !number.negative && (bits == 64 || number.magnitude >> bits == 0);
  if (number.hexadecimal && !number.negative) return bits == 64 || number.magnitude >> bits == 0;
  const std::uint64_t most = (std::uint64_t{1} << (bits - 1)) - (number.negative ? 0 : 1);
  return number.magnitude <= most;
}

std::optional<Value> integer_value(DataType type, const Place& place) {
  const auto number = number_of(place);
  const unsigned bits = type == DataType::boolean ? 1 : bit_length(type);
  if (!number) {
    const std::string word = folded(without_comment(place.item.value));
    if (word == "true" || word == "false") {
      place.note("true or false for 1 or 0");
      return Value{little_endian(word == "true" ? 1 : 0, byte_length(type))};
    }
    place.loss("is not a number: taken as not given");
    return std::nullopt;
  }
  Value value{{}, number->adds_node_id};
  std::uint64_t raw = number->bits();
  if (type == DataType::boolean) {
    if (raw > 1) {
      place.loss("is neither 0 nor 1: taken as 1");
      raw = 1;
    }
  } else if (!fits(*number, type)) {
    const std::uint64_t cut = bits == 64 ? raw : raw & ((std::uint64_t{1} << bits) - 1);
    const std::string message = "does not fit " + std::string(name(type)) + ": taken as " + hex_text(cut);
    place.loss(message);
    raw = cut;
  }
  value.bytes = little_endian(raw, byte_length(type));
  return value;
}

/// Decimal text is the value itself, hexadecimal its IEEE bit pattern [CiA 306].
std::optional<double> real_number(DataType type, const Place& place) {
  const std::string_view text = without_comment(place.item.value);
  if (text.size() < trim(place.item.value).size()) place.note("a comment behind the number");
  if (const auto real = read_real(text)) {
    if (text.find(',') != std::string_view::npos) place.note("a comma for the decimal point");
    return real;
  }
  const auto number = read_number(text);
  if (!number || number->adds_node_id) return std::nullopt;
  if (!number->hexadecimal) {
    const auto magnitude = static_cast<double>(number->magnitude);
    return number->negative ? -magnitude : magnitude;
  }
  if (type == DataType::real64) return std::bit_cast<double>(number->bits());
  if (number->bits() > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(number->bits())));
}

std::optional<Value> real_value(DataType type, const Place& place) {
  const auto real = real_number(type, place);
  if (!real) {
    place.loss("is neither a number nor a bit pattern: taken as not given");
    return std::nullopt;
  }
  if (type == DataType::real64) return Value{little_endian(std::bit_cast<std::uint64_t>(*real), 8)};
  if (std::isfinite(*real) && std::abs(*real) > static_cast<double>(std::numeric_limits<float>::max())) {
    place.loss("does not fit REAL32: taken as not given");
    return std::nullopt;
  }
  return Value{little_endian(std::bit_cast<std::uint32_t>(static_cast<float>(*real)), 4)};
}

std::string_view without_quotes(const Place& place) {
  std::string_view text = trim(place.item.value);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    place.note("quotes round a text");
    text = text.substr(1, text.size() - 2);
  }
  return text;
}

Value octets(const Place& place) {
  std::string_view text = without_quotes(place);
  if (ascii::has_hex_prefix(text)) text.remove_prefix(2);
  Value value;
  unsigned half = 0;
  bool is_half = false;
  bool is_hex = true;
  for (const char c : text) {
    const auto digit = ascii::hex_value(c);
    if (!digit && ascii::is_blank(c) && !is_half) continue;
    is_hex = digit.has_value();
    if (!is_hex) break;
    if (is_half) value.bytes.push_back(static_cast<std::uint8_t>(half << 4 | *digit));
    half = *digit;
    is_half = !is_half;
  }
  if (is_hex && is_half && value.bytes.empty()) {  // a single digit
    value.bytes.push_back(static_cast<std::uint8_t>(half));
  } else if (!is_hex || is_half) {
    place.note("octets that are not pairs of hexadecimal digits, taken as text");
    value.bytes = canopen::text(without_quotes(place));
  }
  return value;
}

Value utf16_text(const Place& place) {
  const std::string text = to_utf8(without_quotes(place));
  Value value;
  const auto push = [&](std::uint32_t unit) { can::append_value(value.bytes, unit, 2); };
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    std::uint32_t code = length == 1 ? first : first & (0x7FU >> length);
    for (std::size_t k = 1; k < length; ++k)
      code = code << 6 | (static_cast<unsigned char>(text[i + k]) & 0x3F);
    if (code >= 0x10000) {
      push(0xD800 + ((code - 0x10000) >> 10));
      push(0xDC00 + ((code - 0x10000) & 0x3FF));
    } else {
      push(code);
    }
    i += length;
  }
  return value;
}

/// "days milliseconds", or one 48-bit number.
std::optional<Value> time_value(const Place& place) {
  const std::string_view text = without_comment(place.item.value);
  const std::size_t blank = text.find_first_of(" \t");
  if (blank != std::string_view::npos) {
    const auto days = read_number(text.substr(0, blank));
    const auto milliseconds = read_number(text.substr(blank + 1));
    if (days && milliseconds && days->bits() <= 0xFFFF && milliseconds->bits() <= 0x0FFFFFFF) {
      return Value{little_endian(days->bits() << 32 | milliseconds->bits(), 6)};
    }
  } else if (const auto number = read_number(text); number && number->bits() >> 48 == 0) {
    return Value{little_endian(number->bits(), 6)};
  }
  place.loss("is not \"days milliseconds\": taken as not given");
  return std::nullopt;
}

}  // namespace

std::string Place::quoted() const {
  return item.key + '=' + printable(item.value) + " of " + object_text(index, sub);
}

void Place::report(Problem::Severity severity, std::string_view message) const {
  problems.report(severity, item.line, quoted() + ' ' + std::string(message), item.column);
}

void Place::note(std::string_view kind) const {
  problems.repeated(Problem::Severity::note, std::string(kind), item.line,
                    quoted() + ": " + std::string(kind), item.column);
}

std::optional<Value> read_value(DataType type, const Place& place) {
  switch (type) {
    case DataType::visible_string: return Value{canopen::text(without_quotes(place))};
    case DataType::octet_string:
    case DataType::domain: return octets(place);
    case DataType::unicode_string: return utf16_text(place);
    case DataType::time_of_day:
    case DataType::time_difference: return time_value(place);
    case DataType::real32:
    case DataType::real64: return real_value(type, place);
    default: return integer_value(type, place);
  }
}

std::optional<std::string> value_text(DataType type, std::span<const std::uint8_t> bytes, bool adds_node_id) {
  if (const unsigned length = byte_length(type); length != 0) {
    const std::uint64_t value = can::load_value(bytes.first(std::min<std::size_t>(bytes.size(), length)));
    const bool is_short = value == 0 || (value < 10 && !is_real(type));
    const std::string text = is_short ? std::to_string(value) : hex_text(value, 2 * length);
    return adds_node_id ? "$NODEID+" + text : text;
  }
  std::string text;
  if (type == DataType::unicode_string) {
    text = from_utf16({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, false);  // NOLINT
    if (bytes.size() % 2 != 0 || text.find("\xEF\xBF\xBD") != std::string::npos) return std::nullopt;
  } else if (type == DataType::visible_string) {
    text.assign(bytes.begin(), bytes.end());
  } else {
    for (const std::uint8_t byte : bytes) text += hex_text(byte, 2).substr(2);
    return text;
  }
  const bool is_quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return is_quoted || trim(text) != text ? '"' + text + '"' : text;
}

std::string limit_text(DataType type, std::uint64_t limit) {
  if (is_real(type)) {
    std::array<char, 32> digits{};
    const auto end =
        std::to_chars(digits.data(), digits.data() + digits.size(), std::bit_cast<double>(limit)).ptr;
    return {digits.data(), end};
  }
  if (is_signed(type)) return std::to_string(static_cast<std::int64_t>(limit));
  return limit < 10 ? std::to_string(limit) : hex_text(limit, 2 * byte_length(type));
}

bool is_number(DataType type) noexcept {
  return bit_length(type) != 0 && type != DataType::time_of_day && type != DataType::time_difference;
}

std::optional<std::uint64_t> read_limit(DataType type, const Place& place) {
  if (!is_number(type) || type == DataType::boolean) return std::nullopt;
  if (is_real(type)) {
    if (const auto real = real_number(type, place); real && !std::isnan(*real)) {
      return std::bit_cast<std::uint64_t>(*real);
    }
    place.loss("is neither a number nor a bit pattern: no limit");
    return std::nullopt;
  }
  const auto number = number_of(place);
  if (!number) {
    place.loss("is not a number: no limit");
    return std::nullopt;
  }
  if (number->adds_node_id) {
    place.loss("depends on the node-ID: no limit");
    return std::nullopt;
  }
  if (!fits(*number, type)) {
    // A highest value above all of the type, or a lowest one below them, would keep nothing out.
    const bool is_without_effect = (place.item.folded_key == "lowlimit") == number->negative;
    place.report(is_without_effect ? Problem::Severity::warning : Problem::Severity::loss,
                 "is outside " + std::string(name(type)) + ": no limit");
    return std::nullopt;
  }
  return is_signed(type) ? sign_extended(number->bits(), bit_length(type)) : number->bits();
}

std::optional<std::uint64_t> read_unsigned(const Section& section, const Item& item, std::uint64_t highest,
                                           Problems& problems, Problem::Severity severity) {
  const auto number = read_number(item.value);
  const std::string shown = item.key + '=' + printable(item.value) + " in [" + section.name + ']';
  if (!number || number->negative || number->adds_node_id || number->magnitude > highest) {
    problems.report(severity, item.line,
                    shown + (number ? " is outside 0.." + std::to_string(highest) : " is not a number") +
                        ": taken as not given",
                    item.column);
    return std::nullopt;
  }
  if (!number->overlooked.empty()) {
    problems.repeated(Problem::Severity::note, std::string(number->overlooked), item.line,
                      shown + ": " + std::string(number->overlooked), item.column);
  }
  return number->magnitude;
}

Range range(DataType type) noexcept {
  const unsigned bits = bit_length(type);
  if (is_signed(type)) {
    const std::uint64_t half = std::uint64_t{1} << (bits - 1);
    return {sign_extended(half, bits), half - 1};
  }
  return {0, bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1};
}

bool less(DataType type, std::uint64_t a, std::uint64_t b) noexcept {
  if (is_real(type)) return std::bit_cast<double>(a) < std::bit_cast<double>(b);
  if (is_signed(type)) return static_cast<std::int64_t>(a) < static_cast<std::int64_t>(b);
  return a < b;
}

std::uint64_t pattern(DataType type, const std::vector<std::uint8_t>& bytes) noexcept {
  const std::uint64_t raw = can::load_value(bytes);
  if (type == DataType::real32) {
    return std::bit_cast<std::uint64_t>(
        static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw))));
  }
  return is_signed(type) ? sign_extended(raw, bit_length(type)) : raw;
}

}  // namespace canopus::eds
