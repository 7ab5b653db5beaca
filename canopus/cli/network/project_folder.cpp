#include "canopus/cli/network/project_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/eds/words.hpp"

namespace canopus::cli {

namespace fs = std::filesystem;

std::expected<ProjectFolder, std::string> ProjectFolder::open(const std::string& path, For purpose) {
  std::error_code error;
  fs::path folder = path;
  std::string list = "nodelist.cpj";
  if (eds::lower(folder.extension().string()) == ".cpj" && !fs::is_directory(folder, error)) {
    list = folder.filename().string();
    folder = folder.parent_path();
  }
  if (folder.empty()) folder = ".";
  ProjectFolder project(folder, std::move(list));
  const fs::path records = folder / ".canopus";
  const bool has_records = fs::is_directory(records, error);
  // Who only looks leaves a folder without a journal, or one that he may not write, as it is.
  const bool is_locked = purpose == For::changing || (has_records && ::access(records.c_str(), W_OK) == 0);
  if (!is_locked) return project;
  auto lock = store::FolderLock::take(records);
  if (!lock) return std::unexpected(fmt::format("{}: {}", folder.string(), lock.error()));
  project.lock_ = std::move(*lock);
  if (auto recovered = project.changes_.recover(); !recovered) return std::unexpected(recovered.error());
  return project;
}

project::ReadFile ProjectFolder::reader() {
  return [changes = changes_](const std::string& name) mutable { return changes.read(name); };
}

std::expected<project::NetworkProject, std::string> ProjectFolder::read(unsigned network) {
  auto project = project::NetworkProject::open(list_, reader(), network - 1);
  if (!project) {
    // ChangeSets says the file itself.
    const bool is_named = project.error().starts_with(shown_list());
    return std::unexpected(is_named ? project.error() : fmt::format("{}: {}", shown_list(), project.error()));
  }
  return project;
}

std::expected<project::NetworkProject, std::string> ProjectFolder::make(std::string_view name) {
  auto project = project::NetworkProject::make(list_, reader(), name);
  if (!project) return std::unexpected(fmt::format("{}: {}", shown_list(), project.error()));
  return project;
}

std::expected<void, std::string> ProjectFolder::save(const project::NetworkProject& project,
                                                     std::string_view title) {
  return changes_.write(project.changes(), title);
}

std::expected<std::optional<std::string>, std::string> ProjectFolder::undo() { return changes_.undo(); }

}  // namespace canopus::cli
