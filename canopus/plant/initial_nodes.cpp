#include "canopus/plant/initial_nodes.hpp"

#include <utility>

#include "canopus/module/interface/communication_module.hpp"
#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::plant {
namespace {

constexpr bool is_node_id(unsigned node_id) noexcept { return node_id >= 1 && node_id <= 127; }

}  // namespace

std::vector<InitialPlantNode> initial_nodes(Plant& plant) {
  std::vector<InitialPlantNode> nodes;
  for (std::size_t number = 0; number < plant.plc_count(); ++number) {
    for (const ModuleSection& section : plant.plc_section(number).modules) {
      auto* const module =
          dynamic_cast<module::CommunicationModule*>(plant.rack(number).module_at(section.head));
      if (module == nullptr) continue;
      auto node = module->initial_node();
      if (!node || !is_node_id(node->node_id)) continue;
      nodes.push_back({section.bus, shown_name(section), node->node_id, std::move(node->objects)});
    }
  }
  for (std::size_t number = 0; number < plant.device_count(); ++number) {
    DeviceOnBus& seat = plant.device(number);
    const NodeLabel label = seat.status().label;
    DeviceOnBus::InitialNode node = seat.initial_node();
    if (!is_node_id(node.node_id)) continue;
    nodes.push_back({std::string(label.bus), std::string(label.name), node.node_id, std::move(node.objects)});
  }
  return nodes;
}

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
