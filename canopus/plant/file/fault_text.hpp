#pragma once
// One fault of a bus as the lines below [[bus.fault]], to make one while a plant runs.

#include <expected>
#include <string>
#include <string_view>

#include "canopus/plant/file/plant_file.hpp"

namespace canopus::plant {

/// "kind = \"drop\"\nidentifier = 0x183\ncount = 1". The error is the first mistake, with its line.
[[nodiscard]] std::expected<FaultSection, std::string> read_fault(std::string_view text);

}  // namespace canopus::plant
