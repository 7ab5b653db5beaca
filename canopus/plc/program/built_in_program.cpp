#include "canopus/plc/program/built_in_program.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace canopus::plc {

namespace {

constexpr can::Duration scan_time = std::chrono::milliseconds(10);
/// Pause after a command that failed.
constexpr can::Duration command_retry = std::chrono::seconds(1);
constexpr std::uint16_t command_busy = 0xFFFF;
constexpr std::uint16_t request_nmt = 0x1F82;
constexpr std::uint16_t start_remote_node = 0x05;

bool is_on(std::uint32_t signals, unsigned number) { return (signals >> number & 1U) != 0; }

}  // namespace

BuiltInProgram::BuiltInProgram(Rack& rack, std::uint16_t head, module::Module& module,
                               const module::ProgramInterface& interface, Task task)
    : rack_(rack),
      head_(head),
      module_(module),
      words_(module.buffer_memory()),
      signals_(module.signals()),
      interface_(interface),
      task_(std::move(task)),
      interval_(task_.exchange.value_or(can::Duration{})) {
  for (can::Alarm* part : {&next_request_, &answer_due_, &next_scan_}) alarm_.add_part(*part);
}

void BuiltInProgram::supply_changed(bool on, can::Time now) {
  exchange_ = Exchange::idle;
  node_start_ = NodeStart::none;
  node_start_due_ = can::never;
  for (can::Alarm* alarm : {&next_request_, &answer_due_, &next_scan_}) alarm->cancel();
  was_ready_ = owns_signal_ = is_running_ = is_setting_up_ = false;
  if (on && rack_.cpu_state() == module::CpuState::run) begin(now);
}

void BuiltInProgram::cpu_changed(module::CpuState state, can::Time now) {
  if (state == module::CpuState::stop) {
    is_running_ = owns_signal_ = false;
    node_start_due_ = can::never;
    for (can::Alarm* alarm : {&next_request_, &answer_due_, &next_scan_}) alarm->cancel();
    return;
  }
  if (is_running_) return;
  end_node_start(NodeStart::none, now);  // Y is as before the STOP
  node_start_due_ = can::never;
  const bool can_start_node = task_.exchange && task_.recover && interface_.command.sdo_write != 0;
  node_start_ = can_start_node ? NodeStart::wanted : NodeStart::none;
  begin(now);
}

void BuiltInProgram::cpu_paused(bool paused, can::Time now) {
  if (paused) {
    is_running_ = false;
    for (can::Alarm* alarm : {&next_request_, &answer_due_, &next_scan_}) alarm->cancel();
  } else if (!is_running_) {
    const bool was_ready = was_ready_;
    begin(now);
    was_ready_ = was_ready;  // a module that did not restart is not set up again
  }
}

void BuiltInProgram::begin(can::Time now) {
  is_running_ = true;
  if (!interface_.ready) was_ready_ = false;  // no restarts were reported in STOP
  if (node_start_ != NodeStart::none || (has_set_up() && !interface_.ready)) next_scan_ = now + scan_time;
  const module::ProgramRequest& exchange = interface_.exchange;
  if (!task_.exchange || exchange.kind == Kind::none) return;
  // Of a request that the STOP interrupted, Y is back, and so an answer will come.
  const bool is_requested = exchange.kind == Kind::signal ? is_on(signals_->outputs(), exchange.signal)
                                                          : exchange_ == Exchange::requested;
  if (exchange_ != Exchange::idle && is_requested) {
    const bool is_answered = exchange.kind == Kind::signal && is_on(signals_->inputs(), exchange.signal);
    exchange_ = is_answered ? Exchange::answered : Exchange::requested;
    owns_signal_ = exchange.kind == Kind::signal;
    requested_at_ = now;
    if (is_answered) next_request_ = now;
    if (!is_answered && task_.recover) answer_due_ = now + answer_time;
    return;
  }
  exchange_ = Exchange::idle;
  owns_signal_ = false;
  next_request_ = now + interval_;
}

void BuiltInProgram::update(can::Time now) {
  if (!is_running_) return;
  if (has_set_up()) set_up(now);
  if (exchange_ != Exchange::requested) return;
  const module::ProgramRequest& exchange = interface_.exchange;
  if (exchange.kind == Kind::signal) {
    if (task_.recover && !is_ready(now)) withdraw_exchange(now);
  } else if (!is_initializing(now) && (exchange.kind == Kind::write || !bits_are_set(exchange, now))) {
    exchange_done(now);
  }
}

void BuiltInProgram::tick(can::Time now) {
  if (next_scan_ <= now) scan(now);
  if (answer_due_ <= now) withdraw_exchange(now);
  if (next_request_ > now) return;
  switch (exchange_) {
    case Exchange::requested: return;
    case Exchange::answered: set_output(interface_.exchange.signal, false, now); return exchange_done(now);
    case Exchange::idle:
      if (may_exchange(now)) return request_exchange(now);
      next_request_ = now + interval_;  // not ready, or a client acts as the program: try again later
      return;
  }
}

bool BuiltInProgram::signal_changed(module::SignalKind kind, unsigned number, bool on, can::Time now) {
  const bool is_input = kind == module::SignalKind::input;
  if (is_input && number == interface_.ready && !on) was_ready_ = false;  // the module restarts
  if (!owns_signal_ || number != interface_.exchange.signal) return false;
  if (is_input && on) {
    exchange_ = Exchange::answered;
    next_request_ = is_running_ ? now : can::never;
    answer_due_ = can::never;
  }
  if (is_input && !on && exchange_ == Exchange::idle) owns_signal_ = false;
  return true;
}

bool BuiltInProgram::buffer_written(module::BufferAddress address) const noexcept {
  return is_writing_ && address == interface_.exchange.word;
}

bool BuiltInProgram::is_initializing(can::Time now) {
  if (interface_.initializing == 0) return false;
  const bool is_set = (words_->program_read(interface_.status, now) & interface_.initializing) != 0;
  return is_set != interface_.initializing_is_0;
}

// The ready signal stays ON in an NMT reset and in a restart [ME3CAN1-Q 3.3.2].
bool BuiltInProgram::is_ready(can::Time now) {
  if (interface_.ready && !is_on(signals_->inputs(), *interface_.ready)) return false;
  return (interface_.ready && !task_.recover) || !is_initializing(now);
}

bool BuiltInProgram::bits_are_set(const module::ProgramRequest& request, can::Time now) {
  return (words_->program_read(request.word, now) & request.bits) != 0;
}

bool BuiltInProgram::may_exchange(can::Time now) {
  if (!is_ready(now)) return false;
  const module::ProgramRequest& exchange = interface_.exchange;
  if (exchange.kind == Kind::signal) {
    return !is_on(signals_->inputs(), exchange.signal) && !is_on(signals_->outputs(), exchange.signal);
  }
  return exchange.kind == Kind::write || !bits_are_set(exchange, now);
}

void BuiltInProgram::set_output(unsigned signal, bool on, can::Time now) {
  const std::uint8_t value = on ? 1 : 0;
  (void)rack_.write_bits(Device::y, head_ + signal, {&value, 1}, now);
}

void BuiltInProgram::request_exchange(can::Time now) {
  const module::ProgramRequest& exchange = interface_.exchange;
  requested_at_ = now;
  next_request_ = can::never;
  if (task_.recover) answer_due_ = now + answer_time;
  exchange_ = Exchange::requested;
  if (exchange.kind == Kind::signal) {
    owns_signal_ = true;
    set_output(exchange.signal, true, now);
  } else {
    is_writing_ = true;
    words_->write_word(exchange.word, exchange.bits, now);
    is_writing_ = false;
  }
}

void BuiltInProgram::exchange_done(can::Time now) {
  exchange_ = Exchange::idle;
  answer_due_ = can::never;
  owns_signal_ = owns_signal_ && is_on(signals_->inputs(), interface_.exchange.signal);
  next_request_ = std::max(requested_at_ + interval_, now + std::chrono::milliseconds(1));
}

void BuiltInProgram::withdraw_exchange(can::Time now) {
  if (interface_.exchange.kind == Kind::signal) set_output(interface_.exchange.signal, false, now);
  exchange_done(now);
  next_request_ = now + std::min(scan_time, interval_);
}

void BuiltInProgram::set_online(bool on, can::Time now) {
  const module::ProgramRequest& online = interface_.online;
  if (online.kind == Kind::signal) {
    set_output(online.signal, on, now);
  } else if (online.kind != Kind::none && (on || bits_are_set(online, now))) {
    words_->write_word(online.word, on ? online.bits : std::uint16_t{0}, now);
  }
}

void BuiltInProgram::set_up(can::Time now) {
  const bool is_started = !is_initializing(now);
  if (!is_started) is_setting_up_ = false;
  if (!std::exchange(was_ready_, is_started) && is_started) {
    is_setting_up_ = true;
    next_word_ = 0;
    if (task_.online) set_online(false, now);
  }
  if (!is_setting_up_) return;
  // A command that a word starts completes before the next word.
  const module::ProgramCommand& command = interface_.command;
  const bool words_execute = command.execute.kind == Kind::write;
  for (; next_word_ < task_.words.size(); ++next_word_) {
    const bool follows_command = next_word_ != 0 && task_.words[next_word_ - 1].address == command.first;
    if (words_execute && follows_command && words_->program_read(command.first, now) == command_busy) return;
    words_->write_word(task_.words[next_word_].address, task_.words[next_word_].value, now);
  }
  is_setting_up_ = false;
  if (task_.online) set_online(true, now);
}

// The update() that follows is part of it.
void BuiltInProgram::scan(can::Time now) {
  if (node_start_ != NodeStart::none) start_own_node(now);
  const bool goes_on = node_start_ != NodeStart::none || (has_set_up() && !interface_.ready);
  next_scan_ = goes_on ? now + scan_time : can::never;
}

// An active NMT master alone can; a start-up that begins or still boots slaves ends with it anyway.
void BuiltInProgram::start_own_node(can::Time now) {
  const module::ProgramCommand& command = interface_.command;
  const unsigned signal = command.execute.signal;
  switch (node_start_) {
    case NodeStart::none: return;
    case NodeStart::wanted: {
      if (is_initializing(now)) return end_node_start(NodeStart::none, now);
      switch (module_.start_up()) {
        case module::StartUp::none:
        case module::StartUp::ended:
        case module::StartUp::halted: return end_node_start(NodeStart::none, now);
        case module::StartUp::booting: return;
        case module::StartUp::waits_for_own_start: break;
      }
      const bool by_signal = command.execute.kind == Kind::signal;
      const bool is_idle =
          !by_signal || (!is_on(signals_->outputs(), signal) && !is_on(signals_->inputs(), signal));
      const bool is_free = is_idle && words_->program_read(command.first, now) != command_busy;
      if (!is_free || (node_start_due_ != can::never && node_start_due_ > now)) return;
      const std::array<std::uint16_t, 6> words{
          command.sdo_write, 0, request_nmt, words_->program_read(interface_.node_address, now), 1,
          start_remote_node};
      // The code last: where there is no signal, it executes the command.
      for (std::uint32_t i = 1; i < words.size(); ++i) words_->write_word(command.first + i, words[i], now);
      words_->write_word(command.first, words[0], now);
      if (by_signal) set_output(signal, true, now);
      node_start_ = NodeStart::requested;
      node_start_due_ = now + answer_time;
      return;
    }
    case NodeStart::requested: {
      const bool by_signal = command.execute.kind == Kind::signal;
      const std::uint16_t result = words_->program_read(command.first, now);
      const bool is_done = by_signal ? is_on(signals_->inputs(), signal) : result != command_busy;
      if (!is_done && now < node_start_due_ && !is_initializing(now)) return;
      const bool succeeded = is_done && result == command.success;
      return end_node_start(succeeded ? NodeStart::none : NodeStart::wanted, now);
    }
  }
}

void BuiltInProgram::end_node_start(NodeStart next, can::Time now) {
  const module::ProgramRequest& execute = interface_.command.execute;
  if (node_start_ == NodeStart::requested && execute.kind == Kind::signal) {
    set_output(execute.signal, false, now);
  }
  node_start_ = next;
  node_start_due_ = now + command_retry;
}

}  // namespace canopus::plc
