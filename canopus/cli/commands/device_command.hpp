#pragma once
// `canopus device`: the values of the simulated devices of a running plant, to look at and to force.

namespace CLI {
class App;
}

namespace canopus::cli {

void add_device_command(CLI::App& app, int& exit_code);

}  // namespace canopus::cli
