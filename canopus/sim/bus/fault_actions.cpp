#include "canopus/sim/bus/fault_actions.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "canopus/sim/bus/faults/termination.hpp"

namespace canopus::sim {
namespace {

/// A fault of a port's controller or driver begins or ends.
void set_port_fault(BusPort& port, const Fault& fault, bool begins) {
  port.wire->before_change();
  switch (fault.kind) {
    case FaultKind::stuck_dominant: port.stuck_dominant = begins; break;
    case FaultKind::stuck_recessive: port.stuck_recessive = begins; break;
    case FaultKind::late: port.lateness = begins ? fault.delay : can::Duration{}; break;
    case FaultKind::overload:
      port.overload_frames = begins ? fault.overload_frames : 0;
      port.bits.set_overload_frames(port.overload_frames);
      break;
    case FaultKind::single_shot: port.single_shot = begins; break;
    case FaultKind::early:
      port.early_bits = begins ? fault.early_bits : 0;
      port.bits.set_early_bits(port.early_bits);
      break;
    default: break;
  }
  port.wire->after_change();
}

void set_babble(BusPort& port, const Fault& fault) {
  port.wire->snapshot_pending(port);
  port.babbling = true;
  port.babble_always = fault.interval == can::Duration{};
  port.babble = fault.frame;
}

}  // namespace

void FaultActions::run(can::Time now) {
  if (!core_.delayed.empty()) release_delayed(now);
  if (core_.plan.next() <= now) run_timed(now);
  if (core_.plan.driver().next() <= now) run_driver(now);
}

can::Time FaultActions::next() const noexcept {
  can::Time next = std::min(core_.plan.next(), core_.plan.driver().next());
  for (const BusCore::Delayed& delayed : core_.delayed) next = std::min(next, delayed.until);
  return next;
}

void FaultActions::end_all(can::Time now) {
  for (TimedFault& timed : core_.plan.timed_faults()) {
    if (timed.active) end(timed, now);
  }
  near_.drive({});
}

bool FaultActions::end(std::size_t number, can::Time now) {
  bool is_ended = core_.plan.end_rules(number, now);
  for (TimedFault& timed : core_.plan.timed_faults()) {
    if (timed.number != number) continue;
    is_ended = true;
    if (timed.active) end(timed, now);
    timed.fault.from = can::never;
  }
  return is_ended;
}

void FaultActions::release_delayed(can::Time now) {
  for (std::size_t number = 0; number < core_.delayed.size();) {
    const BusCore::Delayed delayed = core_.delayed[number];
    if (delayed.until > now) {
      ++number;
      continue;
    }
    core_.delayed.erase(core_.delayed.begin() + static_cast<std::ptrdiff_t>(number));
    delayed.port->enqueue(delayed.frame);
  }
}

void FaultActions::run_driver(can::Time now) {
  BitDriver& driver = core_.plan.driver();
  if (driver.run(now)) near_.drive({.is_busy = driver.is_busy(), .level = driver.level()});
}

void FaultActions::run_timed(can::Time now) {
  for (TimedFault& timed : core_.plan.timed_faults()) {
    if (!timed.active && timed.fault.from <= now) begin(timed, now);
    if (timed.active && timed.fault.until <= now) end(timed, now);
    if (!timed.active || timed.next_act > now) continue;
    if (timed.fault.kind == FaultKind::babble) {
      babble(timed, now);
    } else {
      make_noise(timed, now);
    }
  }
}

void FaultActions::begin(TimedFault& timed, can::Time now) {
  timed.active = true;
  switch (timed.fault.kind) {
    case FaultKind::babble:
      for (BusPort* port : timed.ports) set_babble(*port, timed.fault);
      babble(timed, now);
      break;
    case FaultKind::jam:
      for (BusPort* port : timed.ports) {
        port->jammed = true;
        port->held_capacity = timed.fault.capacity;
        port->held.reserve(timed.fault.capacity);
      }
      break;
    case FaultKind::stuck_dominant:
    case FaultKind::stuck_recessive:
    case FaultKind::late:
    case FaultKind::overload:
    case FaultKind::single_shot:
    case FaultKind::early:
      for (BusPort* port : timed.ports) set_port_fault(*port, timed.fault, true);
      break;
    case FaultKind::cut:
      for (BusPort* port : timed.ports) far_.move_in(*port, segment_of(*port));
      break;
    case FaultKind::noise: timed.next_act = after_bits(now, timed.bits_to_next_hit()); break;
    case FaultKind::termination:
      set_termination(termination(timed.fault.resistors, timed.fault.length, core_.ports.size()));
      break;
    default: break;  // about frames
  }
}

/// A fault of this kind that the port has at this time.
const FaultPlan::TimedFault* FaultActions::other_active(FaultKind kind, const BusPort& port) {
  for (const TimedFault& timed : core_.plan.timed_faults()) {
    const bool has_port = std::find(timed.ports.begin(), timed.ports.end(), &port) != timed.ports.end();
    if (timed.active && timed.fault.kind == kind && has_port) return &timed;
  }
  return nullptr;
}

void FaultActions::end(TimedFault& timed, can::Time now) {
  timed.active = false;
  timed.fault.from = can::never;
  const FaultKind kind = timed.fault.kind;
  for (BusPort* port : timed.ports) {
    const TimedFault* other = other_active(kind, *port);
    if (other == nullptr) {
      end_at(*port, kind, now);
    } else if (kind == FaultKind::babble) {
      set_babble(*port, other->fault);
      port->wire->offer_changed(*port);
    } else if (kind != FaultKind::jam && kind != FaultKind::cut) {
      set_port_fault(*port, other->fault, true);
    }
  }
  if (timed.is_inverting) invert(timed);
  if (kind == FaultKind::termination) set_termination({});
}

/// The port has no other fault of this kind.
void FaultActions::end_at(BusPort& port, FaultKind kind, can::Time now) {
  switch (kind) {
    case FaultKind::babble:
      port.wire->snapshot_pending(port);
      port.babbling = port.babble_due = false;
      port.wire->offer_changed(port);
      break;
    case FaultKind::jam: {
      port.jammed = false;
      std::vector<can::Frame> held;
      held.swap(port.held);
      for (const can::Frame& frame : held) port.receive(frame, now);
      break;
    }
    case FaultKind::cut: near_.move_in(port, segment_of(port)); break;
    default: set_port_fault(port, {.kind = kind}, false); break;
  }
}

void FaultActions::set_termination(const Termination& termination) {
  near_.set_termination(termination);
  far_.set_termination(termination);
}

void FaultActions::babble(TimedFault& timed, can::Time now) {
  for (BusPort* port : timed.ports) {
    set_babble(*port, timed.fault);
    port->babble_due = true;
    port->wire->offer_changed(*port);
  }
  const can::Duration interval = timed.fault.interval;
  timed.next_act = interval > can::Duration{} ? can::later(now, interval) : can::never;
}

/// One bit of noise begins or ends.
void FaultActions::make_noise(TimedFault& timed, can::Time now) {
  std::uint64_t good_bits = 0;
  if (timed.is_inverting) good_bits = timed.bits_to_next_hit();
  if (!timed.is_inverting || good_bits > 0) invert(timed);
  timed.next_act = after_bits(now, timed.is_inverting ? 1 : good_bits);
}

void FaultActions::invert(TimedFault& timed) {
  timed.is_inverting = !timed.is_inverting;
  if (timed.ports.empty()) {
    near_.invert();
    far_.invert();
    return;
  }
  for (BusPort* port : timed.ports) {
    port->wire->before_change();
    port->inverted = !port->inverted;
    port->wire->after_change();
  }
}

can::Time FaultActions::after_bits(can::Time now, std::uint64_t bits) const {
  return can::later(now, can::bit_time(1, core_.bit_rate) * static_cast<std::int64_t>(bits));
}

}  // namespace canopus::sim
