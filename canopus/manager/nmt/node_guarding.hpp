#pragma once
// Node guarding, master side, of one slave [CiA 301 node guarding; ME3CAN1-Q 4.6.7]: a remote frame
// 700H + node-ID every guard time, answered by one byte: toggle bit 7 and the slave's state. The slave is
// lost when it did not answer for its life time (guard time x retry factor), or when a request was repeated in vain as
// often as the retry factor says.
//
// Decides only; the remote frames are sent by its owner.

#include <algorithm>
#include <cstdint>

#include "canopus/can/alarm.hpp"
#include "canopus/can/time.hpp"

namespace canopus::manager {

class NodeGuarding {
 public:
  struct Due {
    bool request = false;  ///< a remote frame is to be sent now
    bool missed = false;   ///< the previous one was not answered
    bool lost = false;     ///< and by this, the life time is over
  };
  struct Answer {
    bool accepted = false;  ///< false: wrong toggle bit, the answer does not count
    bool resolved = false;  ///< the slave was lost before
  };

  /// Begins; the first remote frame is due at once. retry_factor >= 1, guard_time > 0. `repeats`: the retry factor counts
  /// repetitions (MasterOptions::guarding_is_repeated).
  void start(can::Duration guard_time, unsigned retry_factor, bool repeats, can::Time now) noexcept;
  /// The toggle bit is remembered: the slave goes on with it when guarding starts again.
  void stop() noexcept;
  /// Nothing is known of the slave.
  void forget() noexcept { change({}); }
  /// The slave was reset: its silence counts as nothing until it answers, and its toggle bit begins anew.
  void expect_silence() noexcept;
  /// The slave's boot-up message: the toggle bit of its next answer is 0.
  void boot_up() noexcept;

  Due tick(can::Time now) noexcept;
  /// Also while not running: an answer to a single remote frame moves the toggle bit on.
  Answer answer(std::uint8_t byte, can::Time now) noexcept;

  [[nodiscard]] bool running() const noexcept { return state_.running; }
  /// Running, and answers are coming.
  [[nodiscard]] bool alive() const noexcept { return state_.running && state_.answered && !state_.lost; }
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

 private:
  struct State {
    bool running = false;
    bool repeats = false;
    bool awaiting = false;
    bool answered = false;
    bool lost = false;
    bool silence_expected = false;
    bool toggle_known = false;
    bool toggle = false;
    unsigned retry_factor = 0;
    can::Duration guard_time{};
    can::Time requested{};
    can::Time next_request = can::never;
    can::Time life_end = can::never;

    /// After a sign of life at `now`, with the next request already planned. The next request and each repetition have the
    /// guard time for their answer.
    [[nodiscard]] can::Time life_end_from(can::Time now) const noexcept {
      return repeats ? later(next_request, guard_time * (retry_factor + 1))
                     : later(now, guard_time * retry_factor);
    }
  };
  void change(const State& state) noexcept {
    state_ = state;
    set_alarm();
  }
  void set_alarm() noexcept { alarm_ = std::min(state_.next_request, state_.life_end); }

  State state_;
  can::Alarm alarm_;
};

}  // namespace canopus::manager
