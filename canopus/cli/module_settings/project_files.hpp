#pragma once
// Projects of modules on the disk: read and written whole.

#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopus/module_settings/module_project.hpp"
#include "canopus/store/change_sets.hpp"
#include "canopus/store/folder_lock.hpp"

namespace canopus::cli {

/// The project, or why it cannot be read, with file and line.
[[nodiscard]] std::expected<module_settings::ModuleProject, std::string> load_project(
    const std::string& path);
/// The same, for a command that only looks. `unfinished`: called with a sentence when a power cut, or another command at work, has
/// left a change half done; the project is then the one before it.
[[nodiscard]] std::expected<module_settings::ModuleProject, std::string> look_at_project(
    const std::string& path, const std::function<void(const std::string&)>& unfinished);
/// A file that nobody changes later, a new project or a backup: takes its place in one step; after a failure the old one is
/// there, whole. Empty: done.
[[nodiscard]] std::string save_project(const std::string& path,
                                       const module_settings::ModuleProject& project);

/// A project that is going to be changed: each save can be taken back, the latest first (store::ChangeSets). What the file
/// was before lies in ".canopus/settings/FILE" beside it. Others cannot change it as long as this lives.
class ChangingProject {
 public:
  /// Ends what a power cut left half done. Errors are sentences that name the file.
  [[nodiscard]] static std::expected<ChangingProject, std::string> open(const std::string& path);
  [[nodiscard]] std::expected<module_settings::ModuleProject, std::string> read() const {
    return load_project(path_);
  }
  /// `title`: what was done, for people. Empty: done.
  [[nodiscard]] std::string save(const module_settings::ModuleProject& project, std::string_view title);
  /// The title of what was taken back; nothing: there is nothing to take back.
  [[nodiscard]] std::expected<std::optional<std::string>, std::string> undo() { return changes_.undo(); }

 private:
  ChangingProject(std::string path, store::ChangeSets changes, store::FolderLock lock)
      : path_(std::move(path)), changes_(std::move(changes)), lock_(std::move(lock)) {}

  std::string path_;
  store::ChangeSets changes_;
  store::FolderLock lock_;
};

}  // namespace canopus::cli
