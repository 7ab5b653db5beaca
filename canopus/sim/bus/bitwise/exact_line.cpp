#include "canopus/sim/bus/bitwise/exact_line.hpp"

#include <algorithm>

#include "canopus/sim/bus/bitwise/bitwise_wire.hpp"
#include "canopus/sim/bus/line/line_clocks.hpp"

namespace canopus::sim {

void ExactLine::run(can::Time now, bool has_changed) {
  LineClocks& clocks = *wire_.core.clocks;
  in_quantum_.clear();
  for (BusPort* port : bits_.sampling()) {
    BusPort::BitPhase& phase = port->phase;
    const bool begins = phase.next == now && !phase.sampling;
    if (begins && !clocks.begins_bit(port->index, port->rate, now)) {
      clocks.restart(port->index, port->rate, now);
    }
    const bool is_asleep = port->bits.idle() && phase.next == can::never;
    const bool begins_quantum =
        is_asleep ? clocks.advance_asleep(port->index, now) : clocks.advance(port->index, now);
    if (begins_quantum) in_quantum_.push_back(port);
    if (begins) begin_bit(*port, now);
    if (bits_.has_late_drivers() && phase.output_changes <= now) phase.set_output(phase.next_output);
    drive(*port, now);
  }
  if (has_changed || levels_.has_stuck_dominant()) {
    for (const auto& port : wire_.core.ports) drive(*port, now);
  }
  update_level(now, has_changed);
  for (BusPort* port : in_quantum_) {
    if (wire_.has(*port)) begin_quantum(*port, now);
  }
  wire_.core.report(now);
  if (!clocks.driving().empty()) clocks.forget(now);
}

void ExactLine::begin_bit(BusPort& port, can::Time now) {
  BusPort::BitPhase& phase = port.phase;
  phase.bit_start = now;
  phase.sampling = !port.bits.idle();
  phase.next = phase.sampling ? wire_.core.clocks->sample_point(port.index) : can::never;
  phase.driving = port.bits.drives_dominant();
  BitwiseWire::put_on_wire(port, now);
  if (wire_.core.wire_observers.empty()) return;
  port.report_output(now);
  port.report_activity(now);
  port.report_field(now);
}

void ExactLine::drive(BusPort& port, can::Time now) {
  if (!wire_.has(port)) return;
  wire_.core.clocks->drive(port.index, port.drives_wire(), now);
}

/// The level of the wire where it is driven. What is done to the wire itself is done everywhere at once.
void ExactLine::update_level(can::Time now, bool has_changed) {
  const bool is_driven = std::ranges::any_of(
      wire_.core.ports, [this](const auto& port) { return wire_.has(*port) && port->drives_wire(); });
  const bool was_held = levels_.is_held();
  const bool dominant = levels_.level(is_driven, now);
  const bool is_inverted = levels_.is_inverted(nullptr, now);
  if (has_changed || wire_.faults.corruptions > 0 || is_inverted != was_inverted_ ||
      was_held != levels_.is_held()) {
    wire_.core.clocks->disturb(now);
  }
  was_inverted_ = is_inverted;
  bits_.report_outputs(has_changed, now);
  bits_.set_level(dominant, now);
}

/// The wire's level at the port's place.
bool ExactLine::is_seen_dominant(const BusPort& port, can::Time now) const noexcept {
  const LineClocks& clocks = *wire_.core.clocks;
  const bool is_driven = std::ranges::any_of(clocks.driving(), [&](std::size_t from) {
    return wire_.has(*wire_.core.ports[from]) && clocks.sees(port.index, from, now);
  });
  return levels_.seen_on_line(port, is_driven, now);
}

can::Time ExactLine::next(can::Time now) const noexcept {
  can::Time next = can::never;
  for (const BusPort* port : bits_.sampling()) {
    next = std::min(next, wire_.core.clocks->next_quantum(port->index, now, port->phase.next));
  }
  return next;
}

void ExactLine::begin_quantum(BusPort& port, can::Time now) {
  LineClocks& clocks = *wire_.core.clocks;
  BusPort::BitPhase& phase = port.phase;
  const bool dominant = is_seen_dominant(port, now);
  if (port.bits.idle() && phase.next == can::never) {
    if (!dominant) return;
    clocks.wake(port.index);
    phase.bit_start = now;
    phase.sampling = true;
    phase.next = clocks.sample_point(port.index);
    return;
  }
  const bool hard = port.bits.synchronises_hard() &&
                    (port.bits.state() != BitController::State::bus_off || port.recovering);
  const BitClock::Quantum quantum = clocks.monitor(port.index, dominant, hard, phase.driving);
  if (quantum.samples) {
    phase.sampled = quantum.dominant;
    bits_.sample_port(port, now);
  }
  if (!quantum.begins) {
    phase.next = phase.sampling ? clocks.sample_point(port.index) : clocks.end_of_bit(port.index);
  } else if (hard) {  // the SOF of another port
    phase.bit_start = now;
    phase.sampling = true;
    phase.next = clocks.sample_point(port.index);
  } else {  // the bit has ended
    phase.next = now;
  }
}

}  // namespace canopus::sim
