#include "canopus/plant/plant.hpp"

#include <algorithm>
#include <utility>

#include "canopus/module/interface/event_records.hpp"
#include "canopus/plant/plant_parts.hpp"
#include "canopus/plant/slave_boot.hpp"

namespace canopus::plant {

Plant::Plant() : parts_(std::make_unique<Parts>()) {}
Plant::~Plant() {
  for (const auto& execution : parts_->executions)
    if (execution != nullptr) execution->save_retained();
}

std::expected<std::unique_ptr<Plant>, std::vector<text::FileError>> Plant::build(
    PlantFile file, PlantObserver& observer, std::optional<std::uint64_t> seed, BusOpener* opener) {
  std::unique_ptr<Plant> plant(new Plant);
  const std::uint64_t file_seed = file.seed;
  plant->parts_->file = std::move(file);
  auto errors = assemble(*plant->parts_, observer, seed.value_or(file_seed), opener);
  if (!errors.empty()) {
    std::ranges::stable_sort(errors, {}, &text::FileError::place);
    return std::unexpected(std::move(errors));
  }
  std::ranges::stable_sort(plant->parts_->warnings, {}, &text::FileWarning::place);
  return plant;
}

std::vector<text::FileError> Plant::open_stores() { return parts_->stores->open(); }

void Plant::power_on() {
  const can::Time now = parts_->timeline.now();
  for (std::size_t i = 0; i < parts_->devices.size(); ++i) {
    parts_->devices[i]->power_on(now);
  }
  for (std::size_t i = 0; i < parts_->racks.size(); ++i) {
    parts_->racks[i]->power_on(now,
                               parts_->file.plcs[i].run ? module::CpuState::run : module::CpuState::stop);
  }
  for (std::size_t i = 0; i < parts_->cpu_errors.size(); ++i) {
    parts_->cpu_errors[i]->powered(now);
  }
}

can::Timeline& Plant::timeline() noexcept { return parts_->timeline; }
can::Timeline& Plant::timeline_of_bus(std::size_t number) noexcept {
  return parts_->timeline_of(parts_->division.buses[number]);
}
PlantObserver& Plant::observer_of_bus(std::size_t number) noexcept {
  return *parts_->events[parts_->division.buses[number]];
}
void Plant::parts_met(can::Time now) {
  parts_->timeline.join_partitions(now);
  DeferredEvents::release(parts_->events);
}
const std::string& Plant::name() const noexcept { return parts_->file.name; }
const PlantFile& Plant::file() const noexcept { return parts_->file; }
const std::vector<text::FileWarning>& Plant::warnings() const noexcept { return parts_->warnings; }
std::size_t Plant::bus_count() const noexcept { return parts_->buses.size(); }
can::Bus& Plant::bus(std::size_t number) noexcept { return *parts_->buses[number]; }
sim::Bus* Plant::simulated_bus(std::size_t number) noexcept { return parts_->simulated[number]; }
const BusSection& Plant::bus_section(std::size_t number) const noexcept { return parts_->file.buses[number]; }
std::size_t Plant::plc_count() const noexcept { return parts_->racks.size(); }
plc::Rack& Plant::rack(std::size_t number) noexcept { return *parts_->racks[number]; }
plc::ProgramExecution* Plant::program(std::size_t plc) noexcept { return parts_->executions[plc].get(); }
const PlcSection& Plant::plc_section(std::size_t number) const noexcept { return parts_->file.plcs[number]; }
const std::vector<std::string>& Plant::connections() const noexcept { return parts_->connections; }

std::size_t Plant::device_count() const noexcept { return parts_->devices.size(); }
DeviceOnBus& Plant::device(std::size_t number) noexcept { return *parts_->devices[number]; }

std::size_t Plant::lift_count() const noexcept { return parts_->lifts.size(); }
LiftOnBus& Plant::lift(std::size_t number) noexcept { return *parts_->lifts[number]; }

std::vector<ForcedObject> Plant::forced() const {
  std::vector<ForcedObject> all;
  for (const auto& seat : parts_->devices) {
    for (const sim::Forcing::Force& force : seat->device().forced()) {
      all.push_back(seat->forced_object(force.entry, force.until));
    }
  }
  return all;
}

bool Plant::has_stalled() const noexcept { return parts_->has_stalled; }

std::vector<NodeStatus> Plant::nodes() const {
  std::vector<NodeStatus> all;
  const auto is_cut_off = [this](const can::Port& port) {
    return std::ranges::any_of(parts_->simulated,
                               [&](const sim::Bus* bus) { return bus != nullptr && bus->is_cut_off(port); });
  };
  const auto add = [&](const NodeStatus& status, const can::Port& port) {
    NodeStatus& node = all.emplace_back(status);
    node.is_cut_off = node.is_on && is_cut_off(port);
    node.frames = port.counters().transmitted;
    node.waiting = port.waiting();
    node.error_state = port.error_state();
    node.transmit_errors = port.transmit_error_counter();
    node.receive_errors = port.receive_error_counter();
  };
  for (std::size_t i = 0; i < parts_->modules.size(); ++i) {
    add(parts_->modules[i]->status(), *parts_->module_ports[i]);
  }
  for (std::size_t i = 0; i < parts_->devices.size(); ++i) {
    add(parts_->devices[i]->status(), *parts_->device_ports[i]);
  }
  return all;
}

std::vector<ModuleStatus> Plant::modules() const {
  std::vector<ModuleStatus> all;
  for (const auto& seat : parts_->modules) all.push_back(seat->module_status(parts_->timeline.now()));
  return all;
}

module::CommunicationModule& Plant::module(std::size_t number) noexcept {
  return parts_->modules[number]->module();
}

const ModuleSection& Plant::module_section(std::size_t number) const noexcept {
  return parts_->modules[number]->section();
}

std::vector<module::ModuleErrorRecord> Plant::module_errors(std::size_t module) const {
  return parts_->modules[module]->module().module_errors();
}

std::vector<SlaveBoot> Plant::boots() const {
  std::vector<SlaveBoot> all;
  for (const auto& seat : parts_->modules) seat->collect_boots(all);
  return all;
}

std::vector<ModuleTrouble> Plant::troubles() const {
  std::vector<ModuleTrouble> all;
  for (const auto& seat : parts_->modules) {
    if (auto trouble = seat->trouble(parts_->timeline.now())) all.push_back(std::move(*trouble));
  }
  return all;
}

}  // namespace canopus::plant
