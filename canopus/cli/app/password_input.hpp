#pragma once

#include <expected>
#include <string>

namespace canopus::cli {

/// A password from the terminal of the standard input, asked for twice and not shown; without a terminal the first line of the
/// standard input. The error is a sentence.
[[nodiscard]] std::expected<std::string, std::string> read_password(const std::string& user);

}  // namespace canopus::cli
