#pragma once
// A file that records the frames of a run: as candump log, or as pcap (link type 227, CAN over SocketCAN)
// with nanosecond time stamps. Writing never fails in the middle of a run: the first error is kept, the rest
// is dropped, and close() returns it.

#include <array>
#include <cstdint>
#include <cstdio>
#include <expected>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"

namespace canopus::trace {

enum class TraceFormat : std::uint8_t { candump, pcap };

/// By the name: ".pcap" is pcap; ".log", ".candump", ".txt", a number (run.1) or no extension candump. The error
/// says which formats are written.
[[nodiscard]] std::expected<TraceFormat, std::string> trace_format_of(std::string_view path);

/// Octets of the header of a pcap file, and of one record in it.
inline constexpr std::size_t pcap_header_size = 24;
inline constexpr std::size_t pcap_max_record = 16 + 16;

/// The header a pcap file of CAN frames starts with [tcpdump.org LINKTYPE_CAN_SOCKETCAN]; host byte order.
[[nodiscard]] std::array<std::uint8_t, pcap_header_size> pcap_header() noexcept;
/// Writes one record and returns its length. A pcap has no name of a channel.
std::size_t write_pcap_record(std::span<std::uint8_t, pcap_max_record> out, const can::Frame& frame,
                              can::Time time) noexcept;

class TraceFile {
 public:
  /// Creates or empties the file. The error names it and says what the system said.
  [[nodiscard]] static std::expected<TraceFile, std::string> create(const std::string& path,
                                                                    TraceFormat format);
  /// Hands the header and each record, whole, to `writer`, which returns 0 or an errno. `path` is for errors.
  using Writer = std::function<int(const void* bytes, std::size_t size)>;
  [[nodiscard]] static TraceFile to(std::string path, TraceFormat format, Writer writer);
  TraceFile(TraceFile&&) noexcept = default;
  TraceFile& operator=(TraceFile&&) = delete;
  ~TraceFile();

  void write(std::string_view channel, const can::Frame& frame, can::Time time) noexcept;
  /// Hands everything written so far to the system, so that another program can read it.
  void flush() noexcept;
  /// Flushes and closes. The first error of all writes since create(), if there was one.
  [[nodiscard]] std::expected<void, std::string> close();

 private:
  struct Closer {
    void operator()(std::FILE* file) const noexcept { (void)std::fclose(file); }
  };
  TraceFile(std::string path, TraceFormat format, std::FILE* file, Writer writer);
  void put(const void* bytes, std::size_t size) noexcept;

  std::string path_;
  TraceFormat format_;
  std::unique_ptr<char[]> buffer_;  // of file_, so it is declared before it
  std::unique_ptr<std::FILE, Closer> file_;
  Writer writer_;  // in place of a file
  int error_ = 0;  // errno of the first failure
};

}  // namespace canopus::trace
