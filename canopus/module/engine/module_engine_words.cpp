// The PLC's side of the engine: words, data exchange, saving, clock, LEDs.

#include <algorithm>
#include <string>

#include "canopus/module/engine/module_engine.hpp"

namespace canopus::module {

namespace {

// A frame is too short to be seen.
constexpr can::Duration traffic_afterglow = std::chrono::milliseconds(50);

// With a 29-bit identifier, 8 bytes and every stuff bit, and the space after it.
constexpr unsigned longest_frame_bits = 163;

}  // namespace

std::uint16_t ModuleEngine::read_word(BufferAddress address, can::Time now) {
  return state_.phase == Phase::off ? std::uint16_t{0} : buffer_.read(address, now);
}

void ModuleEngine::write_word(BufferAddress address, std::uint16_t value, can::Time now) {
  if (state_.phase == Phase::off) return;
  const bool allowed = !state_.initializing() || (state_.phase == Phase::stuck && command_.owns(address));
  const bool was_good = !errors_.has(ModuleError::invalid_value);
  const WriteResult result = allowed ? buffer_.write(address, value, now) : WriteResult::refused;
  errors_.record(result, address);
  if (was_good && errors_.has(ModuleError::invalid_value)) {
    diagnostics_.raise(Diagnosis::invalid_value, now, {errors_.invalid_address()});
  }
  if (result == WriteResult::done) {
    if (observer_ != nullptr) observer_->buffer_written(address, value, now);
    port_->serve(now);
  } else if (result != WriteResult::ignored) {
    tell_of_word(
        address, value,
        result == WriteResult::invalid ? ": not a value this word accepts" : ": not to be written now", now);
  }
  update(now);
}

// "G24 = 300: not a value this word accepts".
void ModuleEngine::tell_of_word(BufferAddress address, std::uint16_t value, std::string_view what,
                                can::Time now) {
  if (observer_ == nullptr) return;
  std::string text(model_.word_prefix);
  text += std::to_string(address) + " = " + std::to_string(value);
  text += what;
  report(text, now);
}

// A value out of range changes nothing; the request is answered all the same, so that the program can look at
// the error status.
void ModuleEngine::set_clock(can::Time now) {
  if (const auto wrong = time_stamp_.set_from_words(now)) {
    errors_.record(WriteResult::invalid, *wrong);
    diagnostics_.raise(Diagnosis::invalid_value, now, {*wrong});
    report("the time stamp words are not a date and time", now);
  }
  port_->done(Request::set_clock, now);
}

void ModuleEngine::read_clock(can::Time now) {
  time_stamp_.show(now);
  port_->done(Request::read_clock, now);
}

void ModuleEngine::begin_exchange(can::Time now) {
  exchange_.begin(state_.canopen_mode(), can::later(now, profile_.exchange_time));
}

// Settings that make no sense keep the module offline.
void ModuleEngine::go_online(can::Time now) {
  join_layer2_bus(now);
  const auto wrong = layer2_.go_online(now);
  if (!wrong) return;
  errors_.record(WriteResult::invalid, *wrong);
  diagnostics_.raise(Diagnosis::invalid_value, now, {*wrong});
  tell_of_word(*wrong, buffer_.word(*wrong),
               " does not go with the other Layer 2 settings: the module stays offline", now);
}

void ModuleEngine::go_offline(can::Time now) {
  if (layer2_.online()) off_wire_at_ = can::never;
  layer2_.go_offline();
  leave_layer2_bus(now);
}

// [RJ71CN91 App. 1 Y3, App. 2 G24] The bit rate is what its word says now; bus-off is left.
void ModuleEngine::join_layer2_bus(can::Time now) {
  if (layer2_.online()) return;
  off_wire_at_ = can::never;
  if (layer2_.rules().online_applies_bit_rate) {
    const std::uint16_t bit_rate = settings_.bit_rate();
    if (bit_rate != state_.bit_rate || controller_.error_state() == can::ErrorState::bus_off) {
      state_.bit_rate = bit_rate;
      controller_.restart(bit_rate * 1000U);
      overflows_ = 0;
    }
  }
  if (layer2_.rules().offline_is_silent) controller_.set_power(true);
  wire_left_ = false;
  controller_changed(now);
}

// A frame that is on the wire is completed first.
void ModuleEngine::leave_layer2_bus(can::Time now) {
  if (!layer2_.rules().offline_is_silent) return;
  if (controller_.error_state() == can::ErrorState::bus_off) layer2_.drop_stop_messages();
  if (layer2_.uses_bus()) {
    off_wire_at_ = can::never;
    wire_left_ = false;
    return;
  }
  if (wire_left_) return;
  if (off_wire_at_ == can::never) {
    off_wire_at_ = can::later(now, std::chrono::microseconds(longest_frame_bits * 1000 / state_.bit_rate));
  } else if (now >= off_wire_at_) {
    off_wire_at_ = can::never;
    wire_left_ = true;
    controller_.set_power(false);
  }
}

// [RJ71CN91 App. 1 YF] Node errors are cleared with the others where the model says so: those of all nodes.
void ModuleEngine::hold_clear_errors(bool held, can::Time now) {
  const bool had_bad_value = errors_.has(ModuleError::invalid_value);
  errors_.hold_clear(held);
  diagnostics_.hold_clear(held);
  if (held && state_.phase != Phase::off) diagnostics_.log(ModuleEvent::errors_cleared, now);
  if (!held && !had_bad_value && errors_.has(ModuleError::invalid_value)) {
    diagnostics_.raise(Diagnosis::invalid_value, now, {errors_.invalid_address()});
  }
  if (!held && errors_.has(ModuleError::bus_off)) diagnostics_.raise(Diagnosis::bus_off, now);
  if (!model_.error_status || !model_.error_status->clears_node_failures) return;
  nmt_status_.hold_clear_all(held);
  if (!held || state_.phase == Phase::off || state_.initializing() || !state_.canopen_mode()) return;
  nmt_status_.clear_life_guarding(0);
  master_.clear_error_control(0, now);
}

void ModuleEngine::hold_clear_nmt_errors(bool held, can::Time now) {
  nmt_status_.hold_clear(held);
  if (held && state_.phase != Phase::off) diagnostics_.log(ModuleEvent::node_failures_cleared, now);
  if (held && !state_.initializing() && state_.canopen_mode()) clear_nmt_errors(now);
}

void ModuleEngine::hold_clear_emergencies(bool held, can::Time now) {
  emergencies_.hold_clear(held);
  if (held) diagnostics_.log(ModuleEvent::emergencies_cleared, now);
}

void ModuleEngine::clear_nmt_errors(can::Time now) {
  const std::uint8_t node = nmt_status_.node_to_clear();
  nmt_status_.clear_life_guarding(node);
  master_.clear_error_control(node, now);
}

void ModuleEngine::execute_command(can::Time now) {
  command_.execute(state_.mode->bit, now, profile_.command_time);
}

// [RJ71CN91 App. 1 Y1F] A request that is refused is not answered.
void ModuleEngine::begin_save(can::Time now) {
  if (model_.settings.saves_offline_only && layer2_.online()) {
    if (errors_.raise(ModuleError::save_while_online)) {
      report("nothing is saved or restored while Layer 2 is online", now);
      diagnostics_.raise(Diagnosis::save_while_online, now);
    }
    return;
  }
  settings_.begin_save(can::later(now, profile_.save_time));
}

void ModuleEngine::end_save(can::Time now) {
  if (!settings_.end_save()) report("the flash memory could not be written", now);
  if (settings_.saves()) diagnostics_.log(ModuleEvent::saved, now);
  if (settings_.restores()) {
    diagnostics_.log(ModuleEvent::restored, now);
    network_settings_.apply();
    time_stamp_.correction_changed(now);
  }
  port_->done(Request::save_restore, now);
}

std::vector<Led> ModuleEngine::leds(can::Time now) const {
  std::vector<Led> leds;
  for (const LedRow& row : model_.leds) {
    Led& led = leds.emplace_back(row.name);
    if (state_.phase == Phase::off) continue;
    const auto light = [&](bool on) { led.pattern = on ? LedPattern::on : LedPattern::off; };
    switch (row.use) {
      case LedUse::supply: light(diagnostics_.worst() != ErrorClass::major); break;
      case LedUse::error:
        light(errors_.any() || diagnostics_.worst().has_value());
        if (diagnostics_.worst() == ErrorClass::moderate) led.pattern = LedPattern::blinking;
        if (diagnostics_.worst() == ErrorClass::major) led.pattern = LedPattern::off;
        led.error = true;
        break;
      case LedUse::network_state: led.pattern = network_state_pattern(); break;
      case LedUse::traffic:
        light(state_.running() && last_frame_ != can::Time{} && now - last_frame_ < traffic_afterglow);
        break;
      case LedUse::network_error:
        led.pattern = network_error_pattern();
        // Flickers in turn with the one for the state.
        led.opposite = led.pattern == LedPattern::flickering;
        led.error = !led.opposite;
        break;
    }
  }
  return leds;
}

std::vector<SlaveBootRecord> ModuleEngine::boots() const {
  std::vector<SlaveBootRecord> boots;
  for (std::uint8_t node_id = 1; node_id <= 127; ++node_id) {
    const manager::BootRecord& record = master_.boot_record(node_id);
    if (record.step != manager::BootStep::idle) boots.push_back({node_id, record});
  }
  return boots;
}

LedPattern ModuleEngine::network_state_pattern() const {
  if (!state_.running()) return LedPattern::off;
  if (master_.lss_active()) return LedPattern::flickering;
  if (!state_.canopen_mode()) return layer2_.online() ? LedPattern::on : LedPattern::off;
  switch (node_.state()) {
    case canopen::NmtState::operational: return LedPattern::on;
    case canopen::NmtState::pre_operational: return LedPattern::blinking;
    case canopen::NmtState::stopped: return LedPattern::single_flash;
    case canopen::NmtState::initialising: break;
  }
  return LedPattern::off;
}

// The most severe cause wins.
LedPattern ModuleEngine::network_error_pattern() const {
  if (!state_.running()) return LedPattern::off;
  if (errors_.has(ModuleError::bus_off)) return LedPattern::on;
  if (master_.lss_active()) return LedPattern::flickering;
  if (nmt_status_.any_failure()) return LedPattern::double_flash;
  if (error_counter(controller_) >= warning_counter) return LedPattern::single_flash;
  if (errors_.any()) return LedPattern::blinking;
  return LedPattern::off;
}

}  // namespace canopus::module
