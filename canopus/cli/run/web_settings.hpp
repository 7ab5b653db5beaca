#pragma once

#include <expected>
#include <string>

#include "canopus/web/commands/settings.hpp"

namespace canopus::cli {

/// Reads a file. The error names it, and the line.
[[nodiscard]] std::expected<web::WebSettings, std::string> read_web_settings(const std::string& file);

}  // namespace canopus::cli
