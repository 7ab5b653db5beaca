#pragma once
// Receivers of a wire that have seen the same of a frame, simulated in lockstep: one of them goes through the bits for all.
//
// From a frame's first bits to the end of its intermission most controllers do the same at the same moments. They have the
// same bit rate, bit boundaries, error state and position in the frame; only their counters are their own. One of them, the
// leader, samples; what it finds is then applied to the counters of its followers, in the order of the ports, as if each had
// sampled. A follower that comes to differ, and every follower before anything about a port changes, takes over the leader's
// position in the frame and goes on by itself.

#include <optional>
#include <vector>

#include "canopus/can/bus_error.hpp"
#include "canopus/sim/bus/wire/wire.hpp"

namespace canopus::sim {

class Lockstep {
 public:
  explicit Lockstep(const WireState& wire) noexcept : wire_(wire) {}

  /// The members that sample by themselves, in the order of the ports: the leader, and all outside of the lockstep.
  [[nodiscard]] const std::vector<BusPort*>& sampling() const noexcept { return sampling_; }
  /// Null: there is no lockstep.
  [[nodiscard]] BusPort* leader() const noexcept { return leader_; }
  [[nodiscard]] static bool is_follower(const BusPort& port) noexcept {
    return port.lockstep_leader != nullptr;
  }

  /// The members are others; only without a lockstep.
  void update_members() { sampling_ = wire_.members; }
  /// After ports have begun to receive: those whose state is the same go on in lockstep.
  void form_lockstep();
  /// Every follower comes to the leader's state, and goes on by itself.
  void split_lockstep();
  /// Followers whose error state is not the leader's any more go on by themselves, from where they are.
  void split_by_error_state();
  /// The follower comes to the leader's state, and stays a follower.
  static void copy_leader(BusPort& follower) noexcept;
  /// The follower goes on by itself, from where it is.
  static void release(BusPort& follower) noexcept { follower.lockstep_leader = nullptr; }
  /// The leader's next sample point or bit was moved.
  void copy_deadline() noexcept;
  /// A receiver's counters did at the sample point what the leader's did.
  static void count(can::FaultConfinement& faults, BitController::Counted counted) noexcept;
  /// Reports to the observers of the wire what all followers do in the bit that begins for the leader.
  void report_bit(can::Time now);

 private:
  /// What was reported last of the followers' bits.
  struct Reported {
    bool dominant;
    bool flagging;
    can::FrameField field;
    friend bool operator==(const Reported&, const Reported&) = default;
  };
  [[nodiscard]] bool may_follow(const BusPort& port) const noexcept;
  [[nodiscard]] static bool have_same_state(const BusPort& one, const BusPort& other) noexcept;

  const WireState& wire_;
  BusPort* leader_ = nullptr;
  std::vector<BusPort*> sampling_;
  std::optional<Reported> reported_;  // none: some have just joined
};

}  // namespace canopus::sim
