#include "canopus/module/signal_module.hpp"

#include <algorithm>
#include <utility>

namespace canopus::module {

SignalModule::SignalModule(const ModuleModel& model, can::Controller& controller, NonVolatileMemory& memory,
                           const Profile& profile)
    : ModuleEngine(model, controller, memory, profile) {
  for (const SignalRow& row : model.signals) {
    row_of_.at(row.number) = &row;
    row_for_.at(std::to_underlying(row.use)) = &row;
    bit_of_.at(std::to_underlying(row.use)) = 1U << row.number;
  }
}

void SignalModule::set_observer(ModuleObserver* observer) {
  ModuleEngine::set_observer(observer);
  signals_.set_observer(observer);
}

bool SignalModule::wanted(SignalUse use) const {
  const SignalRow* row = row_for_[std::to_underlying(use)];
  return row != nullptr && (row->modes & state().mode->bit) != 0 && signals_.output(row->number);
}

void SignalModule::set_input(SignalUse use, bool on, can::Time now) {
  if (const SignalRow* row = row_for_[std::to_underlying(use)]) signals_.set_input(row->number, on, now);
}

void SignalModule::set_output(unsigned signal, bool on, can::Time now) {
  if (state().phase == Phase::off || signal >= row_of_.size() || !signals_.set_output(signal, on, now))
    return;
  if (const SignalRow* row = row_of_[signal]) on ? rising(*row, now) : falling(*row, now);
  update(now);
}

void SignalModule::rising(const SignalRow& row, can::Time now) {
  switch (row.use) {  // as long as they are ON, at any time
    case SignalUse::error: return hold_clear_errors(true);
    case SignalUse::nmt_error: return hold_clear_nmt_errors(true, now);
    default: break;
  }
  // While a restart, or the start after power-on, runs, its request is looked at when it ends. An NMT reset
  // it ends.
  const bool may_restart = row.use == SignalUse::restart && state().phase != Phase::initializing;
  const bool may_command = row.use == SignalUse::command && state().phase == Phase::stuck;
  if (state().initializing() && !may_restart && !may_command) return;
  if ((row.modes & state().mode->bit) == 0) return;
  switch (row.use) {
    case SignalUse::data_exchange: return begin_exchange(now);
    case SignalUse::restart: return begin_restart(now);
    case SignalUse::online: return go_online(now);
    case SignalUse::transmit_trigger: return request_trigger(true);
    case SignalUse::command: return execute_command(now);
    case SignalUse::save_restore: return begin_save(now);
    case SignalUse::emergency: return hold_clear_emergencies(true);
    case SignalUse::set_clock: return set_clock(now);
    case SignalUse::read_clock: return read_clock(now);
    default: return;
  }
}

void SignalModule::falling(const SignalRow& row, can::Time now) {
  switch (row.use) {
    case SignalUse::restart: restart_again_at_ = can::never; [[fallthrough]];
    case SignalUse::data_exchange:
    case SignalUse::command:
    case SignalUse::set_clock:
    case SignalUse::read_clock:
    case SignalUse::save_restore: return signals_.set_input(row.number, false, now);
    case SignalUse::online: return go_offline();
    case SignalUse::transmit_trigger: return request_trigger(false);
    case SignalUse::error: return hold_clear_errors(false);
    case SignalUse::nmt_error: return hold_clear_nmt_errors(false, now);
    case SignalUse::emergency: return hold_clear_emergencies(false);
    case SignalUse::ready:
    case SignalUse::none: return;
  }
}

// A request that was taken back meanwhile is not answered.
void SignalModule::done(Request request, can::Time now) {
  const auto answer = [&](SignalUse use) {
    if (wanted(use)) set_input(use, true, now);
  };
  switch (request) {
    case Request::data_exchange: return answer(SignalUse::data_exchange);
    case Request::command: return answer(SignalUse::command);
    case Request::save_restore: return answer(SignalUse::save_restore);
    case Request::set_clock: return answer(SignalUse::set_clock);
    case Request::read_clock: return answer(SignalUse::read_clock);
  }
}

// Everything the program had switched ON is OFF, and nothing is held clear.
void SignalModule::power_on(can::Time now) {
  if (state().phase == Phase::off) {
    for (unsigned number = 0; number < row_of_.size(); ++number) signals_.set_output(number, false, now);
    hold_clear_errors(false);
    hold_clear_nmt_errors(false, now);
    hold_clear_emergencies(false);
  }
  ModuleEngine::power_on(now);
}

void SignalModule::went_off(can::Time now) {
  signals_.clear_inputs(now);
  restart_again_at_ = can::never;
}

void SignalModule::fault_found(can::Time now) { set_input(SignalUse::ready, false, now); }

void SignalModule::initialization_begins(can::Time now) {
  restart_again_at_ = can::never;
  const SignalRow* ready = row_for_[std::to_underlying(SignalUse::ready)];
  const bool was_ready = ready != nullptr && signals_.input(ready->number);
  signals_.clear_inputs(now);
  set_input(SignalUse::ready, was_ready, now);
}

void SignalModule::initialized(bool by_restart, can::Time now) {
  if (wanted(SignalUse::online)) go_online(now);
  set_input(SignalUse::ready, !state().hardware_fault, now);
  if (!wanted(SignalUse::restart)) return;
  if (by_restart) set_input(SignalUse::restart, true, now);
  restart_again_at_ = by_restart ? can::later(now, profile().restart_repeat_time) : now;
}

void SignalModule::tick(can::Time now) {
  end_due_initialization(now);
  if (now >= restart_again_at_) {
    restart_again_at_ = can::never;
    begin_restart(now);
  }
  ModuleEngine::tick(now);
}

can::Time SignalModule::deadline() const noexcept {
  return std::min(restart_again_at_, ModuleEngine::deadline());
}

// After every event, and nearly always as it was.
void SignalModule::show(can::Time now) {
  const std::array shown{
      std::pair{SignalUse::online, layer2_state() == Layer2State::online},
      std::pair{SignalUse::transmit_trigger, trigger_done()}, std::pair{SignalUse::error, any_error()},
      std::pair{SignalUse::nmt_error, any_nmt_error()}, std::pair{SignalUse::emergency, any_emergency()}};
  std::uint32_t changed = 0;
  for (const auto& [use, on] : shown) {
    const std::uint32_t bit = bit_of_[std::to_underlying(use)];
    changed |= (signals_.inputs() ^ (on ? bit : 0U)) & bit;
  }
  if (changed == 0) return;
  for (const auto& [use, on] : shown) set_input(use, on, now);
}

}  // namespace canopus::module
