#pragma once
// Single numbers that the page plots, whether their row is in sight or not.

#include <cstddef>
#include <string>

#include "canopus/plant/plant.hpp"
#include "canopus/text/json.hpp"

namespace canopus::web {

inline constexpr std::size_t most_values = 12;

/// The event of {"values": ["words 0 10000", "objects 3 6004:00"]}: of the module or node of that number in `state` the word of this
/// address, the object of this index and sub-index; of each a number, or null. Empty: it is no such view.
[[nodiscard]] std::string values_event(plant::Plant& plant, const text::Json& wish);

}  // namespace canopus::web
