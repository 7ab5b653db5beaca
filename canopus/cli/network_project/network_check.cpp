#include "canopus/cli/network_project/network_check.hpp"

#include <algorithm>
#include <utility>

#include "canopus/plant/plant_review.hpp"

namespace canopus::cli {
namespace {

using network_project::ProjectNode;

plant::ReviewedNode reviewed(const ProjectNode& node) {
  static const std::vector<text::ObjectSetting> no_settings;
  plant::ReviewedNode result{.place = {node.listed.line, 0},
                             .name = node.shown_name(),
                             .node_id = node.id(),
                             .objects = canopen::ObjectDictionary(node.device->dictionary, node.id()),
                             .settings = &no_settings,
                             .file = node.device.get()};
  const canopen::CobId sync{static_cast<std::uint32_t>(node.value(0x1005).value_or(0))};
  result.produces_sync =
      sync.has_bit_30() && !canopen::is_restricted(sync) && node.value(0x1006).value_or(0) != 0;
  return result;
}

/// A manager is in the project, so what happens on its bus is known.
bool has_manager(const network_project::NetworkProject& project) {
  return std::ranges::any_of(project.nodes(), [](const ProjectNode& node) {
    return node.device != nullptr && node.device->commissioning &&
           node.device->commissioning->canopen_manager;
  });
}

}  // namespace

std::vector<network_project::Finding> review_network(const network_project::NetworkProject& project) {
  std::vector<network_project::Finding> findings = network_project::review(project);
  plant::ReviewedBus bus{.name = project.network().name};
  for (const ProjectNode& node : project.nodes()) {
    if (node.device != nullptr && node.listed.present) bus.nodes.push_back(reviewed(node));
  }
  bus.may_have_others = !has_manager(project);
  // One CAN-ID of two senders cannot work; the other warnings about plants may be intended.
  plant::Warnings conflicts;
  plant::find_two_senders(bus, conflicts);
  plant::Warnings warnings;
  plant::review(bus, warnings);
  for (text::FileWarning& warning : warnings) {
    const bool is_conflict = std::ranges::find(conflicts, warning) != conflicts.end();
    const auto node = std::ranges::find_if(
        project.nodes(), [&](const ProjectNode& one) { return one.listed.line == warning.place.line; });
    findings.push_back(
        {.severity = is_conflict ? eds::Problem::Severity::error : eds::Problem::Severity::warning,
         .node_id = node == project.nodes().end() ? std::uint8_t{0} : node->id(),
         .path = project.list_path(),
         .line = warning.place.line,
         .message = std::move(warning.message)});
  }
  std::ranges::stable_sort(findings,
                           [](const network_project::Finding& a, const network_project::Finding& b) {
                             return std::pair(a.severity, a.node_id) < std::pair(b.severity, b.node_id);
                           });
  return findings;
}

}  // namespace canopus::cli
