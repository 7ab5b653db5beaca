#include "canopus/cli/run/web_settings.hpp"

#include "canopus/cli/module_settings/settings_file.hpp"

namespace canopus::cli {

std::expected<web::WebSettings, std::string> read_web_settings(const std::string& file) {
  constexpr std::uint32_t points_of_module = 0x10;
  const auto project = load_project(file);
  if (!project) return std::unexpected(project.error());
  return web::WebSettings{.file = file,
                          .model = std::string(project->tool().model),
                          .head = points_of_module * project->unit_number()};
}

}  // namespace canopus::cli
