#include "canopus/serve/pace.hpp"

#include <algorithm>

namespace canopus::serve {

Pace::Step Pace::step(const Reading& reading, can::Time now, can::Time due) noexcept {
  Step step;
  can::Time present = can::Time{} + (reading.elapsed - stood_still_);
  // Until the deadline the process was free to sleep; it is absent from there on.
  const can::Duration absent = present - std::min(present, std::max(last_, due));
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
  const can::Time late = std::min(due, present);
  step.lag = present - late;
  step.run_until = std::min(present, can::later(std::max(now, late), slice));
  return step;
}

}  // namespace canopus::serve
