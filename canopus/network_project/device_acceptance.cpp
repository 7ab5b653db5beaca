#include "canopus/network_project/device_acceptance.hpp"

#include <fmt/format.h>

namespace canopus::network_project {
namespace {

/// The object of a manager that has this value of each slave, by node-ID: 1F84H of 1000H, then those of 1018:01 to 04.
constexpr std::uint16_t list_of_manager(const IdentityValue& value) {
  return static_cast<std::uint16_t>(0x1F84 + value.sub);
}

}  // namespace

std::vector<AcceptedValue> find_accepted_values(const NetworkProject& project, std::uint8_t node_id,
                                                std::span<const IdentityValue> found) {
  std::vector<AcceptedValue> values;
  const ProjectNode* const own = project.find(node_id);
  if (own == nullptr) return values;
  for (const IdentityValue& one : found) {
    const auto before = own->value(one.index, one.sub);
    if (before && *before != one.value) {
      values.push_back({node_id, one.index, one.sub, static_cast<std::uint32_t>(*before), one.value});
    }
  }
  for (const ProjectNode& node : project.nodes()) {
    const bool is_manager = node.device != nullptr && node.device->commissioning &&
                            node.device->commissioning->canopen_manager && node.id() != node_id;
    if (!is_manager) continue;
    for (const IdentityValue& one : found) {
      const auto before = node.value(list_of_manager(one), node_id);
      if (!before || *before == 0 || *before == one.value) continue;
      values.push_back(
          {node.id(), list_of_manager(one), node_id, static_cast<std::uint32_t>(*before), one.value});
    }
  }
  return values;
}

std::expected<void, std::string> accept_values(NetworkProject& project,
                                               std::span<const AcceptedValue> values) {
  NetworkProject changed = project;
  for (const AcceptedValue& one : values) {
    const auto done = changed.set_value(one.node_id, one.index, one.sub, fmt::format("0x{:08X}", one.after));
    if (!done) return std::unexpected(fmt::format("node {}: {}", one.node_id, done.error()));
  }
  project = std::move(changed);
  return {};
}

}  // namespace canopus::network_project
