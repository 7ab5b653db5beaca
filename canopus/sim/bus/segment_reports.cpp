// What a segment tells those who watch it.

#include <algorithm>
#include <bit>

#include "canopus/sim/bus/segment.hpp"

namespace canopus::sim {

void Segment::report_error(const BusPort& port, can::BusErrorReport report) {
  if (core_.observers.empty()) return;
  report.port = &port;
  report.state = port.faults.state();
  report.transmit_errors = port.faults.transmit_errors();
  report.receive_errors = port.faults.receive_errors();
  core_.error_reports.push_back(report);
}

void Segment::fall_silent(BusPort& port) {
  const can::Time now = core_.timeline.now();
  const bool still_dominant = port.on_wire && port.stuck;
  const bool was_dominant = port.shown_dominant && !still_dominant;
  if (was_dominant) port.shown_dominant = false;
  for (WireObserver* observer : core_.wire_observers) {
    if (was_dominant) observer->transmit_changed(port, false, now);
    if (port.tap.flagging || port.tap.arbitrating) observer->activity_changed(port, false, false, now);
    observer->field_changed(port, can::FrameField::idle, now);
  }
  port.tap.reach(false);
  port.tap.driving = port.tap.flagging = port.tap.arbitrating = false;
}

/// What the port drives: a stuck one is dominant even when its controller is bus-off.
void Segment::tell_driven(BusPort& port, can::Time now) {
  if (port.segment != this) return;
  const bool shown = port.on_wire && (port.stuck || port.tap.reaching);
  if (shown == port.shown_dominant) return;
  port.shown_dominant = shown;
  for (WireObserver* observer : core_.wire_observers) observer->transmit_changed(port, shown, now);
}

void Segment::tell_activity(BusPort& port, can::Time now) {
  const bool flagging = port.bits.flagging();
  const bool arbitrating = port.bits.arbitrating();
  if (flagging == port.tap.flagging && arbitrating == port.tap.arbitrating) return;
  port.tap.flagging = flagging;
  port.tap.arbitrating = arbitrating;
  for (WireObserver* observer : core_.wire_observers) {
    observer->activity_changed(port, flagging, arbitrating, now);
  }
}

void Segment::tell_place(const BusPort& port, can::Time now) {
  for (WireObserver* observer : core_.wire_observers) observer->field_changed(port, port.bits.field(), now);
}

void Segment::tell_counters(const BusPort& port, can::Time now) {
  for (WireObserver* observer : core_.wire_observers) observer->counters_changed(port, now);
}

bool Segment::somebody_needs_bits() const noexcept {
  return std::ranges::any_of(core_.wire_observers, [](const auto* one) { return one->needs_bits(); });
}

/// Somebody has to hear of every bit, or what is told of the two sides of a cut has to come in its order.
bool Segment::shows_bits() const noexcept {
  if (core_.wire_observers.empty()) return false;
  if (!is_near_) return true;
  return somebody_needs_bits() ||
         std::ranges::any_of(core_.ports, [this](const auto& port) { return port->segment != this; });
}

/// What the port offered when the frame began that is on the wire now.
std::uint64_t Segment::offer_at_start(const BusPort& port) const noexcept {
  if (port.kept.frame_number != frame_number_) return arbiter_.of(port.index);
  return port.kept.offered ? Arbiter::key(can::arbitration(port.kept.frame), port.index) : Arbiter::none;
}

/// The frame ends now, and nothing has come of it yet.
void Segment::tell_frame() {
  senders_.clear();
  const std::uint32_t winner = can::arbitration(transmitter_->current);
  for (BusPort* port : members_) {
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
                        .members = members_,
                        .membership = membership_,
                        .senders = senders_,
                        .start = start_,
                        .bit = bit,
                        .sample_point = bit - after_sample_point(bit),
                        .counting = counting_};
  for (WireObserver* observer : core_.wire_observers) observer->frame_passed(frame);
}

/// The frame ends now for whoever sent it or has received it first; others may be a little behind.
void Segment::tell_arbitration(const can::Frame& frame, can::Time start) {
  senders_.clear();
  for (const BusPort* port : members_) {
    if (!port->tap.transmitted && port->tap.lost_at == WireFrame::Sender::won) continue;
    senders_.push_back({.port = port->index,
                        .lost_at = port->tap.lost_at,
                        .arbitration = can::arbitration(port->bits.sent())});
  }
  const WireArbitration arbitration{.frame = frame, .start = start, .senders = senders_};
  for (WireObserver* observer : core_.wire_observers) observer->arbitration_passed(arbitration);
}

}  // namespace canopus::sim
