#include "canopus/plant/events/event_printer.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/hex.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/plant/file/process_value.hpp"
#include "canopus/text/json.hpp"

namespace canopus::plant {
namespace {

using Json = text::Json;

Json node_event(can::Time now, std::string_view kind, const NodeLabel& node) {
  Json line = event_line(now, kind);
  line["bus"] = node.bus;
  line["node"] = node.node_id;
  if (!node.name.empty()) line["name"] = node.name;
  return line;
}

Json object_event(can::Time now, std::string_view kind, const ForcedObject& object) {
  Json line = node_event(now, kind, object.device);
  line["object"] = object.object;
  line["parameter"] = object.name;
  line["value"] = json_value(object.type, object.value);
  return line;
}

std::string hexadecimal(const canopen::Emergency& message) { return ascii::hex_bytes(message.manufacturer); }

}  // namespace

double event_seconds(can::Time time) {
  return static_cast<double>(time.time_since_epoch() / std::chrono::microseconds(1)) / 1e6;
}

text::Json event_line(can::Time now, std::string_view kind) {
  return {{"t", event_seconds(now)}, {"event", kind}};
}

void JsonPrinter::print(const Json& line, can::Time now) {
  latest_ = now;
  out_.json(line);
}

std::string JsonPrinter::lost_line(std::uint64_t lines) const {
  Json line = event_line(latest_, "lost");
  line["lines"] = lines;
  return line.dump() + '\n';
}

void JsonPrinter::listening(std::string_view protocol, std::string_view of, std::string_view address) {
  Json line = event_line(can::Time{}, "listen");
  line["protocol"] = protocol;
  line["of"] = of;
  line["address"] = address;
  print(line, can::Time{});
}

void JsonPrinter::on(const Event& event) {
  std::visit([&](const auto& what) { add(what, event.time); }, event.what);
}

void JsonPrinter::add(const BootUp& event, can::Time now) { print(node_event(now, "boot", event.node), now); }

void JsonPrinter::add(const NmtStateChange& event, can::Time now) {
  Json line = node_event(now, "nmt", event.node);
  line["state"] = canopen::name(event.state);
  print(line, now);
}

void JsonPrinter::add(const LssSetting& event, can::Time now) {
  Json line = node_event(now, "lss", event.node);
  line["bit_rate"] = event.bit_rate;
  print(line, now);
}

void JsonPrinter::add(const EmergencySent& event, can::Time now) {
  Json line = node_event(now, "emcy", event.node);
  line["code"] = fmt::format("{:04X}", event.message.code);
  line["register"] = event.message.error_register;
  line["data"] = hexadecimal(event.message);
  print(line, now);
}

void JsonPrinter::add(const MissingAck& event, can::Time now) {
  out_.json(node_event(now, "unacknowledged", event.node));
}

void JsonPrinter::add(const SlaveBootStep& event, can::Time now) {
  Json line = node_event(now, "boot slave", event.slave);
  line["master"] = event.master.node_id;
  add_boot(line, event.record, now);
  print(line, now);
}

void JsonPrinter::add(const SignalChange& event, can::Time now) {
  Json line = event_line(now, "signal");
  line["plc"] = event.plc;
  line["signal"] = fmt::format("{}{:02X}", event.device, event.number);
  line["on"] = event.on;
  print(line, now);
}

void JsonPrinter::add(const BufferChange& event, can::Time now) {
  Json line = event_line(now, "buffer");
  line["plc"] = event.plc;
  line["module"] = fmt::format("U{:X}", event.head / 16);
  line["address"] = event.address;
  line["value"] = event.value;
  line["by"] = event.by_cpu ? "cpu" : "module";
  print(line, now);
}

void JsonPrinter::add(const ObjectForced& event, can::Time now) {
  Json line = object_event(now, "forced", event.object);
  if (event.object.until != can::never) line["until"] = event_seconds(event.object.until);
  print(line, now);
}

void JsonPrinter::add(const ObjectReleased& event, can::Time now) {
  print(object_event(now, "released", event.object), now);
}

void JsonPrinter::add(const LoadMeasured& event, can::Time now) {
  Json line = event_line(now, "load");
  line["bus"] = event.bus;
  line["now"] = event.load.now;
  line["peak"] = event.load.peak;
  line["frames"] = event.load.frames;
  line["error_frames"] = event.load.error_frames;
  print(line, now);
}

void JsonPrinter::add(const Warning& event, can::Time now) {
  Json line = event_line(now, "warning");
  line["source"] = event.source;
  line["message"] = event.message;
  print(line, now);
}

void JsonPrinter::add(const Failure& event, can::Time now) {
  Json line = event_line(now, "error");
  line["source"] = event.source;
  line["message"] = event.message;
  print(line, now);
}

void JsonPrinter::summary(const RunSummary& summary) {
  Json line = event_line(summary.end, "summary");
  line["virtual"] = summary.virtual_time;
  line["wall"] = static_cast<double>(summary.wall / std::chrono::microseconds(1)) / 1e6;
  if (!summary.virtual_time) {
    line["lag"] = static_cast<double>(summary.largest_lag / std::chrono::microseconds(1)) / 1e6;
  }
  line["buses"] = Json::array();
  for (const auto& bus : summary.buses) {
    line["buses"].push_back({{"bus", bus.name},
                             {"frames", bus.load.frames},
                             {"error_frames", bus.load.error_frames},
                             {"peak", bus.load.peak}});
  }
  line["nodes"] = Json::array();
  for (const NodeStatus& node : summary.nodes) {
    line["nodes"].push_back({{"bus", node.label.bus},
                             {"node", node.label.node_id},
                             {"name", node.label.name},
                             {"state", state_name(node)},
                             {"pdos", node.pdos},
                             {"emcy", node.emergencies}});
  }
  line["slaves"] = Json::array();
  for (const SlaveBoot& boot : summary.boots) {
    Json slave{{"bus", boot.slave.bus}, {"node", boot.slave.node_id}};
    if (!boot.slave.name.empty()) slave["name"] = boot.slave.name;
    slave["master"] = boot.master.node_id;
    add_boot(slave, boot.record, summary.end);
    line["slaves"].push_back(std::move(slave));
  }
  line["troubles"] = Json::array();
  for (const ModuleTrouble& trouble : summary.troubles) {
    line["troubles"].push_back({{"bus", trouble.module.bus},
                                {"node", trouble.module.node_id},
                                {"name", trouble.module.name},
                                {"message", trouble.text}});
  }
  line["forced"] = Json::array();
  for (const ForcedObject& forced : summary.forced) {
    line["forced"].push_back({{"bus", forced.device.bus},
                              {"node", forced.device.node_id},
                              {"name", forced.device.name},
                              {"object", forced.object},
                              {"value", json_value(forced.type, forced.value)}});
  }
  add_lifts(line, summary.lifts);
  print(line, summary.end);
}

std::string describe_trouble(const SlaveBoot& boot, can::Time now) {
  if (boot.record.step == manager::BootStep::booted) return {};
  return fmt::format("{}: {}", describe(boot.slave), manager::explain(boot.record, now));
}

std::string_view state_name(const NodeStatus& node) {
  if (!node.is_on) return "off";
  switch (node.layer2) {
    case module::Layer2State::offline: return "layer 2 offline";
    case module::Layer2State::online: return "layer 2 online";
    case module::Layer2State::inactive: break;
  }
  return canopen::name(node.state);
}

std::string_view condition_name(const NodeStatus& node) {
  if (node.is_cut_off) return "cut off from its bus";
  if (node.is_on && node.error_state == can::ErrorState::bus_off) return "bus-off";
  return state_name(node);
}

bool in_operation(const NodeStatus& node) {
  if (!node.is_on || node.is_cut_off || node.error_state == can::ErrorState::bus_off) return false;
  return node.layer2 == module::Layer2State::inactive ? node.state == canopen::NmtState::operational
                                                      : node.layer2 == module::Layer2State::online;
}

std::string describe(const NodeLabel& node) {
  if (node.node_id == 0) return fmt::format("{} ({})", node.bus, node.name);
  if (node.node_id == no_node_id) return fmt::format("{} unconfigured ({})", node.bus, node.name);
  // Thousands of lines at one moment begin so.
  return node.name.empty() ? fmt::format(FMT_COMPILE("{} node {}"), node.bus, node.node_id)
                           : fmt::format(FMT_COMPILE("{} node {} ({})"), node.bus, node.node_id, node.name);
}

std::string describe_lss(const NodeLabel& node, std::uint32_t bit_rate) {
  const std::string number =
      node.node_id == no_node_id ? "no node-ID" : fmt::format("node-ID {}", node.node_id);
  return fmt::format("{}: LSS: {}, {:g} kbit/s", describe(node), number, bit_rate / 1000.0);
}

std::string describe_unacknowledged(const NodeLabel& node) {
  return describe(node) + ": no acknowledgement: no other node on this bus";
}

std::string describe_value(const ForcedObject& forced) {
  std::string text =
      fmt::format("{} ({}) forced to {}", forced.object, forced.name, show_value(forced.type, forced.value));
  if (forced.until != can::never) {
    text += fmt::format(" until {}", text::describe_duration(forced.until.time_since_epoch()));
  }
  return text;
}

std::string describe(const ForcedObject& forced) {
  return fmt::format("{}: {}", describe(forced.device), describe_value(forced));
}

std::vector<std::string> describe(const RunSummary& summary) {
  std::vector<std::string> lines;
  std::string time =
      fmt::format("ran {} of plant time in {}", text::describe_duration(summary.end.time_since_epoch()),
                  text::describe_duration(summary.wall));
  if (summary.virtual_time) {
    const double ratio =
        can::seconds(summary.end) / std::max(1e-9, std::chrono::duration<double>(summary.wall).count());
    constexpr double whole_from = 10;  // below that "0 times" or "1 times" would be said
    time += fmt::format(", {:.{}f} times as fast as real time", ratio, ratio < whole_from ? 1 : 0);
  } else {
    time += fmt::format(", at most {} late", text::describe_duration(summary.largest_lag));
  }
  lines.push_back(std::move(time));
  for (const auto& bus : summary.buses) {
    lines.push_back(fmt::format("bus {}: {}, {}, load at most {:.1f} %", bus.name,
                                ascii::counted(bus.load.frames, "frame"),
                                ascii::counted(bus.load.error_frames, "error frame"), bus.load.peak * 100));
  }
  std::size_t operational = 0;
  for (const NodeStatus& node : summary.nodes) {
    operational += in_operation(node) ? 1 : 0;
    const bool plain = node.layer2 != module::Layer2State::inactive;
    lines.push_back(fmt::format("{}: {}, {} sent{}", describe(node.label), state_name(node),
                                ascii::counted(node.pdos, plain ? "frame" : "PDO"),
                                node.emergencies == 0 ? ""
                                                      : fmt::format(", {} EMCY, last {:04X}H",
                                                                    node.emergencies, node.last_emergency)));
  }
  for (const SlaveBoot& boot : summary.boots) {
    if (std::string trouble = describe_trouble(boot, summary.end); !trouble.empty()) {
      lines.push_back(std::move(trouble));
    }
  }
  for (const ModuleTrouble& trouble : summary.troubles) {
    lines.push_back(fmt::format("{}: {}", describe(trouble.module), trouble.text));
  }
  for (const ForcedObject& forced : summary.forced) lines.push_back(describe(forced));
  for (const RunSummary::LiftCount& lift : summary.lifts) lines.push_back(describe(lift));
  lines.push_back(
      operational == summary.nodes.size() && operational != 1
          ? fmt::format("all {} operational", ascii::counted(operational, "node"))
          : fmt::format("{} of {} operational", operational, ascii::counted(summary.nodes.size(), "node")));
  return lines;
}

std::string LinePrinter::lost_line(std::uint64_t lines) const {
  return text::Line("{:>12.6f}  {} lost: the output was not read\n", event_seconds(latest_),
                    ascii::counted(lines, "line"))
      .text();
}

void LinePrinter::line(can::Time now, std::string_view text) {
  latest_ = now;
  print_counted(now);
  if (!repeated_.passes(text, now)) return;
  const auto microseconds = now.time_since_epoch() / std::chrono::microseconds(1);
  out_.line("{:>5}.{:06}  {}", microseconds / 1'000'000, microseconds % 1'000'000, text);
}

void LinePrinter::on(const Event& event) {
  std::visit([&](const auto& what) { add(what, event.time); }, event.what);
}

void LinePrinter::add(const BootUp& event, can::Time now) {
  if (!quiet_) line(now, fmt::format("{}: boot-up", describe(event.node)));
}

void LinePrinter::add(const NmtStateChange& event, can::Time now) {
  if (!quiet_) line(now, fmt::format("{}: {}", describe(event.node), canopen::name(event.state)));
}

void LinePrinter::add(const LssSetting& event, can::Time now) {
  if (!quiet_) line(now, describe_lss(event.node, event.bit_rate));
}

void LinePrinter::add(const EmergencySent& event, can::Time now) {
  if (quiet_) return;
  line(now, fmt::format("{}: EMCY {:04X}H, error register {:02X}H, {}", describe(event.node),
                        event.message.code, event.message.error_register, hexadecimal(event.message)));
}

void LinePrinter::add(const MissingAck& event, can::Time now) {
  if (!quiet_) line(now, describe_unacknowledged(event.node));
}

void LinePrinter::add(const SlaveBootStep& event, can::Time now) {
  using manager::BootStep;
  if (event.record.step == BootStep::failed)
    return add(Failure{describe(event.slave), manager::explain(event.record, now)}, now);
  const bool again = event.record.step == BootStep::presence && event.record.attempts > 1;
  const bool still = event.record.step == BootStep::presence_pause && event.record.attempts > 1;
  if (quiet_ || again || still) return;  // a missing slave is asked for ever: reported once
  const std::string words = event.record.step == BootStep::presence_pause
                                ? manager::explain(event.record, now)
                                : manager::describe(event.record);
  std::string text = describe(event.slave);
  text += event.record.step == BootStep::booted ? ": " : ": boot: ";
  text += words;
  line(now, text);
}

void LinePrinter::add(const SignalChange& event, can::Time now) {
  if (!quiet_)
    line(now, fmt::format("{} {}{:02X} {}", event.plc, event.device, event.number, event.on ? "ON" : "OFF"));
}

void LinePrinter::add(const BufferChange& event, can::Time now) {
  if (quiet_) return;
  line(now, fmt::format("{} U{:X}\\G{} = {} ({:04X}H){}", event.plc, event.head / 16, event.address,
                        event.value, event.value, event.by_cpu ? " written by the CPU" : ""));
}

void LinePrinter::add(const ObjectForced& event, can::Time now) {
  if (!quiet_) line(now, describe(event.object));
}

void LinePrinter::add(const ObjectReleased& event, can::Time now) {
  if (quiet_) return;
  line(now, fmt::format("{}: {} ({}) released, now {}", describe(event.object.device), event.object.object,
                        event.object.name, show_value(event.object.type, event.object.value)));
}

void LinePrinter::add(const Warning& event, can::Time now) {
  if (quiet_) return;
  if (now == can::Time{}) return errors_.line("{}: warning: {}", event.source, event.message);
  latest_ = now;
  errors_.line("{:>12.6f}  {}: warning: {}", event_seconds(now), event.source, event.message);
}

void LinePrinter::add(const Failure& event, can::Time now) {
  latest_ = now;
  print_counted(now);
  const std::string text = fmt::format("{}: {}", event.source, event.message);
  if (repeated_errors_.passes(text, now)) errors_.line("{:>12.6f}  {}", event_seconds(now), text);
}

void LinePrinter::print_counted(can::Time now) {
  for (const std::string& text : repeated_.ended(now)) out_.line("{:>12}  {}", "...", text);
  for (const std::string& text : repeated_errors_.ended(now)) errors_.line("{:>12}  {}", "...", text);
}

void LinePrinter::summary(const RunSummary& summary) {
  print_counted(can::never);
  if (quiet_) return;
  for (const std::string& text : describe(summary)) out_.line("{}", text);
}

using manager::BootError;
using manager::BootStep;

void add_boot(text::Json& line, const manager::BootRecord& record, can::Time now) {
  line["step"] = manager::facts(record.step).text;
  line["since"] = static_cast<double>(record.since.time_since_epoch() / std::chrono::microseconds(1)) / 1e6;
  const bool names_object =
      facts(record.step == BootStep::failed ? record.failed_step : record.step).asks_object ||
      record.step == BootStep::presence_pause;
  if (names_object && record.index != 0) {
    line["object"] = canopen::object_text(record.index, record.sub);
  }
  if (record.attempts != 0) line["attempts"] = record.attempts;
  if (record.error == BootError::none) {
    if (record.halted_by != 0) line["reason"] = manager::explain(record, now);
    return;
  }
  line["error"] = std::string(1, manager::letter(record.error));
  if (record.abort_code != canopen::AbortCode::none) {
    line["abort"] = fmt::format("{:08X}", static_cast<std::uint32_t>(record.abort_code));
  } else if (record.expected != record.received) {
    line["expected"] = record.expected;
    line["received"] = record.received;
  }
  line["reason"] = manager::explain(record, now);
}

}  // namespace canopus::plant
