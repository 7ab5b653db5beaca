// What faults do to the levels of a segment.

#include <algorithm>
#include <span>

#include "canopus/sim/bus/segment.hpp"

namespace canopus::sim {

void Segment::invert() {
  before_change();
  inverted_ = !inverted_;
  after_change();
}

void Segment::set_termination(const Termination& termination) {
  before_change();
  termination_ = termination;
  after_change();
}

void Segment::drive(const DrivenWire& driven) {
  if (driven == driven_) return;
  before_change();
  driven_ = driven;
  after_change();
}

/// What was to happen to a frame that nobody sends any more does not happen to the next one.
void Segment::forget_given_up() {
  given_up_ = false;
  const bool is_sent = std::any_of(working_.begin(), working_.end(),
                                   [](const BusPort* port) { return port->bits.transmitting(); });
  if (!is_sent) faults_.corruptions = 0;
}

/// Whether somebody may see another level than the wire's.
void Segment::look_for_views() noexcept {
  const std::span corruptions(faults_.corruption, faults_.corruptions);
  seen_apart_ = std::ranges::any_of(corruptions, [](const auto& one) { return one.at != nullptr; }) ||
                std::ranges::any_of(members_, [](const BusPort* port) { return port->inverted; }) ||
                core_.clocks != nullptr;
}

/// What the port samples, if somebody may see another level than the wire's.
bool Segment::seen_at(const BusPort& port, can::Time now) const noexcept {
  return core_.clocks != nullptr ? port.tap.sampled : dominant_ != inverted(&port, now);
}

/// Whether a fault inverts what there is on the wire, or what one port sees of it.
bool Segment::inverted(const BusPort* at, can::Time now) const noexcept {
  bool inverts = at == nullptr ? inverted_ && !members_.empty() : at->inverted;
  for (std::size_t number = 0; number < faults_.corruptions; ++number) {
    const FrameFaults::Corruption& corruption = faults_.corruption[number];
    const can::Time begin = faults_origin_ + faults_bit_ * corruption.bit;
    if (corruption.at == at && now >= begin && now < begin + faults_bit_) inverts = !inverts;
  }
  return inverts;
}

/// What a port drives from now on gets onto the wire, if it does, at once or later.
void Segment::put_on_wire(BusPort& port, can::Time now) {
  BusPort::BitPhase& tap = port.tap;
  const bool dominant = tap.driving && !port.mute;
  if (port.lateness == can::Duration{}) return tap.reach(dominant);
  if (tap.reaches != can::never) tap.reach(tap.reaching_next);  // a bit shorter than the delay
  if (dominant == tap.reaching) return;
  tap.reaching_next = dominant;
  tap.reaches = now + port.lateness;
}

/// The wire's level by its termination, while nodes drive it dominant or do not.
bool Segment::driven_level(bool dominant, can::Time now) {
  if (termination_.is_weak) return false;
  if (is_driven_ && !dominant) released_ = now + termination_.release;
  is_driven_ = dominant;
  if (dominant) released_ = can::never;
  if (released_ <= now) released_ = can::never;
  return dominant || released_ != can::never;
}

}  // namespace canopus::sim
