#pragma once
// Numbers as text. A text is a number as a whole: no blanks, no '+', nothing behind it, and '-' of signed types alone.

#include <charconv>
#include <concepts>
#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>
#include <system_error>

namespace canopus::ascii {

enum class NumberError : std::uint8_t {
  no_number,
  out_of_range,  ///< a number, but not one of this type
};

/// An integer in `base` (2 to 36, letters in both cases, no prefix), and why there is none.
template <std::integral Number>
[[nodiscard]] std::expected<Number, NumberError> parse_number_or_error(std::string_view text,
                                                                       int base = 10) noexcept {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [stop, failure] = std::from_chars(text.data(), end, value, base);
  if (stop != end || failure == std::errc::invalid_argument) return std::unexpected(NumberError::no_number);
  if (failure != std::errc{}) return std::unexpected(NumberError::out_of_range);
  return value;
}

/// An integer in `base` (2 to 36, letters in both cases, no prefix); nothing if it is none or does not fit.
template <std::integral Number>
[[nodiscard]] std::optional<Number> parse_number(std::string_view text, int base = 10) noexcept {
  const auto number = parse_number_or_error<Number>(text, base);
  return number ? std::optional(*number) : std::nullopt;
}

/// "1.5", "-2e3", "inf", "nan"; nothing if it is none, or is too large or too small for the type.
template <std::floating_point Number>
[[nodiscard]] std::optional<Number> parse_number(std::string_view text) noexcept {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [stop, failure] = std::from_chars(text.data(), end, value);
  if (stop != end || failure != std::errc{}) return std::nullopt;
  return value;
}

[[nodiscard]] constexpr bool has_hex_prefix(std::string_view text) noexcept {
  return text.starts_with("0x") || text.starts_with("0X");
}

/// "31" or "0x1F".
template <std::unsigned_integral Number>
[[nodiscard]] std::optional<Number> parse_number_with_prefix(std::string_view text) noexcept {
  return has_hex_prefix(text) ? parse_number<Number>(text.substr(2), 16) : parse_number<Number>(text);
}

/// Always hexadecimal: "1F", "0x1F", "1FH".
template <std::unsigned_integral Number>
[[nodiscard]] std::optional<Number> parse_hexadecimal(std::string_view text) noexcept {
  if (has_hex_prefix(text)) text.remove_prefix(2);
  if (text.ends_with('H') || text.ends_with('h')) text.remove_suffix(1);
  return parse_number<Number>(text, 16);
}

}  // namespace canopus::ascii
