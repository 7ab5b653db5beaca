#include "canopus/app/plant.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <span>
#include <sstream>

#include <fmt/format.h>

#include "canopus/app/module_network.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/module/me3can1_q/me3can1_q.hpp"
#include "canopus/sim/device.hpp"
#include "canopus/store/file_memory.hpp"

namespace canopus::app {
namespace {

using module::me3can1_q::Me3can1Q;

/// Non-volatile memory that lasts as long as the run: a rack without a store folder.
class RunMemory final : public module::NonVolatileMemory {
 public:
  Content read(std::string_view name) override {
    const auto found = contents_.find(name);
    if (found == contents_.end()) return {};
    return {Content::State::good, found->second};
  }
  bool write(std::string_view name, std::span<const std::uint8_t> bytes) override {
    contents_.insert_or_assign(std::string(name), std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
    return true;
  }
  bool erase(std::string_view name) override {
    contents_.erase(std::string(name));
    return true;
  }

 private:
  std::map<std::string, std::vector<std::uint8_t>, std::less<>> contents_;
};

bool is_pdo(const can::Frame& frame) {
  return !frame.extended && !frame.remote && frame.identifier >= 0x180 && frame.identifier < 0x580;
}

/// A simulated device in its place on a bus.
class DeviceSeat final : public can::Participant {
 public:
  DeviceSeat(std::shared_ptr<const eds::DeviceFile> file, const DeviceSection& section, std::uint8_t node_id,
             sim::Port& port, PlantObserver& observer)
      : device_(std::move(file), node_id, port), start_(can::Time{} + section.start), observer_(observer) {
    const std::string& product = device_.file().device.product_name;
    name_ = !section.name.empty() ? section.name : product;
    status_.plate = {section.bus, name_, node_id};
  }

  sim::Device& device() noexcept { return device_; }
  NodeStatus& status() noexcept { return status_; }
  const NodeStatus& status() const noexcept { return status_; }

  void power_on(can::Time now) {
    if (now < start_) return;
    status_.is_on = true;
    device_.power_on(now);
    look(now);
  }
  void receive(const can::Frame& frame, can::Time now) override {
    if (!status_.is_on) return;
    device_.receive(frame, now);
    look(now);
  }
  void transmitted(const can::Frame& frame, can::Time now) override {
    if (is_pdo(frame)) ++status_.pdos;
    device_.transmitted(frame, now);
  }
  void controller_changed(can::Time now) override {
    device_.controller_changed(now);
    look(now);
  }
  void tick(can::Time now) override {
    if (!status_.is_on) return power_on(now);
    device_.tick(now);
    look(now);
  }
  can::Time deadline() const noexcept override { return status_.is_on ? device_.deadline() : start_; }

 private:
  void look(can::Time now) {
    if (device_.node().state() == status_.state) return;
    status_.state = device_.node().state();
    observer_.nmt_state_changed(status_.plate, status_.state, now);
  }

  sim::Device device_;
  std::string name_;
  NodeStatus status_;
  can::Time start_;
  PlantObserver& observer_;
};

/// A module in its slot, with the stand-in for the PLC program that asks for data exchanges.
class ModuleSeat final : public can::Participant, public module::ModuleObserver {
 public:
  ModuleSeat(const ModuleSection& section, std::string_view plc, sim::Port& port,
             std::unique_ptr<module::NonVolatileMemory> memory, module::me3can1_q::Profile profile,
             PlantObserver& observer)
      : section_(section),
        plc_(plc),
        memory_(std::move(memory)),
        module_(port, *memory_, std::move(profile)),
        observer_(observer) {
    name_ = fmt::format("{} U{:X}", section.model, section.head / 16);
    status_.is_module = true;
    status_.plate = {section.bus, name_, section.node};
    watched_.resize(section.watch.size());
    module_.set_observer(this);
  }

  Me3can1Q& module() noexcept { return module_; }
  NodeStatus& status() noexcept { return status_; }
  const NodeStatus& status() const noexcept { return status_; }

  /// The rack has switched the module on.
  void powered(can::Time now) {
    status_.is_on = true;
    if (section_.exchange) next_request_ = now + *section_.exchange;
    look(now);
  }

  void receive(const can::Frame& frame, can::Time now) override {
    module_.receive(frame, now);
    look(now);
  }
  void transmitted(const can::Frame& frame, can::Time now) override {
    if (is_pdo(frame)) ++status_.pdos;
    module_.transmitted(frame, now);
  }
  void controller_changed(can::Time now) override {
    module_.controller_changed(now);
    look(now);
  }
  void tick(can::Time now) override {
    if (module_.deadline() <= now) module_.tick(now);
    if (next_request_ <= now) run_program(now);
    look(now);
  }
  can::Time deadline() const noexcept override { return std::min(module_.deadline(), next_request_); }

  void signal_changed(module::SignalKind kind, unsigned number, bool on, can::Time now) override {
    const bool is_input = kind == module::SignalKind::input;
    if (number == exchange_signal && program_owns_exchange_) {  // the stand-in program's own are not news
      if (is_input && on) next_request_ = now;
      if (is_input && !on) program_owns_exchange_ = false;
      return;
    }
    observer_.signal_changed(plc_, is_input ? 'X' : 'Y', section_.head + number, on, now);
  }
  void buffer_written(std::uint32_t address, std::uint16_t value, can::Time now) override {
    observer_.buffer_changed(plc_, section_.head, address, value, true, now);
    for (std::size_t i = 0; i < watched_.size(); ++i) {
      if (section_.watch[i] == address) watched_[i] = value;
    }
  }
  void error_raised(std::string_view what, can::Time now) override { observer_.error(name_, what, now); }

 private:
  static constexpr unsigned exchange_signal = 0x01;

  /// Y01 ON; when X01 answers, Y01 OFF; again after the interval [ME3CAN1-Q 3.3.2].
  void run_program(can::Time now) {
    const auto is_on = [](std::uint32_t signals, unsigned number) { return ((signals >> number) & 1U) != 0; };
    if (program_requested_) {
      program_requested_ = false;
      module_.set_output(exchange_signal, false, now);
      next_request_ = std::max(requested_at_ + *section_.exchange, now + std::chrono::milliseconds(1));
      return;
    }
    const bool is_free = is_on(module_.inputs(), 0) && !is_on(module_.inputs(), exchange_signal) &&
                         !is_on(module_.outputs(), exchange_signal);
    if (!is_free) {  // not ready, or a client plays the program: look again later
      next_request_ = now + *section_.exchange;
      return;
    }
    requested_at_ = now;
    next_request_ = can::never;
    program_requested_ = program_owns_exchange_ = true;
    module_.set_output(exchange_signal, true, now);
  }

  void look(can::Time now) {
    status_.plate.node_id = module_.node().node_id();
    if (module_.node().state() != status_.state) {
      status_.state = module_.node().state();
      observer_.nmt_state_changed(status_.plate, status_.state, now);
    }
    for (std::size_t i = 0; i < watched_.size(); ++i) {
      const std::uint16_t value = module_.read_word(section_.watch[i], now);
      if (value == watched_[i]) continue;
      watched_[i] = value;
      observer_.buffer_changed(plc_, section_.head, section_.watch[i], value, false, now);
    }
  }

  ModuleSection section_;
  std::string_view plc_;
  std::string name_;
  std::unique_ptr<module::NonVolatileMemory> memory_;
  Me3can1Q module_;
  PlantObserver& observer_;
  NodeStatus status_;
  std::vector<std::uint16_t> watched_;
  can::Time next_request_ = can::never;
  can::Time requested_at_{};
  bool program_requested_ = false;      // Y01 is ON, X01 awaited
  bool program_owns_exchange_ = false;  // until X01 is OFF again
};

/// Reports what the nodes of a bus say of themselves, those outside of this process included.
class BusWatch final : public sim::BusObserver {
 public:
  BusWatch(std::string_view bus, PlantObserver& observer) : bus_(bus), observer_(observer) {}
  void know(NodeStatus& status) { known_[status.plate.node_id & 0x7F] = &status; }

  void frame_completed(const can::Frame& frame, can::Time /*start*/, can::Time end) override {
    if (frame.extended || frame.remote) return;
    const auto node_id = static_cast<std::uint8_t>(frame.identifier & 0x7F);
    if (node_id == 0) return;
    const std::uint32_t function = frame.identifier & 0x780;
    if (function == canopen::cob_id::error_control && frame.dlc == 1) {
      error_control(node_id, static_cast<std::uint8_t>(frame.data[0] & 0x7F), end);
    } else if (function == canopen::cob_id::emcy && frame.dlc == 8) {
      emergency(node_id, frame, end);
    }
  }

 private:
  void error_control(std::uint8_t node_id, std::uint8_t state, can::Time now) {
    if (state == 0) observer_.booted(plate(node_id), now);
    if (known_[node_id] != nullptr || foreign_states_[node_id] == state) return;
    foreign_states_[node_id] = state;
    if (state != 0) observer_.nmt_state_changed(plate(node_id), static_cast<canopen::NmtState>(state), now);
  }
  void emergency(std::uint8_t node_id, const can::Frame& frame, can::Time now) {
    canopen::Emergency message{.node_id = node_id};
    message.code = static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8);
    message.error_register = frame.data[2];
    std::copy_n(frame.data.begin() + 3, 5, message.manufacturer.begin());
    if (NodeStatus* status = known_[node_id]) {
      ++status->emergencies;
      status->last_emergency = message.code;
    }
    observer_.emergency(plate(node_id), message, now);
  }
  NodePlate plate(std::uint8_t node_id) const {
    return known_[node_id] != nullptr ? known_[node_id]->plate : NodePlate{bus_, {}, node_id};
  }

  std::string_view bus_;
  PlantObserver& observer_;
  std::array<NodeStatus*, 128> known_{};
  std::array<std::uint8_t, 128> foreign_states_{};
};

/// Reports the load of every bus once a second.
class LoadReport final : public can::Participant {
 public:
  LoadReport(std::vector<std::unique_ptr<sim::Bus>>& buses, PlantObserver& observer)
      : buses_(buses), observer_(observer) {}
  void receive(const can::Frame&, can::Time) override {}
  void tick(can::Time now) override {
    for (const auto& bus : buses_) observer_.load(bus->name(), bus->load(now), now);
    next_ += std::chrono::seconds(1);
  }
  can::Time deadline() const noexcept override { return next_; }

 private:
  std::vector<std::unique_ptr<sim::Bus>>& buses_;
  PlantObserver& observer_;
  can::Time next_ = can::Time{} + std::chrono::seconds(1);
};

}  // namespace

struct Plant::Parts {
  PlantFile file;
  can::Timeline timeline;
  std::vector<std::unique_ptr<sim::Bus>> buses;
  std::vector<std::unique_ptr<BusWatch>> watches;
  std::vector<std::unique_ptr<DeviceSeat>> devices;
  std::vector<can::Timeline::Handle> device_handles;
  std::vector<std::unique_ptr<ModuleSeat>> modules;
  std::vector<can::Timeline::Handle> module_handles;
  std::vector<std::unique_ptr<plc::Rack>> racks;
  std::unique_ptr<LoadReport> load_report;
  std::vector<std::string> connections;

  sim::Bus& bus(std::string_view name) {
    return **std::ranges::find_if(buses, [&](const auto& bus) { return bus->name() == name; });
  }
};

namespace {

/// Builds a plant's parts, collecting every error on the way.
class Assembly {
 public:
  Assembly(Plant::Parts& parts, PlantObserver& observer, std::uint64_t seed)
      : parts_(parts),
        observer_(observer),
        seed_(seed),
        folder_(std::filesystem::path(parts.file.path).parent_path()) {}

  std::vector<PlantError> run();

 private:
  using File = std::shared_ptr<const eds::DeviceFile>;

  template <typename... Arguments>
  void error(Place place, fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    errors_.push_back({place, fmt::format(text, std::forward<Arguments>(arguments)...)});
  }
  File load(const DeviceSection& section);
  File configured(const File& file, const DeviceSection& section);
  void add_device(const DeviceSection& section, std::size_t number);
  void add_module(const PlcSection& plc, std::size_t plc_number, const ModuleSection& section);
  void configure_network(const ModuleSection& section, Me3can1Q& module);
  void set_faults(const BusSection& section, sim::Bus& bus);
  DeviceSeat* device(std::string_view bus, std::uint8_t node);

  Plant::Parts& parts_;
  PlantObserver& observer_;
  std::uint64_t seed_;
  std::filesystem::path folder_;
  std::map<std::string, File> files_;
  std::vector<PlantError> errors_;
};

std::vector<PlantError> Assembly::run() {
  for (const BusSection& section : parts_.file.buses) {
    parts_.buses.push_back(std::make_unique<sim::Bus>(section.name, section.bit_rate, parts_.timeline));
    parts_.watches.push_back(std::make_unique<BusWatch>(section.name, observer_));
    parts_.buses.back()->add_observer(*parts_.watches.back());
  }
  for (std::size_t i = 0; i < parts_.file.devices.size(); ++i) add_device(parts_.file.devices[i], i);
  for (std::size_t i = 0; i < parts_.file.plcs.size(); ++i) {
    parts_.racks.push_back(std::make_unique<plc::Rack>(parts_.timeline));
    for (const ModuleSection& module : parts_.file.plcs[i].modules)
      add_module(parts_.file.plcs[i], i, module);
  }
  for (std::size_t i = 0; i < parts_.buses.size(); ++i) set_faults(parts_.file.buses[i], *parts_.buses[i]);
  parts_.load_report = std::make_unique<LoadReport>(parts_.buses, observer_);
  parts_.timeline.add(*parts_.load_report);
  return std::move(errors_);
}

Assembly::File Assembly::load(const DeviceSection& section) {
  const std::string path = (folder_ / section.eds).lexically_normal().string();
  if (const auto known = files_.find(path); known != files_.end()) return known->second;
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  if (!stream || !(text << stream.rdbuf())) {
    error(section.eds_place, "eds = \"{}\": cannot read {}: {}", section.eds, path, std::strerror(errno));
    return files_[path] = nullptr;
  }
  const eds::ReadResult result = eds::read_device_file(text.str());
  if (!result.file) {
    const eds::Problem& problem = result.problems.front();
    error(section.eds_place, "eds = \"{}\": no device can be made of it: {}:{}: {}", section.eds, path,
          problem.line, problem.message);
  }
  return files_[path] = result.file;
}

Assembly::File Assembly::configured(const File& file, const DeviceSection& section) {
  std::vector<canopen::DictionaryDescription::Change> changes;
  for (const ObjectSetting& setting : section.objects) {
    const canopen::Entry entry = file->dictionary->find(setting.object.index, setting.object.sub);
    if (!entry) {
      error(setting.place, "{} has no object {:04X}H:{:02X}H", section.eds, setting.object.index,
            setting.object.sub);
      continue;
    }
    auto bytes = encode(setting.value, entry.description->type);
    if (!bytes) {
      error(setting.place, "{:04X}H:{:02X}H: {}", setting.object.index, setting.object.sub, bytes.error());
      continue;
    }
    changes.push_back({entry, std::move(*bytes)});
  }
  if (changes.empty()) return file;
  auto copy = std::make_shared<eds::DeviceFile>(*file);
  copy->dictionary = file->dictionary->with(changes);
  return copy;
}

void Assembly::add_device(const DeviceSection& section, std::size_t number) {
  File file = load(section);
  if (!file) return;
  std::uint8_t node_id = section.node;
  if (node_id == 0 && file->commissioning && file->commissioning->node_id)
    node_id = *file->commissioning->node_id;
  if (node_id == 0) {
    return error(section.place, "device: node is missing; {} names no node-ID either", section.eds);
  }
  if (device(section.bus, node_id) != nullptr) {
    return error(section.place, "device: node {} of bus \"{}\" is taken already", node_id, section.bus);
  }
  file = configured(file, section);
  sim::Bus& bus = parts_.bus(section.bus);
  sim::Port& port = bus.add_port(section.name.empty() ? fmt::format("node{}", node_id) : section.name);
  port.set_transmit_queue(section.transmit_fifo ? sim::TransmitOrder::fifo : sim::TransmitOrder::identifier,
                          section.transmit_queue);
  if (section.bit_rate != 0) port.restart(section.bit_rate);
  port.set_listen_only(section.listen_only);
  auto seat = std::make_unique<DeviceSeat>(file, section, node_id, port, observer_);
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
    if (const auto problem = seat->device().add_behaviour(behaviour))
      error(wanted.place, "behaviour: {}", *problem);
  }
  parts_.device_handles.push_back(parts_.timeline.add(*seat));
  port.connect(*seat, parts_.device_handles.back());
  parts_
      .watches[static_cast<std::size_t>(
          std::ranges::find_if(parts_.buses, [&](const auto& b) { return b.get() == &bus; }) -
          parts_.buses.begin())]
      ->know(seat->status());
  parts_.devices.push_back(std::move(seat));
}

void Assembly::set_faults(const BusSection& section, sim::Bus& bus) {
  std::vector<sim::Fault> faults;
  for (const FaultSection& fault : section.faults) {
    if (const auto good = bus.set_faults({fault.fault}, seed_); !good)
      error(fault.place, "fault: {}", good.error());
    faults.push_back(fault.fault);
  }
  (void)bus.set_faults(faults, seed_);
}

DeviceSeat* Assembly::device(std::string_view bus, std::uint8_t node) {
  for (const auto& seat : parts_.devices) {
    if (seat->status().plate.bus == bus && seat->status().plate.node_id == node) return seat.get();
  }
  return nullptr;
}

void Assembly::add_module(const PlcSection& plc, std::size_t plc_number, const ModuleSection& section) {
  sim::Bus& bus = parts_.bus(section.bus);
  sim::Port& port = bus.add_port(fmt::format("{} U{:X}", section.model, section.head / 16));
  std::unique_ptr<module::NonVolatileMemory> memory;
  if (plc.store.empty()) {
    memory = std::make_unique<RunMemory>();
  } else {
    const std::filesystem::path path =
        folder_ / plc.store / fmt::format("U{:03X}-{}", section.head, section.model);
    memory = std::make_unique<store::FileMemory>(path);
  }
  module::me3can1_q::Profile profile;
  if (section.restart_time) profile.restart_time = *section.restart_time;
  auto seat = std::make_unique<ModuleSeat>(section, plc.name, port, std::move(memory), profile, observer_);
  Me3can1Q& module = seat->module();

  constexpr module::BufferAddress bit_rate_word = 24;
  constexpr module::BufferAddress node_address_word = 27;
  module.preset_buffer(bit_rate_word, static_cast<std::uint16_t>(bus.bit_rate() / 1000));
  if (section.node != 0) module.preset_buffer(node_address_word, section.node);
  for (const BufferSetting& setting : section.buffer) {
    if (!module.preset_buffer(setting.address, setting.value)) {
      error(setting.place, "G{} = {}: the {} does not take this value, or does not save this word",
            setting.address, setting.value, section.model);
    }
  }
  if (section.master) configure_network(section, module);
  for (const ObjectSetting& setting : section.objects) {
    const auto [index, sub] = setting.object;
    const canopen::Entry entry = module.node().dictionary().description().find(index, sub);
    if (!entry) {
      error(setting.place, "the {} has no object {:04X}H:{:02X}H", section.model, index, sub);
      continue;
    }
    const auto bytes = encode(setting.value, entry.description->type);
    if (!bytes) {
      error(setting.place, "{:04X}H:{:02X}H: {}", index, sub, bytes.error());
    } else if (const auto code = module.preset_object(index, sub, *bytes); code != canopen::AbortCode::none) {
      error(setting.place, "{:04X}H:{:02X}H: the {} refuses the value: {}", index, sub, section.model,
            canopen::describe(code));
    }
  }
  parts_.module_handles.push_back(parts_.timeline.add(*seat));
  port.connect(*seat, parts_.module_handles.back());
  if (!parts_.racks[plc_number]->insert(section.head, module, parts_.module_handles.back())) {
    error(section.place, "module: head {:03X}H overlaps another module's points", section.head);
  }
  seat->status().plate.node_id = section.node;
  for (std::size_t i = 0; i < parts_.buses.size(); ++i) {
    if (parts_.buses[i].get() == &bus && section.node != 0) parts_.watches[i]->know(seat->status());
  }
  parts_.modules.push_back(std::move(seat));
}

void Assembly::configure_network(const ModuleSection& section, Me3can1Q& module) {
  ModuleNetwork network(module, fmt::format("U{:X}", section.head / 16));
  const auto add = [&](const SlaveSection& wanted, DeviceSeat& seat, bool every_link) {
    const NodeStatus& status = seat.status();
    const auto problems = network.add_slave(wanted, seat.device().file(), status.plate.name, every_link);
    for (const PlantError& problem : problems) errors_.push_back(problem);
  };
  for (const SlaveSection& slave : section.slaves) {
    if (DeviceSeat* seat = device(section.bus, slave.node)) add(slave, *seat, true);
  }
  if (section.all_slaves) {
    for (const auto& seat : parts_.devices) {
      const NodePlate& plate = seat->status().plate;
      if (plate.bus != section.bus) continue;
      if (std::ranges::find(section.slaves, plate.node_id, &SlaveSection::node) != section.slaves.end())
        continue;
      SlaveSection slave{.place = section.place, .node = plate.node_id};
      slave.receive.push_back({.place = section.place, .pdo = 1});
      slave.send.push_back({.place = section.place, .pdo = 1});
      add(slave, *seat, false);
    }
  }
  network.become_master();
  for (const std::string& line : network.connections()) parts_.connections.push_back(line);
}

}  // namespace

Plant::Plant() : parts_(std::make_unique<Parts>()) {}
Plant::~Plant() = default;

std::expected<std::unique_ptr<Plant>, std::vector<PlantError>> Plant::build(
    const PlantFile& file, PlantObserver& observer, std::optional<std::uint64_t> seed) {
  std::unique_ptr<Plant> plant(new Plant);
  plant->parts_->file = file;
  auto errors = Assembly(*plant->parts_, observer, seed.value_or(file.seed)).run();
  if (!errors.empty()) {
    std::ranges::stable_sort(errors, {},
                             [](const PlantError& e) { return std::pair(e.place.line, e.place.column); });
    return std::unexpected(std::move(errors));
  }
  return plant;
}

void Plant::power_on() {
  const can::Time now = parts_->timeline.now();
  for (std::size_t i = 0; i < parts_->devices.size(); ++i) {
    parts_->devices[i]->power_on(now);
    parts_->timeline.refresh(parts_->device_handles[i]);
  }
  for (std::size_t i = 0; i < parts_->racks.size(); ++i) {
    parts_->racks[i]->power_on(now,
                               parts_->file.plcs[i].run ? module::CpuState::run : module::CpuState::stop);
  }
  for (std::size_t i = 0; i < parts_->modules.size(); ++i) {
    parts_->modules[i]->powered(now);
    parts_->timeline.refresh(parts_->module_handles[i]);
  }
}

can::Timeline& Plant::timeline() noexcept { return parts_->timeline; }
const std::string& Plant::name() const noexcept { return parts_->file.name; }
std::size_t Plant::bus_count() const noexcept { return parts_->buses.size(); }
sim::Bus& Plant::bus(std::size_t number) noexcept { return *parts_->buses[number]; }
const BusSection& Plant::bus_section(std::size_t number) const noexcept { return parts_->file.buses[number]; }
std::size_t Plant::plc_count() const noexcept { return parts_->racks.size(); }
plc::Rack& Plant::rack(std::size_t number) noexcept { return *parts_->racks[number]; }
const PlcSection& Plant::plc_section(std::size_t number) const noexcept { return parts_->file.plcs[number]; }
const std::vector<std::string>& Plant::connections() const noexcept { return parts_->connections; }

std::vector<NodeStatus> Plant::nodes() const {
  std::vector<NodeStatus> all;
  for (const auto& seat : parts_->modules) all.push_back(seat->status());
  for (const auto& seat : parts_->devices) all.push_back(seat->status());
  return all;
}

}  // namespace canopus::app
