#pragma once
// Common to LSS master and slave [CiA 305]: identifiers, command specifiers, the LSS address, and the table
// of bit rates. All frames have 8 bytes; numbers are little-endian.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "canopus/can/frame.hpp"
#include "canopus/can/little_endian.hpp"

namespace canopus::lss {

/// The LSS address of a device: 1018:01..04.
struct LssAddress {
  std::uint32_t vendor = 0;
  std::uint32_t product = 0;
  std::uint32_t revision = 0;
  std::uint32_t serial = 0;

  /// 0 vendor, 1 product, 2 revision, 3 serial.
  [[nodiscard]] constexpr std::uint32_t part(unsigned number) const noexcept {
    return number == 0 ? vendor : number == 1 ? product : number == 2 ? revision : serial;
  }
  constexpr void set_part(unsigned number, std::uint32_t value) noexcept {
    (number == 0 ? vendor : number == 1 ? product : number == 2 ? revision : serial) = value;
  }
  friend constexpr bool operator==(const LssAddress&, const LssAddress&) = default;
};

inline constexpr std::uint32_t from_slave = 0x7E4;
inline constexpr std::uint32_t from_master = 0x7E5;
/// Node-ID of a device that has none yet.
inline constexpr std::uint8_t unconfigured = 0xFF;

/// BitCheck of a fastscan that begins.
inline constexpr std::uint8_t reset_scan = 0x80;

/// Command specifiers, byte 0.
namespace command {
inline constexpr std::uint8_t switch_global = 0x04;
inline constexpr std::uint8_t configure_node_id = 0x11;
inline constexpr std::uint8_t configure_bit_timing = 0x13;
inline constexpr std::uint8_t activate_bit_timing = 0x15;
inline constexpr std::uint8_t store = 0x17;
inline constexpr std::uint8_t select_vendor = 0x40;  ///< 41H product, 42H revision, 43H serial
inline constexpr std::uint8_t select_serial = 0x43;
inline constexpr std::uint8_t selected = 0x44;
inline constexpr std::uint8_t identify_vendor = 0x46;  ///< 47H product, 48H..4BH revision and serial ranges
inline constexpr std::uint8_t identify_serial_high = 0x4B;
inline constexpr std::uint8_t identify_unconfigured = 0x4C;
inline constexpr std::uint8_t identified = 0x4F;
inline constexpr std::uint8_t unconfigured_identified = 0x50;
inline constexpr std::uint8_t fastscan = 0x51;
inline constexpr std::uint8_t inquire_vendor = 0x5A;  ///< 5BH product, 5CH revision, 5DH serial
inline constexpr std::uint8_t inquire_serial = 0x5D;
inline constexpr std::uint8_t inquire_node_id = 0x5E;
}  // namespace command

/// Bit rates of table 0 by their index, in bit/s; 0 = reserved.
inline constexpr std::array<std::uint32_t, 9> bit_rates{1'000'000, 800'000, 500'000, 250'000, 125'000,
                                                        0,         50'000,  20'000,  10'000};

/// Index of a bit rate in table 0.
[[nodiscard]] constexpr std::optional<std::uint8_t> bit_rate_index(std::uint32_t bit_rate) noexcept {
  for (std::size_t index = 0; index < bit_rates.size(); ++index) {
    if (bit_rate != 0 && bit_rates[index] == bit_rate) return static_cast<std::uint8_t>(index);
  }
  return std::nullopt;
}

/// A number in bytes 1..4.
[[nodiscard]] inline std::uint32_t number(const can::Frame& frame) noexcept {
  return can::load_as<std::uint32_t>(&frame.data[1]);
}

/// A frame of 8 bytes: command specifier, and a number in bytes 1..4.
[[nodiscard]] inline can::Frame frame(std::uint32_t identifier, std::uint8_t command,
                                      std::uint32_t value = 0) noexcept {
  can::Frame frame = can::data_frame(identifier, {command, 0, 0, 0, 0, 0, 0, 0});
  can::store_value(&frame.data[1], value, 4);
  return frame;
}

}  // namespace canopus::lss
