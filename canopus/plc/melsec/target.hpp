#pragma once
// The target of a request: a device of the CPU, or buffer memory of a module (U\G), in the four layouts of
// the subcommands.
//
//                      binary                                         ASCII
//   000x Q/L     number 3 | code 1                                    code 2 | number 6
//   000x iQ-R    number 4 | code 2                                    code 4 | number 8
//   008x Q/L     00 00 | number 3 | code 1 | 00 00 | ext 2 | memory   "00" | ext 4 | "000" | code 2 |
//                                                                     number 6 | "000"
//   008x iQ-R    00 00 | number 4 | code 2 | 00 00 | ext 2 | memory   "00" | ext 4 | "0000" | code 4 |
//                                                                     number 10 | "0000"
//
// `ext` is a module's start I/O number / 16 (ASCII: "U003"), `memory` F8H then; 3E0H (ASCII: "U3E0") and FAH of the CPU
// buffer memory. The zeros in front (in ASCII behind) are the
// place of the device's index modification, those behind the code (in ASCII behind `ext`) of the extension's: 4000H + n
// (ASCII: "Z04") adds index register Zn. [SH-080008 8.1, appendix 1]

#include <cstdint>
#include <expected>
#include <span>

#include "canopus/plc/cpu/device.hpp"
#include "canopus/plc/melsec/end_code.hpp"
#include "canopus/plc/melsec/field.hpp"
#include "canopus/plc/rack/rack_address.hpp"

namespace canopus::plc::melsec {

/// The last digit of the subcommands 000x and 008x, apart from its bit for single bits.
struct Layout {
  bool iqr = false;
  bool extended = false;
  bool octal_io = false;  ///< ASCII: the CPU counts X and Y in octal (FX5)
};

using Target = RackAddress;

/// Reads one target. A missing byte or a wrong digit shows in the reader's fault, as for any field; the error
/// is about what was read. `index_registers`: the values of Z0, Z1 ...
[[nodiscard]] std::expected<Target, EndCode> read_target(
    FieldReader& reader, Layout layout, std::span<const std::uint16_t> index_registers) noexcept;

/// Binary code of a device, the same for Q and iQ-R.
[[nodiscard]] std::uint8_t device_code(Device device) noexcept;
/// ASCII code of a device, without its padding: the Q series calls the retentive timers SS SC SN.
[[nodiscard]] std::string_view device_text(Device device, bool iqr) noexcept;

/// Binary code of G.
inline constexpr std::uint8_t buffer_memory_code = 0xAB;
/// The direct memory specification for a CPU's or module's memory: U\G.
inline constexpr std::uint8_t module_access = 0xF8;
/// Likewise, the CPU buffer memory: U3E0\HG. `ext` is 3E0H then, CPU No. 1 of a multiple CPU system.
inline constexpr std::uint8_t cpu_buffer = 0xFA;
inline constexpr std::uint16_t own_cpu = 0x03E0;

}  // namespace canopus::plc::melsec
