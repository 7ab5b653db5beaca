#pragma once
// `canopus lss ...`: finding devices, their node-IDs and bit rates, by LSS [CiA 305].

namespace canopus::cli {

class Command;

/// Adds the subcommand `lss` to the program. When the user asks for it, parsing runs it and puts the exit
/// code into `exit_code`.
void add_lss_command(Command& app, int& exit_code);

}  // namespace canopus::cli
