#pragma once
// canopus trace show, stats, plot and export; canopus monitor.

namespace CLI {
class App;
}

namespace canopus::cli {

void add_trace_show(CLI::App& trace, int& exit_code);
void add_trace_stats(CLI::App& trace, int& exit_code);
void add_trace_plot(CLI::App& trace, int& exit_code);
void add_trace_export(CLI::App& trace, int& exit_code);
/// All four, into the group `canopus trace`, which is made if it is not there.
void add_trace_analysis(CLI::App& app, int& exit_code);

void add_monitor_command(CLI::App& app, int& exit_code);

}  // namespace canopus::cli
