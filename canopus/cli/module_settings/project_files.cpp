#include "canopus/cli/module_settings/project_files.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include <fmt/format.h>

#include "canopus/cli/setups/user_state.hpp"
#include "canopus/module_settings/module_project_file.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/store/files.hpp"
#include "canopus/store/inner_path.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::cli {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t longest_file = 4'000'000;
constexpr std::size_t most_recent = 10;

std::expected<std::string, std::string> read_text(const std::string& path) {
  const auto bytes = store::real_files().read(path, longest_file);
  if (!bytes) return std::unexpected(fmt::format("{}: {}", path, store::describe_error(bytes.error())));
  return std::string(bytes->begin(), bytes->end());
}

std::expected<module_settings::ModuleProject, std::string> read_project(const std::string& path,
                                                                        const std::string& text) {
  auto project = module_settings::from_xml(text, plant::configuration_tools());
  if (!project) return std::unexpected(fmt::format("{}:{}", path, project.error()));
  return project;
}

/// The folder of the changes of a file, below its own.
fs::path records_of(const fs::path& path) { return fs::path(".canopus") / "settings" / path.filename(); }

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

fs::path list_path() {
  const fs::path folder = user_state_folder();
  return folder.empty() ? folder : folder / "recent-projects";
}

}  // namespace

std::expected<module_settings::ModuleProject, std::string> load_project(const std::string& path) {
  const auto text = read_text(path);
  return text ? read_project(path, *text) : std::unexpected(text.error());
}

std::expected<module_settings::ModuleProject, std::string> look_at_project(
    const std::string& path, const std::function<void(const std::string&)>& unfinished) {
  store::ChangeSets changes(folder_of(path), store::real_files(), records_of(path));
  const auto is_unfinished = changes.look();
  if (!is_unfinished) return std::unexpected(is_unfinished.error());
  if (!*is_unfinished) return load_project(path);
  const auto text = changes.read(fs::path(path).filename().string());
  if (!text) return std::unexpected(text.error());
  if (!*text) return std::unexpected(fmt::format("{}: {}", path, store::describe_error(ENOENT)));
  unfinished(store::ChangeSets::unfinished_change((folder_of(path) / records_of(path) / "journal").string()));
  return read_project(path, **text);
}

std::string save_project(const std::string& path, const module_settings::ModuleProject& project) {
  return write_whole(path, module_settings::to_xml(project), FileReaders::everybody);
}

std::expected<ChangingProject, std::string> ChangingProject::open(const std::string& path) {
  const fs::path folder = folder_of(path);
  const fs::path records = records_of(path);
  // A file that is not there gets no folder of its changes.
  std::error_code error;
  if (!fs::exists(path, error) && !fs::exists(folder / records, error))
    return std::unexpected(fmt::format("{}: {}", path, store::describe_error(ENOENT)));
  if (auto good = store::check_inner_path(store::real_files(), folder, (records / ".lock").string()); !good) {
    return std::unexpected(std::move(good.error()));
  }
  auto lock = store::FolderLock::take(folder / records);
  if (!lock) return std::unexpected(fmt::format("{}: {}", path, lock.error()));
  store::ChangeSets changes(folder, store::real_files(), records);
  if (auto recovered = changes.recover(); !recovered) return std::unexpected(recovered.error());
  return ChangingProject(path, std::move(changes), std::move(*lock));
}

std::string ChangingProject::save(const module_settings::ModuleProject& project, std::string_view title) {
  const auto written =
      changes_.write({{fs::path(path_).filename().string(), module_settings::to_xml(project)}}, title);
  return written ? std::string() : written.error();
}

std::vector<std::string> recent_projects() {
  const fs::path list = list_path();
  std::vector<std::string> names;
  if (list.empty()) return names;
  const auto text = read_text(list.string());
  if (!text) return names;
  for (std::size_t at = 0; at < text->size() && names.size() < most_recent;) {
    const std::size_t end = std::min(text->find('\n', at), text->size());
    if (end > at) names.push_back(text->substr(at, end - at));
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
  (void)write_whole(list, fmt::format("{}\n", fmt::join(names, "\n")), FileReaders::everybody);
}

}  // namespace canopus::cli
