// Life cycle: construction, supply, initialization, restart, CPU.

#include "canopus/module/module_engine.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

namespace canopus::module {

namespace {

// 1029H:01.
constexpr std::uint8_t no_change_on_error = 1;
constexpr std::uint8_t stopped_on_error = 2;

Layer2Rules layer2_rules(const ModuleModel& model, const Profile& profile) {
  Layer2Rules rules = model.layer2_rules;
  rules.cycle_unit = profile.layer2_cycle_unit;
  rules.message_time = profile.layer2_message_time;
  rules.waiting_messages = profile.layer2_waiting_messages;
  return rules;
}

canopen::NodeOptions node_options(const ModuleModel& model, const Profile& profile) {
  canopen::NodeOptions options = model.node_options();
  options.reset_time = profile.nmt_reset_time;
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
      settings_(model, memory, buffer_),
      errors_(model.error_status),
      emergencies_(model.words.emergencies, model.emergency_records.stack, model.emergency_records.ring),
      nmt_status_(model.words.error_control_status, model.words.nmt_state),
      node_(model.object_dictionary(), 127, network_, node_options(model, profile_)),
      master_(node_, controller, model.master_options()),
      command_(model.words.command, model.commands, *this, network_),
      exchange_(model.program_interface.process_data, buffer_),
      layer2_(model.layer2, layer2_rules(model, profile_), buffer_, controller),
      time_stamp_(model.time_stamp, buffer_),
      concise_dcfs_(node_, master_, settings_.flash(), ModuleSettings::concise_dcfs_name,
                    {.erase_time = profile_.erase_time}),
      mode_(&model.function_modes.front()) {
  controller_.set_automatic_recovery(false);  // the way out of bus-off is a restart [ME3CAN1-Q 3.5.7]
  node_.set_listener(this);
  master_.set_listener(this);
  node_.dictionary().attach(0x0002, 0x0008, *this);
  node_.dictionary().attach(0x1010, 0x1011, *this);
  exchange_.attach(node_.dictionary());

  const SystemWords& words = model_.words;
  for (const BufferAddress address :
       {words.data_exchange_control, words.communication_status, words.transmit_errors, words.receive_errors,
        words.active_baud_rate, model_.time_stamp.role()}) {
    buffer_.attach(address, address, status_words_);
  }
  for (const BufferAddress address : {model_.error_status.status, model_.error_status.setting_address,
                                      model_.error_status.refused_address}) {
    buffer_.attach(address, address, errors_);
  }
  buffer_.attach(words.error_control_status + 1, words.error_control_status + 127, nmt_status_);
  buffer_.attach(words.nmt_state + 1, words.nmt_state + 127, nmt_status_);
  buffer_.attach(words.emergencies, emergencies_.last_address(), emergencies_);
  buffer_.attach(words.command, words.command + CommandInterface::word_count - 1, command_);
  events_.reserve(most_events);
}

bool ModuleEngine::preset_word(BufferAddress address, std::uint16_t value) {
  return settings_.preset_word(address, value);
}
bool ModuleEngine::preset_bit_rate(std::uint32_t bit_rate) {
  return bit_rate % 1000 == 0 && bit_rate <= 1'000'000 &&
         preset_word(model_.words.baud_rate, static_cast<std::uint16_t>(bit_rate / 1000));
}
bool ModuleEngine::preset_node_id(std::uint8_t node_id) {
  return preset_word(model_.words.node_address, node_id);
}
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

bool ModuleEngine::initializing() const noexcept {
  return state_ == State::initializing || state_ == State::stuck || nmt_resetting_;
}

Layer2State ModuleEngine::layer2_state() const noexcept {
  if (canopen_mode()) return Layer2State::inactive;
  return layer2_.online() ? Layer2State::online : Layer2State::offline;
}

void ModuleEngine::power_on(can::Time now) {
  if (state_ != State::off) return;
  restarting_ = false;
  clear_concise_dcfs_ = false;  // kept in RAM: only a restart carries it out
  begin_initialization(profile_.power_on_time, now);
}

void ModuleEngine::power_off(can::Time now) {
  if (state_ == State::off) return;
  state_ = State::off;
  hardware_fault_ = false;
  master_.stop(now);
  node_.power_off();
  layer2_.go_offline();
  command_.reset();
  nmt_resetting_ = false;
  initialized_at_ = exchange_end_ = save_end_ = can::never;
  events_.clear();
  events_due_ = can::never;
  went_off(now);
}

void ModuleEngine::inject(ModuleFault fault, can::Time now) {
  if (state_ == State::off) return;
  switch (fault) {
    case ModuleFault::hardware_error:
      hardware_fault_ = true;
      fault_found(now);
      tell("hardware error", now);
      // A severe error that the device causes itself acts as a communication error does [ME3CAN1-Q 4.7].
      if (state_ == State::running && canopen_mode()) node_.communication_error(now);
      return update(now);
    case ModuleFault::watchdog_error:
      power_off(now);  // until the supply has been off
      return tell("watchdog error", now);
  }
}

// [ME3CAN1-Q 3.3.2, 3.5.5] From the start of a restart on the module is off the bus; what it holds is what
// its flash memory holds.
void ModuleEngine::begin_initialization(can::Duration duration, can::Time now) {
  state_ = State::initializing;
  initialized_at_ = can::later(now, duration);
  exchange_end_ = save_end_ = can::never;
  process_data_pending_ = emergencies_pending_ = exchange_running_ = false;
  nmt_resetting_ = nmt_reset_seen_ = time_seen_ = false;
  events_.clear();
  events_due_ = can::never;
  master_.stop(now);
  node_.power_off();
  layer2_.go_offline();
  errors_.reset();
  emergencies_.clear();
  nmt_status_.reset();
  command_.reset();
  exchange_.reset();
  initialization_begins(now);
  if (std::exchange(clear_concise_dcfs_, false)) concise_dcfs_.clear();
  mode_ = &settings_.load();
  if (canopen_mode()) time_stamp_.reset();
  layer2_.start(mode_->kind == FunctionModeRow::Kind::layer2_extended);
  update(now);
}

void ModuleEngine::end_due_initialization(can::Time now) {
  if (now < initialized_at_) return;
  initialized_at_ = can::never;
  if (canopen_mode() && model_.faulty_mapping_keeps_initializing && configuration_is_faulty(now)) {
    state_ = State::stuck;
    return;
  }
  state_ = State::running;
  bit_rate_ = buffer_.word(model_.words.baud_rate);
  controller_.restart(bit_rate_ * 1000U);
  overflows_ = 0;
  if (canopen_mode()) {
    node_.set_node_id(static_cast<std::uint8_t>(buffer_.word(model_.words.node_address)));
    use_communication_settings();
    node_.power_on(now);
  }
  initialized(std::exchange(restarting_, false), now);
  controller_changed(now);
}

// The way out is the object dictionary's reset by the command interface, and a restart [ME3CAN1-Q 8.1.2].
bool ModuleEngine::configuration_is_faulty(can::Time now) {
  const auto faulty =
      settings_.faulty_mapping(static_cast<std::uint8_t>(buffer_.word(model_.words.node_address)));
  if (!faulty) return false;
  std::array<char, 120> text{};
  const int length =
      std::snprintf(text.data(), text.size(),
                    "stays in initialization: the stored object dictionary is faulty at %04XH:%02X; "
                    "write 1011H:01 by the CIF and restart",
                    faulty->index, faulty->sub);
  tell({text.data(), static_cast<std::size_t>(length)}, now);
  return true;
}

void ModuleEngine::begin_restart(can::Time now) {
  // A restart is no cut of the supply: what was asked for is saved.
  if (save_end_ != can::never) end_save(now);
  // The frame is in the controller's queue before the node goes off; the controller starts anew only at the
  // end of the initialization, so it leaves.
  if (state_ == State::running && canopen_mode()) {
    const EmergencyRow& row = model_.emergencies.restart;
    node_.emergency(row.code, row.error_register, row.manufacturer, now);
  }
  restarting_ = true;
  begin_initialization(profile_.restart_time, now);
}

void ModuleEngine::use_communication_settings() {
  master_.options().start_all_delay = std::chrono::milliseconds(buffer_.word(model_.words.start_all_delay));
  master_.options().sdo_time_out = sdo_time_out();
  master_.options().bit_rate = bit_rate_ * 1000U;
}

void ModuleEngine::cpu_changed(CpuState state, can::Time now) {
  const CpuState before = cpu_;
  cpu_ = state;
  const bool failed = std::exchange(cpu_failed_, false);
  if (state_ != State::running) return;
  const bool stopped = before == CpuState::run && state == CpuState::stop;
  if (!canopen_mode()) {
    if (stopped) layer2_.cpu_stopped();
  } else if (stopped) {
    // One error, one message: a CPU error's STOP is not told as RUN to STOP besides [ME3CAN1-Q 8.2.2].
    raise_event(failed ? model_.emergencies.cpu_error : model_.emergencies.cpu_stopped);
    // [ME3CAN1-Q 4.7] 1 means no change on communication errors, yet STOP still leads to Pre-operational.
    const auto behaviour = node_.dictionary().get<std::uint8_t>(0x1029, 1);
    if (behaviour == stopped_on_error) {
      node_.command(canopen::NmtCommand::stop, now);
    } else if (node_.state() == canopen::NmtState::operational) {
      node_.command(canopen::NmtCommand::enter_pre_operational, now);
    }
  }
  update(now);
}

void ModuleEngine::cpu_failed(can::Time now) {
  cpu_failed_ = cpu_ == CpuState::run;
  if (cpu_failed_ || state_ != State::running || !canopen_mode()) return;
  raise_event(model_.emergencies.cpu_error);  // it was in STOP already
  update(now);
}

bool ModuleEngine::may_become_operational() {
  return cpu_ == CpuState::run || node_.dictionary().get<std::uint8_t>(0x1029, 1) == no_change_on_error;
}

void ModuleEngine::tick(can::Time now) {
  end_due_initialization(now);
  if (now >= exchange_end_) end_exchange(now);
  if (now >= save_end_) end_save(now);
  if (state_ == State::running && now >= time_stamp_.next_transmission()) send_time(now);
  if (now >= node_.deadline()) node_.tick(now);
  if (now >= master_.deadline()) master_.tick(now);
  if (now >= command_.deadline()) command_.tick(now);
  if (now >= layer2_.deadline()) layer2_.tick(now);
  update(now);
}

can::Time ModuleEngine::deadline() const noexcept {
  const can::Time time_due = state_ == State::running ? time_stamp_.next_transmission() : can::never;
  return std::min({events_due_, initialized_at_, exchange_end_, save_end_, time_due, node_.deadline(),
                   master_.deadline(), command_.deadline(), layer2_.deadline()});
}

// After every event: what hangs on several causes.
void ModuleEngine::update(can::Time now) {
  if (state_ == State::off) return;
  if (state_ == State::running) {
    look_at_overflows(now);
    if (canopen_mode()) {
      send_events(now);
      if (process_data_pending_ && node_.state() == canopen::NmtState::operational) {
        exchange_process_data(now);
      }
    } else {
      events_.clear();
      if (layer2_.any_slot_error() && errors_.raise(model_.errors.message_slot)) {
        tell("messages of a slot were lost: they come faster than the module takes them", now);
      }
    }
  }
  if (settings_.wore_out()) {  // the real flash memory; this one goes on
    tell("the flash memory has been written more often than the real one lasts for (" +
             std::to_string(model_.data_sheet->flash_writes) + " times)",
         now);
  }
  errors_.follow(model_.errors.hardware, hardware_fault_);
  errors_.follow(model_.errors.flash, settings_.error());
  show(now);
}

void ModuleEngine::tell(std::string_view what, can::Time now) {
  if (observer_ != nullptr) observer_->error_raised(what, now);
}

}  // namespace canopus::module
