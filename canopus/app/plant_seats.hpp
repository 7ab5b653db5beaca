#pragma once
// The participants a plant puts on its buses, each around the thing itself: what happens to it is passed on,
// and what changes is reported to the plant's observer.

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canopus/app/plant.hpp"
#include "canopus/manager/nmt_master.hpp"
#include "canopus/module/me3can1_q/me3can1_q.hpp"
#include "canopus/plc/rack.hpp"
#include "canopus/sim/device.hpp"
#include "canopus/store/parameter_file.hpp"

namespace canopus::app {

/// True for a frame of the identifiers that PDOs have by default.
[[nodiscard]] inline bool is_pdo(const can::Frame& frame) {
  return !frame.extended && !frame.remote && frame.identifier >= 0x180 && frame.identifier < 0x580;
}

/// Reports what the nodes of a bus say of themselves, those outside of this process included.
class BusWatch final : public sim::BusObserver {
 public:
  BusWatch(std::string_view bus, PlantObserver& observer) : bus_(bus), observer_(observer) {}
  /// Somebody of the plant on this bus.
  void know(NodeStatus& status) {
    occupants_.push_back(&status);
    know_number(status);
  }
  /// The node has this node-ID from now on (FFH: none).
  void renumber(NodeStatus& status, std::uint8_t node_id) {
    std::ranges::replace(known_, &status, static_cast<NodeStatus*>(nullptr));
    status.plate.node_id = node_id;
    know_number(status);
  }
  /// Who has this node-ID (1..127) on the bus.
  NodePlate plate(std::uint8_t node_id) const {
    return known_[node_id] != nullptr ? known_[node_id]->plate : NodePlate{bus_, {}, node_id};
  }

  void frame_completed(const can::Frame& frame, can::Time /*start*/, can::Time end) override {
    if (frame.extended || frame.remote) return;
    const auto node_id = static_cast<std::uint8_t>(frame.identifier & 0x7F);
    if (node_id == 0) return;
    const std::uint32_t function = frame.identifier & 0x780;
    if (function != canopen::cob_id::error_control && function != canopen::cob_id::emcy) return;
    if (is_plain_can()) return;
    if (function == canopen::cob_id::error_control && frame.dlc == 1) {
      error_control(node_id, static_cast<std::uint8_t>(frame.data[0] & 0x7F), end);
    } else if (function == canopen::cob_id::emcy && frame.dlc == 8) {
      emergency(node_id, frame, end);
    }
  }

 private:
  void know_number(NodeStatus& status) {
    const std::uint8_t node_id = status.plate.node_id;
    if (node_id >= 1 && node_id <= 127) known_[node_id] = &status;
  }
  /// Everybody of the plant is in a Layer 2 mode: identifiers mean nothing.
  bool is_plain_can() const {
    return !occupants_.empty() && std::ranges::none_of(occupants_, [](const NodeStatus* status) {
      return status->layer2 == module::Layer2State::inactive;
    });
  }
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
  std::string_view bus_;
  PlantObserver& observer_;
  std::vector<const NodeStatus*> occupants_;
  std::array<NodeStatus*, 128> known_{};
  std::array<std::uint8_t, 128> foreign_states_{};
};

/// A simulated device in its place on a bus.
class DeviceSeat final : public can::Participant {
 public:
  DeviceSeat(std::shared_ptr<const eds::DeviceFile> file, const DeviceSection& section, std::uint8_t node_id,
             sim::Port& port, PlantObserver& observer)
      : device_(std::move(file), node_id, port),
        port_(port),
        start_(can::Time{} + section.start),
        observer_(observer) {
    const std::string& product = device_.file().device.product_name;
    name_ = !section.name.empty() ? section.name : product;
    status_.plate = {section.bus, name_, node_id};
  }

  sim::Device& device() noexcept { return device_; }
  /// Where the device keeps what 1010H saves. To be called before power_on().
  void set_store(std::unique_ptr<store::ParameterFile> store) {
    store_ = std::move(store);
    device_.node().set_parameter_store(store_.get());
  }
  /// LSS slave, what it is told to store goes there (nullptr: does not survive the run). To be called before
  /// power_on().
  void enable_lss(std::unique_ptr<store::ParameterFile> store) {
    lss_store_ = std::move(store);
    device_.enable_lss(port_, lss_store_.get());
  }
  /// To be told when the node-ID changes.
  void set_watch(BusWatch& watch) noexcept { watch_ = &watch; }
  NodeStatus& status() noexcept { return status_; }
  const NodeStatus& status() const noexcept { return status_; }

  void power_on(can::Time now) {
    if (now < start_) return;
    status_.is_on = true;
    bit_rate_ = port_.bit_rate();
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
    if (device_.lss() != nullptr) look_at_lss(now);
    if (device_.node().identifiers_revision() != accepted_revision_) accept();
    if (device_.node().state() == status_.state) return;
    status_.state = device_.node().state();
    observer_.nmt_state_changed(status_.plate, status_.state, now);
  }
  void look_at_lss(can::Time now) {
    const std::uint8_t node_id = device_.node().node_id();
    if (node_id == status_.plate.node_id && port_.bit_rate() == bit_rate_) return;
    bit_rate_ = port_.bit_rate();
    if (node_id != status_.plate.node_id) watch_->renumber(status_, node_id);
    observer_.lss_configured(status_.plate, bit_rate_, now);
  }
  /// Tells the controller which identifiers the node does something with: the bus then leaves out the others.
  void accept() {
    const canopen::Node& node = device_.node();
    accepted_revision_ = node.identifiers_revision();
    sim::Acceptance acceptance;
    for (std::uint32_t identifier = 0; identifier <= can::max_base_identifier; ++identifier) {
      acceptance.base[identifier] = device_.wants(identifier);
    }
    acceptance.extended = node.wants_extended();
    port_.accept(acceptance);
  }

  std::unique_ptr<store::ParameterFile> store_;
  std::unique_ptr<store::ParameterFile> lss_store_;
  BusWatch* watch_ = nullptr;
  std::uint32_t bit_rate_ = 0;
  sim::Device device_;
  sim::Port& port_;
  std::uint32_t accepted_revision_ = 0;
  std::string name_;
  NodeStatus status_;
  can::Time start_;
  PlantObserver& observer_;
};

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

/// Stops a PLC's CPU with an error, once.
class CpuErrorTimer final : public can::Participant {
 public:
  CpuErrorTimer(plc::Rack& rack, can::Duration after) : rack_(rack), after_(after) {}

  /// The rack has been switched on.
  void powered(can::Time now) { at_ = can::later(now, after_); }
  void receive(const can::Frame&, can::Time) override {}
  void tick(can::Time now) override {
    at_ = can::never;
    rack_.fail_cpu(now);
  }
  can::Time deadline() const noexcept override { return at_; }

 private:
  plc::Rack& rack_;
  can::Duration after_;
  can::Time at_ = can::never;
};

/// A module in its slot, with the stand-in for the PLC program that asks for data exchanges.
class ModuleSeat final : public can::Participant, public module::ModuleObserver {
 public:
  ModuleSeat(const ModuleSection& section, std::string_view plc, sim::Port& port,
             std::unique_ptr<module::NonVolatileMemory> memory, module::Profile profile,
             const BusWatch& watch, PlantObserver& observer)
      : section_(section),
        plc_(plc),
        watch_(watch),
        memory_(std::move(memory)),
        module_(port, *memory_, std::move(profile)),
        observer_(observer) {
    name_ = fmt::format("{} U{:X}", section.model, section.head / 16);
    status_.is_module = true;
    status_.plate = {section.bus, name_, section.node};
    watched_.resize(section.watch.size());
    module_.set_observer(this);
  }

  module::me3can1_q::Me3can1Q& module() noexcept { return module_; }
  NodeStatus& status() noexcept { return status_; }
  const NodeStatus& status() const noexcept { return status_; }

  /// Adds the slaves that this module boots as the active NMT master.
  void collect_boots(std::vector<SlaveBoot>& all) const {
    const manager::NmtMaster* master = module_.master();
    if (master == nullptr) return;
    for (std::uint8_t node_id = 1; node_id <= 127; ++node_id) {
      const manager::BootRecord& record = master->boot_record(node_id);
      if (record.step == manager::BootStep::idle) continue;
      all.push_back({watch_.plate(node_id), status_.plate, record});
    }
  }

  /// The rack has switched the module on.
  void powered(can::Time now) {
    status_.is_on = true;
    if (section_.exchange) next_request_ = now + exchange_interval_;
    if (section_.fault_at) next_fault_ = can::later(now, *section_.fault_at);
    look(now);
  }

  void receive(const can::Frame& frame, can::Time now) override {
    module_.receive(frame, now);
    look(now);
  }
  void transmitted(const can::Frame& frame, can::Time now) override {
    if (status_.layer2 != module::Layer2State::inactive || is_pdo(frame)) ++status_.pdos;
    module_.transmitted(frame, now);
  }
  void controller_changed(can::Time now) override {
    module_.controller_changed(now);
    look(now);
  }
  void tick(can::Time now) override {
    if (module_.deadline() <= now) module_.tick(now);
    if (next_fault_ <= now) {
      next_fault_ = can::never;
      module_.inject(section_.fault, now);
    }
    if (next_request_ <= now) run_program(now);
    look(now);
  }
  can::Time deadline() const noexcept override {
    return std::min({module_.deadline(), next_request_, next_fault_});
  }

  void signal_changed(module::SignalKind kind, unsigned number, bool on, can::Time now) override {
    const bool is_input = kind == module::SignalKind::input;
    if (is_input && number == ready_signal && !on) was_ready_ = false;  // it starts anew
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
  void slave_boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) override {
    BootSeen& seen = boots_seen_[node_id & 0x7F];
    const bool is_news = seen.step != record.step || seen.attempts != record.attempts;
    seen = {record.step, record.attempts};
    status_.plate.node_id = module_.node().node_id();
    if (is_news) observer_.slave_boot_went_on(watch_.plate(node_id), status_.plate, record, now);
  }
  void error_raised(std::string_view what, can::Time now) override { observer_.error(name_, what, now); }

 private:
  static constexpr unsigned ready_signal = 0x00;
  static constexpr unsigned exchange_signal = 0x01;
  static constexpr unsigned online_signal = 0x03;
  static constexpr module::BufferAddress communication_status = 25;
  static constexpr std::uint16_t initializing = 1U << 7;

  /// Y01 ON; when X01 answers, Y01 OFF; again after the interval [ME3CAN1-Q 3.3.2].
  void run_program(can::Time now) {
    const auto is_on = [](std::uint32_t signals, unsigned number) { return ((signals >> number) & 1U) != 0; };
    if (program_requested_) {
      program_requested_ = false;
      module_.set_output(exchange_signal, false, now);
      next_request_ = std::max(requested_at_ + exchange_interval_, now + std::chrono::milliseconds(1));
      return;
    }
    const bool is_free = is_on(module_.inputs(), 0) && !is_on(module_.inputs(), exchange_signal) &&
                         !is_on(module_.outputs(), exchange_signal);
    if (!is_free) {  // not ready, or a client plays the program: look again later
      next_request_ = now + exchange_interval_;
      return;
    }
    requested_at_ = now;
    next_request_ = can::never;
    program_requested_ = program_owns_exchange_ = true;
    module_.set_output(exchange_signal, true, now);
  }

  /// What the program does once after each start of the module: words, then Y03.
  void set_up(can::Time now) {
    const bool ready = status_.is_on && (module_.read_word(communication_status, now) & initializing) == 0;
    if (std::exchange(was_ready_, ready) || !ready) return;
    if (section_.online) module_.set_output(online_signal, false, now);
    for (const BufferSetting& word : section_.writes) module_.write_word(word.address, word.value, now);
    if (section_.online) module_.set_output(online_signal, true, now);
  }

  void look(can::Time now) {
    if (section_.online || !section_.writes.empty()) set_up(now);
    status_.layer2 = module_.layer2_state();
    const bool canopen_mode = status_.layer2 == module::Layer2State::inactive;
    status_.plate.node_id = canopen_mode ? module_.node().node_id() : std::uint8_t{0};
    if (canopen_mode && module_.node().state() != status_.state) {
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

  struct BootSeen {
    manager::BootStep step = manager::BootStep::idle;
    std::uint32_t attempts = 0;
  };

  ModuleSection section_;
  std::string_view plc_;
  const BusWatch& watch_;
  std::string name_;
  std::unique_ptr<module::NonVolatileMemory> memory_;
  module::me3can1_q::Me3can1Q module_;
  PlantObserver& observer_;
  NodeStatus status_;
  std::vector<std::uint16_t> watched_;
  std::array<BootSeen, 128> boots_seen_{};
  can::Duration exchange_interval_ = section_.exchange.value_or(can::Duration{});
  can::Time next_fault_ = can::never;
  can::Time next_request_ = can::never;
  can::Time requested_at_{};
  bool was_ready_ = false;              // as set_up() saw it last
  bool program_requested_ = false;      // Y01 is ON, X01 awaited
  bool program_owns_exchange_ = false;  // until X01 is OFF again
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

}  // namespace canopus::app
