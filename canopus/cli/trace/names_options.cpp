#include "canopus/cli/trace/names_options.hpp"

#include "canopus/cli/options/command.hpp"
#include "canopus/trace/print/node_names.hpp"

namespace canopus::cli {

void add_names_options(Command& command, NamesOptions& options) {
  add_node_names_options(command, options.of, "names of nodes and objects, mapped PDOs");
  command
      .add_option("--eds", options.device_files,
                  "Device file (EDS or DCF) of a node, as 3=encoder.eds; may be given again")
      ->type_name("NODE=FILE")
      ->allow_extra_args(false);
  command.add_old_spelling({.old = "--node", .now = "--eds", .value = [](std::string_view value) {
                              return value.contains('=') ? std::optional(std::string(value)) : std::nullopt;
                            }});
}

std::vector<std::string> files_of(const NamesOptions& options) {
  std::vector<std::string> files;
  for (const std::string& name : {options.of.plant, options.of.network, options.of.project}) {
    if (!name.empty()) files.push_back(name);
  }
  for (const std::string& node : options.device_files) {
    if (const std::size_t equals = node.find('='); equals != std::string::npos)
      files.push_back(node.substr(equals + 1));
  }
  return files;
}

std::optional<trace::Names> load_names(const NamesOptions& options, Output& err) {
  auto names = load_node_names(options.of);
  if (!names) {
    if (!names.error().empty()) err.line("canopus: {}", names.error());
    return std::nullopt;
  }
  for (const std::string& node : options.device_files) {
    if (!trace::add_node_names(node, *names, err)) return std::nullopt;
  }
  return std::move(*names);
}

}  // namespace canopus::cli
