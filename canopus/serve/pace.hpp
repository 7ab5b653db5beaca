#pragma once
// How a plant keeps step with the machine's clock, without the clock: from each reading of it to how far the
// plant is to run, how late it is, and for how long the process was suspended.
//
// Plant time stands still while the process is suspended: the plant goes on where it was, as a debugger's
// user or the owner of a laptop expects. Lag is something else: the process could have run, and the machine
// ran a deadline late. A plant that lags catches up.

#include <algorithm>

#include "canopus/can/time.hpp"

namespace canopus::serve {

class Pace {
 public:
  /// Longer than any scheduler lets a process wait that wants to run: without SIGCONT, too, the process was
  /// suspended (its virtual machine or container was, or a debugger held it).
  static constexpr can::Duration longest_wait = std::chrono::seconds(5);
  /// Shorter ones are not worth a word.
  static constexpr can::Duration shortest_sleep = std::chrono::seconds(1);
  /// A plant that is behind runs at most so far at a time, so that clients and signals are heard meanwhile.
  static constexpr can::Duration slice = std::chrono::milliseconds(20);

  struct Reading {
    can::Duration elapsed{};  ///< since the start, by a clock that stands still while the machine sleeps
    can::Duration asleep{};   ///< how long the machine has slept since the start
    bool continued = false;   ///< SIGCONT came since the last reading: the process had been stopped
  };
  struct Step {
    can::Time run_until{};      ///< plant time
    can::Duration lag{};        ///< how late the earliest deadline is
    can::Duration suspended{};  ///< since the last reading
  };

  /// `due` is the plant's earliest deadline, `now` how far the plant has run.
  [[nodiscard]] Step step(const Reading& reading, can::Time now, can::Time due) noexcept;
  /// Deadlines that nobody outside waits for are waited for together: a plant of a thousand deadlines in a
  /// hundred milliseconds is woken once in `longest`, and runs them at their moments of plant time all the same.
  /// 0, as long as nobody says otherwise: it is woken for each.
  void wake_together(can::Duration longest) noexcept { together_ = longest; }
  /// Somebody outside has come in: for a while each deadline is waited for on its own, for an answer may hang on it.
  void attend(can::Time now) noexcept { attends_until_ = can::later(now, attention); }
  static constexpr can::Duration attention = std::chrono::milliseconds(50);
  /// When to wake for the earliest deadline `due`, in plant time, of a plant that has run up to `now`.
  [[nodiscard]] can::Time wake_for(can::Time due, can::Time now) const noexcept {
    return now < attends_until_ ? due : std::max(due, can::later(now, together_));
  }

  /// What Reading::elapsed will be when this moment of plant time comes.
  [[nodiscard]] can::Duration elapsed_at(can::Time moment) const noexcept {
    return moment.time_since_epoch() + stood_still_;
  }

 private:
  can::Duration stood_still_{};  // plant time did, all in all
  can::Duration asleep_{};       // as reported
  can::Time last_{};             // plant time that the last reading meant
  can::Duration together_{};
  can::Time attends_until_{};
};

}  // namespace canopus::serve
