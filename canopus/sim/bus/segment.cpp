// A segment frame by frame.

#include "canopus/sim/bus/segment.hpp"

#include <algorithm>
#include <bit>

namespace canopus::sim {
namespace {

// Bits of a frame after its ACK slot: ACK delimiter and EOF.
constexpr unsigned after_ack_slot = 1 + 7;
constexpr unsigned error_flag_bits = 6;
constexpr unsigned error_delimiter_bits = 8;

}  // namespace

void Segment::resize() {
  arbiter_.resize(core_.ports.size());
  hearing_.resize(core_.acceptance.words());
}

void Segment::reconsider() {
  part();
  ++membership_;
  reconsidered_ = true;
  members_.clear();
  forced_ = some_early_ = some_late_ = false;
  bool has_bit_faults = false;
  for (const auto& port : core_.ports) {
    if (port->segment != this) {
      arbiter_.set(port->index, Arbiter::none);
      continue;
    }
    forced_ = forced_ || (port->on_wire && port->stuck);
    arbiter_.set(port->index, port->offer());
    if (port->present()) {
      members_.push_back(port.get());
      has_bit_faults = has_bit_faults || port->has_bit_fault();
      some_early_ = some_early_ || port->early_bits > 0;
      some_late_ = some_late_ || port->lateness > can::Duration{};
      if (port->lateness == can::Duration{}) port->tap.reach(port->tap.driving && !port->mute);
    } else {
      fall_silent(*port);  // bus-off for good
    }
  }
  working_ = members_;
  look_for_views();
  // Frames are computed as a whole when all have one bit rate. A controller with another one stays on the wire, where
  // it samples, counts and disturbs as it does on a real one.
  const std::uint32_t rate = members_.empty() ? 0 : members_.front()->rate;

  const bool computable = !shows_bits() && !forced_ && !driven_.is_busy && !inverted_ && !has_bit_faults &&
                          termination_ == Termination{} && core_.clocks == nullptr;
  healthy_ = computable;
  std::size_t acknowledging = 0;
  std::fill(hearing_.begin(), hearing_.end(), 0);
  for (const BusPort* port : members_) {
    hearing_[port->index / 64] |= std::uint64_t{1} << (port->index % 64);
    if (!port->listen_only) ++acknowledging;
    if (port->rate != rate || !port->bits.idle()) healthy_ = false;
  }
  lone_ = members_.size() == 1 && acknowledging == 1 && members_[0]->bits.idle() && computable &&
          core_.wire_observers.empty();
  healthy_ = healthy_ && acknowledging >= 2;
}

void Segment::suspended_offer_changed() {
  if (state_ != State::idle || suspended_->offer() == Arbiter::none || suspended_until_ >= deadline_) return;
  deadline_ = std::max(core_.timeline.now(), suspended_until_);
  core_.deadline_changed();
}

/// After what the port offers has changed, and while no frame is on the wire: the next one may begin earlier.
void Segment::look_for_start(const BusPort& port) {
  if (state_ == State::lone_frame) return;
  if (state_ == State::bits ? !ready(port, core_.timeline.now()) : arbiter_.lowest() == Arbiter::none) return;
  const can::Time possible =
      state_ == State::bits ? core_.timeline.now() : std::max(core_.timeline.now(), free_from_);
  if (possible >= deadline_) return;
  deadline_ = possible;
  core_.deadline_changed();
}

void Segment::before_change() {
  enter_bits();
  part();
}

void Segment::after_change() {
  const can::Time now = core_.timeline.now();
  reconsider();
  if (!active_ && !quiet(now)) {
    active_ = true;
    activity_start_ = now;
  }
  // The bus's tick at this moment does the rest: what ends or begins now may be part of it.
  given_up_ = changed_ = true;
  deadline_ = now;
  core_.deadline_changed();
}

void Segment::arrive(BusPort& port, const Segment& from) {
  if (port.tap.received || port.tap.transmitted) {
    completing_ = true;
    port.tap.counted = std::any_of(from.members_.begin(), from.members_.end(), [&](const BusPort* other) {
      return other->segment == &from && (other->tap.received || other->tap.transmitted);
    });
  }
  if (dominant_) wake(port, core_.timeline.now());
}

void Segment::restart(BusPort& port) {
  take_off(port);
  tell_counters(port, core_.timeline.now());
  port.bits.set_recovering(port.recovering);
  port.bits.restart(false);
  port.tap.bit_start = core_.timeline.now();
  port.tap.next = port.tap.bit_start;
}

void Segment::take_off(BusPort& port) {
  if (port.sending && port.tap.transmitted) {  // complete but for the end of its last bit
    port.confirm = port.complete();
  } else if (port.sending) {
    port.requeue();
  }
  port.sending = false;
  port.bits.restart(true);
  fall_silent(port);
  port.tap = {};
}

void Segment::start(can::Time now) {
  if (suspended_ != nullptr && now >= suspended_until_) end_suspension();
  const std::uint64_t winner = arbiter_.lowest();
  if (winner == Arbiter::none) {
    const bool waits = suspended_ != nullptr && suspended_->offer() != Arbiter::none;
    deadline_ = waits ? suspended_until_ : can::never;
    return;
  }
  if (!healthy_ && !lone_) return begin_bits(now);
  BusPort& port = *core_.ports[Arbiter::port_of(winner)];
  port.take_next();  // it stays in the arbiter: most often it will offer the same identifier again
  if (core_.plan.hits_frames()) {
    faults_ = core_.plan.on_frame(port, port.bit(), port.current, now);
    faults_ready_ = true;
  }
  // A waveform shows a suspension, which is not told as a whole.
  const bool shows_suspension =
      !core_.wire_observers.empty() && port.faults.state() == can::ErrorState::error_passive;
  // A new state is reported at the sample point that it comes with, within the frame.
  const bool changes_a_controller = healthy_ && counting_ && success_changes_a_controller(port);
  if (faults_.corruptions > 0 || arbiter_.is_lowest_shared() || shows_suspension || changes_a_controller) {
    port.requeue();
    arbiter_.set(port.index, port.offer());
    return begin_bits(now);
  }
  faults_ready_ = false;
  failed_ = false;
  suspended_at_sof_ = suspended_;
  if (suspended_ != nullptr) end_suspension();  // it has become a receiver
  transmitter_ = &port;
  frame_number_ = ++core_.frame_number;
  start_ = now;
  bits_ = can::frame_bits(port.current);
  if (healthy_) {
    state_ = State::frame;
    deadline_ = now + port.time_of(bits_);
  } else {
    state_ = State::lone_frame;
    deadline_ = now + can::bit_time(bits_ - after_ack_slot, port.rate) - after_sample_point(port.bit());
  }
}

/// Ready for the next frame at `from`.
void Segment::become_idle(can::Time from) {
  state_ = State::idle;
  free_from_ = from;
  deadline_ = arbiter_.lowest() == Arbiter::none ? can::never : from;
}

/// A passive transmitter lets the others go first.
void Segment::suspend(BusPort& port, can::Time until) {
  suspended_ = &port;
  suspended_until_ = until;
  arbiter_.set(port.index, Arbiter::none);
  if (arbiter_.lowest() != Arbiter::none) return;
  deadline_ = port.offer() == Arbiter::none ? can::never : until;
}

void Segment::end_suspension() {
  arbiter_.set(suspended_->index, suspended_->offer());
  suspended_ = nullptr;
}

void Segment::finish(can::Time now) {
  BusPort& port = *transmitter_;
  if (!core_.wire_observers.empty()) tell_frame();
  const can::Frame frame = port.current;
  const bool own = port.complete();
  const can::Time next = now + port.time_of(can::intermission_bits);
  core_.statistics.frame(frame);
  core_.statistics.busy(start_, next, bits_ + can::intermission_bits);
  if (counting_) count_success(port);
  become_idle(next);
  if (counting_ && port.faults.state() == can::ErrorState::error_passive) {
    suspend(port, next + can::bit_time(suspend_bits, port.rate));
  }
  for (BusObserver* observer : core_.observers) observer->frame_completed(frame, start_, now);
  core_.report(now);
  deliver(frame, port, now);
  if (own) port.notify_transmitted(frame, now);
  if (state_ == State::idle && port.segment == this && &port != suspended_) {
    arbiter_.set(port.index, port.offer());
    deadline_ = arbiter_.lowest() == Arbiter::none ? can::never : next;
  }
}

void Segment::deliver_to_all(const can::Frame& frame, const BusPort& from, can::Time now) {
  const AcceptanceTable::Ports wanted = core_.acceptance.ports_for(frame);
  for (std::size_t word = 0; word < hearing_.size(); ++word) {
    std::uint64_t ports = wanted[word] & hearing_[word];
    while (ports != 0) {
      const std::size_t number = 64 * word + static_cast<std::size_t>(std::countr_zero(ports));
      ports &= ports - 1;
      if (number != from.index) deliver_to(number, frame, now);
    }
  }
}

/// Success takes errors back, rules g and h.
can::FaultConfinement Segment::after_success(const BusPort& port, const BusPort& transmitter) const noexcept {
  can::FaultConfinement faults = port.faults;
  if (port.listen_only) return faults;
  if (&port == &transmitter) {
    faults.transmitted();
  } else {
    faults.received();
  }
  return faults;
}

bool Segment::success_changes_a_controller(const BusPort& transmitter) const noexcept {
  return std::ranges::any_of(members_, [&](const BusPort* port) {
    if (port->faults.clean()) return false;
    const can::FaultConfinement after = after_success(*port, transmitter);
    return after.state() != port->faults.state() || after.warning() != port->faults.warning();
  });
}

/// None of them comes to another state: such a frame goes bit by bit.
void Segment::count_success(BusPort& transmitter) {
  counting_ = false;
  for (BusPort* port : members_) {
    if (port->faults.clean()) continue;
    port->faults = after_success(*port, transmitter);
    counting_ = counting_ || (!port->listen_only && !port->faults.clean());
  }
}

can::FaultConfinement Segment::counters_of(const BusPort& port) const noexcept {
  if (state_ != State::frame || !counting_ || !port.present()) return port.faults;
  const BusPort& sender = *transmitter_;
  const unsigned bits = &port == &sender ? bits_ : bits_ - after_ack_slot;  // up to the one that counts
  const can::Time sampled = start_ + sender.time_of(bits) - after_sample_point(sender.bit());
  const can::Time now = core_.timeline.now();
  const bool is_counted = sampled < now || (sampled == now && core_.has_ticked());
  return is_counted ? after_success(port, sender) : port.faults;
}

void Segment::fail_lone(can::Time now) {
  BusPort& port = *transmitter_;
  // A passive transmitter that sees no dominant bit in its error flag counts no acknowledgement error: alone
  // on the bus it stays passive for ever and is never bus-off.
  const bool was_passive = port.faults.state() == can::ErrorState::error_passive;
  const bool was_warned = port.faults.warning();
  failed_ = true;
  faults_before_ = port.faults;
  if (!was_passive) port.faults.transmitter_error();
  counting_ = true;
  ++port.counted.errors;
  core_.statistics.error_frame();
  const bool passive = port.faults.state() == can::ErrorState::error_passive;
  const unsigned bits = error_flag_bits + error_delimiter_bits + can::intermission_bits;
  const can::Time end = now + after_sample_point(port.bit()) + can::bit_time(bits, port.rate);
  const can::Time next = passive ? end + can::bit_time(suspend_bits, port.rate) : end;
  port.requeue();
  arbiter_.set(port.index, port.offer());
  core_.statistics.busy(start_, end, bits_ - after_ack_slot + bits);
  become_idle(next);
  for (BusObserver* observer : core_.observers) {
    observer->error_detected(port, BusError::acknowledgement, now);
  }
  report_error(port, {.error = BusError::acknowledgement,
                      .field = can::FrameField::ack_slot,
                      .bit = bits_ - after_ack_slot - 1,
                      .transmitter = true,
                      .first = true});
  if (passive != was_passive || port.faults.warning() != was_warned) {
    port.tap.changed = changes_ = true;
    core_.note_controller(port, was_passive ? can::ErrorState::error_passive : can::ErrorState::error_active);
    core_.report(now);
    tell_changes(now);
  } else {
    core_.report(now);
  }
}

}  // namespace canopus::sim
