#pragma once
// A trace as a bus: its frames come at their times; frames that a plant sends there are accepted, and no
// other node receives them.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <string>

#include "canopus/can/timeline.hpp"
#include "canopus/link/bus_client.hpp"
#include "canopus/trace/file/trace_reader.hpp"

namespace canopus::serve {

/// Reads the trace as it goes, in constant memory. Time 0 of the run is that of the first frame.
class ReplayBus final : public link::BusClient, public can::Ticker {
 public:
  /// `path` and `keep_reading` as open_trace() takes them; `channel`: of its channels this one alone, empty: all. Errors are sentences.
  [[nodiscard]] static std::expected<std::unique_ptr<ReplayBus>, std::string> open(
      const std::string& path, std::string channel, can::Timeline& timeline,
      trace::KeepReading keep_reading = {});
  ReplayBus(const ReplayBus&) = delete;
  ReplayBus& operator=(const ReplayBus&) = delete;

  bool send(const can::Frame& frame) override;
  void set_user(link::BusClientListener* user) override { user_ = user; }
  bool close(std::chrono::milliseconds) override { return true; }

  void tick(can::Time now) override;

 private:
  ReplayBus(std::unique_ptr<trace::TraceReader> reader, std::string channel, can::Timeline& timeline);
  /// At once if there is something to report to the user.
  void set_alarm() { alarm() = sent_count_ > 0 || !mistake_.empty() ? timeline_.now() : at_; }
  /// Reads up to the next frame; error frames are left out. After many that the filter rejects it leaves the
  /// rest to the next tick, a millisecond later: a plant that reads a stream without end goes on all the
  /// same.
  void read_next();
  [[nodiscard]] bool wants(const trace::TraceRecord& record) const;

  std::unique_ptr<trace::TraceReader> reader_;
  std::string channel_;
  can::Timeline& timeline_;
  link::BusClientListener* user_ = nullptr;
  std::optional<trace::TraceRecord> next_;
  std::optional<can::Time> zero_;  // of the trace
  can::Time at_ = can::never;      // of next_, in the run, or when to read on
  std::array<can::Frame, 16> sent_{};
  std::size_t sent_count_ = 0;
  std::size_t mistakes_ = 0;  // of the file so far
  std::string mistake_;       // to report: the first one, and at the end their number
};

}  // namespace canopus::serve
