#include "canopus/cli/run/web_options.hpp"

#include "canopus/cli/module_settings/settings_file.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/web/http/request.hpp"

namespace canopus::cli {

void add_web_access_options(Command& command, const std::string& prefix, web::WebAccess& access,
                            Option* page) {
  auto* users =
      command.add_option(prefix + "users", access.users,
                         "The page is for the users in this file (canopus web-users), at any address of "
                         "this machine");
  users->type_name("FILE");
  auto* audit =
      command.add_option(prefix + "audit", access.audit,
                         "Append a line to this file for each command and log-in on the page; with users "
                         "FILE.audit unless it is given");
  audit->type_name("FILE");
  auto* origin = command.add_option(prefix + "origin", access.origin,
                                    "What browsers see of a TLS proxy in front of the page, for example "
                                    "https://plant.example");
  origin->type_name("ORIGIN")->check([](const std::string& text) {
    const auto read = web::parse_web_origin(text);
    return read ? std::string() : read.error();
  });
  if (page == nullptr) return;
  for (Option* option : {users, audit, origin}) option->needs(page);
}

std::expected<web::WebSettings, std::string> read_web_settings(const std::string& file) {
  constexpr std::uint32_t points_of_module = 0x10;
  const auto project = load_project(file);
  if (!project) return std::unexpected(project.error());
  return web::WebSettings{.file = file,
                          .model = std::string(project->tool().model),
                          .head = points_of_module * project->unit_number()};
}

}  // namespace canopus::cli
