#pragma once
// The simulated CAN bus: frames occupy it for their exact number of bits, the lowest identifier wins
// arbitration, and every controller on it has its own bit rate, queues and error counters. Time is virtual:
// the bus is a Participant of the timeline that its nodes live on, so the same code runs as fast as possible
// or in step with a clock.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "canopus/can/controller.hpp"
#include "canopus/can/timeline.hpp"

namespace canopus::sim {

class Bus;

/// What a bus did, for traces and statistics. Called for every frame that was completed on the bus.
class BusObserver {
 public:
  virtual void frame_completed(const can::Frame& frame, can::Time start, can::Time end) = 0;

 protected:
  ~BusObserver() = default;
};

/// A controller plugged into the bus, and the participant behind it.
class Port : public can::Controller {
 public:
  /// The participant that hears this port. Its deadline is refreshed in the timeline after every call.
  virtual void connect(can::Participant& participant, can::Timeline::Handle handle) = 0;
  virtual void plug(bool plugged) = 0;  ///< unplugged: hears nothing, its frames wait
};

/// How busy a bus is.
struct BusLoad {
  std::uint64_t frames = 0;
  std::uint64_t bits = 0;  ///< on the wire, interframe space included
  double now = 0;          ///< share of the last full second that was busy, 0..1
  double peak = 0;         ///< highest `now` so far
};

class Bus final : public can::Participant {
 public:
  /// bit_rate in bit/s. Adds itself to the timeline, which must outlive the bus.
  Bus(std::string name, std::uint32_t bit_rate, can::Timeline& timeline);
  ~Bus() override;
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  [[nodiscard]] const std::string& name() const noexcept;
  [[nodiscard]] std::uint32_t bit_rate() const noexcept;
  /// Adds a controller; it belongs to the bus and lives as long.
  Port& add_port(std::string name);
  void set_observer(BusObserver* observer);
  [[nodiscard]] BusLoad load(can::Time now) const;

  void receive(const can::Frame&, can::Time) override {}
  void tick(can::Time now) override;
  [[nodiscard]] can::Time deadline() const noexcept override;

 private:
  struct Wire;
  std::unique_ptr<Wire> wire_;
};

}  // namespace canopus::sim
