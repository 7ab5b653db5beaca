#pragma once
// Times of formats that write seconds from 0 to 59.999 and no minute.

#include "canopus/can/time.hpp"

namespace canopus::trace {

class MinuteClock {
 public:
  /// `start`: time of day at which the trace begins.
  explicit MinuteClock(can::Duration start = {})
      : minute_(std::chrono::floor<std::chrono::minutes>(start)), last_(start - minute_.time_since_epoch()) {}

  /// A time that goes back by more than half a minute is in the next one; channels may be a little out of order.
  [[nodiscard]] can::Time at(can::Duration of_minute) noexcept {
    constexpr can::Duration half = std::chrono::seconds(30);
    if (last_ - of_minute > half) minute_ = can::later(minute_, std::chrono::minutes(1));
    last_ = of_minute;
    return can::later(minute_, of_minute);
  }

 private:
  can::Time minute_;
  can::Duration last_;
};

}  // namespace canopus::trace
