#pragma once
// `canopus nmt start|stop|preop|reset|reset-comm NODE|all`: NMT commands on a bus.

namespace canopus::cli {

class Command;

/// Adds the subcommand `nmt` to the program. When the user asks for it, parsing runs it and puts the exit
/// code into `exit_code`.
void add_nmt_command(Command& app, int& exit_code);

}  // namespace canopus::cli
