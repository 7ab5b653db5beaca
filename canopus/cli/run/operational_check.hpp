#pragma once
// Has the network of a plant come up? For runs that answer it with their exit code.

#include <optional>
#include <string>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::cli {

/// All nodes of the plant are Operational, or online in a Layer 2 mode.
[[nodiscard]] bool all_operational(const std::vector<plant::NodeStatus>& nodes);

/// A line for each node of the plant that is not, with the step its boot is at and what to check, as far as a
/// master of the plant boots it: "line1 node 3 (encoder) is pre-operational: failed (M, ...). Check ...". A
/// slave that is no node of the plant has a line when its boot is not over.
[[nodiscard]] std::vector<std::string> not_operational(const std::vector<plant::NodeStatus>& nodes,
                                                       const std::vector<plant::SlaveBoot>& boots,
                                                       can::Time now);

/// The expectation of a run.
class OperationalCheck {
 public:
  /// `within`: plant time by which all nodes have to have been operational once; without it only the end
  /// counts. `goes_on`: the run has its own end, and continues when they are.
  OperationalCheck(std::optional<can::Duration> within, bool goes_on) : within_(within), goes_on_(goes_on) {}

  /// Asked now and then: true when the question is answered and the run ends by it.
  [[nodiscard]] bool over(const std::vector<plant::NodeStatus>& nodes, can::Time now);
  /// At the end of the run: were they in time, and are they now?
  [[nodiscard]] bool met(const std::vector<plant::NodeStatus>& nodes, can::Time now);

 private:
  void update(const std::vector<plant::NodeStatus>& nodes, can::Time now);

  std::optional<can::Duration> within_;
  bool goes_on_;
  bool came_up_ = false;
};

}  // namespace canopus::cli
