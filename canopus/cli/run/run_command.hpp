#pragma once
// `canopus run PLANT.toml`.

namespace CLI {
class App;
}

namespace canopus::cli {

/// Adds the subcommand; when the user asks for it, parsing runs it and puts the exit code into `exit_code`.
void add_run_command(CLI::App& app, int& exit_code);

}  // namespace canopus::cli
