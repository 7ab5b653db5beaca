#include "canopus/cli/run/operational_check.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "canopus/plant/events/event_printer.hpp"

namespace canopus::cli {
namespace {

bool same_node(const plant::NodeLabel& a, const plant::NodeLabel& b) {
  return a.bus == b.bus && a.node_id == b.node_id;
}

}  // namespace

bool all_operational(const std::vector<plant::NodeStatus>& nodes) {
  return std::ranges::all_of(nodes, plant::in_operation);
}

std::vector<std::string> not_operational(const std::vector<plant::NodeStatus>& nodes,
                                         const std::vector<plant::SlaveBoot>& boots, can::Time now) {
  std::vector<std::string> lines;
  const auto booting = [](const plant::SlaveBoot& boot) {
    return boot.record.step != manager::BootStep::booted && boot.record.step != manager::BootStep::idle;
  };
  const auto has_reason = [&](const plant::SlaveBoot& boot) {
    return booting(boot) || boot.record.halted_by != 0;
  };
  for (const plant::NodeStatus& node : nodes) {
    if (in_operation(node)) continue;
    std::string text = fmt::format("{} is {}", describe(node.label), condition_name(node));
    for (const plant::SlaveBoot& boot : boots) {
      if (same_node(boot.slave, node.label) && has_reason(boot))
        text += ": " + manager::explain(boot.record, now);
    }
    lines.push_back(std::move(text));
  }
  for (const plant::SlaveBoot& boot : boots) {
    const auto is_slave = [&](const plant::NodeStatus& node) { return same_node(node.label, boot.slave); };
    if (booting(boot) && std::ranges::none_of(nodes, is_slave)) lines.push_back(describe_trouble(boot, now));
  }
  return lines;
}

void OperationalCheck::update(const std::vector<plant::NodeStatus>& nodes, can::Time now) {
  const bool in_time = !within_ || now.time_since_epoch() <= *within_;
  came_up_ = came_up_ || (in_time && all_operational(nodes));
}

bool OperationalCheck::over(const std::vector<plant::NodeStatus>& nodes, can::Time now) {
  if (!within_) return false;
  update(nodes, now);
  return came_up_ ? !goes_on_ : now.time_since_epoch() >= *within_;
}

bool OperationalCheck::met(const std::vector<plant::NodeStatus>& nodes, can::Time now) {
  update(nodes, now);
  return came_up_ && all_operational(nodes);
}

}  // namespace canopus::cli
