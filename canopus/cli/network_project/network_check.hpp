#pragma once
// All checks of a project without its bus: its own, and those of plants.

#include <optional>
#include <string>
#include <vector>

#include "canopus/network_project/network_review.hpp"
#include "canopus/text/output.hpp"

namespace canopus::cli {

/// network_project::review(), and what plant::review() finds in nodes as these. Sorted as that is.
[[nodiscard]] std::vector<network_project::Finding> review_network(
    const network_project::NetworkProject& project, const network_project::ExternalPdos& external = {});

/// The PDOs of the plant's nodes that are not in the project, such as its module, on the buses that have the project; on all
/// where none has it. Nothing after mistakes of the plant file were printed.
[[nodiscard]] std::optional<network_project::ExternalPdos> external_pdos(
    const network_project::NetworkProject& project, const std::string& plant_file, text::Output& err);

}  // namespace canopus::cli
