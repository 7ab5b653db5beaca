#include "canopus/cli/bus/scan_command.hpp"

#include <algorithm>
#include <charconv>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

struct ScanArguments {
  BusOptions bus;
  NodeNamesOptions names;
  std::string nodes = "1-127";
};

std::string number(std::optional<std::uint32_t> value) { return value ? fmt::format("{:08X}", *value) : "-"; }

std::string_view colour_of(std::optional<canopen::NmtState> state) {
  if (!state) return "2";  // dim
  switch (*state) {
    case canopen::NmtState::operational: return "32";
    case canopen::NmtState::pre_operational: return "33";
    case canopen::NmtState::stopped: return "31";
    case canopen::NmtState::initialising: break;
  }
  return "36";
}

/// Runs the scan, with a bar on a terminal.
BusLoop::End run_scan(BusLoop& bus, client::BusScan& scan) {
  const bool bar = is_terminal(STDERR_FILENO);
  can::Time next_bar{};
  bus.add(scan);
  scan.start(bus.now());
  BusLoop::End end = BusLoop::End::time_over;
  while (end == BusLoop::End::time_over) {
    if (bar && bus.now() >= next_bar) {
      show_progress(Line("{}", scan_progress(scan.asked(), scan.of(), scan.found().size())));
      next_bar = bus.now() + std::chrono::milliseconds(100);
    }
    end = bus.run([&] { return scan.finished(); }, bar ? next_bar : can::never);
  }
  end_progress();
  bus.remove(scan);
  return end;
}

int scan(const ScanArguments& arguments) {
  const auto range = parse_node_range(arguments.nodes);
  if (!range) return complain(exit_code::usage, range.error());
  const auto names = load_node_names(with_plant_of_bus(arguments.names, arguments.bus.bus));
  if (!names) return names.error().empty() ? exit_code::usage : complain(exit_code::usage, names.error());
  const auto address = link::parse_bus_address(arguments.bus.bus);
  const NamesOfNodes known = names_on_channel(*names, address ? address->bus : "");
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    std::vector<client::FoundNode> nodes;
    const int code = scan_bus(bus, *range, time_out, nodes);
    if (arguments.bus.json) {
      for (const client::FoundNode& node : nodes) print_json(scan_json(node, known));
    } else if (!nodes.empty()) {
      for (const Line& line : scan_table(nodes, wants_colour(STDOUT_FILENO), known))
        standard_output().line(line);
    }
    if (code != exit_code::done) return code;
    if (nodes.empty()) return complain(exit_code::failed, "no node answers");
    if (!arguments.bus.json) print_line("{} found", ascii::counted(nodes.size(), "node"));
    return exit_code::done;
  });
}

}  // namespace

std::expected<NodeRange, std::string> parse_node_range(std::string_view text) {
  const std::size_t dash = text.find('-');
  const unsigned first = parse_node(text.substr(0, dash));
  const unsigned last = dash == std::string_view::npos ? first : parse_node(text.substr(dash + 1));
  if (first == 0 || last == 0 || last < first) {
    return std::unexpected(fmt::format("--nodes: \"{}\" is no range; expected for example 1-32 or 5", text));
  }
  return NodeRange{static_cast<std::uint8_t>(first), static_cast<std::uint8_t>(last)};
}

int scan_bus(BusLoop& bus, NodeRange range, can::Duration time_out, std::vector<client::FoundNode>& found) {
  bus.need({link::IdentifierFilter::function(canopen::cob_id::sdo_response),
            link::IdentifierFilter::function(canopen::cob_id::error_control)});
  client::BusScan questions(bus, range.first, range.last, time_out);
  const BusLoop::End end = run_scan(bus, questions);
  found = questions.found();
  return end == BusLoop::End::done ? exit_code::done : complain_of(end, bus, "");
}

NamesOfNodes names_on_channel(const trace::Names& names, std::string_view bus) {
  NamesOfNodes known;
  for (const trace::NodeDescription* node : names.on_channel(bus)) {
    if (!node->name.empty()) known[node->node_id] = node->name;
  }
  return known;
}

std::vector<Line> scan_table(const std::vector<client::FoundNode>& nodes, bool colour,
                             const NamesOfNodes& names) {
  std::vector<Line> lines;
  std::size_t width = 4;
  for (const auto& [node, name] : names) width = std::max(width, name.size());
  lines.push_back(Line("{:>4}  {:<15}  {:<8}  {:<8}  {:<8}  {:<8}  {:<8}  {}", "node", "state", "type",
                       "vendor", "product", "revision", "serial", names.empty() ? "name" : ""));
  if (!names.empty()) lines.back().add("{:<{}}  device name", "name", width);
  for (const client::FoundNode& node : nodes) {
    const std::string state = fmt::format("{:<15}", node.state ? canopen::name(*node.state) : "unknown");
    Line line("{:>4}  {}  {:<8}  {:<8}  {:<8}  {:<8}  {:<8}  ", node.node_id,
              paint(state, colour_of(node.state), colour), number(node.device_type), number(node.vendor),
              number(node.product), number(node.revision), number(node.serial));
    const auto name = names.find(node.node_id);
    if (!names.empty()) line.add("{:<{}}  ", name == names.end() ? "-" : name->second, width);
    line.add("{}", node.answers_sdo ? node.name.value_or("-") : "(no SDO answer)");
    lines.push_back(std::move(line));
  }
  return lines;
}

text::Json scan_json(const client::FoundNode& node, const NamesOfNodes& names) {
  text::Json line;
  line["node"] = node.node_id;
  line["answers_sdo"] = node.answers_sdo;
  if (node.state) line["state"] = canopen::name(*node.state);
  if (node.device_type) line["device_type"] = *node.device_type;
  if (node.vendor) line["vendor"] = *node.vendor;
  if (node.product) line["product"] = *node.product;
  if (node.revision) line["revision"] = *node.revision;
  if (node.serial) line["serial"] = *node.serial;
  if (node.name) line["name"] = *node.name;
  if (const auto name = names.find(node.node_id); name != names.end()) line["node_name"] = name->second;
  if (node.heartbeat_ms) line["heartbeat_ms"] = *node.heartbeat_ms;
  if (node.guard_ms) line["guard_ms"] = *node.guard_ms;
  return line;
}

std::string scan_progress(unsigned asked, unsigned of, std::size_t found) {
  constexpr unsigned width = 30;
  const unsigned full = of == 0 ? width : asked * width / of;
  return fmt::format("[{:#<{}}{:-<{}}] {:>3} of {} asked, {} found", "", full, "", width - full, asked,
                     ascii::counted(of, "node"), found);
}

namespace {

void build_scan_command(Command& command, int& exit_code) {
  const auto arguments = std::make_shared<ScanArguments>();
  arguments->bus.time_out = "200ms";
  command.add_option("--nodes", arguments->nodes, "only these node-IDs, for example 1-32")
      ->type_name("FIRST-LAST")
      ->capture_default_str();
  add_node_names_options(command, arguments->names, "names of nodes");
  add_bus_options(command, arguments->bus, "for each answer of a node");
  command.footer(
      "Every node is asked over its default SDO channel; no other client should be using it meanwhile.\n"
      "Names of nodes come from the options, or from plant.toml of this folder if the bus is one of that "
      "plant.\n"
      "Exit code: 0 nodes found, 1 none, or no bus, 2 wrong command line.");
  command.callback([arguments, &exit_code] { exit_code = scan(*arguments); });
}

}  // namespace

void add_scan_command(Command& app, int& exit_code) {
  app.add_subcommand("scan", "Find the nodes of a bus: identity, name and NMT state of each",
                     [&exit_code](Command& command) { build_scan_command(command, exit_code); });
}

}  // namespace canopus::cli
