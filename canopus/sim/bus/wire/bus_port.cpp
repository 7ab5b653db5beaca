#include "canopus/sim/bus/wire/bus_port.hpp"

#include <algorithm>

#include "canopus/sim/bus/wire/wire.hpp"

namespace canopus::sim {
namespace {

constexpr std::size_t default_queue_capacity = 128;
constexpr std::size_t max_queue_capacity = 65'535;

}  // namespace

BusPort::BusPort(BusCore& bus_core, Wire& port_wire, std::uint32_t port_index, std::string port_name)
    : core(bus_core),
      wire(&port_wire),
      index(port_index),
      bit_length(can::bit_time(1, bus_core.bit_rate)),
      rate(bus_core.bit_rate),
      port_name_(std::move(port_name)) {
  queue.configure(true, default_queue_capacity);
  accept(can::Acceptance{});
}

bool BusPort::send(const can::Frame& frame) {
  if (core.had_faults) [[unlikely]]
    return send_with_faults(frame);
  return enqueue(frame);
}

bool BusPort::send_with_faults(const can::Frame& frame) {
  if (powered && core.plan.delays_frames()) {
    const can::Duration delay = core.plan.on_send(*this, frame, core.timeline.now());
    if (delay > can::Duration{}) {
      core.delayed.push_back({can::later(core.timeline.now(), delay), this, frame});
      core.deadline_changed();
      return true;
    }
  }
  return enqueue(frame);
}

bool BusPort::enqueue(const can::Frame& frame) {
  wire->snapshot_pending(*this);
  if (!powered || listen_only || !queue.push(frame, sending ? 1 : 0)) {
    ++refused;
    return false;
  }
  wire->offer_changed(*this);
  return true;
}

std::uint64_t BusPort::offer_of_babbler() const noexcept {
  if (!may_transmit()) return Arbiter::none;
  return Arbiter::key(arbitration(babble_goes_first() ? babble : queue.front()), index);
}

std::uint16_t BusPort::transmit_error_counter() const { return wire->counters_of(*this).transmit_errors(); }

std::uint16_t BusPort::receive_error_counter() const { return wire->counters_of(*this).receive_errors(); }

void BusPort::restart(std::uint32_t bit_rate) {
  wire->before_change();
  leave_wire();
  rate = bit_rate;
  bit_length = can::bit_time(1, rate);
  reset();
  start_controller();
  wire->after_change();
}

void BusPort::reset() {
  faults.reset();
  recovering = false;
  confirm = false;  // what was to be confirmed belongs to the time before
  queue.clear();
  refused = 0;
  overrun = 0;
}

void BusPort::abort_transmissions() {
  std::erase_if(core.delayed, [&](const BusCore::Delayed& waiting) { return waiting.port == this; });
  abort_pending();
  queue.clear();
  wire->offer_changed(*this);
}

/// Of what waits nothing is sent again, not even what is in arbitration.
void BusPort::abort_pending() {
  wire->snapshot_pending(*this);
  pending.is_aborted = true;
  last_attempt = sending && !sends_babble;
}

void BusPort::plug(bool plugged) {
  is_plugged = plugged;
  update_on_wire();
}

void BusPort::set_power(bool on) {
  if (powered == on) return;
  wire->before_change();
  powered = on;
  if (!on) {
    std::erase_if(core.delayed, [&](const BusCore::Delayed& waiting) { return waiting.port == this; });
    leave_wire();
    reset();
    report_counters(core.timeline.now());
  }
  update_on_wire();
  wire->after_change();
}

void BusPort::update_on_wire() {
  if (on_wire == (is_plugged && powered)) return;
  wire->before_change();
  on_wire = !on_wire;
  if (on_wire) {
    start_controller();
  } else {
    leave_wire();
  }
  wire->after_change();
}

void BusPort::set_listen_only(bool new_listen_only) {
  if (listen_only == new_listen_only) return;
  wire->before_change();
  listen_only = new_listen_only;
  bits.set_listen_only(new_listen_only);
  start_controller();
  wire->after_change();
}

void BusPort::set_automatic_recovery(bool automatic) {
  automatic_recovery = automatic;
  if (automatic) recover();
}

void BusPort::recover() {
  if (faults.state() != can::ErrorState::bus_off || recovering) return;
  wire->before_change();
  recovering = true;
  start_controller();
  wire->after_change();
}

void BusPort::accept(const can::Acceptance& acceptance) {
  core.acceptance.change(index, accepted, acceptance);
  accepted = acceptance;
}

void BusPort::set_transmit_queue(can::TransmitOrder order, std::size_t capacity) {
  abort_pending();
  queue.configure(order == can::TransmitOrder::identifier, std::min(capacity, max_queue_capacity));
  wire->offer_changed(*this);
}

void BusPort::leave_wire() {
  if (sending && phase.transmitted) {  // complete but for the end of its last bit
    confirm = complete();
  } else if (sending) {
    requeue();
  }
  sending = false;
  bits.restart(true);
  report_silence();
  phase = {};
}

void BusPort::start_controller() {
  leave_wire();
  const can::Time now = core.timeline.now();
  report_counters(now);
  bits.set_recovering(recovering);
  bits.restart(false);
  phase.bit_start = now;
  phase.next = now;
}

void BusPort::report_error(can::BusErrorReport report) const {
  if (core.observers.empty()) return;
  report.port = this;
  report.state = faults.state();
  report.transmit_errors = faults.transmit_errors();
  report.receive_errors = faults.receive_errors();
  core.error_reports.push_back(report);
}

void BusPort::report_controller(can::ErrorState before) const {
  if (core.observers.empty()) return;
  core.controller_reports.push_back({.port = this,
                                     .before = before,
                                     .state = faults.state(),
                                     .warning = faults.warning(),
                                     .transmit_errors = faults.transmit_errors(),
                                     .receive_errors = faults.receive_errors()});
}

void BusPort::report_silence() {
  const can::Time now = core.timeline.now();
  const bool still_dominant = on_wire && stuck_dominant;
  const bool was_dominant = reported_dominant && !still_dominant;
  if (was_dominant) reported_dominant = false;
  for (WireObserver* observer : core.wire_observers) {
    if (was_dominant) observer->transmit_changed(*this, false, now);
    if (phase.flagging || phase.arbitrating) observer->activity_changed(*this, false, false, now);
    observer->field_changed(*this, can::FrameField::idle, now);
  }
  phase.set_output(false);
  phase.driving = phase.flagging = phase.arbitrating = false;
}

void BusPort::report_output(can::Time now) {
  const bool dominant = drives_wire();
  if (dominant == reported_dominant) return;
  reported_dominant = dominant;
  for (WireObserver* observer : core.wire_observers) observer->transmit_changed(*this, dominant, now);
}

void BusPort::report_activity(can::Time now) {
  const bool flagging = bits.flagging();
  const bool arbitrating = bits.arbitrating();
  if (flagging == phase.flagging && arbitrating == phase.arbitrating) return;
  phase.flagging = flagging;
  phase.arbitrating = arbitrating;
  for (WireObserver* observer : core.wire_observers)
    observer->activity_changed(*this, flagging, arbitrating, now);
}

void BusPort::report_field(can::Time now) const {
  for (WireObserver* observer : core.wire_observers) observer->field_changed(*this, bits.field(), now);
}

void BusPort::report_counters(can::Time now) const {
  for (WireObserver* observer : core.wire_observers) observer->counters_changed(*this, now);
}

}  // namespace canopus::sim
