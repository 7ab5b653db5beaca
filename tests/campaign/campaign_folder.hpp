#pragma once
// A campaign in a folder of its own: the plant of the first steps, and rules and invariants that a test writes.

#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <unistd.h>

#include "canopus/campaign/campaign.hpp"

#include "paths.hpp"

namespace canopus::campaign::test {

inline const std::string examples = CANOPUS_SOURCE_DIR "/examples/";

class CampaignFolder : public testing::Test {
 protected:
  CampaignFolder() {
    static int number = 0;
    folder_ = std::filesystem::temp_directory_path() /
              ("canopus-campaign-" + std::to_string(::getpid()) + "-" + std::to_string(++number));
    std::filesystem::create_directories(folder_);
  }
  ~CampaignFolder() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string in(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(in(name)) << text; }
  [[nodiscard]] static std::string read(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
  /// [campaign] with the plant of the first steps, then `rest`.
  [[nodiscard]] std::string text(const std::string& head, const std::string& rest) const {
    return "[campaign]\nplant = \"" + examples + "first-plant/plant.toml\"\n" + head + "\n" + rest;
  }
  [[nodiscard]] std::optional<Campaign> load(const std::string& text) {
    write("campaign.toml", text);
    return load_campaign(in("campaign.toml"), err_);
  }

  std::filesystem::path folder_;
  text::TextOutput err_;
};

}  // namespace canopus::campaign::test
