#include "canopus/cli/analysis/trace_analysis.hpp"

#include <CLI/CLI.hpp>

namespace canopus::cli {

void add_trace_analysis(CLI::App& app, int& exit_code) {
  const auto groups =
      app.get_subcommands([](const CLI::App* command) { return command->get_name() == "trace"; });
  CLI::App* trace = groups.empty() ? nullptr : groups.front();
  if (trace == nullptr) {
    trace = app.add_subcommand("trace", "Look into traces of CAN buses");
    trace->require_subcommand(1);
  }
  add_trace_show(*trace, exit_code);
  add_trace_stats(*trace, exit_code);
  add_trace_plot(*trace, exit_code);
  add_trace_export(*trace, exit_code);
}

}  // namespace canopus::cli
