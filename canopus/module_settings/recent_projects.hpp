#pragma once

#include <string>
#include <vector>

namespace canopus::module_settings {

/// Projects that were made, opened or saved last, the newest first, at most ten [FX3U-CAN 15.1.1]. The list
/// is in $XDG_STATE_HOME/canopus, else in ~/.local/state/canopus.
[[nodiscard]] std::vector<std::string> recent_projects();
/// Puts a project on top of the list. A list that cannot be written is no error.
void remember_project(const std::string& path);

}  // namespace canopus::module_settings
