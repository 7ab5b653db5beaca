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
/// The same, for a command that only reads. `unfinished`: called with a sentence when a power cut, or another
/// command at work, has left a change half done; the project is then the one before it.
[[nodiscard]] std::expected<module_settings::ModuleProject, std::string> read_project(
    const std::string& path, const std::function<void(const std::string&)>& unfinished);
/// Writes a new project or a backup, which has no change history: replaces the file atomically; after a
/// failure the old one is intact. Empty: done.
[[nodiscard]] std::string save_project(const std::string& path,
                                       const module_settings::ModuleProject& project);

/// A project opened for changes: each save can be undone, the latest first (store::ChangeSets). The previous
/// contents are in ".canopus/settings/FILE" beside it. The file is locked for the lifetime of this object.
class ChangingProject {
 public:
  /// Ends what a power cut left half done. Errors are sentences that name the file.
  [[nodiscard]] static std::expected<ChangingProject, std::string> open(const std::string& path);
  [[nodiscard]] std::expected<module_settings::ModuleProject, std::string> read() const {
    return load_project(path_);
  }
  /// `title`: the change, for the undo list. Empty: done.
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
