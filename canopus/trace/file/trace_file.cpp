#include "canopus/trace/file/trace_file.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "canopus/trace/file/candump_log.hpp"

namespace canopus::trace {
namespace {

constexpr std::size_t buffer_size = 65536;
constexpr std::uint32_t pcap_nanosecond_magic = 0xA1B2'3C4D;
constexpr std::uint32_t linktype_can_socketcan = 227;
constexpr std::uint32_t extended_flag = 0x8000'0000;
constexpr std::uint32_t remote_flag = 0x4000'0000;

/// A pcap says by its magic number which byte order it is in: the host's.
template <typename T>
std::uint8_t* put_host(std::uint8_t* out, T value) noexcept {
  const auto bytes = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
  return std::ranges::copy(bytes, out).out;
}

}  // namespace

std::expected<TraceFormat, std::string> trace_format_of(std::string_view path) {
  const std::string_view name = path.substr(path.rfind('/') + 1);
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || dot == 0) return TraceFormat::candump;
  std::string extension(name.substr(dot + 1));
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  if (extension == "pcap") return TraceFormat::pcap;
  const bool number = extension.find_first_not_of("0123456789") == std::string::npos;
  if (number || extension == "log" || extension == "candump" || extension == "txt")
    return TraceFormat::candump;
  const std::string_view hint = extension == "asc" ? "; can-utils' log2asc makes an ASC file of a candump log"
                                : extension == "pcapng" ? "; Wireshark reads pcap as well"
                                : extension == "vcd"    ? "; --vcd records the wire as a waveform"
                                                        : "";
  return std::unexpected(std::string(path) +
                         ": traces are written as pcap (name.pcap) or as candump log (name.log, or "
                         "a name without extension), not as ." +
                         extension + std::string(hint));
}

std::array<std::uint8_t, pcap_header_size> pcap_header() noexcept {
  std::array<std::uint8_t, pcap_header_size> header{};
  std::uint8_t* p = put_host(header.data(), pcap_nanosecond_magic);
  p = put_host<std::uint16_t>(p, 2);  // version 2.4
  p = put_host<std::uint16_t>(p, 4);
  p += 8;                                 // time zone and accuracy: always 0
  p = put_host<std::uint32_t>(p, 65535);  // longest record
  put_host(p, linktype_can_socketcan);
  return header;
}

std::size_t write_pcap_record(std::span<std::uint8_t, pcap_max_record> out, const can::Frame& frame,
                              can::Time time) noexcept {
  const auto length = static_cast<std::uint8_t>(frame.length());
  const auto nanoseconds =
      static_cast<std::uint64_t>(std::max<std::int64_t>(0, time.time_since_epoch().count()));
  const std::uint32_t size = 8U + length;
  std::uint8_t* p = put_host(out.data(), static_cast<std::uint32_t>(nanoseconds / 1'000'000'000));
  p = put_host(p, static_cast<std::uint32_t>(nanoseconds % 1'000'000'000));
  p = put_host(p, size);
  p = put_host(p, size);
  const std::uint32_t identifier =
      frame.identifier | (frame.extended ? extended_flag : 0) | (frame.remote ? remote_flag : 0);
  for (const int shift : {24, 16, 8, 0}) *p++ = static_cast<std::uint8_t>(identifier >> shift);
  // A remote frame has no data but says the length it asks for.
  *p++ = static_cast<std::uint8_t>(std::min<unsigned>(frame.dlc, 8));
  p = std::fill_n(p, 3, std::uint8_t{0});
  p = std::ranges::copy(frame.bytes(), p).out;
  return static_cast<std::size_t>(p - out.data());
}

std::expected<TraceFile, std::string> TraceFile::create(const std::string& path, TraceFormat format) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) {
    return std::unexpected(path + ": cannot create the trace: " + std::generic_category().message(errno));
  }
  return TraceFile(path, format, file, {});
}

TraceFile TraceFile::to(std::string path, TraceFormat format, Writer writer) {
  return {std::move(path), format, nullptr, std::move(writer)};
}

TraceFile::TraceFile(std::string path, TraceFormat format, std::FILE* file, Writer writer)
    : path_(std::move(path)), format_(format), file_(file), writer_(std::move(writer)) {
  if (file != nullptr) {
    buffer_ = std::make_unique<char[]>(buffer_size);
    (void)std::setvbuf(file, buffer_.get(), _IOFBF, buffer_size);
  }
  if (format_ == TraceFormat::pcap) {
    const auto header = pcap_header();
    put(header.data(), header.size());
  }
}

TraceFile::~TraceFile() = default;

void TraceFile::put(const void* bytes, std::size_t size) noexcept {
  if (error_ != 0) return;
  if (writer_) {
    error_ = writer_(bytes, size);
    return;
  }
  if (file_ == nullptr) return;
  if (std::fwrite(bytes, 1, size, file_.get()) != size) error_ = errno != 0 ? errno : EIO;
}

void TraceFile::write(std::string_view channel, const can::Frame& frame, can::Time time) noexcept {
  switch (format_) {
    case TraceFormat::candump: {
      std::array<char, candump_max_line> line;
      put(line.data(), write_candump_line(line, channel, frame, time));
      break;
    }
    case TraceFormat::pcap: {
      std::array<std::uint8_t, pcap_max_record> record;
      put(record.data(), write_pcap_record(record, frame, time));
      break;
    }
  }
}

void TraceFile::flush() noexcept {
  if (error_ == 0 && file_ != nullptr && std::fflush(file_.get()) != 0) error_ = errno != 0 ? errno : EIO;
}

std::expected<void, std::string> TraceFile::close() {
  flush();
  if (file_ != nullptr && std::fclose(file_.release()) != 0 && error_ == 0) error_ = errno != 0 ? errno : EIO;
  if (error_ == 0) return {};
  return std::unexpected(path_ + ": the trace is not complete: " + std::generic_category().message(error_));
}

}  // namespace canopus::trace
