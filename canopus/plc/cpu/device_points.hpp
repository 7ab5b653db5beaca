#pragma once
// How many points of each device a CPU has: the settings of a project, and the special registers that contain
// them.

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>

#include "canopus/plc/cpu/device.hpp"

namespace canopus::plc {

/// Whether a project can set the points of this device: M L F V B SB D W SW, T ST C (contact, coil and value at
/// once), ZR (with it R).
[[nodiscard]] bool has_settable_points(std::string_view device) noexcept;

/// Sets them like a project's parameters. The error names what was expected; nothing is changed then.
std::expected<void, std::string> set_device_points(CpuModel& model, std::string_view device,
                                                   std::int64_t points);
/// Whether all devices together fit into the CPU's memory; the error is a sentence.
[[nodiscard]] std::expected<void, std::string> check_device_points(const CpuModel& model);

/// SD that hold the number of points: from SD260 on (iQ-R), from SD286 on (Q). None: another register.
[[nodiscard]] std::optional<std::uint16_t> device_points_register(const CpuModel& model,
                                                                  std::uint32_t number) noexcept;

}  // namespace canopus::plc
