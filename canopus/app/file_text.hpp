#pragma once
// Files that people name on the command line or in a plant file, read whole.

#include <expected>
#include <string>

namespace canopus::app {

/// The bytes of a file, 64 MiB at most (a device that never ends is no file). The error is a sentence:
/// "cannot read plant.toml: No such file or directory".
[[nodiscard]] std::expected<std::string, std::string> read_file(const std::string& path);

}  // namespace canopus::app
