#pragma once
// A project on the disk: found, read and written whole.

#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "canopus/network_project/network_project.hpp"
#include "canopus/store/change_sets.hpp"
#include "canopus/store/folder_lock.hpp"

namespace canopus::cli {

class ProjectFolder {
 public:
  enum class For : std::uint8_t { looking, changing };

  /// `path`: a folder with nodelist.cpj, or a file *.cpj. To change it: the folder is locked, and a change
  /// that a power cut left half done is completed. To read: nothing is written, and unfinished() reports such
  /// a change. Errors are sentences that name the file.
  [[nodiscard]] static std::expected<ProjectFolder, std::string> open(const std::string& path, For purpose);

  /// Opened to read: a sentence about a change that is not finished; the project is the one before it.
  [[nodiscard]] std::optional<std::string> unfinished() const;
  /// `network`: from 1.
  [[nodiscard]] std::expected<network_project::NetworkProject, std::string> read(unsigned network);
  [[nodiscard]] std::expected<network_project::NetworkProject, std::string> make(std::string_view name);
  /// All that the project has changed, or nothing of it.
  [[nodiscard]] std::expected<void, std::string> save(const network_project::NetworkProject& project,
                                                      std::string_view title);
  [[nodiscard]] std::expected<std::optional<std::string>, std::string> undo();

  /// The path of a project's file for messages.
  [[nodiscard]] std::string shown_path(const std::string& path) const { return (folder_ / path).string(); }
  [[nodiscard]] std::string shown_list() const { return shown_path(list_); }
  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }

 private:
  ProjectFolder(std::filesystem::path folder, std::string list)
      : folder_(std::move(folder)), list_(std::move(list)), changes_(folder_) {}
  [[nodiscard]] network_project::ReadFile reader();

  std::filesystem::path folder_;
  std::string list_;
  store::ChangeSets changes_;
  std::optional<store::FolderLock> lock_{};
  bool is_unfinished_ = false;
};

}  // namespace canopus::cli
