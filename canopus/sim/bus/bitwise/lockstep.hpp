#pragma once
// Ports of a wire that wait or receive, and have seen the same of it, simulated in lockstep: one of them goes through the bits
// for all.
//
// Most controllers do the same at the same moments. They have the same bit rate, bit boundaries, error state and position in the
// frame; only their counters are their own. All of one state are a group. One of them, the leader, samples; what it finds is then
// applied to the counters of its followers, in the order of the ports, as if each had sampled. A follower that comes to differ,
// and every follower before anything about a port changes, takes over the leader's position in the frame and goes on by itself.

#include <vector>

#include "canopus/can/bus_error.hpp"
#include "canopus/sim/bus/wire/wire.hpp"

namespace canopus::sim {

class Lockstep {
 public:
  explicit Lockstep(const WireState& wire) noexcept : wire_(wire) {}

  /// The members that sample by themselves, in the order of the ports: the leaders, and all outside of the lockstep.
  [[nodiscard]] const std::vector<BusPort*>& sampling() const noexcept { return sampling_; }
  /// Ports with followers.
  [[nodiscard]] const std::vector<BusPort*>& leaders() const noexcept { return leaders_; }
  [[nodiscard]] static bool is_follower(const BusPort& port) noexcept {
    return port.lockstep.leader != nullptr;
  }
  /// The port that simulates this one's bits: its leader, or it does so itself.
  [[nodiscard]] static const BusPort& sampler_of(const BusPort& port) noexcept {
    return is_follower(port) ? *port.lockstep.leader : port;
  }

  /// The members are others; only without a lockstep.
  void update_members() { sampling_ = wire_.members; }
  /// Ports whose state is the same go on in lockstep: those that receive a frame, and if no observer sees the wire those that are
  /// idle, integrate or are bus-off.
  void form_lockstep();
  /// Every follower comes to its leader's state, and goes on by itself.
  void split_lockstep();
  /// The followers of this leader of which that is true come to its state, and go on by themselves.
  template <typename Predicate>
  void split(BusPort& leader, Predicate is_wanted) {
    bool have_left = false;
    for (BusPort* port : wire_.members) {
      if (port->lockstep.leader != &leader || !is_wanted(*port)) continue;
      release(*port);
      have_left = true;
    }
    if (have_left) update_leaders();
  }
  /// The port goes on by itself, and those that were in lockstep with it without it.
  void take_out(BusPort& port);
  /// Followers whose error state is not their leader's any more go on by themselves, from where they are.
  void split_by_error_state();
  /// Ports that may recover from bus-off with this bit go on by themselves.
  void take_out_recovering();
  /// As BitController::bits_to_return(), of the port and its followers.
  [[nodiscard]] static unsigned bits_to_return(const BusPort& port) noexcept {
    return port.bits.bits_to_return(port.lockstep.followers > 0 ? port.lockstep.more_sequences : 0);
  }
  /// The follower comes to its leader's state, and stays a follower.
  static void copy_leader(BusPort& follower) noexcept;
  /// The follower goes on by itself, from where its leader is.
  static void release(BusPort& follower) noexcept {
    copy_leader(follower);
    follower.lockstep.leader = nullptr;
  }
  /// The leader's next sample point or bit was moved.
  void copy_deadline(const BusPort& leader) noexcept;
  /// A receiver's counters did at the sample point what its leader's did.
  static void count(can::FaultConfinement& faults, BitController::Counted counted) noexcept;
  /// Reports to the observers of the wire what all followers do in the bit that begins for their leader.
  void report_bit(BusPort& leader, can::Time now);

 private:
  [[nodiscard]] bool may_join(const BusPort& port) const noexcept;
  [[nodiscard]] static bool have_same_state(const BusPort& one, const BusPort& other) noexcept;
  static void join(BusPort& follower, BusPort& leader) noexcept;
  void replace_leader(BusPort& leader) noexcept;
  void update_leaders();

  const WireState& wire_;
  std::vector<BusPort*> leaders_;
  std::vector<BusPort*> sampling_;
  std::vector<BusPort*> firsts_;  // of form_lockstep(), kept for its memory
};

}  // namespace canopus::sim
