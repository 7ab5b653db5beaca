#include "canopus/cli/run/run_summary.hpp"

#include "canopus/plant/lift_on_bus.hpp"

namespace canopus::cli {

plant::RunSummary summary_of(plant::Plant& plant) {
  plant::RunSummary summary{.end = plant.timeline().now(),
                            .nodes = plant.nodes(),
                            .boots = plant.boots(),
                            .troubles = plant.troubles(),
                            .forced = plant.forced()};
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    summary.buses.push_back({plant.bus(i).name(), plant.bus(i).load(summary.end)});
  }
  for (std::size_t i = 0; i < plant.lift_count(); ++i) {
    summary.lifts.push_back({plant.lift(i).bus(), plant.lift(i).building().report()});
  }
  return summary;
}

}  // namespace canopus::cli
