// Events and errors that modules report to their CPUs, and errors on a bus, as lines.

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "canopus/module/interface/event_records.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/text/json.hpp"

namespace canopus::plant {

using Json = text::Json;

namespace {

/// The keys of a node within an event of its bus.
Json node_keys(const NodeLabel& node) {
  Json keys{{"node", node.node_id}};
  if (!node.name.empty()) keys["name"] = node.name;
  return keys;
}

}  // namespace

void JsonPrinter::module_event(std::string_view plc, std::string_view source,
                               const module::ModuleEventRecord& record) {
  Json line = event_line(record.at, "module event");
  line["plc"] = plc;
  line["module"] = source;
  line["code"] = fmt::format("{:05X}", record.code);
  line["overview"] = record.overview;
  if (record.detail) line["detail"] = *record.detail;
  print(line, record.at);
}

void JsonPrinter::module_error(std::string_view plc, std::string_view source,
                               const module::ModuleErrorRecord& record) {
  Json line = event_line(record.at, "module error");
  line["plc"] = plc;
  line["module"] = source;
  line["code"] = fmt::format("{:04X}", record.code);
  line["class"] = module::name(record.error_class);
  line["overview"] = record.overview;
  for (const auto& detail : record.details) {
    if (!detail.name.empty()) line["details"][std::string(detail.name)] = detail.value;
  }
  print(line, record.at);
}

void LinePrinter::module_error(std::string_view, std::string_view source,
                               const module::ModuleErrorRecord& record) {
  latest_ = record.at;
  errors_.line("{:>12.6f}  {}: {}", can::seconds(record.at), source, describe(record));
}

std::string describe(const module::ModuleErrorRecord& record) {
  std::string text =
      fmt::format("error {:04X}H ({}): {}", record.code, module::name(record.error_class), record.overview);
  std::string_view separator = "; ";
  for (const auto& detail : record.details) {
    if (detail.name.empty()) continue;
    text += fmt::format("{}{} {}", separator, detail.name, detail.value);
    separator = ", ";
  }
  return text;
}

void JsonPrinter::bus_error(const BusErrorEvent& error, can::Time now) {
  Json line = event_line(now, "bus error");
  line["bus"] = error.bus;
  line["error"] = can::name(error.error);
  line["field"] = can::name(error.field);
  line["bit"] = error.bit;
  line["nodes"] = Json::array();
  for (const BusErrorEvent::Node& one : error.nodes) {
    Json node = node_keys(one.label);
    node["transmitter"] = one.report.transmitter;
    node["tec"] = one.report.transmit_errors;
    node["rec"] = one.report.receive_errors;
    node["state"] = can::name(one.report.state);
    line["nodes"].push_back(std::move(node));
  }
  print(line, now);
}

void JsonPrinter::controller_changed(const NodeLabel& node, const can::ControllerReport& report,
                                     can::Time now) {
  Json line = event_line(now, "controller");
  line["bus"] = node.bus;
  line.update(node_keys(node));
  line["state"] = can::name(report.state);
  line["warning"] = report.warning;
  line["tec"] = report.transmit_errors;
  line["rec"] = report.receive_errors;
  print(line, now);
}

void LinePrinter::controller_changed(const NodeLabel& node, const can::ControllerReport& report,
                                     can::Time now) {
  if (!quiet_) line(now, describe_controller(node, report));
}

std::string describe(const BusErrorEvent& error) {
  std::string text = fmt::format("{} error in {}, bit {}, seen by ", can::name(error.error),
                                 can::name(error.field), error.bit);
  constexpr std::size_t shown = 4;
  for (std::size_t i = 0; i < std::min(shown, error.nodes.size()); ++i) {
    const BusErrorEvent::Node& node = error.nodes[i];
    if (i > 0) text += ", ";
    text +=
        node.label.name.empty() ? fmt::format("node {}", node.label.node_id) : std::string(node.label.name);
    if (node.report.transmitter) text += " (sending)";
  }
  if (error.nodes.size() > shown) text += fmt::format(" and {} more", error.nodes.size() - shown);
  return text;
}

std::string describe_controller(const NodeLabel& node, const can::ControllerReport& report) {
  const bool is_warned = report.warning && report.state == can::ErrorState::error_active;
  return fmt::format("{}: {}{}, TEC {}, REC {}", describe(node), can::name(report.state),
                     is_warned ? " (warning)" : "", report.transmit_errors, report.receive_errors);
}

}  // namespace canopus::plant
