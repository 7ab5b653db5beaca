#pragma once
// What a run records beside its output: every frame of its buses in one trace file, and the wire of each bus
// as a waveform.

#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "canopus/link/trace_file.hpp"
#include "canopus/sim/bus.hpp"
#include "canopus/sim/waveform.hpp"

namespace canopus::app {

/// Every frame of a bus into the trace file.
class TraceWriter final : public sim::BusObserver {
 public:
  TraceWriter(link::TraceFile& file, const std::string& bus) : file_(file), bus_(bus) {}
  void frame_completed(const can::Frame& frame, can::Time start, can::Time end) override;

 private:
  link::TraceFile& file_;
  const std::string& bus_;
};

/// The wire of one bus as a VCD file. The first error is kept and told by close().
class VcdFile {
 public:
  VcdFile(std::string path, sim::Bus& bus);
  ~VcdFile();
  VcdFile(const VcdFile&) = delete;
  VcdFile& operator=(const VcdFile&) = delete;

  [[nodiscard]] std::string error() const;
  /// Empty, or what went wrong since the start.
  std::string close(can::Time now);

 private:
  std::string path_;
  std::FILE* file_;
  int error_ = 0;
  std::optional<sim::Waveform> waveform_;
};

}  // namespace canopus::app
