#pragma once
// Addresses in a rack: a device of the CPU, or a word of a module's buffer memory; and their notation.

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

#include "canopus/plc/cpu/device.hpp"

namespace canopus::plc {

struct RackAddress {
  bool is_buffer = false;
  Device device = Device::d;       ///< when !is_buffer
  std::uint16_t head_address = 0;  ///< head I/O number of the module, when is_buffer
  std::uint32_t number = 0;        ///< device number or buffer memory address
};

/// "D100", "x1f", "U0\G25", "U3E0\HG0" (also with / instead of the backslash). The unit number behind U and
/// the numbers of X Y B W SB SW are hexadecimal, everything else is decimal; `io_base` is what X and Y are
/// written in, 8 with an FX (CpuModel::number_base). The error names what was expected.
[[nodiscard]] std::expected<RackAddress, std::string> parse_rack_address(std::string_view text,
                                                                         unsigned io_base = 16);

/// The address `offset` points further, as people write it: "U0\G26", "X20".
[[nodiscard]] std::string to_text(const RackAddress& address, std::uint32_t offset = 0,
                                  unsigned io_base = 16);

}  // namespace canopus::plc
