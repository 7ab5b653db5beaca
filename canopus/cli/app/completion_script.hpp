#pragma once
// Scripts that complete the words of the program's command line in a shell, made from the table of its commands.

#include <optional>
#include <string>
#include <string_view>

#include "canopus/cli/options/command.hpp"

namespace canopus::cli {

enum class Shell { bash, zsh, fish };

/// "bash", "zsh", "fish"; nothing for another word.
[[nodiscard]] std::optional<Shell> shell_of(std::string_view word);

/// The script to load in the shell, or to put into its folder of completions.
[[nodiscard]] std::string completion_script(const Command& program, Shell shell);

}  // namespace canopus::cli
