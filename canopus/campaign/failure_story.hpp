#pragma once
// What is left of a failure: a folder with the smallest run that shows it, ready to be run again, and its story.

#include <expected>
#include <functional>
#include <string>

#include "canopus/campaign/shrink.hpp"
#include "canopus/campaign/summary.hpp"

namespace canopus::campaign {

/// Of more kinds than this no story is told.
inline constexpr std::size_t most_stories = 100;

/// "failures/seed-7-plant-1f2e3d4c", in the folder of the results.
[[nodiscard]] std::string story_folder(const FailureKind& kind);

/// Shrinks the first run of each kind of failure, and writes its folder: plant.toml with its device files, campaign.toml,
/// trace.log, events.jsonl, story.json. What is there already stays. `is_over` as in RunnerUse, asked between two runs. The
/// error is a sentence.
[[nodiscard]] std::expected<void, std::string> write_stories(const Campaign& campaign, const Summary& summary,
                                                             const std::string& results_folder,
                                                             const std::function<bool()>& is_over);

}  // namespace canopus::campaign
