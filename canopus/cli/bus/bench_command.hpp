#pragma once

namespace canopus::cli {

class Command;

/// `canopus bench jitter`: how punctual a plant is on this machine.
void add_bench_command(Command& app, int& exit_code);

}  // namespace canopus::cli
