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

void JsonPrinter::add(const ModuleEvent& event, can::Time) {
  Json line = event_line(event.record.at, "module event");
  line["plc"] = event.plc;
  line["module"] = event.module;
  line["code"] = fmt::format("{:05X}", event.record.code);
  line["overview"] = event.record.overview;
  if (event.record.detail) line["detail"] = *event.record.detail;
  print(line, event.record.at);
}

void JsonPrinter::add(const ModuleError& event, can::Time) {
  Json line = event_line(event.record.at, "module error");
  line["plc"] = event.plc;
  line["module"] = event.module;
  line["code"] = fmt::format("{:04X}", event.record.code);
  line["class"] = module::name(event.record.error_class);
  line["overview"] = event.record.overview;
  for (const auto& detail : event.record.details) {
    if (!detail.name.empty()) line["details"][std::string(detail.name)] = detail.value;
  }
  print(line, event.record.at);
}

void LinePrinter::add(const ModuleError& event, can::Time) {
  latest_ = event.record.at;
  errors_.line("{:>12.6f}  {}: {}", can::seconds(event.record.at), event.module, describe(event.record));
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

void JsonPrinter::add(const BusErrorEvent& event, can::Time now) {
  Json line = event_line(now, "bus error");
  line["bus"] = event.bus;
  line["error"] = can::name(event.error);
  line["field"] = can::name(event.field);
  line["bit"] = event.bit;
  line["nodes"] = Json::array();
  for (const BusErrorEvent::Node& one : event.nodes) {
    Json node = node_keys(one.label);
    node["transmitter"] = one.report.transmitter;
    node["tec"] = one.report.transmit_errors;
    node["rec"] = one.report.receive_errors;
    node["state"] = can::name(one.report.state);
    line["nodes"].push_back(std::move(node));
  }
  print(line, now);
}

void JsonPrinter::add(const ControllerChange& event, can::Time now) {
  Json line = event_line(now, "controller");
  line["bus"] = event.node.bus;
  line.update(node_keys(event.node));
  line["state"] = can::name(event.report.state);
  line["warning"] = event.report.warning;
  line["tec"] = event.report.transmit_errors;
  line["rec"] = event.report.receive_errors;
  print(line, now);
}

void LinePrinter::add(const ControllerChange& event, can::Time now) {
  if (!quiet_) line(now, describe_controller(event.node, event.report));
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
