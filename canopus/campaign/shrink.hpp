#pragma once
// The smallest run that shows a failure: fewest rules, then the shortest time, then fewest devices.

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "canopus/campaign/plant_run.hpp"

namespace canopus::campaign {

struct ShrunkFailure {
  RunPlan plan{};
  InvariantFailure failure{};
  std::size_t runs = 0;  ///< that it took
};

/// Runs at most so many plants for one failure. A number and not a time: what comes out depends on no machine.
inline constexpr std::size_t most_shrinking_runs = 300;

/// Nothing: the plan does not show a failure of this fingerprint, or `is_over`, which is asked between two runs, said so.
[[nodiscard]] std::optional<ShrunkFailure> shrink(
    const Campaign& campaign, const RunPlan& plan, const std::string& fingerprint,
    const std::function<bool()>& is_over = [] { return false; });

}  // namespace canopus::campaign
