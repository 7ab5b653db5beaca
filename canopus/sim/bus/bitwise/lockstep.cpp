#include "canopus/sim/bus/bitwise/lockstep.hpp"

#include <algorithm>

namespace canopus::sim {

namespace {

/// From bus-off, with the next bit.
bool may_recover(const BusPort& port, int more_sequences) noexcept {
  return port.bits.state() == BitController::State::bus_off && port.bits.bits_to_return(more_sequences) == 1;
}

}  // namespace

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
  const BusPort& leader = *follower.lockstep.leader;
  follower.bits.copy_reception(leader.bits, follower.lockstep.more_sequences);
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
  if (one.rate != other.rate || one.faults.state() != other.faults.state() || a.next != b.next ||
      a.sampling != b.sampling || a.sampled != b.sampled || a.synchronised != b.synchronised ||
      a.driving != b.driving || one.recovering != other.recovering || !one.bits.is_alike(other.bits))
    return false;
  const bool are_asleep = one.bits.idle() && a.next == can::never;  // their last bits were what they were
  return are_asleep || (a.bit_start == b.bit_start && (one.bits.idle() || a.frame_start == b.frame_start));
}

/// Nothing happens to it that does not happen to the others.
bool Lockstep::may_join(const BusPort& port) const noexcept {
  if (port.has_bit_fault() || port.bits.transmitting()) return false;
  using enum BitController::State;
  const auto state = port.bits.state();
  const bool waits = state == idle || state == integrating || state == bus_off;
  if (state != frame && !(waits && wire_.core.wire_observers.empty())) return false;
  for (std::size_t number = 0; number < wire_.faults.corruptions; ++number) {
    if (wire_.faults.corruption[number].at == &port) return false;
  }
  return true;
}

void Lockstep::form_lockstep() {
  firsts_ = leaders_;
  bool have_joined = false;
  for (BusPort* port : sampling_) {
    if (port->lockstep.followers > 0 || !may_join(*port)) continue;
    const auto first =
        std::ranges::find_if(firsts_, [port](const BusPort* one) { return have_same_state(*port, *one); });
    if (first == firsts_.end()) {
      firsts_.push_back(port);
      continue;
    }
    if ((*first)->lockstep.followers++ == 0) leaders_.push_back(*first);
    join(*port, **first);
    have_joined = true;
  }
  if (have_joined) update_leaders();
}

void Lockstep::join(BusPort& follower, BusPort& leader) noexcept {
  const bool is_bus_off = follower.bits.state() == BitController::State::bus_off;
  follower.lockstep.leader = &leader;
  follower.lockstep.more_sequences =
      is_bus_off ? static_cast<int>(follower.bits.sequences()) - static_cast<int>(leader.bits.sequences())
                 : 0;
  leader.lockstep.reported.reset();
}

void Lockstep::split_lockstep() {
  if (leaders_.empty()) return;
  for (BusPort* port : wire_.members) {
    if (is_follower(*port)) release(*port);
    port->lockstep.followers = 0;
  }
  leaders_.clear();
  sampling_ = wire_.members;
}

void Lockstep::take_out(BusPort& port) {
  if (is_follower(port)) {
    release(port);
  } else if (port.lockstep.followers > 0) {
    replace_leader(port);
  } else {
    return;
  }
  update_leaders();
}

/// The first of its followers leads the others.
void Lockstep::replace_leader(BusPort& leader) noexcept {
  BusPort* next = nullptr;
  for (BusPort* port : wire_.members) {
    if (port->lockstep.leader != &leader) continue;
    if (next == nullptr) {
      release(*port);
      next = port;
    } else {
      port->lockstep.leader = next;
      port->lockstep.more_sequences -= next->lockstep.more_sequences;
    }
  }
  std::ranges::replace(leaders_, &leader, next);
  leader.lockstep.followers = 0;
}

void Lockstep::take_out_recovering() {
  const auto has_recovering = [](const BusPort* leader) {
    return may_recover(*leader, leader->lockstep.more_sequences);
  };
  if (std::ranges::none_of(leaders_, has_recovering)) return;
  for (BusPort* leader : std::vector<BusPort*>(leaders_)) {
    split(*leader,
          [leader](const BusPort& port) { return may_recover(*leader, port.lockstep.more_sequences); });
    if (may_recover(*leader, 0)) take_out(*leader);
  }
}

void Lockstep::split_by_error_state() {
  bool have_left = false;
  for (BusPort* port : wire_.members) {
    if (!is_follower(*port) || port->faults.state() == port->lockstep.leader->faults.state()) continue;
    release(*port);
    have_left = true;
  }
  if (have_left) update_leaders();
}

/// Some ports follow another one than before, or none.
void Lockstep::update_leaders() {
  for (BusPort* leader : leaders_) {
    leader->lockstep.followers = 0;
    leader->lockstep.more_sequences = 0;
  }
  sampling_.clear();
  for (BusPort* port : wire_.members) {
    if (!is_follower(*port)) {
      sampling_.push_back(port);
      continue;
    }
    BusPort::LockstepState& leader = port->lockstep.leader->lockstep;
    ++leader.followers;
    leader.more_sequences = std::max(leader.more_sequences, port->lockstep.more_sequences);
  }
  std::erase_if(leaders_, [](const BusPort* leader) { return leader->lockstep.followers == 0; });
}

void Lockstep::copy_deadline(const BusPort& leader) noexcept {
  for (BusPort* port : wire_.members) {
    if (port->lockstep.leader == &leader) port->phase.next = leader.phase.next;
  }
}

void Lockstep::report_bit(BusPort& leader, can::Time now) {
  const BusPort::LockstepState::Report report{
      .dominant = leader.phase.output, .flagging = leader.bits.flagging(), .field = leader.bits.field()};
  if (leader.lockstep.reported == report) return;
  leader.lockstep.reported = report;
  for (BusPort* port : wire_.members) {
    if (port->lockstep.leader != &leader) continue;
    copy_leader(*port);
    port->report_output(now);
    port->report_activity(now);
    port->report_field(now);
  }
}

}  // namespace canopus::sim
