// The network's side: what the CANopen node and the NMT master report, and what the command interface asks of
// them.

#include <algorithm>
#include <string>
#include <utility>

#include "canopus/module/me3can1_q/buffer_table.hpp"
#include "canopus/module/me3can1_q/firmware.hpp"

namespace canopus::module::me3can1_q {

namespace {

// 1029H:01 [ME3CAN1-Q 4.7].
constexpr std::uint8_t no_change_on_error = 1;
constexpr std::uint8_t stopped_on_error = 2;

}  // namespace

void Me3can1Q::Firmware::receive(const can::Frame& frame, can::Time now) {
  if (state_ != State::running || layer2_state() == Layer2State::offline) return;
  last_frame_ = now;
  if (canopen_mode()) {
    if (network_.is_open()) node_.receive(frame, now);
    master_.receive(frame, now);
    if (network_.is_open()) command_.receive(frame, now);
  } else {
    layer2_.receive(frame, now);
  }
  update(now);
}

void Me3can1Q::Firmware::transmitted(const can::Frame& frame, can::Time now) {
  last_frame_ = now;
  if (state_ != State::running) return;
  if (canopen_mode()) {
    node_.transmitted(frame, now);
    return master_.transmitted(frame, now);
  }
  layer2_.transmitted(frame);
  update(now);
}

// [ME3CAN1-Q 8.2.2] One error, one message: a CPU error's STOP is not told as RUN to STOP besides.
Me3can1Q::Firmware::Event Me3can1Q::Firmware::cpu_event(bool error) {
  const std::uint8_t digit = error ? '1' : '2';  // "ME001", "ME002"
  return {0xFF00, 0x81, {'M', 'E', '0', '0', digit}};
}

void Me3can1Q::Firmware::cpu_changed(CpuState state, can::Time now) {
  const CpuState before = cpu_;
  cpu_ = state;
  const bool failed = std::exchange(cpu_failed_, false);
  if (state_ != State::running) return;
  const bool stopped = before == CpuState::run && state == CpuState::stop;
  if (!canopen_mode()) {
    if (stopped) layer2_.cpu_stopped();
  } else if (stopped) {
    raise_event(cpu_event(failed));
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

void Me3can1Q::Firmware::cpu_failed(can::Time now) {
  cpu_failed_ = cpu_ == CpuState::run;
  if (cpu_failed_ || state_ != State::running || !canopen_mode()) return;
  raise_event(cpu_event(true));  // it was in STOP already
  update(now);
}

bool Me3can1Q::Firmware::may_become_operational() {
  return cpu_ == CpuState::run || node_.dictionary().get<std::uint8_t>(0x1029, 1) == no_change_on_error;
}

void Me3can1Q::Firmware::nmt_state_changed(canopen::NmtState state, can::Time now) {
  // The own node is shown whether it is a master or not; 7 = in the middle of a reset [ME3CAN1-Q 4.8.8].
  const bool in_reset = state == canopen::NmtState::initialising || nmt_reset_end_ != can::never;
  nmt_status_.set_state(node_.node_id(), in_reset ? manager::node_state::reset_communication
                                                  : static_cast<std::uint8_t>(state));
  master_.own_state_changed(state, now);
  if (state == canopen::NmtState::stopped) command_.bus_lost(command_error::wrong_state, now);
}

void Me3can1Q::Firmware::emergency_received(const canopen::Emergency& message, can::Time) {
  emergencies_.record(message);
}

void Me3can1Q::Firmware::rpdo_received(std::uint16_t number, can::Time) {
  exchange_.rpdo_received(node_, number);
}

void Me3can1Q::Firmware::time_received(const canopen::TimeOfDay& time, can::Time now) {
  time_seen_ = true;
  time_stamp_.receive(time, now);
}

void Me3can1Q::Firmware::heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) {
  master_.heartbeat_received(node_id, state, now);
}

void Me3can1Q::Firmware::heartbeat_lost(std::uint8_t node_id, can::Time now) {
  master_.heartbeat_lost(node_id, now);
}

void Me3can1Q::Firmware::life_guarding_event(bool occurred, can::Time) {
  // The master's own number is not known to a guarded slave, so the failure is shown at the own word.
  if (occurred && !signals_.output(signal::nmt_error)) nmt_status_.set_life_guarding(node_.node_id());
}

// Any change of the configuration makes its date and time invalid [ME3CAN1-Q 4.8.12].
void Me3can1Q::Firmware::object_written(const canopen::Entry& entry, can::Time) {
  if (entry.index == 0x1012) use_time_role();
  if (!entry.description->stored || entry.index == 0x1020) return;
  node_.dictionary().set<std::uint32_t>(0x1020, 1, 0);
  node_.dictionary().set<std::uint32_t>(0x1020, 2, 0);
}

void Me3can1Q::Firmware::boot_went_on(std::uint8_t node_id, const manager::BootRecord& record,
                                      can::Time now) {
  if (observer_ != nullptr) observer_->slave_boot_went_on(node_id, record, now);
}

void Me3can1Q::Firmware::start_up_halted(std::uint8_t node_id, manager::BootError, can::Time now) {
  tell("the start-up of the network has ended: node " + std::to_string(node_id) +
           " is mandatory (1F81H bit 3) and was not booted",
       now);
}

void Me3can1Q::Firmware::error_control_event(std::uint8_t node_id, manager::ErrorControlEvent event,
                                             can::Time) {
  // A lost heartbeat is the node's own to tell; guarding is the master's.
  if (event == manager::ErrorControlEvent::heartbeat_lost) return;
  raise_event({static_cast<std::uint16_t>(0x8F00 + node_id), 0x11, {}});
}

void Me3can1Q::Firmware::lss_active_changed(bool active, can::Time now) {
  // A slave at another bit rate, which the search is for, can drive the module bus-off: that must not end it.
  controller_.set_automatic_recovery(active);
  if (active) tell("the boot time is over: missing slaves are looked for by LSS", now);
}

void Me3can1Q::Firmware::change_bit_rate(std::uint32_t bit_rate, can::Time now) {
  controller_.restart(bit_rate);
  overflows_ = 0;
  // What the controller meets at another bit rate is no error of this network.
  network_.open(true);
  controller_changed(now);
  network_.open(bit_rate == bit_rate_ * 1000U);
}

void Me3can1Q::Firmware::lss_search_ended(std::uint8_t node_id, bool found, can::Time now) {
  std::string text = "LSS: the slave for node-ID " + std::to_string(node_id);
  text += found ? " was found and has its node-ID and bit rate" : " was not found at any bit rate";
  tell(text, now);
}

void Me3can1Q::Firmware::node_state_changed(std::uint8_t node_id, std::uint8_t state, can::Time) {
  nmt_status_.set_state(node_id, state);
}

void Me3can1Q::Firmware::error_control_changed(std::uint8_t node_id, std::uint16_t bits, can::Time now) {
  const std::uint16_t held = buffer_.word(g::error_clear_node);
  const bool clear_at_once = signals_.output(signal::nmt_error) && (held == 0 || held == node_id);
  if (clear_at_once && (bits & manager::error_control::errors) != 0) {
    nmt_status_.set_status(node_id, bits & static_cast<std::uint16_t>(~manager::error_control::errors));
    master_.clear_error_control(node_id, now);
    return;
  }
  nmt_status_.set_status(node_id, bits);
}

std::uint16_t Me3can1Q::Firmware::bus_obstacle() const {
  if (controller_.error_state() == can::ErrorState::bus_off) return command_error::bus_off;
  if (!canopen_mode()) return layer2_.online() ? std::uint16_t{0} : command_error::wrong_state;
  const canopen::NmtState state = node_.state();
  const bool usable = state == canopen::NmtState::pre_operational || state == canopen::NmtState::operational;
  return usable ? std::uint16_t{0} : command_error::wrong_state;
}

can::Duration Me3can1Q::Firmware::sdo_time_out() const {
  return std::chrono::milliseconds(buffer_.word(g::sdo_time_out));
}

CommandHost::EmergencyAnswer Me3can1Q::Firmware::send_emergency(std::uint16_t code,
                                                                std::uint8_t error_register,
                                                                std::span<const std::uint8_t, 5> manufacturer,
                                                                can::Time now) {
  if (bus_obstacle() != 0) return EmergencyAnswer::wrong_state;
  return node_.emergency(code, error_register, manufacturer, now) ? EmergencyAnswer::sent
                                                                  : EmergencyAnswer::inhibited;
}

CommandHost::FrameAnswer Me3can1Q::Firmware::send_plain_frame(std::span<const std::uint16_t> parameters,
                                                              std::span<std::uint16_t> faults) {
  return layer2_.send(parameters, faults);
}

}  // namespace canopus::module::me3can1_q
