#pragma once
// canopus trace convert, diff and info: traces as files.

namespace CLI {
class App;
}

namespace canopus::cli {

void add_trace_convert(CLI::App& trace, int& exit_code);
void add_trace_diff(CLI::App& trace, int& exit_code);
void add_trace_info(CLI::App& trace, int& exit_code);
/// All three, into the group `canopus trace`, which is made if it is not there.
void add_trace_command(CLI::App& app, int& exit_code);

}  // namespace canopus::cli
