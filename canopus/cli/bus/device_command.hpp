#pragma once
// `canopus device`: reads and forces values of the simulated devices of a running plant.

namespace canopus::cli {

class Command;

void add_device_command(Command& app, int& exit_code);

}  // namespace canopus::cli
