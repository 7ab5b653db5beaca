#include "canopus/sim/bus/bus_core.hpp"
#include "canopus/sim/bus/segment.hpp"

namespace canopus::sim {
namespace {

constexpr std::size_t default_queue_capacity = 128;
constexpr std::size_t max_queue_capacity = 65'535;

}  // namespace

BusPort::BusPort(BusCore& bus_core, Segment& port_segment, std::uint32_t port_index, std::string port_name)
    : core(bus_core),
      segment(&port_segment),
      index(port_index),
      bit_length(can::bit_time(1, bus_core.bit_rate)),
      rate(bus_core.bit_rate),
      port_name_(std::move(port_name)) {
  queue.configure(true, default_queue_capacity);
  accept(Acceptance{});
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
  segment->snapshot_pending(*this);
  if (!powered || listen_only || !queue.push(frame, sending ? 1 : 0)) {
    ++refused;
    return false;
  }
  segment->offer_changed(*this);
  return true;
}

std::uint64_t BusPort::offer_of_babbler() const noexcept {
  if (!may_transmit()) return Arbiter::none;
  return Arbiter::key(arbitration(babble_goes_first() ? babble : queue.front()), index);
}

std::uint16_t BusPort::transmit_error_counter() const {
  return segment->counters_of(*this).transmit_errors();
}

std::uint16_t BusPort::receive_error_counter() const { return segment->counters_of(*this).receive_errors(); }

void BusPort::restart(std::uint32_t bit_rate) {
  segment->before_change();
  segment->take_off(*this);
  rate = bit_rate;
  bit_length = can::bit_time(1, rate);
  start_anew();
  segment->restart(*this);
  segment->after_change();
}

void BusPort::start_anew() {
  faults.reset();
  recovering = false;
  confirm = false;  // nobody is left who would hear of it
  queue.clear();
  refused = 0;
  overrun = 0;
}

void BusPort::abort_transmissions() {
  std::erase_if(core.delayed, [&](const BusCore::Delayed& waiting) { return waiting.port == this; });
  forget_queue();
  queue.clear();
  segment->offer_changed(*this);
}

/// Of what waits nothing is sent again, not even what is in arbitration.
void BusPort::forget_queue() {
  segment->snapshot_pending(*this);
  kept.is_aborted = true;
  last_attempt = sending && !sends_babble;
}

void BusPort::plug(bool plugged) {
  is_plugged = plugged;
  be_on_wire();
}

void BusPort::set_power(bool on) {
  if (powered == on) return;
  segment->before_change();
  powered = on;
  if (!on) {
    std::erase_if(core.delayed, [&](const BusCore::Delayed& waiting) { return waiting.port == this; });
    segment->take_off(*this);
    start_anew();
    segment->tell_counters(*this, core.timeline.now());
  }
  be_on_wire();
  segment->after_change();
}

void BusPort::be_on_wire() {
  if (on_wire == (is_plugged && powered)) return;
  segment->before_change();
  on_wire = !on_wire;
  if (on_wire) {
    segment->restart(*this);
  } else {
    segment->take_off(*this);
  }
  segment->after_change();
}

void BusPort::set_listen_only(bool new_listen_only) {
  if (listen_only == new_listen_only) return;
  segment->before_change();
  listen_only = new_listen_only;
  bits.set_listen_only(new_listen_only);
  segment->restart(*this);
  segment->after_change();
}

void BusPort::set_automatic_recovery(bool automatic) {
  automatic_recovery = automatic;
  if (automatic) recover();
}

void BusPort::recover() {
  if (faults.state() != can::ErrorState::bus_off || recovering) return;
  segment->before_change();
  recovering = true;
  segment->restart(*this);
  segment->after_change();
}

void BusPort::accept(const Acceptance& acceptance) {
  core.acceptance.change(index, accepted, acceptance);
  accepted = acceptance;
}

void BusPort::set_transmit_queue(TransmitOrder order, std::size_t capacity) {
  forget_queue();
  queue.configure(order == TransmitOrder::identifier, std::min(capacity, max_queue_capacity));
  segment->offer_changed(*this);
}

}  // namespace canopus::sim
