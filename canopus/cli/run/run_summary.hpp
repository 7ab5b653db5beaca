#pragma once
// What a plant is at the end of its run, for the output.

#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::cli {

/// All that the plant itself knows; the wall clock's part is the run's. Views into `plant`.
[[nodiscard]] plant::RunSummary summary_of(plant::Plant& plant);

}  // namespace canopus::cli
