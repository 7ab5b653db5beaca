#pragma once
// A module's project as an XML file: the backup that [Export] writes and [Import] reads [FX3U-CAN 15.3.3].

#include <expected>
#include <string>
#include <string_view>

#include "canopus/module_settings/module_project.hpp"

namespace canopus::module_settings {

/// The version of the format that is written here; files of a newer one are refused.
inline constexpr unsigned project_format = 1;

/// The whole file.
[[nodiscard]] std::string to_xml(const ModuleProject& project);

/// A project of a module that one of the tools is for, or what is wrong, as "LINE: text". Fields that the file does not have keep
/// their defaults.
[[nodiscard]] std::expected<ModuleProject, std::string> from_xml(std::string_view text, Tools tools);

}  // namespace canopus::module_settings
