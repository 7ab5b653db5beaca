// Life cycle: construction, supply, initialization, restart.

#include "canopus/module/engine/module_engine.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/frame_of.hpp"
#include "canopus/manager/boot/start_up_bits.hpp"
#include "canopus/module/storage/stored_settings.hpp"

namespace canopus::module {

ModuleEngine::ModuleEngine(const ModuleModel& model, can::Controller& controller, NonVolatileMemory& memory,
                           const Profile& profile)
    : parts_(model, controller, memory, profile, command_host_), registers_(model.registers, *this) {
  parts_.port = model.request_port(*this);
  controller.set_power(false);
  controller.set_automatic_recovery(false);  // the way out of bus-off is a restart [ME3CAN1-Q 3.5.7]
  parts_.node.set_parameter_store(&parts_.settings.object_store());
  parts_.process_data.attach(parts_.node);
  for (can::Alarm* part :
       {&initialized_at_, &parts_.port->alarm(), &parts_.watchdog.alarm(), &controller_side_.alarm(),
        &layer2_bus_.alarm(), &parts_.own_emergencies.alarm(), &parts_.exchange.alarm(),
        &parts_.settings.alarm(), &parts_.time_stamp.alarm(), &parts_.node.alarm(), &parts_.master.alarm(),
        &parts_.command.alarm(), &parts_.layer2.alarm()}) {
    alarm().add_part(*part);
  }
}

// Function modes may have object dictionaries of their own [FX3U-CAN 6.5].
void ModuleEngine::describe_node() {
  if (!parts_.state.canopen_mode()) return;
  const auto description = parts_.model.dictionary_of(*parts_.state.mode);
  if (description.get() != &parts_.node.dictionary().description())
    parts_.node.describe(description, parts_.node_options(*parts_.state.mode));
}

bool ModuleEngine::preset_word(BufferAddress address, std::uint16_t value) {
  return parts_.settings.preset_word(address, value);
}
bool ModuleEngine::preset_bit_rate(std::uint32_t bit_rate) {
  return parts_.settings.preset_bit_rate(bit_rate);
}
bool ModuleEngine::preset_node_id(std::uint8_t node_id) { return parts_.settings.preset_node_id(node_id); }
canopen::AbortCode ModuleEngine::preset_object(std::uint16_t index, std::uint8_t sub,
                                               std::span<const std::uint8_t> value) {
  return parts_.settings.preset_object(index, sub, value);
}
std::optional<BufferAddress> ModuleEngine::layer2_preset_error() const {
  return parts_.settings.layer2_preset_error(parts_.layer2.rules());
}
bool ModuleEngine::takes_word(BufferAddress address, std::uint16_t value) const {
  return parts_.settings.takes_word(address, value);
}

std::optional<CommunicationModule::InitialNode> ModuleEngine::initial_node() {
  const ModuleSettings::Found stored = parts_.settings.look();
  if (stored.mode->kind != FunctionModeRow::Kind::canopen) return std::nullopt;
  InitialNode node{
      .node_id = stored.node_id,
      .objects = canopen::ObjectDictionary(parts_.model.dictionary_of(*stored.mode), stored.node_id),
      .configures = parts_.concise_dcfs.stored_nodes()};
  canopen::ObjectDictionary& objects = node.objects;
  if (parts_.model.node_id_defaults != nullptr) parts_.model.node_id_defaults(objects, stored.node_id);
  const auto is_stored = [](const canopen::Entry& entry) { return entry.description->stored; };
  canopen::apply_stored_values(stored.objects, stored_length, objects, is_stored);
  const canopen::CobId sync{objects.get<std::uint32_t>(0x1005, 0)};
  const bool is_master = (objects.get<std::uint32_t>(0x1F80, 0) & manager::start_up_bit::nmt_master) != 0;
  node.produces_sync = sync.has_bit_30() && !is_restricted(sync) &&
                       objects.get<std::uint32_t>(0x1006, 0) != 0 &&
                       (is_master || !parts_.model.node_options().sync_needs_active_master);
  return node;
}

ProductInformation ModuleEngine::product() const noexcept {
  const DataSheet& sheet = *parts_.model.data_sheet;
  return {.type = sheet.type,
          .series = sheet.series,
          .model = sheet.model,
          .points = sheet.points,
          .serial_number = sheet.serial_number,
          .version = sheet.function_version};
}

void ModuleEngine::set_observer(ModuleObserver* observer) {
  parts_.observer = observer;
  parts_.diagnostics.set_observer(observer);
  parts_.port->set_observer(observer);
}

void ModuleEngine::power_on(can::Time now) {
  if (parts_.state.phase != Phase::off) return;
  parts_.port->power_on(now);
  restarting_ = false;
  (void)network_events_.take_clear_request();  // kept in RAM: only a restart carries it out
  takes_files_ = true;
  begin_initialization(parts_.profile.power_on_time, now);
}

void ModuleEngine::power_off(can::Time now) {
  if (parts_.state.phase == Phase::off) return;
  stop(Phase::off, now);
  parts_.state.hardware_fault = false;
  parts_.diagnostics.reset();
}

void ModuleEngine::stop(Phase phase, can::Time now) {
  parts_.state.phase = phase;
  controller_sends_last_ = false;
  parts_.controller.set_power(false);
  parts_.master.stop(now);
  parts_.node.power_off();
  parts_.layer2.go_offline();
  parts_.command.reset();
  parts_.state.nmt_resetting = false;
  parts_.state.boot_up_waits = false;
  parts_.exchange.reset();
  parts_.watchdog.reset();
  parts_.settings.cancel_save();
  parts_.time_stamp.alarm().cancel();
  layer2_bus_.stop();
  controller_side_.alarm().cancel();
  initialized_at_ = can::never;
  parts_.own_emergencies.clear();
  parts_.port->power_off(now);
}

// Nothing works any more, but the words that say so [RJ71CN91 App. 1 X0, 5.3, 5.5].
void ModuleEngine::fail(can::Time now) {
  stop(Phase::failed, now);
  parts_.state.hardware_fault = true;
  parts_.errors.follow(ModuleError::hardware, true);
  parts_.port->show(now);
}

void ModuleEngine::inject(ModuleFault fault, can::Time now) {
  if (!parts_.state.works()) return;
  switch (fault) {
    case ModuleFault::hardware_error:
      parts_.state.hardware_fault = true;
      parts_.port->fault_found(now);
      parts_.report("hardware error", now);
      parts_.diagnostics.raise(Diagnosis::hardware, now, {1});
      // A severe error that the device causes itself acts as a communication error does [ME3CAN1-Q 4.7].
      if (parts_.state.running() && parts_.state.canopen_mode()) parts_.node.communication_error(now);
      return update(now);
    case ModuleFault::power_error:
      parts_.errors.raise(ModuleError::power_supply);
      parts_.report("the supply was out of range", now);
      return update(now);
    case ModuleFault::watchdog_error:
      // Until the supply has been off.
      parts_.model.watchdog_error_is_shown ? fail(now) : power_off(now);
      parts_.diagnostics.raise(Diagnosis::watchdog, now, {2});  // the cause codes are not printed
      return parts_.report("watchdog error", now);
  }
}

// [ME3CAN1-Q 3.3.2, 3.5.5] From the start of a restart on the module is off the bus, but for the message that
// says so; what it holds is what its flash memory holds.
void ModuleEngine::begin_initialization(can::Duration duration, can::Time now) {
  parts_.state.phase = Phase::initializing;
  if (!controller_sends_last_) parts_.controller.set_power(false);
  initialized_at_ = can::later(now, duration);
  parts_.settings.cancel_save();
  parts_.state.nmt_resetting = parts_.state.boot_up_waits = save_is_refused_ = false;
  cpu_side_.initialization_begins();
  layer2_bus_.stop();
  parts_.own_emergencies.clear();
  parts_.master.stop(now);
  parts_.node.power_off();
  parts_.layer2.go_offline();
  parts_.errors.reset();
  if (!parts_.state.hardware_fault) parts_.diagnostics.reset();
  parts_.emergencies.clear();
  parts_.nmt_status.reset();
  parts_.command.reset();
  parts_.exchange.reset();
  parts_.watchdog.reset();
  parts_.process_data.reset();
  parts_.status_words.reset();
  parts_.port->initialization_begins(now);
  if (network_events_.take_clear_request()) parts_.concise_dcfs.clear();
  parts_.state.mode = &parts_.settings.load();
  describe_node();
  parts_.lift.start();
  take_parameters(now);
  parts_.time_stamp.alarm().cancel();
  if (parts_.state.canopen_mode()) parts_.time_stamp.reset();
  parts_.layer2.start(parts_.state.mode->kind == FunctionModeRow::Kind::layer2_extended);
  update(now);
}

void ModuleEngine::end_due_initialization(can::Time now) {
  if (now < initialized_at_) return;
  initialized_at_ = can::never;
  if (parts_.state.canopen_mode() && parts_.model.faulty_mapping_keeps_initializing &&
      configuration_is_faulty(now)) {
    parts_.state.phase = Phase::stuck;
    return;
  }
  parts_.state.phase = Phase::running;
  parts_.state.bit_rate = parts_.settings.bit_rate();
  parts_.master.options().bit_rate = parts_.state.bit_rate * 1000U;
  controller_sends_last_ = false;
  controller_side_.restart(parts_.state.bit_rate * 1000U);
  layer2_bus_.initialized();
  if (parts_.state.canopen_mode()) {
    parts_.node.set_node_id(parts_.settings.node_id());
    parts_.network_settings.apply();
    parts_.node.power_on(now);
  }
  parts_.watchdog.module_started(now);
  const bool by_restart = std::exchange(restarting_, false);
  if (by_restart) parts_.diagnostics.log(ModuleEvent::restarted, now);
  switch (parts_.state.mode->kind) {
    case FunctionModeRow::Kind::canopen: parts_.diagnostics.log(ModuleEvent::canopen_start, now); break;
    case FunctionModeRow::Kind::layer2_base:
      parts_.diagnostics.log(ModuleEvent::layer2_base_start, now);
      break;
    case FunctionModeRow::Kind::layer2_extended:
      parts_.diagnostics.log(ModuleEvent::layer2_extended_start, now);
      break;
  }
  parts_.port->initialized(by_restart, now);
  controller_changed(now);
}

// The way out is the object dictionary's reset by the command interface, and a restart [ME3CAN1-Q 8.1.2].
bool ModuleEngine::configuration_is_faulty(can::Time now) {
  const auto faulty = parts_.settings.faulty_mapping(parts_.settings.node_id());
  if (!faulty) return false;
  parts_.report("stays in initialization: the stored object dictionary is faulty at " +
                    canopen::object_name(faulty->index, faulty->sub) +
                    "; write 1011H:01 by the CIF and restart",
                now);
  return true;
}

void ModuleEngine::begin_restart(can::Time now) {
  // A restart is no cut of the supply: what was asked for is saved.
  if (parts_.settings.save_deadline() != can::never) end_save(now);
  // The frame is in the controller's queue before the node goes off; the controller goes off after it.
  if (parts_.state.running() && parts_.state.canopen_mode()) {
    const EmergencyRow& row = parts_.model.emergencies.restart;
    controller_sends_last_ =
        row.code != 0 && parts_.node.emergency(row.code, row.error_register, row.manufacturer, now);
  }
  restarting_ = true;
  begin_initialization(parts_.profile.restart_time, now);
}

void ModuleEngine::receive(const can::Frame& frame, can::Time now) {
  if (!parts_.state.running()) return;
  if (!parts_.state.canopen_mode()) {
    if (parts_.layer2_state() == Layer2State::offline) return;
    last_frame_ = now;
    parts_.layer2.receive(frame, now);
    ++parts_.change_count;
    return update(now);
  }
  last_frame_ = now;
  const bool is_pdo = frame.identifier > 0x180 && frame.identifier < canopen::cob_id::sdo_response &&
                      canopen::is_base_data(frame);
  if (is_pdo && parts_.network.is_open()) return receive_pdo(frame, now);
  receive_other(frame, now);
}

// Most frames are PDOs and heartbeats. What they change beyond process data is reported (ModuleContext::change_count); without such a
// report nothing of what update() reads has changed. The master does nothing with PDOs.
inline void ModuleEngine::receive_pdo(const can::Frame& frame, can::Time now) {
  const std::uint64_t changes = parts_.change_count;
  parts_.node.receive(frame, now);
  const bool is_of_command = parts_.command.receive(frame, now);
  if (is_of_command || parts_.change_count != changes) update_after_frame(now);
}

/// What is no PDO, or comes while the node is off the network.
void ModuleEngine::receive_other(const can::Frame& frame, can::Time now) {
  const std::uint64_t changes = parts_.change_count;
  const bool is_open = parts_.network.is_open();
  if (is_open) parts_.node.receive(frame, now);
  parts_.master.receive(frame, now);
  const bool is_of_command = is_open && parts_.command.receive(frame, now);
  const bool is_heartbeat =
      is_open && canopen::is_base_data(frame) && frame.data[0] != 0 &&
      (frame.identifier & canopen::cob_id::function_code) == canopen::cob_id::error_control;
  if (is_of_command || !is_heartbeat || parts_.change_count != changes) update_after_frame(now);
}

void ModuleEngine::update_after_frame(can::Time now) {
  ++parts_.change_count;
  update(now);
}

void ModuleEngine::transmitted(const can::Frame& frame, can::Time now) {
  last_frame_ = now;
  if (controller_sends_last_) return end_sending(frame);
  if (!parts_.state.running()) return;
  if (parts_.state.canopen_mode()) {
    parts_.node.transmitted(frame, now);
    parts_.master.transmitted(frame, now);
    parts_.command.transmitted(frame, now);
    return end_initialisation_of_node(frame, now);
  }
  parts_.layer2.transmitted(frame);
  if (parts_.layer2.takes_command_frame(frame)) parts_.command.frame_sent(now);
  update(now);
}

// The boot-up message does [CiA 301 7.3.2.2].
void ModuleEngine::end_initialisation_of_node(const can::Frame& frame, can::Time now) {
  if (!parts_.state.boot_up_waits || frame.remote || frame.extended) return;
  if (frame.identifier != canopen::cob_id::error_control + parts_.node.node_id() || frame.data[0] != 0)
    return;
  parts_.state.boot_up_waits = false;
  update(now);
}

void ModuleEngine::end_sending(const can::Frame& frame) {
  const EmergencyRow& row = parts_.model.emergencies.restart;
  const bool is_last = frame.dlc == 8 && (frame.data[0] | frame.data[1] << 8) == row.code &&
                       std::equal(row.manufacturer.begin(), row.manufacturer.end(), &frame.data[3]);
  if (!is_last) return;
  controller_sends_last_ = false;
  parts_.controller.set_power(false);
}

StartUp ModuleEngine::start_up() const noexcept {
  if (!parts_.master.active()) return StartUp::none;
  if (parts_.master.waits_for_own_start()) return StartUp::waits_for_own_start;
  if (parts_.master.halted()) return StartUp::halted;
  return parts_.master.starting() ? StartUp::booting : StartUp::ended;
}

void ModuleEngine::controller_changed(can::Time now) {
  if (!parts_.state.running() || !parts_.network.is_open()) return;
  controller_side_.changed(now);
  update(now);
}

void ModuleEngine::cpu_changed(CpuState state, can::Time now) {
  cpu_side_.changed(state, now);
  if (parts_.state.running()) update(now);
}

void ModuleEngine::cpu_failed(can::Time now) {
  cpu_side_.failed();
  if (parts_.state.running()) update(now);
}

void ModuleEngine::tick(can::Time now) {
  end_due_initialization(now);
  parts_.port->tick(now);
  if (parts_.watchdog.expires(is_online(), now)) cpu_side_.watchdog_expired(now);
  if (parts_.exchange.end_if_due(now)) parts_.port->done(Request::data_exchange, now);
  if (now >= parts_.settings.save_deadline()) end_save(now);
  if (parts_.state.running() && now >= parts_.time_stamp.next_transmission()) parts_.time_stamp.tick(now);
  if (now >= parts_.node.deadline()) parts_.node.tick(now);
  if (now >= parts_.master.deadline()) parts_.master.tick(now);
  if (now >= parts_.command.alarm()) parts_.command.tick(now);
  if (now >= parts_.layer2.deadline()) parts_.layer2.tick(now);
  controller_side_.tick(now);
  update(now);
}

// After every event: what hangs on several causes.
void ModuleEngine::update(can::Time now) {
  if (!parts_.state.works()) return;
  if (parts_.state.running()) {
    cpu_side_.enter_due_stop(now);
    if (parts_.state.canopen_mode()) {
      parts_.own_emergencies.send(now);
      parts_.exchange.exchange_if_operational(now);
    } else {
      parts_.own_emergencies.clear();
      layer2_bus_.leave_when_silent(now);
      if (parts_.errors.track(ModuleError::message_slot, parts_.layer2.any_slot_error())) {
        parts_.report("messages of a slot were lost: they come faster than the module takes them", now);
        parts_.diagnostics.raise(Diagnosis::message_slot, now, {parts_.layer2.first_slot_error()});
      }
    }
    controller_side_.look_at_overflows(now);  // of what was sent just now, too
  }
  if (parts_.settings.wore_out()) {  // the real flash memory; this one goes on
    parts_.report("the flash memory has been written more often than the real one lasts for (" +
                      std::to_string(parts_.model.data_sheet->flash_writes) + " times)",
                  now);
    parts_.diagnostics.raise(Diagnosis::flash_worn, now);
  }
  save_is_refused_ = save_is_refused_ && parts_.layer2.online();
  parts_.errors.follow(ModuleError::save_while_online, save_is_refused_);
  change_log_.look(now);
  parts_.errors.follow(ModuleError::hardware, parts_.state.hardware_fault);
  parts_.errors.follow(ModuleError::flash, parts_.settings.error());
  parts_.errors.follow(ModuleError::access_watchdog, parts_.watchdog.expired());
  parts_.errors.follow(ModuleError::emergency, parts_.emergencies.any_active());
  parts_.errors.track(ModuleError::node_failure, parts_.any_nmt_error());
  parts_.port->show(now);
}

}  // namespace canopus::module
