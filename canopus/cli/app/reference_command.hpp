#pragma once
// The commands `canopus completion` and `canopus reference`: what a package, a shell and a site of documentation need to know of
// the other commands.

#include <string_view>

namespace canopus::cli {

class Command;

/// To be added last: they describe `app` as it is when they run.
void add_reference_commands(Command& app, int& exit_code, std::string_view version);

}  // namespace canopus::cli
