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
    : context_(model, controller, memory, profile),
      controller_(context_, controller, node_),
      node_(context_, controller, controller_, cpu_, layer2_, *this),
      layer2_(context_, controller, controller_),
      windows_(model.process_data_windows, model.program_interface.process_data, context_.buffer),
      exchange_(model.exchange_control, context_.buffer, node_.exchange_data(layer2_.slots(), controller)),
      registers_(model.registers, *this) {
  context_.port = model.request_port(*this);
  for (can::Alarm* part :
       {&initialized_at_, &context_.port->alarm(), &context_.watchdog.alarm(), &controller_.alarm(),
        &exchange_.alarm(), &context_.settings.alarm(), &layer2_.alarm(), &node_.alarm()}) {
    alarm().add_part(*part);
  }
}

bool ModuleEngine::preset_word(BufferAddress address, std::uint16_t value) {
  return context_.settings.preset_word(address, value);
}
bool ModuleEngine::preset_bit_rate(std::uint32_t bit_rate) {
  return context_.settings.preset_bit_rate(bit_rate);
}
bool ModuleEngine::preset_node_id(std::uint8_t node_id) { return context_.settings.preset_node_id(node_id); }
canopen::AbortCode ModuleEngine::preset_object(std::uint16_t index, std::uint8_t sub,
                                               std::span<const std::uint8_t> value) {
  return context_.settings.preset_object(index, sub, value);
}
std::optional<BufferAddress> ModuleEngine::layer2_preset_error() const {
  return context_.settings.layer2_preset_error(layer2_.slots().rules());
}
bool ModuleEngine::takes_word(BufferAddress address, std::uint16_t value) const {
  return context_.settings.takes_word(address, value);
}

std::optional<CommunicationModule::InitialNode> ModuleEngine::initial_node() {
  const ModuleSettings::Found stored = context_.settings.read_flash();
  if (stored.mode->kind != FunctionModeRow::Kind::canopen) return std::nullopt;
  InitialNode node{
      .node_id = stored.node_id,
      .objects = canopen::ObjectDictionary(context_.model.dictionary_of(*stored.mode), stored.node_id),
      .bit_rate = stored.bit_rate * 1000U,
      .configures = node_.stored_configurations()};
  canopen::ObjectDictionary& objects = node.objects;
  if (context_.model.node_id_defaults != nullptr) context_.model.node_id_defaults(objects, stored.node_id);
  const auto is_stored = [](const canopen::Entry& entry) { return entry.description->stored; };
  canopen::apply_stored_values(stored.objects, stored_length, objects, is_stored);
  const canopen::CobId sync{objects.get<std::uint32_t>(0x1005, 0)};
  const bool is_master = (objects.get<std::uint32_t>(0x1F80, 0) & manager::start_up_bit::nmt_master) != 0;
  node.produces_sync = sync.has_bit_30() && !is_restricted(sync) &&
                       objects.get<std::uint32_t>(0x1006, 0) != 0 &&
                       (is_master || !context_.model.node_options().sync_needs_active_master);
  return node;
}

ProductInformation ModuleEngine::product() const noexcept {
  const DataSheet& sheet = *context_.model.data_sheet;
  return {.type = sheet.type,
          .series = sheet.series,
          .model = sheet.model,
          .points = sheet.points,
          .serial_number = sheet.serial_number,
          .version = sheet.function_version};
}

void ModuleEngine::set_observer(ModuleObserver* observer) {
  context_.observer = observer;
  context_.diagnostics.set_observer(observer);
  context_.port->set_observer(observer);
}

void ModuleEngine::power_on(can::Time now) {
  if (context_.state.phase != Phase::off) return;
  context_.port->power_on(now);
  restarting_ = false;
  node_.forget_restore();
  takes_files_ = true;
  begin_initialization(context_.profile.power_on_time, now);
}

void ModuleEngine::power_off(can::Time now) {
  if (context_.state.phase == Phase::off) return;
  stop(Phase::off, now);
  context_.state.hardware_fault = false;
  context_.diagnostics.reset();
}

void ModuleEngine::stop(Phase phase, can::Time now) {
  context_.state.phase = phase;
  controller_sends_last_ = false;
  controller_.set_power(false);
  node_.power_off(now);
  layer2_.stop();
  exchange_.reset();
  context_.watchdog.reset();
  context_.settings.cancel_save();
  controller_.alarm().cancel();
  initialized_at_ = can::never;
  context_.port->power_off(now);
}

// Nothing works any more, but the words that report it [RJ71CN91 App. 1 X0, 5.3, 5.5].
void ModuleEngine::fail(can::Time now) {
  stop(Phase::failed, now);
  context_.state.hardware_fault = true;
  context_.errors.follow(ModuleError::hardware, true);
  context_.port->show(now);
}

void ModuleEngine::inject(ModuleFault fault, can::Time now) {
  if (!context_.state.works()) return;
  switch (fault) {
    case ModuleFault::hardware_error:
      context_.state.hardware_fault = true;
      context_.port->fault_found(now);
      context_.report("hardware error", now);
      context_.diagnostics.raise(Diagnosis::hardware, now, {1});
      // A severe error that the device causes itself acts as a communication error does [ME3CAN1-Q 4.7].
      if (context_.state.running() && context_.state.canopen_mode()) node_.communication_error(now);
      return update(now);
    case ModuleFault::power_error:
      context_.errors.raise(ModuleError::power_supply);
      context_.report("the supply was out of range", now);
      return update(now);
    case ModuleFault::watchdog_error:
      // Until the supply has been off.
      context_.model.watchdog_error_is_shown ? fail(now) : power_off(now);
      context_.diagnostics.raise(Diagnosis::watchdog, now, {2});  // the cause codes are not printed
      return context_.report("watchdog error", now);
  }
}

// [ME3CAN1-Q 3.3.2, 3.5.5] From the start of a restart on the module is off the bus, but for the message that
// says so; what it holds is what its flash memory holds.
void ModuleEngine::begin_initialization(can::Duration duration, can::Time now) {
  context_.state.phase = Phase::initializing;
  if (!controller_sends_last_) controller_.set_power(false);
  initialized_at_ = can::later(now, duration);
  context_.settings.cancel_save();
  save_is_refused_ = false;
  cpu_.initialization_begins();
  node_.power_off(now);
  layer2_.stop();
  context_.errors.reset();
  if (!context_.state.hardware_fault) context_.diagnostics.reset();
  node_.reset();
  exchange_.reset();
  context_.watchdog.reset();
  context_.port->initialization_begins(now);
  node_.clear_restored_configurations();
  context_.state.mode = &context_.settings.load();
  if (context_.state.canopen_mode()) node_.describe(*context_.state.mode);
  node_.begin(context_.state.canopen_mode());
  load_parameters(now);
  layer2_.start(context_.state.mode->kind == FunctionModeRow::Kind::layer2_extended);
  update(now);
}

void ModuleEngine::end_due_initialization(can::Time now) {
  if (now < initialized_at_) return;
  initialized_at_ = can::never;
  if (context_.state.canopen_mode() && context_.model.faulty_mapping_keeps_initializing &&
      configuration_is_faulty(now)) {
    context_.state.phase = Phase::stuck;
    return;
  }
  context_.state.phase = Phase::running;
  context_.state.bit_rate = context_.settings.bit_rate();
  node_.set_bit_rate(context_.state.bit_rate * 1000U);
  controller_sends_last_ = false;
  controller_.restart(context_.state.bit_rate * 1000U);
  layer2_.initialized();
  if (context_.state.canopen_mode()) node_.power_on(context_.settings.node_id(), now);
  context_.watchdog.module_started(now);
  const bool by_restart = std::exchange(restarting_, false);
  if (by_restart) context_.diagnostics.log(ModuleEvent::restarted, now);
  switch (context_.state.mode->kind) {
    case FunctionModeRow::Kind::canopen: context_.diagnostics.log(ModuleEvent::canopen_start, now); break;
    case FunctionModeRow::Kind::layer2_base:
      context_.diagnostics.log(ModuleEvent::layer2_base_start, now);
      break;
    case FunctionModeRow::Kind::layer2_extended:
      context_.diagnostics.log(ModuleEvent::layer2_extended_start, now);
      break;
  }
  context_.port->initialized(by_restart, now);
  controller_changed(now);
}

// The way out is the object dictionary's reset by the command interface, and a restart [ME3CAN1-Q 8.1.2].
bool ModuleEngine::configuration_is_faulty(can::Time now) {
  const auto faulty = context_.settings.faulty_mapping(context_.settings.node_id());
  if (!faulty) return false;
  context_.report("stays in initialization: the stored object dictionary is faulty at " +
                      canopen::object_text(faulty->index, faulty->sub) +
                      "; write 1011:01 by the CIF and restart",
                  now);
  return true;
}

void ModuleEngine::begin_restart(can::Time now) {
  // A restart is no cut of the supply: what was requested is saved.
  if (context_.settings.save_deadline() != can::never) end_save(now);
  // The frame is in the controller's queue before the node goes off; the controller goes off after it.
  if (context_.state.running() && context_.state.canopen_mode())
    controller_sends_last_ = node_.send_restart_emergency(now);
  restarting_ = true;
  begin_initialization(context_.profile.restart_time, now);
}

void ModuleEngine::receive(const can::Frame& frame, can::Time now) {
  if (!context_.state.running()) return;
  if (context_.state.canopen_mode()) {
    last_frame_ = now;
    if (node_.receive(frame, now)) update(now);
  } else if (layer2_.online()) {
    last_frame_ = now;
    layer2_.receive(frame, now);
    ++layer2_frames_;
    update(now);
  }
}

void ModuleEngine::transmitted(const can::Frame& frame, can::Time now) {
  last_frame_ = now;
  if (controller_sends_last_) return end_sending(frame);
  if (!context_.state.running()) return;
  if (context_.state.canopen_mode()) {
    if (node_.transmitted(frame, now)) update(now);
  } else {
    if (layer2_.transmitted(frame)) node_.command_frame_sent(now);
    update(now);
  }
}

void ModuleEngine::end_sending(const can::Frame& frame) {
  const EmergencyRow& row = context_.model.emergencies.restart;
  const bool is_last = frame.dlc == 8 && (frame.data[0] | frame.data[1] << 8) == row.code &&
                       std::equal(row.manufacturer.begin(), row.manufacturer.end(), &frame.data[3]);
  if (!is_last) return;
  controller_sends_last_ = false;
  controller_.set_power(false);
}

StartUp ModuleEngine::start_up() const noexcept {
  if (!node_.master().active()) return StartUp::none;
  if (node_.master().waits_for_own_start()) return StartUp::waits_for_own_start;
  if (node_.master().halted()) return StartUp::halted;
  return node_.master().starting() ? StartUp::booting : StartUp::ended;
}

void ModuleEngine::controller_changed(can::Time now) {
  if (!context_.state.running() || !node_.is_on_network()) return;
  controller_.changed(now);
  update(now);
}

void ModuleEngine::cpu_changed(CpuState state, can::Time now) {
  cpu_.changed(state, now);
  if (context_.state.running()) update(now);
}

void ModuleEngine::cpu_failed(can::Time now) {
  cpu_.failed();
  if (context_.state.running()) update(now);
}

void ModuleEngine::tick(can::Time now) {
  end_due_initialization(now);
  context_.port->tick(now);
  if (context_.watchdog.expires(is_online(), now)) cpu_.watchdog_expired(now);
  if (exchange_.end_if_due(now)) context_.port->done(Request::data_exchange, now);
  if (now >= context_.settings.save_deadline()) end_save(now);
  node_.tick(now);
  layer2_.tick(now);
  controller_.tick(now);
  update(now);
}

// After every event: what hangs on several causes.
void ModuleEngine::update(can::Time now) {
  if (!context_.state.works()) return;
  if (context_.state.running()) {
    cpu_.enter_due_stop(now);
    if (context_.state.canopen_mode()) {
      node_.send_emergencies(now);
      exchange_.exchange_if_operational(now);
    } else {
      node_.drop_emergencies();
      layer2_.leave_when_silent(now);
      if (context_.errors.track(ModuleError::message_slot, layer2_.slots().any_slot_error())) {
        context_.report("messages of a slot were lost: they come faster than the module takes them", now);
        context_.diagnostics.raise(Diagnosis::message_slot, now, {layer2_.slots().first_slot_error()});
      }
    }
    controller_.report_overflows(now);  // of what was sent just now, too
  }
  if (context_.settings.wore_out()) {  // the real flash memory; this one goes on
    context_.report("the flash memory has been written more often than the real one lasts for (" +
                        std::to_string(context_.model.data_sheet->flash_writes) + " times)",
                    now);
    context_.diagnostics.raise(Diagnosis::flash_worn, now);
  }
  save_is_refused_ = save_is_refused_ && layer2_.online();
  context_.errors.follow(ModuleError::save_while_online, save_is_refused_);
  change_log_.update(now);
  context_.errors.follow(ModuleError::hardware, context_.state.hardware_fault);
  context_.errors.follow(ModuleError::flash, context_.settings.error() || node_.has_damaged_files());
  context_.errors.follow(ModuleError::access_watchdog, context_.watchdog.expired());
  context_.errors.follow(ModuleError::emergency, node_.received_emergencies().any_active());
  context_.errors.track(ModuleError::node_failure, any_nmt_error());
  context_.port->show(now);
}

}  // namespace canopus::module
