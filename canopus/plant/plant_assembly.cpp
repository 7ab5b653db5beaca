#include "canopus/plant/plant_assembly.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/hex.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/device_script.hpp"
#include "canopus/plant/volatile_memory.hpp"
#include "canopus/sim/drive/servo.hpp"
#include "canopus/store/file_memory.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::plant {

namespace {

/// 1010H takes the command to save, or the device saves by itself (bit 1) [CiA 301 7.5.2.13].
bool can_save(const canopen::DictionaryDescription& dictionary) {
  const canopen::ObjectDescription* save = dictionary.find(0x1010);
  if (save == nullptr) return false;
  for (unsigned sub = 1; sub <= save->highest_sub; ++sub) {
    const canopen::Entry entry = dictionary.find(*save, static_cast<std::uint8_t>(sub));
    if (entry && canopen::is_writable(entry.description->access)) return true;
  }
  constexpr std::uint64_t autonomously = 2;
  return (eds::default_value(dictionary, 0x1010, 1, 1).value_or(0) & autonomously) != 0;
}

}  // namespace

std::vector<text::FileError> Assembly::run() {
  divide();
  for (const BusSection& section : parts_.file.buses) add_bus(section);
  for (const BridgeSection& section : parts_.file.bridges) add_bridge(section);
  for (std::size_t i = 0; i < parts_.file.lifts.size(); ++i) {
    sim::lift::BuildingSettings settings = parts_.file.lifts[i].building;
    if (!parts_.file.lifts[i].own_seed) settings.passengers.seed = seed_ * 1'000'003 + i;
    const std::string_view bus = parts_.file.lifts[i].bus;
    parts_.lifts.push_back(std::make_unique<LiftOnBus>(parts_.file.lifts[i], std::move(settings),
                                                       timeline_of(bus), observer_of(bus)));
  }
  for (std::size_t i = 0; i < parts_.file.devices.size(); ++i) {
    const std::size_t before = parts_.devices.size();
    if (parts_.file.devices[i].usable) add_device(parts_.file.devices[i], i);
    complete_ = complete_ && parts_.devices.size() > before;
  }
  for (std::size_t i = 0; i < parts_.file.plcs.size(); ++i) {
    can::Timeline& timeline = parts_.timeline_of(parts_.division.racks[i]);
    add_rack(parts_.file.plcs[i], i);
    for (const ModuleSection& module : parts_.file.plcs[i].modules) {
      complete_ = complete_ && module.usable;
      if (module.usable) add_module(parts_.file.plcs[i], i, module);
    }
    if (const auto after = parts_.file.plcs[i].cpu_error) {
      parts_.cpu_errors.push_back(std::make_unique<CpuErrorTimer>(*parts_.racks[i], *after));
      timeline.add(*parts_.cpu_errors.back(), "CPU of " + parts_.file.plcs[i].name);
    }
  }
  for (std::size_t i = 0; i < parts_.modules.size(); ++i) {
    add_parameters(parts_.modules[i]->section(), module_plcs_[i], parts_.modules[i]->module());
  }
  for (const auto& seat : parts_.modules) add_download(*seat);
  for (const auto& master : parts_.modules) {
    if (master->section().master) configure_network(master->section(), master->module());
  }
  stores_.review(errors_, parts_.warnings);
  if (complete_ && errors_.empty()) review_buses();
  for (std::size_t i = 0; i < parts_.buses.size(); ++i) {
    if (parts_.simulated[i] != nullptr) set_faults(parts_.file.buses[i], *parts_.simulated[i]);
    set_line(parts_.file.buses[i], parts_.simulated[i]);
  }
  for (const auto& bus : parts_.buses) {
    parts_.load_reports.push_back(std::make_unique<LoadReport>(*bus, observer_of(bus->name())));
    timeline_of(bus->name()).add(*parts_.load_reports.back(), "load report");
  }
  return errors_.release();
}

void Assembly::add_bus(const BusSection& section) {
  std::unique_ptr<can::Bus> bus;
  std::error_code unknown;
  if (opener_ == nullptr && !section.replay.empty() &&
      !std::filesystem::exists(folder_ / section.replay, unknown)) {
    errors_.add(section.link_place, "link = \"{}\": there is no such file", section.link);
  }
  if (opener_ != nullptr && section.is_linked()) {
    auto opened = opener_->open(section, timeline_of(section.name));
    if (opened) {
      bus = std::move(*opened);
    } else {
      errors_.add(section.link_place, "{}: {}",
                  section.link_by_option ? "--bus " + section.link : "link = \"" + section.link + "\"",
                  opened.error());
    }
  }
  sim::Bus* simulated = nullptr;
  if (bus == nullptr) {
    auto made = std::make_unique<sim::Bus>(section.name, section.bit_rate, timeline_of(section.name));
    simulated = made.get();
    bus = std::move(made);
  }
  parts_.simulated.push_back(simulated);
  parts_.buses.push_back(std::move(bus));
  parts_.watches.push_back(
      std::make_unique<NodeRegistry>(section.name, section.bit_rate, observer_of(section.name)));
  parts_.buses.back()->add_observer(*parts_.watches.back());
}

void Assembly::add_bridge(const BridgeSection& section) {
  if (!section.usable) return;
  parts_.bridges.push_back(std::make_unique<BusBridge>(parts_.bus(section.from), parts_.bus(section.to),
                                                       section, timeline_of(section.from),
                                                       observer_of(section.from)));
}

Assembly::File Assembly::load(const std::string& eds, text::Place place) {
  const std::string path = (folder_ / eds).lexically_normal().string();
  if (const auto known = files_.find(path); known != files_.end()) return known->second;
  const auto text = text::read_file(path);
  if (!text) {
    errors_.add(place, "eds = \"{}\": {}", eds, text.error());
    return files_[path] = nullptr;
  }
  const eds::ReadResult result = eds::read_device_file(*text);
  if (!result.file) {
    const eds::Problem& problem = result.problems.front();
    errors_.add(place, "eds = \"{}\": no device can be made of it: {}:{}: {}", eds, path, problem.line,
                problem.message);
  }
  return files_[path] = result.file;
}

Assembly::File Assembly::configured(const File& file, const DeviceSection& section) {
  std::vector<canopen::DictionaryDescription::Change> changes;
  for (const text::ObjectSetting& setting : section.objects) {
    const canopen::Entry entry = file->dictionary->find(setting.object.index, setting.object.sub);
    if (!entry) {
      errors_.add(setting.place, "{} has no object {}", section.eds,
                  canopen::object_text(setting.object.index, setting.object.sub));
      continue;
    }
    auto bytes = text::encode(setting.value, entry.description->type);
    if (!bytes) {
      errors_.add(setting.place, "{}: {}", canopen::object_text(setting.object.index, setting.object.sub),
                  bytes.error());
      continue;
    }
    changes.push_back({entry, std::move(*bytes)});
  }
  if (changes.empty()) return file;
  // Devices of one file with the same values are one description; others share all but the values.
  std::string key = fmt::format("{}\n", static_cast<const void*>(file.get()));
  for (const auto& [entry, value] : changes) {
    key += canopen::object_text(entry.index, entry.sub) + '=' + ascii::hex_bytes(value) + '\n';
  }
  File& known = configured_[key];
  if (known == nullptr) {
    auto copy = std::make_shared<eds::DeviceFile>(*file);
    copy->dictionary = file->dictionary->with(changes);
    known = std::move(copy);
  }
  return known;
}

/// 0 after an error.
std::uint8_t Assembly::node_id(const DeviceSection& section, const eds::DeviceFile& file) {
  std::uint8_t node_id = section.node;
  if (node_id == 0 && file.commissioning) node_id = file.commissioning->node_id.value_or(0);
  if (node_id == 0) {
    errors_.add(section.place,
                "device: node is missing; {} names no node-ID either. A device that gets it by LSS: node = "
                "\"unconfigured\"",
                section.eds);
  } else if (node_id != lss::unconfigured && !nodes_.emplace(section.bus, node_id).second) {
    errors_.add(section.place, "device: node {} of bus \"{}\" is taken already", node_id, section.bus);
    return 0;
  }
  return node_id;
}

can::Port& Assembly::add_port(const DeviceSection& section, std::uint8_t node_id, std::size_t number) {
  const bool is_unconfigured = node_id == lss::unconfigured;
  can::Port& port = parts_.bus(section.bus)
                        .add_port(!section.name.empty() ? section.name
                                  : is_unconfigured     ? fmt::format("device{}", number + 1)
                                                        : fmt::format("node{}", node_id));
  port.set_transmit_queue(section.transmit_fifo ? can::TransmitOrder::fifo : can::TransmitOrder::identifier,
                          section.transmit_queue);
  if (section.bit_rate != 0) port.restart(section.bit_rate);
  port.set_listen_only(section.listen_only);
  return port;
}

/// Gives a device its non-volatile memory, for 1010H and LSS, named by its factory node-ID, or if that is
/// none, by its LSS address.
void Assembly::give_memory(const DeviceSection& section, std::uint8_t node_id, DeviceOnBus& seat) {
  const eds::DeviceFile& file = seat.device().file();
  const bool is_unconfigured = node_id == lss::unconfigured;
  const bool is_lss_slave = section.lss.value_or(is_unconfigured || file.device.lss);
  if (section.store.empty()) {
    if (is_lss_slave) seat.enable_lss(nullptr);
    return;
  }
  if (!is_lss_slave && !can_save(*file.dictionary)) {
    warn(section.store_place,
         "store = \"{}\": {} has no 1010H that can be written, and is no LSS slave: the device never stores "
         "anything",
         section.store, section.eds);
  }
  std::string unit = fmt::format("node-{:03}", node_id);
  if (is_unconfigured) {
    const eds::Identity identity = eds::identity(file);
    unit = fmt::format("{:08X}-{:08X}-{:08X}-{:08X}", identity.vendor_id.value_or(0),
                       identity.product_code.value_or(0), identity.revision.value_or(0),
                       identity.serial_number.value_or(0));
  }
  const StoredAs stored = stores_.claim(section, unit, errors_);
  const auto file_named = [&](const std::string& name) {
    return std::make_unique<store::ParameterFile>(stored.folder, name, stored.owner);
  };
  if (is_lss_slave) seat.enable_lss(file_named(stored.name + ".lss"));
  seat.set_store(file_named(stored.name));
}

void Assembly::give_drive(const DriveSection& section, DeviceOnBus& seat) {
  sim::Device& device = seat.device();
  sim::ServoSettings settings{.start = section.start,
                              .low_switch = section.low_switch,
                              .high_switch = section.high_switch,
                              .revolution = section.revolution,
                              .faults = {}};
  for (const DriveSection::Fault& fault : section.faults) {
    settings.faults.push_back({can::Time{} + fault.at, fault.code});
  }
  auto servo = sim::Servo::make(*device.file().dictionary, std::move(settings));
  if (!servo) return errors_.add(section.place, "drive: {}", servo.error());
  (*servo)->set_standstill_report(
      [&seat](std::string_view reason, can::Time now) { seat.warn(reason, now); });
  device.set_application(std::move(*servo));
}

void Assembly::move_values(const DeviceSection& section, std::size_t number, DeviceOnBus& seat) {
  for (std::size_t i = 0; i < section.behaviours.size(); ++i) {
    const BehaviourSection& wanted = section.behaviours[i];
    sim::Behaviour behaviour;
    behaviour.kind = sim::behaviour_kind(wanted.kind).value_or(sim::Behaviour::Kind::constant);
    behaviour.index = wanted.object.index;
    behaviour.sub = wanted.object.sub;
    behaviour.low = wanted.low.value_or(0);
    behaviour.high = wanted.high.value_or(behaviour.low + 100);
    behaviour.period = wanted.period.value_or(behaviour.period);
    behaviour.step = wanted.step.value_or(1);
    behaviour.seed = wanted.seed.value_or(seed_ * 1'000'003 + number * 1009 + i);
    if (wanted.source) {
      behaviour.source_index = wanted.source->index;
      behaviour.source_sub = wanted.source->sub;
    }
    if (const auto problem = seat.device().add_behaviour(behaviour))
      errors_.add(wanted.place, "behaviour: {}", *problem);
  }
}

void Assembly::play_back(const PlaybackSection& section, sim::Device& device) {
  const std::string path = (folder_ / section.file).lexically_normal().string();
  const auto wrong = [&](std::string_view what) {
    errors_.add(section.file_place, "playback: file = \"{}\": {}", section.file, what);
  };
  const CsvLimits limits;
  std::error_code unknown;
  if (const auto size = std::filesystem::file_size(path, unknown); !unknown && size > limits.bytes) {
    return wrong(fmt::format("the file has {} bytes; expected at most {}", size, limits.bytes));
  }
  const auto text = text::read_file_or_reason(path);
  if (!text) return wrong(text.error());
  auto playback = read_playback_csv(*text, device, limits);
  if (!playback) {
    const CsvProblem& problem = playback.error();
    return wrong(fmt::format("{}:{}:{}: {}", path, problem.line, problem.column, problem.message));
  }
  if (section.repeat && playback->rows() < 2)
    return wrong("repeat = true needs two rows, which give it a length");
  if (section.repeat) playback->repeat();
  if (const auto problem = device.add_playback(std::move(*playback))) wrong(*problem);
}

void Assembly::add_device(const DeviceSection& section, std::size_t number) {
  File file = section.lift ? parts_.lifts[section.lift->lift]->device_file(section.lift->unit)
                           : load(section.eds, section.eds_place);
  if (!file) return;
  const std::uint8_t node = node_id(section, *file);
  if (node == 0) return;
  file = configured(file, section);
  can::Bus& bus = parts_.bus(section.bus);
  can::Port& port = add_port(section, node, number);
  auto seat = std::make_unique<DeviceOnBus>(file, section, node, port, observer_of(section.bus));
  give_memory(section, node, *seat);
  if (section.drive) give_drive(*section.drive, *seat);
  move_values(section, number, *seat);
  for (const PlaybackSection& playback : section.playbacks) play_back(playback, seat->device());
  errors_.add(add_scripts(seat->device(), section.scripts));
  timeline_of(section.bus).add(*seat);
  if (section.lift) parts_.lifts[section.lift->lift]->add_unit(*seat);
  port.connect(*seat);
  watch(bus).add_node(seat->status(), port);
  seat->set_watch(watch(bus));
  device_sections_.emplace_back(&section, seat.get());
  parts_.devices.push_back(std::move(seat));
  parts_.device_ports.push_back(&port);
}

NodeRegistry& Assembly::watch(const can::Bus& bus) {
  const auto found = std::ranges::find(parts_.buses, &bus, [](const auto& owned) { return owned.get(); });
  return *parts_.watches[static_cast<std::size_t>(found - parts_.buses.begin())];
}

void Assembly::set_faults(const BusSection& section, sim::Bus& bus) {
  if (!complete_) return;  // a port may be missing
  std::vector<sim::Fault> faults;
  for (const FaultSection& fault : section.faults) {
    if (const auto good = bus.set_faults({fault.fault}, seed_); !good)
      errors_.add(fault.place, "fault: {}", good.error());
    faults.push_back(fault.fault);
  }
  (void)bus.set_faults(faults, seed_);
}

void Assembly::add_module(const PlcSection& plc, std::size_t plc_number, const ModuleSection& section) {
  can::Bus& bus = parts_.bus(section.bus);
  can::Port& port = bus.add_port(shown_name(section));
  const CatalogueEntry& entry = *find_module(section.model);
  std::unique_ptr<module::NonVolatileMemory> memory;
  if (plc.store.empty()) {
    memory = std::make_unique<VolatileMemory>();
  } else {
    const StoredAs stored = stores_.claim(plc, section, entry.stored, errors_);
    memory = std::make_unique<store::FileMemory>(stored.folder, stored.owner);
  }
  auto made = entry.make(port, *memory, {.restart_time = section.restart_time});
  auto seat = std::make_unique<ModuleInRack>(section, plc.name, *parts_.racks[plc_number], std::move(memory),
                                             std::move(made), watch(bus), observer_of(section.bus));
  module::CommunicationModule& module = seat->module();
  const auto bus_section = std::ranges::find(parts_.file.buses, section.bus, &BusSection::name);
  if (entry.download != nullptr)
    (void)entry.download(module, module_parameters(*entry.data_sheet, section, *bus_section), {});
  errors_.add(preset_words(module, *entry.data_sheet, section, *bus_section));
  errors_.add(preset_objects(module, section));
  errors_.add(give_parameters(module, section));
  timeline_of(section.bus).add(*seat, fmt::format("{} on {}", port.name(), bus.name()));
  port.connect(*seat);
  if (!parts_.racks[plc_number]->insert(section.head, module)) {
    errors_.add(section.place, "module: head {:03X}H overlaps another module's points", section.head);
  }
  seat->status().label.node_id = section.node;
  watch(bus).add_node(seat->status(), port);
  module_sections_.emplace_back(&section, seat.get());
  parts_.modules.push_back(std::move(seat));
  module_plcs_.push_back(plc_number);
  parts_.module_ports.push_back(&port);
}

std::vector<text::FileError> assemble(Plant::Parts& parts, PlantObserver& observer, std::uint64_t seed,
                                      BusOpener* opener) {
  return Assembly(parts, observer, seed, opener).run();
}

}  // namespace canopus::plant
