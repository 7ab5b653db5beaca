#pragma once
// The commands `canopus completion` and `canopus reference`: generate completions, manual pages and a
// reference from the other commands, for shells, packages and documentation.

#include <string_view>

namespace canopus::cli {

class Command;

/// Add them last: they describe `app` as it is when they run.
void add_reference_commands(Command& app, int& exit_code, std::string_view version);

}  // namespace canopus::cli
