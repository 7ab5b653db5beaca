#include "canopus/plc/program/exchange_monitor.hpp"

#include <cstdio>
#include <utility>

#include "canopus/ascii/hex.hpp"

namespace canopus::plc {

namespace {

using Kind = module::ProgramRequest::Kind;

constexpr can::Duration check_again = std::chrono::milliseconds(100);

/// "X01"
std::string signal_name(char kind, unsigned number) { return kind + ascii::hex(number, 2); }

/// "1.0 s", "31 ms"
std::string shown(can::Duration time) {
  char text[32];
  const double seconds = std::chrono::duration<double>(time).count();
  if (time < std::chrono::seconds(1)) {
    std::snprintf(text, sizeof text, "%.0f ms", seconds * 1000);
  } else {
    std::snprintf(text, sizeof text, "%.1f s", seconds);
  }
  return text;
}

}  // namespace

void ExchangeMonitor::signal_changed(module::SignalKind kind, unsigned number, bool on, bool by_program,
                                     can::Time now) {
  if (interface_.exchange.kind != Kind::signal || number != interface_.exchange.signal) return;
  if (kind == module::SignalKind::input) {
    if (on) answered(now);
    return;
  }
  if (on) return requested(now);
  if (!is_open_) return;
  if (by_program) {
    was_taken_back_ = true;
    has_initialized_ = has_initialized_ || is_initializing(now);
  } else {
    forget();  // a program may change its mind
  }
}

void ExchangeMonitor::buffer_written(module::BufferAddress address, std::uint16_t value, can::Time now) {
  const module::ProgramRequest& exchange = interface_.exchange;
  if (exchange.kind != Kind::bits || address != exchange.word || (value & exchange.bits) == 0) return;
  requested(now);
}

void ExchangeMonitor::forget() noexcept {
  is_open_ = has_initialized_ = was_taken_back_ = was_reported_ = false;
  alarm_ = can::never;
}

void ExchangeMonitor::requested(can::Time now) {
  if (is_open_) return;
  forget();
  is_open_ = true;
  has_initialized_ = is_initializing(now);
  since_ = now;
  alarm_ = now + patience;
}

void ExchangeMonitor::answered(can::Time now) {
  if (!is_open_) return;
  if (was_reported_) {
    report_ = "process data are exchanged again, after " + shown(now - since_);
  } else if (was_taken_back_) {
    const std::string y = signal_name('Y', head_ + interface_.exchange.signal);
    report_ = "process data were not exchanged for " + shown(now - since_) + ": the module " +
              (has_initialized_ ? "initialized while " + y + " was ON" : "did not answer") +
              "; the built-in PLC program took " + y + " back and set it again";
  }
  forget();
}

void ExchangeMonitor::update(can::Time now) {
  const module::ProgramRequest& exchange = interface_.exchange;
  if (!is_open_ || exchange.kind != Kind::bits || is_initializing(now)) return;
  if ((words_->peek(exchange.word, now) & exchange.bits) == 0) answered(now);
}

void ExchangeMonitor::tick(can::Time now) {
  if (alarm_ > now) return;
  alarm_ = now + check_again;
  if (is_initializing(now)) return;
  alarm_ = can::never;  // its answer was received
  was_reported_ = true;
  report_ = described(now);
}

std::string ExchangeMonitor::trouble(can::Time now) const {
  return is_open_ && was_reported_ ? described(now) : std::string();
}

std::string ExchangeMonitor::described(can::Time now) const {
  const module::ProgramRequest& exchange = interface_.exchange;
  std::string text = "no process data exchange: ";
  if (exchange.kind == Kind::signal) {
    const std::string x = signal_name('X', head_ + exchange.signal);
    const std::string y = signal_name('Y', head_ + exchange.signal);
    text += x + " has not come for " + shown(now - since_);
    if (has_initialized_) text += ", because " + y + " was set while the module initialized";
    return text + ". To recover, set " + y + " OFF and ON again";
  }
  text +=
      "the module has not acknowledged BFM #" + std::to_string(exchange.word) + " for " + shown(now - since_);
  if (has_initialized_) text += ", because it was written while the module initialized";
  return text + ". To recover, write BFM #" + std::to_string(exchange.word) + " again";
}

bool ExchangeMonitor::is_initializing(can::Time now) const {
  if (interface_.initializing == 0) return false;
  const bool is_set = (words_->peek(interface_.status, now) & interface_.initializing) != 0;
  return is_set != interface_.initializing_is_0;
}

}  // namespace canopus::plc
