#include "canopus/module_settings/recent_projects.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/store/files.hpp"
#include "canopus/store/user_state.hpp"

namespace canopus::module_settings {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t longest_list = 4'000'000;
constexpr std::size_t most_recent = 10;

fs::path list_path() {
  const fs::path folder = store::user_state_folder();
  return folder.empty() ? folder : folder / "recent-projects";
}

}  // namespace

std::vector<std::string> recent_projects() {
  const fs::path list = list_path();
  std::vector<std::string> names;
  if (list.empty()) return names;
  const auto bytes = store::real_files().read(list.string(), longest_list);
  if (!bytes) return names;
  const std::string text(bytes->begin(), bytes->end());
  for (std::size_t at = 0; at < text.size() && names.size() < most_recent;) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (end > at) names.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return names;
}

void remember_project(const std::string& path) {
  const fs::path list = list_path();
  std::error_code error;
  const std::string name = fs::absolute(path, error).lexically_normal().string();
  if (list.empty() || error || name.find('\n') != std::string::npos) return;
  std::vector<std::string> names = recent_projects();
  std::erase(names, name);
  names.insert(names.begin(), name);
  if (names.size() > most_recent) names.resize(most_recent);
  fs::create_directories(list.parent_path(), error);
  (void)store::write_whole(list, fmt::format("{}\n", fmt::join(names, "\n")), store::FileReaders::everybody);
}

}  // namespace canopus::module_settings
