#pragma once
// Traces of other programs and of our own, read record by record.

#include <cstddef>
#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "canopus/trace/file/file_format.hpp"
#include "canopus/trace/file/left_out.hpp"
#include "canopus/trace/file/trace_input.hpp"
#include "canopus/trace/file/trace_record.hpp"

namespace canopus::trace {

/// Reads one trace from its begin to its end, in constant memory.
class TraceReader {
 public:
  virtual ~TraceReader() = default;
  /// The next record; nothing at the end of the file. An error names file and line (or offset) and what was
  /// expected; the next call continues after it where the format allows that, else it returns the end of the
  /// file.
  [[nodiscard]] virtual std::expected<std::optional<TraceRecord>, std::string> next() = 0;
  [[nodiscard]] virtual FileFormat format() const noexcept = 0;
  /// Channels named so far.
  [[nodiscard]] virtual std::size_t channel_count() const noexcept = 0;
  [[nodiscard]] virtual std::string_view channel(std::size_t number) const noexcept = 0;
  /// Records that hold no classical CAN frame and were left out so far, and what the recorder lost.
  [[nodiscard]] virtual const LeftOut& left_out() const noexcept = 0;
};

/// Opens a file ("-" is the standard input). Without a format it is found from the content, not from the name: a pipe is
/// waited for. `keep_reading`: as TraceInput::open() has it; a trace that it ends at once has no records.
[[nodiscard]] std::expected<std::unique_ptr<TraceReader>, std::string> open_trace(
    const std::string& path, std::optional<FileFormat> format = std::nullopt, KeepReading keep_reading = {});

}  // namespace canopus::trace
