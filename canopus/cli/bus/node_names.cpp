#include "canopus/cli/bus/node_names.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/client/node_id.hpp"
#include "canopus/link/bus_address.hpp"
#include "canopus/master/network_file.hpp"
#include "canopus/network_project/network_project.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/initial_nodes.hpp"
#include "canopus/store/inner_path.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::cli {
namespace {

namespace fs = std::filesystem;

using trace::NodeDescription;
using Done = std::expected<void, std::string>;

constexpr const char* default_plant = "plant.toml";
constexpr const char* default_list = "nodelist.cpj";

Done add_project_names(const std::string& path, trace::Names& names) {
  std::error_code ignored;
  const bool is_list =
      ascii::lower(fs::path(path).extension().string()) == ".cpj" && !fs::is_directory(path, ignored);
  const fs::path folder = is_list ? fs::path(path).parent_path() : fs::path(path);
  const std::string list = is_list ? fs::path(path).filename().string() : default_list;
  const auto read =
      [&folder](const std::string& name) -> std::expected<std::optional<std::string>, std::string> {
    const fs::path root = folder.empty() ? fs::path(".") : folder;
    std::error_code error;
    if (!fs::exists(root / name, error)) return std::nullopt;
    auto text = store::read_inner_file(root, name);
    if (!text) return std::unexpected(std::move(text.error()));
    return std::move(*text);
  };
  const auto project = network_project::NetworkProject::open(list, read);
  if (!project) return std::unexpected(fmt::format("{}: {}", path, project.error()));
  for (const network_project::ProjectNode& node : project->nodes()) {
    if (node.device != nullptr)
      names.add(trace::describe_node("", node.id(), node.listed.name, node.device->dictionary));
  }
  return {};
}

Done load(const NodeNamesOptions& options, trace::Names& names) {
  const Done printed = std::unexpected(std::string());
  if (!options.plant.empty() && !plant::add_plant_names(options.plant, names, standard_error()))
    return printed;
  if (!options.network.empty() && !master::add_network_names(options.network, names, standard_error()))
    return printed;
  return options.project.empty() ? Done{} : add_project_names(options.project, names);
}

/// The nodes that a text may mean; several: it is ambiguous.
std::vector<const NodeDescription*> nodes_called(const trace::Names& names, std::string_view text) {
  std::string_view bus;
  if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
    bus = text.substr(0, colon);
    text.remove_prefix(colon + 1);
  }
  const unsigned number = client::parse_node(text);
  std::vector<const NodeDescription*> exact;
  std::vector<const NodeDescription*> other_case;
  for (const NodeDescription& node : names.nodes()) {
    if (!bus.empty() && node.bus != bus) continue;
    if (number != 0 ? node.node_id == number : node.name == text) {
      exact.push_back(&node);
    } else if (number == 0 && ascii::equal_ignoring_case(node.name, text)) {
      other_case.push_back(&node);
    }
  }
  return exact.empty() ? other_case : exact;
}

}  // namespace

void add_node_names_options(Command& command, NodeNamesOptions& options, const char* what) {
  command.add_option("--plant", options.plant, std::string("plant file: ") + what)->type_name("PLANT");
  command.add_option("--network", options.network, "network file of `canopus master`, for the same")
      ->type_name("NETWORK");
  command
      .add_option("--project", options.project,
                  "project, for the same: folder with nodelist.cpj, or a file *.cpj")
      ->type_name("PROJECT");
}

NodeNamesOptions with_default(NodeNamesOptions options) {
  std::error_code ignored;
  if (!options.plant.empty() || !options.network.empty() || !options.project.empty()) return options;
  if (fs::exists(default_plant, ignored)) {
    options.plant = default_plant;
  } else if (fs::exists(default_list, ignored)) {
    options.project = default_list;
  }
  return options;
}

NodeNamesOptions with_plant_of_bus(NodeNamesOptions options, const std::string& bus) {
  if (!options.plant.empty() || !options.network.empty() || !options.project.empty()) return options;
  const auto address = link::parse_bus_address(bus);
  if (!address || address->kind != link::BusAddress::Kind::socketcand) return options;
  if (address->host != "127.0.0.1" && address->host != "localhost" && address->host != "::1") return options;
  const auto text = text::read_file(default_plant);
  if (!text) return options;
  const plant::PlantReading reading = plant::read_plant(*text, default_plant);
  const bool has_bus = std::ranges::any_of(reading.plant.buses, [&](const plant::BusSection& section) {
    return section.socketcand && section.socketcand->port == address->port;
  });
  if (reading.errors.empty() && has_bus) options.plant = default_plant;
  return options;
}

std::expected<trace::Names, std::string> load_node_names(const NodeNamesOptions& options) {
  trace::Names names;
  if (const Done done = load(options, names); !done) return std::unexpected(done.error());
  return names;
}

std::string shown_node(const NodeDescription& node) {
  const std::string name = node.name.empty() ? "" : fmt::format(" ({})", node.name);
  return node.bus.empty() ? fmt::format("node {}{}", node.node_id, name)
                          : fmt::format("{}:{}{}", node.bus, node.node_id, name);
}

std::string no_such_node(const trace::Names& names, std::string_view text, std::string_view sources) {
  constexpr std::size_t most_listed = 12;
  std::vector<std::string_view> known;
  for (const NodeDescription& node : names.nodes()) {
    if (!node.name.empty() && std::ranges::find(known, node.name) == known.end()) known.push_back(node.name);
  }
  if (known.empty())
    return fmt::format("\"{}\" is not a node; expected a node-ID 1 to 127, or a name with {}", text, sources);
  const bool is_short = known.size() <= most_listed || !text::nearest(text, known).empty();
  return fmt::format("there is no node \"{}\"{}", text,
                     is_short ? text::suggestion(text, known) : "; expected a node-ID or the name of a node");
}

std::expected<const NodeDescription*, std::string> find_named_node(const trace::Names& names,
                                                                   std::string_view text) {
  const auto found = nodes_called(names, text);
  if (found.size() < 2) return found.empty() ? nullptr : found.front();
  std::string list;
  for (const NodeDescription* node : found) list += (list.empty() ? "" : ", ") + shown_node(*node);
  return std::unexpected(fmt::format("\"{}\" is one of {}; expected BUS:NODE", text, list));
}

std::expected<std::uint8_t, std::string> find_node_id(const NodeNamesOptions& options,
                                                      const std::string& text) {
  if (const unsigned number = client::parse_node(text); number != 0) return static_cast<std::uint8_t>(number);
  const auto names = load_node_names(with_default(options));
  if (!names) return std::unexpected(names.error());
  const auto node = find_named_node(*names, text);
  if (!node) return std::unexpected(node.error());
  if (*node == nullptr) return std::unexpected(no_such_node(*names, text, "--plant, --network or --project"));
  return (*node)->node_id;
}

}  // namespace canopus::cli
