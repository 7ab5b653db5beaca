#include "canopus/trace/decode/names.hpp"

#include <algorithm>
#include <utility>

namespace canopus::trace {

std::vector<Setting> settings_of(const canopen::ObjectDictionary& objects) {
  std::vector<Setting> settings;
  const canopen::DictionaryDescription& description = objects.description();
  for (const canopen::ObjectDescription& object : description.objects()) {
    if (!is_service_setting(object.index)) continue;
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const auto entry = description.find(object, static_cast<std::uint8_t>(sub));
      if (!entry || entry.description->length == 0) continue;
      settings.push_back({object.index, entry.sub, objects.get<std::uint32_t>(entry)});
    }
  }
  return settings;
}

NodeDescription describe_node(std::string bus, std::uint8_t node_id, std::string name,
                              std::shared_ptr<const canopen::DictionaryDescription> dictionary) {
  NodeDescription node{.bus = std::move(bus),
                       .node_id = node_id,
                       .name = std::move(name),
                       .dictionary = std::move(dictionary)};
  if (node.dictionary) node.settings = settings_of(canopen::ObjectDictionary(node.dictionary, node_id));
  return node;
}

NodeDescription describe_node(std::string bus, std::uint8_t node_id, std::string name,
                              canopen::ObjectDictionary objects) {
  const auto kept = std::make_shared<const canopen::ObjectDictionary>(std::move(objects));
  return {.bus = std::move(bus),
          .node_id = node_id,
          .name = std::move(name),
          .dictionary = {kept, &kept->description()},  // lives as long as what it is part of
          .settings = settings_of(*kept)};
}

void Names::add(NodeDescription node) {
  const auto same = std::ranges::find_if(nodes_, [&](const NodeDescription& other) {
    return other.bus == node.bus && other.node_id == node.node_id;
  });
  if (same == nodes_.end()) {
    nodes_.push_back(std::move(node));
  } else {
    *same = std::move(node);
  }
}

std::vector<const NodeDescription*> Names::on_channel(std::string_view channel) const {
  const bool named =
      std::ranges::any_of(nodes_, [&](const NodeDescription& node) { return node.bus == channel; });
  std::vector<const NodeDescription*> found;
  for (const NodeDescription& node : nodes_) {
    const auto same_id = [&](const NodeDescription& other) { return other.node_id == node.node_id; };
    if (node.bus.empty() || node.bus == channel || (!named && std::ranges::count_if(nodes_, same_id) == 1)) {
      found.push_back(&node);
    }
  }
  return found;
}

}  // namespace canopus::trace
