#include "canopus/cli/module_settings/settings_file.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include <fmt/format.h>

#include "canopus/module_settings/module_project.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/store/files.hpp"
#include "canopus/store/inner_path.hpp"
#include "canopus/store/user_state.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::cli {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t longest_file = 4'000'000;

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

}  // namespace

std::expected<module_settings::ModuleProject, std::string> load_project(const std::string& path) {
  const auto text = read_text(path);
  return text ? read_project(path, *text) : std::unexpected(text.error());
}

std::expected<module_settings::ModuleProject, std::string> read_project(
    const std::string& path, const std::function<void(const std::string&)>& unfinished) {
  store::ChangeSets changes(folder_of(path), store::real_files(), records_of(path));
  const auto is_unfinished = changes.open_read_only();
  if (!is_unfinished) return std::unexpected(is_unfinished.error());
  if (!*is_unfinished) return load_project(path);
  const auto text = changes.read(fs::path(path).filename().string());
  if (!text) return std::unexpected(text.error());
  if (!*text) return std::unexpected(fmt::format("{}: {}", path, store::describe_error(ENOENT)));
  unfinished(store::ChangeSets::unfinished_change((folder_of(path) / records_of(path) / "journal").string()));
  return read_project(path, **text);
}

std::string save_project(const std::string& path, const module_settings::ModuleProject& project) {
  return store::write_whole(path, module_settings::to_xml(project), store::FileReaders::everybody);
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
  auto lock = store::FolderLock::acquire(folder / records);
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

}  // namespace canopus::cli
