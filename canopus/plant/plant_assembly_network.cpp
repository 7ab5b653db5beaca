// Relations between nodes of one bus: slaves of a module, and checks across all nodes.

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "canopus/plant/plant_assembly.hpp"
#include "canopus/plant/plant_review.hpp"

namespace canopus::plant {

/// Checks how the nodes of each bus fit together.
// One bus after the other: each node's dictionary is made for it.
void Assembly::review_buses() {
  for (const BusSection& section : parts_.file.buses) {
    ReviewedBus bus{
        .name = section.name, .bit_rate = section.bit_rate, .may_have_others = section.may_have_others()};
    for (const auto& [module_section, seat] : module_sections_) {
      if (module_section->bus != section.name) continue;
      if (auto node = seat->module().initial_node()) {
        bus.configured.insert(node->configures.begin(), node->configures.end());
        bus.nodes.push_back(reviewed(*module_section, seat->status().label.name, std::move(*node)));
      } else {
        bus.has_plain_can = true;
      }
    }
    for (const auto& [device_section, seat] : device_sections_) {
      if (device_section->bus == section.name) bus.nodes.push_back(reviewed(*device_section, *seat));
    }
    find_line_troubles(section, parts_.warnings);
    review(bus, parts_.warnings);
  }
}

/// The slave that a node of the plant is for this master.
std::optional<Assembly::WantedSlave> Assembly::wanted_slave(const ModuleSection& master,
                                                            const NodeLabel& node) {
  if (node.bus != master.bus || node.node_id == 0 || node.node_id == lss::unconfigured) return std::nullopt;
  const auto written = std::ranges::find_if(master.slaves, [&](const SlaveSection& slave) {
    return slave.node != 0 ? slave.node == node.node_id : slave.name == node.name;
  });
  if (written != master.slaves.end()) {
    WantedSlave wanted{.slave = *written, .written = &*written};
    wanted.slave.node = node.node_id;
    return wanted;
  }
  if (!master.all_slaves) return std::nullopt;
  WantedSlave wanted{.slave = {.place = master.place, .node = node.node_id}};
  wanted.slave.receive.push_back({.place = master.place, .pdo = 1});
  wanted.slave.send.push_back({.place = master.place, .pdo = 1});
  return wanted;
}

/// In the plant file's order, devices first, so that the words come in this order too.
void Assembly::configure_network(const ModuleSection& section, module::CommunicationModule& module) {
  const std::string slot = fmt::format("U{:X}", section.head / 16);
  ModuleNetwork network(module, section.name.empty() ? slot : section.name + ' ' + slot);
  std::set<const SlaveSection*> found;
  const auto add = [&](const WantedSlave& wanted, const SlaveDescription& description) {
    found.insert(wanted.written);
    if (!wanted.slave.usable) return;
    errors_.add(network.add_slave(wanted.slave, description, wanted.written != nullptr));
  };
  for (const auto& seat : parts_.devices) {
    const NodeLabel& label = seat->status().label;
    if (label.bus == section.bus && label.node_id == lss::unconfigured && section.all_slaves) {
      warn(section.slaves_place, "slaves = \"all\" leaves out {}, which has no node-ID yet",
           label.name.empty() ? "a device" : fmt::format("\"{}\"", label.name));
    }
    if (const auto wanted = wanted_slave(section, label)) {
      add(*wanted, SlaveDescription::of(seat->device().file(), label.node_id, label.name));
    }
  }
  for (const auto& seat : parts_.modules) {
    const NodeLabel& label = seat->status().label;
    const auto wanted = wanted_slave(section, label);
    if (!wanted || &seat->module() == &module) continue;
    const bool is_node = seat->module().presets_canopen_mode();
    if (wanted->written == nullptr && (!is_node || seat->section().master)) continue;
    if (!is_node) {
      errors_.add(wanted->slave.place,
                  "slave: the module with node {} (line {}) is in a Layer 2 mode; expected a CANopen node",
                  label.node_id, seat->section().place.line);
    }
    add(*wanted, SlaveDescription::of(seat->module(), label.node_id, label.name));
  }
  for (const SlaveSection& slave : section.slaves) {
    if (complete_ && slave.usable && !found.contains(&slave)) add_outside_slave(section, slave, network);
  }
  network.become_master();
  (void)preset_objects(module, section);  // the plant file overrides
  for (const std::string& line : network.connections()) parts_.connections.push_back(line);
  for (const std::string& line : network.left_out()) {
    warn(section.slaves_place, "slaves = \"all\" {}", line);
  }
}

const canopen::DictionaryDescription* Assembly::dictionary_of(const ModuleSection& section,
                                                              const WantedNode& node) {
  if (!node.eds.empty()) {
    const File file = load(node.eds, node.eds_place);
    return file ? file->dictionary.get() : nullptr;
  }
  for (const auto& seat : parts_.devices) {
    const NodeLabel& label = seat->status().label;
    if (label.bus == section.bus && label.node_id == node.node) return seat->device().file().dictionary.get();
  }
  for (const auto& seat : parts_.modules) {
    const NodeLabel& label = seat->status().label;
    if (label.bus != section.bus || label.node_id != node.node) continue;
    return &seat->module().node().dictionary().description();
  }
  errors_.add(node.place,
              "{}: there is no device or module with node = {} on bus \"{}\"; expected eds = its file",
              node.what, node.node, section.bus);
  return nullptr;
}

void Assembly::add_parameters(const ModuleSection& section, std::size_t plc_number,
                              module::CommunicationModule& module) {
  if (!section.parameters || !module.takes_parameters()) return;
  for (const ParametersSection::Node& node : section.parameters->nodes) {
    if (node.node == section.node) {
      errors_.add(node.place,
                  "parameters: node {} is the module itself; expected its objects in [plc.module.parameters]",
                  node.node);
      continue;
    }
    const auto* dictionary =
        dictionary_of(section, {node.place, node.node, node.eds, node.eds_place, "parameters"});
    if (!dictionary) continue;
    if (module.parameter_concise_dcf(node.node, concise_dcf_of(node, *dictionary, errors_))) continue;
    errors_.add(
        node.place,
        "parameters: node {}: the {} has no room for its settings: too many nodes, or too much of one",
        node.node, section.model);
  }
  if (!section.parameters->refresh) return;
  const module::DataExchangeLayout& words = module.program_interface().process_data;
  std::vector<plc::ModuleRefresh::Block> blocks;
  bool sends = false, receives = false;
  for (const ParametersSection::Block& block : section.parameters->blocks) {
    const bool to_module = block.address >= words.transmit_first;
    sends = sends || to_module;
    receives = receives || !to_module;
    blocks.push_back({block.address, block.device, block.number, to_module});
    if (!block.device && to_module) {
      warn(block.place,
           "refresh: G{} = \"label\": programs alone can write a module label, and here is none: these words "
           "of the TPDOs stay 0",
           block.address);
    }
  }
  if (!sends || !receives) {
    warn(section.parameters->refresh_place,
         "refresh has no block of {}: the module exchanges no process data at all without one in each "
         "direction",
         receives ? "the TPDOs" : "the RPDOs");
  }
  plc::ModuleRefresh::Timing timing;
  if (const auto group = section.parameters->refresh_group) {
    timing.at_end = false;
    for (const ProgramSection& program : parts_.file.plcs[plc_number].programs) {
      if (program.refresh_group != *group) continue;
      if (program.interval) timing.intervals.push_back(*program.interval);
      timing.each_scan = timing.each_scan || !program.interval;
    }
    if (!timing.each_scan && timing.intervals.empty()) {
      warn(section.parameters->refresh_group_place,
           "refresh_group = {}: no [[plc.program]] of this PLC has it: the module exchanges no process data "
           "at "
           "all",
           *group);
    }
  }
  parts_.refreshes.push_back(std::make_unique<plc::ModuleRefresh>(
      *parts_.racks[plc_number], timeline_of(section.bus), section.head, module, std::move(blocks),
      std::move(timing), "refresh of " + shown_name(section)));
}

/// A node that joins the bus from outside, or gets its node-ID by LSS.
void Assembly::add_outside_slave(const ModuleSection& master, const SlaveSection& slave,
                                 ModuleNetwork& network) {
  const auto bus = std::ranges::find(parts_.file.buses, master.bus, &BusSection::name);
  const bool may_come = bus->may_have_others() || std::ranges::any_of(parts_.devices, [&](const auto& seat) {
                          const NodeLabel& label = seat->status().label;
                          return label.bus == master.bus && label.node_id == lss::unconfigured;
                        });
  if (!may_come) {
    return errors_.add(slave.place,
                       "slave: there is no device or module with node = {} on bus \"{}\"; for a node outside "
                       "of the plant the bus needs serve or link",
                       slave.node, master.bus);
  }
  SlaveDescription description;
  if (!slave.eds.empty()) {
    const File file = load(slave.eds, slave.eds_place);
    if (!file) return;
    description = SlaveDescription::of(*file, slave.node, "external node");
  }
  errors_.add(network.add_slave(slave, description, true));
}

/// Applies the bus length and the node positions of the plant file.
void Assembly::set_line(const BusSection& section, sim::Bus* bus) {
  if (!section.line || !section.line->is_exact || !complete_) return;
  const LineSection& line = *section.line;
  if (bus == nullptr) {
    return errors_.add(line.place,
                       "exact = true: only a simulated bus has a length; bus \"{}\" is a real one",
                       section.name);
  }
  sim::Line wanted{.length = line.length,
                   .stub = line.stub,
                   .nanoseconds_per_metre = line.nanoseconds_per_metre,
                   .transceiver_delay = line.transceiver_delay,
                   .clock_ppm = line.clock_ppm,
                   .timing = line.timing};
  const std::vector<const can::Port*> ports = bus->ports();
  for (const LineSection::Node& node : line.nodes) {
    if (std::ranges::find(ports, node.node.port, &can::Port::name) == ports.end()) {
      errors_.add(node.place, "node: no port \"{}\" on bus \"{}\"", node.node.port, section.name);
    }
    wanted.nodes.push_back(node.node);
  }
  bus->set_line(wanted);
}

}  // namespace canopus::plant
