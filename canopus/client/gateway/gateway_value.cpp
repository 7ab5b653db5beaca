#include "canopus/client/gateway/gateway_value.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/text/base64.hpp"

namespace canopus::client {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Kind = GatewayType::Kind;

using ascii::is_blank;
using ascii::trim;

Bytes little_endian(std::uint64_t value, std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
  return bytes;
}

std::uint64_t number_of(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size() && i < 8; ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
  return value;
}

std::uint64_t most(unsigned bits) { return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1; }

std::optional<Bytes> encode_number(std::string_view text, GatewayType type) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  const auto value = gateway_number(text);
  if (!value) return std::nullopt;
  const std::size_t size = (type.bits + 7) / 8;
  if (type.kind != Kind::integer) {
    if (negative || *value > most(type.bits)) return std::nullopt;
    return little_endian(*value, size);
  }
  const std::uint64_t limit = most(type.bits - 1);
  if (*value > limit + (negative ? 1 : 0)) return std::nullopt;
  return little_endian(negative ? ~*value + 1 : *value, size);
}

std::optional<Bytes> encode_real(std::string_view text, unsigned bits) {
  const auto value = ascii::parse_number<double>(text);
  if (!value) return std::nullopt;
  if (bits == 64) return little_endian(std::bit_cast<std::uint64_t>(*value), 8);
  const auto narrow = static_cast<float>(*value);
  if (std::isinf(narrow) && !std::isinf(*value)) return std::nullopt;
  return little_endian(std::bit_cast<std::uint32_t>(narrow), 4);
}

// 28 bits ms, 4 reserved, 16 bits days [CiA 301 7.1.6.5].
std::optional<Bytes> encode_time(std::string_view text) {
  const auto days = gateway_number(next_gateway_word(text));
  const auto milliseconds = gateway_number(next_gateway_word(text));
  if (!days || !milliseconds || *days > 0xFFFF || *milliseconds > 0x0FFF'FFFF || !trim(text).empty()) {
    return std::nullopt;
  }
  return little_endian(*milliseconds | *days << 32, 6);
}

std::optional<Bytes> encode_text(std::string_view text) {
  if (!text.starts_with('"')) {
    if (std::ranges::any_of(text, is_blank)) return std::nullopt;
    return Bytes(text.begin(), text.end());
  }
  text.remove_prefix(1);
  Bytes bytes;
  while (!text.empty()) {
    const char c = text.front();
    text.remove_prefix(1);
    if (c != '"') {
      bytes.push_back(static_cast<std::uint8_t>(c));
    } else if (text.starts_with('"')) {
      bytes.push_back('"');
      text.remove_prefix(1);
    } else {
      return text.empty() ? std::optional(bytes) : std::nullopt;
    }
  }
  return std::nullopt;  // no closing quote
}

std::optional<Bytes> encode_hexadecimal(std::string_view text) {
  Bytes bytes;
  while (true) {
    text = trim(text);
    if (text.empty()) return bytes;
    const auto byte = ascii::byte_of_hex(text.substr(0, 2));
    if (!byte) return std::nullopt;
    bytes.push_back(*byte);
    text.remove_prefix(2);
  }
}

std::optional<Bytes> encode_base64(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  Bytes bytes;
  std::size_t padding = 0;
  while (!text.empty() && padding < 2 && text.ends_with('=')) {
    text.remove_suffix(1);
    ++padding;
  }
  std::uint32_t bits = 0;
  unsigned count = 0;
  for (const char c : text) {
    const std::size_t digit = text::base64_digits.find(c);
    if (digit == std::string_view::npos) return std::nullopt;
    bits = (bits << 6 | static_cast<std::uint32_t>(digit)) & 0xFFFFFF;
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count));
  }
  if (count >= 6) return std::nullopt;
  return bytes;
}

/// A line stays a line: control characters are shown as C escapes.
std::string show_text(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty() && bytes.back() == 0) bytes = bytes.first(bytes.size() - 1);
  std::string text = "\"";
  for (const std::uint8_t byte : bytes) {
    if (byte == '"') {
      text += "\"\"";
    } else if (byte < ' ' || byte == 0x7F) {
      text += fmt::format("\\x{:02x}", byte);
    } else {
      text += static_cast<char>(byte);
    }
  }
  return text + '"';
}

std::string show_integer(std::uint64_t value, unsigned bits) {
  if ((value >> (bits - 1) & 1U) == 0) return fmt::format("{}", value);
  return fmt::format("{}", static_cast<std::int64_t>(value | ~most(bits)));
}

}  // namespace

std::string_view next_gateway_word(std::string_view& line) noexcept {
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  bool quoted = false;
  std::size_t size = 0;
  while (size < line.size() && (quoted || !is_blank(line[size]))) {
    if (line[size] == '"') quoted = !quoted;
    ++size;
  }
  const std::string_view word = line.substr(0, size);
  line.remove_prefix(size);
  return word;
}

std::optional<std::uint64_t> gateway_number(std::string_view word) noexcept {
  int base = 10;
  if (ascii::has_hex_prefix(word)) {
    base = 16;
    word.remove_prefix(2);
  } else if (word.size() > 1 && word.starts_with('0')) {
    base = 8;
  }
  return ascii::parse_number<std::uint64_t>(word, base);
}

std::optional<GatewayType> parse_gateway_type(std::string_view name) noexcept {
  if (name == "b") return GatewayType{Kind::boolean, 1};
  if (name == "t" || name == "td") return GatewayType{Kind::time, 48};
  if (name == "vs") return GatewayType{Kind::text};
  if (name == "os" || name == "us" || name == "d") return GatewayType{Kind::base64};
  if (name == "hex") return GatewayType{Kind::bytes};
  if (name == "r32") return GatewayType{Kind::real, 32};
  if (name == "r64") return GatewayType{Kind::real, 64};
  if (name.empty()) return std::nullopt;
  const auto bits = gateway_number(name.substr(1));
  if (!bits || *bits == 0 || *bits > 64 || *bits % 8 != 0 || name[1] == '0') return std::nullopt;
  const auto width = static_cast<unsigned>(*bits);
  switch (name.front()) {
    case 'i': return GatewayType{Kind::integer, width};
    case 'u': return GatewayType{Kind::unsigned_integer, width};
    case 'x': return GatewayType{Kind::hexadecimal, width};
    default: return std::nullopt;
  }
}

std::optional<Bytes> encode_gateway_value(std::string_view text, GatewayType type) {
  text = trim(text);
  switch (type.kind) {
    case Kind::boolean:
    case Kind::integer:
    case Kind::unsigned_integer:
    case Kind::hexadecimal: return encode_number(text, type);
    case Kind::real: return encode_real(text, type.bits);
    case Kind::time: return encode_time(text);
    case Kind::text: return encode_text(text);
    case Kind::base64: return encode_base64(text);
    case Kind::bytes: return encode_hexadecimal(text);
  }
  return std::nullopt;
}

std::optional<std::string> show_gateway_value(std::span<const std::uint8_t> bytes, GatewayType type) {
  if (type.bits != 0 && bytes.size() != (type.bits + 7) / 8) return std::nullopt;
  const std::uint64_t value = number_of(bytes);
  switch (type.kind) {
    case Kind::boolean: return value != 0 ? "1" : "0";
    case Kind::integer: return show_integer(value, type.bits);
    case Kind::unsigned_integer: return fmt::format("{}", value);
    case Kind::hexadecimal: return fmt::format("0x{:0{}X}", value, type.bits / 4);
    case Kind::real:
      if (type.bits == 64) return fmt::format("{}", std::bit_cast<double>(value));
      return fmt::format("{}", std::bit_cast<float>(static_cast<std::uint32_t>(value)));
    case Kind::time: return fmt::format("{} {}", value >> 32, value & 0x0FFF'FFFF);
    case Kind::text: return show_text(bytes);
    case Kind::base64: return text::to_base64(bytes);
    case Kind::bytes: break;
  }
  return ascii::hex_bytes(bytes, " ");
}

}  // namespace canopus::client
