#pragma once
// The way from a command to the module of a project: connects to the PLC, waits for the module's start.

#include <expected>
#include <functional>
#include <string>

#include "canopus/cli/module_settings/configure_command.hpp"
#include "canopus/client/plc_module.hpp"
#include "canopus/module_settings/module_project.hpp"

namespace canopus::cli {

/// The project of the command line, for a command that does not change it; warns of a change that is not finished.
[[nodiscard]] std::expected<module_settings::ModuleProject, std::string> read_project(
    const ConfigureArguments& arguments);

/// Runs an action on the module of the command line, else the project's, else the first one. `project`:
/// nullptr: there is none; then --module, or the PLC's type, determines the model. Returns the exit code.
int with_module(const ConfigureArguments& arguments, const module_settings::ModuleProject* project,
                const std::function<int(client::PlcClient&, client::PlcModule&)>& action);

/// The module that --project or --number and --module select.
int with_selected_module(const ConfigureArguments& arguments,
                         const std::function<int(client::PlcClient&, client::PlcModule&)>& action);

/// The same, with the project of the command line, and the PDOs that --pdos names.
int with_project(const ConfigureArguments& arguments,
                 const std::function<int(module_settings::ModuleProject&, client::PlcClient&,
                                         client::PlcModule&, module_settings::PdoRange)>& action);

}  // namespace canopus::cli
