#pragma once
// The register machine.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "canopus/program/program.hpp"

namespace canopus::program {

/// Where a break has halted a run, which goes on from there.
struct Suspension {
  struct Caller {
    std::uint32_t next = 0;  ///< instruction
    std::uint32_t frame = 0;
  };
  bool is_set = false;
  std::uint32_t next = 0;
  std::uint32_t frame = 0;
  std::uint32_t depth = 0;
  std::array<Caller, most_nested_calls> callers{};
};

/// What a run of code works on.
struct Execution {
  std::span<const Instruction> code;
  std::span<const SourcePosition> positions;
  const Program& program;  ///< its tables
  std::span<Slot> memory;
  std::span<const Slot> initial;  ///< of the memory
  DeviceImage* devices = nullptr;
  std::int64_t now = 0;     ///< ns: the time of the scan
  std::int64_t budget = 0;  ///< instructions that it may still execute, as loops and calls count them
  Suspension* suspension = nullptr;             ///< of code with breaks
  const DeviceMemory* device_memory = nullptr;  ///< of each of Program::devices; nullptr: by the image alone
};

/// Runs from instruction `entry` on with the frame at `frame` until the program's end. The code must be a compiler's: it is not checked.
/// Allocates nothing.
/// With `suspension` set it goes on from there instead, beyond the break. At a break it returns without a fault, `suspension` set.
[[nodiscard]] std::optional<Fault> execute(Execution& execution, std::uint32_t entry,
                                           std::uint32_t frame) noexcept;

}  // namespace canopus::program
