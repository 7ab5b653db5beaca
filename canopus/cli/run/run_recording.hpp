#pragma once
// The recordings of a run beside its output: every frame of its buses in one trace file, and the wire of each
// bus as a waveform. Regular files are written at once. A file with a reader (a FIFO, a pipe, /dev/stdout)
// gets its own queue: in real time the plant does not wait for it.

#include <cstdio>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/cli/output/output_queue.hpp"
#include "canopus/cli/run/lift_picture.hpp"
#include "canopus/link/linked_bus.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/sim/bus/waveform/waveform.hpp"
#include "canopus/trace/file/trace_file.hpp"

namespace canopus::cli {

/// A target of a recording that is no regular file, so that its reader may be slow or gone.
class RecordingStream {
 public:
  /// Nothing if `path` is, or will be, a regular file. Waits for the reader of a FIFO.
  [[nodiscard]] static std::expected<std::unique_ptr<RecordingStream>, std::string> open(
      const std::string& path);
  ~RecordingStream();
  RecordingStream(const RecordingStream&) = delete;
  RecordingStream& operator=(const RecordingStream&) = delete;

  /// Without a patience what the reader does not take in time is left out.
  void set_patience(const OutputQueue::Patience& patience) { queue_.set_patience(patience); }
  /// 0, or the errno of an earlier write.
  int write(std::string_view bytes);
  /// Something was left out.
  [[nodiscard]] bool is_incomplete() const { return queue_.lost() != 0; }
  /// Empty, or what went wrong since the start.
  [[nodiscard]] std::string close(const OutputQueue::Patience& patience);

 private:
  RecordingStream(std::string path, int descriptor);
  std::string path_;
  int descriptor_;
  OutputQueue queue_;
};

/// Every frame of a bus into the trace file, with the time stamps of the kernel where the bus has them; SocketCAN error
/// frames for its errors, one for each error frame of the bus, and for each new state of a controller.
class TraceWriter final : public can::BusObserver {
 public:
  /// While the timeline, that of the bus, runs apart from others, records are held back.
  TraceWriter(trace::TraceFile& file, const can::Bus& bus, const can::Timeline& timeline);
  /// Writes what they have held back, in the order of all.
  static void release(std::span<const std::unique_ptr<TraceWriter>> writers);
  void frame_completed(const can::Frame& frame, can::Time start, can::Time end) override;
  void errors_reported(std::span<const can::BusErrorReport> reports, can::Time now) override;
  void controller_changed(const can::ControllerReport& report, can::Time now) override;

 private:
  struct Held {
    can::TickStamp stamp;
    trace::TraceRecord record;
  };
  void write(const trace::TraceRecord& record);

  trace::TraceFile& file_;
  const std::string& bus_;
  const link::LinkedBus* linked_;  // null: simulated
  const can::Timeline& timeline_;
  std::vector<Held> held_;
};

/// The path of the waveform of one of several buses: "wire.vcd" becomes "wire-line1.vcd". file_name_of()
/// converts a name that is not valid for a file, so that it never leads out of the folder.
[[nodiscard]] std::string vcd_path_of(std::string_view path, std::string_view bus);

/// The wire of one bus as a VCD file. The first error is kept and returned by close().
class VcdFile {
 public:
  /// The timeline is that of the bus; `grid` as sim::Waveform has it.
  VcdFile(std::string path, sim::Bus& bus, const can::Timeline& timeline, can::Duration grid);
  ~VcdFile();
  VcdFile(const VcdFile&) = delete;
  VcdFile& operator=(const VcdFile&) = delete;

  void set_patience(const OutputQueue::Patience& patience);
  /// The bus may run on another thread, up to the next release(): a reader's patience must not be asked there.
  void release();
  [[nodiscard]] std::string error() const { return error_; }
  /// Empty, or what went wrong since the start.
  std::string close(can::Time now, const OutputQueue::Patience& patience);

 private:
  void write(std::string_view text);
  void fail(int reason);

  std::string path_;
  std::unique_ptr<RecordingStream> stream_;  // or a file
  std::FILE* file_ = nullptr;
  std::string error_;
  const can::Timeline& timeline_;
  std::string held_;  // for the stream
  std::optional<sim::Waveform> waveform_;
};

/// All that one run records.
class RunRecording {
 public:
  /// Every frame of the plant's buses in this file; no path: none. The error is a sentence.
  [[nodiscard]] std::expected<void, std::string> open_trace(const std::string& path, plant::Plant& plant);
  /// The wire of each bus, with several buses in one file each. All external actions on the plant come at
  /// multiples of `grid`.
  [[nodiscard]] std::expected<void, std::string> open_vcd(const std::string& path, plant::Plant& plant,
                                                          can::Duration grid = std::chrono::microseconds(1));
  /// A picture of the lifts, written at the end; no path: none.
  [[nodiscard]] std::expected<void, std::string> open_svg(const std::string& path, plant::Plant& plant);
  void set_patience(const OutputQueue::Patience& patience);
  /// Parts of the plant have run apart and met (plant::Plant::parts_met).
  void parts_met();
  /// The errors since the start, a sentence each.
  [[nodiscard]] std::vector<std::string> close(can::Time now, const OutputQueue::Patience& patience);

 private:
  std::unique_ptr<RecordingStream> trace_stream_;  // before the trace, if it is no regular file
  std::optional<trace::TraceFile> trace_;
  std::vector<std::unique_ptr<TraceWriter>> trace_writers_;
  std::vector<std::unique_ptr<VcdFile>> vcd_;
  std::unique_ptr<LiftPictureFile> picture_;
};

}  // namespace canopus::cli
