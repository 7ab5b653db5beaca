#pragma once
// What a seed chooses of a campaign's rules, and the values of their knobs.

#include <cstdint>
#include <string>
#include <vector>

#include "canopus/campaign/campaign_file.hpp"

namespace canopus::campaign {

/// A value that was drawn: "fault.from" = "1204us".
struct Knob {
  std::string name{};
  std::string value{};
};

/// A rule with a value in place of each knob.
struct ChosenRule {
  const Rule* rule = nullptr;  ///< never null
  toml::table values{};
  std::vector<Knob> knobs{};
};

/// The rule as a seed has it, whether it chooses it or not.
[[nodiscard]] ChosenRule chosen_rule(const Rule& rule, std::uint64_t seed);

/// In the order of the file. The seed of a canary has that rule alone.
[[nodiscard]] std::vector<ChosenRule> choose_rules(const CampaignFile& campaign, std::uint64_t seed);

}  // namespace canopus::campaign
