#pragma once
// `canopus sdo read|write`: objects of a node on a bus.

namespace CLI {
class App;
}

namespace canopus::cli {

/// Adds the subcommand `sdo` to the program. When the user asks for it, parsing runs it and puts the exit
/// code into `exit_code`.
void add_sdo_command(CLI::App& app, int& exit_code);

}  // namespace canopus::cli
