#pragma once
// The devices of a PLC CPU (X Y M D W ...): what they are called, how people number them, and how many of
// them a CPU has.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace canopus::plc {

/// In the manuals' order: bit devices, then word devices. Timers and counters have a contact, a coil and a
/// current value each; without a PLC program they are memory.
enum class Device : std::uint8_t {
  x,    ///< input
  y,    ///< output
  m,    ///< internal relay
  l,    ///< latch relay
  f,    ///< annunciator
  v,    ///< edge relay
  b,    ///< link relay
  sb,   ///< link special relay
  sm,   ///< special relay
  ts,   ///< timer contact
  tc,   ///< timer coil
  sts,  ///< retentive timer contact
  stc,  ///< retentive timer coil
  cs,   ///< counter contact
  cc,   ///< counter coil
  d,    ///< data register
  w,    ///< link register
  sw,   ///< link special register
  sd,   ///< special register
  r,    ///< file register of the current block
  zr,   ///< file register, serial number access: the same words as R from ZR0 on
  z,    ///< index register
  tn,   ///< timer current value
  stn,  ///< retentive timer current value
  cn,   ///< counter current value
};

inline constexpr std::size_t device_count = 25;

struct DeviceInfo {
  std::string_view name;     ///< as people write it: "X", "ZR"
  bool is_bit = false;       ///< a bit device: one point is one bit, 16 points are a word
  bool hexadecimal = false;  ///< its numbers are written in hexadecimal
};

[[nodiscard]] const DeviceInfo& device_info(Device device) noexcept;
/// "D" -> Device::d; upper case. Empty for what is no device.
[[nodiscard]] std::optional<Device> device_named(std::string_view name) noexcept;

/// A CPU module as far as the outside sees it.
struct CpuModel {
  std::string_view name;   ///< as command 0101 answers it, at most 16 characters
  std::uint16_t code = 0;  ///< model code of command 0101 [SH-080008 11.1]
  bool iqr = false;        ///< understands the subcommands of the iQ-R series (0002, 0003, 0082)
  bool bcd_clock = false;  ///< SD210.. hold the clock as BCD pairs (Q), not one binary number per word (iQ-R)
  std::array<std::uint32_t, device_count> points{};  ///< by Device; 0: the CPU does not have it
  std::uint32_t device_words = 0;                    ///< memory for all devices but the file register
  std::uint32_t most_file_registers = 0;             ///< points of ZR at most
  std::uint32_t buffer_words = 0;                    ///< buffer memory of its own (0613); 0: the CPU has none

  [[nodiscard]] std::uint32_t points_of(Device device) const noexcept {
    return points[static_cast<std::size_t>(device)];
  }
};

/// R04CPU with the points a new project has: X Y M 12K, L B W 8K, D 18K, SM SD 4096, file register 32K. Takes
/// MELSEC-Q modules through an extension base unit and both kinds of subcommands, so it is the default.
[[nodiscard]] const CpuModel& r04cpu() noexcept;
/// Q03UDVCPU with the points of a new project: X Y M L B W 8K, D 12K, SM SD 2048, file register 32K.
[[nodiscard]] const CpuModel& q03udvcpu() noexcept;
/// By the name of command 0101, or nullptr.
[[nodiscard]] const CpuModel* cpu_model_named(std::string_view name) noexcept;

}  // namespace canopus::plc
