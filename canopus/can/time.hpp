#pragma once
// Time as the protocol rooms know it: nanoseconds since the start of the run. No room below the program reads a
// clock; time is always an argument, so the same code runs in virtual and in real time.

#include <chrono>
#include <cstdint>

namespace canopus::can {

/// The clock of a run. It has no now(): only the event loop has the present time.
struct RunClock {
  using rep = std::int64_t;
  using period = std::nano;
  using duration = std::chrono::duration<rep, period>;
  using time_point = std::chrono::time_point<RunClock>;
  static constexpr bool is_steady = true;
};

/// A span of time, in nanoseconds. Literals such as 10ms come from std::chrono_literals.
using Duration = RunClock::duration;

/// A moment of the run. Time{} is its start, never is later than everything.
using Time = RunClock::time_point;

/// The deadline of an object that waits for nothing.
inline constexpr Time never = Time::max();

/// Seconds since the start of the run, for people and log files.
constexpr double seconds(Time time) noexcept {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

/// `from + after`, or never when that is not representable.
constexpr Time later(Time from, Duration after) noexcept {
  return after > never - from ? never : from + after;
}

}  // namespace canopus::can
