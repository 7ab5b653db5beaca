#include "canopus/plc/built_in_program.hpp"

#include <algorithm>
#include <utility>

namespace canopus::plc {

namespace {

constexpr can::Duration scan_time = std::chrono::milliseconds(10);

bool is_on(std::uint32_t signals, unsigned number) { return (signals >> number & 1U) != 0; }

}  // namespace

BuiltInProgram::BuiltInProgram(module::Module& module, const module::ProgramInterface& interface, Task task)
    : words_(module.buffer_memory()),
      signals_(module.signals()),
      interface_(interface),
      task_(std::move(task)),
      interval_(task_.exchange.value_or(can::Duration{})) {}

void BuiltInProgram::powered(can::Time now) {
  is_on_ = true;
  const bool exchanges_by_itself = interface_.exchange.kind == Kind::none;
  if (task_.exchange && !exchanges_by_itself) next_request_ = now + interval_;
  if (has_set_up() && !interface_.ready) next_scan_ = now + scan_time;
}

can::Time BuiltInProgram::deadline() const noexcept { return std::min(next_request_, next_scan_); }

void BuiltInProgram::look(can::Time now) {
  if (has_set_up()) set_up(now);
  const module::ProgramRequest& exchange = interface_.exchange;
  if (!is_requested_ || exchange.kind == Kind::signal || is_initializing(now)) return;
  if (exchange.kind == Kind::write || !bits_are_set(exchange, now)) exchange_done(now);
}

void BuiltInProgram::tick(can::Time now) {
  if (next_scan_ <= now) next_scan_ = now + scan_time;  // the look that follows is the scan
  if (next_request_ > now) return;
  if (is_requested_) {
    signals_->set_output(interface_.exchange.signal, false, now);
    exchange_done(now);
  } else if (may_exchange(now)) {
    request_exchange(now);
  } else {  // not ready, or a client plays the program: look again later
    next_request_ = now + interval_;
  }
}

bool BuiltInProgram::signal_changed(module::SignalKind kind, unsigned number, bool on, can::Time now) {
  const bool is_input = kind == module::SignalKind::input;
  if (is_input && number == interface_.ready && !on) was_ready_ = false;  // it starts anew
  if (!owns_signal_ || number != interface_.exchange.signal) return false;
  if (is_input && on) next_request_ = now;
  if (is_input && !on) owns_signal_ = false;
  return true;
}

bool BuiltInProgram::buffer_written(module::BufferAddress address) const noexcept {
  return is_requesting_ && address == interface_.exchange.word;
}

bool BuiltInProgram::is_initializing(can::Time now) {
  return interface_.initializing != 0 &&
         (words_->read_word(interface_.status, now) & interface_.initializing) != 0;
}

bool BuiltInProgram::bits_are_set(const module::ProgramRequest& request, can::Time now) {
  return (words_->read_word(request.word, now) & request.bits) != 0;
}

bool BuiltInProgram::may_exchange(can::Time now) {
  const bool is_ready =
      interface_.ready ? is_on(signals_->inputs(), *interface_.ready) : !is_initializing(now);
  if (!is_ready) return false;
  const module::ProgramRequest& exchange = interface_.exchange;
  if (exchange.kind == Kind::signal) {
    return !is_on(signals_->inputs(), exchange.signal) && !is_on(signals_->outputs(), exchange.signal);
  }
  return exchange.kind == Kind::write || !bits_are_set(exchange, now);
}

void BuiltInProgram::request_exchange(can::Time now) {
  const module::ProgramRequest& exchange = interface_.exchange;
  requested_at_ = now;
  next_request_ = can::never;
  is_requested_ = true;
  if (exchange.kind == Kind::signal) {
    owns_signal_ = true;
    signals_->set_output(exchange.signal, true, now);
  } else {
    is_requesting_ = true;
    words_->write_word(exchange.word, exchange.bits, now);
    is_requesting_ = false;
  }
}

void BuiltInProgram::exchange_done(can::Time now) {
  is_requested_ = false;
  next_request_ = std::max(requested_at_ + interval_, now + std::chrono::milliseconds(1));
}

void BuiltInProgram::set_online(bool on, can::Time now) {
  const module::ProgramRequest& online = interface_.online;
  if (online.kind == Kind::signal) {
    signals_->set_output(online.signal, on, now);
  } else if (online.kind != Kind::none && (on || bits_are_set(online, now))) {
    words_->write_word(online.word, on ? online.bits : std::uint16_t{0}, now);
  }
}

void BuiltInProgram::set_up(can::Time now) {
  const bool is_ready = is_on_ && !is_initializing(now);
  if (std::exchange(was_ready_, is_ready) || !is_ready) return;
  if (task_.online) set_online(false, now);
  for (const Word& word : task_.words) words_->write_word(word.address, word.value, now);
  if (task_.online) set_online(true, now);
}

}  // namespace canopus::plc
