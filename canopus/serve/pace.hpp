#pragma once
// How a plant keeps step with the machine's clock, without the clock: computes from each reading of it how
// far the plant must run, how late it is, and how long the process was suspended.
//
// Plant time stops while the process is suspended: the plant continues where it was, as a debugger's user or
// the owner of a laptop expects. Lag is different: the process was runnable, and the machine ran a deadline
// late. A plant that lags catches up.
//
// Plant time can run faster or slower than the clock, or stop, at once or at a given moment. A plant whose
// speed is too high for the machine runs as fast as possible, and does not catch up later.

#include <algorithm>

#include "canopus/can/time.hpp"

namespace canopus::serve {

class Pace {
 public:
  /// Longer than any scheduler delays a runnable process: without SIGCONT, too, the process was suspended
  /// (its virtual machine or container was, or a debugger held it).
  static constexpr can::Duration longest_wait = std::chrono::seconds(5);
  /// Shorter ones are not reported.
  static constexpr can::Duration shortest_sleep = std::chrono::seconds(1);
  /// The most that a plant faster than the clock catches up with.
  static constexpr can::Duration most_behind = std::chrono::milliseconds(100);
  /// A plant that is behind runs at most so far at a time, so that clients and signals are served meanwhile.
  static constexpr can::Duration slice = std::chrono::milliseconds(20);

  struct Reading {
    can::Duration elapsed{};  ///< since the start, by a clock that stops while the machine sleeps
    can::Duration asleep{};   ///< how long the machine has slept since the start
    bool continued = false;   ///< SIGCONT came since the last reading: the process had been stopped
  };
  struct Step {
    can::Time run_until{};      ///< plant time
    can::Duration lag{};        ///< how late the earliest deadline is, by the clock
    can::Duration suspended{};  ///< since the last reading
  };

  /// `due` is the plant's earliest deadline, `now` how far the plant has run.
  [[nodiscard]] Step step(const Reading& reading, can::Time now, can::Time due) noexcept {
    // Most frequent case: nothing is due yet, and the clock ran without interruption.
    if (speed_ == 1 && !reading.continued && reading.asleep < asleep_ + shortest_sleep) {
      const can::Duration present = reading.elapsed - stood_still_;
      const can::Time moment = plant_then_ + (present - clock_then_);
      if (now <= moment && moment < std::min(due, until_)) {
        last_ = present;
        return {.run_until = moment};
      }
    }
    return step_with_care(reading, now, due);
  }
  /// Deadlines without an external observer are combined: a plant of a thousand deadlines in a hundred
  /// milliseconds is woken once in `longest`, and runs them at their moments of plant time all the same. 0,
  /// the default: it is woken for each.
  void wake_together(can::Duration longest) noexcept { together_ = together_at_speed_ = longest; }
  /// From now on plant time runs `speed` times as fast as the clock (0: stopped), up to `until`. `now` is how
  /// far the plant has run; lag up to then is dropped.
  void set_speed(double speed, can::Time now, can::Duration elapsed, can::Time until = can::never) noexcept;
  [[nodiscard]] double speed() const noexcept { return speed_; }
  [[nodiscard]] can::Time until() const noexcept { return until_; }
  /// An external access happened: for a while the plant is woken for each deadline, because an answer may
  /// depend on it.
  void attend(can::Time now) noexcept { attends_until_ = can::later(now, attention); }
  static constexpr can::Duration attention = std::chrono::milliseconds(50);
  /// When to wake for the earliest deadline `due`, in plant time, of a plant that has run up to `now`.
  [[nodiscard]] can::Time wake_for(can::Time due, can::Time now) const noexcept {
    return now < attends_until_ ? due : std::max(due, can::later(now, together_at_speed_));
  }

  /// Reading::elapsed when the plant has to run again: at the deadline `due`, or where it stops before that.
  /// Duration::max(): it has stopped.
  [[nodiscard]] can::Duration elapsed_to_wake(can::Time due, can::Time now) const noexcept {
    return elapsed_at(now < until_ ? std::min(due, until_) : due);
  }
  /// Reading::elapsed at this moment of plant time; Duration::max(): it does not come.
  [[nodiscard]] can::Duration elapsed_at(can::Time moment) const noexcept {
    const can::Duration clock = clock_at(moment);
    return clock == can::Duration::max() ? clock : clock + stood_still_;
  }

 private:
  /// The clock at this moment of plant time, without suspensions; max(): it does not come.
  [[nodiscard]] can::Duration clock_at(can::Time moment) const noexcept;
  [[nodiscard]] can::Time plant_at(can::Duration clock) const noexcept;
  [[nodiscard]] Step step_with_care(const Reading& reading, can::Time now, can::Time due) noexcept;

  can::Duration stood_still_{};  // plant time did while the process was suspended, all in all
  can::Duration asleep_{};       // as reported
  can::Duration last_{};         // the last reading, without suspensions
  double speed_ = 1;
  can::Duration clock_then_{};         // when it got its speed
  can::Time plant_then_{};             // likewise
  can::Time until_ = can::never;       // and then plant time stops
  can::Duration together_{};           // of the clock
  can::Duration together_at_speed_{};  // of plant time
  can::Time attends_until_{};
};

}  // namespace canopus::serve
