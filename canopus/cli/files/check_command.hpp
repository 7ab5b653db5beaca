#pragma once
// `canopus check PLANT.toml`: errors and probable mistakes of a plant file, without running it.

#include <string>

#include "canopus/cli/output/print.hpp"

namespace canopus::cli {

class Command;

struct CheckOptions {
  std::string plant;                ///< path of the plant file
  bool strict = false;              ///< warnings are mistakes, too
  bool allows_native_code = false;  ///< programs that are shared objects are loaded
};

/// Prints what is connected to what on `out`, mistakes and warnings on `err`. The exit code: 0 the plant can
/// start, 2 it cannot (with `strict`: or there is a warning).
int check_plant(const CheckOptions& options, Output& out, Output& err);

/// Adds the subcommand; when the user asks for it, parsing runs it and puts the exit code into `exit_code`.
void add_check_command(Command& app, int& exit_code);

}  // namespace canopus::cli
