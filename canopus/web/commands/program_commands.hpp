#pragma once
// What people do with the program of a PLC from the page: variables, forces, single scans, breaks, online change. The commands are the
// requests of the control server (docs/control.md), with the same fields.

#include <map>
#include <string>

#include "canopus/link/loop_clock.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/web/commands/commands.hpp"

namespace canopus::web {

/// Adds them to the commands that are carried out in this process. Both must outlive these.
void add_program_commands(std::map<std::string, WebCommands::Own, std::less<>>& own, plant::Plant& plant,
                          link::LoopClock& clock);

}  // namespace canopus::web
