#pragma once
// `canopus web PROJECT`: the page in the browser for a CiA 306 project and its bus.

namespace canopus::cli {

class Command;

/// Adds the subcommand; when the user asks for it, parsing runs it and puts the exit code into `exit_code`.
void add_web_command(Command& app, int& exit_code);

}  // namespace canopus::cli
