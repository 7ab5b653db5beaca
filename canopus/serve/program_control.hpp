#pragma once
// Requests of the control server about a PLC's program: its variables by name, forces, breaks, single scans, online change
// (docs/control.md). The page's commands are the same.

#include <span>
#include <string_view>

#include "canopus/plant/plant.hpp"
#include "canopus/serve/control_message.hpp"

namespace canopus::serve {

struct ProgramRequest {
  std::string_view name;                     ///< "force variable"
  std::span<const std::string_view> fields;  ///< beside `plc`
  bool is_read_only = false;
};
[[nodiscard]] std::span<const ProgramRequest> program_requests() noexcept;
[[nodiscard]] bool is_program_request(std::string_view request) noexcept;
/// Carries one of them out.
[[nodiscard]] Result<Json> program_request(plant::Plant& plant, const ControlFields& fields,
                                           std::string_view request);

}  // namespace canopus::serve
