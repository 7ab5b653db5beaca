// The CPU's side of the engine: RUN and STOP, and what the CPU's event history is told.

#include <utility>

#include "canopus/manager/boot/start_up_bits.hpp"
#include "canopus/module/engine/module_engine.hpp"

namespace canopus::module {

namespace {

// 1029H:01.
constexpr std::uint8_t no_change_on_error = 1;
constexpr std::uint8_t stopped_on_error = 2;

}  // namespace

void ModuleEngine::cpu_changed(CpuState state, can::Time now) {
  const CpuState before = state_.cpu;
  state_.cpu = state;
  const bool failed = std::exchange(cpu_failed_, false);
  if (!state_.running()) return;
  const bool stopped = before == CpuState::run && state == CpuState::stop;
  if (!state_.canopen_mode()) {
    if (stopped) layer2_.cpu_stopped();
  } else if (stopped) {
    // One error, one message: a CPU error's STOP is not reported as RUN to STOP besides [ME3CAN1-Q 8.2.2].
    enter_stop(failed ? model_.emergencies.cpu_error : model_.emergencies.cpu_stopped, now);
  } else if (before == CpuState::stop && state == CpuState::run) {
    enter_run(now);
  }
  update(now);
}

bool ModuleEngine::is_master_by_role() const {
  return (node_.dictionary().get<std::uint32_t>(0x1F80, 0, 0) & manager::start_up_bit::nmt_master) != 0;
}

void ModuleEngine::enter_stop(const EmergencyRow& row, can::Time now) {
  stop_is_due_ = false;
  raise_event(row);
  send_events(now);  // before the state in which there are none
  if (model_.cpu.stop_ends_master && is_master_by_role()) {
    master_.stop(now);
    node_.pause_heartbeat(true, now);
  }
  // [ME3CAN1-Q 4.7] 1 means no change on communication errors, yet STOP still leads to Pre-operational.
  const auto behaviour = node_.dictionary().get<std::uint8_t>(0x1029, 1);
  if (behaviour == stopped_on_error) {
    node_.command(canopen::NmtCommand::stop, now);
  } else if (node_.state() == canopen::NmtState::operational) {
    node_.command(canopen::NmtCommand::enter_pre_operational, now);
  }
}

void ModuleEngine::enter_run(can::Time now) {
  stop_is_due_ = false;
  if (model_.cpu.run_ends_error) {
    const EmergencyRow& row = model_.emergencies.cpu_stopped;
    node_.forget_error(row.code, row.manufacturer, now);
  }
  if (!model_.cpu.stop_ends_master || !is_master_by_role()) return;
  node_.pause_heartbeat(false, now);
  if (node_.state() != canopen::NmtState::initialising) master_.start(now);
}

void ModuleEngine::cpu_failed(can::Time now) {
  cpu_failed_ = state_.cpu == CpuState::run;
  if (cpu_failed_ || !state_.running() || !state_.canopen_mode()) return;
  raise_event(model_.emergencies.cpu_error);  // it was in STOP already
  update(now);
}

bool ModuleEngine::may_become_operational() {
  return state_.cpu == CpuState::run || node_.dictionary().get<std::uint8_t>(0x1029, 1) == no_change_on_error;
}

// Edges that nobody reports.
void ModuleEngine::log_changes(can::Time now) {
  const bool online = layer2_state() == Layer2State::online;
  if (std::exchange(logged_online_, online) != online) {
    diagnostics_.log(online ? ModuleEvent::online : ModuleEvent::offline, now);
  }
  const bool active = state_.running() && state_.canopen_mode() && master_.active();
  if (std::exchange(logged_active_, active) != active) {
    const auto start_up = node_.dictionary().get<std::uint32_t>(0x1F80, 0, 0);
    if ((start_up & manager::start_up_bit::flying_master) != 0) {
      diagnostics_.log(ModuleEvent::flying_master, now, master_.active_master());
    }
  }
  if (!errors_.shows(ModuleError::invalid_value)) diagnostics_.end(Diagnosis::invalid_value);
  if (!errors_.has(ModuleError::bus_off)) diagnostics_.end(Diagnosis::bus_off);
  if (settings_.error()) {
    diagnostics_.raise(Diagnosis::flash_data, now);
  } else {
    diagnostics_.end(Diagnosis::flash_data);
  }
}

}  // namespace canopus::module
