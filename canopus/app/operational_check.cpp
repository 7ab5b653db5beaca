#include "canopus/app/operational_check.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "canopus/app/event_printer.hpp"

namespace canopus::app {
namespace {

bool same_node(const NodePlate& a, const NodePlate& b) { return a.bus == b.bus && a.node_id == b.node_id; }

}  // namespace

bool all_operational(const std::vector<NodeStatus>& nodes) {
  return std::ranges::all_of(nodes, in_operation);
}

std::vector<std::string> not_operational(const std::vector<NodeStatus>& nodes,
                                         const std::vector<SlaveBoot>& boots, can::Time now) {
  std::vector<std::string> lines;
  const auto booting = [](const SlaveBoot& boot) {
    return boot.record.step != manager::BootStep::booted && boot.record.step != manager::BootStep::idle;
  };
  for (const NodeStatus& node : nodes) {
    if (in_operation(node)) continue;
    std::string text = fmt::format("{} is {}", describe(node.plate), state_name(node));
    for (const SlaveBoot& boot : boots) {
      if (same_node(boot.slave, node.plate) && booting(boot))
        text += ": " + manager::explain(boot.record, now);
    }
    lines.push_back(std::move(text));
  }
  for (const SlaveBoot& boot : boots) {
    const auto is_slave = [&](const NodeStatus& node) { return same_node(node.plate, boot.slave); };
    if (booting(boot) && std::ranges::none_of(nodes, is_slave)) lines.push_back(describe_trouble(boot, now));
  }
  return lines;
}

void OperationalCheck::look(const std::vector<NodeStatus>& nodes, can::Time now) {
  const bool in_time = !within_ || now.time_since_epoch() <= *within_;
  came_up_ = came_up_ || (in_time && all_operational(nodes));
}

bool OperationalCheck::over(const std::vector<NodeStatus>& nodes, can::Time now) {
  if (!within_) return false;
  look(nodes, now);
  return came_up_ ? !goes_on_ : now.time_since_epoch() >= *within_;
}

bool OperationalCheck::met(const std::vector<NodeStatus>& nodes, can::Time now) {
  look(nodes, now);
  return came_up_ && all_operational(nodes);
}

}  // namespace canopus::app
