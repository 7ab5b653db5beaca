#include "canopus/trace/file/trace_file.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

namespace canopus::trace {
namespace {

constexpr std::size_t buffer_size = 65536;

}  // namespace

std::expected<TraceFile, std::string> TraceFile::create(const std::string& path, FileFormat format,
                                                        TrcVersion trc_version) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) {
    return std::unexpected(path + ": cannot create the trace: " + std::generic_category().message(errno));
  }
  return TraceFile(path, TraceEncoder(format, trc_version), file, {});
}

TraceFile TraceFile::to(std::string path, FileFormat format, Writer writer) {
  return {std::move(path), TraceEncoder(format), nullptr, std::move(writer)};
}

TraceFile::TraceFile(std::string path, TraceEncoder encoder, std::FILE* file, Writer writer)
    : path_(std::move(path)), encoder_(std::move(encoder)), file_(file), writer_(std::move(writer)) {
  if (file != nullptr) {
    buffer_ = std::make_unique<char[]>(buffer_size);
    (void)std::setvbuf(file, buffer_.get(), _IOFBF, buffer_size);
  }
  put(encoder_.begin());
}

TraceFile::~TraceFile() = default;

void TraceFile::put(std::string_view bytes) noexcept {
  if (error_ != 0 || bytes.empty()) return;
  if (writer_) {
    error_ = writer_(bytes.data(), bytes.size());
    return;
  }
  if (file_ == nullptr) return;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size())
    error_ = errno != 0 ? errno : EIO;
}

void TraceFile::write(std::string_view channel, const can::Frame& frame, can::Time time) noexcept {
  write(channel, TraceRecord{.time = time, .frame = frame});
}

void TraceFile::write(std::string_view channel, const TraceRecord& record) noexcept {
  put(encoder_.encode(channel, record));
}

void TraceFile::flush() noexcept {
  if (error_ == 0 && file_ != nullptr && std::fflush(file_.get()) != 0) error_ = errno != 0 ? errno : EIO;
}

std::expected<void, std::string> TraceFile::close() {
  put(encoder_.end());
  flush();
  if (file_ != nullptr && std::fclose(file_.release()) != 0 && error_ == 0) error_ = errno != 0 ? errno : EIO;
  if (error_ == 0) return {};
  return std::unexpected(path_ + ": the trace is not complete: " + std::generic_category().message(error_));
}

}  // namespace canopus::trace
