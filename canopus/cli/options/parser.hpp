#pragma once
// Reads a command line by the table of commands. The only part of the program that uses CLI11.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/cli/options/command.hpp"

namespace canopus::cli {

/// The result of parsing a command line.
struct Parsing {
  enum class Result : std::uint8_t {
    ran,       ///< the command was called
    answered,  ///< `text` is the help or the version
    misfit,    ///< a word is missing, or one too many; `text` names it, without a suggestion
    wrong      ///< `text` names the mistake
  };
  /// A command that the words named.
  struct Named {
    const Command* command;
    std::vector<std::string> left_over;  ///< words behind it that nothing took
  };

  Result result = Result::ran;
  std::string text{};
  std::vector<Named> commands{};  ///< the program, then the commands inwards
};

/// Puts the values into the options' targets and calls the command. Of the commands only those named are built.
/// `hint` gets a sentence for each old spelling, before the command is called.
[[nodiscard]] Parsing parse_words(Command& program, std::span<const std::string> words,
                                  const std::function<void(std::string_view)>& hint = {});

/// The output of --help.
[[nodiscard]] std::string help_of(Command& program);

}  // namespace canopus::cli
