#include "canopus/manager/nmt/node_guarding.hpp"

namespace canopus::manager {

void NodeGuarding::start(can::Duration guard_time, unsigned retry_factor, can::Time now) noexcept {
  stop();
  running_ = true;
  guard_time_ = guard_time;
  retry_factor_ = retry_factor;
  next_request_ = now;
  life_end_ = later(now, guard_time * retry_factor);
}

void NodeGuarding::stop() noexcept {
  const bool known = toggle_known_;
  const bool toggle = toggle_;
  *this = NodeGuarding{};
  toggle_known_ = known;
  toggle_ = toggle;
}

void NodeGuarding::expect_silence() noexcept {
  silence_expected_ = !lost_;
  lost_ = true;
  awaiting_ = false;
  toggle_known_ = false;  // its boot-up message, if it comes, will say
  life_end_ = can::never;
}

void NodeGuarding::boot_up() noexcept {
  toggle_known_ = true;
  toggle_ = false;
  awaiting_ = false;
}

NodeGuarding::Due NodeGuarding::tick(can::Time now) noexcept {
  Due due;
  if (next_request_ <= now) {
    due.request = true;
    due.missed = awaiting_ && !lost_;
    awaiting_ = true;
    requested_ = now;
    next_request_ = next_request_ + guard_time_ > now ? next_request_ + guard_time_ : later(now, guard_time_);
  }
  if (life_end_ <= now) {
    // With a retry factor of 1 the life time is no longer than the guard time: the answer to the remote frame
    // just sent must still have its time, or any jitter would lose the slave.
    const can::Time least = later(requested_, guard_time_);
    if (retry_factor_ == 1 && awaiting_ && !due.missed && least > now) {
      life_end_ = least;
    } else {
      due.lost = !lost_;
      lost_ = true;
      life_end_ = can::never;
    }
  }
  return due;
}

NodeGuarding::Answer NodeGuarding::answer(std::uint8_t byte, can::Time now) noexcept {
  Answer result;
  const bool toggle = (byte & 0x80) != 0;
  result.accepted = !toggle_known_ || toggle == toggle_;
  if (!result.accepted) return result;
  toggle_known_ = true;
  toggle_ = !toggle;
  if (!running_) return result;
  result.resolved = lost_ && !silence_expected_;
  silence_expected_ = false;
  awaiting_ = false;
  answered_ = true;
  lost_ = false;
  life_end_ = later(now, guard_time_ * retry_factor_);
  return result;
}

}  // namespace canopus::manager
