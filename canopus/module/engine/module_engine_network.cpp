// The network's side of the engine: what the CANopen node, the NMT master and the controller report, and what
// the command interface asks of them.

#include <algorithm>
#include <string>
#include <utility>

#include "canopus/module/engine/module_engine.hpp"

namespace canopus::module {

namespace {

// The inhibit time of EMCY counts in milliseconds [ME3CAN1-Q 4.6.12].
constexpr can::Duration emergency_retry = std::chrono::milliseconds(1);

}  // namespace

void ModuleEngine::receive(const can::Frame& frame, can::Time now) {
  if (!state_.running() || layer2_state() == Layer2State::offline) return;
  last_frame_ = now;
  if (state_.canopen_mode()) {
    if (network_.is_open()) node_.receive(frame, now);
    master_.receive(frame, now);
    if (network_.is_open()) command_.receive(frame, now);
  } else {
    layer2_.receive(frame, now);
  }
  update(now);
}

void ModuleEngine::transmitted(const can::Frame& frame, can::Time now) {
  last_frame_ = now;
  if (controller_sends_last_) return end_sending(frame);
  if (!state_.running()) return;
  if (state_.canopen_mode()) {
    node_.transmitted(frame, now);
    return master_.transmitted(frame, now);
  }
  layer2_.transmitted(frame);
  if (layer2_.takes_command_frame(frame)) command_.frame_sent(now);
  update(now);
}

void ModuleEngine::end_sending(const can::Frame& frame) {
  const EmergencyRow& row = model_.emergencies.restart;
  const bool is_last = frame.dlc == 8 && (frame.data[0] | frame.data[1] << 8) == row.code &&
                       std::equal(row.manufacturer.begin(), row.manufacturer.end(), &frame.data[3]);
  if (!is_last) return;
  controller_sends_last_ = false;
  controller_.set_power(false);
}

void ModuleEngine::controller_changed(can::Time now) {
  if (!state_.running() || !network_.is_open()) return;
  const can::ErrorState state = controller_.error_state();
  const bool was_off = errors_.has(ModuleError::bus_off);
  errors_.follow(ModuleError::bus_off, state == can::ErrorState::bus_off);
  if (errors_.follow(ModuleError::error_passive, state == can::ErrorState::error_passive) &&
      errors_.has(ModuleError::error_passive)) {
    raise_event(model_.emergencies.error_passive);
    diagnostics_.log(ModuleEvent::error_passive, now);
  }
  const bool warning =
      state == can::ErrorState::error_active && error_counter(controller_) >= warning_counter;
  if (warning && !logged_warning_) diagnostics_.log(ModuleEvent::warning_level, now);
  logged_warning_ = warning;
  if (!was_off && errors_.has(ModuleError::bus_off)) {
    report("the CAN controller is bus-off", now);
    diagnostics_.raise(Diagnosis::bus_off, now);
    command_.bus_lost(command_error::bus_off, now);
    if (state_.canopen_mode()) node_.communication_error(now);
  }
  update(now);
}

void ModuleEngine::look_at_overflows(can::Time now) {
  const std::uint32_t overflows = controller_.transmit_overflows() + controller_.receive_overflows();
  if (overflows == overflows_) return;
  overflows_ = overflows;
  if (!errors_.raise(ModuleError::queue_overflow)) return;
  raise_event(model_.emergencies.queue_overflow);
  report("a queue has overflown: frames were lost", now);
  diagnostics_.raise(Diagnosis::queue_overflow, now);
}

void ModuleEngine::send_events(can::Time now) {
  if (node_.state() != canopen::NmtState::pre_operational &&
      node_.state() != canopen::NmtState::operational) {
    events_.clear();
  }
  const auto held_back = std::ranges::find_if_not(events_, [&](const Event& event) {
    return node_.emergency(static_cast<std::uint16_t>(event.row->code + event.node_id),
                           event.row->error_register, event.row->manufacturer, now);
  });
  events_.erase(events_.begin(), held_back);
  events_due_ = events_.empty() ? can::never : can::later(now, emergency_retry);
}

void ModuleEngine::reset_requested(canopen::NmtCommand, can::Time now) {
  diagnostics_.log(ModuleEvent::nmt_reset, now);
  status_words_.show_nmt_reset(false);
  state_.nmt_resetting = true;
  master_.stop(now);
  // The own node is shown whether it is a master or not [ME3CAN1-Q 4.8.8].
  nmt_status_.reset();
  nmt_status_.set_state(node_.node_id(), manager::node_state::reset_communication);
}

void ModuleEngine::defaults_loaded(canopen::NmtCommand, can::Time) {
  if (model_.node_id_defaults != nullptr) model_.node_id_defaults(node_.dictionary(), node_.node_id());
}

void ModuleEngine::reset_done(canopen::NmtCommand, can::Time now) {
  if (!concise_dcfs_.load()) settings_.note_error();
  time_stamp_.show_role();
  nmt_status_.reset();
  if (std::exchange(state_.nmt_resetting, false)) status_words_.show_nmt_reset(true);
  const bool stopped = state_.cpu == CpuState::stop;
  const bool has_no_role = stopped && model_.cpu.stop_ends_master && is_master_by_role();
  stop_is_due_ = stopped && model_.cpu.stop_at_start_counts;
  node_.pause_heartbeat(has_no_role, now);
  if (!has_no_role) master_.start(now);
}

// The data types 0002H-0008H are there for PDO mapping alone [ME3CAN1-Q 4.5].
canopen::AbortCode ModuleEngine::before_read(canopen::ObjectDictionary&, const canopen::Entry&, can::Time) {
  return canopen::AbortCode::no_object;
}

canopen::AbortCode ModuleEngine::before_write(canopen::ObjectDictionary&, const canopen::Entry&,
                                              std::span<const std::uint8_t>, can::Time) {
  return canopen::AbortCode::no_object;
}

void ModuleEngine::nmt_state_changed(canopen::NmtState state, can::Time now) {
  nmt_status_.set_state(node_.node_id(), static_cast<std::uint8_t>(state));
  diagnostics_.log(ModuleEvent::nmt_state, now, static_cast<std::uint8_t>(state));
  master_.own_state_changed(state, now);
  if (state == canopen::NmtState::stopped) command_.bus_lost(command_error::wrong_state, now);
}

void ModuleEngine::emergency_received(const canopen::Emergency& message, can::Time now) {
  emergencies_.record(message);
  if (!emergencies_.held_clear()) diagnostics_.log(ModuleEvent::emergency_received, now, message.node_id);
  port_->emergency_received(message, now);
}

void ModuleEngine::rpdo_received(std::uint16_t number, can::Time) {
  process_data_.rpdo_received(node_, number);
}

void ModuleEngine::time_received(const canopen::TimeOfDay& time, can::Time now) {
  status_words_.show_time();
  time_stamp_.receive(time, now);
}

void ModuleEngine::heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) {
  master_.heartbeat_received(node_id, state, now);
}

void ModuleEngine::heartbeat_lost(std::uint8_t node_id, can::Time now) {
  master_.heartbeat_lost(node_id, now);
}

void ModuleEngine::life_guarding_event(bool occurred, can::Time now) {
  if (occurred && !nmt_status_.held_clear(node_.node_id())) diagnostics_.log(ModuleEvent::life_guarding, now);
  // The master's own number is not known to a guarded slave, so the failure is shown at the own word.
  if (occurred && !nmt_status_.held_clear(node_.node_id())) nmt_status_.set_life_guarding(node_.node_id());
}

// Any change of the configuration makes its date and time invalid [ME3CAN1-Q 4.8.12].
void ModuleEngine::object_written(const canopen::Entry& entry, can::Time now) {
  if (entry.index == 0x1010 || entry.index == 0x1F22) diagnostics_.log(ModuleEvent::saved, now);
  if (entry.index == 0x1011) diagnostics_.log(ModuleEvent::restored, now);
  if (entry.index == 0x1011) clear_concise_dcfs_ = true;  // it took "load" [ME3CAN1-Q 4.6.11]
  if (entry.index == 0x1012) time_stamp_.show_role();
  if (!entry.description->stored || entry.index == 0x1020) return;
  node_.dictionary().set<std::uint32_t>(0x1020, 1, 0);
  node_.dictionary().set<std::uint32_t>(0x1020, 2, 0);
}

void ModuleEngine::boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) {
  port_->boot_went_on(node_id, record, now);
  if (observer_ != nullptr) observer_->slave_boot_went_on(node_id, record, now);
}

void ModuleEngine::slave_failed(std::uint8_t node_id, manager::BootError error, can::Time now) {
  const bool configuration = error == manager::BootError::configuration;
  diagnostics_.raise(configuration ? Diagnosis::slave_configuration : Diagnosis::slave_boot, now,
                     {node_id, static_cast<std::uint8_t>(error)});
}

// The emergency code says which rule a received frame broke.
void ModuleEngine::emergency_raised(const canopen::Emergency& message, can::Time now) {
  namespace code = canopen::emcy_code;
  if (message.code == code::pdo_too_short || message.code == code::pdo_too_long) {
    diagnostics_.raise(Diagnosis::rpdo_length, now, {message.manufacturer[0], message.code});
  } else if (message.code == code::protocol_error) {
    diagnostics_.raise(Diagnosis::invalid_object, now,
                       {node_.dictionary().get<std::uint32_t>(0x1005, 0) & 0x7FFU, message.code});
  }
}

void ModuleEngine::start_up_halted(std::uint8_t node_id, manager::BootError error, can::Time now) {
  diagnostics_.raise(Diagnosis::start_up, now, {static_cast<std::uint8_t>(error)});
  report("the start-up of the network has ended: node " + std::to_string(node_id) +
             " is mandatory (1F81H bit 3) and was not booted",
         now);
}

void ModuleEngine::error_control_event(std::uint8_t node_id, manager::ErrorControlEvent event, can::Time) {
  // The node reports a lost heartbeat itself; guarding is the master's.
  if (event == manager::ErrorControlEvent::heartbeat_lost) return;
  raise_event(model_.emergencies.node_lost, node_id);
}

void ModuleEngine::lss_active_changed(bool active, can::Time now) {
  // A slave at another bit rate, which the search is for, can drive the module bus-off: that must not end it.
  controller_.set_automatic_recovery(active);
  if (active) report("the boot time is over: missing slaves are looked for by LSS", now);
}

void ModuleEngine::change_bit_rate(std::uint32_t bit_rate, can::Time now) {
  controller_.restart(bit_rate);
  overflows_ = 0;
  // What the controller meets at another bit rate is no error of this network.
  network_.open(true);
  controller_changed(now);
  network_.open(bit_rate == state_.bit_rate * 1000U);
}

void ModuleEngine::lss_search_ended(std::uint8_t node_id, bool found, can::Time now) {
  std::string text = "LSS: the slave for node-ID " + std::to_string(node_id);
  text += found ? " was found and has its node-ID and bit rate" : " was not found at any bit rate";
  report(text, now);
}

void ModuleEngine::node_state_changed(std::uint8_t node_id, std::uint8_t state, can::Time) {
  nmt_status_.set_state(node_id, state);
}

void ModuleEngine::error_control_changed(std::uint8_t node_id, std::uint16_t bits, can::Time now) {
  port_->error_control_changed(node_id, bits, now);
  const unsigned news = bits & ~nmt_status_.status(node_id) & manager::error_control::errors;
  if (news != 0 && !nmt_status_.held_clear(node_id))
    diagnostics_.log(ModuleEvent::error_control, now, node_id);
  if (nmt_status_.held_clear(node_id) && (bits & manager::error_control::errors) != 0) {
    nmt_status_.set_status(node_id, bits & static_cast<std::uint16_t>(~manager::error_control::errors));
    master_.clear_error_control(node_id, now);
    return;
  }
  nmt_status_.set_status(node_id, bits);
}

StartUp ModuleEngine::start_up() const noexcept {
  if (!master_.active()) return StartUp::none;
  if (master_.waits_for_own_start()) return StartUp::waits_for_own_start;
  return master_.starting() ? StartUp::booting : StartUp::ended;
}

std::uint16_t ModuleEngine::bus_obstacle() const {
  if (controller_.error_state() == can::ErrorState::bus_off) return command_error::bus_off;
  if (!state_.canopen_mode()) return layer2_.online() ? std::uint16_t{0} : command_error::wrong_state;
  const canopen::NmtState state = node_.state();
  const bool usable = state == canopen::NmtState::pre_operational || state == canopen::NmtState::operational;
  return usable ? std::uint16_t{0} : command_error::wrong_state;
}

CommandHost::EmergencyAnswer ModuleEngine::send_emergency(std::uint16_t code, std::uint8_t error_register,
                                                          std::span<const std::uint8_t, 5> manufacturer,
                                                          can::Time now) {
  if (bus_obstacle() != 0) return EmergencyAnswer::wrong_state;
  if (!node_.emergency(code, error_register, manufacturer, now)) return EmergencyAnswer::inhibited;
  diagnostics_.log(ModuleEvent::emergency_sent, now);
  return EmergencyAnswer::sent;
}

CommandHost::FrameAnswer ModuleEngine::send_plain_frame(std::span<const std::uint16_t> parameters,
                                                        std::span<std::uint16_t> faults) {
  return layer2_.send(parameters, faults);
}

}  // namespace canopus::module
