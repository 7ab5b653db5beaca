#pragma once
// Forwards the events of one partition to the plant's observer: at once, or, while the partition runs
// independently, later in the order of all partitions.

#include <algorithm>
#include <iterator>
#include <memory>
#include <span>
#include <vector>

#include "canopus/can/timeline.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::plant {

class DeferredEvents final : public PlantObserver {
 public:
  /// Both outlive it; the timeline is the part's.
  DeferredEvents(PlantObserver& observer, const can::Timeline& timeline)
      : observer_(observer), timeline_(timeline) {}

  /// Delivers the deferred events of all partitions, as if they had run together. Call it when the partitions
  /// have joined.
  static void release(std::span<const std::unique_ptr<DeferredEvents>> parts) {
    std::vector<Held> all;
    for (const auto& part : parts) {
      std::ranges::move(part->held_, std::back_inserter(all));
      part->held_.clear();
    }
    std::ranges::stable_sort(all, {}, &Held::stamp);
    for (const Held& held : all) parts.front()->observer_.on(held.event);
  }

  void on(const Event& event) override {
    if (!timeline_.runs_alone()) return observer_.on(event);
    held_.push_back({timeline_.stamp(), event});
  }

 private:
  struct Held {
    can::TickStamp stamp;
    Event event;
  };

  PlantObserver& observer_;
  const can::Timeline& timeline_;
  std::vector<Held> held_;
};

}  // namespace canopus::plant
