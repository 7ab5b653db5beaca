#pragma once
// The words of a socketcand element, for the server's and the client's side.

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

namespace canopus::link {

[[nodiscard]] constexpr bool is_blank(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/// Takes the next word off the front of `text`; empty when there is none.
[[nodiscard]] inline std::string_view take_word(std::string_view& text) noexcept {
  const auto start = std::ranges::find_if_not(text, is_blank);
  const auto end = std::find_if(start, text.end(), is_blank);
  const std::string_view word(start, end);
  text = std::string_view(end, text.end());
  return word;
}

/// The whole word as a number without sign or prefix, up to 32 bits.
[[nodiscard]] inline std::optional<std::uint32_t> number(std::string_view word, int base) noexcept {
  std::uint32_t value = 0;
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value, base);
  if (failure != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace canopus::link
