#pragma once
// The devices of a PLC CPU (X Y M D W ...): their names, their number bases, and their number of points in a
// CPU.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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
  s,    ///< step relay
  hcs,  ///< 32-bit counter contact (AS300)
  hcn,  ///< 32-bit counter current value (AS300), two words each, the low one first; of an FX3 the high words of C200...
  rd,   ///< refresh data register (iQ-R): what modules are refreshed with
  hg,   ///< fixed scan communication area of the CPU buffer memory (iQ-R), U3E0\HG: not a device by itself
};

inline constexpr std::size_t device_count = 30;

/// Families of PLCs, as far as they differ in access from outside: which devices exist, the number base of X
/// and Y, the address of a module.
enum class CpuFamily : std::uint8_t { q, iqr, fx3, fx5, as300 };

inline constexpr std::size_t family_count = 5;

/// The address of a module of a rack.
struct ModulePlace {
  std::string_view key;    ///< as the plant file calls it
  std::string_view words;  ///< what it is, for people
  std::uint16_t first = 0;
  std::uint16_t last = 0;
  std::uint16_t step = 1;  ///< numbers are multiples of it
};

struct FamilyInfo {
  std::string_view name;  ///< as people write it: "iQ-R"
  ModulePlace place;
  bool modules_have_points = false;  ///< a module occupies X and Y from its head I/O number on
  bool counts_octal = false;         ///< X and Y
};

[[nodiscard]] const FamilyInfo& family_info(CpuFamily family) noexcept;
/// "FX3" -> CpuFamily::fx3; small and capital letters differ. Empty for what is no family.
[[nodiscard]] std::optional<CpuFamily> family_named(std::string_view name) noexcept;

struct DeviceInfo {
  std::string_view name;     ///< as people write it: "X", "ZR"
  bool is_bit = false;       ///< a bit device: one point is one bit, 16 points are a word
  bool hexadecimal = false;  ///< its numbers are written in hexadecimal
};

[[nodiscard]] const DeviceInfo& device_info(Device device) noexcept;
/// "D" -> Device::d; upper case. Empty for what is no device.
[[nodiscard]] std::optional<Device> device_named(std::string_view name) noexcept;

/// A CPU module by its external properties.
struct CpuModel {
  std::string_view name;   ///< as command 0101 answers it, at most 16 characters
  std::uint16_t code = 0;  ///< model code of command 0101 [SH-080008 11.1]
  bool iqr = false;        ///< understands the subcommands of the iQ-R series (0002, 0003, 0082)
  bool bcd_clock = false;  ///< SD210.. hold the clock as BCD pairs (Q), not one binary number per word (iQ-R)
  std::array<std::uint32_t, device_count> points{};  ///< by Device; 0: the CPU does not have it
  std::uint32_t device_words = 0;                    ///< memory for all devices but the file register
  std::uint32_t most_file_registers = 0;             ///< points of ZR at most
  std::uint32_t buffer_words = 0;                    ///< buffer memory of its own (0613); 0: the CPU has none
  CpuFamily family = CpuFamily::q;

  [[nodiscard]] std::uint32_t points_of(Device device) const noexcept {
    return points[static_cast<std::size_t>(device)];
  }
  /// Points up to the last one, the gap below the special ones of an FX3 included: what memory there must be.
  [[nodiscard]] std::uint32_t end_of(Device device) const noexcept;
  /// The CPU has all these points: `count` from `first` on. FX3: M8000 to M8511 and D8000 to D8511 as well.
  [[nodiscard]] bool has(Device device, std::uint32_t first, std::uint32_t count) const noexcept;
  /// The special relays and registers: SM and SD; of an FX3 M and D from 8000 on.
  [[nodiscard]] Device special_relay() const noexcept;
  [[nodiscard]] Device special_register() const noexcept;
  /// In which the numbers of a device are written: 8, 10 or 16.
  [[nodiscard]] unsigned number_base(Device device) const noexcept;
  /// The device's name in this family: SR of an AS300 is Device::sd.
  [[nodiscard]] std::string_view name_of(Device device) const noexcept;
};

/// R04CPU with the points a new project has: X Y M 12K, L B W 8K, D 18K, SM SD 4096, file register 32K, RD 512K. Takes
/// MELSEC-Q modules through an extension base unit and both kinds of subcommands, so it is the default.
[[nodiscard]] const CpuModel& r04cpu() noexcept;
/// Q03UDVCPU with the points of a new project: X Y M L B W 8K, D 12K, SM SD 2048, file register 32K.
[[nodiscard]] const CpuModel& q03udvcpu() noexcept;
/// FX3U, FX3UC: X Y in octal to 367, M 7680 and M8000 to M8511, S 4096, D 8000 and D8000 to D8511, R 32768.
[[nodiscard]] const CpuModel& fx3u() noexcept;
/// FX5U, FX5UC with the points of a new project: X Y in octal to 1777, M L 7680, D 8000, SM 10000, SD 12000.
[[nodiscard]] const CpuModel& fx5u() noexcept;
/// AS300: X Y 1024 (X0.0 to X63.15 as 0 to 1023), M 8192, S 2048, T C 512, HC 256, D 30000, SR 2048.
[[nodiscard]] const CpuModel& as300() noexcept;
/// The default model of a family.
[[nodiscard]] const CpuModel& default_model(CpuFamily family) noexcept;
/// The names of all models.
[[nodiscard]] std::span<const std::string_view> cpu_model_names() noexcept;
/// By the name of command 0101, or nullptr.
[[nodiscard]] const CpuModel* cpu_model_named(std::string_view name) noexcept;

}  // namespace canopus::plc
