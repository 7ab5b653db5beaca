#include "canopus/module/models/as_fcopm/as_fcopm.hpp"

#include <algorithm>
#include <utility>

#include "canopus/module/models/as_fcopm/data_sheet.hpp"
#include "canopus/module/models/as_fcopm/master_role.hpp"
#include "canopus/module/models/as_fcopm/object_table.hpp"
#include "canopus/module/models/as_fcopm/register_table.hpp"
#include "canopus/module/models/as_fcopm/slave_role.hpp"

namespace canopus::module::as_fcopm {

namespace {

/// DS301 V4.02 in SR821; its form is not printed [10.1.1, 10.5.1].
constexpr std::uint16_t protocol_version = 402;

constexpr ProgramInterface interface_facts{.process_data = {.receive_first = input_first,
                                                            .transmit_first = output_first,
                                                            .words = process_words,
                                                            .pdos = most_pdos}};

}  // namespace

AsFcopm::AsFcopm(can::Controller& controller, NonVolatileMemory& /*memory*/, const Profile& profile)
    : controller_(controller), profile_(profile) {
  controller_.set_power(false);
  controller_.set_automatic_recovery(false);  // the way out of bus-off is a reboot [10.5.1 F4]
  alarm().add_part(initialized_at_);
  alarm().add_part(downloaded_at_);
  make_role();
}

// --- parameters

void AsFcopm::download(Configuration configuration, can::Time now) {
  if (phase_ == Phase::off) {
    stored_ = std::move(configuration);
    return make_role();
  }
  downloading_ = std::move(configuration);
  downloaded_at_ = can::later(now, download_time);
}

std::shared_ptr<const canopen::DictionaryDescription> AsFcopm::slave_objects() const {
  const auto objects = object_dictionary();
  std::vector<canopen::DictionaryDescription::Change> changes;
  for (const auto& [object, value] : presets_)
    changes.push_back({objects->find(object.first, object.second), value});
  return changes.empty() ? objects : objects->with(changes);
}

void AsFcopm::make_role() {
  in_use_ = check(stored_).empty() ? stored_ : Configuration{.work_mode = stored_.work_mode};
  if (is_master()) {
    role_ = std::make_unique<MasterRole>(in_use_, controller_, profile_, observer_);
  } else {
    role_ = std::make_unique<SlaveRole>(slave_objects(), static_cast<std::uint8_t>(in_use_.node_id),
                                        controller_, profile_);
  }
  alarm().add_part(role_->alarm());
}

bool AsFcopm::preset_bit_rate(std::uint32_t bit_rate) {
  const auto known = std::ranges::find(bit_rates, bit_rate / 1000);
  if (known == bit_rates.end() || bit_rate % 1000 != 0) return false;
  stored_.bit_rate = *known;
  make_role();
  return true;
}

bool AsFcopm::preset_node_id(std::uint8_t node_id) {
  if (node_id < 1 || node_id > 127) return false;
  stored_.node_id = node_id;
  make_role();
  return true;
}

canopen::AbortCode AsFcopm::preset_object(std::uint16_t index, std::uint8_t sub,
                                          std::span<const std::uint8_t> value) {
  if (is_master()) return canopen::AbortCode::cannot_store;
  canopen::ObjectDictionary objects(slave_objects(), static_cast<std::uint8_t>(in_use_.node_id));
  const canopen::AbortCode refused = objects.write(index, sub, value, {});
  if (refused != canopen::AbortCode::none) return refused;
  presets_[{index, sub}].assign(value.begin(), value.end());
  make_role();
  return refused;
}

std::span<const std::uint8_t> AsFcopm::object_preset(std::uint16_t index, std::uint8_t sub) const {
  const auto preset = presets_.find({index, sub});
  return preset == presets_.end() ? std::span<const std::uint8_t>{} : std::span(preset->second);
}

std::optional<CommunicationModule::InitialNode> AsFcopm::initial_node() {
  const auto node_id = static_cast<std::uint8_t>(in_use_.node_id);
  if (!is_master())
    return InitialNode{.node_id = node_id, .objects = canopen::ObjectDictionary(slave_objects(), node_id)};
  InitialNode node{
      .node_id = node_id,
      .objects = canopen::ObjectDictionary(master_dictionary(in_use_, lay_out(in_use_)), node_id),
      .produces_sync = in_use_.cycle_period != 0};
  for (const SlaveSetting& slave : in_use_.slaves) node.configures.push_back(slave.node_id);
  return node;
}

const ProgramInterface& AsFcopm::program_interface() const noexcept { return interface_facts; }

// --- for display

std::string_view AsFcopm::model() const noexcept { return data_sheet.model; }

ProductInformation AsFcopm::product() const noexcept {
  return {.type = data_sheet.type, .series = data_sheet.series, .model = data_sheet.model};
}

ModuleInformation AsFcopm::information() const {
  if (phase_ == Phase::off) return {};
  return {.function_mode = static_cast<std::uint16_t>(is_master() ? 1 : 2),
          .function_mode_name = mode_facts[is_master() ? 0 : 1].name,
          .bit_rate = in_use_.bit_rate * 1000U,
          .node_id = static_cast<std::uint8_t>(in_use_.node_id)};
}

std::vector<SlaveBootRecord> AsFcopm::boots() const {
  return phase_ == Phase::running ? role_->boots() : std::vector<SlaveBootRecord>{};
}

StartUp AsFcopm::start_up() const noexcept {
  return phase_ == Phase::running ? role_->start_up() : StartUp::none;
}

// --- life

void AsFcopm::power_on(can::Time now) {
  if (phase_ != Phase::off) return;
  make_role();
  was_bus_off_ = send_buffer_was_full_ = receive_buffer_was_full_ = cpu_has_failed_ = false;
  const std::vector<std::string> errors = check(stored_);
  for (const std::string& error : errors) report(error, now);
  phase_ = errors.empty() ? Phase::initializing : Phase::wrong_setting;
  if (errors.empty()) initialized_at_ = can::later(now, profile_.power_on_time);
}

void AsFcopm::power_off(can::Time now) {
  if (phase_ == Phase::off) return;
  phase_ = Phase::off;
  controller_.set_power(false);
  role_->stop(now);
  initialized_at_.cancel();
  downloaded_at_.cancel();
  downloading_.reset();
}

void AsFcopm::cpu_changed(CpuState state, can::Time now) {
  if (phase_ == Phase::off || state != CpuState::run || !std::exchange(cpu_has_failed_, false)) return;
  if (phase_ == Phase::running) role_->cpu_failed(false, now);
}

void AsFcopm::cpu_failed(can::Time now) {
  if (phase_ == Phase::off) return;
  cpu_has_failed_ = true;
  if (phase_ == Phase::running) role_->cpu_failed(true, now);
}

void AsFcopm::inject(ModuleFault fault, can::Time now) {
  if (phase_ == Phase::off) return;
  switch (fault) {
    case ModuleFault::power_error: return report("the supply was out of range", now);
    case ModuleFault::watchdog_error:
      power_off(now);  // until the supply has been off
      return report("watchdog error", now);
    case ModuleFault::hardware_error:
      phase_ = Phase::fault;
      initialized_at_ = can::never;
      role_->stop(now);
      controller_.set_power(false);
      return report("an error of the internal memory: supply off and on, else another card", now);
  }
}

// --- registers

std::span<const RegisterRange> AsFcopm::registers() const noexcept { return registers::ranges; }

OwnCode AsFcopm::own_code() const noexcept {
  const bool master = is_master();
  if (phase_ == Phase::fault) return master ? OwnCode::memory_error : OwnCode::none;
  if (phase_ == Phase::wrong_setting && !downloading_) return OwnCode::wrong_setting;
  if (was_bus_off_) return OwnCode::bus_off;
  if (downloading_) return role_->download_code();
  if (cpu_has_failed_ && master) return OwnCode::plc_error;
  if (send_buffer_was_full_) return OwnCode::send_buffer_full;
  if (receive_buffer_was_full_) return OwnCode::receive_buffer_full;
  if (phase_ == Phase::initializing) return master ? OwnCode::none : OwnCode::initializing;
  return role_->code();
}

std::uint16_t AsFcopm::read_register(RegisterKind kind, std::uint32_t number, can::Time) {
  if (phase_ == Phase::off || (kind == RegisterKind::special) != (number < response_first)) return 0;
  switch (number) {
    case version_register: return protocol_version;
    case bit_rate_register: return in_use_.bit_rate;
    case state_register: return static_cast<std::uint16_t>(own_code());
    default: return role_->read(number);
  }
}

void AsFcopm::write_register(RegisterKind kind, std::uint32_t number, std::uint16_t value, can::Time now) {
  if (has_role() && kind == RegisterKind::data) role_->write(number, value, now);
}

// --- the network

void AsFcopm::receive(const can::Frame& frame, can::Time now) {
  ++change_count_;
  // No guarding, and no PDO that can be requested [10.1.1, 10.3.2].
  if (phase_ != Phase::running || frame.remote) return;
  role_->receive(frame, now);
  check_queues();
}

void AsFcopm::transmitted(const can::Frame& frame, can::Time now) {
  if (phase_ == Phase::running) role_->transmitted(frame, now);
}

void AsFcopm::controller_changed(can::Time now) {
  if (phase_ != Phase::running) return;
  check_queues();
  if (controller_.error_state() != can::ErrorState::bus_off) return;
  if (std::exchange(was_bus_off_, true)) return;
  report("the CAN controller is bus-off: restart the module to recover", now);
  role_->bus_off(now);
}

void AsFcopm::check_queues() {
  send_buffer_was_full_ = send_buffer_was_full_ || controller_.transmit_overflows() != 0;
  receive_buffer_was_full_ = receive_buffer_was_full_ || controller_.receive_overflows() != 0;
}

void AsFcopm::tick(can::Time now) {
  if (now >= downloaded_at_) {
    downloaded_at_ = can::never;
    if (downloading_) stored_ = *std::exchange(downloading_, std::nullopt);
  }
  if (now >= initialized_at_) {
    initialized_at_ = can::never;
    phase_ = Phase::running;
    controller_.set_power(true);
    controller_.restart(in_use_.bit_rate * 1000U);
    role_->start(now);
  }
  if (has_role() && now >= role_->deadline()) role_->tick(now);
  if (phase_ == Phase::running) check_queues();
}

}  // namespace canopus::module::as_fcopm
