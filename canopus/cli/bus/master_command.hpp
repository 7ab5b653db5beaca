#pragma once
// `canopus master --dcf network.toml`: boots a network without a PLC.

namespace canopus::cli {

class Command;

/// Adds the subcommand `master` to the program. When the user asks for it, parsing runs it and puts the exit
/// code into `exit_code`.
void add_master_command(Command& app, int& exit_code);

}  // namespace canopus::cli
