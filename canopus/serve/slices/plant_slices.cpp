#include "canopus/serve/slices/plant_slices.hpp"

#include <algorithm>
#include <utility>

#include "canopus/can/timeline.hpp"

namespace canopus::serve {

PlantSlices::PlantSlices(plant::Plant& plant, Use use)
    : plant_(plant),
      use_(std::move(use)),
      workers_(std::min(use_.threads, plant.timeline().partition_count())) {}

void PlantSlices::run_until(can::Time end) {
  do run_slice(end);
  while (plant_.timeline().now() < end);
}

void PlantSlices::run_slice(can::Time end) {
  can::Timeline& timeline = plant_.timeline();
  const can::Time slice_end = std::min(can::later(timeline.now(), slice_), end);
  const auto start = std::chrono::steady_clock::now();
  // Participants outside all partitions may access any of them.
  if (timeline.partition_count() == 0 || timeline.outside_next() <= slice_end) {
    timeline.run_until(slice_end);
  } else {
    workers_.run(timeline.partition_count(),
                 [&](std::size_t part) { timeline.partition(part).run_partition(slice_end); });
    plant_.parts_met(slice_end);
    if (use_.met) use_.met();
  }
  follow_the_clock(std::chrono::steady_clock::now() - start);
}

void PlantSlices::follow_the_clock(std::chrono::steady_clock::duration taken) noexcept {
  using namespace std::chrono_literals;
  if (taken < 20ms) slice_ = std::min(2 * slice_, use_.most);
  if (taken > 80ms) slice_ = std::max(slice_ / 2, use_.least);
}

}  // namespace canopus::serve
