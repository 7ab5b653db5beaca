#pragma once
// Options of the page in the browser that `canopus run` and `canopus web` have in common.

#include <expected>
#include <string>

#include "canopus/web/access/access_files.hpp"
#include "canopus/web/commands/settings.hpp"

namespace canopus::cli {

class Command;
class Option;

/// --web-users, --web-audit, --web-origin; `prefix` is "--web-" or "--". Each needs `page`, the option that opens the page, if
/// there is one. `access` outlives the command.
void add_web_access_options(Command& command, const std::string& prefix, web::WebAccess& access,
                            Option* page = nullptr);

/// Reads the settings of a module, a project of `canopus configure`. The error names it, and the line.
[[nodiscard]] std::expected<web::WebSettings, std::string> read_web_settings(const std::string& file);

}  // namespace canopus::cli
