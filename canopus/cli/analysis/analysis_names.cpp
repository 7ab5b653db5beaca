#include "canopus/cli/analysis/analysis_names.hpp"

#include <filesystem>
#include <utility>

#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/option_checks.hpp"
#include "canopus/cli/terminal/plant_loading.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/master/network_file.hpp"
#include "canopus/plant/initial_nodes.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::cli {
namespace {

/// The device file, or nullptr after its mistake was printed.
std::shared_ptr<const eds::DeviceFile> load_device_file(const std::string& path, Output& err) {
  const auto text = text::read_file(path);
  if (!text) {
    err.line("canopus: {}", text.error());
    return nullptr;
  }
  const eds::ReadResult result = eds::read_device_file(*text);
  if (!result.file) {
    const eds::Problem& problem = result.problems.front();
    err.line("{}:{}:{}: {}", path, problem.line, problem.column, problem.message);
  }
  return result.file;
}

std::string name_of(const eds::DeviceFile& file) {
  if (file.commissioning && !file.commissioning->node_name.empty()) return file.commissioning->node_name;
  return file.device.product_name;
}

bool add_plant(const std::string& path, trace::Names& names, Output& err) {
  class Nobody final : public plant::PlantObserver {
  } no_observer;
  const auto plant = load_plant(path, no_observer, err);
  if (!plant) return false;
  for (plant::InitialPlantNode& node : plant::initial_nodes(*plant)) {
    names.add(trace::describe_node(std::move(node.bus), node.node_id, std::move(node.name),
                                   std::move(node.objects)));
  }
  return true;
}

bool add_network(const std::string& path, trace::Names& names, Output& err) {
  const auto text = text::read_file(path);
  if (!text) {
    err.line("canopus: {}", text.error());
    return false;
  }
  master::NetworkReading reading = master::read_network(*text, path);
  if (!reading.errors.empty()) {
    print_errors(std::move(reading.errors), path, err);
    return false;
  }
  names.add({.node_id = reading.network.node, .name = "master"});
  for (const master::NetworkSlave& slave : reading.network.slaves) {
    std::shared_ptr<const canopen::DictionaryDescription> dictionary;
    std::string name = slave.name;
    if (!slave.eds.empty()) {
      const auto file =
          load_device_file((std::filesystem::path(path).parent_path() / slave.eds).string(), err);
      if (!file) return false;
      dictionary = file->dictionary;
      if (name.empty()) name = name_of(*file);
    }
    names.add(trace::describe_node("", slave.node, std::move(name), std::move(dictionary)));
  }
  return true;
}

/// "3=encoder.eds", "3".
bool add_node(const std::string& text, trace::Names& names, Output& err) {
  const std::size_t sign = text.find('=');
  const std::string number = text.substr(0, sign);
  if (sign == std::string::npos || !number_from(1, 127)(number).empty()) {
    err.line("canopus: --node {}: expected a node-ID 1 to 127, = and a device file, as 3=encoder.eds", text);
    return false;
  }
  const auto file = load_device_file(text.substr(sign + 1), err);
  if (!file) return false;
  names.add(trace::describe_node("", static_cast<std::uint8_t>(std::stoi(number)), name_of(*file),
                                 file->dictionary));
  return true;
}

}  // namespace

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
  if (!options.plant.empty() && !add_plant(options.plant, names, err)) return std::nullopt;
  if (!options.network.empty() && !add_network(options.network, names, err)) return std::nullopt;
  for (const std::string& node : options.nodes) {
    if (!add_node(node, names, err)) return std::nullopt;
  }
  return names;
}

}  // namespace canopus::cli
