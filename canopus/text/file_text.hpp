#pragma once
// Files that people name on the command line or in another file, read whole.

#include <expected>
#include <string>

namespace canopus::text {

/// The bytes of a file, 64 MiB at most. What is no file (a folder, a FIFO, a device) is refused and never
/// waited for. The error is a sentence: "cannot read plant.toml: No such file or directory".
[[nodiscard]] std::expected<std::string, std::string> read_file(const std::string& path);

/// The same, but the error is the reason alone: "No such file or directory".
[[nodiscard]] std::expected<std::string, std::string> read_file_or_reason(const std::string& path);

/// The same as read_file(), but a FIFO or device is read until it ends, too: data that another program gives.
[[nodiscard]] std::expected<std::string, std::string> read_file_or_pipe(const std::string& path);

/// The whole standard input. The error is the reason alone.
[[nodiscard]] std::expected<std::string, std::string> read_standard_input();

}  // namespace canopus::text
