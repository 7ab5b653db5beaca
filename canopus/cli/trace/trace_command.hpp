#pragma once
// canopus trace convert, diff and info: traces as files.

namespace canopus::cli {

class Command;

void add_trace_convert(Command& trace, int& exit_code);
void add_trace_diff(Command& trace, int& exit_code);
void add_trace_info(Command& trace, int& exit_code);
/// All three.
void add_trace_files(Command& trace, int& exit_code);

}  // namespace canopus::cli
