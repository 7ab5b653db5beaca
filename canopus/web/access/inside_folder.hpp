#pragma once

#include <filesystem>
#include <string>

namespace canopus::web {

/// A regular file that is in the folder, wherever links lead.
[[nodiscard]] bool is_inside(const std::filesystem::path& file, const std::filesystem::path& folder);

/// As people know it: "~/machines" for one in the user's home folder ($HOME).
[[nodiscard]] std::string shown_folder(const std::filesystem::path& folder);

}  // namespace canopus::web
