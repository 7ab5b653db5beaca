#pragma once
// The bytes of a trace, read once from the begin to the end with a buffer of limited size: from a file, from a
// pipe, or from memory.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace canopus::trace {

/// Longest line that is read, in bytes; a longer one is no line of a trace.
inline constexpr std::size_t trace_max_line = 16384;

/// Asked before each read from a file, and ten times a second while there is nothing to read; false ends the trace
/// there. `silent`: the name of a named pipe that nothing has been written to, once; else empty.
using KeepReading = std::function<bool(std::string_view silent)>;

class TraceInput {
 public:
  /// The number of bytes put into the span, 0 at the end, or an errno.
  using Source = std::function<std::expected<std::size_t, int>(std::span<char>)>;

  /// "-" is the standard input. The error names the file and has the reason of the system. A named pipe is not waited
  /// for here, but when it is read.
  [[nodiscard]] static std::expected<TraceInput, std::string> open(const std::string& path,
                                                                   KeepReading keep_reading = {});
  [[nodiscard]] static TraceInput from_memory(std::string name, std::string bytes);
  TraceInput(std::string name, Source source) : name_(std::move(name)), source_(std::move(source)) {}

  /// As errors name it.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// Position of the next byte, from 0.
  [[nodiscard]] std::uint64_t offset() const noexcept { return offset_; }
  /// Number of the line that line() returned last, from 1.
  [[nodiscard]] std::size_t line_number() const noexcept { return line_number_; }
  /// Why reading failed, as a message with the name; nothing while it did not. The end of the file is no failure.
  [[nodiscard]] std::optional<std::string> failure() const;

  /// The next bytes, which stay unread: at least `size` unless the file ends before. Valid until the next call.
  [[nodiscard]] std::string_view peek(std::size_t size);
  /// The buffer after one more read from the source; it does not wait for further data. Valid until the next
  /// call.
  [[nodiscard]] std::string_view peek_more();
  /// The contents of the buffer. Valid until the next call.
  [[nodiscard]] std::string_view buffered() const noexcept;
  /// Skips this number of bytes; false if the file ends before.
  bool skip(std::uint64_t size);
  /// The next line without its end (and a carriage return before it); nothing at the end of the file. A line longer
  /// than trace_max_line is cut, and is_cut() is true then. Valid until the next call.
  [[nodiscard]] std::optional<std::string_view> line(char end = '\n');
  [[nodiscard]] bool is_cut() const noexcept { return cut_; }

 private:
  bool fill();

  std::string name_;
  Source source_;
  std::vector<char> buffer_{};
  std::size_t begin_ = 0;  // of what is not read yet
  std::size_t end_ = 0;
  std::uint64_t offset_ = 0;
  std::size_t line_number_ = 0;
  bool cut_ = false;
  bool at_end_ = false;
  int error_ = 0;
};

}  // namespace canopus::trace
