#include "canopus/cli/run/run_recording.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "canopus/can/error_frame.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/text/file_name.hpp"

namespace canopus::cli {

std::expected<std::unique_ptr<RecordingStream>, std::string> RecordingStream::open(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode)) return nullptr;
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return std::unexpected(fmt::format("cannot write {}: {}", path, std::strerror(errno)));
  return std::unique_ptr<RecordingStream>(new RecordingStream(path, descriptor));
}

RecordingStream::RecordingStream(std::string path, int descriptor)
    : path_(std::move(path)), descriptor_(descriptor), queue_(descriptor, {}) {}

RecordingStream::~RecordingStream() { (void)close({}); }

int RecordingStream::write(std::string_view bytes) {
  queue_.content(bytes);
  return queue_.error();
}

std::string RecordingStream::close(const OutputQueue::Patience& patience) {
  if (descriptor_ < 0) return {};
  const bool is_complete = queue_.finish(patience) == 0 && !is_incomplete();
  (void)::close(std::exchange(descriptor_, -1));
  if (const int error = queue_.error(); error != 0) {
    return fmt::format("{}: the recording is not complete: {}", path_, std::strerror(error));
  }
  return is_complete ? "" : fmt::format("{}: the recording is not complete: its reader was too slow", path_);
}

TraceWriter::TraceWriter(trace::TraceFile& file, const can::Bus& bus, const can::Timeline& timeline)
    : file_(file),
      bus_(bus.name()),
      linked_(dynamic_cast<const link::LinkedBus*>(&bus)),
      timeline_(timeline) {}

void TraceWriter::frame_completed(const can::Frame& frame, can::Time /*start*/, can::Time end) {
  write({.time = linked_ != nullptr ? linked_->stamp() : end, .frame = frame});
}

void TraceWriter::errors_reported(std::span<const can::BusErrorReport> reports, can::Time now) {
  if (!reports.front().first) return;
  write({.time = now, .error_frame = true, .frame = can::error_frame(can::recorded_of(reports))});
}

void TraceWriter::controller_changed(const can::ControllerReport& report, can::Time now) {
  write({.time = now, .error_frame = true, .frame = can::error_frame(report)});
}

void TraceWriter::write(const trace::TraceRecord& record) {
  if (timeline_.runs_alone()) {
    held_.push_back({timeline_.stamp(), record});
  } else {
    file_.write(bus_, record);
  }
}

void TraceWriter::release(std::span<const std::unique_ptr<TraceWriter>> writers) {
  struct Next {
    can::TickStamp stamp;
    TraceWriter* writer;
    std::size_t number;
  };
  const auto is_later = [](const Next& one, const Next& other) { return other.stamp < one.stamp; };
  std::vector<Next> heap;  // first in front
  for (const auto& writer : writers) {
    if (!writer->held_.empty()) heap.push_back({writer->held_.front().stamp, writer.get(), 0});
  }
  std::ranges::make_heap(heap, is_later);
  while (!heap.empty()) {
    std::ranges::pop_heap(heap, is_later);
    Next& next = heap.back();
    std::vector<Held>& held = next.writer->held_;
    next.writer->file_.write(next.writer->bus_, held[next.number].record);
    if (++next.number < held.size()) {
      next.stamp = held[next.number].stamp;
      std::ranges::push_heap(heap, is_later);
    } else {
      held.clear();
      heap.pop_back();
    }
  }
}

std::string vcd_path_of(std::string_view path, std::string_view bus) {
  const std::string_view suffix = path.ends_with(".vcd") ? ".vcd" : "";
  const std::string_view stem = path.substr(0, path.size() - suffix.size());
  return fmt::format("{}-{}{}", stem, text::file_name_of(bus), suffix);
}

VcdFile::VcdFile(std::string path, sim::Bus& bus, const can::Timeline& timeline, can::Duration grid)
    : path_(std::move(path)), timeline_(timeline) {
  auto stream = RecordingStream::open(path_);
  if (!stream) {
    error_ = stream.error();
    return;
  }
  stream_ = std::move(*stream);
  if (stream_ == nullptr) file_ = std::fopen(path_.c_str(), "w");
  if (stream_ == nullptr && file_ == nullptr) {
    fail(errno);
    return;
  }
  waveform_.emplace(
      bus, can::Time{}, [this](std::string_view text) { write(text); }, grid);
}

VcdFile::~VcdFile() { (void)close({}, {}); }

void VcdFile::set_patience(const OutputQueue::Patience& patience) {
  if (stream_ != nullptr) stream_->set_patience(patience);
}

void VcdFile::fail(int reason) {
  if (error_.empty()) error_ = fmt::format("cannot write {}: {}", path_, std::strerror(reason));
}

void VcdFile::write(std::string_view text) {
  if (stream_ == nullptr) {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail(errno);
  } else if (timeline_.runs_alone()) {
    held_ += text;
  } else if (!stream_->is_incomplete()) {  // a waveform with a hole would show edges that never were
    (void)stream_->write(text);
  }
}

void VcdFile::release() {
  if (!held_.empty() && !stream_->is_incomplete()) (void)stream_->write(held_);
  held_.clear();
}

std::string VcdFile::close(can::Time now, const OutputQueue::Patience& patience) {
  if (waveform_) waveform_->flush(now);
  waveform_.reset();
  if (file_ != nullptr && std::fclose(file_) != 0) fail(errno);
  file_ = nullptr;
  if (stream_ != nullptr && error_.empty()) error_ = stream_->close(patience);
  stream_.reset();
  return error_;
}

std::expected<void, std::string> RunRecording::open_trace(const std::string& path, plant::Plant& plant) {
  if (path.empty()) return {};
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    const std::string& replay = plant.bus_section(i).replay;
    std::error_code unknown;
    if (!replay.empty() &&
        std::filesystem::equivalent(std::filesystem::path(plant.file().path).parent_path() / replay, path,
                                    unknown)) {
      return std::unexpected(fmt::format("--trace {}: bus \"{}\" plays it back; it would be overwritten",
                                         path, plant.bus(i).name()));
    }
  }
  const auto format = trace::trace_format_of(path);
  if (!format) return std::unexpected(format.error());
  auto stream = RecordingStream::open(path);
  if (!stream) return std::unexpected(stream.error());
  trace_stream_ = std::move(*stream);
  if (trace_stream_ != nullptr) {
    trace_.emplace(trace::TraceFile::to(path, *format, [this](const void* bytes, std::size_t size) {
      return trace_stream_->write({static_cast<const char*>(bytes), size});
    }));
  } else {
    auto file = trace::TraceFile::create(path, *format);
    if (!file) return std::unexpected(file.error());
    trace_.emplace(std::move(*file));
  }
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    trace_writers_.push_back(std::make_unique<TraceWriter>(*trace_, plant.bus(i), plant.timeline_of_bus(i)));
    plant.bus(i).add_observer(*trace_writers_.back());
  }
  return {};
}

std::expected<void, std::string> RunRecording::open_vcd(const std::string& path, plant::Plant& plant,
                                                        can::Duration grid) {
  if (path.empty()) return {};
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    if (plant.simulated_bus(i) == nullptr) {
      return std::unexpected(
          fmt::format("--vcd: bus \"{}\" is not simulated; its wire cannot be seen", plant.bus(i).name()));
    }
    sim::Bus& bus = *plant.simulated_bus(i);
    const std::string of_bus = plant.bus_count() == 1 ? path : vcd_path_of(path, bus.name());
    vcd_.push_back(std::make_unique<VcdFile>(of_bus, bus, plant.timeline_of_bus(i), grid));
    if (std::string problem = vcd_.back()->error(); !problem.empty()) {
      return std::unexpected(std::move(problem));
    }
  }
  return {};
}

std::expected<void, std::string> RunRecording::open_svg(const std::string& path, plant::Plant& plant) {
  if (path.empty()) return {};
  auto picture = LiftPictureFile::open(path, plant);
  if (!picture) return std::unexpected(picture.error());
  picture_ = std::move(*picture);
  return {};
}

void RunRecording::set_patience(const OutputQueue::Patience& patience) {
  if (trace_stream_ != nullptr) trace_stream_->set_patience(patience);
  for (const auto& vcd : vcd_) vcd->set_patience(patience);
}

void RunRecording::parts_met() {
  TraceWriter::release(trace_writers_);
  for (const auto& vcd : vcd_) vcd->release();
}

std::vector<std::string> RunRecording::close(can::Time now, const OutputQueue::Patience& patience) {
  std::vector<std::string> problems;
  for (const auto& vcd : vcd_) problems.push_back(vcd->close(now, patience));
  if (trace_) {
    const auto closed = trace_->close();
    if (!closed) problems.push_back(closed.error());
    if (closed && trace_stream_ != nullptr) problems.push_back(trace_stream_->close(patience));
  }
  if (picture_) problems.push_back(picture_->close(now));
  std::erase(problems, "");
  return problems;
}

}  // namespace canopus::cli
