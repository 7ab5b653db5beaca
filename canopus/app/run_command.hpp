#pragma once
// `canopus run PLANT.toml` and `canopus check PLANT.toml`.

namespace CLI {
class App;
}

namespace canopus::app {

/// Adds the subcommands; when the user asks for one, parsing runs it and puts the exit code into `exit_code`.
void add_run_command(CLI::App& app, int& exit_code);
void add_check_command(CLI::App& app, int& exit_code);

}  // namespace canopus::app
