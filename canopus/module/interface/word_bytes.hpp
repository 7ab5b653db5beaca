#pragma once
// Bytes and bits of a word.

#include <cstdint>

namespace canopus::module {

[[nodiscard]] constexpr std::uint8_t low_byte(std::uint16_t word) noexcept {
  return static_cast<std::uint8_t>(word & 0xFF);
}
[[nodiscard]] constexpr std::uint8_t high_byte(std::uint16_t word) noexcept {
  return static_cast<std::uint8_t>(word >> 8);
}

[[nodiscard]] constexpr std::uint16_t word_of(unsigned high_byte, unsigned low_byte) noexcept {
  return static_cast<std::uint16_t>(high_byte << 8 | low_byte);
}

[[nodiscard]] constexpr std::uint16_t with_bit(std::uint16_t word, unsigned bit, bool on) noexcept {
  const auto mask = static_cast<std::uint16_t>(1U << bit);
  return static_cast<std::uint16_t>(on ? word | mask : word & ~mask);
}

}  // namespace canopus::module
