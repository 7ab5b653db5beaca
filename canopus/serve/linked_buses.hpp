#pragma once
// The buses of a plant that are not simulated: those of this machine's hardware and of other programs, and traces that
// are played back.

#include <chrono>
#include <expected>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "canopus/link/linked_bus.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/trace/file/trace_input.hpp"

namespace canopus::serve {

/// Opens them when the plant is built, and starts them when it runs.
class LinkedBuses final : public plant::BusOpener {
 public:
  /// `plant_path` is what paths of traces are relative to. In virtual time only traces can be opened: a plant that runs ahead
  /// of the clock cannot wait for the frames of a real bus.
  /// `keep_reading`: for traces, as open_trace() has it; called by the thread that the bus is ticked on.
  LinkedBuses(boost::asio::io_context& io, const std::string& plant_path, bool virtual_time,
              trace::KeepReading keep_reading = {});
  ~LinkedBuses();
  LinkedBuses(const LinkedBuses&) = delete;
  LinkedBuses& operator=(const LinkedBuses&) = delete;

  std::expected<std::unique_ptr<can::Bus>, std::string> open(const plant::BusSection& section,
                                                             can::Timeline& timeline) override;
  /// Frames come and go from now on. `clock` is null in virtual time.
  void start(link::LoopClock* clock, plant::Plant& plant);
  /// There are none.
  [[nodiscard]] bool empty() const noexcept { return buses_.empty(); }
  /// Gives what the plant has sent `time_out` to get out. The plant must still be there.
  void close(std::chrono::milliseconds time_out);

 private:
  boost::asio::io_context& io_;
  std::filesystem::path folder_;
  bool virtual_time_;
  trace::KeepReading keep_reading_;
  std::vector<link::LinkedBus*> buses_;  // they belong to the plant
};

}  // namespace canopus::serve
