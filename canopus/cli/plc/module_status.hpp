#pragma once
// `canopus module status`: the modules of a running plant, as the engineering tool's module diagnostics show them.

#include <string>

#include "canopus/cli/output/print.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {

class Command;

/// Prints the control server's answer to the request "modules". Nothing of it is trusted.
void print_modules(const text::Json& answer, Output& out);

/// Adds `status` to `canopus module`. Exit code: 0 done, 1 the plant refused or could not be reached, 2 wrong command line.
void add_module_status(Command& module_command, int& exit_code);

}  // namespace canopus::cli
