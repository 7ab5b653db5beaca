// Life cycle: construction, supply, initialization, restart.

#include "canopus/module/engine/module_engine.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/manager/boot/start_up_bits.hpp"
#include "canopus/module/storage/stored_settings.hpp"

namespace canopus::module {

namespace {

Layer2Rules layer2_rules(const ModuleModel& model, const Profile& profile) {
  Layer2Rules rules = model.layer2_rules;
  rules.cycle_unit = profile.layer2_cycle_unit;
  rules.message_time = profile.layer2_message_time;
  rules.waiting_messages = profile.layer2_waiting_messages;
  return rules;
}

manager::ConfigurationOptions configuration_options(const ModuleModel& model, const Profile& profile) {
  manager::ConfigurationOptions options;
  if (model.configuration_options != nullptr) options = model.configuration_options();
  options.erase_time = profile.erase_time;
  return options;
}

canopen::NodeOptions node_options(const ModuleModel& model, const Profile& profile) {
  canopen::NodeOptions options = model.node_options();
  options.reset_time = profile.nmt_reset_time;
  options.stored_length = stored_length;
  return options;
}

}  // namespace

ModuleEngine::ModuleEngine(const ModuleModel& model, can::Controller& controller, NonVolatileMemory& memory,
                           const Profile& profile)
    : model_(model),
      controller_(controller),
      network_(controller),
      profile_(profile),
      buffer_(model.buffer_memory),
      registers_(model.registers, *this),
      settings_(model, memory, buffer_),
      errors_(model.error_status, buffer_),
      diagnostics_(model.diagnostics),
      emergencies_(model.emergency_buffer, buffer_),
      nmt_status_(model.nmt_status, buffer_),
      node_(model.object_dictionary(), 127, network_, node_options(model, profile_)),
      master_(node_, controller, model.master_options()),
      command_(model.command, buffer_, *this, network_),
      network_settings_(model.network_settings, buffer_, master_),
      process_data_(model.program_interface.process_data, buffer_),
      layer2_(model.layer2, layer2_rules(model, profile_), buffer_, controller),
      windows_(model.process_data_windows, model.program_interface.process_data, buffer_),
      exchange_(model.exchange_control, buffer_, {process_data_, emergencies_, layer2_, node_}),
      time_stamp_(model.time_stamp, buffer_, node_),
      status_words_(model.status, buffer_, {state_, controller, node_, master_, layer2_}),
      concise_dcfs_(node_, master_, settings_.flash(), ModuleSettings::concise_dcfs_name,
                    configuration_options(model, profile_)),
      port_(model.request_port(*this)) {
  state_.mode = &model.function_modes.front();
  controller_.set_power(false);
  controller_.set_automatic_recovery(false);  // the way out of bus-off is a restart [ME3CAN1-Q 3.5.7]
  node_.set_listener(this);
  master_.set_listener(this);
  node_.dictionary().attach(0x0002, 0x0008, *this);
  node_.set_parameter_store(&settings_.object_store());
  process_data_.attach(node_.dictionary());
  events_.reserve(most_events);
}

bool ModuleEngine::preset_word(BufferAddress address, std::uint16_t value) {
  return settings_.preset_word(address, value);
}
bool ModuleEngine::preset_bit_rate(std::uint32_t bit_rate) { return settings_.preset_bit_rate(bit_rate); }
bool ModuleEngine::preset_node_id(std::uint8_t node_id) { return settings_.preset_node_id(node_id); }
canopen::AbortCode ModuleEngine::preset_object(std::uint16_t index, std::uint8_t sub,
                                               std::span<const std::uint8_t> value) {
  return settings_.preset_object(index, sub, value);
}
std::optional<BufferAddress> ModuleEngine::layer2_preset_error() const {
  return settings_.layer2_preset_error(layer2_rules(model_, profile_));
}
bool ModuleEngine::takes_word(BufferAddress address, std::uint16_t value) const {
  return settings_.takes_word(address, value);
}

std::optional<CommunicationModule::InitialNode> ModuleEngine::initial_node() {
  const ModuleSettings::Found stored = settings_.look();
  if (stored.mode->kind != FunctionModeRow::Kind::canopen) return std::nullopt;
  InitialNode node{.node_id = stored.node_id,
                   .objects = canopen::ObjectDictionary(model_.object_dictionary(), stored.node_id),
                   .configures = concise_dcfs_.stored_nodes()};
  canopen::ObjectDictionary& objects = node.objects;
  if (model_.node_id_defaults != nullptr) model_.node_id_defaults(objects, stored.node_id);
  const auto is_stored = [](const canopen::Entry& entry) { return entry.description->stored; };
  canopen::apply_stored_values(stored.objects, stored_length, objects, is_stored);
  const canopen::CobId sync{objects.get<std::uint32_t>(0x1005, 0)};
  const bool is_master = (objects.get<std::uint32_t>(0x1F80, 0) & manager::start_up_bit::nmt_master) != 0;
  node.produces_sync = sync.has_bit_30() && !is_restricted(sync) &&
                       objects.get<std::uint32_t>(0x1006, 0) != 0 &&
                       (is_master || !model_.node_options().sync_needs_active_master);
  return node;
}

const ProgramInterface& ModuleEngine::program_interface() const noexcept { return model_.program_interface; }

ProductInformation ModuleEngine::product() const noexcept {
  const DataSheet& sheet = *model_.data_sheet;
  return {.type = sheet.type,
          .series = sheet.series,
          .model = sheet.model,
          .points = sheet.points,
          .serial_number = sheet.serial_number,
          .version = sheet.function_version};
}

Layer2State ModuleEngine::layer2_state() const noexcept {
  if (state_.canopen_mode()) return Layer2State::inactive;
  return layer2_.online() ? Layer2State::online : Layer2State::offline;
}

void ModuleEngine::set_observer(ModuleObserver* observer) {
  observer_ = observer;
  diagnostics_.set_observer(observer);
  port_->set_observer(observer);
}

void ModuleEngine::power_on(can::Time now) {
  if (state_.phase != Phase::off) return;
  port_->power_on(now);
  restarting_ = false;
  clear_concise_dcfs_ = false;  // kept in RAM: only a restart carries it out
  begin_initialization(profile_.power_on_time, now);
}

void ModuleEngine::power_off(can::Time now) {
  if (state_.phase == Phase::off) return;
  state_.phase = Phase::off;
  controller_sends_last_ = false;
  controller_.set_power(false);
  state_.hardware_fault = false;
  master_.stop(now);
  node_.power_off();
  layer2_.go_offline();
  command_.reset();
  state_.nmt_resetting = false;
  exchange_.reset();
  settings_.cancel_save();
  initialized_at_ = can::never;
  events_.clear();
  events_due_ = can::never;
  diagnostics_.reset();
  port_->power_off(now);
}

void ModuleEngine::inject(ModuleFault fault, can::Time now) {
  if (state_.phase == Phase::off) return;
  switch (fault) {
    case ModuleFault::hardware_error:
      state_.hardware_fault = true;
      port_->fault_found(now);
      report("hardware error", now);
      diagnostics_.raise(Diagnosis::hardware, now);
      // A severe error that the device causes itself acts as a communication error does [ME3CAN1-Q 4.7].
      if (state_.running() && state_.canopen_mode()) node_.communication_error(now);
      return update(now);
    case ModuleFault::watchdog_error:
      power_off(now);  // until the supply has been off
      diagnostics_.raise(Diagnosis::watchdog, now);
      return report("watchdog error", now);
  }
}

// [ME3CAN1-Q 3.3.2, 3.5.5] From the start of a restart on the module is off the bus, but for the message that
// says so; what it holds is what its flash memory holds.
void ModuleEngine::begin_initialization(can::Duration duration, can::Time now) {
  state_.phase = Phase::initializing;
  if (!controller_sends_last_) controller_.set_power(false);
  initialized_at_ = can::later(now, duration);
  settings_.cancel_save();
  state_.nmt_resetting = false;
  stop_is_due_ = false;
  off_wire_at_ = can::never;
  events_.clear();
  events_due_ = can::never;
  master_.stop(now);
  node_.power_off();
  layer2_.go_offline();
  errors_.reset();
  if (!state_.hardware_fault) diagnostics_.reset();
  emergencies_.clear();
  nmt_status_.reset();
  command_.reset();
  exchange_.reset();
  process_data_.reset();
  status_words_.reset();
  port_->initialization_begins(now);
  if (std::exchange(clear_concise_dcfs_, false)) concise_dcfs_.clear();
  state_.mode = &settings_.load();
  if (state_.canopen_mode()) time_stamp_.reset();
  layer2_.start(state_.mode->kind == FunctionModeRow::Kind::layer2_extended);
  update(now);
}

void ModuleEngine::end_due_initialization(can::Time now) {
  if (now < initialized_at_) return;
  initialized_at_ = can::never;
  if (state_.canopen_mode() && model_.faulty_mapping_keeps_initializing && configuration_is_faulty(now)) {
    state_.phase = Phase::stuck;
    return;
  }
  state_.phase = Phase::running;
  state_.bit_rate = settings_.bit_rate();
  master_.options().bit_rate = state_.bit_rate * 1000U;
  controller_sends_last_ = false;
  controller_.restart(state_.bit_rate * 1000U);
  off_wire_at_ = can::never;
  wire_left_ = true;
  controller_.set_power(state_.canopen_mode() || !layer2_.rules().offline_is_silent);
  overflows_ = 0;
  if (state_.canopen_mode()) {
    node_.set_node_id(settings_.node_id());
    network_settings_.apply();
    node_.power_on(now);
  }
  const bool by_restart = std::exchange(restarting_, false);
  if (by_restart) diagnostics_.log(ModuleEvent::restarted, now);
  switch (state_.mode->kind) {
    case FunctionModeRow::Kind::canopen: diagnostics_.log(ModuleEvent::canopen_start, now); break;
    case FunctionModeRow::Kind::layer2_base: diagnostics_.log(ModuleEvent::layer2_base_start, now); break;
    case FunctionModeRow::Kind::layer2_extended:
      diagnostics_.log(ModuleEvent::layer2_extended_start, now);
      break;
  }
  port_->initialized(by_restart, now);
  controller_changed(now);
}

// The way out is the object dictionary's reset by the command interface, and a restart [ME3CAN1-Q 8.1.2].
bool ModuleEngine::configuration_is_faulty(can::Time now) {
  const auto faulty = settings_.faulty_mapping(settings_.node_id());
  if (!faulty) return false;
  std::array<char, 120> text{};
  const int length =
      std::snprintf(text.data(), text.size(),
                    "stays in initialization: the stored object dictionary is faulty at %04XH:%02X; "
                    "write 1011H:01 by the CIF and restart",
                    faulty->index, faulty->sub);
  report({text.data(), static_cast<std::size_t>(length)}, now);
  return true;
}

void ModuleEngine::begin_restart(can::Time now) {
  // A restart is no cut of the supply: what was asked for is saved.
  if (settings_.save_deadline() != can::never) end_save(now);
  // The frame is in the controller's queue before the node goes off; the controller goes off after it.
  if (state_.running() && state_.canopen_mode()) {
    const EmergencyRow& row = model_.emergencies.restart;
    controller_sends_last_ = node_.emergency(row.code, row.error_register, row.manufacturer, now);
  }
  restarting_ = true;
  begin_initialization(profile_.restart_time, now);
}

void ModuleEngine::tick(can::Time now) {
  end_due_initialization(now);
  port_->tick(now);
  if (exchange_.end_if_due(now)) port_->done(Request::data_exchange, now);
  if (now >= settings_.save_deadline()) end_save(now);
  if (state_.running() && now >= time_stamp_.next_transmission()) time_stamp_.tick(now);
  if (now >= node_.deadline()) node_.tick(now);
  if (now >= master_.deadline()) master_.tick(now);
  if (now >= command_.deadline()) command_.tick(now);
  if (now >= layer2_.deadline()) layer2_.tick(now);
  update(now);
}

can::Time ModuleEngine::deadline() const noexcept {
  const can::Time wire_due = state_.running() && !layer2_.uses_bus() ? off_wire_at_ : can::never;
  const can::Time time_due = state_.running() ? time_stamp_.next_transmission() : can::never;
  return std::min({port_->deadline(), wire_due, events_due_, initialized_at_, exchange_.deadline(),
                   settings_.save_deadline(), time_due, node_.deadline(), master_.deadline(),
                   command_.deadline(), layer2_.deadline()});
}

// After every event: what hangs on several causes.
void ModuleEngine::update(can::Time now) {
  if (state_.phase == Phase::off) return;
  if (state_.running()) {
    if (stop_is_due_) enter_stop(model_.emergencies.cpu_stopped, now);
    look_at_overflows(now);
    if (state_.canopen_mode()) {
      send_events(now);
      exchange_.exchange_if_operational(now);
    } else {
      events_.clear();
      leave_layer2_bus(now);
      if (layer2_.any_slot_error() && errors_.raise(ModuleError::message_slot)) {
        report("messages of a slot were lost: they come faster than the module takes them", now);
        diagnostics_.raise(Diagnosis::message_slot, now, {layer2_.first_slot_error()});
      }
    }
  }
  if (settings_.wore_out()) {  // the real flash memory; this one goes on
    report("the flash memory has been written more often than the real one lasts for (" +
               std::to_string(model_.data_sheet->flash_writes) + " times)",
           now);
    diagnostics_.raise(Diagnosis::flash_worn, now);
  }
  log_changes(now);
  errors_.follow(ModuleError::hardware, state_.hardware_fault);
  errors_.follow(ModuleError::flash, settings_.error());
  errors_.track(ModuleError::node_failure, any_nmt_error());
  port_->show(now);
}

void ModuleEngine::report(std::string_view what, can::Time now) {
  if (observer_ != nullptr) observer_->error_raised(what, now);
}

}  // namespace canopus::module
