#pragma once
// CRC of SDO block transfers [CiA 301 7.2.4.3.16]: polynomial x^16 + x^12 + x^5 + 1, start value 0, no
// reflection, no final XOR, over the bytes of the value. "123456789" gives 31C3H.

#include <cstdint>
#include <span>

namespace canopus::canopen::sdo {

/// Continues `crc` (0 to begin with) over more bytes.
[[nodiscard]] std::uint16_t crc16(std::uint16_t crc, std::span<const std::uint8_t> bytes) noexcept;

}  // namespace canopus::canopen::sdo
