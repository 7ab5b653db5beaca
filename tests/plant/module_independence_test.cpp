// The rule that lets modules be added: nothing outside of a module's folder knows of it but the catalogue.

#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "paths.hpp"

namespace canopus::plant::module_independence_test {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;
namespace fs = std::filesystem;

const fs::path sources = fs::path(CANOPUS_SOURCE_DIR) / "canopus";
const fs::path catalogue = sources / "plant" / "catalogue" / "module_catalogue.cpp";

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The folders of canopus/module that hold a module (its model), named as its namespace.
std::vector<fs::path> module_folders() {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(sources / "module")) {
    if (fs::exists(entry.path() / "model.hpp")) folders.push_back(entry.path());
  }
  return folders;
}

bool is_below(const fs::path& path, const fs::path& folder) {
  return path.string().starts_with(folder.string() + "/");
}

/// It includes a header of the module's folder, or names the module's namespace.
bool knows(const std::string& text, const std::string& module) {
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t at = text.find(module); at != std::string::npos; at = text.find(module, at + 1)) {
    if (at > 0 && is_word(text[at - 1])) continue;
    const std::size_t next = text.find_first_not_of(' ', at + module.size());
    if (next != std::string::npos && std::string_view("/:;{").contains(text[next])) return true;
  }
  return false;
}

TEST(ModuleIndependence, Knows_SeesIncludesAndNamespaces) {
  EXPECT_TRUE(knows("#include \"canopus/module/abc1_q/abc1_q.hpp\"\n", "abc1_q"));
  EXPECT_TRUE(knows("module::abc1_q::Profile profile;", "abc1_q"));
  EXPECT_TRUE(knows("using namespace module::abc1_q;", "abc1_q"));
  EXPECT_TRUE(knows("namespace canopus::module::abc1_q {", "abc1_q"));
  EXPECT_FALSE(knows("// as the ABC1-Q does, see also xabc1_q::a and abc1_qx::b", "abc1_q"));
}

TEST(ModuleIndependence, OutsideOfItsFolder_OnlyTheCatalogueKnowsAModule) {
  const std::vector<fs::path> modules = module_folders();
  ASSERT_THAT(modules, Not(IsEmpty()));
  std::vector<std::string> strangers;
  for (const fs::path& folder : modules) {
    const std::string module = folder.filename().string();
    EXPECT_TRUE(knows(text_of(catalogue), module)) << module << " is not in the catalogue";
    for (const auto& entry : fs::recursive_directory_iterator(sources)) {
      const fs::path& path = entry.path();
      if (!entry.is_regular_file() || path == catalogue || is_below(path, folder)) continue;
      if (knows(text_of(path), module)) strangers.push_back(path.string() + " knows " + module);
    }
  }
  EXPECT_THAT(strangers, IsEmpty());
}

}  // namespace
}  // namespace canopus::plant::module_independence_test
