#include "canopus/module/engine/cpu_state_handler.hpp"

#include <utility>

#include "canopus/module/engine/layer2_mode.hpp"
#include "canopus/module/engine/module_node.hpp"

namespace canopus::module {

void CpuStateHandler::changed(CpuState state, can::Time now) {
  const CpuState before = std::exchange(cpu_, state);
  const bool failed = std::exchange(failed_, false);
  if (context_.model.cpu.is_unknown) return;
  if (state == CpuState::run) has_fault_ = false;
  if (!context_.state.running()) return;
  const bool stopped = before == CpuState::run && state == CpuState::stop;
  if (!context_.state.canopen_mode()) {
    if (stopped) layer2_.cpu_stopped();
    if (stopped && context_.model.cpu.stop_ends_layer2) {
      layer2_.end();
      context_.port->went_offline();
    }
  } else if (stopped) {
    // One error, one message: a CPU error's STOP is not reported as RUN to STOP besides [ME3CAN1-Q 8.2.2].
    const EmergencyRows& rows = context_.model.emergencies;
    enter_stop(failed ? rows.cpu_error : rows.cpu_stopped, now);
  } else if (before == CpuState::stop && state == CpuState::run) {
    enter_run(now);
  }
}

void CpuStateHandler::failed() {
  if (context_.model.cpu.is_unknown) return;
  failed_ = cpu_ == CpuState::run;
  has_fault_ = true;
  if (failed_ || !context_.state.running() || !context_.state.canopen_mode()) return;
  node_.raise_emergency(context_.model.emergencies.cpu_error);  // it was in STOP already
}

void CpuStateHandler::watchdog_expired(can::Time now) {
  context_.report("the program has not used the data words for too long", now);
  if (!context_.state.canopen_mode()) return layer2_.cpu_stopped();
  const bool keeps_state = context_.model.cpu.watchdog_keeps_state;
  if (keeps_state && node_.state() != canopen::NmtState::operational) return;
  node_.raise_emergency(context_.model.emergencies.access_watchdog);
  node_.send_emergencies(now);  // before the state in which there are none
  if (!keeps_state) node_.leave_operational(now);
}

bool CpuStateHandler::is_master_in_run_alone() const {
  return context_.model.cpu.stop_ends_master && node_.is_master_by_role();
}

void CpuStateHandler::node_starts(can::Time now) {
  const bool stopped = cpu_ == CpuState::stop && !context_.model.cpu.is_unknown;
  stop_is_due_ = stopped && context_.model.cpu.stop_at_start_counts;
  if (stopped && is_master_in_run_alone()) {
    node_.pause_heartbeat(true, now);
  } else {
    node_.pause_heartbeat(false, now);
    node_.start_master(now);
  }
}

void CpuStateHandler::enter_due_stop(can::Time now) {
  if (stop_is_due_ && !node_.boot_up_waits()) enter_stop(context_.model.emergencies.cpu_stopped, now);
}

bool CpuStateHandler::allows_operational() const {
  if (context_.model.cpu.is_unknown) return true;
  return (cpu_ == CpuState::run && !context_.watchdog.expired()) || node_.keeps_state_on_error();
}

void CpuStateHandler::enter_stop(const EmergencyRow& row, can::Time now) {
  stop_is_due_ = false;
  node_.raise_emergency(row);
  node_.send_emergencies(now);  // before the state in which there are none
  if (is_master_in_run_alone()) {
    node_.stop_master(now);
    node_.pause_heartbeat(true, now);
  }
  node_.leave_operational(now);
}

void CpuStateHandler::enter_run(can::Time now) {
  stop_is_due_ = false;
  if (context_.model.cpu.run_ends_error) node_.forget_error(context_.model.emergencies.cpu_stopped, now);
  if (!is_master_in_run_alone()) return;
  node_.pause_heartbeat(false, now);
  if (node_.state() != canopen::NmtState::initialising) node_.start_master(now);
}

}  // namespace canopus::module
