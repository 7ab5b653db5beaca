#include "canopus/app/run_recording.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>

namespace canopus::app {

void TraceWriter::frame_completed(const can::Frame& frame, can::Time /*start*/, can::Time end) {
  file_.write(bus_, frame, end);
}

VcdFile::VcdFile(std::string path, sim::Bus& bus)
    : path_(std::move(path)), file_(std::fopen(path_.c_str(), "w")) {
  if (file_ == nullptr) {
    error_ = errno;
    return;
  }
  waveform_.emplace(bus, can::Time{}, [this](std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size() && error_ == 0) error_ = errno;
  });
}

VcdFile::~VcdFile() { (void)close({}); }

std::string VcdFile::error() const {
  return error_ == 0 ? std::string() : fmt::format("cannot write {}: {}", path_, std::strerror(error_));
}

std::string VcdFile::close(can::Time now) {
  if (waveform_) waveform_->flush(now);
  waveform_.reset();
  if (file_ != nullptr && std::fclose(file_) != 0 && error_ == 0) error_ = errno;
  file_ = nullptr;
  return error();
}

}  // namespace canopus::app
