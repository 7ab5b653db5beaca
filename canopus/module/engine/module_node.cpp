#include "canopus/module/engine/module_node.hpp"

#include <string>
#include <utility>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/frame_of.hpp"
#include "canopus/manager/boot/start_up_bits.hpp"
#include "canopus/module/commands/pdo_mapping.hpp"
#include "canopus/module/engine/layer2_mode.hpp"
#include "canopus/module/storage/stored_settings.hpp"

namespace canopus::module {

namespace {

// 1029:01.
constexpr std::uint8_t no_change_on_error = 1;
constexpr std::uint8_t stopped_on_error = 2;

manager::ConfigurationOptions configuration_options(const ModuleContext& context) {
  manager::ConfigurationOptions options;
  if (context.model.configuration_options != nullptr) options = context.model.configuration_options();
  options.erase_time = context.profile.erase_time;
  return options;
}

}  // namespace

ModuleNode::ModuleNode(ModuleContext& context, can::Controller& controller, ControllerMonitor& monitor,
                       CpuStateHandler& cpu, Layer2Mode& layer2, can::Participant& module)
    : context_(context),
      monitor_(monitor),
      cpu_(cpu),
      layer2_(layer2),
      module_(module),
      network_(controller),
      emergencies_(context.model.emergency_buffer, context.buffer),
      nmt_status_(context.model.nmt_status, context.buffer),
      node_(context.model.object_dictionary(), 127, network_, options(context.model.function_modes.front())),
      master_(node_, controller, context.model.master_options()),
      command_(context.model.command, context.buffer, *this, network_),
      network_settings_(context.model.network_settings, context.buffer, master_),
      process_data_(context.model.program_interface.process_data, context.buffer),
      lift_(context.model.lift, context.buffer, node_),
      time_stamp_(context.model.time_stamp, context.buffer, node_),
      status_words_(context.model.status, context.buffer,
                    {context.state, is_resetting_, controller, node_, master_, layer2}),
      concise_dcfs_(node_, master_, context.settings.flash(), ModuleSettings::concise_dcfs_name,
                    configuration_options(context)),
      own_emergencies_(node_) {
  node_.set_parameter_store(&context.settings.object_store());
  process_data_.attach(node_);
  node_.set_listener(this);
  node_.attach(0x0002, 0x0008, *this);
  master_.set_listener(this);
  for (can::Alarm* part :
       {&own_emergencies_.alarm(), &time_stamp_.alarm(), &node_.alarm(), &master_.alarm(), &command_.alarm()})
    alarm_.add_part(*part);
}

canopen::NodeOptions ModuleNode::options(const FunctionModeRow& mode) const {
  canopen::NodeOptions options =
      mode.node_options != nullptr ? mode.node_options() : context_.model.node_options();
  options.reset_time = context_.profile.nmt_reset_time;
  options.stored_length = stored_length;
  return options;
}

bool ModuleNode::is_master_by_role() const {
  return (node_.dictionary().get<std::uint32_t>(0x1F80, 0, 0) & manager::start_up_bit::nmt_master) != 0;
}

bool ModuleNode::keeps_state_on_error() const {
  return node_.dictionary().get<std::uint8_t>(0x1029, 1) == no_change_on_error;
}

// --- the module's life

void ModuleNode::power_off(can::Time now) {
  master_.stop(now);
  node_.power_off();
  command_.reset();
  time_stamp_.alarm().cancel();
  own_emergencies_.clear();
  is_resetting_ = boot_up_waits_ = false;
}

void ModuleNode::reset() {
  emergencies_.clear();
  nmt_status_.reset();
  process_data_.reset();
  status_words_.reset();
  has_damaged_files_ = false;
}

// Function modes may have object dictionaries of their own [FX3U-CAN 6.5].
void ModuleNode::describe(const FunctionModeRow& mode) {
  const auto description = context_.model.dictionary_of(mode);
  if (description.get() != &node_.dictionary().description()) node_.describe(description, options(mode));
}

void ModuleNode::clear_restored_configurations() {
  if (std::exchange(clear_configurations_, false)) concise_dcfs_.clear();
}

void ModuleNode::begin(bool canopen_mode) {
  lift_.start();
  time_stamp_.alarm().cancel();
  if (canopen_mode) time_stamp_.reset();
}

void ModuleNode::power_on(std::uint8_t node_id, can::Time now) {
  node_.set_node_id(node_id);
  network_settings_.apply();
  node_.power_on(now);
}

// --- events

// Most frames are PDOs and heartbeats. What they change beyond process data is counted; without that nothing of what
// ModuleEngine::update() reads has changed. The master does nothing with PDOs.
bool ModuleNode::receive(const can::Frame& frame, can::Time now) {
  const std::uint64_t changes = change_count_;
  const bool is_open = network_.is_open();
  const bool is_data = canopen::is_base_data(frame);
  const bool is_pdo = frame.identifier > 0x180 && frame.identifier < canopen::cob_id::sdo_response && is_data;
  if (is_pdo && is_open) {
    node_.receive(frame, now);
    if (!command_.receive(frame, now) && change_count_ == changes) return false;
  } else {
    if (is_open) node_.receive(frame, now);
    master_.receive(frame, now);
    const bool is_of_command = is_open && command_.receive(frame, now);
    const bool is_heartbeat =
        is_open && is_data && frame.data[0] != 0 &&
        (frame.identifier & canopen::cob_id::function_code) == canopen::cob_id::error_control;
    if (!is_of_command && is_heartbeat && change_count_ == changes) return false;
  }
  ++change_count_;
  return true;
}

bool ModuleNode::transmitted(const can::Frame& frame, can::Time now) {
  node_.transmitted(frame, now);
  master_.transmitted(frame, now);
  command_.transmitted(frame, now);
  const bool is_boot_up = boot_up_waits_ && !frame.remote && !frame.extended &&
                          frame.identifier == canopen::cob_id::error_control + node_.node_id() &&
                          frame.data[0] == 0;
  if (is_boot_up) boot_up_waits_ = false;
  return is_boot_up;
}

void ModuleNode::bus_off(can::Time now) {
  command_.bus_lost(command_error::bus_off, now);
  if (context_.state.canopen_mode()) node_.communication_error(now);
}

void ModuleNode::tick(can::Time now) {
  if (context_.state.running() && now >= time_stamp_.next_transmission()) time_stamp_.tick(now);
  if (now >= node_.deadline()) node_.tick(now);
  if (now >= master_.deadline()) master_.tick(now);
  if (now >= command_.alarm()) command_.tick(now);
}

void ModuleNode::leave_operational(can::Time now) {
  // [ME3CAN1-Q 4.7] 1 means no change on communication errors, yet STOP still leads to Pre-operational.
  if (node_.dictionary().get<std::uint8_t>(0x1029, 1) == stopped_on_error) {
    node_.command(canopen::NmtCommand::stop, now);
  } else if (node_.state() == canopen::NmtState::operational) {
    node_.command(canopen::NmtCommand::enter_pre_operational, now);
  }
}

// --- requests

bool ModuleNode::send_restart_emergency(can::Time now) {
  const EmergencyRow& row = context_.model.emergencies.restart;
  return row.code != 0 && node_.emergency(row.code, row.error_register, row.manufacturer, now);
}

void ModuleNode::clear_failures(std::uint8_t node_id, can::Time now) {
  nmt_status_.clear_life_guarding(node_id);
  master_.clear_error_control(node_id, now);
}

void ModuleNode::clear_written_failures(can::Time now) {
  const std::bitset<128> nodes = nmt_status_.consume_cleared();
  if (nodes.none()) return;
  for (std::uint8_t node = 1; node < nodes.size(); ++node)
    if (nodes.test(node)) clear_failures(node, now);
}

void ModuleNode::execute_command(can::Time now) {
  command_.execute(context_.state.mode->bit, now, context_.profile.command_time);
}

void ModuleNode::words_restored(can::Time now) {
  network_settings_.apply();
  time_stamp_.correction_changed(now);
}

// --- reports of the node

void ModuleNode::reset_requested(canopen::NmtCommand, can::Time now) {
  ++change_count_;
  context_.diagnostics.log(ModuleEvent::nmt_reset, now);
  status_words_.show_nmt_reset(false);
  is_resetting_ = true;
  master_.stop(now);
  // The own node is shown whether it is a master or not [ME3CAN1-Q 4.8.8].
  nmt_status_.reset();
  nmt_status_.set_state(node_.node_id(), manager::node_state::reset_communication);
}

void ModuleNode::defaults_loaded(canopen::NmtCommand, can::Time) {
  ++change_count_;
  if (context_.model.node_id_defaults != nullptr)
    context_.model.node_id_defaults(node_.dictionary(), node_.node_id());
}

void ModuleNode::reset_done(canopen::NmtCommand, can::Time now) {
  ++change_count_;
  if (!concise_dcfs_.load()) has_damaged_files_ = true;
  time_stamp_.show_role();
  nmt_status_.reset();
  if (std::exchange(is_resetting_, false)) status_words_.show_nmt_reset(true);
  // The next frame of the node; without room it is lost.
  boot_up_waits_ = network_.is_open() && context_.controller.has_room();
  cpu_.node_starts(now);
}

// The data types 0002H-0008H are there for PDO mapping alone [ME3CAN1-Q 4.5].
canopen::AbortCode ModuleNode::before_read(canopen::ObjectDictionary&, const canopen::Entry&, can::Time) {
  return canopen::AbortCode::no_object;
}

canopen::AbortCode ModuleNode::before_write(canopen::ObjectDictionary&, const canopen::Entry&,
                                            std::span<const std::uint8_t>, can::Time) {
  return canopen::AbortCode::no_object;
}

void ModuleNode::nmt_state_changed(canopen::NmtState state, can::Time now) {
  ++change_count_;
  nmt_status_.set_state(node_.node_id(), static_cast<std::uint8_t>(state));
  context_.diagnostics.log(ModuleEvent::nmt_state, now, static_cast<std::uint8_t>(state));
  master_.own_state_changed(state, now);
  if (state == canopen::NmtState::stopped) command_.bus_lost(command_error::wrong_state, now);
}

void ModuleNode::emergency_received(const canopen::Emergency& message, can::Time now) {
  ++change_count_;
  emergencies_.record(message);
  if (!emergencies_.held_clear())
    context_.diagnostics.log(ModuleEvent::emergency_received, now, message.node_id);
  constexpr std::uint32_t is_slave = 1;
  if ((node_.dictionary().get<std::uint32_t>(0x1F81, message.node_id, 0) & is_slave) != 0)
    context_.errors.raise(ModuleError::slave_emergency);
  context_.port->emergency_received(message, now);
}

void ModuleNode::emergency_raised(const canopen::Emergency& message, can::Time now) {
  ++change_count_;
  if (message.code != canopen::emcy_code::protocol_error) return;
  context_.diagnostics.raise(Diagnosis::invalid_object, now,
                             {node_.dictionary().get<std::uint32_t>(0x1005, 0) & 0x7FFU, message.code});
}

void ModuleNode::rpdo_length_wrong(std::uint16_t number, std::uint16_t code, can::Time now) {
  ++change_count_;
  context_.diagnostics.raise(Diagnosis::rpdo_length, now, {number + 1U, code});
}

void ModuleNode::rpdo_received(std::uint16_t number, can::Time) {
  process_data_.rpdo_received(node_, number);
  if (!lift_.active()) return;
  ++change_count_;
  lift_.rpdo_received(number);
}

void ModuleNode::time_received(const canopen::TimeOfDay& time, can::Time now) {
  ++change_count_;
  status_words_.show_time();
  time_stamp_.receive(time, now);
}

void ModuleNode::heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) {
  master_.heartbeat_received(node_id, state, now);
}

void ModuleNode::heartbeat_lost(std::uint8_t node_id, can::Time now) {
  ++change_count_;
  master_.heartbeat_lost(node_id, now);
}

void ModuleNode::life_guarding_event(bool occurred, can::Time now) {
  ++change_count_;
  const std::uint8_t own = node_.node_id();
  if (!occurred || nmt_status_.held_clear(own)) return;
  context_.diagnostics.log(ModuleEvent::life_guarding, now);
  // The master's number is not known to a guarded slave, so the failure is shown at the own word.
  nmt_status_.set_guarding_master(own, manager::error_control::life_guarding);
}

void ModuleNode::life_guarding_running(bool running, can::Time) {
  ++change_count_;
  constexpr std::uint16_t active = manager::error_control::guarding_active;
  nmt_status_.set_guarding_master(node_.node_id(), running ? active : 0, running ? 0 : active);
}

void ModuleNode::life_guarding_missed(can::Time) {
  ++change_count_;
  const std::uint8_t own = node_.node_id();
  if (nmt_status_.held_clear(own)) return;
  nmt_status_.set_guarding_master(own, manager::error_control::guarding_miss);
}

// Any change of the configuration makes its date and time invalid [ME3CAN1-Q 4.8.12].
void ModuleNode::object_written(const canopen::Entry& entry, can::Time now) {
  ++change_count_;
  if (entry.index == 0x1010 || entry.index == 0x1F22) context_.diagnostics.log(ModuleEvent::saved, now);
  if (entry.index == 0x1011) context_.diagnostics.log(ModuleEvent::restored, now);
  if (entry.index == 0x1011) clear_configurations_ = true;  // it took "load" [ME3CAN1-Q 4.6.11]
  if (entry.index == 0x1011 && context_.model.restore_clears_files_at_once) concise_dcfs_.clear();
  if (entry.index == 0x1012) time_stamp_.show_role();
  if (!entry.description->stored || entry.index == 0x1020) return;
  node_.dictionary().set<std::uint32_t>(0x1020, 1, 0);
  node_.dictionary().set<std::uint32_t>(0x1020, 2, 0);
}

void ModuleNode::boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) {
  ++change_count_;
  context_.port->boot_went_on(node_id, record, now);
  if (context_.observer != nullptr) context_.observer->slave_boot_went_on(node_id, record, now);
}

void ModuleNode::slave_failed(std::uint8_t node_id, manager::BootError error, can::Time now) {
  ++change_count_;
  const bool configuration = error == manager::BootError::configuration;
  context_.diagnostics.raise(configuration ? Diagnosis::slave_configuration : Diagnosis::slave_boot, now,
                             {node_id, static_cast<std::uint8_t>(error)});
}

void ModuleNode::start_up_halted(std::uint8_t node_id, manager::BootError error, can::Time now) {
  ++change_count_;
  context_.diagnostics.raise(Diagnosis::start_up, now, {static_cast<std::uint8_t>(error)});
  context_.report("the start-up of the network has ended: node " + std::to_string(node_id) +
                      " is mandatory (1F81H bit 3) and was not booted",
                  now);
}

void ModuleNode::error_control_event(std::uint8_t node_id, manager::ErrorControlEvent event, can::Time) {
  ++change_count_;
  // The node reports a lost heartbeat itself; guarding is the master's.
  if (event == manager::ErrorControlEvent::heartbeat_lost) return;
  own_emergencies_.raise(context_.model.emergencies.node_lost, node_id);
}

void ModuleNode::lss_active_changed(bool active, can::Time now) {
  ++change_count_;
  // A slave at another bit rate, which the search is for, can drive the module bus-off: that must not end it.
  monitor_.set_automatic_recovery(active);
  if (active) context_.report("the boot time is over: missing slaves are looked for by LSS", now);
}

void ModuleNode::change_bit_rate(std::uint32_t bit_rate, can::Time now) {
  ++change_count_;
  monitor_.restart(bit_rate);
  // What the controller meets at another bit rate is no error of this network.
  network_.open(true);
  module_.controller_changed(now);
  network_.open(bit_rate == context_.state.bit_rate * 1000U);
}

void ModuleNode::lss_search_ended(std::uint8_t node_id, bool found, can::Time now) {
  ++change_count_;
  std::string text = "LSS: the slave for node-ID " + std::to_string(node_id);
  text += found ? " was found and has its node-ID and bit rate" : " was not found at any bit rate";
  context_.report(text, now);
}

void ModuleNode::node_state_changed(std::uint8_t node_id, std::uint8_t state, can::Time) {
  ++change_count_;
  nmt_status_.set_state(node_id, state);
}

void ModuleNode::error_control_changed(std::uint8_t node_id, std::uint16_t bits, can::Time now) {
  ++change_count_;
  context_.port->error_control_changed(node_id, bits, now);
  const unsigned new_bits = bits & ~nmt_status_.status(node_id) & manager::error_control::errors;
  if (new_bits != 0 && !nmt_status_.held_clear(node_id))
    context_.diagnostics.log(ModuleEvent::error_control, now, node_id);
  if (nmt_status_.held_clear(node_id) && (bits & manager::error_control::errors) != 0) {
    nmt_status_.set_status(node_id, bits & static_cast<std::uint16_t>(~manager::error_control::errors));
    master_.clear_error_control(node_id, now);
    return;
  }
  nmt_status_.set_status(node_id, bits);
}

// --- what commands need

std::uint16_t ModuleNode::bus_obstacle() const {
  if (context_.controller.error_state() == can::ErrorState::bus_off) return command_error::bus_off;
  if (!context_.state.canopen_mode()) return layer2_.online() ? std::uint16_t{0} : command_error::wrong_state;
  const canopen::NmtState state = node_.state();
  const bool usable = state == canopen::NmtState::pre_operational || state == canopen::NmtState::operational;
  return usable ? std::uint16_t{0} : command_error::wrong_state;
}

CommandHost::EmergencyAnswer ModuleNode::send_emergency(std::uint16_t code, std::uint8_t error_register,
                                                        std::span<const std::uint8_t, 5> manufacturer,
                                                        can::Time now) {
  if (bus_obstacle() != 0) return EmergencyAnswer::wrong_state;
  if (!node_.emergency(code, error_register, manufacturer, now)) return EmergencyAnswer::inhibited;
  context_.diagnostics.log(ModuleEvent::emergency_sent, now);
  return EmergencyAnswer::sent;
}

PlainFrameResult ModuleNode::send_plain_frame(std::span<const std::uint16_t> parameters,
                                              std::span<std::uint16_t> faults) {
  return layer2_.send(parameters, faults);
}

bool ModuleNode::send_now(const can::Frame& frame) {
  const bool sends = monitor_.send(frame);
  if (!sends) context_.errors.raise(ModuleError::command_overflow);
  return sends;
}

void ModuleNode::map_pdos(PdoMapping mapping, can::Time now) {
  const canopen::ObjectDictionary factory(context_.model.object_dictionary(), node_.node_id());
  set_pdo_mapping(node_.dictionary(), factory, node_.node_id(), pdos(), mapping, now);
  if (context_.model.mapping_clears_words) process_data_.clear();
}

}  // namespace canopus::module
