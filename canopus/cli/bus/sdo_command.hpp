#pragma once
// `canopus sdo read|write`: objects of a node on a bus.

namespace canopus::cli {

class Command;

/// Adds the subcommand `sdo` to the program. When the user asks for it, parsing runs it and puts the exit
/// code into `exit_code`.
void add_sdo_command(Command& app, int& exit_code);

}  // namespace canopus::cli
