#include "canopus/module/engine/module_command_host.hpp"

#include "canopus/module/commands/pdo_mapping.hpp"
#include "canopus/module/engine/module_context.hpp"

namespace canopus::module {

std::uint8_t ModuleCommandHost::own_node_id() const { return parts_.node.node_id(); }

canopen::ObjectDictionary& ModuleCommandHost::dictionary() { return parts_.node.dictionary(); }

can::Duration ModuleCommandHost::sdo_time_out() const { return parts_.network_settings.sdo_time_out(); }

bool ModuleCommandHost::sdo_channel_free(std::uint8_t node_id) const {
  return !parts_.master.sdo_channel_busy(node_id);
}

void ModuleCommandHost::command_finished(can::Time now) { parts_.port->done(Request::command, now); }

bool ModuleCommandHost::is_nmt_master() const { return parts_.is_master_by_role(); }

std::uint16_t ModuleCommandHost::pdos() const { return parts_.model.program_interface.process_data.pdos; }

void ModuleCommandHost::map_pdos(PdoMapping mapping, can::Time now) {
  const canopen::ObjectDictionary factory(parts_.model.object_dictionary(), parts_.node.node_id());
  set_pdo_mapping(parts_.node.dictionary(), factory, own_node_id(), pdos(), mapping, now);
  if (parts_.model.mapping_clears_words) parts_.process_data.clear();
}

bool ModuleCommandHost::holds_commands() const {
  return parts_.model.cpu.watchdog_holds_commands && parts_.watchdog.expired();
}

bool ModuleCommandHost::send_now(const can::Frame& frame) {
  const bool sends = parts_.controller.error_state() != can::ErrorState::bus_off &&
                     parts_.controller.has_room() && parts_.controller.send(frame);
  if (!sends) parts_.errors.raise(ModuleError::command_overflow);
  return sends;
}

EmergencyBuffer& ModuleCommandHost::emergencies() { return parts_.emergencies; }

const NmtStatus& ModuleCommandHost::nmt_status() const { return parts_.nmt_status; }

void ModuleCommandHost::clear_error_control(std::uint8_t node_id, can::Time now) {
  parts_.nmt_status.clear_life_guarding(node_id);
  parts_.master.clear_error_control(node_id, now);
}

std::uint16_t ModuleCommandHost::bus_obstacle() const {
  if (parts_.controller.error_state() == can::ErrorState::bus_off) return command_error::bus_off;
  if (!parts_.state.canopen_mode())
    return parts_.layer2.online() ? std::uint16_t{0} : command_error::wrong_state;
  const canopen::NmtState state = parts_.node.state();
  const bool usable = state == canopen::NmtState::pre_operational || state == canopen::NmtState::operational;
  return usable ? std::uint16_t{0} : command_error::wrong_state;
}

CommandHost::EmergencyAnswer ModuleCommandHost::send_emergency(std::uint16_t code,
                                                               std::uint8_t error_register,
                                                               std::span<const std::uint8_t, 5> manufacturer,
                                                               can::Time now) {
  if (bus_obstacle() != 0) return EmergencyAnswer::wrong_state;
  if (!parts_.node.emergency(code, error_register, manufacturer, now)) return EmergencyAnswer::inhibited;
  parts_.diagnostics.log(ModuleEvent::emergency_sent, now);
  return EmergencyAnswer::sent;
}

PlainFrameResult ModuleCommandHost::send_plain_frame(std::span<const std::uint16_t> parameters,
                                                     std::span<std::uint16_t> faults) {
  return parts_.layer2.send(parameters, faults);
}

}  // namespace canopus::module
