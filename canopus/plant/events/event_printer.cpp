#include "canopus/plant/events/event_printer.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include "canopus/plant/events/boot_report.hpp"
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

std::string hexadecimal(const canopen::Emergency& message) {
  std::string text;
  for (const std::uint8_t byte : message.manufacturer) text += fmt::format("{:02X}", byte);
  return text;
}

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

void JsonPrinter::booted(const NodeLabel& node, can::Time now) { print(node_event(now, "boot", node), now); }

void JsonPrinter::nmt_state_changed(const NodeLabel& node, canopen::NmtState state, can::Time now) {
  Json line = node_event(now, "nmt", node);
  line["state"] = canopen::name(state);
  print(line, now);
}

void JsonPrinter::lss_configured(const NodeLabel& node, std::uint32_t bit_rate, can::Time now) {
  Json line = node_event(now, "lss", node);
  line["bit_rate"] = bit_rate;
  print(line, now);
}

void JsonPrinter::emergency(const NodeLabel& node, const canopen::Emergency& message, can::Time now) {
  Json line = node_event(now, "emcy", node);
  line["code"] = fmt::format("{:04X}", message.code);
  line["register"] = message.error_register;
  line["data"] = hexadecimal(message);
  print(line, now);
}

void JsonPrinter::unacknowledged(const NodeLabel& node, can::Time now) {
  out_.json(node_event(now, "unacknowledged", node));
}

void JsonPrinter::slave_boot_went_on(const NodeLabel& slave, const NodeLabel& master,
                                     const manager::BootRecord& record, can::Time now) {
  Json line = node_event(now, "boot slave", slave);
  line["master"] = master.node_id;
  add_boot(line, record, now);
  print(line, now);
}

void JsonPrinter::signal_changed(std::string_view plc, char kind, unsigned number, bool on, can::Time now) {
  Json line = event_line(now, "signal");
  line["plc"] = plc;
  line["signal"] = fmt::format("{}{:02X}", kind, number);
  line["on"] = on;
  print(line, now);
}

void JsonPrinter::buffer_changed(std::string_view plc, unsigned head, std::uint32_t address,
                                 std::uint16_t value, bool by_cpu, can::Time now) {
  Json line = event_line(now, "buffer");
  line["plc"] = plc;
  line["module"] = fmt::format("U{:X}", head / 16);
  line["address"] = address;
  line["value"] = value;
  line["by"] = by_cpu ? "cpu" : "module";
  print(line, now);
}

void JsonPrinter::object_forced(const ForcedObject& forced, can::Time now) {
  Json line = object_event(now, "forced", forced);
  if (forced.until != can::never) line["until"] = event_seconds(forced.until);
  print(line, now);
}

void JsonPrinter::object_released(const ForcedObject& released, can::Time now) {
  print(object_event(now, "released", released), now);
}

void JsonPrinter::load(std::string_view bus, const can::BusLoad& load, can::Time now) {
  Json line = event_line(now, "load");
  line["bus"] = bus;
  line["now"] = load.now;
  line["peak"] = load.peak;
  line["frames"] = load.frames;
  line["error_frames"] = load.error_frames;
  print(line, now);
}

void JsonPrinter::warning(std::string_view source, std::string_view message, can::Time now) {
  Json line = event_line(now, "warning");
  line["source"] = source;
  line["message"] = message;
  print(line, now);
}

void JsonPrinter::error(std::string_view source, std::string_view message, can::Time now) {
  Json line = event_line(now, "error");
  line["source"] = source;
  line["message"] = message;
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
  return describe(node) + ": nobody acknowledges: no other node on this bus";
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
    time += fmt::format(", {:.0f} times as fast as real time", ratio);
  } else {
    time += fmt::format(", at most {} late", text::describe_duration(summary.largest_lag));
  }
  lines.push_back(std::move(time));
  for (const auto& bus : summary.buses) {
    lines.push_back(fmt::format("bus {}: {} frames, {} error frames, load at most {:.1f} %", bus.name,
                                bus.load.frames, bus.load.error_frames, bus.load.peak * 100));
  }
  std::size_t operational = 0;
  for (const NodeStatus& node : summary.nodes) {
    operational += in_operation(node) ? 1 : 0;
    const bool plain = node.layer2 != module::Layer2State::inactive;
    lines.push_back(fmt::format(
        "{}: {}, {} {} sent{}", describe(node.label), state_name(node), node.pdos, plain ? "frames" : "PDOs",
        node.emergencies == 0
            ? ""
            : fmt::format(", {} EMCY, last {:04X}H", node.emergencies, node.last_emergency)));
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
  lines.push_back(operational == summary.nodes.size()
                      ? fmt::format("all {} nodes operational", operational)
                      : fmt::format("{} of {} nodes operational", operational, summary.nodes.size()));
  return lines;
}

std::string LinePrinter::lost_line(std::uint64_t lines) const {
  return text::Line("{:>12.6f}  {} line{} lost: the output was not read\n", event_seconds(latest_), lines,
                    lines == 1 ? "" : "s")
      .text();
}

void LinePrinter::line(can::Time now, std::string_view text) {
  latest_ = now;
  const auto microseconds = now.time_since_epoch() / std::chrono::microseconds(1);
  out_.line("{:>5}.{:06}  {}", microseconds / 1'000'000, microseconds % 1'000'000, text);
}

void LinePrinter::booted(const NodeLabel& node, can::Time now) {
  if (!quiet_) line(now, fmt::format("{}: boot-up", describe(node)));
}

void LinePrinter::nmt_state_changed(const NodeLabel& node, canopen::NmtState state, can::Time now) {
  if (!quiet_) line(now, fmt::format("{}: {}", describe(node), canopen::name(state)));
}

void LinePrinter::lss_configured(const NodeLabel& node, std::uint32_t bit_rate, can::Time now) {
  if (!quiet_) line(now, describe_lss(node, bit_rate));
}

void LinePrinter::emergency(const NodeLabel& node, const canopen::Emergency& message, can::Time now) {
  if (quiet_) return;
  line(now, fmt::format("{}: EMCY {:04X}H, error register {:02X}H, {}", describe(node), message.code,
                        message.error_register, hexadecimal(message)));
}

void LinePrinter::unacknowledged(const NodeLabel& node, can::Time now) {
  if (!quiet_) line(now, describe_unacknowledged(node));
}

void LinePrinter::slave_boot_went_on(const NodeLabel& slave, const NodeLabel&,
                                     const manager::BootRecord& record, can::Time now) {
  using manager::BootStep;
  if (record.step == BootStep::failed) return error(describe(slave), manager::explain(record, now), now);
  const bool again = record.step == BootStep::presence && record.attempts > 1;
  const bool still = record.step == BootStep::presence_pause && record.attempts > 1;
  if (quiet_ || again || still) return;  // a missing slave is asked for ever: reported once
  const std::string words =
      record.step == BootStep::presence_pause ? manager::explain(record, now) : manager::describe(record);
  std::string text = describe(slave);
  text += record.step == BootStep::booted ? ": " : ": boot: ";
  text += words;
  line(now, text);
}

void LinePrinter::signal_changed(std::string_view plc, char kind, unsigned number, bool on, can::Time now) {
  if (!quiet_) line(now, fmt::format("{} {}{:02X} {}", plc, kind, number, on ? "ON" : "OFF"));
}

void LinePrinter::buffer_changed(std::string_view plc, unsigned head, std::uint32_t address,
                                 std::uint16_t value, bool by_cpu, can::Time now) {
  if (quiet_) return;
  line(now, fmt::format("{} U{:X}\\G{} = {} ({:04X}H){}", plc, head / 16, address, value, value,
                        by_cpu ? " written by the CPU" : ""));
}

void LinePrinter::object_forced(const ForcedObject& forced, can::Time now) {
  if (!quiet_) line(now, describe(forced));
}

void LinePrinter::object_released(const ForcedObject& released, can::Time now) {
  if (quiet_) return;
  line(now, fmt::format("{}: {} ({}) released, now {}", describe(released.device), released.object,
                        released.name, show_value(released.type, released.value)));
}

void LinePrinter::warning(std::string_view source, std::string_view message, can::Time) {
  if (!quiet_) errors_.line("{}: warning: {}", source, message);
}

void LinePrinter::error(std::string_view source, std::string_view message, can::Time now) {
  latest_ = now;
  errors_.line("{:>12.6f}  {}: {}", event_seconds(now), source, message);
}

void LinePrinter::summary(const RunSummary& summary) {
  if (quiet_) return;
  for (const std::string& text : describe(summary)) out_.line("{}", text);
}

}  // namespace canopus::plant
