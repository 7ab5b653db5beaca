#pragma once
// The program of a PLC as the page shows it: its text with the values in it, and its variables.

#include <string>

#include "canopus/plant/plant.hpp"
#include "canopus/text/json.hpp"

namespace canopus::web {

/// The event of {"program": PLC, "file": 0, "from": 1, "count": 200, "block": "Main.motor1"}: the lines of that file of the program of
/// the PLC of that name. Empty: it has no program.
[[nodiscard]] std::string program_event(plant::Plant& plant, const text::Json& wish);
/// The event of {"variables": PLC, "find": "...", "from": 0, "count": 100}.
[[nodiscard]] std::string variables_event(plant::Plant& plant, const text::Json& wish);
/// One entry for each PLC with a program: `plc state`, after an error `error`.
[[nodiscard]] text::Json programs_of(plant::Plant& plant);

}  // namespace canopus::web
