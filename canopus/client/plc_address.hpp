#pragma once
// The notation of PLC data: devices (D100, X1F, ZR0), buffer memory (U3\G256) and values.

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

#include "canopus/plc/melsec/target.hpp"

namespace canopus::client {

/// "D100", "x1f", "U0\G25"; see plc::parse_rack_address().
[[nodiscard]] inline std::expected<plc::melsec::Target, std::string> parse_plc_address(
    std::string_view text, unsigned io_base = 16) {
  return plc::parse_rack_address(text, io_base);
}

/// The target, `offset` points further, as people write it: "U0\G26", "X20".
[[nodiscard]] inline std::string plc_address(const plc::melsec::Target& target, std::uint32_t offset = 0,
                                             unsigned io_base = 16) {
  return plc::to_text(target, offset, io_base);
}

/// A 16-bit value: 1234, -5, 0x4D2, 4D2H, K1234, H4D2; -32768 to 65535.
[[nodiscard]] std::expected<std::uint16_t, std::string> parse_plc_word(std::string_view text);

/// A bit: 1, 0, ON, OFF.
[[nodiscard]] std::expected<bool, std::string> parse_plc_bit(std::string_view text);

}  // namespace canopus::client
