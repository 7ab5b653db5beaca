#include "canopus/cli/trace/trace_command.hpp"

namespace canopus::cli {

void add_trace_files(Command& trace, int& exit_code) {
  add_trace_info(trace, exit_code);
  add_trace_convert(trace, exit_code);
  add_trace_diff(trace, exit_code);
}

}  // namespace canopus::cli
