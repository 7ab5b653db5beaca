#pragma once

#include <string_view>

#include "canopus/cli/terminal/print.hpp"

namespace canopus::cli {

/// Says on `err` that a named pipe is waited for, as trace::KeepReading has it: `silent` is its name, or empty.
inline void report_silent_pipe(std::string_view silent, Output& err) {
  if (!silent.empty()) err.line("canopus: {}: waiting until a program writes to this named pipe", silent);
}

}  // namespace canopus::cli
