// A segment bit by bit on a line with length: each controller looks once a quantum of its own clock, and sees what the
// others drive when it has come to its place.

#include <algorithm>

#include "canopus/sim/bus/line/line_clocks.hpp"
#include "canopus/sim/bus/segment.hpp"

namespace canopus::sim {

/// In place of settle() and sample().
void Segment::settle_line(can::Time now, bool has_changed) {
  if (state_ != State::bits) return;
  LineClocks& clocks = *core_.clocks;
  looking_.clear();
  for (BusPort* port : working_) {
    BusPort::BitPhase& tap = port->tap;
    const bool begins = tap.next == now && !tap.sampling;
    if (begins && !clocks.begins_bit(port->index, port->rate, now)) {
      clocks.restart(port->index, port->rate, now);
    }
    const bool is_asleep = port->bits.idle() && tap.next == can::never;
    const bool looks = is_asleep ? clocks.advance_asleep(port->index, now) : clocks.advance(port->index, now);
    if (looks) looking_.push_back(port);
    if (begins) begin_bit_on_line(*port, now);
    if (some_late_ && tap.reaches <= now) tap.reach(tap.reaching_next);
    drive_line(*port, now);
  }
  if (has_changed || forced_) {
    for (const auto& port : core_.ports) drive_line(*port, now);
  }
  tell_line_level(now, has_changed);
  for (BusPort* port : looking_) {
    if (port->segment == this) look_on_line(*port, now);
  }
  core_.report(now);
  if (!clocks.driving().empty()) clocks.forget(now);
}

void Segment::begin_bit_on_line(BusPort& port, can::Time now) {
  BusPort::BitPhase& tap = port.tap;
  tap.bit_start = now;
  tap.sampling = !port.bits.idle();
  tap.next = tap.sampling ? core_.clocks->sample_point(port.index) : can::never;
  tap.driving = port.bits.drives_dominant();
  put_on_wire(port, now);
  if (core_.wire_observers.empty()) return;
  tell_driven(port, now);
  tell_activity(port, now);
  tell_place(port, now);
}

void Segment::drive_line(BusPort& port, can::Time now) {
  if (port.segment != this) return;
  core_.clocks->drive(port.index, port.on_wire && (port.stuck || port.tap.reaching), now);
}

/// The level of the wire where it is driven. What is done to the wire itself is done everywhere at once.
void Segment::tell_line_level(can::Time now, bool has_changed) {
  bool dominant = std::ranges::any_of(core_.ports, [this](const auto& port) {
    return port->segment == this && port->on_wire && (port->stuck || port->tap.reaching);
  });
  const bool was_held = released_ != can::never;
  if (termination_ != Termination{}) dominant = driven_level(dominant, now);
  const bool is_inverted = inverted(nullptr, now);
  dominant = dominant != is_inverted;
  if (driven_.level != DrivenLevel::released) dominant = driven_.level == DrivenLevel::dominant;
  if (has_changed || faults_.corruptions > 0 || is_inverted != line_inverted_ ||
      was_held != (released_ != can::never)) {
    core_.clocks->disturb(now);
  }
  line_inverted_ = is_inverted;
  if (!core_.wire_observers.empty() && (has_changed || reconsidered_ || forced_ || some_late_)) {
    for (const auto& port : core_.ports) tell_driven(*port, now);
    reconsidered_ = false;
  }
  if (dominant == dominant_) return;
  dominant_ = dominant;
  for (WireObserver* observer : core_.wire_observers) {
    if (is_near_) {
      observer->level_changed(dominant, now);
    } else {
      observer->far_level_changed(dominant, now);
    }
  }
  if (dominant && !active_) {
    active_ = true;
    activity_start_ = now;
  }
}

/// What there is of the wire's level at the port's place.
bool Segment::seen_on_line(const BusPort& port, can::Time now) const noexcept {
  const LineClocks& clocks = *core_.clocks;
  bool dominant = termination_ != Termination{} && released_ != can::never;
  for (const std::size_t from : clocks.driving()) {
    if (core_.ports[from]->segment == this && clocks.sees(port.index, from, now)) dominant = true;
  }
  if (termination_.is_weak) dominant = false;
  dominant = dominant != inverted(nullptr, now);
  if (driven_.level != DrivenLevel::released) dominant = driven_.level == DrivenLevel::dominant;
  return dominant != inverted(&port, now);
}

can::Time Segment::next_look_on_line(can::Time now) const noexcept {
  can::Time next = can::never;
  for (const BusPort* port : working_) {
    next = std::min(next, core_.clocks->next_quantum(port->index, now, port->tap.next));
  }
  return next;
}

void Segment::look_on_line(BusPort& port, can::Time now) {
  LineClocks& clocks = *core_.clocks;
  BusPort::BitPhase& tap = port.tap;
  const bool dominant = seen_on_line(port, now);
  if (port.bits.idle() && tap.next == can::never) {
    if (!dominant) return;
    clocks.wake(port.index);
    tap.bit_start = now;
    tap.sampling = true;
    tap.next = clocks.sample_point(port.index);
    return;
  }
  const bool hard = port.bits.synchronises_hard() &&
                    (port.bits.state() != BitController::State::bus_off || port.recovering);
  const BitClock::Quantum quantum = clocks.monitor(port.index, dominant, hard, tap.driving);
  if (quantum.samples) {
    tap.sampled = quantum.dominant;
    sample_port(port, now);
  }
  if (!quantum.begins) {
    tap.next = tap.sampling ? clocks.sample_point(port.index) : clocks.end_of_bit(port.index);
  } else if (hard) {  // somebody's SOF
    tap.bit_start = now;
    tap.sampling = true;
    tap.next = clocks.sample_point(port.index);
  } else {  // the bit has ended
    tap.next = now;
  }
}

}  // namespace canopus::sim
