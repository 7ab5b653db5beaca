#include "canopus/cli/trace/names_options.hpp"

#include "canopus/cli/options/command.hpp"
#include "canopus/master/network_names.hpp"
#include "canopus/plant/plant_names.hpp"
#include "canopus/trace/print/node_names.hpp"

namespace canopus::cli {
void add_names_options(Command& command, NamesOptions& options) {
  command.add_option("--plant", options.plant, "Plant file: names of nodes and objects, mapped PDOs")
      ->type_name("PLANT");
  command.add_option("--network", options.network, "Network file of `canopus master`, for the same")
      ->type_name("NETWORK");
  command
      .add_option("--node", options.nodes,
                  "Device file (EDS or DCF) of a node, as 3=encoder.eds; may be repeated")
      ->type_name("ID=FILE")
      ->allow_extra_args(false);
}

std::vector<std::string> files_of(const NamesOptions& options) {
  std::vector<std::string> files;
  for (const std::string& name : {options.plant, options.network}) {
    if (!name.empty()) files.push_back(name);
  }
  for (const std::string& node : options.nodes) {
    if (const std::size_t equals = node.find('='); equals != std::string::npos)
      files.push_back(node.substr(equals + 1));
  }
  return files;
}

std::optional<trace::Names> load_names(const NamesOptions& options, Output& err) {
  trace::Names names;
  if (!options.plant.empty() && !plant::add_plant_names(options.plant, names, err)) return std::nullopt;
  if (!options.network.empty() && !master::add_network_names(options.network, names, err))
    return std::nullopt;
  for (const std::string& node : options.nodes) {
    if (!trace::add_node_names(node, names, err)) return std::nullopt;
  }
  return names;
}

}  // namespace canopus::cli
