#include "canopus/cli/trace/trace_command.hpp"

#include <CLI/CLI.hpp>

namespace canopus::cli {

void add_trace_command(CLI::App& app, int& exit_code) {
  const auto groups =
      app.get_subcommands([](const CLI::App* command) { return command->get_name() == "trace"; });
  CLI::App* trace = groups.empty() ? nullptr : groups.front();
  if (trace == nullptr) {
    trace = app.add_subcommand("trace", "Look into traces of CAN buses, convert and compare them");
    trace->require_subcommand(1);
  }
  add_trace_info(*trace, exit_code);
  add_trace_convert(*trace, exit_code);
  add_trace_diff(*trace, exit_code);
}

}  // namespace canopus::cli
