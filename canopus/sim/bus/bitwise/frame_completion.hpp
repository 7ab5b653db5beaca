#pragma once
// The ends of frames on a wire that works bit by bit: ports whose frame is complete with their present bit, and what follows
// when that bit ends.

#include <vector>

#include "canopus/sim/bus/wire/wire.hpp"

namespace canopus::sim {

class FrameCompletion {
 public:
  explicit FrameCompletion(WireState& wire) noexcept : wire_(wire) {}

  /// What the port's controller found at its sample point: it may have received or transmitted a frame with this bit.
  void note(BusPort& port, const BitController::Events& events) noexcept {
    is_due_ = is_due_ || events.received || events.transmitted;
    port.phase.received = port.phase.received || events.received;
    port.phase.transmitted = port.phase.transmitted || events.transmitted;
  }
  /// The port has come from another wire, perhaps with a frame that is complete with its present bit.
  void move_in(BusPort& port, const WireState& from) noexcept;
  /// Some frame is complete with the present bit of some port.
  [[nodiscard]] bool is_due() const noexcept { return is_due_; }
  /// Reports, delivers and confirms frames whose last bit ends now.
  void run(can::Time now) {
    if (is_due_) complete(now);
  }

 private:
  void complete(can::Time now);
  void report(can::Time now);
  void report_arbitration(const can::Frame& frame, can::Time start);
  void deliver(can::Time now);

  WireState& wire_;
  bool is_due_ = false;                     // some frame ends with the present bit
  can::Frame reported_{};                   // last ...
  can::Time reported_at_{};                 // ... at this moment
  std::vector<WireFrame::Sender> senders_;  // of it
};

}  // namespace canopus::sim
