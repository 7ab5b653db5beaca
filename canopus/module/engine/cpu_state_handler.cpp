#include "canopus/module/engine/cpu_state_handler.hpp"

#include <utility>

namespace canopus::module {

namespace {

// 1029H:01.
constexpr std::uint8_t no_change_on_error = 1;
constexpr std::uint8_t stopped_on_error = 2;

}  // namespace

void CpuStateHandler::changed(CpuState state, can::Time now) {
  const CpuState before = std::exchange(parts_.state.cpu, state);
  const bool failed = std::exchange(failed_, false);
  if (parts_.model.cpu.is_unknown) return;
  if (state == CpuState::run) parts_.state.cpu_fault = false;
  if (!parts_.state.running()) return;
  const bool stopped = before == CpuState::run && state == CpuState::stop;
  if (!parts_.state.canopen_mode()) {
    if (stopped) parts_.layer2.cpu_stopped();
    if (stopped && parts_.model.cpu.stop_ends_layer2) {
      parts_.layer2.go_offline();
      parts_.port->went_offline();
    }
  } else if (stopped) {
    // One error, one message: a CPU error's STOP is not reported as RUN to STOP besides [ME3CAN1-Q 8.2.2].
    const EmergencyRows& rows = parts_.model.emergencies;
    enter_stop(failed ? rows.cpu_error : rows.cpu_stopped, now);
  } else if (before == CpuState::stop && state == CpuState::run) {
    enter_run(now);
  }
}

void CpuStateHandler::failed() {
  if (parts_.model.cpu.is_unknown) return;
  failed_ = parts_.state.cpu == CpuState::run;
  parts_.state.cpu_fault = true;
  if (failed_ || !parts_.state.running() || !parts_.state.canopen_mode()) return;
  parts_.own_emergencies.raise(parts_.model.emergencies.cpu_error);  // it was in STOP already
}

void CpuStateHandler::watchdog_expired(can::Time now) {
  parts_.report("the program has not used the data words for too long", now);
  if (!parts_.state.canopen_mode()) return parts_.layer2.cpu_stopped();
  const bool keeps_state = parts_.model.cpu.watchdog_keeps_state;
  if (keeps_state && parts_.node.state() != canopen::NmtState::operational) return;
  parts_.own_emergencies.raise(parts_.model.emergencies.access_watchdog);
  parts_.own_emergencies.send(now);  // before the state in which there are none
  if (!keeps_state) leave_operational(now);
}

void CpuStateHandler::node_starts(can::Time now) {
  const bool stopped = parts_.state.cpu == CpuState::stop && !parts_.model.cpu.is_unknown;
  const bool has_no_role = stopped && parts_.model.cpu.stop_ends_master && parts_.is_master_by_role();
  stop_is_due_ = stopped && parts_.model.cpu.stop_at_start_counts;
  parts_.node.pause_heartbeat(has_no_role, now);
  if (!has_no_role) parts_.master.start(now);
}

bool CpuStateHandler::allows_operational() const {
  if (parts_.model.cpu.is_unknown) return true;
  return (parts_.state.cpu == CpuState::run && !parts_.watchdog.expired()) ||
         parts_.node.dictionary().get<std::uint8_t>(0x1029, 1) == no_change_on_error;
}

void CpuStateHandler::enter_stop(const EmergencyRow& row, can::Time now) {
  stop_is_due_ = false;
  canopen::Node& node = parts_.node;
  parts_.own_emergencies.raise(row);
  parts_.own_emergencies.send(now);  // before the state in which there are none
  if (parts_.model.cpu.stop_ends_master && parts_.is_master_by_role()) {
    parts_.master.stop(now);
    node.pause_heartbeat(true, now);
  }
  leave_operational(now);
}

void CpuStateHandler::leave_operational(can::Time now) {
  canopen::Node& node = parts_.node;
  // [ME3CAN1-Q 4.7] 1 means no change on communication errors, yet STOP still leads to Pre-operational.
  const auto behaviour = node.dictionary().get<std::uint8_t>(0x1029, 1);
  if (behaviour == stopped_on_error) {
    node.command(canopen::NmtCommand::stop, now);
  } else if (node.state() == canopen::NmtState::operational) {
    node.command(canopen::NmtCommand::enter_pre_operational, now);
  }
}

void CpuStateHandler::enter_run(can::Time now) {
  stop_is_due_ = false;
  if (parts_.model.cpu.run_ends_error) {
    const EmergencyRow& row = parts_.model.emergencies.cpu_stopped;
    parts_.node.forget_error(row.code, row.manufacturer, now);
  }
  if (!parts_.model.cpu.stop_ends_master || !parts_.is_master_by_role()) return;
  parts_.node.pause_heartbeat(false, now);
  if (parts_.node.state() != canopen::NmtState::initialising) parts_.master.start(now);
}

}  // namespace canopus::module
