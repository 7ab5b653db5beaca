// Receivers of a segment that have all seen the same of a frame: one of them goes through the bits for all.
//
// From the frame's first bits to the end of its intermission most controllers do the same at the same moments. They
// have the same bit rate, bit boundaries, error state and place in the frame; only their counters are their own. One
// of them, the spokesman, samples; what it finds is then applied to the counters of the others, in the order of the
// ports, as if each had sampled. Whoever comes to differ, and everybody before anything about a port changes, takes over
// the spokesman's place in the frame and goes on by itself.

#include <algorithm>

#include "canopus/sim/bus/segment.hpp"

namespace canopus::sim {
namespace {

void count(can::FaultConfinement& faults, BitController::Counted counted) {
  using enum BitController::Counted;
  switch (counted) {
    case nothing: break;
    case success: faults.received(); break;
    case error: faults.receiver_error(); break;
    case severe_error: faults.receiver_severe_error(); break;
  }
}

}  // namespace

/// Comes to where its spokesman is.
void Segment::follow(BusPort& port) noexcept {
  const BusPort& spokesman = *port.spokesman;
  port.bits.copy_reception(spokesman.bits);
  BusPort::BitPhase& tap = port.tap;
  const BusPort::BitPhase& other = spokesman.tap;
  tap.bit_start = other.bit_start;
  tap.next = other.next;
  tap.sampling = other.sampling;
  tap.sampled = other.sampled;
  tap.synchronised = other.synchronised;
  tap.driving = other.driving;
  tap.reach(other.reaching);
  tap.frame_start = other.frame_start;
}

bool Segment::is_in_step(const BusPort& port, const BusPort& other) const noexcept {
  const BusPort::BitPhase& one = port.tap;
  const BusPort::BitPhase& two = other.tap;
  return port.rate == other.rate && port.faults.state() == other.faults.state() &&
         one.bit_start == two.bit_start && one.next == two.next && one.sampling == two.sampling &&
         one.sampled == two.sampled && one.synchronised == two.synchronised && one.driving == two.driving &&
         one.frame_start == two.frame_start && port.bits.receives_as(other.bits);
}

/// Nothing happens to it that does not happen to the others.
bool Segment::may_join(const BusPort& port) const noexcept {
  if (port.has_bit_fault() || port.bits.state() != BitController::State::frame || port.bits.transmitting()) {
    return false;
  }
  for (std::size_t number = 0; number < faults_.corruptions; ++number) {
    if (faults_.corruption[number].at == &port) return false;
  }
  return true;
}

/// After controllers have begun to receive: those that are in step go on together.
void Segment::gather() {
  begun_ = false;
  if (somebody_needs_bits()) return;
  bool have_joined = false;
  for (BusPort* port : working_) {
    if (port == lockstep_leader_ || !may_join(*port)) continue;
    if (lockstep_leader_ == nullptr) {
      lockstep_leader_ = port;
    } else if (is_in_step(*port, *lockstep_leader_)) {
      port->spokesman = lockstep_leader_;
      have_joined = true;
    }
  }
  if (have_joined) {
    lockstep_reports_.reset();
    std::erase_if(working_, [](const BusPort* port) { return port->spokesman != nullptr; });
  } else if (working_.size() == members_.size()) {
    lockstep_leader_ = nullptr;
  }
}

/// Everybody goes on by itself.
void Segment::part() {
  if (lockstep_leader_ == nullptr) return;
  for (BusPort* port : members_) {
    if (port->spokesman == nullptr) continue;
    follow(*port);
    port->spokesman = nullptr;
  }
  lockstep_leader_ = nullptr;
  working_ = members_;
}

/// What observers hear of all for whom the spokesman begins a bit.
void Segment::tell_together(can::Time now) {
  const ToldTogether told{.dominant = lockstep_leader_->tap.reaching,
                          .flagging = lockstep_leader_->bits.flagging(),
                          .field = lockstep_leader_->bits.field()};
  if (lockstep_reports_ == told) return;
  lockstep_reports_ = told;
  for (BusPort* port : members_) {
    if (port->spokesman == nullptr) continue;
    follow(*port);
    tell_driven(*port, now);
    tell_activity(*port, now);
    tell_place(*port, now);
  }
}

void Segment::keep_in_step() noexcept {
  for (BusPort* port : members_) {
    if (port->spokesman != nullptr) port->tap.next = lockstep_leader_->tap.next;
  }
}

/// The spokesman's sample point.
void Segment::sample_together(can::Time now) {
  BusPort& spokesman = *lockstep_leader_;
  const Sampled found = look(spokesman, now);
  if (found.events == BitController::Events{}) {
    for (BusPort* port : working_) {
      if (port != &spokesman && is_sampling(*port, now)) sample_port(*port, now);
    }
    return;
  }
  if (found.events.early_start) return leave_lockstep(found, now);
  bool differ = false;
  for (BusPort* port : members_) {
    if (port == &spokesman) {
      conclude(spokesman, found, now);
    } else if (port->spokesman != nullptr) {
      Sampled own = found;
      own.faults = port->faults;
      count(port->faults, found.events.counted);
      tell_counters(*port, now);
      follow(*port);
      conclude(*port, own, now);
      differ = differ || port->faults.state() != spokesman.faults.state();
    } else if (is_sampling(*port, now)) {
      sample_port(*port, now);
    }
  }
  if (!differ) return;
  for (BusPort* port : members_) {
    if (port->faults.state() != spokesman.faults.state()) port->spokesman = nullptr;
  }
  working_ = members_;
  std::erase_if(working_, [](const BusPort* port) { return port->spokesman != nullptr; });
}

/// Somebody's SOF in the last bit of the intermission: whoever has something to send joins in.
void Segment::leave_lockstep(const Sampled& found, can::Time now) {
  BusPort* spokesman = lockstep_leader_;
  for (BusPort* port : working_) {
    if (port != spokesman && is_sampling(*port, now)) sample_port(*port, now);
  }
  for (BusPort* port : members_) {
    if (port->spokesman == nullptr) continue;
    follow(*port);
    Sampled own = found;
    own.faults = port->faults;
    conclude(*port, own, now);
    port->spokesman = nullptr;
  }
  conclude(*spokesman, found, now);
  lockstep_leader_ = nullptr;
  working_ = members_;
}

}  // namespace canopus::sim
