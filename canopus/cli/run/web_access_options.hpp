#pragma once

#include <string>

#include "canopus/web/access/access_files.hpp"

namespace canopus::cli {

class Command;
class Option;

/// --web-users, --web-audit, --web-origin; `prefix` is "--web-" or "--". Each needs `page`, the option that opens the page, if
/// there is one. `access` outlives the command.
void add_web_access_options(Command& command, const std::string& prefix, web::WebAccess& access,
                            Option* page = nullptr);

}  // namespace canopus::cli
