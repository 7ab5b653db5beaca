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
  line_.make_all_due();
  const bool is_healthy = !levels_.are_disturbed() && wire_.core.clocks == nullptr;
  is_regular_ =
      is_healthy && !have_bit_faults && std::ranges::all_of(wire_.members, [this](const BusPort* port) {
        return port->rate == wire_.members.front()->rate;
      });
  return is_healthy && !have_bit_faults;
}

void BitwiseWire::before_change() {
  if (ahead_.is_active) rewind(past_end());
  if (wire_.core.clocks != nullptr) line_.catch_up(past_end());
  simulate_contenders();
  lockstep_.split_lockstep();
}

can::Time BitwiseWire::past_end() const noexcept {
  const can::Time now = wire_.core.timeline.now();
  return wire_.core.has_ticked() ? now + can::Duration(1) : now;
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
  ahead_.is_active = false;
  wire_.uncontended = nullptr;
  for (const auto& port : wire_.core.ports) {
    if (wire_.has(*port)) port->phase = {};
  }
  const can::Time until = past_end();
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

bool BitwiseWire::has_new_members() const noexcept {
  const auto is_idle = [](const BusPort* port) { return port->bits.idle(); };
  const auto has_left = [](const BusPort* port) { return !port->present(); };
  return !wire_.core.wire_observers.empty() || std::ranges::all_of(lockstep_.sampling(), is_idle) ||
         std::ranges::any_of(lockstep_.sampling(), has_left);
}

void BitwiseWire::leave(can::Time now) {
  wire_.uncontended = nullptr;
  for (BusPort* port : wire_.members) {
    port->report_field(now);
    port->phase = {};
  }
}

bool BitwiseWire::end_bits(can::Time now) {
  if (std::exchange(ahead_.is_active, false) && now < ahead_.until) rewind(now);
  had_changed_ = std::exchange(changed_, false);
  completion_.run(now);
  if (!wire_.core.wire_observers.empty() &&
      std::ranges::any_of(lockstep_.leaders(), [](const BusPort* port) { return port->bits.quiet(); }))
    lockstep_.split_lockstep();
  if (dominant_ || !is_quiet(now)) return false;
  if (active_) {
    active_ = false;
    has_error_frame_ = false;
    if (!wire_.faults_ready) wire_.clear_faults();
    count_activity(now);
  }
  return !levels_.is_corrupted(now);
}

void BitwiseWire::run_bits(can::Time now) {
  begin_frames(now);
  if (wire_.core.clocks != nullptr) {
    line_.run(now, had_changed_);
  } else {
    begin_bits(now);
    sample(now);
  }
  if (abandoned_) cancel_abandoned_corruptions(now);
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
  const BusPort& sampler = Lockstep::sampler_of(port);
  return (sampler.bits.idle() || (has_early_ports_ && sampler.bits.may_begin())) &&
         is_between_bits(sampler, now) && port.offer() != Arbiter::none;
}

/// The wire was busy from activity_start_ on.
void BitwiseWire::count_activity(can::Time now) {
  const can::Duration bit = can::bit_time(1, wire_.core.bit_rate);
  activity_start_ = std::min(activity_start_, now);
  wire_.count_busy(activity_start_, now, static_cast<std::uint64_t>((now - activity_start_) / bit));
}

/// Each controller begins by its own bits, whatever the others are still doing: those that are not idle yet see
/// the SOF where they are.
void BitwiseWire::begin_frames(can::Time now) {
  if (replaying_ || wire_.arbiter.lowest() == Arbiter::none) return;
  BusPort* uncontended = is_uniform() ? begin_uncontended(now) : nullptr;
  const BusPort* first = uncontended != nullptr ? uncontended : begin_each(now);
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
  for (std::size_t number = 0; number < wire_.faults.corruptions; ++number) {
    const FrameFaults::Corruption& corruption = wire_.faults.corruption[number];
    if (corruption.at != nullptr &&
        wire_.has(*corruption.at))  // a port behind a cut has its own wire's lockstep
      lockstep_.take_out(*wire_.core.ports[corruption.at->index]);
    if (uncontended != nullptr && !uncontended->bits.is_behind_arbitration(corruption.bit)) {
      begin_each(now);
      uncontended = nullptr;
    }
  }
  wire_.uncontended = uncontended;
  wire_.faults_ready = false;
  abandoned_ = false;
  has_error_frame_ = false;
  levels_.begin_frame(now, first->bit());
}

/// Nothing but what the ports mean to drive makes the level, all see the same, and no observer sees the wire.
bool BitwiseWire::is_uniform() const noexcept { return is_regular_ && wire_.core.wire_observers.empty(); }

/// All that may begin do so now, and none is within anything else than waiting: the one that will win arbitration begins alone.
/// Null: it is not so.
BusPort* BitwiseWire::begin_uncontended(can::Time now) {
  Arbiter& arbiter = wire_.arbiter;
  lockstep_.form_lockstep();
  const std::vector<BusPort*>& sampling = lockstep_.sampling();
  for (const BusPort* port : sampling) {
    if (!port->bits.quiet() || (port->bits.idle() && !is_between_bits(*port, now))) return nullptr;
  }
  waiting_.clear();  // with an offer that is not for this frame
  for (BusPort* port : wire_.members) {
    if (arbiter.of(port->index) != Arbiter::none && !Lockstep::sampler_of(*port).bits.idle())
      waiting_.push_back(port);
  }
  for (const BusPort* port : waiting_) arbiter.set(port->index, Arbiter::none);
  const std::uint64_t lowest = arbiter.lowest();
  const bool has_winner = lowest != Arbiter::none && !arbiter.is_lowest_shared();
  for (const BusPort* port : waiting_) arbiter.set(port->index, port->offer());
  if (!has_winner) return nullptr;
  wire_.frame_number = ++wire_.core.frame_number;
  for (BusPort* port : waiting_) port->take_no_part(wire_.frame_number);
  BusPort& winner = *wire_.core.ports[Arbiter::port_of(lowest)];
  lockstep_.take_out(winner);
  begin_frame(winner, now);
  return &winner;
}

/// Returns the one that will win arbitration; null: none begins.
BusPort* BitwiseWire::begin_each(can::Time now) {
  for (BusPort* leader : std::vector<BusPort*>(lockstep_.leaders())) {
    if (!may_lockstep_begin(*leader, now)) continue;
    lockstep_.split(*leader, [](const BusPort& port) { return port.offer() != Arbiter::none; });
    if (leader->offer() != Arbiter::none) lockstep_.take_out(*leader);
  }
  BusPort* first = nullptr;
  for (BusPort* port : lockstep_.sampling()) {
    if (!may_begin(*port, now)) continue;
    begin_frame(*port, now);
    if (first == nullptr || arbitration(port->current) < arbitration(first->current)) first = port;
  }
  return first;
}

void BitwiseWire::begin_frame(BusPort& port, can::Time now) {
  port.begin_next();
  wire_.arbiter.set(port.index, port.offer());
  port.bits.transmit(port.current);
  port.phase.frame_start = now;
  port.phase.next = now;
  port.phase.lost_at = WireFrame::Sender::won;
  line_.make_all_due();
}

/// The leader or one of its followers may.
bool BitwiseWire::may_lockstep_begin(const BusPort& leader, can::Time now) const noexcept {
  if (!leader.bits.idle() || !is_between_bits(leader, now) || wire_.arbiter.lowest() == Arbiter::none)
    return false;
  return std::ranges::any_of(wire_.members, [&](const BusPort* port) {
    return &Lockstep::sampler_of(*port) == &leader && port->offer() != Arbiter::none;
  });
}

/// Ports that have taken part in arbitration so far without being simulated are from here on.
void BitwiseWire::simulate_contenders() {
  const BusPort* winner = std::exchange(wire_.uncontended, nullptr);
  if (winner == nullptr || !(winner->bits.transmitting() || winner->phase.transmitted)) return;
  lockstep_.split_lockstep();
  for (BusPort* port : wire_.members) {
    if (port == winner) continue;
    if (port->pending.frame_number != wire_.frame_number) port->snapshot_pending(wire_.frame_number);
    if (!port->pending.offered) continue;
    const BitProgress as_receiver = port->bits.progress();
    if (const auto lost_at = port->bits.contend(port->pending.frame, winner->bits)) {
      port->bits.resume(as_receiver);
      port->phase.lost_at = *lost_at;
      continue;
    }
    port->restore_pending();
    wire_.arbiter.set(port->index, port->offer());
    port->phase.frame_start = winner->phase.frame_start;
    port->phase.driving = winner->phase.sampling ? port->bits.drives_dominant() : winner->phase.driving;
    put_on_wire(*port, winner->phase.bit_start);
  }
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
  for (const BusPort* leader : lockstep_.leaders()) {
    if (leader->phase.received) lockstep_.copy_deadline(*leader);
  }
}

/// The bit that begins for the port.
void BitwiseWire::report_bit(BusPort& port, can::Time now) {
  port.report_output(now);
  port.report_activity(now);
  port.report_field(now);
  if (port.lockstep.followers > 0) lockstep_.report_bit(port, now);
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
  lockstep_.take_out_recovering();
  if (sample_leaders(now)) {
    apply_to_lockstep(now);
  } else {
    sample_alone(now);
  }
  wire_.core.report(now);
  if (std::exchange(begun_, false) && !wire_.core.needs_bits()) lockstep_.form_lockstep();
}

/// The ports that have no followers.
void BitwiseWire::sample_alone(can::Time now) {
  for (BusPort* port : lockstep_.sampling()) {
    if (is_sampling(*port, now)) sample_port(*port, now);
  }
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
  sampled.dominant = phase.sampled;
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
    wire_.uncontended = nullptr;  // its frame is over, even if it joins, too
  }
  if (replaying_) return;  // an error frame was counted and reported when it was computed
  if (events.error != BusError::none) report_bit_error(port, sampled, now);
  if (events.recovered) port.recovering = false;
  report_state(port, sampled.faults);
}

/// Its counters have changed, and its state perhaps.
void BitwiseWire::report_state(BusPort& port, const can::FaultConfinement& before) {
  const can::ErrorState state = before.state();
  if (port.faults.state() == state && port.faults.warning() == before.warning()) return;
  port.phase.changed = wire_.controllers_changed = true;
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
                     .dominant = sampled.dominant,
                     .first = !has_error_frame_});
  if (!has_error_frame_) wire_.count_error_frame();
  has_error_frame_ = true;
  for (can::BusObserver* observer : wire_.core.observers) observer->error_detected(port, error, now);
}

/// Leaves in found_ what the leaders found whose sample point it is. False: nothing that changes their followers.
bool BitwiseWire::sample_leaders(can::Time now) {
  found_.clear();
  for (BusPort* leader : lockstep_.leaders()) {
    if (!is_sampling(*leader, now)) continue;
    const Sampled found = sample_bit(*leader, now);
    if (found.events != BitController::Events{}) found_.push_back({leader, found});
  }
  return !found_.empty();
}

/// In the order of the ports: found_, and the sample points of all others.
void BitwiseWire::apply_to_lockstep(can::Time now) {
  for (BusPort* port : wire_.members) {
    if (Lockstep::is_follower(*port)) {
      const Sampled* found = found_by(port->lockstep.leader);
      if (found != nullptr && !found->events.early_start) apply_to_follower(*port, *found, now);
    } else if (const Sampled* found = found_by(port)) {
      if (!found->events.early_start) apply(*port, *found, now);
    } else if (is_sampling(*port, now)) {
      sample_port(*port, now);
    }
  }
  for (const FoundByLeader& one : found_) {
    if (one.found.events.early_start) join_early(*one.leader, one.found, now);
  }
  lockstep_.split_by_error_state();
}

/// The SOF of another port in the last bit of the intermission: ports of this lockstep that have something to send join in.
void BitwiseWire::join_early(BusPort& leader, const Sampled& found, can::Time now) {
  const auto joins = [](const BusPort& port) { return port.offer() != Arbiter::none; };
  waiting_.clear();
  for (BusPort* port : wire_.members) {
    if (port->lockstep.leader == &leader && joins(*port)) waiting_.push_back(port);
  }
  lockstep_.split(leader, joins);
  if (joins(leader)) {
    lockstep_.take_out(leader);
    waiting_.push_back(&leader);
  }
  for (BusPort* port : waiting_) {
    Sampled own = found;
    own.faults = port->faults;
    apply(*port, own, now);
  }
}

const BitwiseWire::Sampled* BitwiseWire::found_by(const BusPort* leader) const noexcept {
  const auto found = std::ranges::find(found_, leader, &FoundByLeader::leader);
  return found == found_.end() ? nullptr : &found->found;
}

/// A follower receives, or has received: it sends nothing that could fail.
void BitwiseWire::apply_to_follower(BusPort& port, const Sampled& found, can::Time now) {
  const can::FaultConfinement before = port.faults;
  Lockstep::count(port.faults, found.events.counted);
  if (!wire_.core.wire_observers.empty()) {
    port.report_counters(now);
    Lockstep::copy_leader(port);
  }
  if (found.events.received) {
    Lockstep::copy_leader(port);
    completion_.note(port, found.events);
  }
  if (found.events.error != BusError::none) {
    port.phase.lost_at = WireFrame::Sender::won;
    if (!replaying_) report_bit_error(port, found, now);
  }
  if (!replaying_) report_state(port, before);
}

/// What was to happen to a frame that no port sends any more does not happen to the next one. A bit that is corrupted now stays so
/// to its end: else the level would change with whatever the wire does next.
void BitwiseWire::cancel_abandoned_corruptions(can::Time now) {
  abandoned_ = false;
  const bool is_sent = std::ranges::any_of(lockstep_.sampling(),
                                           [](const BusPort* port) { return port->bits.transmitting(); });
  if (is_sent) return;
  FrameFaults& faults = wire_.faults;
  FrameFaults::Corruption* const begin = faults.corruption;
  const auto is_over = [&](const auto& corruption) { return !levels_.is_at_work(corruption, now); };
  faults.corruptions =
      static_cast<std::size_t>(std::remove_if(begin, begin + faults.corruptions, is_over) - begin);
}

/// When the wire has to act next.
void BitwiseWire::schedule(can::Time now) {
  can::Time next = std::min(changed_ ? now : can::never, levels_.next_change(now));
  const std::vector<BusPort*>& sampling = lockstep_.sampling();
  if (sampling.empty() && active_ && !dominant_) next = now;  // there is no bit that ends
  const bool is_on_line = wire_.core.clocks != nullptr;
  if (is_on_line) next = std::min(next, line_.next());
  const bool may_some_begin = !replaying_ && wire_.arbiter.lowest() != Arbiter::none;
  if (!is_on_line || may_some_begin || has_late_drivers_) {
    for (const BusPort* port : sampling) {
      if (!is_on_line) next = std::min(next, port->phase.next);
      if (has_late_drivers_) next = std::min(next, port->phase.output_changes);
      if (may_some_begin && may_begin(*port, now)) next = now;
    }
  }
  for (const BusPort* leader : lockstep_.leaders()) {
    if (may_some_begin && may_lockstep_begin(*leader, now)) next = now;
  }
  wire_.deadline = next;
  if (!replaying_ && next > now && is_uniform()) run_ahead();
}

}  // namespace canopus::sim
