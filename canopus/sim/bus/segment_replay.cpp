// A segment on its way from frames to bits: the controllers are brought to where they would be, had it worked bit
// by bit all along.

#include <algorithm>

#include "canopus/sim/bus/segment.hpp"

namespace canopus::sim {

void Segment::enter_bits() {
  if (state_ == State::bits) return;
  const bool on_wire = state_ == State::frame || state_ == State::lone_frame;
  state_ = State::bits;
  dominant_ = false;
  active_ = false;
  for (const auto& port : core_.ports) {
    if (port->segment == this) port->tap = {};
  }
  const can::Time now = core_.timeline.now();
  const bool suspended = suspended_ != nullptr && now < suspended_until_;
  if (suspended_ != nullptr) end_suspension();
  // What is sampled or begins at this moment is part of the past once the bus has had its tick.
  const can::Time until = core_.has_ticked() ? now + can::Duration(1) : now;
  if (on_wire) {
    replay(until);
  } else if (failed_ && now < free_from_) {
    // In the error frame of a lone transmitter, which has been counted already.
    transmitter_->faults = faults_before_;
    replay(until);
    activity_start_ = free_from_ = now;
    failed_ = false;
    error_frame_ = true;
  } else if (now < free_from_ || suspended) {
    replay_intermission(until);
  } else {
    deadline_ = arbiter_.lowest() == Arbiter::none ? can::never : std::max(now, free_from_);
  }
}

/// Brings the controllers to where the frame on the wire has them just before `until`.
void Segment::replay(can::Time until) {
  BusPort& port = *transmitter_;
  replaying_ = true;
  error_frame_ = false;  // of an earlier frame
  port.bits.transmit(port.current);
  port.tap.frame_start = start_;
  port.tap.next = start_;
  for (BusPort* contender : members_) {
    if (contender == &port || contender == suspended_at_sof_) continue;
    if (contender->kept.frame_number != frame_number_) contender->snapshot_pending(frame_number_);
    if (!contender->kept.offered) continue;
    contender->bits.transmit(contender->kept.frame);
    contender->tap.next = contender->tap.frame_start = start_;
  }
  if (suspended_at_sof_ != nullptr) suspended_at_sof_->bits.resume_suspension(suspended_bits());
  deadline_ = start_;
  while (deadline_ < until) bits_tick(deadline_);
  for (BusPort* contender : members_) {
    if (contender != &port && contender->bits.transmitting()) contender->restore_pending();
  }
  replaying_ = false;
}

/// How many bits of its suspension suspended_at_sof_ had sampled when the frame began.
unsigned Segment::suspended_bits() const noexcept {
  const can::Duration bit = suspended_at_sof_->bit();
  const can::Duration since =
      start_ - (suspended_until_ - can::bit_time(suspend_bits, suspended_at_sof_->rate));
  const can::Duration first = bit - after_sample_point(bit);
  return since <= first ? 0 : 1 + static_cast<unsigned>((since - first - can::Duration(1)) / bit);
}

/// The same for the intermission of a frame that is complete.
void Segment::replay_intermission(can::Time until) {
  const can::Time begin = free_from_ - can::bit_time(can::intermission_bits, transmitter_->rate);
  for (BusPort* port : members_) {
    port->bits.begin_intermission(port == transmitter_);
    port->tap.next = begin;
  }
  active_ = true;
  activity_start_ = free_from_;  // up to there it has been counted
  free_from_ = core_.timeline.now();
  replaying_ = true;
  deadline_ = begin;
  while (deadline_ < until) bits_tick(deadline_);
  replaying_ = false;
}

/// From idle: whoever offers something begins.

}  // namespace canopus::sim
