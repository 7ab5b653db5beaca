#include "canopus/plant/plant_names.hpp"

#include <utility>

#include "canopus/plant/initial_nodes.hpp"
#include "canopus/plant/plant_loading.hpp"

namespace canopus::plant {

bool add_plant_names(const std::string& path, trace::Names& names, text::Output& err) {
  class : public PlantObserver {
  } no_observer;
  const auto plant = load_plant(path, no_observer, err);
  if (!plant) return false;
  for (InitialPlantNode& node : initial_nodes(*plant)) {
    names.add(trace::describe_node(std::move(node.bus), node.node_id, std::move(node.name),
                                   std::move(node.objects)));
  }
  return true;
}

}  // namespace canopus::plant
