#pragma once
// Everything that can be said of a project without its bus: its own findings, and those that plants have.

#include <vector>

#include "canopus/network_project/network_review.hpp"

namespace canopus::cli {

/// network_project::review(), and what plant::review() finds in nodes as these. Sorted as that is.
[[nodiscard]] std::vector<network_project::Finding> review_network(
    const network_project::NetworkProject& project);

}  // namespace canopus::cli
