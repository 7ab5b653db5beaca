#pragma once
// `canopus web-users`: the file of the page's users.

#include <expected>
#include <string>
#include <string_view>

#include "canopus/web/access/users.hpp"

namespace canopus::cli {

class Command;

/// Adds `web-users` with its commands; sets exit_code when one runs.
void add_users_command(Command& app, int& exit_code);

/// The text of a users' file with this account in place of the one of its name, or behind the others; every other byte stays.
/// The errors begin with `file`.
[[nodiscard]] std::expected<std::string, std::string> with_user(const std::string& text,
                                                                const std::string& file,
                                                                const web::WebAccount& account,
                                                                bool replaces);
/// Without the user of this name.
[[nodiscard]] std::expected<std::string, std::string> without_user(const std::string& text,
                                                                   const std::string& file,
                                                                   std::string_view name);

}  // namespace canopus::cli
