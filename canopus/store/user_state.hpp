#pragma once
// Files that the program keeps for its user: recent projects, transfer setups.

#include <filesystem>
#include <string>

namespace canopus::store {

/// $XDG_STATE_HOME/canopus, else ~/.local/state/canopus; empty: the environment names neither.
[[nodiscard]] std::filesystem::path user_state_folder();

/// Read permission of a written file.
enum class FileReaders { everybody, owner };

/// Beside it first, then in its place: after a failure the old file is there, whole. Empty: done; else a sentence that names the
/// file.
[[nodiscard]] std::string write_whole(const std::filesystem::path& path, const std::string& text,
                                      FileReaders readers);

}  // namespace canopus::store
