#pragma once
// The error code that a CPU stores when its program fails, by the families' manuals.

#include <cstdint>

#include "canopus/plc/cpu/device.hpp"
#include "canopus/program/program.hpp"

namespace canopus::plc {

/// What goes into SD0 (Q, iQ-R, FX5), D8067 or D8061 (FX3); docs/plc-programs.md has the sources. AS300: 0, its manual has no code for it.
[[nodiscard]] std::uint16_t error_code_of(CpuFamily family, program::FaultCode code) noexcept;

}  // namespace canopus::plc
