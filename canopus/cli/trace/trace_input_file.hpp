#pragma once
// A trace as the commands read it: opened with or without --in-format, its mistakes printed, but not all of thousands.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "canopus/cli/output/print.hpp"
#include "canopus/trace/file/trace_reader.hpp"

namespace canopus::cli {

class Command;

/// `option` (--in-format, --out-format): the name of a format; empty is none. Formats that are not written only where they are read.
void add_format_option(Command& command, const std::string& option, std::string& name,
                       const std::string& help, bool read);

class TraceInputFile {
 public:
  /// Nothing after the reason was printed on `err`. `format`: as --in-format has it, or empty. `goes_on`: asked before each
  /// read and while a pipe has nothing; false ends the trace.
  [[nodiscard]] static std::optional<TraceInputFile> open(
      const std::string& path, const std::string& format, Output& err,
      std::function<bool()> goes_on = [] { return true; });

  /// The next record; nothing at the end. Mistakes on the way are printed.
  [[nodiscard]] std::optional<trace::TraceRecord> next();
  [[nodiscard]] const trace::TraceReader& reader() const noexcept { return *reader_; }
  /// Records that could not be read.
  [[nodiscard]] std::uint64_t mistakes() const noexcept { return mistakes_; }
  /// Prints the number of mistakes and what was left out. False if nothing of the file was read though there is
  /// something in it, which is printed, too.
  [[nodiscard]] bool finish();

 private:
  TraceInputFile(std::unique_ptr<trace::TraceReader> reader, std::string path, Output& err)
      : reader_(std::move(reader)), path_(std::move(path)), err_(&err) {}
  std::unique_ptr<trace::TraceReader> reader_;
  std::string path_;
  Output* err_;
  std::uint64_t records_ = 0;
  std::uint64_t mistakes_ = 0;
};

/// "12.000345000": seconds with nine decimals.
[[nodiscard]] std::string seconds_text(can::Duration time);
/// "line1  601   [2]  40 18", as candump shows a frame.
[[nodiscard]] std::string frame_text(std::string_view channel, const trace::TraceRecord& record);

}  // namespace canopus::cli
