#pragma once
// A project in memory, and the device files of the examples.

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/network_project/network_project.hpp"

#include "paths.hpp"

namespace canopus::test {

/// "drive", "io-block", "encoder"
inline std::string device_file(const std::string& name) {
  std::ifstream file(CANOPUS_SOURCE_DIR "/examples/devices/" + name + ".eds", std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_FALSE(text.str().empty()) << name;
  return text.str();
}

struct ProjectFolder {
  std::map<std::string, std::string> files{};

  [[nodiscard]] network_project::ReadFile reader() {
    return [this](const std::string& path) -> std::expected<std::optional<std::string>, std::string> {
      const auto file = files.find(path);
      return file == files.end() ? std::nullopt : std::optional(file->second);
    };
  }
  [[nodiscard]] network_project::NetworkProject make(std::string_view name) {
    return network_project::NetworkProject::make("nodelist.cpj", reader(), name).value();
  }
  [[nodiscard]] network_project::NetworkProject open() {
    return network_project::NetworkProject::open("nodelist.cpj", reader()).value();
  }
  /// What the project has changed is in the folder.
  void use(const network_project::NetworkProject& project) {
    for (const auto& [path, text] : project.changes()) {
      if (text) {
        files[path] = *text;
      } else {
        files.erase(path);
      }
    }
  }
  /// A project that is there already: node-IDs and device files, after which the nodes are named.
  [[nodiscard]] network_project::NetworkProject with(const std::vector<std::pair<int, std::string>>& nodes,
                                                     std::uint32_t bit_rate = 500'000) {
    network_project::NetworkProject project = make("network");
    for (const auto& [id, name] : nodes) {
      const auto added = project.add_node({.node_id = static_cast<std::uint8_t>(id),
                                           .name = name,
                                           .eds = device_file(name),
                                           .eds_name = name + ".eds",
                                           .bit_rate = bit_rate});
      EXPECT_TRUE(added) << added.error();
    }
    use(project);
    return open();
  }
};

}  // namespace canopus::test
