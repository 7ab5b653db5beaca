#pragma once
// How long a CPU takes for a program, by its family's instruction times.

#include <cstdint>

#include "canopus/can/time.hpp"
#include "canopus/plc/cpu/device.hpp"
#include "canopus/program/program.hpp"

namespace canopus::plc {

/// So many instructions of the register machine, each about one of the CPU.
[[nodiscard]] can::Duration execution_time(CpuFamily family, std::int64_t instructions) noexcept;
/// The most instructions that take no longer than this.
[[nodiscard]] std::int64_t instructions_within(CpuFamily family, can::Duration time) noexcept;

/// How long a scan takes that is not given: END processing, and every instruction of the program once.
[[nodiscard]] can::Duration estimated_scan(const program::Program& program, CpuFamily family);

/// The longest scan that the CPU permits if nothing else is set.
[[nodiscard]] can::Duration default_watchdog(CpuFamily family) noexcept;

}  // namespace canopus::plc
