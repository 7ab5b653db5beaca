#pragma once
// canopus trace show, stats, plot and export; canopus monitor.

namespace canopus::cli {

class Command;

void add_trace_show(Command& trace, int& exit_code);
void add_trace_stats(Command& trace, int& exit_code);
void add_trace_plot(Command& trace, int& exit_code);
void add_trace_export(Command& trace, int& exit_code);
/// All four, into `canopus trace`.
void add_trace_analysis(Command& trace, int& exit_code);

void add_monitor_command(Command& app, int& exit_code);

}  // namespace canopus::cli
