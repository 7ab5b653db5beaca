#pragma once
// Frames of Modbus RTU: where a request ends, and its CRC [Modbus over Serial Line V1.02 2.5.1, 6.2].

#include <cstddef>
#include <cstdint>
#include <span>

namespace canopus::plc::modbus {

/// CRC-16 of these bytes; it goes out low byte first.
[[nodiscard]] std::uint16_t rtu_crc(std::span<const std::uint8_t> bytes) noexcept;

/// How long the request is that `waiting` begins with, unit and CRC included.
struct RtuSize {
  bool is_known = false;
  bool is_none =
      false;  ///< not known, and never: a function whose requests have no known length, or one too long
  std::size_t bytes = 0;
};
[[nodiscard]] RtuSize rtu_request_size(std::span<const std::uint8_t> waiting) noexcept;

/// Whether the last two bytes are the CRC of the others.
[[nodiscard]] bool has_good_crc(std::span<const std::uint8_t> frame) noexcept;
/// Whether it is one request, with a good CRC and nothing behind it.
[[nodiscard]] bool is_rtu_request(std::span<const std::uint8_t> waiting) noexcept;

}  // namespace canopus::plc::modbus
