#include "canopus/can/controller.hpp"

namespace canopus::can {

Time Ticker::tick_and_tell(Time now) {
  tick(now);
  return not_told;
}

}  // namespace canopus::can
