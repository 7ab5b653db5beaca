#include "canopus/cli/network_project/project_folder.hpp"

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/store/inner_path.hpp"

namespace canopus::cli {

namespace fs = std::filesystem;

std::expected<ProjectFolder, std::string> ProjectFolder::open(const std::string& path, For purpose) {
  std::error_code error;
  fs::path folder = path;
  std::string list = "nodelist.cpj";
  if (ascii::lower(folder.extension().string()) == ".cpj" && !fs::is_directory(folder, error)) {
    list = folder.filename().string();
    folder = folder.parent_path();
  }
  if (folder.empty()) folder = ".";
  ProjectFolder project(folder, std::move(list));
  if (purpose == For::looking) {
    const auto is_unfinished = project.changes_.open_read_only();
    if (!is_unfinished) return std::unexpected(is_unfinished.error());
    project.is_unfinished_ = *is_unfinished;
    return project;
  }
  constexpr std::string_view records = ".canopus";
  if (auto good = store::check_inner_path(store::real_files(), folder, records); !good) {
    return std::unexpected(std::move(good.error()));
  }
  auto lock = store::FolderLock::acquire(folder / records);
  if (!lock) return std::unexpected(fmt::format("{}: {}", folder.string(), lock.error()));
  project.lock_ = std::move(*lock);
  if (auto recovered = project.changes_.recover(); !recovered) return std::unexpected(recovered.error());
  return project;
}

std::optional<std::string> ProjectFolder::unfinished() const {
  if (!is_unfinished_) return std::nullopt;
  return store::ChangeSets::unfinished_change(shown_path(".canopus/journal"));
}

network_project::ReadFile ProjectFolder::reader() {
  return [changes = changes_](const std::string& name) mutable { return changes.read(name); };
}

std::expected<network_project::NetworkProject, std::string> ProjectFolder::read(unsigned network) {
  const auto find = [folder = folder_](const std::string& below, const std::string& name) {
    return store::find_inner_file(folder / below, name);
  };
  auto project = network_project::NetworkProject::open(list_, reader(), network - 1, find);
  if (!project) {
    // The errors of ChangeSets already name the file.
    const bool is_named = project.error().starts_with(shown_list());
    return std::unexpected(is_named ? project.error() : fmt::format("{}: {}", shown_list(), project.error()));
  }
  return project;
}

std::expected<network_project::NetworkProject, std::string> ProjectFolder::make(std::string_view name) {
  auto project = network_project::NetworkProject::make(list_, reader(), name);
  if (!project) return std::unexpected(fmt::format("{}: {}", shown_list(), project.error()));
  return project;
}

std::expected<void, std::string> ProjectFolder::save(const network_project::NetworkProject& project,
                                                     std::string_view title) {
  return changes_.write(project.changes(), title);
}

std::expected<std::optional<std::string>, std::string> ProjectFolder::undo() { return changes_.undo(); }

}  // namespace canopus::cli
