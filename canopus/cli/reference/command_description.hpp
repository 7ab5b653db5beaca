#pragma once
// The commands of the program as data, read from the command line's own definition: manual pages, the page of all
// commands and the completion of shells are made from it, so that they say what the program does.

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace canopus::cli {

/// An option ("--for TIME") or a positional argument ("PLANT").
struct OptionDescription {
  std::vector<std::string> names;  ///< "-q", "--quiet"; of a positional argument its name alone
  std::string value;               ///< what stands behind the option ("TIME"); empty: a flag
  std::string description;
  std::vector<std::string> choices;  ///< the words it takes; empty: others, too
  bool required = false;
  bool several = false;  ///< may be given again
};

struct CommandDescription {
  std::string name;  ///< all words: "canopus trace convert"
  std::string description;
  std::string footer;  ///< what the help says at its end, in lines
  std::vector<OptionDescription> arguments;
  std::vector<OptionDescription> options;
  std::vector<CommandDescription> commands;

  /// The last word of the name.
  [[nodiscard]] std::string word() const;
  /// "canopus trace convert [OPTIONS] IN OUT"
  [[nodiscard]] std::string usage() const;
};

/// The command, the commands in it, and so on. `outer`: the words before it.
[[nodiscard]] CommandDescription describe(CLI::App& command, const std::string& outer = {});

}  // namespace canopus::cli
