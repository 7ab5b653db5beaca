#pragma once
// `canopus device`: the values of the simulated devices of a running plant, to look at and to force.

namespace canopus::cli {

class Command;

void add_device_command(Command& app, int& exit_code);

}  // namespace canopus::cli
