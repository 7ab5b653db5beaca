#pragma once
// `canopus run PLANT.toml`.

namespace canopus::cli {

class Command;

/// Adds the subcommand; when the user asks for it, parsing runs it and puts the exit code into `exit_code`.
void add_run_command(Command& app, int& exit_code);

}  // namespace canopus::cli
