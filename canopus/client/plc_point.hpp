#pragma once
// The points that a client reads and writes: devices and buffer memory of a MELSEC PLC, devices of an AS300,
// Modbus addresses.

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

#include "canopus/plc/melsec/target.hpp"
#include "canopus/plc/rack/rack_address.hpp"

namespace canopus::client {

struct PlcPoint {
  enum class Kind : std::uint8_t {
    rack,           ///< a device, or buffer memory
    words_of_bits,  ///< X3 of an AS300: X3.0 to X3.15 as one word; the number counts words
    coils,          ///< from here on the number is a Modbus address
    discrete_inputs,
    holding_registers,
    input_registers,
  };

  Kind kind = Kind::rack;
  plc::RackAddress at{};

  /// One point is a bit, else a word.
  [[nodiscard]] bool is_bit() const noexcept;
  /// Both are points of one row; only their numbers may differ.
  [[nodiscard]] bool is_in_one_row_with(const PlcPoint& other) const noexcept;
  [[nodiscard]] PlcPoint further(std::size_t points) const noexcept {
    PlcPoint point = *this;
    point.at.number += static_cast<std::uint32_t>(points);
    return point;
  }
};

/// Their notation.
enum class PlcNotation : std::uint8_t {
  melsec,
  melsec_octal,  ///< X and Y are counted in octal
  modbus         ///< an AS300's devices (D100, SR7, X0.5, X0), and coil:5 discrete:5 holding:5 input:5
};

/// "D100", "U0\G25"; the error names what was expected.
[[nodiscard]] std::expected<PlcPoint, std::string> parse_plc_point(std::string_view text,
                                                                   PlcNotation notation);

/// The point `offset` further, as parse_plc_point() reads it.
[[nodiscard]] std::string to_text(const PlcPoint& point, std::uint32_t offset, PlcNotation notation);

// The notation of PLC data: devices (D100, X1F, ZR0), buffer memory (U3\G256) and values.

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
