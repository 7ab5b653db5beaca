// The rule that lets modules be added: nothing outside of a module's folder knows it but the catalogue, neither its headers nor its
// model name.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/plant/catalogue/module_catalogue.hpp"

#include "paths.hpp"

namespace canopus::plant::module_independence_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
namespace fs = std::filesystem;

const fs::path sources = fs::path(CANOPUS_SOURCE_DIR) / "canopus";
const std::string catalogue = "plant/catalogue/module_catalogue.cpp";

struct Source {
  std::string path;  // relative to canopus/
  std::string text;
};

std::vector<Source> all_sources() {
  std::vector<Source> all;
  for (const auto& entry : fs::recursive_directory_iterator(sources)) {
    const std::string extension = entry.path().extension();
    if (extension != ".hpp" && extension != ".cpp") continue;
    std::ifstream file(entry.path());
    all.push_back(
        {fs::relative(entry.path(), sources).generic_string(), {std::istreambuf_iterator<char>(file), {}}});
  }
  return all;
}

std::vector<std::string> module_folders() {
  std::vector<std::string> folders;
  for (const auto& entry : fs::directory_iterator(sources / "module" / "models"))
    folders.push_back("module/models/" + entry.path().filename().string() + "/");
  return folders;
}

std::vector<std::string> included_by(const std::string& text) {
  static const std::regex include(R"re(#include "canopus/([^"]+)")re");
  std::vector<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), include), end; match != end; ++match)
    found.push_back((*match)[1]);
  return found;
}

/// String literals that are a model name and nothing else; what a text for people has of models is no knowledge of one.
std::vector<std::string> models_named_in(const std::string& text) {
  std::vector<std::string> found;
  for (const CatalogueEntry& entry : module_catalogue()) {
    const std::string literal = '"' + std::string(entry.data_sheet->model) + '"';
    for (std::size_t at = text.find(literal); at != std::string::npos; at = text.find(literal, at + 1)) {
      const std::size_t line = text.rfind('\n', at) + 1;
      if (text.substr(line, at - line).find("//") == std::string::npos)
        found.emplace_back(entry.data_sheet->model);
    }
  }
  return found;
}

TEST(ModuleIndependence, ModelsAreFoundInLiteralsAndNotInComments) {
  EXPECT_THAT(models_named_in("  if (name == \"RJ71CN91\") return 1;  // \"FX3U-CAN\"\n"),
              ElementsAre("RJ71CN91"));
  EXPECT_THAT(models_named_in("help(\"417 of an FX3U-CAN\"); /// \"FX3U-CAN\"\n"), IsEmpty());
  EXPECT_THAT(included_by("#include \"canopus/module/abc1_q/abc1_q.hpp\"\n"),
              ElementsAre("module/abc1_q/abc1_q.hpp"));
}

TEST(ModuleIndependence, EachModuleOfTheCatalogue_HasAFolder) {
  EXPECT_THAT(module_folders(), SizeIs(module_catalogue().size()));
}

TEST(ModuleIndependence, OutsideOfItsFolder_OnlyTheCatalogueKnowsAModule) {
  std::vector<std::string> strangers;
  const std::vector<std::string> folders = module_folders();
  for (const Source& source : all_sources()) {
    if (source.path == catalogue) continue;
    bool is_a_modules = false;
    for (const std::string& folder : folders) {
      is_a_modules = is_a_modules || source.path.starts_with(folder);
      if (source.path.starts_with(folder)) continue;
      for (const std::string& included : included_by(source.text))
        if (included.starts_with(folder)) strangers.push_back(source.path + " includes " + included);
    }
    if (is_a_modules) continue;
    for (const std::string& model : models_named_in(source.text))
      strangers.push_back(source.path + " names " + model);
  }
  EXPECT_THAT(strangers, IsEmpty());
}

}  // namespace
}  // namespace canopus::plant::module_independence_test
