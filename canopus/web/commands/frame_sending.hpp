#pragma once
// Single frames that the page sends on a bus, simulated or real: a client with a port of its own on it, in plant time.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "canopus/can/frame.hpp"
#include "canopus/link/loop_clock.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/serve/client_ports.hpp"
#include "canopus/text/json.hpp"
#include "canopus/web/commands/running_command.hpp"

namespace canopus::web {

/// {"frames": ["601#4018100100000000", "123#R", "18FF1234#00"], "interval": "10ms", "repeat": 2}
struct FrameList {
  static constexpr std::size_t most_frames = 1000;
  static constexpr std::uint64_t most_repeats = 10'000;
  static constexpr std::uint64_t most_sent = 100'000;  ///< in all
  static constexpr can::Duration longest_interval = std::chrono::minutes(1);

  std::vector<can::Frame> frames{};
  can::Duration
      interval{};  ///< from the start of one to the start of the next; 0: one directly after the other
  std::uint64_t repeat = 1;  ///< how often the whole list is sent

  /// Frames as candump writes them: an identifier of 3 digits, or of 8 digits an extended one. The error names the frame and
  /// what was expected.
  [[nodiscard]] static std::expected<FrameList, std::string> parse(const text::Json& wish);
};

class FrameSending {
 public:
  static constexpr std::size_t most_at_once = 4;
  using Done = std::function<void(std::expected<text::Json, std::string>)>;

  /// All must outlive this. `standstill`: as of BusCommands.
  FrameSending(boost::asio::io_context& io, plant::Plant& plant, link::LoopClock& clock,
               std::chrono::milliseconds standstill = std::chrono::milliseconds(500))
      : io_(io), plant_(plant), clock_(clock), standstill_(standstill) {}
  ~FrameSending();
  FrameSending(const FrameSending&) = delete;
  FrameSending& operator=(const FrameSending&) = delete;

  /// {"bus": "line1", and the fields of FrameList}. The row {"bus", "frames", "seconds"} comes when the last frame is on the bus.
  void send(const text::Json& wish, Done done);
  /// Ends all that are under way; those fail. The row {"stopped": 1}.
  [[nodiscard]] text::Json stop();
  /// The bus that the wish names, if it is a real one; else empty.
  [[nodiscard]] std::string live_bus(const text::Json& wish) const;

 private:
  [[nodiscard]] std::expected<std::size_t, std::string> bus_of(const text::Json& wish) const;

  boost::asio::io_context& io_;
  plant::Plant& plant_;
  link::LoopClock& clock_;
  std::chrono::milliseconds standstill_;
  std::map<std::size_t, serve::ClientPorts> ports_;  // by bus
  std::vector<std::weak_ptr<RunningCommand>> started_;
};

}  // namespace canopus::web
