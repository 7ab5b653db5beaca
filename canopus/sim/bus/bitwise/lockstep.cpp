#include "canopus/sim/bus/bitwise/lockstep.hpp"

#include <algorithm>

namespace canopus::sim {

void Lockstep::count(can::FaultConfinement& faults, BitController::Counted counted) noexcept {
  using enum BitController::Counted;
  switch (counted) {
    case nothing: break;
    case success: faults.received(); break;
    case error: faults.receiver_error(); break;
    case severe_error: faults.receiver_severe_error(); break;
  }
}

void Lockstep::copy_leader(BusPort& follower) noexcept {
  const BusPort& leader = *follower.lockstep_leader;
  follower.bits.copy_reception(leader.bits);
  BusPort::BitPhase& own = follower.phase;
  const BusPort::BitPhase& other = leader.phase;
  own.bit_start = other.bit_start;
  own.next = other.next;
  own.sampling = other.sampling;
  own.sampled = other.sampled;
  own.synchronised = other.synchronised;
  own.driving = other.driving;
  own.set_output(other.output);
  own.frame_start = other.frame_start;
}

bool Lockstep::have_same_state(const BusPort& one, const BusPort& other) noexcept {
  const BusPort::BitPhase& a = one.phase;
  const BusPort::BitPhase& b = other.phase;
  return one.rate == other.rate && one.faults.state() == other.faults.state() && a.bit_start == b.bit_start &&
         a.next == b.next && a.sampling == b.sampling && a.sampled == b.sampled &&
         a.synchronised == b.synchronised && a.driving == b.driving && a.frame_start == b.frame_start &&
         one.bits.receives_as(other.bits);
}

/// Nothing happens to it that does not happen to the others.
bool Lockstep::may_follow(const BusPort& port) const noexcept {
  if (port.has_bit_fault() || port.bits.state() != BitController::State::frame || port.bits.transmitting()) {
    return false;
  }
  for (std::size_t number = 0; number < wire_.faults.corruptions; ++number) {
    if (wire_.faults.corruption[number].at == &port) return false;
  }
  return true;
}

void Lockstep::form_lockstep() {
  bool have_joined = false;
  for (BusPort* port : sampling_) {
    if (port == leader_ || !may_follow(*port)) continue;
    if (leader_ == nullptr) {
      leader_ = port;
    } else if (have_same_state(*port, *leader_)) {
      port->lockstep_leader = leader_;
      have_joined = true;
    }
  }
  if (have_joined) {
    reported_.reset();
    std::erase_if(sampling_, [](const BusPort* port) { return is_follower(*port); });
  } else if (sampling_.size() == wire_.members.size()) {
    leader_ = nullptr;
  }
}

void Lockstep::split_lockstep() {
  if (leader_ == nullptr) return;
  for (BusPort* port : wire_.members) {
    if (!is_follower(*port)) continue;
    copy_leader(*port);
    release(*port);
  }
  leader_ = nullptr;
  sampling_ = wire_.members;
}

void Lockstep::split_by_error_state() {
  const auto differs = [this](const BusPort* port) {
    return is_follower(*port) && port->faults.state() != leader_->faults.state();
  };
  if (std::ranges::none_of(wire_.members, differs)) return;
  for (BusPort* port : wire_.members) {
    if (differs(port)) release(*port);
  }
  sampling_ = wire_.members;
  std::erase_if(sampling_, [](const BusPort* port) { return is_follower(*port); });
}

void Lockstep::copy_deadline() noexcept {
  for (BusPort* port : wire_.members) {
    if (is_follower(*port)) port->phase.next = leader_->phase.next;
  }
}

void Lockstep::report_bit(can::Time now) {
  const Reported reported{.dominant = leader_->phase.output,
                          .flagging = leader_->bits.flagging(),
                          .field = leader_->bits.field()};
  if (reported_ == reported) return;
  reported_ = reported;
  for (BusPort* port : wire_.members) {
    if (!is_follower(*port)) continue;
    copy_leader(*port);
    port->report_output(now);
    port->report_activity(now);
    port->report_field(now);
  }
}

}  // namespace canopus::sim
