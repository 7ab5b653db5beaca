// Commands for the other nodes of a module's network, which it reaches by its command interface.

#include <array>
#include <optional>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/cli/bus/node_names.hpp"
#include "canopus/cli/module_settings/module_access.hpp"
#include "canopus/cli/module_settings/node_files.hpp"
#include "canopus/cli/module_settings/settings_file.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

using client::PlcModule;
using module_settings::ModuleProject;
using module_settings::ObjectNumber;
using Json = text::Json;

struct NodeObject {
  std::string_view name;  ///< as the node settings window prints it
  ObjectNumber object;
  bool is_text;
};
constexpr std::array node_objects{
    NodeObject{"Device name", {0x1008, 0}, true},      NodeObject{"Vendor-ID", {0x1018, 1}, false},
    NodeObject{"Product code", {0x1018, 2}, false},    NodeObject{"Revision number", {0x1018, 3}, false},
    NodeObject{"Serial number", {0x1018, 4}, false},   NodeObject{"Hardware version", {0x1009, 0}, true},
    NodeObject{"Software version", {0x100A, 0}, true},
};

/// An answer, or nothing where the node has no such object; the error is one of the PLC or of a silent node.
std::expected<std::optional<std::vector<std::uint8_t>>, std::string> read_if_there(PlcModule& module,
                                                                                   std::uint8_t node,
                                                                                   ObjectNumber object) {
  auto bytes = module.read_bytes(node, object);
  if (bytes) return std::move(*bytes);
  const std::string& error = bytes.error();
  // 06020000H: no such object; 06090011H: no such sub-index [CiA 301 7.2.4.3.17].
  if (error.find("06020000H") != std::string::npos || error.find("06090011H") != std::string::npos)
    return std::nullopt;
  return std::unexpected(error);
}

std::uint32_t number_of(const std::vector<std::uint8_t>& bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 4); ++i)
    value |= std::uint32_t{bytes[i]} << 8 * i;
  return value;
}

/// File version and revision as in the node settings window; null: the node has no file.
void add_file_information(const std::vector<NodeFile>& files, Json& shown) {
  Json& version = shown["EDS file version"];
  Json& revision = shown["EDS file revision"];
  const auto number = [&](const char* name) {
    const Json& value = shown[name];
    return value.is_number() ? value.get<std::uint32_t>() : 0;
  };
  if (!shown["Product code"].is_number()) return;
  const NodeFile* const file =
      file_of_node(files, number("Vendor-ID"), number("Product code"), number("Revision number"));
  if (file == nullptr) return;
  version = file->version;
  revision = file->revision;
}

/// One node's hardware data.
std::expected<void, std::string> print_node(PlcModule& module, std::uint8_t node, std::uint8_t number,
                                            const std::string& name, const std::vector<NodeFile>& files,
                                            bool json) {
  Json shown{{"node", number}, {"name", name}};
  for (const NodeObject& each : node_objects) {
    const auto bytes = read_if_there(module, node, each.object);
    if (!bytes) return std::unexpected(bytes.error());
    Json& value = shown[std::string(each.name)];
    if (!*bytes) continue;
    if (each.is_text) {
      value = std::string((*bytes)->begin(), (*bytes)->end());
    } else {
      value = number_of(**bytes);
    }
  }
  add_file_information(files, shown);
  if (json) {
    print_json(shown);
    return {};
  }
  print_line("Node ID {}, {}", number, name);
  for (const NodeObject& each : node_objects) {
    const Json& value = shown[std::string(each.name)];
    print_line("  {:<18} {}", each.name,
               value.is_null()     ? std::string("-")
               : value.is_string() ? value.get<std::string>()
                                   : fmt::format("0x{:08X}", value.get<std::uint32_t>()));
  }
  for (const char* const each : {"EDS file version", "EDS file revision"})
    print_line("  {:<18} {}", each, shown[each].is_null() ? "-" : shown[each].dump());
  return {};
}

struct NodeOrder {
  std::uint16_t index;
  std::uint32_t signature;
  std::string_view done;
};
// [CiA 301 7.5.2.13] [CiA 301 7.5.2.14]
constexpr NodeOrder save_order{0x1010, 0x65766173, "object dictionary saved"};
constexpr NodeOrder restore_order{0x1011, 0x64616F6C,
                                  "defaults restored; they count after a reset of the node"};

/// The names of the project's node list.
trace::Names names_of_project(const ConfigureArguments& arguments) {
  trace::Names names;
  if (arguments.file.empty()) return names;
  const auto project = read_project(arguments.file, [](const std::string&) {});
  const module_settings::Window* const list = project ? project->window("node") : nullptr;
  if (list == nullptr) return names;
  for (const auto& [number, row] : project->rows(*list))
    names.add({.node_id = static_cast<std::uint8_t>(number), .name = row.name});
  return names;
}

}  // namespace

std::string resolve_node(ConfigureArguments& arguments) {
  const std::string& text = arguments.node_text;
  if (text.empty()) return {};
  if (const auto number = ascii::parse_number_with_prefix<unsigned>(text)) {
    if (*number > 127)
      return fmt::format("\"{}\" is not a node; expected a node-ID 1 to 127, or a name", text);
    arguments.node = *number;
    return {};
  }
  trace::Names names = names_of_project(arguments);
  auto found = find_named_node(names, text);
  if (found && *found == nullptr) {
    const auto of_folder = load_node_names(with_default({}));
    if (!of_folder)
      return of_folder.error().empty() ? "the names of nodes cannot be read" : of_folder.error();
    for (const trace::NodeDescription& node : of_folder->nodes()) names.add(node);
    found = find_named_node(names, text);
  }
  if (!found) return found.error();
  if (*found == nullptr)
    return no_such_node(names, text,
                        "a plant.toml or nodelist.cpj in this folder, or the project's node list");
  arguments.node = (*found)->node_id;
  return {};
}

int list_nodes(const ConfigureArguments& arguments) {
  const NodeOrder* const order = arguments.save ? &save_order : arguments.restore ? &restore_order : nullptr;
  if (order != nullptr && !arguments.yes) {
    return configure_failed(configure_code::usage,
                            arguments.save
                                ? "the object dictionaries of the nodes are written into their memory: --yes"
                                : "the nodes lose their settings: --yes");
  }
  const auto files = read_node_files(arguments.device_files);
  if (!files) return configure_failed(configure_code::usage, "--eds: " + files.error());
  return with_project(arguments, [&](ModuleProject& project, client::PlcClient&, PlcModule& module,
                                     module_settings::PdoRange) {
    std::map<std::uint32_t, std::string> nodes;
    if (const module_settings::Window* const list = project.window("node"); list != nullptr) {
      for (const auto& [number, row] : project.rows(*list)) nodes[number] = row.name;
    }
    for (const auto& [number, row] : project.rows(*project.window("slave"))) nodes.try_emplace(number, "");
    if (arguments.node != 0) {
      const auto listed = nodes.find(arguments.node);
      nodes = {{arguments.node, listed == nodes.end() ? "" : listed->second}};
    }
    if (nodes.empty())
      return configure_failed(configure_code::usage, arguments.file + ": no node is in the list; or --node");
    int code = configure_code::done;
    for (const auto& [number, name] : nodes) {
      const std::uint8_t node = number == project.node_id() ? 0 : static_cast<std::uint8_t>(number);
      const auto answered =
          order == nullptr
              ? print_node(module, node, static_cast<std::uint8_t>(number), name, *files, arguments.json)
              : module.write_object(node, {order->index, 1}, order->signature, 4);
      if (!answered) {
        code = configure_failed(configure_code::failed, fmt::format("node {}: {}", number, answered.error()));
      } else if (order != nullptr && arguments.json) {
        print_json(Json{{"node", number}, {"done", order->done}});
      } else if (order != nullptr) {
        print_line("Node ID {}: {}", number, order->done);
      }
    }
    return code;
  });
}

int identify_slave(const ConfigureArguments& arguments) {
  auto file = ChangingProject::open(arguments.file);
  if (!file) return configure_failed(configure_code::usage, file.error());
  return with_project(arguments, [&](ModuleProject& project, client::PlcClient&, PlcModule& module,
                                     module_settings::PdoRange) {
    struct Identity {
      std::string_view field;
      ObjectNumber of_slave;
      std::uint16_t of_master;
    };
    constexpr std::array identities{
        Identity{"Device type", {0x1000, 0}, 0x1F84},   Identity{"Vendor-ID", {0x1018, 1}, 0x1F85},
        Identity{"Product code", {0x1018, 2}, 0x1F86},  Identity{"Revision number", {0x1018, 3}, 0x1F87},
        Identity{"Serial number", {0x1018, 4}, 0x1F88},
    };
    const module_settings::Window& slaves = *project.window("slave");
    if (!project.rows(slaves).contains(arguments.node)) {
      if (const auto added = project.add(slaves, arguments.node); !added)
        return configure_failed(configure_code::usage, fmt::format("{}: {}", arguments.file, added.error()));
    }
    const auto node = static_cast<std::uint8_t>(arguments.node);
    const bool from_slave = arguments.from == "slave";
    for (const Identity& each : identities) {
      const auto bytes = from_slave ? read_if_there(module, node, each.of_slave)
                                    : read_if_there(module, 0, {each.of_master, node});
      if (!bytes)
        return configure_failed(configure_code::failed, fmt::format("node {}: {}", node, bytes.error()));
      const std::string value = fmt::format("0x{:X}", *bytes ? number_of(**bytes) : 0);
      if (const auto set = project.set(slaves, arguments.node, each.field, value); !set)
        return configure_failed(configure_code::failed, set.error());
      if (arguments.json) {
        print_json(Json{{"slave", node}, {"field", each.field}, {"value", value}});
      } else {
        print_line("slave {}: {} = {}", node, each.field, value);
      }
    }
    const std::string wrong = file->save(project, fmt::format("identity of slave/{}", arguments.node));
    return wrong.empty() ? configure_code::done : configure_failed(configure_code::failed, wrong);
  });
}

}  // namespace canopus::cli
