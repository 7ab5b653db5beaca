#pragma once
// Projects of modules on the disk: read and written whole, and the list of the last ten.

#include <expected>
#include <string>
#include <vector>

#include "canopus/project/module_project.hpp"

namespace canopus::cli {

/// The project, or why it cannot be read, with file and line.
[[nodiscard]] std::expected<project::ModuleProject, std::string> load_project(const std::string& path);
/// Takes the place of the file in one step: after a failure the old one is there, whole. Empty: done.
[[nodiscard]] std::string save_project(const std::string& path, const project::ModuleProject& project);

/// Projects that were made, opened or saved last, the newest first, at most ten [FX3U-CAN 15.1.1]. The list lies in
/// $XDG_STATE_HOME/canopus, else in ~/.local/state/canopus.
[[nodiscard]] std::vector<std::string> recent_projects();
/// Puts a project on top of the list. A list that cannot be written is no error.
void remember_project(const std::string& path);

}  // namespace canopus::cli
