#include "canopus/module/engine/network_events.hpp"

#include <string>
#include <utility>

namespace canopus::module {

NetworkEvents::NetworkEvents(ModuleContext& parts, CpuStateHandler& cpu, ControllerMonitor& controller,
                             can::Participant& module)
    : parts_(parts), cpu_(cpu), controller_(controller), module_(module) {
  parts_.node.set_listener(this);
  parts_.node.attach(0x0002, 0x0008, *this);
  parts_.master.set_listener(this);
}

void NetworkEvents::reset_requested(canopen::NmtCommand, can::Time now) {
  ++parts_.change_count;
  parts_.diagnostics.log(ModuleEvent::nmt_reset, now);
  parts_.status_words.show_nmt_reset(false);
  parts_.state.nmt_resetting = true;
  parts_.master.stop(now);
  // The own node is shown whether it is a master or not [ME3CAN1-Q 4.8.8].
  parts_.nmt_status.reset();
  parts_.nmt_status.set_state(parts_.node.node_id(), manager::node_state::reset_communication);
}

void NetworkEvents::defaults_loaded(canopen::NmtCommand, can::Time) {
  ++parts_.change_count;
  if (parts_.model.node_id_defaults != nullptr)
    parts_.model.node_id_defaults(parts_.node.dictionary(), parts_.node.node_id());
}

void NetworkEvents::reset_done(canopen::NmtCommand, can::Time now) {
  ++parts_.change_count;
  if (!parts_.concise_dcfs.load()) parts_.settings.note_error();
  parts_.time_stamp.show_role();
  parts_.nmt_status.reset();
  if (std::exchange(parts_.state.nmt_resetting, false)) parts_.status_words.show_nmt_reset(true);
  // The next frame of the node; without room it is lost.
  parts_.state.boot_up_waits = parts_.network.is_open() && parts_.controller.has_room();
  cpu_.node_starts(now);
}

// The data types 0002H-0008H are there for PDO mapping alone [ME3CAN1-Q 4.5].
canopen::AbortCode NetworkEvents::before_read(canopen::ObjectDictionary&, const canopen::Entry&, can::Time) {
  return canopen::AbortCode::no_object;
}

canopen::AbortCode NetworkEvents::before_write(canopen::ObjectDictionary&, const canopen::Entry&,
                                               std::span<const std::uint8_t>, can::Time) {
  return canopen::AbortCode::no_object;
}

void NetworkEvents::nmt_state_changed(canopen::NmtState state, can::Time now) {
  ++parts_.change_count;
  parts_.nmt_status.set_state(parts_.node.node_id(), static_cast<std::uint8_t>(state));
  parts_.diagnostics.log(ModuleEvent::nmt_state, now, static_cast<std::uint8_t>(state));
  parts_.master.own_state_changed(state, now);
  if (state == canopen::NmtState::stopped) parts_.command.bus_lost(command_error::wrong_state, now);
}

void NetworkEvents::emergency_received(const canopen::Emergency& message, can::Time now) {
  ++parts_.change_count;
  parts_.emergencies.record(message);
  if (!parts_.emergencies.held_clear())
    parts_.diagnostics.log(ModuleEvent::emergency_received, now, message.node_id);
  constexpr std::uint32_t is_slave = 1;
  if ((parts_.node.dictionary().get<std::uint32_t>(0x1F81, message.node_id, 0) & is_slave) != 0)
    parts_.errors.raise(ModuleError::slave_emergency);
  parts_.port->emergency_received(message, now);
}

void NetworkEvents::emergency_raised(const canopen::Emergency& message, can::Time now) {
  ++parts_.change_count;
  if (message.code != canopen::emcy_code::protocol_error) return;
  parts_.diagnostics.raise(Diagnosis::invalid_object, now,
                           {parts_.node.dictionary().get<std::uint32_t>(0x1005, 0) & 0x7FFU, message.code});
}

void NetworkEvents::rpdo_length_wrong(std::uint16_t number, std::uint16_t code, can::Time now) {
  ++parts_.change_count;
  parts_.diagnostics.raise(Diagnosis::rpdo_length, now, {number + 1U, code});
}

void NetworkEvents::rpdo_received(std::uint16_t number, can::Time) {
  parts_.process_data.rpdo_received(parts_.node, number);
  if (!parts_.lift.active()) return;
  ++parts_.change_count;
  parts_.lift.rpdo_received(number);
}

void NetworkEvents::time_received(const canopen::TimeOfDay& time, can::Time now) {
  ++parts_.change_count;
  parts_.status_words.show_time();
  parts_.time_stamp.receive(time, now);
}

void NetworkEvents::heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) {
  parts_.master.heartbeat_received(node_id, state, now);
}

void NetworkEvents::heartbeat_lost(std::uint8_t node_id, can::Time now) {
  ++parts_.change_count;
  parts_.master.heartbeat_lost(node_id, now);
}

void NetworkEvents::life_guarding_event(bool occurred, can::Time now) {
  ++parts_.change_count;
  const std::uint8_t own = parts_.node.node_id();
  if (!occurred || parts_.nmt_status.held_clear(own)) return;
  parts_.diagnostics.log(ModuleEvent::life_guarding, now);
  // The master's number is not known to a guarded slave, so the failure is shown at the own word.
  parts_.nmt_status.set_guarding_master(own, manager::error_control::life_guarding);
}

void NetworkEvents::life_guarding_running(bool running, can::Time) {
  ++parts_.change_count;
  constexpr std::uint16_t active = manager::error_control::guarding_active;
  parts_.nmt_status.set_guarding_master(parts_.node.node_id(), running ? active : 0, running ? 0 : active);
}

void NetworkEvents::life_guarding_missed(can::Time) {
  ++parts_.change_count;
  const std::uint8_t own = parts_.node.node_id();
  if (parts_.nmt_status.held_clear(own)) return;
  parts_.nmt_status.set_guarding_master(own, manager::error_control::guarding_miss);
}

// Any change of the configuration makes its date and time invalid [ME3CAN1-Q 4.8.12].
void NetworkEvents::object_written(const canopen::Entry& entry, can::Time now) {
  ++parts_.change_count;
  if (entry.index == 0x1010 || entry.index == 0x1F22) parts_.diagnostics.log(ModuleEvent::saved, now);
  if (entry.index == 0x1011) parts_.diagnostics.log(ModuleEvent::restored, now);
  if (entry.index == 0x1011) clear_concise_dcfs_ = true;  // it took "load" [ME3CAN1-Q 4.6.11]
  if (entry.index == 0x1011 && parts_.model.restore_clears_files_at_once) parts_.concise_dcfs.clear();
  if (entry.index == 0x1012) parts_.time_stamp.show_role();
  if (!entry.description->stored || entry.index == 0x1020) return;
  parts_.node.dictionary().set<std::uint32_t>(0x1020, 1, 0);
  parts_.node.dictionary().set<std::uint32_t>(0x1020, 2, 0);
}

void NetworkEvents::boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) {
  ++parts_.change_count;
  parts_.port->boot_went_on(node_id, record, now);
  if (parts_.observer != nullptr) parts_.observer->slave_boot_went_on(node_id, record, now);
}

void NetworkEvents::slave_failed(std::uint8_t node_id, manager::BootError error, can::Time now) {
  ++parts_.change_count;
  const bool configuration = error == manager::BootError::configuration;
  parts_.diagnostics.raise(configuration ? Diagnosis::slave_configuration : Diagnosis::slave_boot, now,
                           {node_id, static_cast<std::uint8_t>(error)});
}

void NetworkEvents::start_up_halted(std::uint8_t node_id, manager::BootError error, can::Time now) {
  ++parts_.change_count;
  parts_.diagnostics.raise(Diagnosis::start_up, now, {static_cast<std::uint8_t>(error)});
  parts_.report("the start-up of the network has ended: node " + std::to_string(node_id) +
                    " is mandatory (1F81H bit 3) and was not booted",
                now);
}

void NetworkEvents::error_control_event(std::uint8_t node_id, manager::ErrorControlEvent event, can::Time) {
  ++parts_.change_count;
  // The node reports a lost heartbeat itself; guarding is the master's.
  if (event == manager::ErrorControlEvent::heartbeat_lost) return;
  parts_.own_emergencies.raise(parts_.model.emergencies.node_lost, node_id);
}

void NetworkEvents::lss_active_changed(bool active, can::Time now) {
  ++parts_.change_count;
  // A slave at another bit rate, which the search is for, can drive the module bus-off: that must not end it.
  parts_.controller.set_automatic_recovery(active);
  if (active) parts_.report("the boot time is over: missing slaves are looked for by LSS", now);
}

void NetworkEvents::change_bit_rate(std::uint32_t bit_rate, can::Time now) {
  ++parts_.change_count;
  controller_.restart(bit_rate);
  // What the controller meets at another bit rate is no error of this network.
  parts_.network.open(true);
  module_.controller_changed(now);
  parts_.network.open(bit_rate == parts_.state.bit_rate * 1000U);
}

void NetworkEvents::lss_search_ended(std::uint8_t node_id, bool found, can::Time now) {
  ++parts_.change_count;
  std::string text = "LSS: the slave for node-ID " + std::to_string(node_id);
  text += found ? " was found and has its node-ID and bit rate" : " was not found at any bit rate";
  parts_.report(text, now);
}

void NetworkEvents::node_state_changed(std::uint8_t node_id, std::uint8_t state, can::Time) {
  ++parts_.change_count;
  parts_.nmt_status.set_state(node_id, state);
}

void NetworkEvents::error_control_changed(std::uint8_t node_id, std::uint16_t bits, can::Time now) {
  ++parts_.change_count;
  parts_.port->error_control_changed(node_id, bits, now);
  const unsigned new_bits = bits & ~parts_.nmt_status.status(node_id) & manager::error_control::errors;
  if (new_bits != 0 && !parts_.nmt_status.held_clear(node_id))
    parts_.diagnostics.log(ModuleEvent::error_control, now, node_id);
  if (parts_.nmt_status.held_clear(node_id) && (bits & manager::error_control::errors) != 0) {
    parts_.nmt_status.set_status(node_id, bits & static_cast<std::uint16_t>(~manager::error_control::errors));
    parts_.master.clear_error_control(node_id, now);
    return;
  }
  parts_.nmt_status.set_status(node_id, bits);
}

}  // namespace canopus::module
