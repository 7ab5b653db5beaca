#include "canopus/sim/bus/bitwise/exact_line.hpp"

#include <algorithm>
#include <utility>

#include "canopus/sim/bus/bitwise/bitwise_wire.hpp"
#include "canopus/sim/bus/line/line_clocks.hpp"

namespace canopus::sim {

void ExactLine::run(can::Time now, bool has_changed) {
  LineClocks& clocks = *wire_.core.clocks;
  const std::vector<BusPort*>& ports = bits_.sampling();
  if (std::exchange(are_all_due_, false) || has_changed || bits_.has_late_drivers() ||
      levels_.has_stuck_dominant())
    set_all_due(now);
  acting_.clear();
  in_quantum_.clear();
  while (due_.earliest() <= now) {
    const std::size_t number = due_.winner();
    due_.set(due_.winner(), can::never);
    acting_.push_back(number);
    if (begin(number, now)) in_quantum_.push_back(number);
  }
  if (has_changed || levels_.has_stuck_dominant()) {
    for (const auto& port : wire_.core.ports) drive(*port, now);
  }
  update_level(now, has_changed);
  if (clocks.has_changed(now)) make_others_due(now);
  for (const std::size_t number : in_quantum_) {
    if (wire_.has(*ports[number])) begin_quantum(*ports[number], now);
  }
  wire_.core.report(now);
  for (const std::size_t number : acting_) set_due(number, now);
  clocks.forget(now);
}

bool ExactLine::begin(std::size_t number, can::Time now) {
  LineClocks& clocks = *wire_.core.clocks;
  BusPort& port = *bits_.sampling()[number];
  BusPort::BitPhase& phase = port.phase;
  if (passes_end_[number] && phase.next < now) pass_end(number);
  passes_end_[number] = false;
  const bool begins = phase.next == now && !phase.sampling;
  if (begins && !clocks.begins_bit(port.index, port.rate, now)) {
    clocks.restart(port.index, port.rate, now);
  }
  const bool is_asleep = port.bits.idle() && phase.next == can::never;
  const bool begins_quantum =
      is_asleep ? clocks.advance_asleep(port.index, now) : clocks.advance(port.index, now);
  if (begins) begin_bit(port, now);
  if (bits_.has_late_drivers() && phase.output_changes <= now) phase.set_output(phase.next_output);
  drive(port, now);
  return begins_quantum;
}

/// A level has begun its way to all ports: they monitor the wire from their next quantum on, which may begin now.
void ExactLine::make_others_due(can::Time now) {
  const std::vector<BusPort*>& ports = bits_.sampling();
  auto acting = acting_.begin();
  others_.clear();
  for (std::size_t number = 0; number < ports.size(); ++number) {
    if (acting != acting_.end() && *acting == number) {
      ++acting;
    } else if (!monitors_[number]) {
      if (passes_end_[number] && ports[number]->phase.next < now) pass_end(number);
      if (next_due(number, now) == now) {
        others_.push_back(number);
        if (begin(number, now)) in_quantum_.push_back(number);
      } else {
        set_due(number, now);
      }
    }
  }
  if (others_.empty()) return;
  std::ranges::sort(in_quantum_);
  acting_.insert(acting_.end(), others_.begin(), others_.end());
}

void ExactLine::set_all_due(can::Time now) {
  const std::size_t count = bits_.sampling().size();
  if (count != passes_end_.size()) {
    due_ = {};
    for (std::size_t number = 0; number < count; ++number) due_.add();
    passes_end_.assign(count, false);
    monitors_.assign(count, false);
  }
  for (std::size_t number = 0; number < count; ++number)
    due_.set(static_cast<can::WinnerTree::Index>(number), now);
}

void ExactLine::set_due(std::size_t number, can::Time now) {
  const BusPort& port = *bits_.sampling()[number];
  monitors_[number] = wire_.core.clocks->monitors(port.index);
  passes_end_[number] = may_pass_end(port, now);
  due_.set(static_cast<can::WinnerTree::Index>(number), next_due(number, now));
}

can::Time ExactLine::next_due(std::size_t number, can::Time now) const noexcept {
  const BusPort& port = *bits_.sampling()[number];
  const LineClocks& clocks = *wire_.core.clocks;
  const can::Time then =
      passes_end_[number] && port.phase.next > now ? clocks.next_sample_point(port.index) : port.phase.next;
  return clocks.next_quantum(port.index, now, then);
}

/// Nothing comes of the next bit's beginning but that it is sampled: it is recessive, as the present one, and not reported.
bool ExactLine::may_pass_end(const BusPort& port, can::Time now) const noexcept {
  const BusPort::BitPhase& phase = port.phase;
  return !phase.sampling && phase.next > now && phase.next != can::never && !port.bits.quiet() &&
         !port.bits.may_begin() && !port.bits.drives_dominant() && !phase.output && !phase.received &&
         !phase.transmitted && wire_.core.wire_observers.empty();
}

void ExactLine::pass_end(std::size_t number) {
  BusPort& port = *bits_.sampling()[number];
  LineClocks& clocks = *wire_.core.clocks;
  BusPort::BitPhase& phase = port.phase;
  passes_end_[number] = false;
  clocks.pass_end_of_bit(port.index);
  phase.bit_start = phase.next;
  phase.sampling = true;
  phase.driving = false;
  phase.next = clocks.sample_point(port.index);
}

void ExactLine::catch_up(can::Time until) {
  const std::vector<BusPort*>& ports = bits_.sampling();
  for (std::size_t number = 0; number < passes_end_.size(); ++number) {
    if (passes_end_[number] && ports[number]->phase.next < until) pass_end(number);
    passes_end_[number] = false;
  }
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
  const bool is_driven = std::ranges::any_of(wire_.core.clocks->driving(), [this](std::size_t number) {
    const BusPort& port = *wire_.core.ports[number];
    return wire_.has(port) && port.drives_wire();
  });
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
