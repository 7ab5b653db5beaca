#include "canopus/manager/nmt/node_guarding.hpp"

namespace canopus::manager {

void NodeGuarding::start(can::Duration guard_time, unsigned retry_factor, bool repeats,
                         can::Time now) noexcept {
  State begun{.running = true,
              .repeats = repeats,
              .toggle_known = state_.toggle_known,
              .toggle = state_.toggle,
              .retry_factor = retry_factor,
              .guard_time = guard_time,
              .next_request = now};
  begun.life_end = begun.life_end_from(now);
  change(begun);
}

void NodeGuarding::stop() noexcept { change({.toggle_known = state_.toggle_known, .toggle = state_.toggle}); }

void NodeGuarding::expect_silence() noexcept {
  state_.silence_expected = !state_.lost;
  state_.lost = true;
  state_.awaiting = false;
  state_.toggle_known = false;  // its boot-up message, if it comes, will say
  state_.life_end = can::never;
  set_alarm();
}

void NodeGuarding::boot_up() noexcept {
  state_.toggle_known = true;
  state_.toggle = false;
  state_.awaiting = false;
}

NodeGuarding::Due NodeGuarding::tick(can::Time now) noexcept {
  Due due;
  if (state_.next_request <= now) {
    due.request = true;
    due.missed = state_.awaiting && !state_.lost;
    state_.awaiting = true;
    state_.requested = now;
    const can::Time next = state_.next_request + state_.guard_time;
    state_.next_request = next > now ? next : later(now, state_.guard_time);
  }
  if (state_.life_end <= now) {
    // With a retry factor of 1 the life time is no longer than the guard time: the answer to the remote frame
    // just sent must still have its time, or any jitter would lose the slave.
    const can::Time least = later(state_.requested, state_.guard_time);
    if (state_.retry_factor == 1 && !state_.repeats && state_.awaiting && !due.missed && least > now) {
      state_.life_end = least;
    } else {
      due.lost = !state_.lost;
      state_.lost = true;
      state_.life_end = can::never;
    }
  }
  set_alarm();
  return due;
}

NodeGuarding::Answer NodeGuarding::answer(std::uint8_t byte, can::Time now) noexcept {
  Answer result;
  const bool toggle = (byte & 0x80) != 0;
  result.accepted = !state_.toggle_known || toggle == state_.toggle;
  if (!result.accepted) return result;
  state_.toggle_known = true;
  state_.toggle = !toggle;
  if (!state_.running) return result;
  result.resolved = state_.lost && !state_.silence_expected;
  state_.silence_expected = false;
  state_.awaiting = false;
  state_.answered = true;
  state_.lost = false;
  state_.life_end = state_.life_end_from(now);
  set_alarm();
  return result;
}

}  // namespace canopus::manager
