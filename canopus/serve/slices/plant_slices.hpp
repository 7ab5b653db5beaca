#pragma once
// Runs a plant ahead of any clock. Parts that share nothing (can::Timeline::add_part) run apart from each other, in slices of
// plant time: one after the other, which keeps what they touch in the processor's caches, or on several threads. What they
// say is put into one order at the end of each slice, so the output does not depend on slices or threads.

#include <chrono>
#include <cstddef>
#include <functional>

#include "canopus/can/time.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/serve/slices/worker_threads.hpp"

namespace canopus::serve {

class PlantSlices {
 public:
  struct Use {
    std::size_t threads = 1;                               ///< at most; never more than parts
    can::Duration slice = std::chrono::milliseconds(100);  ///< > 0
    /// Called whenever the parts have met, for who keeps back what happened in them.
    std::function<void()> met{};
  };
  /// The plant must outlive it. Nobody from outside accesses the plant while it runs.
  PlantSlices(plant::Plant& plant, Use use);

  /// As can::Timeline::run_until().
  void run_until(can::Time end);

 private:
  plant::Plant& plant_;
  Use use_;
  WorkerThreads workers_;
};

}  // namespace canopus::serve
