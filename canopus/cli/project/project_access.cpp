#include "canopus/cli/project/project_access.hpp"

#include "canopus/cli/project/project_files.hpp"

namespace canopus::cli {
namespace {

/// The project's module, else the one that was told, else the one that goes with the PLC.
const project::ModuleModel& model_of(const ConfigureArguments& arguments,
                                     const project::ModuleProject* project, client::PlcClient& client) {
  if (project != nullptr) return project->model();
  const project::ModuleModel* const told =
      project::find_module_model(arguments.model.empty() ? arguments.plc.module : arguments.model);
  if (told != nullptr) return *told;
  const auto type = client.read_type();  // an FX3 has no answer to this
  return type && type->name.starts_with('R') ? project::rj71cn91_settings() : project::fx3u_can_settings();
}

}  // namespace

int with_module(const ConfigureArguments& arguments, const project::ModuleProject* project,
                const std::function<int(client::PlcClient&, client::PlcModule&)>& action) {
  const std::uint32_t number = arguments.module_number >= 0
                                   ? static_cast<std::uint32_t>(arguments.module_number)
                               : project != nullptr ? project->unit_number()
                                                    : 0;
  return with_client(arguments.plc, [&](client::PlcClient& client) {
    client::PlcModule module(client, static_cast<std::uint16_t>(number),
                             model_of(arguments, project, client).request_way);
    if (const auto ready = module.wait_until_ready(); !ready)
      return configure_failed(configure_code::failed, ready.error());
    return action(client, module);
  });
}

int with_told_module(const ConfigureArguments& arguments,
                     const std::function<int(client::PlcClient&, client::PlcModule&)>& action) {
  if (arguments.file.empty()) return with_module(arguments, nullptr, action);
  const auto project = load_project(arguments.file);
  return project ? with_module(arguments, &*project, action)
                 : configure_failed(configure_code::usage, project.error());
}

int with_project(const ConfigureArguments& arguments,
                 const std::function<int(project::ModuleProject&, client::PlcClient&, client::PlcModule&,
                                         project::PdoRange)>& action) {
  auto project = load_project(arguments.file);
  if (!project) return configure_failed(configure_code::usage, project.error());
  const auto area = parse_area(arguments.pdos, project->window("tpdo")->most_key);
  if (!area) return configure_failed(configure_code::usage, "--pdos: " + area.error());
  remember_project(arguments.file);
  return with_module(arguments, &*project, [&](client::PlcClient& client, client::PlcModule& module) {
    return action(*project, client, module, *area);
  });
}

}  // namespace canopus::cli
