// A segment bit by bit.

#include <algorithm>
#include <utility>

#include "canopus/sim/bus/line/line_clocks.hpp"
#include "canopus/sim/bus/segment.hpp"

namespace canopus::sim {
namespace {

// CiA recommends the sample point at 87.5 % of the bit; one eighth of a bit is also the most that one edge
// may move it.
can::Duration sample_offset(can::Duration bit) { return bit - bit / 8; }
can::Duration jump_width(can::Duration bit) { return bit / 8; }

}  // namespace

void Segment::begin_bits(can::Time now) {
  const FrameFaults faults = faults_;  // of the frame that begins
  const bool ready = faults_ready_;
  clear_faults();  // what is replayed is not that frame
  enter_bits();
  faults_ = faults;
  faults_ready_ = ready;
  bits_tick(now, false);
}

/// Nothing of a frame is left, for nobody, and whoever is idle is at the end of its bit.
bool Segment::quiet(can::Time now) const noexcept {
  return std::all_of(working_.begin(), working_.end(), [now](const BusPort* port) {
    return port->bits.quiet() && (!port->bits.idle() || between_bits(*port, now));
  });
}

void Segment::bits_tick(can::Time now, bool may_leave) {
  const bool has_changed = std::exchange(changed_, false);
  complete_frames(now);
  if (lockstep_leader_ != nullptr && lockstep_leader_->bits.quiet()) part();
  if (!dominant_ && quiet(now)) {
    if (active_) {
      active_ = false;
      error_frame_ = false;
      if (!faults_ready_) clear_faults();
      count_activity(now);
    }
    if (may_leave && leave_bits_if_healthy(now)) return;
  }
  start_waiting(now);
  if (core_.clocks != nullptr) {
    settle_line(now, has_changed);
  } else {
    settle(now);
    sample(now);
  }
  if (given_up_) forget_given_up();
  tell_changes(now);
  schedule(now);
}

/// The wire was busy from activity_start_ on.
void Segment::count_activity(can::Time now) {
  const can::Duration bit = can::bit_time(1, core_.bit_rate);
  activity_start_ = std::min(activity_start_, now);
  core_.statistics.busy(activity_start_, now, static_cast<std::uint64_t>((now - activity_start_) / bit));
}

/// Frames whose last bit ends now.
void Segment::complete_frames(can::Time now) {
  if (!completing_) return;
  const BusPort* reporter = nullptr;
  for (BusPort* port : members_) {
    const BusPort::BitPhase& tap = port->tap;
    if ((!tap.transmitted && !tap.received) || tap.next > now || tap.counted) continue;
    if (reporter == nullptr || (tap.transmitted && !reporter->tap.transmitted)) reporter = port;
  }
  if (reporter != nullptr) {  // everybody has the same frame
    const can::Frame frame = reporter->tap.transmitted ? reporter->current : reporter->bits.frame();
    // A late driver has the others end the same frame at different moments.
    if (reporter->tap.frame_start >= reported_until_ || frame != reported_) {
      reported_ = frame;
      reported_until_ = now;
      core_.statistics.frame(frame);
      if (!core_.wire_observers.empty()) tell_arbitration(frame, reporter->tap.frame_start);
      for (BusObserver* observer : core_.observers) {
        observer->frame_completed(frame, reporter->tap.frame_start, now);
      }
    }
  }
  for (BusPort* port : members_) {
    if (!port->tap.transmitted || port->tap.next > now) continue;
    port->tap.transmitted = port->tap.counted = false;
    port->confirm = port->complete();
    arbiter_.set(port->index, port->offer());
  }
  // By number: who is notified may plug, unplug and add ports.
  for (std::size_t number = 0; number < core_.ports.size(); ++number) {
    BusPort& port = *core_.ports[number];
    if (port.segment != this || !port.tap.received || port.tap.next > now) continue;
    port.tap.received = port.tap.counted = false;
    port.tap.lost_at = WireFrame::Sender::won;
    const can::Frame heard = port.bits.frame();
    const std::uint64_t wanted = core_.acceptance.ports_for(heard)[port.index / 64];
    if ((wanted >> (port.index % 64) & 1U) != 0 && !dropped(port)) port.hear(heard, now);
  }
  for (std::size_t number = 0; number < core_.ports.size(); ++number) {
    BusPort& port = *core_.ports[number];
    if (!port.confirm) continue;
    port.confirm = false;
    const can::Frame sent = port.current;
    port.notify_transmitted(sent, now);
  }
  completing_ = std::any_of(members_.begin(), members_.end(),
                            [](const BusPort* port) { return port->tap.received || port->tap.transmitted; });
}

bool Segment::leave_bits_if_healthy(can::Time now) {
  if (replaying_) return false;
  reconsider();
  if (!healthy_ && !lone_) return false;
  for (BusPort* port : members_) {
    tell_place(*port, now);
    port->tap = {};
    counting_ = counting_ || !port->faults.clean();
  }
  state_ = State::idle;
  free_from_ = std::max(free_from_, now);
  deadline_ = arbiter_.lowest() == Arbiter::none ? can::never : free_from_;
  if (deadline_ == now) start(now);
  return true;
}

/// It is asleep, or its bit ends now.
bool Segment::between_bits(const BusPort& port, can::Time now) noexcept {
  return !port.tap.sampling && (port.tap.next == can::never || port.tap.next <= now);
}

/// It may begin its frame: the bus is idle for it, and it is not within a bit.
bool Segment::ready(const BusPort& port, can::Time now) const noexcept {
  return (port.bits.idle() || (some_early_ && port.bits.may_begin())) && between_bits(port, now) &&
         port.offer() != Arbiter::none;
}

/// Each controller begins by its own bits, whatever the others are still doing: those that are not idle yet see
/// the SOF where they are.
void Segment::start_waiting(can::Time now) {
  if (replaying_) return;
  const BusPort* first = nullptr;
  for (BusPort* port : working_) {
    if (!ready(*port, now)) continue;
    port->take_next();
    arbiter_.set(port->index, port->offer());
    port->bits.transmit(port->current);
    port->tap.frame_start = now;
    port->tap.next = now;
    port->tap.lost_at = WireFrame::Sender::won;
    if (first == nullptr || arbitration(port->current) < arbitration(first->current)) first = port;
  }
  if (first == nullptr) return;
  if (active_) {  // somebody is still in its error frame: what belongs to the last frame ends here all the same
    count_activity(now);
    activity_start_ = now;
  }
  if (!faults_ready_) {
    faults_ = core_.plan.hits_frames() ? core_.plan.on_frame(*first, first->bit(), first->current, now)
                                       : FrameFaults{};
  }
  if (lockstep_leader_ != nullptr && faults_.corruptions > 0) part();  // it may hit one of them alone
  faults_ready_ = false;
  given_up_ = false;
  error_frame_ = false;
  faults_origin_ = now;
  faults_bit_ = first->bit();
  look_for_views();
}

/// Lets bits begin that begin now and finds the level of the wire.
void Segment::settle(can::Time now) {
  if (state_ != State::bits) return;
  bool dominant = forced_;
  bool asleep = false;  // somebody since now
  for (BusPort* port : working_) {
    BusPort::BitPhase& tap = port->tap;
    if (tap.next == now && !tap.sampling) {
      tap.bit_start = now;
      if (port->bits.idle()) {
        tap.next = can::never;  // asleep until the wire is dominant
        tap.synchronised = false;
        asleep = true;
      } else {
        tap.next = now + sample_offset(port->bit());
        tap.sampling = true;
      }
      tap.driving = port->bits.drives_dominant();
      put_on_wire(*port, now);
      if (!core_.wire_observers.empty()) {
        tell_driven(*port, now);
        tell_activity(*port, now);
        tell_place(*port, now);
        if (port == lockstep_leader_) tell_together(now);
      }
    }
    if (some_late_ && tap.reaches <= now) tap.reach(tap.reaching_next);
    dominant = dominant || tap.reaching;
  }
  if (!core_.wire_observers.empty() && (reconsidered_ || forced_ || some_late_)) {
    for (const auto& port : core_.ports) tell_driven(*port, now);
    reconsidered_ = false;
  }
  if (termination_ != Termination{}) dominant = driven_level(dominant, now);
  dominant = dominant != inverted(nullptr, now);
  if (driven_.level != DrivenLevel::released) dominant = driven_.level == DrivenLevel::dominant;
  if (asleep || seen_apart_) {  // there is no edge for those who see a dominant bit from here on
    for (BusPort* port : working_) {
      if (dominant != inverted(port, now)) wake(*port, now);
    }
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
  if (!dominant) return;
  if (!active_) {
    active_ = true;
    activity_start_ = now;
  }
  for (BusPort* port : working_) synchronise(*port, now);
  if (lockstep_leader_ != nullptr && lockstep_leader_->tap.received) keep_in_step();
}

/// Whoever is asleep begins to sample.
void Segment::wake(BusPort& port, can::Time now) {
  if (!port.bits.idle() || port.tap.next != can::never || core_.clocks != nullptr) return;
  port.tap.bit_start = now;
  port.tap.next = now + sample_offset(port.bit());
  port.tap.sampling = true;
}

/// An edge from recessive to dominant [ISO 11898-1 synchronisation]: at most one between two sample points counts, and
/// only if the last sample was recessive. It restarts the bit of whoever waits for a frame, from the second bit of
/// the intermission on; else it moves it by the jump width at most.
void Segment::synchronise(BusPort& port, can::Time now) {
  BusPort::BitPhase& tap = port.tap;
  if (tap.sampled || tap.synchronised) return;
  if (tap.next != can::never && tap.bit_start == now) {
    tap.synchronised = true;
    return;
  }
  const can::Duration bit = port.bit();
  if (port.bits.synchronises_hard()) {
    if (port.bits.state() == BitController::State::bus_off && !port.recovering) return;
    tap.synchronised = true;
    tap.bit_start = now;  // hard synchronisation
    tap.next = now + sample_offset(bit);
    tap.sampling = true;
    return;
  }
  if (tap.sampling) {
    if (tap.driving) return;
    tap.synchronised = true;
    const can::Duration late = std::min(now - tap.bit_start, jump_width(bit));
    tap.bit_start += late;
    tap.next += late;
  } else {
    tap.synchronised = true;
    const can::Duration early = std::min(tap.next - now, jump_width(bit));
    tap.next -= early;
  }
}

void Segment::sample(can::Time now) {
  if (lockstep_leader_ != nullptr && is_sampling(*lockstep_leader_, now)) {
    sample_together(now);
  } else {
    for (BusPort* port : working_) {
      if (is_sampling(*port, now)) sample_port(*port, now);
    }
  }
  core_.report(now);
  if (begun_) gather();
}

void Segment::sample_port(BusPort& port, can::Time now) {
  const Sampled sampled = look(port, now);
  if (sampled.events != BitController::Events{} || port.faults != sampled.faults)
    conclude(port, sampled, now);
}

/// The port's controller samples its bit.
Segment::Sampled Segment::look(BusPort& port, can::Time now) {
  BusPort::BitPhase& tap = port.tap;
  Sampled sampled{
      .faults = port.faults, .position = port.bits.position(), .is_transmitter = port.bits.is_transmitter()};
  const bool in_frame = port.bits.state() == BitController::State::frame;
  tap.sampled = seen_apart_ ? seen_at(port, now) : dominant_;
  tap.synchronised = false;
  port.bits.sample(tap.sampled, sampled.events);
  if (port.faults != sampled.faults) tell_counters(port, now);
  if (!in_frame && port.bits.state() == BitController::State::frame) {
    tap.frame_start = tap.bit_start;
    begun_ = true;
  }
  if (sampled.events.lost) {
    tap.lost_at = sampled.position.payload;  // never a stuff bit: that is an error
    begun_ = true;
  }
  tap.sampling = false;
  tap.next = tap.bit_start + port.bit();
  return sampled;
}

/// What follows from it for the port's queue, its participant and those who watch.
void Segment::conclude(BusPort& port, const Sampled& sampled, can::Time now) {
  BusPort::BitPhase& tap = port.tap;
  const BitController::Events& events = sampled.events;
  if (events.error != BusError::none) {
    given_up_ = true;
    tap.lost_at = WireFrame::Sender::won;
  }
  if (port.sending && (events.lost || events.error != BusError::none)) {
    port.requeue();
    arbiter_.set(port.index, port.offer());
  }
  completing_ = completing_ || events.received || events.transmitted;
  tap.received = tap.received || events.received;
  tap.transmitted = tap.transmitted || events.transmitted;
  if (events.early_start && port.offer() != Arbiter::none) {
    port.take_next();
    arbiter_.set(port.index, port.offer());
    port.bits.join(port.current);
  }
  if (replaying_) return;  // an error frame was counted and reported when it was computed
  if (events.error != BusError::none) {
    ++port.counted.errors;
    report_error(port, {.error = events.error,
                        .field = sampled.position.field(),
                        .bit = sampled.position.number,
                        .transmitter = sampled.is_transmitter,
                        .dominant = tap.sampled,
                        .first = !error_frame_});
    if (!error_frame_) core_.statistics.error_frame();
    error_frame_ = true;
    for (BusObserver* observer : core_.observers) observer->error_detected(port, events.error, now);
  }
  if (events.recovered) port.recovering = false;
  const can::ErrorState state = sampled.faults.state();
  const bool has_changed = port.faults.state() != state || port.faults.warning() != sampled.faults.warning();
  if (has_changed) {
    tap.changed = changes_ = true;
    if (port.faults.state() == can::ErrorState::bus_off) {
      ++port.counted.bus_offs;
      if (port.automatic_recovery) port.recovering = true;
      port.bits.set_recovering(port.recovering);
    }
    arbiter_.set(port.index, port.offer());
    core_.note_controller(port, state);
  }
}

void Segment::tell_changes(can::Time now) {
  if (!changes_) return;
  changes_ = false;
  for (const auto& port : core_.ports) {
    if (port->segment != this || !port->tap.changed) continue;
    port->tap.changed = false;
    if (port->participant != nullptr) port->participant->controller_changed(now);
  }
}

/// When the segment has to act next.
void Segment::schedule(can::Time now) {
  if (state_ != State::bits) return;
  can::Time next = changed_ ? now : can::never;
  for (std::size_t number = 0; number < faults_.corruptions; ++number) {
    const can::Time begin = faults_origin_ + faults_bit_ * faults_.corruption[number].bit;
    if (begin > now) {
      next = std::min(next, begin);
    } else if (begin + faults_bit_ > now) {
      next = std::min(next, begin + faults_bit_);
    }
  }
  if (released_ > now) next = std::min(next, released_);
  if (working_.empty() && active_ && !dominant_) next = now;  // nobody has a bit that ends
  if (core_.clocks != nullptr) next = std::min(next, next_look_on_line(now));
  for (const BusPort* port : working_) {
    next = std::min(next, port->tap.next);
    if (some_late_) next = std::min(next, port->tap.reaches);
    if (!replaying_ && ready(*port, now)) next = now;
  }
  deadline_ = next;
}

}  // namespace canopus::sim
