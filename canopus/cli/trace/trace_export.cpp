#include <algorithm>
#include <memory>
#include <set>

#include <fmt/ranges.h>

#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/trace/trace_options.hpp"
#include "canopus/trace/report/bus_model.hpp"

namespace canopus::cli {
namespace {

struct ExportOptions {
  NamesOptions names{};
  std::string bus{};
  bool dbc = false;
  bool lua = false;
};

std::nullptr_t wrong(std::string_view message) {
  print_error("canopus: {}", message);
  return nullptr;
}

/// The selected bus, or nothing after an error was printed.
std::optional<std::string> chosen_bus(const ExportOptions& options, const trace::Names& names) {
  std::set<std::string> buses;
  for (const trace::NodeDescription& node : names.nodes()) {
    if (!node.bus.empty()) buses.insert(node.bus);
  }
  if (options.bus.empty() && buses.size() > 1) {
    wrong(fmt::format("the plant has the buses {}; say which with --bus", fmt::join(buses, ", ")));
    return std::nullopt;
  }
  if (!options.bus.empty() && !buses.contains(options.bus)) {
    wrong(fmt::format("no node of a bus \"{}\"; there are: {}", options.bus, fmt::join(buses, ", ")));
    return std::nullopt;
  }
  return options.bus;
}

int write_export(const ExportOptions& options) {
  if (options.dbc == options.lua) {
    wrong("expected one of --dbc and --lua");
    return 2;
  }
  const auto names = load_names(options.names, standard_error());
  if (!names) return 2;
  if (names->nodes().empty()) {
    wrong("no nodes: give --plant, --network or --node");
    return 2;
  }
  const auto bus = chosen_bus(options, *names);
  if (!bus) return 2;
  const trace::BusModel model = trace::model_of(*names, *bus);
  standard_output().content(options.dbc ? trace::dbc_file(model) : trace::lua_dissector(model, *bus));
  return 0;
}

}  // namespace

void add_trace_export(Command& trace, int& exit_code) {
  const auto options = std::make_shared<ExportOptions>();
  Command* command =
      trace.add_subcommand("export", "Export a plant's frames and signals for other programs (DBC, Lua)");
  command->add_flag("--dbc", options->dbc,
                    "A DBC file: a message for each PDO, a signal for each mapped object");
  command->add_flag("--lua", options->lua,
                    "A Lua script that shows the plant's names in Wireshark and tshark");
  add_names_options(*command, options->names);
  command->add_option("--bus", options->bus, "The bus, of a plant with several")->type_name("NAME");
  command->footer(
      "The file goes to the standard output. Wireshark: tshark -X lua_script:FILE -d "
      "can.subdissector,canopen\n"
      "Exit codes: 0 written, 2 wrong command line or file.");
  command->callback([options, &exit_code] { exit_code = write_export(*options); });
}

}  // namespace canopus::cli
