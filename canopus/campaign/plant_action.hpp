#pragma once
// What a rule does to a plant while it runs, and no plant file has a key for.

#include <expected>
#include <functional>
#include <string>
#include <vector>

#include "canopus/campaign/chosen_rules.hpp"
#include "canopus/can/time.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::campaign {

struct PlantAction {
  can::Time at{};
  std::function<void(plant::Plant& plant, can::Time now)> carry_out{};
};

/// Adds the actions of a power cut, of a CPU's STOP, or of a write; of other rules none. The error is a sentence.
[[nodiscard]] std::expected<void, std::string> add_actions(const ChosenRule& chosen, plant::Plant& plant,
                                                           std::vector<PlantAction>& actions);

}  // namespace canopus::campaign
