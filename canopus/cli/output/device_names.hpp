#pragma once
// Device files that commands take: which files of a folder are some, and one for the names of objects alone.

#include <expected>
#include <filesystem>
#include <memory>
#include <string>

#include "canopus/eds/device_file.hpp"

namespace canopus::cli {

/// By its extension: .eds, .dcf, .xdd or .xdc, in upper or lower case.
[[nodiscard]] bool is_device_file(const std::filesystem::path& path);

/// An EDS, DCF, XDD or XDC file. The error is a sentence with the file's name.
[[nodiscard]] std::expected<std::shared_ptr<const eds::DeviceFile>, std::string> device_file_of_names(
    const std::string& file);

}  // namespace canopus::cli
