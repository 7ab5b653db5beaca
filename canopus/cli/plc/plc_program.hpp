#pragma once
// `canopus plc` and the program that a simulated PLC runs: its variables by name, scans, breaks, online change, over the control server
// of the plant.

#include <string>
#include <string_view>

#include "canopus/cli/plc/plc_arguments.hpp"

namespace canopus::cli {

/// What was written for ADDRESS is the name of a variable: with --at everything, else what is no address and could not be meant as
/// one, such as "Main.step", "list[3].x" or "counter", but not "n" or "X".
[[nodiscard]] bool is_variable(const PlcArguments& arguments);

// Exit codes are those of plc_access.hpp.
int read_variable(const PlcArguments& arguments);
int write_variable(const PlcArguments& arguments);
int watch_variable(const PlcArguments& arguments);
int force_variable(const PlcArguments& arguments);
/// Without a name all of them.
int release_variable(const PlcArguments& arguments);
/// "halt program", "single scan" or "continue program"; prints the state.
int control_program(const PlcArguments& arguments, std::string_view request);
/// arguments.address is "main.st:12".
int set_break(const PlcArguments& arguments);
/// Without a place all of them.
int clear_break(const PlcArguments& arguments);
int change_program(const PlcArguments& arguments);
int show_program(const PlcArguments& arguments);

}  // namespace canopus::cli
