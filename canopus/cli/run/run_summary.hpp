#pragma once
// The state of a plant at the end of its run, for the output.

#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::cli {

/// All figures of the plant itself; the run adds those of the wall clock. Views into `plant`.
[[nodiscard]] plant::RunSummary summary_of(plant::Plant& plant);

}  // namespace canopus::cli
