#pragma once
// Files that another file names: a journal, the list of a project. Such a file may come from an untrusted
// source, so it may only name files of its own folder.

#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "canopus/store/files.hpp"

namespace canopus::store {

/// Whether `name` is a path below a folder by its spelling alone: relative, with '/', without "..", without control
/// characters. The error names it: "\"../x\" is not a path inside the folder".
[[nodiscard]] std::expected<void, std::string> check_inner_name(std::string_view name);

/// The same, and neither the file nor a folder between `folder` and it is a symbolic link. `folder` itself may be one: a
/// person has named it. The error is a sentence that names the file.
[[nodiscard]] std::expected<void, std::string> check_inner_path(Files& files,
                                                                const std::filesystem::path& folder,
                                                                std::string_view name);

/// The bytes of such a file, 64 MiB at most. The error is a sentence that names the file.
[[nodiscard]] std::expected<std::string, std::string> read_inner_file(const std::filesystem::path& folder,
                                                                      std::string_view name);

/// Of a file below `folder` that differs from `name` in upper and lower case (of ASCII) alone, the path as it is, with
/// '/'. Nothing: there is none or more than one, or `name` leads out. Of a folder 10,000 entries are looked at.
[[nodiscard]] std::optional<std::string> find_inner_file(const std::filesystem::path& folder,
                                                         std::string_view name);

}  // namespace canopus::store
