#pragma once
// The commands `canopus completion` and `canopus reference`: what a package, a shell and a site of documentation need to know of
// the other commands.

#include <string_view>

namespace CLI {
class App;
}

namespace canopus::cli {

/// To be added last: they describe `app` as it is when they run.
void add_reference_commands(CLI::App& app, int& exit_code, std::string_view version);

}  // namespace canopus::cli
