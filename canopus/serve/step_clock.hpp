#pragma once

#include "canopus/can/timeline.hpp"
#include "canopus/link/loop_clock.hpp"

namespace canopus::serve {

/// The time of a plant that is driven in step: it is stopped while clients access the plant.
class StepClock final : public link::LoopClock {
 public:
  explicit StepClock(const can::Timeline& timeline) : timeline_(timeline) {}

  can::Time now() override { return timeline_.now(); }
  void touched() override {}

 private:
  const can::Timeline& timeline_;
};

}  // namespace canopus::serve
