#pragma once
// A trace file read to its end, record by record.

#include <functional>
#include <string>

#include "canopus/text/output.hpp"
#include "canopus/trace/file/trace_reader.hpp"

namespace canopus::trace {

/// Hands every record to `record`, with the name of its channel (empty: the file names none); false of it
/// ends the walk. Errors in the file are printed on `err`; a hundred such lines end it. Exit code: 0, 1 when
/// the file is not whole, 2 when it cannot be opened.
int walk_trace(const std::string& path, text::Output& err,
               const std::function<bool(const TraceRecord&, std::string_view channel)>& record);

}  // namespace canopus::trace
