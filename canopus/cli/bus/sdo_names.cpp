#include "canopus/cli/bus/sdo_names.hpp"

#include <memory>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/output/device_names.hpp"
#include "canopus/client/node_id.hpp"
#include "canopus/network_project/network_project.hpp"
#include "canopus/trace/decode/names.hpp"
#include "canopus/trace/print/node_names.hpp"

namespace canopus::cli {
namespace {

using client::SdoTarget;
using trace::NodeDescription;
using Dictionary = std::shared_ptr<const canopen::DictionaryDescription>;

constexpr std::string_view sources = "--plant, --network, --project or --eds";

/// The node of a device file alone: by number, or by the name that a DCF gives it.
std::expected<NodeDescription, std::string> node_of_file(const std::string& path, const eds::DeviceFile& file,
                                                         std::string_view text) {
  auto number = static_cast<std::uint8_t>(client::parse_node(text));
  const std::string name = trace::node_name_of(file);
  if (number == 0 && file.commissioning && ascii::equal_ignoring_case(name, text))
    number = file.commissioning->node_id.value_or(0);
  if (number == 0)
    return std::unexpected(
        fmt::format("\"{}\" is not a node; expected a node-ID 1 to 127, as {} names none "
                    "of this name",
                    text, path));
  return NodeDescription{.node_id = number, .name = name, .dictionary = file.dictionary};
}

std::expected<NodeDescription, std::string> find_node(const SdoNamesOptions& options,
                                                      const trace::Names& names, const std::string& text) {
  const auto found = find_named_node(names, text);
  if (!found) return std::unexpected(found.error());
  NodeDescription node;
  if (*found != nullptr) node = **found;
  if (!options.eds.empty()) {
    const auto file = device_file_of_names(options.eds);
    if (!file) return std::unexpected("--eds: " + file.error());
    if (node.node_id == 0) return node_of_file(options.eds, **file, text);
    node.dictionary = (*file)->dictionary;
  }
  if (node.node_id == 0) node.node_id = static_cast<std::uint8_t>(client::parse_node(text));
  if (node.node_id == 0) return std::unexpected(no_such_node(names, text, sources));
  return node;
}

/// The device file of a concise DCF's destination: with --eds that file, else that of the node of the sub-index.
Dictionary destination_of(const SdoTarget& target, const SdoNamesOptions& options, const trace::Names& names,
                          const NodeDescription& node) {
  if (!options.eds.empty()) return node.dictionary;
  for (const NodeDescription& other : names.nodes()) {
    if (other.node_id == target.object.sub && other.bus == node.bus) return other.dictionary;
  }
  return nullptr;
}

}  // namespace

void add_sdo_names_options(Command& command, SdoNamesOptions& options) {
  add_node_names_options(command, options.nodes, "names of nodes and objects, types, units");
  command
      .add_option("--eds", options.eds,
                  "device file of NODE, for the same; of a concise DCF (1F22H): of the node that it is for")
      ->type_name("FILE");
}

std::expected<SdoTarget, std::string> find_sdo_target(const SdoNamesOptions& options, const std::string& node,
                                                      const std::string& object, const std::string& type) {
  const auto number = text::parse_object(object);
  const bool has_names = client::parse_node(node) == 0 || !number;
  const bool wants_default = has_names && options.eds.empty();
  const auto loaded = load_node_names(wants_default ? with_default(options.nodes) : options.nodes);
  if (!loaded) return std::unexpected(loaded.error());
  const trace::Names& names = *loaded;
  const auto found = find_node(options, names, node);
  if (!found) return std::unexpected(found.error());

  SdoTarget target{.node = found->node_id};
  if (number) target.object = *number;
  if (auto good = target.set_type(type); !good) return std::unexpected(std::move(good.error()));
  if (number && number->index == client::concise_dcf_object) {
    target.names = destination_of(target, options, names, *found);
    return target;
  }
  if (found->dictionary == nullptr) {
    if (number) return target;
    return std::unexpected(
        fmt::format("\"{}\" is not an object; expected index:sub-index in hexadecimal, for "
                    "example 6000:01, or a name of its device file with {}",
                    object, sources));
  }
  const auto entry = network_project::find_object(*found->dictionary, shown_node(*found), object);
  if (!entry && !number) return std::unexpected(entry.error());
  if (entry) target.use(found->dictionary, *entry, network_project::object_title(*found->dictionary, *entry));
  return target;
}

}  // namespace canopus::cli
