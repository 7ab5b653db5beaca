#pragma once
// A device file that a command takes for the names of objects alone.

#include <expected>
#include <memory>
#include <string>

#include "canopus/eds/device_file.hpp"

namespace canopus::cli {

/// An EDS, DCF, XDD or XDC file. The error is a sentence with the file's name.
[[nodiscard]] std::expected<std::shared_ptr<const eds::DeviceFile>, std::string> device_file_of_names(
    const std::string& file);

}  // namespace canopus::cli
