#pragma once
// A plant file and its device files in a folder of the test's own, and what `canopus check` says of it.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/files/check_command.hpp"
#include "canopus/plant/plant_loading.hpp"

namespace canopus::support {

/// A device file with the mandatory objects and these sections besides.
inline std::string device_file(std::string_view sections) {
  return "[DeviceInfo]\nVendorNumber=1\nProductNumber=2\nRevisionNumber=3\nBaudRate_250=1\n"
         "[1000]\nParameterName=Device type\nDataType=7\nAccessType=ro\nDefaultValue=0x191\n"
         "[1001]\nParameterName=Error register\nDataType=5\nAccessType=ro\n"
         "[1018]\nParameterName=Identity\nObjectType=9\n"
         "[1018sub0]\nDataType=5\nAccessType=ro\nDefaultValue=4\n"
         "[1018sub1]\nDataType=7\nAccessType=ro\nDefaultValue=1\n"
         "[1018sub2]\nDataType=7\nAccessType=ro\nDefaultValue=2\n"
         "[1018sub3]\nDataType=7\nAccessType=ro\nDefaultValue=3\n"
         "[1018sub4]\nDataType=7\nAccessType=ro\nDefaultValue=4\n" +
         std::string(sections);
}

/// A parameter, for device_file(). `type`: 5 UNSIGNED8, 6 UNSIGNED16, 7 UNSIGNED32.
inline std::string variable(std::string_view index, int type, std::string_view value = "0") {
  return "[" + std::string(index) + "]\nParameterName=X\nDataType=" + std::to_string(type) +
         "\nAccessType=rw\nDefaultValue=" + std::string(value) + "\n";
}

/// 1010H, or another object with one sub-index of UNSIGNED32.
inline std::string array_of_one(const std::string& index, std::string_view value = "0") {
  return "[" + index + "]\nParameterName=X\nObjectType=8\n[" + index +
         "sub0]\nDataType=5\nAccessType=ro\nDefaultValue=1\n[" + index +
         "sub1]\nDataType=7\nAccessType=rw\nDefaultValue=" + std::string(value) + "\n";
}

class PlantFolder : public testing::Test {
 protected:
  PlantFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "canopus-plant-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~PlantFolder() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, std::string_view text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  /// What `canopus check` prints of a plant file with this text: mistakes and warnings, a line each, without the
  /// folder.
  std::vector<std::string> check(std::string_view text, bool strict = false) {
    write("plant.toml", text);
    text::TextOutput out;
    text::TextOutput err;
    exit_code_ = cli::check_plant({.plant = path(), .strict = strict}, out, err);
    summary_ = shortened(out.text());
    std::istringstream lines(shortened(err.text()));
    std::vector<std::string> all;
    for (std::string line; std::getline(lines, line);) all.push_back(line);
    return all;
  }
  /// The plant of this text, switched off.
  std::unique_ptr<plant::Plant> load(std::string_view text, plant::PlantObserver& observer,
                                     plant::BusOpener* opener = nullptr) {
    write("plant.toml", text);
    text::TextOutput err;
    auto plant = plant::load_plant(path(), observer, err, {.opener = opener});
    EXPECT_NE(plant, nullptr) << err.text();
    return plant;
  }
  /// Why there is no plant of this text.
  std::string refusal(std::string_view text, plant::PlantObserver& observer, plant::BusOpener* opener) {
    write("plant.toml", text);
    text::TextOutput err;
    EXPECT_EQ(plant::load_plant(path(), observer, err, {.opener = opener}), nullptr);
    return shortened(err.text());
  }
  [[nodiscard]] std::string path() const { return (folder_ / "plant.toml").string(); }
  [[nodiscard]] std::string shortened(std::string text) const {
    const std::string prefix = folder_.string() + "/";
    for (std::size_t at = 0; (at = text.find(prefix, at)) != std::string::npos;)
      text.erase(at, prefix.size());
    return text;
  }

  std::filesystem::path folder_;
  int exit_code_ = -1;
  std::string summary_;
};

}  // namespace canopus::support
