#pragma once
// A campaign with its plants: read once, then shared by all runs, on any number of threads.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopus/campaign/campaign_file.hpp"
#include "canopus/campaign/plant_template.hpp"
#include "canopus/text/output.hpp"

namespace canopus::campaign {

struct Campaign {
  CampaignFile file{};
  toml::table source{};                 ///< the file's text
  std::vector<PlantTemplate> plants{};  ///< of each variant
  /// Of the campaign file, the plants, and the files that they name: results of another one do not belong to it. The number of
  /// seeds, which may be raised later, is not in it.
  std::string checksum{};
};

/// Reads the file and tries each rule once in each plant. Nothing after its mistakes were printed on `err`.
[[nodiscard]] std::optional<Campaign> load_campaign(const std::string& path, text::Output& err);

}  // namespace canopus::campaign
