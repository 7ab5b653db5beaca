#pragma once
// A file that records frames, in any format that is written. Writing never fails in the middle of a run: the first
// error is kept, the rest is dropped, and close() returns it.

#include <cstdint>
#include <cstdio>
#include <expected>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/trace/file/file_format.hpp"
#include "canopus/trace/file/trace_encoder.hpp"
#include "canopus/trace/file/trace_record.hpp"

namespace canopus::trace {

class TraceFile {
 public:
  /// Creates or empties the file. The error names it and has the reason of the system.
  [[nodiscard]] static std::expected<TraceFile, std::string> create(
      const std::string& path, FileFormat format, TrcVersion trc_version = TrcVersion::v2_1);
  /// Hands the header and each record, whole, to `writer`, which returns 0 or an errno. `path` is for errors.
  using Writer = std::function<int(const void* bytes, std::size_t size)>;
  [[nodiscard]] static TraceFile to(std::string path, FileFormat format, Writer writer);
  TraceFile(TraceFile&&) noexcept = default;
  TraceFile& operator=(TraceFile&&) = delete;
  ~TraceFile();

  void write(std::string_view channel, const can::Frame& frame, can::Time time) noexcept;
  /// A record of another trace; record.channel is ignored.
  void write(std::string_view channel, const TraceRecord& record) noexcept;
  /// Hands everything written so far to the system, so that another program can read it.
  void flush() noexcept;
  /// Flushes and closes. The first error of all writes since create(), if there was one.
  [[nodiscard]] std::expected<void, std::string> close();

 private:
  struct Closer {
    void operator()(std::FILE* file) const noexcept { (void)std::fclose(file); }
  };
  TraceFile(std::string path, TraceEncoder encoder, std::FILE* file, Writer writer);
  void put(std::string_view bytes) noexcept;

  std::string path_;
  TraceEncoder encoder_;
  std::unique_ptr<char[]> buffer_;  // of file_, so it is declared before it
  std::unique_ptr<std::FILE, Closer> file_;
  Writer writer_;  // in place of a file
  int error_ = 0;  // errno of the first failure
};

}  // namespace canopus::trace
