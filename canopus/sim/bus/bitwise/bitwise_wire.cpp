#include "canopus/sim/bus/bitwise/bitwise_wire.hpp"

#include <algorithm>
#include <utility>

namespace canopus::sim {
namespace {

// CiA recommends the sample point at 87.5 % of the bit; one eighth of a bit is also the most that one edge
// may move it.
can::Duration sample_offset(can::Duration bit) { return bit - after_sample_point(bit); }
can::Duration jump_width(can::Duration bit) { return bit / 8; }

}  // namespace

bool BitwiseWire::update_members() {
  outputs_changed_ = true;
  has_early_ports_ = has_late_drivers_ = false;
  bool have_bit_faults = false;
  for (const auto& port : wire_.core.ports) {
    if (!wire_.has(*port)) continue;
    if (!port->present()) {
      port->report_silence();  // bus-off for good
      continue;
    }
    have_bit_faults = have_bit_faults || port->has_bit_fault();
    has_early_ports_ = has_early_ports_ || port->early_bits > 0;
    has_late_drivers_ = has_late_drivers_ || port->lateness > can::Duration{};
    if (port->lateness == can::Duration{})
      port->phase.set_output(port->phase.driving && !port->stuck_recessive);
  }
  lockstep_.update_members();
  levels_.update_members();
  return !have_bit_faults && !levels_.are_disturbed() && wire_.core.clocks == nullptr;
}

void BitwiseWire::after_change(can::Time now) noexcept {
  if (!active_ && !is_quiet(now)) {
    active_ = true;
    activity_start_ = now;
  }
  // The bus's tick at this moment does the rest: what ends or begins now may be part of it.
  abandoned_ = changed_ = true;
}

/// The port keeps what its controller is doing and finds itself on another wire.
void BitwiseWire::move_in(BusPort& port, const WireState& from) {
  completion_.move_in(port, from);
  if (dominant_) wake(port, wire_.core.timeline.now());
}

void BitwiseWire::enter(const WireHandover& handover) {
  const can::Time now = wire_.core.timeline.now();
  dominant_ = false;
  active_ = false;
  for (const auto& port : wire_.core.ports) {
    if (wire_.has(*port)) port->phase = {};
  }
  // What is sampled or begins at this moment is part of the past once the bus has had its tick.
  const can::Time until = wire_.core.has_ticked() ? now + can::Duration(1) : now;
  switch (handover.kind) {
    case WireHandover::Kind::idle:
      wire_.deadline = wire_.arbiter.lowest() == Arbiter::none ? can::never : std::max(now, wire_.free_from);
      break;
    case WireHandover::Kind::frame: replay_frame(handover, until); break;
    case WireHandover::Kind::failed_lone_frame:
      replay_frame(handover, until);
      activity_start_ = now;
      has_error_frame_ = true;
      break;
    case WireHandover::Kind::intermission: replay_intermission(handover, until); break;
  }
}

/// Brings the controllers to where the frame on the wire has them just before `until`.
void BitwiseWire::replay_frame(const WireHandover& handover, can::Time until) {
  BusPort& port = *handover.transmitter;
  has_error_frame_ = false;  // of an earlier frame
  port.bits.transmit(port.current);
  port.phase.frame_start = handover.start;
  port.phase.next = handover.start;
  for (BusPort* contender : wire_.members) {
    if (contender == &port || contender == handover.suspended) continue;
    if (contender->pending.frame_number != wire_.frame_number)
      contender->snapshot_pending(wire_.frame_number);
    if (!contender->pending.offered) continue;
    contender->bits.transmit(contender->pending.frame);
    contender->phase.next = contender->phase.frame_start = handover.start;
  }
  if (handover.suspended != nullptr) handover.suspended->bits.resume_suspension(handover.suspended_bits);
  replay(handover.start, until);
  for (BusPort* contender : wire_.members) {
    if (contender != &port && contender->bits.transmitting()) contender->restore_pending();
  }
}

/// The same for the intermission of a frame that is complete.
void BitwiseWire::replay_intermission(const WireHandover& handover, can::Time until) {
  for (BusPort* port : wire_.members) {
    port->bits.begin_intermission(port == handover.transmitter);
    port->phase.next = handover.start;
  }
  active_ = true;
  activity_start_ = handover.counted_until;
  replay(handover.start, until);
}

void BitwiseWire::replay(can::Time from, can::Time until) {
  replaying_ = true;
  wire_.deadline = from;
  while (wire_.deadline < until) {
    const can::Time moment = wire_.deadline;
    end_bits(moment);
    run_bits(moment);
  }
  replaying_ = false;
}

void BitwiseWire::leave(can::Time now) {
  for (BusPort* port : wire_.members) {
    port->report_field(now);
    port->phase = {};
  }
}

bool BitwiseWire::end_bits(can::Time now) {
  had_changed_ = std::exchange(changed_, false);
  completion_.run(now);
  if (lockstep_.leader() != nullptr && lockstep_.leader()->bits.quiet()) lockstep_.split_lockstep();
  if (dominant_ || !is_quiet(now)) return false;
  if (active_) {
    active_ = false;
    has_error_frame_ = false;
    if (!wire_.faults_ready) wire_.clear_faults();
    count_activity(now);
  }
  return true;
}

void BitwiseWire::run_bits(can::Time now) {
  begin_frames(now);
  if (wire_.core.clocks != nullptr) {
    line_.run(now, had_changed_);
  } else {
    begin_bits(now);
    sample(now);
  }
  if (abandoned_) cancel_abandoned_corruptions();
  wire_.notify_controller_changes(now);
  schedule(now);
}

/// Nothing of a frame is left at any port, and the idle ones are at the end of their bits.
bool BitwiseWire::is_quiet(can::Time now) const noexcept {
  return std::ranges::all_of(lockstep_.sampling(), [now](const BusPort* port) {
    return port->bits.quiet() && (!port->bits.idle() || is_between_bits(*port, now));
  });
}

/// It waits for a dominant bit, or its bit ends now.
bool BitwiseWire::is_between_bits(const BusPort& port, can::Time now) noexcept {
  return !port.phase.sampling && (port.phase.next == can::never || port.phase.next <= now);
}

bool BitwiseWire::may_begin(const BusPort& port, can::Time now) const noexcept {
  return (port.bits.idle() || (has_early_ports_ && port.bits.may_begin())) && is_between_bits(port, now) &&
         port.offer() != Arbiter::none;
}

/// The wire was busy from activity_start_ on.
void BitwiseWire::count_activity(can::Time now) {
  const can::Duration bit = can::bit_time(1, wire_.core.bit_rate);
  activity_start_ = std::min(activity_start_, now);
  wire_.core.statistics.busy(activity_start_, now, static_cast<std::uint64_t>((now - activity_start_) / bit));
}

/// Each controller begins by its own bits, whatever the others are still doing: those that are not idle yet see
/// the SOF where they are.
void BitwiseWire::begin_frames(can::Time now) {
  if (replaying_) return;
  const BusPort* first = nullptr;
  for (BusPort* port : lockstep_.sampling()) {
    if (!may_begin(*port, now)) continue;
    port->begin_next();
    wire_.arbiter.set(port->index, port->offer());
    port->bits.transmit(port->current);
    port->phase.frame_start = now;
    port->phase.next = now;
    port->phase.lost_at = WireFrame::Sender::won;
    if (first == nullptr || arbitration(port->current) < arbitration(first->current)) first = port;
  }
  if (first == nullptr) return;
  if (active_) {  // some port is still in its error frame: what belongs to the last frame ends here all the same
    count_activity(now);
    activity_start_ = now;
  }
  FaultPlan& plan = wire_.core.plan;
  if (!wire_.faults_ready) {
    wire_.faults =
        plan.hits_frames() ? plan.on_frame(*first, first->bit(), first->current, now) : FrameFaults{};
  }
  if (wire_.faults.corruptions > 0) lockstep_.split_lockstep();  // one may hit a single port of it
  wire_.faults_ready = false;
  abandoned_ = false;
  has_error_frame_ = false;
  levels_.begin_frame(now, first->bit());
}

/// Lets bits begin that begin now and finds the level of the wire.
void BitwiseWire::begin_bits(can::Time now) {
  bool is_driven = levels_.has_stuck_dominant();
  bool have_gone_idle = false;  // some ports, with this bit
  for (BusPort* port : lockstep_.sampling()) {
    BusPort::BitPhase& phase = port->phase;
    if (phase.next == now && !phase.sampling) {
      phase.bit_start = now;
      if (port->bits.idle()) {
        phase.next = can::never;  // until the wire is dominant
        phase.synchronised = false;
        have_gone_idle = true;
      } else {
        phase.next = now + sample_offset(port->bit());
        phase.sampling = true;
      }
      phase.driving = port->bits.drives_dominant();
      put_on_wire(*port, now);
      if (!wire_.core.wire_observers.empty()) report_bit(*port, now);
    }
    if (has_late_drivers_ && phase.output_changes <= now) phase.set_output(phase.next_output);
    is_driven = is_driven || phase.output;
  }
  report_outputs(false, now);
  const bool dominant = levels_.level(is_driven, now);
  if (have_gone_idle ||
      levels_.differ()) {  // there is no edge for those that see a dominant bit from here on
    for (BusPort* port : lockstep_.sampling()) {
      if (levels_.seen_at(*port, dominant, now)) wake(*port, now);
    }
  }
  if (!set_level(dominant, now) || !dominant) return;
  for (BusPort* port : lockstep_.sampling()) synchronise(*port, now);
  if (lockstep_.leader() != nullptr && lockstep_.leader()->phase.received) lockstep_.copy_deadline();
}

/// The bit that begins for the port.
void BitwiseWire::report_bit(BusPort& port, can::Time now) {
  port.report_output(now);
  port.report_activity(now);
  port.report_field(now);
  if (&port == lockstep_.leader()) lockstep_.report_bit(now);
}

void BitwiseWire::put_on_wire(BusPort& port, can::Time now) {
  BusPort::BitPhase& phase = port.phase;
  const bool dominant = phase.driving && !port.stuck_recessive;
  if (port.lateness == can::Duration{}) return phase.set_output(dominant);
  if (phase.output_changes != can::never)
    phase.set_output(phase.next_output);  // a bit shorter than the delay
  if (dominant == phase.output) return;
  phase.next_output = dominant;
  phase.output_changes = now + port.lateness;
}

void BitwiseWire::report_outputs(bool has_changed, can::Time now) {
  if (wire_.core.wire_observers.empty()) return;
  if (!has_changed && !outputs_changed_ && !levels_.has_stuck_dominant() && !has_late_drivers_) return;
  for (const auto& port : wire_.core.ports) {
    if (wire_.has(*port)) port->report_output(now);
  }
  outputs_changed_ = false;
}

bool BitwiseWire::set_level(bool dominant, can::Time now) {
  if (dominant == dominant_) return false;
  dominant_ = dominant;
  for (WireObserver* observer : wire_.core.wire_observers) {
    if (wire_.is_near) {
      observer->level_changed(dominant, now);
    } else {
      observer->far_level_changed(dominant, now);
    }
  }
  if (dominant && !active_) {
    active_ = true;
    activity_start_ = now;
  }
  return true;
}

void BitwiseWire::start_sampling(BusPort& port, can::Time now) noexcept {
  port.phase.bit_start = now;
  port.phase.next = now + sample_offset(port.bit());
  port.phase.sampling = true;
}

/// A port that waits for a dominant bit sees one.
void BitwiseWire::wake(BusPort& port, can::Time now) {
  if (!port.bits.idle() || port.phase.next != can::never || wire_.core.clocks != nullptr) return;
  start_sampling(port, now);
}

/// An edge from recessive to dominant [ISO 11898-1 synchronisation]: at most one between two sample points counts, and
/// only if the last sample was recessive. It restarts the bit of a port that waits for a frame, from the second bit of
/// the intermission on; else it moves it by the jump width at most.
void BitwiseWire::synchronise(BusPort& port, can::Time now) {
  BusPort::BitPhase& phase = port.phase;
  if (phase.sampled || phase.synchronised) return;
  if (phase.next != can::never && phase.bit_start == now) {
    phase.synchronised = true;
    return;
  }
  if (port.bits.synchronises_hard()) {
    if (port.bits.state() == BitController::State::bus_off && !port.recovering) return;
    phase.synchronised = true;
    return start_sampling(port, now);
  }
  const can::Duration most = jump_width(port.bit());
  if (phase.sampling) {
    if (phase.driving) return;
    phase.synchronised = true;
    const can::Duration late = std::min(now - phase.bit_start, most);
    phase.bit_start += late;
    phase.next += late;
  } else {
    phase.synchronised = true;
    phase.next -= std::min(phase.next - now, most);
  }
}

void BitwiseWire::sample(can::Time now) {
  if (lockstep_.leader() != nullptr && is_sampling(*lockstep_.leader(), now)) {
    sample_lockstep(now);
  } else {
    for (BusPort* port : lockstep_.sampling()) {
      if (is_sampling(*port, now)) sample_port(*port, now);
    }
  }
  wire_.core.report(now);
  if (std::exchange(begun_, false) && !wire_.core.needs_bits()) lockstep_.form_lockstep();
}

void BitwiseWire::sample_port(BusPort& port, can::Time now) {
  const Sampled sampled = sample_bit(port, now);
  if (sampled.events != BitController::Events{} || port.faults != sampled.faults) apply(port, sampled, now);
}

/// The port's controller samples its bit.
BitwiseWire::Sampled BitwiseWire::sample_bit(BusPort& port, can::Time now) {
  BusPort::BitPhase& phase = port.phase;
  Sampled sampled{
      .faults = port.faults, .position = port.bits.position(), .is_transmitter = port.bits.is_transmitter()};
  const bool in_frame = port.bits.state() == BitController::State::frame;
  if (!levels_.differ()) {
    phase.sampled = dominant_;
  } else if (wire_.core.clocks == nullptr) {  // on a line with length it has seen the wire already
    phase.sampled = levels_.seen_at(port, dominant_, now);
  }
  phase.synchronised = false;
  port.bits.sample(phase.sampled, sampled.events);
  if (port.faults != sampled.faults) port.report_counters(now);
  if (!in_frame && port.bits.state() == BitController::State::frame) {
    phase.frame_start = phase.bit_start;
    begun_ = true;
  }
  if (sampled.events.lost) {
    phase.lost_at = sampled.position.payload;  // never a stuff bit: that is an error
    begun_ = true;
  }
  phase.sampling = false;
  phase.next = phase.bit_start + port.bit();
  return sampled;
}

/// What follows from it for the port's queue, its participant and the observers.
void BitwiseWire::apply(BusPort& port, const Sampled& sampled, can::Time now) {
  BusPort::BitPhase& phase = port.phase;
  const BitController::Events& events = sampled.events;
  if (events.error != BusError::none) {
    abandoned_ = true;
    phase.lost_at = WireFrame::Sender::won;
  }
  if (port.sending && (events.lost || events.error != BusError::none)) {
    port.requeue();
    wire_.arbiter.set(port.index, port.offer());
  }
  completion_.note(port, events);
  if (events.early_start && port.offer() != Arbiter::none) {
    port.begin_next();
    wire_.arbiter.set(port.index, port.offer());
    port.bits.join(port.current);
  }
  if (replaying_) return;  // an error frame was counted and reported when it was computed
  if (events.error != BusError::none) report_bit_error(port, sampled, now);
  if (events.recovered) port.recovering = false;
  const can::ErrorState state = sampled.faults.state();
  if (port.faults.state() == state && port.faults.warning() == sampled.faults.warning()) return;
  phase.changed = wire_.controllers_changed = true;
  if (port.faults.state() == can::ErrorState::bus_off) {
    ++port.counted.bus_offs;
    if (port.automatic_recovery) port.recovering = true;
    port.bits.set_recovering(port.recovering);
  }
  wire_.arbiter.set(port.index, port.offer());
  port.report_controller(state);
}

void BitwiseWire::report_bit_error(BusPort& port, const Sampled& sampled, can::Time now) {
  const BusError error = sampled.events.error;
  ++port.counted.errors;
  port.report_error({.error = error,
                     .field = sampled.position.field(),
                     .bit = sampled.position.number,
                     .transmitter = sampled.is_transmitter,
                     .dominant = port.phase.sampled,
                     .first = !has_error_frame_});
  if (!has_error_frame_) wire_.core.statistics.error_frame();
  has_error_frame_ = true;
  for (can::BusObserver* observer : wire_.core.observers) observer->error_detected(port, error, now);
}

/// The leader's sample point.
void BitwiseWire::sample_lockstep(can::Time now) {
  BusPort& leader = *lockstep_.leader();
  const Sampled found = sample_bit(leader, now);
  if (found.events == BitController::Events{}) {
    for (BusPort* port : lockstep_.sampling()) {
      if (port != &leader && is_sampling(*port, now)) sample_port(*port, now);
    }
    return;
  }
  if (found.events.early_start) return split_at_early_start(found, now);
  for (BusPort* port : wire_.members) {
    if (port == &leader) {
      apply(leader, found, now);
    } else if (Lockstep::is_follower(*port)) {
      Sampled own = found;
      own.faults = port->faults;
      Lockstep::count(port->faults, found.events.counted);
      port->report_counters(now);
      Lockstep::copy_leader(*port);
      apply(*port, own, now);
    } else if (is_sampling(*port, now)) {
      sample_port(*port, now);
    }
  }
  lockstep_.split_by_error_state();
}

/// The SOF of another port in the last bit of the intermission: ports that have something to send join in.
void BitwiseWire::split_at_early_start(const Sampled& found, can::Time now) {
  BusPort& leader = *lockstep_.leader();
  for (BusPort* port : lockstep_.sampling()) {
    if (port != &leader && is_sampling(*port, now)) sample_port(*port, now);
  }
  for (BusPort* port : wire_.members) {
    if (!Lockstep::is_follower(*port)) continue;
    Lockstep::copy_leader(*port);
    Sampled own = found;
    own.faults = port->faults;
    apply(*port, own, now);
    Lockstep::release(*port);
  }
  apply(leader, found, now);
  lockstep_.split_lockstep();
}

/// What was to happen to a frame that no port sends any more does not happen to the next one.
void BitwiseWire::cancel_abandoned_corruptions() {
  abandoned_ = false;
  const bool is_sent = std::ranges::any_of(lockstep_.sampling(),
                                           [](const BusPort* port) { return port->bits.transmitting(); });
  if (!is_sent) wire_.faults.corruptions = 0;
}

/// When the wire has to act next.
void BitwiseWire::schedule(can::Time now) {
  can::Time next = std::min(changed_ ? now : can::never, levels_.next_change(now));
  const std::vector<BusPort*>& sampling = lockstep_.sampling();
  if (sampling.empty() && active_ && !dominant_) next = now;  // there is no bit that ends
  if (wire_.core.clocks != nullptr) next = std::min(next, line_.next(now));
  for (const BusPort* port : sampling) {
    next = std::min(next, port->phase.next);
    if (has_late_drivers_) next = std::min(next, port->phase.output_changes);
    if (!replaying_ && may_begin(*port, now)) next = now;
  }
  wire_.deadline = next;
}

}  // namespace canopus::sim
