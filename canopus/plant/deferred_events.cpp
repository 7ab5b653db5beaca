#include "canopus/plant/deferred_events.hpp"

#include <algorithm>
#include <iterator>

namespace canopus::plant {

void DeferredEvents::on(const Event& event) {
  if (!timeline_.runs_alone()) return observer_.on(event);
  held_.push_back({timeline_.stamp(), event});
}

void DeferredEvents::release(std::span<const std::unique_ptr<DeferredEvents>> parts) {
  std::vector<Held> all;
  for (const auto& part : parts) {
    std::ranges::move(part->held_, std::back_inserter(all));
    part->held_.clear();
  }
  std::ranges::stable_sort(all, {}, &Held::stamp);
  for (const Held& held : all) parts.front()->observer_.on(held.event);
}

}  // namespace canopus::plant
