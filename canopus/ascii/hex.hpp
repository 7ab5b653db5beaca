#pragma once
// Hexadecimal digits of numbers and bytes, as text and back. Digits are capitals if nothing else is said, and are read in both cases.

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace canopus::ascii {

/// The digit of 0 to 15.
constexpr char hex_digit(unsigned value) noexcept { return "0123456789ABCDEF"[value & 0xFU]; }

/// 0 to 15; nothing if `c` is no digit.
[[nodiscard]] constexpr std::optional<unsigned> hex_value(char c) noexcept {
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0');
  if (c >= 'A' && c <= 'F') return static_cast<unsigned>(c - 'A' + 10);
  if (c >= 'a' && c <= 'f') return static_cast<unsigned>(c - 'a' + 10);
  return std::nullopt;
}

/// One digit or more, and nothing else.
[[nodiscard]] constexpr bool is_hex(std::string_view text) noexcept {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return hex_value(c).has_value(); });
}

/// Writes the lowest `digits` digits of `value`; returns where they end.
constexpr char* write_hex(char* out, std::uint64_t value, int digits) noexcept {
  while (digits-- > 0) *out++ = hex_digit(static_cast<unsigned>(value >> (4 * digits)));
  return out;
}

/// A number with at least so many digits (0 to 16), and as many as it needs.
[[nodiscard]] inline std::string hex(std::uint64_t value, int least_digits = 1) {
  int digits = least_digits;
  while (digits < 16 && value >> (4 * digits) != 0) ++digits;
  std::string text(static_cast<std::size_t>(digits), '0');
  write_hex(text.data(), value, digits);
  return text;
}
[[nodiscard]] inline std::string lower_hex(std::uint64_t value, int least_digits = 1) {
  std::string text = hex(value, least_digits);
  for (char& c : text) c = c >= 'A' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

/// Two digits for each byte: "01A0FF", with `between` = " " "01 A0 FF".
[[nodiscard]] inline std::string hex_bytes(std::span<const std::uint8_t> bytes,
                                           std::string_view between = {}) {
  std::string text;
  text.reserve(bytes.size() * (2 + between.size()));
  for (const std::uint8_t byte : bytes) {
    if (!text.empty()) text += between;
    text += hex_digit(byte >> 4U);
    text += hex_digit(byte);
  }
  return text;
}

/// The byte that two digits are; nothing if the text is anything else.
[[nodiscard]] constexpr std::optional<std::uint8_t> byte_of_hex(std::string_view two_digits) noexcept {
  if (two_digits.size() != 2) return std::nullopt;
  const auto high = hex_value(two_digits[0]);
  const auto low = hex_value(two_digits[1]);
  if (!high || !low) return std::nullopt;
  return static_cast<std::uint8_t>(*high << 4U | *low);
}

/// The bytes that pairs of digits are, with nothing between them; nothing if the text is anything else.
[[nodiscard]] inline std::optional<std::vector<std::uint8_t>> bytes_of_hex(std::string_view digits) {
  if (digits.size() % 2 != 0) return std::nullopt;
  std::vector<std::uint8_t> bytes;
  bytes.reserve(digits.size() / 2);
  for (; !digits.empty(); digits.remove_prefix(2)) {
    const auto byte = byte_of_hex(digits.substr(0, 2));
    if (!byte) return std::nullopt;
    bytes.push_back(*byte);
  }
  return bytes;
}

}  // namespace canopus::ascii
