#include "canopus/module/engine/signal_port.hpp"

#include <utility>

#include "canopus/module/engine/module_engine.hpp"

namespace canopus::module {

using Phase = ModuleState::Phase;

SignalPort::SignalPort(ModuleEngine& engine, std::span<const SignalRow> table) : engine_(engine) {
  for (const SignalRow& row : table) {
    row_of_.at(row.number) = &row;
    row_for_.at(std::to_underlying(row.use)) = &row;
    bit_of_.at(std::to_underlying(row.use)) = 1U << row.number;
  }
}

std::unique_ptr<RequestPort> requests_by_signals(ModuleEngine& engine) {
  return std::make_unique<SignalPort>(engine, engine.description().signals);
}

bool SignalPort::wanted(RequestUse use) const {
  const SignalRow* row = row_for_[std::to_underlying(use)];
  return row != nullptr && (row->modes & engine_.state().mode->bit) != 0 && signals_.output(row->number);
}

void SignalPort::set_input(RequestUse use, bool on, can::Time now) {
  if (const SignalRow* row = row_for_[std::to_underlying(use)]) signals_.set_input(row->number, on, now);
}

void SignalPort::set_output(unsigned signal, bool on, can::Time now) {
  if (!engine_.state().works() || signal >= row_of_.size() || !signals_.set_output(signal, on, now)) return;
  if (const SignalRow* row = row_of_[signal]) on ? rising(*row, now) : falling(*row, now);
  engine_.update(now);
}

void SignalPort::rising(const SignalRow& row, can::Time now) {
  switch (row.use) {  // as long as they are ON, at any time
    case RequestUse::error: return engine_.hold_clear_errors(true, now);
    case RequestUse::nmt_error: return engine_.hold_clear_nmt_errors(true, now);
    default: break;
  }
  // While a restart, or the start after power-on, runs, its request is looked at when it ends. An NMT reset
  // it ends.
  const bool may_restart = row.use == RequestUse::restart && engine_.state().phase != Phase::initializing;
  const bool may_command = row.use == RequestUse::command && engine_.state().phase == Phase::stuck;
  if (engine_.initializing() && !may_restart && !may_command) return;
  if ((row.modes & engine_.state().mode->bit) == 0) return;
  switch (row.use) {
    case RequestUse::data_exchange: return engine_.begin_exchange(now);
    case RequestUse::restart: return engine_.begin_restart(now);
    case RequestUse::online: return engine_.go_online(now);
    case RequestUse::transmit_trigger: return engine_.request_trigger(true);
    case RequestUse::command: return engine_.execute_command(now);
    case RequestUse::save_restore: return engine_.begin_save(now);
    case RequestUse::emergency: return engine_.hold_clear_emergencies(true, now);
    case RequestUse::set_clock: return engine_.set_clock(now);
    case RequestUse::read_clock: return engine_.read_clock(now);
    default: return;
  }
}

void SignalPort::falling(const SignalRow& row, can::Time now) {
  switch (row.use) {
    case RequestUse::save_restore: engine_.end_save_request(); break;
    case RequestUse::restart: alarm().cancel(); break;
    case RequestUse::data_exchange:
    case RequestUse::command:
    case RequestUse::set_clock:
    case RequestUse::read_clock: break;
    case RequestUse::online: return engine_.go_offline(now);
    case RequestUse::transmit_trigger: return engine_.request_trigger(false);
    case RequestUse::error: return engine_.hold_clear_errors(false, now);
    case RequestUse::nmt_error: return engine_.hold_clear_nmt_errors(false, now);
    case RequestUse::emergency: return engine_.hold_clear_emergencies(false, now);
    case RequestUse::ready:
    case RequestUse::none: return;
  }
  signals_.set_input(row.number, false, now);
}

// A request that was taken back meanwhile is not answered.
void SignalPort::done(Request request, can::Time now) {
  const auto answer = [&](RequestUse use) {
    if (wanted(use)) set_input(use, true, now);
  };
  switch (request) {
    case Request::data_exchange: return answer(RequestUse::data_exchange);
    case Request::command: return answer(RequestUse::command);
    case Request::save_restore: return answer(RequestUse::save_restore);
    case Request::set_clock: return answer(RequestUse::set_clock);
    case Request::read_clock: return answer(RequestUse::read_clock);
  }
}

// Everything the program had switched ON is OFF, and nothing is held clear.
void SignalPort::power_on(can::Time now) {
  for (unsigned number = 0; number < row_of_.size(); ++number) signals_.set_output(number, false, now);
  engine_.hold_clear_errors(false, now);
  engine_.hold_clear_nmt_errors(false, now);
  engine_.hold_clear_emergencies(false, now);
}

void SignalPort::power_off(can::Time now) {
  signals_.clear_inputs(now);
  alarm().cancel();
}

void SignalPort::fault_found(can::Time now) { set_input(RequestUse::ready, false, now); }

void SignalPort::initialization_begins(can::Time now) {
  alarm().cancel();
  const SignalRow* ready = row_for_[std::to_underlying(RequestUse::ready)];
  const bool was_ready = ready != nullptr && signals_.input(ready->number);
  signals_.clear_inputs(now);
  set_input(RequestUse::ready, was_ready, now);
}

void SignalPort::initialized(bool by_restart, can::Time now) {
  if (wanted(RequestUse::online)) engine_.go_online(now);
  set_input(RequestUse::ready, !engine_.state().hardware_fault, now);
  if (!wanted(RequestUse::restart)) return;
  if (by_restart) set_input(RequestUse::restart, true, now);
  alarm() = by_restart ? can::later(now, engine_.profile().restart_repeat_time) : now;
}

void SignalPort::tick(can::Time now) {
  if (now < alarm()) return;
  alarm().cancel();
  engine_.begin_restart(now);
}

// After every event, and nearly always as it was.
void SignalPort::show(can::Time now) {
  const std::array shown{std::pair{RequestUse::online, engine_.layer2_state() == Layer2State::online},
                         std::pair{RequestUse::transmit_trigger, engine_.trigger_done()},
                         std::pair{RequestUse::error, engine_.any_error()},
                         std::pair{RequestUse::nmt_error, engine_.any_nmt_error()},
                         std::pair{RequestUse::emergency, engine_.any_emergency()}};
  std::uint32_t bits = 0, on_bits = 0;
  for (const auto& [use, on] : shown) {
    const std::uint32_t bit = bit_of_[std::to_underlying(use)];
    bits |= bit;
    if (on) on_bits |= bit;
  }
  if ((signals_.inputs() & bits) == on_bits) return;
  for (const auto& [use, on] : shown) set_input(use, on, now);
}

}  // namespace canopus::module
