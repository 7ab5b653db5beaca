#pragma once
// A wire in whole frames, the quick way while nothing is wrong: a frame costs two steps, its start, where arbitration and its
// length are computed, and its end, where it is delivered. Only the sources of the bus include this.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "canopus/sim/bus/wire/wire.hpp"

namespace canopus::sim {

class WholeFrames {
 public:
  explicit WholeFrames(WireState& wire) noexcept : wire_(wire) {}

  /// A port was added to the bus, whether to this wire or not.
  void resize() { receiving_.resize(wire_.core.acceptance.words()); }
  /// The members or their settings are others. `allowed`: nothing else on the bus needs single bits.
  void update_members(bool allowed);
  /// Frames can be computed as a whole, or at least the failures of the only member.
  [[nodiscard]] bool are_possible() const noexcept { return healthy_ || lone_; }

  /// Of an idle wire: begins the frame that is due. False: that has to go bit by bit.
  [[nodiscard]] bool start(can::Time now);
  /// The end of the frame's EOF.
  void finish(can::Time now);
  /// The sample point of the ACK slot of a frame that no port acknowledges.
  void fail_lone(can::Time now);

  /// The wire works bit by bit from here on.
  [[nodiscard]] WireHandover leave(can::Time now);
  /// It has worked bit by bit up to here, and is idle.
  void resume(can::Time now);

  /// SOF of the frame on the wire.
  [[nodiscard]] can::Time frame_start() const noexcept { return start_; }
  /// See Wire::counters_of().
  [[nodiscard]] can::FaultConfinement counters_of(const BusPort& port) const noexcept;

 private:
  void become_idle(can::Time from);
  void suspend(BusPort& port, can::Time until);
  void end_suspension();
  [[nodiscard]] unsigned suspended_bits() const noexcept;
  void count_success(BusPort& transmitter);
  [[nodiscard]] bool success_changes_a_controller(const BusPort& transmitter) const noexcept;
  [[nodiscard]] can::FaultConfinement after_success(const BusPort& port,
                                                    const BusPort& transmitter) const noexcept;
  void deliver(const can::Frame& frame, const BusPort& from, can::Time now) {
    const AcceptanceTable::Receivers receivers = wire_.core.acceptance.cached_receivers(frame);
    if (!receivers.are_known) return deliver_to_all(frame, from, now);
    deliver_if_receiving(receivers.first, frame, from, now);
    deliver_if_receiving(receivers.second, frame, from, now);
  }
  void deliver_if_receiving(std::size_t number, const can::Frame& frame, const BusPort& from, can::Time now) {
    if (number != from.index && number != AcceptanceTable::no_port &&
        (receiving_[number / 64] >> number % 64 & 1) != 0)
      deliver_to(number, frame, now);
  }
  /// To a member that accepts it, and has not sent it.
  void deliver_to(std::size_t number, const can::Frame& frame, can::Time now) {
    BusPort& port = *wire_.core.ports[number];
    if (!wire_.drops_at(port)) port.receive(frame, now);
  }
  void deliver_to_all(const can::Frame& frame, const BusPort& from, can::Time now);
  [[nodiscard]] std::uint64_t offer_at_start(const BusPort& port) const noexcept;
  void report_frame();

  WireState& wire_;
  bool healthy_ = false;            // frames can be computed as a whole
  bool lone_ = false;               // so can the failures of the only member
  std::vector<BusPort*> counting_;  // the members with an error counter that is not 0
  bool lone_frame_failed_ = false;  // transmitter_ was alone with its last frame
  bool is_after_frame_ = false;     // the wire is free from the end of an intermission on
  can::FaultConfinement counters_before_failure_;
  unsigned bits_ = 0;                       // of the frame on the wire
  can::Time start_{};                       // likewise
  BusPort* transmitter_ = nullptr;          // likewise, or of the last one
  BusPort* suspended_at_start_ = nullptr;   // was suspended when that frame began
  std::vector<std::uint64_t> receiving_;    // set of members, as in AcceptanceTable
  std::uint64_t membership_ = 0;            // how often the members were updated
  std::vector<WireFrame::Sender> senders_;  // of the frame that was reported last
};

}  // namespace canopus::sim
