#pragma once
// Everything that can be said of a project without its bus: its own findings, and those that plants have.

#include <vector>

#include "canopus/project/network/network_review.hpp"

namespace canopus::cli {

/// project::review(), and what plant::review() finds in nodes as these. Sorted as that is.
[[nodiscard]] std::vector<project::Finding> review_network(const project::NetworkProject& project);

}  // namespace canopus::cli
