#include "canopus/module/engine/master_events.hpp"

#include <string>

namespace canopus::module {

MasterEvents::MasterEvents(ModuleContext& parts, ControllerMonitor& controller, can::Participant& module)
    : parts_(parts), controller_(controller), module_(module) {
  parts_.master.set_listener(this);
}

void MasterEvents::boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) {
  ++parts_.change_count;
  parts_.port->boot_went_on(node_id, record, now);
  if (parts_.observer != nullptr) parts_.observer->slave_boot_went_on(node_id, record, now);
}

void MasterEvents::slave_failed(std::uint8_t node_id, manager::BootError error, can::Time now) {
  ++parts_.change_count;
  const bool configuration = error == manager::BootError::configuration;
  parts_.diagnostics.raise(configuration ? Diagnosis::slave_configuration : Diagnosis::slave_boot, now,
                           {node_id, static_cast<std::uint8_t>(error)});
}

void MasterEvents::start_up_halted(std::uint8_t node_id, manager::BootError error, can::Time now) {
  ++parts_.change_count;
  parts_.diagnostics.raise(Diagnosis::start_up, now, {static_cast<std::uint8_t>(error)});
  parts_.report("the start-up of the network has ended: node " + std::to_string(node_id) +
                    " is mandatory (1F81H bit 3) and was not booted",
                now);
}

void MasterEvents::error_control_event(std::uint8_t node_id, manager::ErrorControlEvent event, can::Time) {
  ++parts_.change_count;
  // The node reports a lost heartbeat itself; guarding is the master's.
  if (event == manager::ErrorControlEvent::heartbeat_lost) return;
  parts_.own_emergencies.raise(parts_.model.emergencies.node_lost, node_id);
}

void MasterEvents::lss_active_changed(bool active, can::Time now) {
  ++parts_.change_count;
  // A slave at another bit rate, which the search is for, can drive the module bus-off: that must not end it.
  parts_.controller.set_automatic_recovery(active);
  if (active) parts_.report("the boot time is over: missing slaves are looked for by LSS", now);
}

void MasterEvents::change_bit_rate(std::uint32_t bit_rate, can::Time now) {
  ++parts_.change_count;
  controller_.restart(bit_rate);
  // What the controller meets at another bit rate is no error of this network.
  parts_.network.open(true);
  module_.controller_changed(now);
  parts_.network.open(bit_rate == parts_.state.bit_rate * 1000U);
}

void MasterEvents::lss_search_ended(std::uint8_t node_id, bool found, can::Time now) {
  ++parts_.change_count;
  std::string text = "LSS: the slave for node-ID " + std::to_string(node_id);
  text += found ? " was found and has its node-ID and bit rate" : " was not found at any bit rate";
  parts_.report(text, now);
}

void MasterEvents::node_state_changed(std::uint8_t node_id, std::uint8_t state, can::Time) {
  ++parts_.change_count;
  parts_.nmt_status.set_state(node_id, state);
}

void MasterEvents::error_control_changed(std::uint8_t node_id, std::uint16_t bits, can::Time now) {
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
