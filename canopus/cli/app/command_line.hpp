#pragma once
// The command line of the program: all commands, and the error texts for mistyped ones.

#include <span>
#include <string>

namespace canopus::cli {

class Command;

/// All commands of the program. The one that is called sets the exit code.
void add_commands(Command& app, int& code);

/// Runs the command that the words behind the program's name ask for. The exit code is the command's; 2 when
/// the words make no command.
int run_command_line(std::span<const std::string> words);

}  // namespace canopus::cli
