#pragma once
// Names of the nodes on a bus, for commands that join it: out of a plant, a network file or a project.

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

#include "canopus/trace/decode/names.hpp"

namespace canopus::cli {

class Command;

struct NodeNamesOptions {
  std::string plant{};
  std::string network{};
  std::string project{};
};

/// --plant, --network and --project; `what` they give, "names of nodes".
void add_node_names_options(Command& command, NodeNamesOptions& options, const char* what);

/// plant.toml or nodelist.cpj of the working folder stands in for options, where a name has to be looked up.
[[nodiscard]] NodeNamesOptions with_default(NodeNamesOptions options);

/// plant.toml of the working folder stands in for options where `bus`, as --bus has it, is a bus of that plant: the port
/// of its socketcand server on this machine.
[[nodiscard]] NodeNamesOptions with_plant_of_bus(NodeNamesOptions options, const std::string& bus);

/// The error is empty if the mistakes of a file were printed already.
[[nodiscard]] std::expected<trace::Names, std::string> load_node_names(const NodeNamesOptions& options);

/// A node as a person writes it: number or name, also as BUS:NODE. nullptr: none of them. The error: several are.
[[nodiscard]] std::expected<const trace::NodeDescription*, std::string> find_named_node(
    const trace::Names& names, std::string_view text);
/// The sentence for a node that is in no file; `sources`: the options that have names.
[[nodiscard]] std::string no_such_node(const trace::Names& names, std::string_view text,
                                       std::string_view sources);
/// The node-ID of such a text. Files are read for a name alone. The error as of load_node_names().
[[nodiscard]] std::expected<std::uint8_t, std::string> find_node_id(const NodeNamesOptions& options,
                                                                    const std::string& text);

/// "line1:5 (servo)"
[[nodiscard]] std::string shown_node(const trace::NodeDescription& node);

}  // namespace canopus::cli
