#pragma once

namespace CLI {
class App;
}

namespace canopus::cli {

/// `canopus bench jitter`: how punctual a plant is on this machine.
void add_bench_command(CLI::App& app, int& exit_code);

}  // namespace canopus::cli
