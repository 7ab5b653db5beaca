#include "canopus/web/state/events.hpp"

#include <algorithm>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canopus/module/interface/communication_module.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/web/state/program_views.hpp"

namespace canopus::web {
namespace {

using Fields = text::Json;

Fields label_fields(const plant::NodeLabel& label) {
  return {{"bus", label.bus}, {"node", label.node_id}, {"name", label.name}};
}

std::string_view controller_text(can::ErrorState state) {
  switch (state) {
    case can::ErrorState::error_active: return "error active";
    case can::ErrorState::error_passive: return "error passive";
    case can::ErrorState::bus_off: return "bus-off";
  }
  return "unknown";
}

/// Of a cut wire.
Fields side_fields(const std::vector<sim::BusSide>& sides) {
  Fields fields = Fields::array();
  for (const sim::BusSide& side : sides) {
    fields.push_back({{"nodes", side.ports},
                      {"now", side.now},
                      {"frames", side.frames},
                      {"error_frames", side.error_frames}});
  }
  return fields;
}

Fields bus_fields(const plant::BusSection& section, const can::Bus& bus, const sim::Bus* simulated,
                  can::Time now) {
  const can::BusLoad load = bus.load(now);
  Fields fields{{"bus", bus.name()},
                {"link", section.is_linked() ? section.link : std::string("sim")},
                {"bit_rate", bus.bit_rate()},
                {"now", load.now},
                {"peak", load.peak},
                {"frames", load.frames},
                {"error_frames", load.error_frames}};
  if (!bus.is_there()) fields["gone"] = true;
  if (simulated != nullptr) {
    if (const auto sides = simulated->sides(now); !sides.empty()) fields["cut"] = side_fields(sides);
  }
  return fields;
}

Fields node_fields(const plant::NodeStatus& node) {
  Fields fields = label_fields(node.label);
  fields["module"] = node.is_module;
  fields["state"] = state_name(node);
  fields["in_operation"] = in_operation(node);
  if (node.is_cut_off) fields["cut_off"] = true;
  fields["frames"] = node.frames;
  fields["waiting"] = node.waiting;
  fields["pdos"] = node.pdos;
  fields["emcy"] = node.emergencies;
  if (node.emergencies != 0) fields["last_emcy"] = fmt::format("{:04X}", node.last_emergency);
  fields["controller"] = controller_text(node.error_state);
  fields["tec"] = node.transmit_errors;
  fields["rec"] = node.receive_errors;
  return fields;
}

Fields signals_that_are_on(char kind, std::uint16_t head, std::uint32_t on) {
  Fields names = Fields::array();
  for (unsigned bit = 0; bit < 32; ++bit) {
    if ((on >> bit & 1U) != 0) names.push_back(fmt::format("{}{:02X}", kind, head + bit));
  }
  return names;
}

/// The name of a word in the module's manual; empty: it has none.
std::string_view word_name(std::span<const module::BufferRow> rows, std::uint32_t address) {
  const auto row = std::ranges::find_if(rows, [&](const module::BufferRow& one) {
    return address <= 0xFFFF && one.covers(static_cast<module::BufferAddress>(address)) && !one.name.empty();
  });
  return row == rows.end() ? std::string_view() : row->name;
}

Fields module_fields(const plant::ModuleStatus& module, module::CommunicationModule& itself) {
  Fields fields = label_fields(module.label);
  fields["model"] = itself.model();
  fields["signals"] = itself.signals() != nullptr;
  fields["plc"] = module.plc;
  fields["head"] = module.head;
  fields["on"] = module.is_on;
  fields["cpu"] = module.cpu == module::CpuState::run ? "RUN" : "STOP";
  fields["leds"] = Fields::array();
  for (const module::Led& led : module.leds) {
    fields["leds"].push_back({{"name", led.name},
                              {"pattern", module::name(led.pattern)},
                              {"opposite", led.opposite},
                              {"error", led.error}});
  }
  fields["signals_on"] = signals_that_are_on('X', module.head, module.inputs);
  for (Fields& name : signals_that_are_on('Y', module.head, module.outputs)) {
    fields["signals_on"].push_back(std::move(name));
  }
  fields["words"] = Fields::array();
  const auto rows = plant::find_module(itself.model())->buffer_rows;
  for (const auto& word : module.words) {
    Fields one{{"address", word.address}, {"value", word.value}};
    if (const std::string_view name = word_name(rows, word.address); !name.empty()) one["name"] = name;
    fields["words"].push_back(std::move(one));
  }
  return fields;
}

/// Times in seconds.
void add_figures(Fields& fields, const BusStatisticsView* figures, std::uint8_t node_id, can::Time now) {
  if (figures == nullptr || node_id == 0) return;
  const BusStatisticsView::Node& node = figures->node(node_id);
  if (node.heartbeat) {
    fields["heartbeat"] = {{"age", can::seconds(can::Time{now - *node.heartbeat})},
                           {"period", can::seconds(can::Time{node.period})}};
  }
  if (node.answers.count() != 0) fields["sdo"] = time_fields(node.answers);
}

/// The NMT state of a node outside of the plant, as far as its bus shows it: that it was booted is another thing.
void add_nmt_state(Fields& fields, const BusStatisticsView* figures, std::uint8_t node_id, can::Time now) {
  fields["state"] = "not known";
  fields["in_operation"] = false;
  if (figures == nullptr) return;
  const BusStatisticsView::Node& node = figures->node(node_id);
  const bool is_silent =
      node.heartbeat && node.period > can::Duration{} && 2 * (now - *node.heartbeat) > 3 * node.period;
  if (!node.state || is_silent) return;
  fields["state"] = canopen::name(*node.state);
  fields["in_operation"] = *node.state == canopen::NmtState::operational;
}

/// The boot that succeeded has asked for the identity, and found what it expected.
bool has_compared_identity(const WebBoots& boots, const plant::SlaveBoot& boot) {
  if (boot.record.step != manager::BootStep::booted) return false;
  const auto slave = boots.slaves().find({std::string(boot.slave.bus), boot.slave.node_id});
  if (slave == boots.slaves().end()) return false;
  const auto& steps = slave->second.steps;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    if (step->record.step == manager::BootStep::identity) return true;
    if (step->record.step == manager::BootStep::wait_after_reset) return false;
  }
  return false;
}

/// Nodes that a bus has shown, and that are neither the plant's nor booted by one of its modules.
void add_outside(Fields& state, plant::Plant& plant, const WebTraffic& traffic, can::Time now) {
  std::set<std::pair<std::string_view, unsigned>> known;
  for (const plant::NodeStatus& node : plant.nodes()) known.emplace(node.label.bus, node.label.node_id);
  for (const plant::SlaveBoot& boot : plant.boots()) known.emplace(boot.slave.bus, boot.slave.node_id);
  constexpr std::uint8_t last_node = 127;
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    const std::string& bus = plant.bus(i).name();
    const BusStatisticsView* const figures = traffic.figures(bus);
    if (figures == nullptr) continue;
    for (std::uint8_t id = 1; id <= last_node; ++id) {
      const BusStatisticsView::Node& node = figures->node(id);
      if ((!node.state && node.answers.count() == 0) || known.contains({bus, id})) continue;
      Fields fields = label_fields({.bus = bus, .name = {}, .node_id = id});
      add_figures(fields, figures, id, now);
      add_nmt_state(fields, figures, id, now);
      state["outside"].push_back(std::move(fields));
    }
  }
}

}  // namespace

void WebEvents::set_listener(std::function<void(std::string_view)> listener) {
  listener_ = std::move(listener);
  for (const std::string& line : std::exchange(early_, {})) listener_(line);
}

void WebEvents::add(std::string_view line) {
  if (line.ends_with('\n')) line.remove_suffix(1);
  if (listener_) return listener_(line);
  early_.emplace_back(line);
  if (early_.size() > most_kept) early_.pop_front();
}

std::string WebEvents::lost(std::uint64_t events) const {
  std::string line = json_.lost_line(events);
  line.pop_back();
  return line;
}

std::string state_event(plant::Plant& plant, const WebTraffic* traffic, const WebBoots* boots, double speed) {
  const can::Time now = plant.timeline().now();
  Fields state = plant::event_line(now, "state");
  state["plant"] = plant.name();
  state["speed"] = speed;
  state["live"] = false;
  state["buses"] = Fields::array();
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    const plant::BusSection& section = plant.bus_section(i);
    if (section.is_linked() && section.replay.empty()) state["live"] = true;
    state["buses"].push_back(bus_fields(section, plant.bus(i), plant.simulated_bus(i), now));
  }
  state["nodes"] = Fields::array();
  for (const plant::NodeStatus& node : plant.nodes()) {
    Fields fields = node_fields(node);
    if (traffic != nullptr) add_figures(fields, traffic->figures(node.label.bus), node.label.node_id, now);
    state["nodes"].push_back(std::move(fields));
  }
  state["slaves"] = Fields::array();
  for (const plant::SlaveBoot& boot : plant.boots()) {
    Fields slave = label_fields(boot.slave);
    slave["master"] = boot.master.node_id;
    plant::add_boot(slave, boot.record, now);
    const BusStatisticsView* const figures = traffic == nullptr ? nullptr : traffic->figures(boot.slave.bus);
    add_figures(slave, figures, boot.slave.node_id, now);
    add_nmt_state(slave, figures, boot.slave.node_id, now);
    if (boots != nullptr && has_compared_identity(*boots, boot)) slave["identity"] = "as expected";
    state["slaves"].push_back(std::move(slave));
  }
  state["outside"] = Fields::array();
  if (traffic != nullptr) add_outside(state, plant, *traffic, now);
  state["modules"] = Fields::array();
  const std::vector<plant::ModuleStatus> modules = plant.modules();
  for (std::size_t i = 0; i < modules.size(); ++i)
    state["modules"].push_back(module_fields(modules[i], plant.module(i)));
  state["programs"] = programs_of(plant);
  state["troubles"] = Fields::array();
  for (const plant::ModuleTrouble& trouble : plant.troubles()) {
    Fields fields = label_fields(trouble.module);
    fields["message"] = trouble.text;
    state["troubles"].push_back(std::move(fields));
  }
  state["forced"] = Fields::array();
  for (const plant::ForcedObject& forced : plant.forced()) {
    Fields fields = label_fields(forced.device);
    fields["object"] = forced.object;
    fields["text"] = describe_value(forced);
    state["forced"].push_back(std::move(fields));
  }
  return text::printable_json(state.dump());
}

}  // namespace canopus::web
