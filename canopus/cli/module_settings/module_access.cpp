#include "canopus/cli/module_settings/module_access.hpp"

#include "canopus/cli/module_settings/settings_file.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/module_settings/recent_projects.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"

namespace canopus::cli {
namespace {

/// The tool of the project's module, else of the one that the command line names, else of the one that fits
/// into the PLC's rack.
const module::ConfigurationTool& tool_of(const ConfigureArguments& arguments,
                                         const module_settings::ModuleProject* project,
                                         client::PlcClient& client) {
  if (project != nullptr) return project->tool();
  const auto tools = plant::configuration_tools();
  const auto* const named =
      module_settings::find_tool(tools, arguments.model.empty() ? arguments.plc.module : arguments.model);
  if (named != nullptr) return *named;
  const auto type = client.read_type();  // an FX3 has no answer to this
  const plc::CpuFamily family =
      type && type->name.starts_with('R') ? plc::CpuFamily::iqr : plc::CpuFamily::fx3;
  return **std::ranges::find_if(tools, [&](const auto* tool) {
    const auto families = plant::find_module(tool->model)->families;
    return std::ranges::find(families, family) != families.end();
  });
}

}  // namespace

int with_module(const ConfigureArguments& arguments, const module_settings::ModuleProject* project,
                const std::function<int(client::PlcClient&, client::PlcModule&)>& action) {
  const std::uint32_t number = arguments.module_number >= 0
                                   ? static_cast<std::uint32_t>(arguments.module_number)
                               : project != nullptr ? project->unit_number()
                                                    : 0;
  return with_client(arguments.plc, [&](client::PlcClient& client) {
    client::PlcModule module(client, static_cast<std::uint16_t>(number),
                             tool_of(arguments, project, client).request_method);
    if (const auto ready = module.wait_until_ready(); !ready)
      return configure_failed(configure_code::failed, ready.error());
    return action(client, module);
  });
}

std::expected<module_settings::ModuleProject, std::string> read_project(const ConfigureArguments& arguments) {
  return read_project(arguments.file,
                      [](const std::string& sentence) { print_error("canopus configure: {}", sentence); });
}

int with_selected_module(const ConfigureArguments& arguments,
                         const std::function<int(client::PlcClient&, client::PlcModule&)>& action) {
  if (arguments.file.empty()) return with_module(arguments, nullptr, action);
  const auto project = read_project(arguments);
  return project ? with_module(arguments, &*project, action)
                 : configure_failed(configure_code::usage, project.error());
}

int with_project(const ConfigureArguments& arguments,
                 const std::function<int(module_settings::ModuleProject&, client::PlcClient&,
                                         client::PlcModule&, module_settings::PdoRange)>& action) {
  auto project = read_project(arguments);
  if (!project) return configure_failed(configure_code::usage, project.error());
  const auto area = parse_area(arguments.pdos, project->window("tpdo")->most_key);
  if (!area) return configure_failed(configure_code::usage, "--pdos: " + area.error());
  module_settings::remember_project(arguments.file);
  return with_module(arguments, &*project, [&](client::PlcClient& client, client::PlcModule& module) {
    return action(*project, client, module, *area);
  });
}

}  // namespace canopus::cli
