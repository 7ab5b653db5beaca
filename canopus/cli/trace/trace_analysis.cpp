#include "canopus/cli/trace/trace_analysis.hpp"

namespace canopus::cli {

void add_trace_analysis(Command& trace, int& exit_code) {
  add_trace_show(trace, exit_code);
  add_trace_stats(trace, exit_code);
  add_trace_plot(trace, exit_code);
  add_trace_export(trace, exit_code);
}

}  // namespace canopus::cli
