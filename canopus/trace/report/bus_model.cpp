#include "canopus/trace/report/bus_model.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "canopus/trace/decode/object_facts.hpp"

namespace canopus::trace {
namespace {

ModelPdo model_pdo(const BusKnowledge& bus, FrameKey key, const PdoFacts& facts) {
  ModelPdo pdo{.key = key, .node = facts.node, .transmit = facts.transmit, .number = facts.number};
  for (const PdoFacts& sharing : bus.pdos(key)) {
    auto& list = sharing.transmit ? pdo.producers : pdo.consumers;
    if (std::ranges::find(list, sharing.node) == list.end()) list.push_back(sharing.node);
  }
  const NodeDescription* const node = bus.node(facts.node);
  unsigned bit = 0;
  for (const std::uint32_t entry : facts.mapping) {
    const unsigned bits = entry & 0xFFU;
    if (bits == 0 || bit + bits > 64) break;
    const auto index = static_cast<std::uint16_t>(entry >> 16);
    const auto sub = static_cast<std::uint8_t>(entry >> 8);
    if (index >= 0x20) {  // else a dummy
      ObjectFacts object = object_facts(node == nullptr ? nullptr : node->dictionary.get(), index, sub);
      pdo.signals.push_back({.index = index,
                             .sub = sub,
                             .first_bit = static_cast<std::uint8_t>(bit),
                             .bits = static_cast<std::uint8_t>(bits),
                             .type = object.type,
                             .name = std::move(object.name)});
    }
    bit += bits;
  }
  pdo.length = (bit + 7) / 8;
  return pdo;
}

}  // namespace

std::string BusModel::node_name(std::uint8_t node_id) const {
  const auto node =
      std::ranges::find(nodes, node_id, [](const NodeDescription* one) { return one->node_id; });
  if (node == nodes.end() || (*node)->name.empty()) return fmt::format("node {}", node_id);
  return (*node)->name;
}

BusModel model_of(const Names& names, std::string_view bus) {
  BusModel model{.bus = std::string(bus)};
  for (const NodeDescription& node : names.nodes()) {
    if (bus.empty() || node.bus.empty() || node.bus == bus) model.nodes.push_back(&node);
  }
  const BusKnowledge knowledge(model.nodes);
  for (const FrameKey key : knowledge.pdo_identifiers()) {
    const PdoFacts* const pdo = knowledge.pdo(key);
    if (pdo != nullptr && pdo->mpdo == 0) model.pdos.push_back(model_pdo(knowledge, key, *pdo));
  }
  return model;
}

}  // namespace canopus::trace
