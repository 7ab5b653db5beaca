#pragma once

#include "canopus/plant/plant.hpp"

namespace canopus::web {

/// Two observers as one; the first gets each event first.
class ObserverPair final : public plant::PlantObserver {
 public:
  /// Both must outlive the pair.
  ObserverPair(plant::PlantObserver& first, plant::PlantObserver& second) : first_(first), second_(second) {}

  void on(const plant::Event& event) override {
    first_.on(event);
    second_.on(event);
  }

 private:
  plant::PlantObserver& first_;
  plant::PlantObserver& second_;
};

}  // namespace canopus::web
