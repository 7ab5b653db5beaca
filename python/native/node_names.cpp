#include "node_names.hpp"

#include "canopus/master/network_file.hpp"
#include "canopus/plant/initial_nodes.hpp"
#include "canopus/trace/print/node_names.hpp"

#include "plant_run.hpp"

namespace canopus::python {

void refuse(const text::TextOutput& errors) {
  std::string text = errors.text();
  while (text.ends_with('\n')) text.pop_back();
  throw PlantProblem(text);
}

trace::Names node_names(const std::string& plant, const std::string& network,
                        const std::vector<std::string>& nodes) {
  trace::Names names;
  text::TextOutput errors;
  bool good = plant.empty() || plant::add_plant_names(plant, names, errors);
  good = good && (network.empty() || master::add_network_names(network, names, errors));
  for (const std::string& node : nodes) good = good && trace::add_node_names(node, names, errors);
  if (!good) refuse(errors);
  return names;
}

}  // namespace canopus::python
