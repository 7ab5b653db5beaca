#include "canopus/sim/bus/segment.hpp"

#include <algorithm>

namespace canopus::sim {

void Segment::resize() {
  arbiter.resize(core.ports.size());
  frames_.resize();
}

void Segment::update_members() {
  bits_.before_change();
  members.clear();
  for (const auto& port : core.ports) {
    if (!has(*port)) {
      arbiter.set(port->index, Arbiter::none);
      continue;
    }
    arbiter.set(port->index, port->offer());
    if (port->present()) members.push_back(port.get());
  }
  const bool allowed = bits_.update_members();
  frames_.update_members(allowed && !shows_bits());
}

/// Some observer needs every bit, or what is reported of the two sides of a cut has to come in its order.
bool Segment::shows_bits() const noexcept {
  if (core.wire_observers.empty()) return false;
  if (!is_near) return true;
  return core.needs_bits() ||
         std::ranges::any_of(core.ports, [this](const auto& port) { return !has(*port); });
}

void Segment::before_change() {
  enter_bits();
  bits_.before_change();
}

void Segment::after_change() {
  const can::Time now = core.timeline.now();
  update_members();
  bits_.after_change(now);
  deadline = now;
  core.deadline_changed();
}

void Segment::enter_bits() {
  if (mode != Mode::bits) bits_.enter(frames_.leave(core.timeline.now()));
}

/// Whole frames go on, if they can.
bool Segment::leave_bits(can::Time now) {
  if (!bits_.has_new_members()) return false;
  update_members();
  if (!frames_.are_possible()) return false;
  bits_.leave(now);
  frames_.resume(now);
  if (deadline == now) start(now);
  return true;
}

/// The frame that begins now goes bit by bit.
void Segment::start_bits(can::Time now) {
  const FrameFaults of_frame = faults;
  const bool ready = faults_ready;
  clear_faults();  // what is replayed is not that frame
  enter_bits();
  faults = of_frame;
  faults_ready = ready;
  (void)bits_.end_bits(now);
  bits_.run_bits(now);
}

void Segment::tick_bits(can::Time now) {
  if (bits_.end_bits(now) && leave_bits(now)) return;
  bits_.run_bits(now);
}

bool Segment::is_busy() const noexcept {
  return mode == Mode::frame || mode == Mode::lone_frame || bits_.is_active() ||
         free_from > core.timeline.now();
}

can::Time Segment::busy_since() const noexcept {
  if (mode == Mode::bits) return bits_.is_active() ? bits_.active_since() : can::never;
  return mode == Mode::idle ? can::never : frames_.frame_start();
}

void Segment::report_wire() {
  if (mode != Mode::frame || core.wire_observers.empty()) return;
  before_change();
  after_change();
}

void Segment::drive(const DrivenWire& driven) {
  if (driven == bits_.levels().driven()) return;
  before_change();
  bits_.levels().drive(driven);
  after_change();
}

void Segment::invert() {
  before_change();
  bits_.levels().invert();
  after_change();
}

void Segment::set_termination(const Termination& termination) {
  before_change();
  bits_.levels().set_termination(termination);
  after_change();
}

void Segment::cancel_faults() {
  const bool is_disturbed = mode == Mode::bits && faults.corruptions > 0;
  if (is_disturbed) before_change();
  clear_faults();
  if (is_disturbed) after_change();
}

void Segment::move_in(BusPort& port, Segment& from) {
  if (&from == this) return;
  from.before_change();
  before_change();
  port.wire = this;
  bits_.move_in(port, from);
  from.after_change();
  after_change();
}

}  // namespace canopus::sim
