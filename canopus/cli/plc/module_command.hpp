#pragma once
// `canopus module list|info|eds|compare|status`: the soft modules, the data of their manuals, their EDS
// files.

#include <filesystem>
#include <optional>
#include <string>

#include "canopus/cli/output/print.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {

class Command;

/// The modules there are, or, with a plant file, the product list of each of its PLCs.
int module_list(const std::optional<std::string>& plant, bool json, Output& out, Output& err);
/// The data of a module's manual; with `store` also the number of writes to its flash memory.
int module_info(const std::string& model, const std::optional<std::filesystem::path>& store, bool json,
                Output& out, Output& err);
/// Its EDS file, to `out` or, when it is not empty, to the file `path`. `mode`: of this function mode.
int module_eds_file(const std::string& model, const std::string& path, Output& out, Output& err,
                    std::optional<unsigned> mode = {});

/// Adds the subcommand `module` to the program. Exit code: 0 done, 2 no such module or file.
void add_module_command(Command& app, int& exit_code);

// `canopus module compare`: the modules beside each other, from their models.

/// A table in Markdown: a row for each property, a column for each module.
[[nodiscard]] std::string comparison_table();
int module_compare(Output& out);

// `canopus module status`: the modules of a running plant, as the engineering tool's module diagnostics show them.

/// Prints the control server's answer to the request "modules". Nothing of it is trusted.
void print_modules(const text::Json& answer, Output& out);

/// Adds `status` to `canopus module`. Exit code: 0 done, 1 the plant refused or could not be reached, 2 wrong command line.
void add_module_status(Command& module_command, int& exit_code);

}  // namespace canopus::cli
