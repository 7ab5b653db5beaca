#pragma once
// A trace file read to its end, record by record.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "canopus/text/output.hpp"
#include "canopus/trace/file/trace_reader.hpp"

namespace canopus::trace {

/// A KeepReading for commands: prints on `err` that the command waits for a named pipe, and continues while
/// `goes_on()` is true.
inline std::function<bool(std::string_view)> wait_in_words(text::Output& err, std::function<bool()> goes_on) {
  return [&err, goes_on = std::move(goes_on)](std::string_view silent) {
    if (!silent.empty()) err.line("canopus: {}: waiting until a program writes to this named pipe", silent);
    return goes_on();
  };
}

/// Prints on `err` what the reader has left out so far, by kind, and how many frames the recorder lost. False, and a line
/// that says so, if the file has frames or lines but none of them was read: `records` are those that were, `mistakes`
/// those that could not be.
[[nodiscard]] bool report_left_out(const std::string& path, const TraceReader& reader, std::uint64_t records,
                                   std::uint64_t mistakes, text::Output& err);

/// Hands every record to `record`, with the name of its channel (empty: the file names none); false of it
/// ends the walk. Errors in the file are printed on `err`; a hundred such lines end it; then what was left out.
/// Exit code: 0, 1 when the file is not whole or nothing of it was read, 2 when it cannot be opened.
int walk_trace(const std::string& path, text::Output& err,
               const std::function<bool(const TraceRecord&, std::string_view channel)>& record);

}  // namespace canopus::trace
