#include "canopus/canopen/sdo/sdo_crc.hpp"

#include <array>
#include <cstddef>

namespace canopus::canopen::sdo {
namespace {

constexpr std::size_t slice = 16;  // bytes taken at once
using Tables = std::array<std::array<std::uint16_t, 256>, slice>;

// tables[k][b]: what byte b does to the CRC when k more bytes of 0 follow it.
constexpr Tables make_tables() {
  Tables tables{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    unsigned crc = byte << 8;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x8000U) != 0 ? crc << 1 ^ 0x1021U : crc << 1;
    tables[0][byte] = static_cast<std::uint16_t>(crc);
  }
  for (std::size_t k = 1; k < slice; ++k) {
    for (unsigned byte = 0; byte < 256; ++byte) {
      const std::uint16_t crc = tables[k - 1][byte];
      tables[k][byte] = static_cast<std::uint16_t>(crc << 8 ^ tables[0][crc >> 8]);
    }
  }
  return tables;
}

constexpr Tables tables = make_tables();

}  // namespace

std::uint16_t crc16(std::uint16_t crc, std::span<const std::uint8_t> bytes) noexcept {
  const std::uint8_t* p = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= slice; left -= slice, p += slice) {
    // What does not wait for the CRC of the bytes before comes first.
    const auto later = tables[13][p[2]] ^ tables[12][p[3]] ^ tables[11][p[4]] ^ tables[10][p[5]] ^
                       tables[9][p[6]] ^ tables[8][p[7]] ^ tables[7][p[8]] ^ tables[6][p[9]] ^
                       tables[5][p[10]] ^ tables[4][p[11]] ^ tables[3][p[12]] ^ tables[2][p[13]] ^
                       tables[1][p[14]] ^ tables[0][p[15]];
    crc = static_cast<std::uint16_t>(tables[15][p[0] ^ crc >> 8] ^ tables[14][p[1] ^ (crc & 0xFF)] ^ later);
  }
  for (; left != 0; --left, ++p) {
    crc = static_cast<std::uint16_t>(crc << 8 ^ tables[0][(crc >> 8 ^ *p) & 0xFF]);
  }
  return crc;
}

}  // namespace canopus::canopen::sdo
