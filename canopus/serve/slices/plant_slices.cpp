#include "canopus/serve/slices/plant_slices.hpp"

#include <algorithm>
#include <utility>

namespace canopus::serve {

PlantSlices::PlantSlices(plant::Plant& plant, Use use)
    : plant_(plant), use_(std::move(use)), workers_(std::min(use_.threads, plant.timeline().part_count())) {}

void PlantSlices::run_until(can::Time end) {
  can::Timeline& timeline = plant_.timeline();
  // Who belongs to no part may look at any of them.
  if (timeline.part_count() == 0 || timeline.outside_next() <= end) return timeline.run_until(end);
  while (timeline.now() < end) {
    const can::Time slice_end = std::min(can::later(timeline.now(), use_.slice), end);
    workers_.run(timeline.part_count(), [&](std::size_t part) { timeline.part(part).run_apart(slice_end); });
    plant_.parts_met(slice_end);
    if (use_.met) use_.met();
  }
}

}  // namespace canopus::serve
