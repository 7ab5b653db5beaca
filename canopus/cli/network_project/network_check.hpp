#pragma once
// All checks of a project without its bus: its own, and those of plants.

#include <vector>

#include "canopus/network_project/network_review.hpp"

namespace canopus::cli {

/// network_project::review(), and what plant::review() finds in nodes as these. Sorted as that is.
[[nodiscard]] std::vector<network_project::Finding> review_network(
    const network_project::NetworkProject& project);

}  // namespace canopus::cli
