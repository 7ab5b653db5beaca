#include "canopus/serve/pace.hpp"

#include <algorithm>

namespace canopus::serve {
namespace {

can::Duration times(can::Duration duration, double factor) noexcept {
  if (factor == 1) return duration;
  constexpr double longest = 4e18;  // more than a century, and twice that is a number, too
  return can::Duration(static_cast<can::Duration::rep>(
      std::clamp(static_cast<double>(duration.count()) * factor, -longest, longest)));
}

}  // namespace

can::Duration Pace::clock_at(can::Time moment) const noexcept {
  if (speed_ == 0 || moment == can::never || moment > until_) return can::Duration::max();
  return clock_then_ + times(moment - plant_then_, 1 / speed_);
}

can::Time Pace::plant_at(can::Duration clock) const noexcept {
  return std::min(can::later(plant_then_, times(clock - clock_then_, speed_)), until_);
}

void Pace::set_speed(double speed, can::Time now, can::Duration elapsed, can::Time until) noexcept {
  speed_ = speed;
  plant_then_ = now;
  clock_then_ = elapsed - stood_still_;
  until_ = until;
  together_at_speed_ = times(together_, std::max(1.0, speed));
}

Pace::Step Pace::step_with_care(const Reading& reading, can::Time now, can::Time due) noexcept {
  Step step;
  can::Duration present = reading.elapsed - stood_still_;
  // Until the deadline the process was free to sleep; it is absent from there on.
  const can::Duration absent = present - std::min(present, std::max(last_, clock_at(due)));
  if (absent >= longest_wait || reading.continued) {
    stood_still_ += absent;
    present -= absent;
    step.suspended = absent;
  }
  if (reading.asleep >= asleep_ + shortest_sleep) {
    step.suspended += reading.asleep - asleep_;
    asleep_ = reading.asleep;
  }
  last_ = present;
  step.lag = present - std::min(clock_at(due), present);
  if (speed_ > 1 && step.lag > most_behind) {
    clock_then_ += step.lag - most_behind;
    step.lag = most_behind;
  }
  const can::Time moment = plant_at(present);
  step.run_until = std::min(moment, can::later(std::max(now, std::min(due, moment)), slice));
  return step;
}

}  // namespace canopus::serve
