#pragma once
// What happens in one part of a plant, on its way to the plant's observer: at once, or, while the part runs apart from the
// others, afterwards in the order of all.

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

  /// Hands on what was held back, of all parts, as if they had run together. To be called when they have met.
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
