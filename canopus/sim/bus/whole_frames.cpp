#include "canopus/sim/bus/whole_frames.hpp"

#include <algorithm>
#include <bit>
#include <iterator>

namespace canopus::sim {
namespace {

using Mode = WireState::Mode;

// Bits of a frame after its ACK slot: ACK delimiter and EOF.
constexpr unsigned after_ack_slot = 1 + 7;
constexpr unsigned error_flag_bits = 6;
constexpr unsigned error_delimiter_bits = 8;

}  // namespace

/// Frames are computed as a whole when all have one bit rate. A controller with another one stays on the wire, where it
/// samples, counts and disturbs as it does on a real one.
void WholeFrames::update_members(bool allowed) {
  ++membership_;
  const std::vector<BusPort*>& members = wire_.members;
  const std::uint32_t rate = members.empty() ? 0 : members.front()->rate;
  healthy_ = allowed;
  std::size_t acknowledging = 0;
  std::fill(receiving_.begin(), receiving_.end(), 0);
  for (const BusPort* port : members) {
    receiving_[port->index / 64] |= std::uint64_t{1} << (port->index % 64);
    if (!port->listen_only) ++acknowledging;
    if (port->rate != rate || !port->bits.idle()) healthy_ = false;
  }
  lone_ = members.size() == 1 && acknowledging == 1 && members[0]->bits.idle() && allowed &&
          wire_.core.wire_observers.empty();
  healthy_ = healthy_ && acknowledging >= 2;
}

bool WholeFrames::start(can::Time now) {
  WireState& wire = wire_;
  BusCore& core = wire.core;
  is_after_frame_ = false;
  if (wire.suspension.port != nullptr && now >= wire.suspension.until) end_suspension();
  const std::uint64_t winner = wire.arbiter.lowest();
  if (winner == Arbiter::none) {
    const bool waits = wire.suspension.port != nullptr && wire.suspension.port->offer() != Arbiter::none;
    wire.deadline = waits ? wire.suspension.until : can::never;
    return true;
  }
  if (!are_possible()) return false;
  BusPort& port = *core.ports[Arbiter::port_of(winner)];
  port.begin_next();  // it stays in the arbiter: most often it will offer the same identifier again
  if (core.plan.hits_frames()) {
    wire.faults = core.plan.on_frame(port, port.bit(), port.current, now);
    wire.faults_ready = true;
  }
  // A waveform shows a suspension, which is not reported as a whole.
  const bool shows_suspension =
      !core.wire_observers.empty() && port.faults.state() == can::ErrorState::error_passive;
  // A new state is reported at the sample point that it comes with, within the frame.
  const bool changes_a_controller = healthy_ && !counting_.empty() && success_changes_a_controller(port);
  if (wire.faults.corruptions > 0 || wire.arbiter.is_lowest_shared() || shows_suspension ||
      changes_a_controller) {
    port.requeue();
    wire.arbiter.set(port.index, port.offer());
    return false;
  }
  wire.faults_ready = false;
  lone_frame_failed_ = false;
  suspended_at_start_ = wire.suspension.port;
  if (suspended_at_start_ != nullptr) end_suspension();  // it has become a receiver
  transmitter_ = &port;
  wire.frame_number = ++core.frame_number;
  start_ = now;
  bits_ = can::frame_bits(port.current);
  if (healthy_) {
    wire.mode = Mode::frame;
    wire.deadline = now + port.time_of(bits_);
  } else {
    wire.mode = Mode::lone_frame;
    wire.deadline = now + can::bit_time(bits_ - after_ack_slot, port.rate) - after_sample_point(port.bit());
  }
  return true;
}

/// Ready for the next frame at `from`.
void WholeFrames::become_idle(can::Time from) {
  wire_.mode = Mode::idle;
  wire_.free_from = from;
  wire_.deadline = wire_.arbiter.lowest() == Arbiter::none ? can::never : from;
}

/// A passive transmitter lets the others go first.
void WholeFrames::suspend(BusPort& port, can::Time until) {
  wire_.suspension = {.port = &port, .until = until};
  wire_.arbiter.set(port.index, Arbiter::none);
  if (wire_.arbiter.lowest() != Arbiter::none) return;
  wire_.deadline = port.offer() == Arbiter::none ? can::never : until;
}

void WholeFrames::end_suspension() {
  BusPort& port = *wire_.suspension.port;
  wire_.arbiter.set(port.index, port.offer());
  wire_.suspension.port = nullptr;
}

void WholeFrames::finish(can::Time now) {
  WireState& wire = wire_;
  BusCore& core = wire.core;
  BusPort& port = *transmitter_;
  if (!core.wire_observers.empty()) report_frame();
  const can::Frame frame = port.current;
  const bool own = port.complete();
  const can::Time next = now + port.time_of(can::intermission_bits);
  wire.count_frame(frame);
  wire.count_busy(start_, next, bits_ + can::intermission_bits);
  if (!counting_.empty()) count_success(port);
  become_idle(next);
  is_after_frame_ = true;
  if (!port.faults.clean() && port.faults.state() == can::ErrorState::error_passive) {
    suspend(port, next + can::bit_time(suspend_bits, port.rate));
  }
  for (can::BusObserver* observer : core.observers) observer->frame_completed(frame, start_, now);
  core.report(now);
  deliver(frame, port, now);
  if (own) port.notify_transmitted(frame, now);
  if (wire.mode == Mode::idle && wire.has(port) && &port != wire.suspension.port) {
    wire.arbiter.set(port.index, port.offer());
    wire.deadline = wire.arbiter.lowest() == Arbiter::none ? can::never : next;
  }
}

void WholeFrames::deliver_to_all(const can::Frame& frame, const BusPort& from, can::Time now) {
  const AcceptanceTable::Ports accepting = wire_.core.acceptance.ports_for(frame);
  for (std::size_t word = 0; word < receiving_.size(); ++word) {
    std::uint64_t ports = accepting[word] & receiving_[word];
    while (ports != 0) {
      const std::size_t number = 64 * word + static_cast<std::size_t>(std::countr_zero(ports));
      ports &= ports - 1;
      if (number != from.index) deliver_to(number, frame, now);
    }
  }
}

/// Success takes errors back, rules g and h.
can::FaultConfinement WholeFrames::after_success(const BusPort& port,
                                                 const BusPort& transmitter) const noexcept {
  can::FaultConfinement faults = port.faults;
  if (port.listen_only) return faults;
  if (&port == &transmitter) {
    faults.transmitted();
  } else {
    faults.received();
  }
  return faults;
}

bool WholeFrames::success_changes_a_controller(const BusPort& transmitter) const noexcept {
  return std::ranges::any_of(counting_, [&](const BusPort* port) {
    const can::FaultConfinement after = after_success(*port, transmitter);
    return after.state() != port->faults.state() || after.warning() != port->faults.warning();
  });
}

/// None of them comes to another state: such a frame goes bit by bit.
void WholeFrames::count_success(BusPort& transmitter) {
  std::erase_if(counting_, [&](BusPort* port) {
    port->faults = after_success(*port, transmitter);
    return port->listen_only || port->faults.clean();
  });
}

can::FaultConfinement WholeFrames::counters_of(const BusPort& port) const noexcept {
  if (wire_.mode != Mode::frame || counting_.empty() || !port.present()) return port.faults;
  const BusPort& sender = *transmitter_;
  const unsigned bits = &port == &sender ? bits_ : bits_ - after_ack_slot;  // up to the one that counts
  const can::Time sampled = start_ + sender.time_of(bits) - after_sample_point(sender.bit());
  const can::Time now = wire_.core.timeline.now();
  const bool is_counted = sampled < now || (sampled == now && wire_.core.has_ticked());
  return is_counted ? after_success(port, sender) : port.faults;
}

void WholeFrames::fail_lone(can::Time now) {
  WireState& wire = wire_;
  BusCore& core = wire.core;
  BusPort& port = *transmitter_;
  // A passive transmitter that sees no dominant bit in its error flag counts no acknowledgement error: alone
  // on the bus it stays passive for ever and is never bus-off.
  const bool was_passive = port.faults.state() == can::ErrorState::error_passive;
  const bool was_warned = port.faults.warning();
  lone_frame_failed_ = true;
  counters_before_failure_ = port.faults;
  if (!was_passive) port.faults.transmitter_error();
  counting_ = {&port};
  ++port.counted.errors;
  wire.count_error_frame();
  const bool passive = port.faults.state() == can::ErrorState::error_passive;
  const unsigned bits = error_flag_bits + error_delimiter_bits + can::intermission_bits;
  const can::Time end = now + after_sample_point(port.bit()) + can::bit_time(bits, port.rate);
  const can::Time next = passive ? end + can::bit_time(suspend_bits, port.rate) : end;
  port.requeue();
  wire.arbiter.set(port.index, port.offer());
  wire.count_busy(start_, end, bits_ - after_ack_slot + bits);
  become_idle(next);
  is_after_frame_ = true;
  for (can::BusObserver* observer : core.observers) {
    observer->error_detected(port, BusError::acknowledgement, now);
  }
  port.report_error({.error = BusError::acknowledgement,
                     .field = can::FrameField::ack_slot,
                     .bit = bits_ - after_ack_slot - 1,
                     .transmitter = true,
                     .first = true});
  if (passive != was_passive || port.faults.warning() != was_warned) {
    port.phase.changed = wire.controllers_changed = true;
    port.report_controller(was_passive ? can::ErrorState::error_passive : can::ErrorState::error_active);
    core.report(now);
    wire.notify_controller_changes(now);
  } else {
    core.report(now);
  }
}

WireHandover WholeFrames::leave(can::Time now) {
  WireState& wire = wire_;
  WireHandover handover{.transmitter = transmitter_};
  const bool on_wire = wire.mode == Mode::frame || wire.mode == Mode::lone_frame;
  // At the very end of an intermission the controllers are at the end of a bit, too, and not in the midst of idling: a dominant
  // level does not wake them, and they may begin a frame.
  const bool is_in_intermission = now < wire.free_from || (is_after_frame_ && now == wire.free_from);
  const bool is_suspended = wire.suspension.port != nullptr && now <= wire.suspension.until;
  if (wire.suspension.port != nullptr) end_suspension();
  wire.mode = Mode::bits;
  if (on_wire || (lone_frame_failed_ && is_in_intermission)) {
    handover.kind = on_wire ? WireHandover::Kind::frame : WireHandover::Kind::failed_lone_frame;
    handover.start = start_;
    handover.suspended = suspended_at_start_;
    if (suspended_at_start_ != nullptr) handover.suspended_bits = suspended_bits();
    if (on_wire) return handover;
    transmitter_->faults = counters_before_failure_;
    lone_frame_failed_ = false;
    wire.free_from = now;
  } else if (is_in_intermission || is_suspended) {
    handover.kind = WireHandover::Kind::intermission;
    handover.start = wire.free_from - can::bit_time(can::intermission_bits, transmitter_->rate);
    handover.counted_until = wire.free_from;
    wire.free_from = now;
  }
  return handover;
}

/// How many bits of its suspension suspended_at_start_ had sampled when the frame began.
unsigned WholeFrames::suspended_bits() const noexcept {
  const can::Duration bit = suspended_at_start_->bit();
  const can::Duration since =
      start_ - (wire_.suspension.until - can::bit_time(suspend_bits, suspended_at_start_->rate));
  const can::Duration first = bit - after_sample_point(bit);
  return since <= first ? 0 : 1 + static_cast<unsigned>((since - first - can::Duration(1)) / bit);
}

void WholeFrames::resume(can::Time now) {
  counting_.clear();
  std::ranges::copy_if(wire_.members, std::back_inserter(counting_),
                       [](const BusPort* port) { return !port->faults.clean(); });
  become_idle(std::max(wire_.free_from, now));
  is_after_frame_ = false;
}

/// What the port offered when the frame began that is on the wire now.
std::uint64_t WholeFrames::offer_at_start(const BusPort& port) const noexcept {
  if (port.pending.frame_number != wire_.frame_number) return wire_.arbiter.of(port.index);
  return port.pending.offered ? Arbiter::key(can::arbitration(port.pending.frame), port.index)
                              : Arbiter::none;
}

/// The frame ends now, and nothing has come of it yet.
void WholeFrames::report_frame() {
  senders_.clear();
  const std::uint32_t winner = can::arbitration(transmitter_->current);
  for (BusPort* port : wire_.members) {
    if (port == transmitter_) {
      senders_.push_back({.port = port->index, .lost_at = WireFrame::Sender::won, .arbitration = winner});
    } else if (const std::uint64_t offer = offer_at_start(*port); offer != Arbiter::none) {
      const auto lost_at = 1 + static_cast<unsigned>(std::countl_zero(winner ^ Arbiter::value_of(offer)));
      senders_.push_back({.port = port->index, .lost_at = lost_at, .arbitration = Arbiter::value_of(offer)});
    }
  }
  const can::Duration bit = transmitter_->bit();
  const WireFrame frame{.frame = transmitter_->current,
                        .transmitter = *transmitter_,
                        .members = wire_.members,
                        .membership = membership_,
                        .senders = senders_,
                        .start = start_,
                        .bit = bit,
                        .sample_point = bit - after_sample_point(bit),
                        .counting = !counting_.empty()};
  for (WireObserver* observer : wire_.core.wire_observers) observer->frame_passed(frame);
}

}  // namespace canopus::sim
