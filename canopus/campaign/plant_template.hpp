#pragma once
// The plant file of a run: that of the campaign's variant, with what the chosen rules add to it.

#include <cstdint>
#include <expected>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/campaign/chosen_rules.hpp"
#include "canopus/text/output.hpp"

namespace canopus::campaign {

/// Whether it is a plant that a campaign can run, and as the rules of a run change it.
class PlantTemplate {
 public:
  /// Reads and builds the plant of a variant, as it is without rules. False after its mistakes were printed on `err`.
  [[nodiscard]] bool load(const CampaignFile& campaign, const Variant& variant, text::Output& err);

  /// Path of the plant file: paths in it are relative to its folder.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// Names of the devices, as far as they have one.
  [[nodiscard]] std::vector<std::string> device_names() const;
  /// With the rules that are keys of a plant file, and without some devices. The error is a sentence.
  [[nodiscard]] std::expected<toml::table, std::string> with(
      std::span<const ChosenRule> rules, std::span<const std::string> without_devices = {}) const;

 private:
  [[nodiscard]] std::expected<void, std::string> apply(toml::table& plant, const Variant& variant,
                                                       const CampaignFile& campaign) const;
  std::string path_;
  toml::table plant_;
};

/// The table as the text of a file.
[[nodiscard]] std::string text_of(const toml::table& table);

/// Calls `each` with every path of a file in a plant file, which may change it.
void each_path(toml::table& plant, const std::function<void(std::string&)>& each);

}  // namespace canopus::campaign
