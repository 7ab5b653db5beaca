#pragma once
// Forwards the events of one partition to the plant's observer: at once, or, while the partition runs
// independently, later in the order of all partitions.

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
  static void release(std::span<const std::unique_ptr<DeferredEvents>> parts);

  void on(const Event& event) override;

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
