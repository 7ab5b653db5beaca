#include "canopus/module/engine/module_context.hpp"

#include <string>

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

}  // namespace

ModuleContext::ModuleContext(const ModuleModel& the_model, can::Controller& the_controller,
                             NonVolatileMemory& memory, const Profile& the_profile, CommandHost& host)
    : model(the_model),
      controller(the_controller),
      network(controller),
      profile(the_profile),
      buffer(model.buffer_memory),
      settings(model, memory, buffer),
      errors(model.error_status, buffer),
      diagnostics(model.diagnostics),
      emergencies(model.emergency_buffer, buffer),
      nmt_status(model.nmt_status, buffer),
      node(model.object_dictionary(), 127, network, node_options(model.function_modes.front())),
      master(node, controller, model.master_options()),
      command(model.command, buffer, host, network),
      network_settings(model.network_settings, buffer, master),
      process_data(model.program_interface.process_data, buffer),
      lift(model.lift, buffer, node),
      layer2(model.layer2, layer2_rules(model, profile), buffer, controller),
      windows(model.process_data_windows, model.program_interface.process_data, buffer),
      exchange(model.exchange_control, buffer, {process_data, lift, emergencies, layer2, node, controller}),
      time_stamp(model.time_stamp, buffer, node),
      watchdog(model.access_watchdog, buffer),
      status_words(model.status, buffer, {state, controller, node, master, layer2}),
      concise_dcfs(node, master, settings.flash(), ModuleSettings::concise_dcfs_name,
                   configuration_options(model, profile)),
      own_emergencies(node, state) {
  state.mode = &model.function_modes.front();
}

canopen::NodeOptions ModuleContext::node_options(const FunctionModeRow& mode) const {
  canopen::NodeOptions options = mode.node_options != nullptr ? mode.node_options() : model.node_options();
  options.reset_time = profile.nmt_reset_time;
  options.stored_length = stored_length;
  return options;
}

bool ModuleContext::is_master_by_role() const {
  return (node.dictionary().get<std::uint32_t>(0x1F80, 0, 0) & manager::start_up_bit::nmt_master) != 0;
}

void ModuleContext::report_word(BufferAddress address, std::uint16_t value, std::string_view what,
                                can::Time now) const {
  if (observer == nullptr) return;
  std::string text(model.data_sheet->word_prefix);
  text += std::to_string(address) + " = " + std::to_string(value);
  text += what;
  report(text, now);
}

}  // namespace canopus::module
