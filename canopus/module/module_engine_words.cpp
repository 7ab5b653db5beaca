// The PLC's side of the engine: words, data exchange, saving, clock, LEDs.

#include <algorithm>
#include <string>

#include "canopus/module/module_engine.hpp"

namespace canopus::module {

namespace {

// [ME3CAN1-Q 3.5.8]
constexpr unsigned warning_counter = 96;
constexpr std::uint16_t passive_counter = 128;
constexpr std::uint16_t bus_off_counter = 256;

// A frame is too short to be seen.
constexpr can::Duration traffic_afterglow = std::chrono::milliseconds(50);

}  // namespace

std::uint16_t ModuleEngine::read_word(BufferAddress address, can::Time now) {
  return state_ == State::off ? std::uint16_t{0} : buffer_.read(address, now);
}

void ModuleEngine::write_word(BufferAddress address, std::uint16_t value, can::Time now) {
  if (state_ == State::off) return;
  const bool allowed = !initializing() || (state_ == State::stuck && command_.owns(address));
  const WriteResult result = allowed ? buffer_.write(address, value, now) : WriteResult::refused;
  errors_.record(result, address);
  if (result == WriteResult::done) {
    if (address == model_.time_stamp.daily_correction()) time_stamp_.correction_changed(now);
    if (address == model_.words.start_all_delay || address == model_.words.sdo_time_out) {
      use_communication_settings();
    }
    if (observer_ != nullptr) observer_->buffer_written(address, value, now);
    word_written(address, value, now);
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
  tell(text, now);
}

std::uint16_t ModuleEngine::StatusWords::read_word(BufferAddress address, can::Time) {
  const ModuleEngine& engine = *engine_;
  const SystemWords& words = engine.model_.words;
  const bool bus_off = engine.controller_.error_state() == can::ErrorState::bus_off;
  if (address == words.data_exchange_control) {
    return engine.exchange_running_ ? engine.model_.data_exchange.running : std::uint16_t{0};
  }
  if (address == words.communication_status) return engine.communication_status();
  if (address == words.transmit_errors) {
    return bus_off ? bus_off_counter : engine.controller_.transmit_error_counter();
  }
  if (address == words.receive_errors) {
    return bus_off ? bus_off_counter
                   : std::min<std::uint16_t>(engine.controller_.receive_error_counter(), passive_counter);
  }
  if (address == words.active_baud_rate) return static_cast<std::uint16_t>(engine.bit_rate_ * 10U);
  return engine.buffer_.word(address);
}

WriteResult ModuleEngine::StatusWords::write_word(BufferAddress address, std::uint16_t value, can::Time now) {
  ModuleEngine& engine = *engine_;
  if (address == engine.model_.words.communication_status) {
    // Writing acts on two bits only, and only as a 0.
    const CommunicationStatusBits& bits = engine.model_.communication_status;
    if ((value & bits.nmt_reset_seen) == 0) engine.nmt_reset_seen_ = false;
    if ((value & bits.time_seen) == 0) engine.time_seen_ = false;
    return WriteResult::done;
  }
  // The data exchange control word: what was chosen is not what is read, which shows whether an exchange
  // runs.
  engine.buffer_.set_word(address, value);
  if (address == engine.model_.time_stamp.role()) engine.change_time_role(value, now);
  return WriteResult::done;
}

// Takes effect directly: bits 31 (consume) and 30 (produce) of 1012H [ME3CAN1-Q 3.5.11, 4.6.9].
void ModuleEngine::change_time_role(std::uint16_t role, can::Time now) {
  canopen::ObjectDictionary& objects = node_.dictionary();
  const std::uint32_t cob_id =
      (objects.get<std::uint32_t>(0x1012, 0) & 0x3FFF'FFFFU) | (role & 1U) << 31 | (role & 2U) << 29;
  if (objects.write(0x1012, 0, canopen::little_endian(cob_id, 4), now) != canopen::AbortCode::none) {
    use_time_role();
  }
}

void ModuleEngine::use_time_role() {
  const auto cob_id = node_.dictionary().get<std::uint32_t>(0x1012, 0);
  time_stamp_.set_role((cob_id >> 31 & 1U) != 0, (cob_id >> 30 & 1U) != 0);
}

// A value out of range changes nothing; the request is answered all the same, so that the program can look at
// the error status.
void ModuleEngine::set_clock(can::Time now) {
  if (const auto wrong = time_stamp_.set_from_words(now)) {
    errors_.record(WriteResult::invalid, *wrong);
    tell("the time stamp words are not a date and time", now);
  }
  done(Request::set_clock, now);
}

void ModuleEngine::read_clock(can::Time now) {
  time_stamp_.show(now);
  done(Request::read_clock, now);
}

void ModuleEngine::send_time(can::Time now) {
  node_.send_time(time_stamp_.time_of_day(now), now);  // only if 1012H, the role and the state allow
  time_stamp_.transmission_done(now);
}

unsigned ModuleEngine::error_counter() const {
  return std::max<unsigned>(controller_.transmit_error_counter(), controller_.receive_error_counter());
}

std::uint16_t ModuleEngine::communication_status() const {
  const CommunicationStatusBits& bits = model_.communication_status;
  unsigned status = 0;
  if (initializing()) status |= bits.initialization;
  if (nmt_reset_seen_) status |= bits.nmt_reset_seen;
  if (time_seen_) status |= bits.time_seen;
  if (state_ != State::running) return static_cast<std::uint16_t>(status);
  if (error_counter() >= warning_counter && controller_.error_state() == can::ErrorState::error_active) {
    status |= bits.warning_level;
  }
  if (!canopen_mode()) return static_cast<std::uint16_t>(status);
  switch (node_.state()) {
    case canopen::NmtState::operational: status |= bits.operational | bits.operational_state; break;
    case canopen::NmtState::pre_operational: status |= bits.pre_operational_state; break;
    case canopen::NmtState::stopped:
    case canopen::NmtState::initialising: break;
  }
  if (master_.lss_active()) status |= bits.lss_active;
  if (master_.starting()) status |= bits.slave_start_up;
  if (master_.active()) status |= bits.nmt_master;
  return static_cast<std::uint16_t>(status);
}

void ModuleEngine::begin_exchange(can::Time now) {
  if (canopen_mode()) {
    const DataExchangeBits& bits = model_.data_exchange;
    const std::uint16_t selection = buffer_.written(model_.words.data_exchange_control) &
                                    static_cast<std::uint16_t>(bits.process_data | bits.emergencies);
    emergencies_pending_ = selection == 0 || (selection & bits.emergencies) != 0;
    if (selection == 0 || (selection & bits.process_data) != 0) {
      exchange_running_ = true;
      exchange_.snapshot();
    }
  } else {
    layer2_.snapshot();
  }
  exchange_end_ = can::later(now, profile_.exchange_time);
}

void ModuleEngine::end_exchange(can::Time now) {
  exchange_end_ = can::never;
  if (emergencies_pending_) emergencies_.refresh();
  emergencies_pending_ = false;
  if (!canopen_mode()) layer2_.exchange();
  // Process data wait for Operational; the exchange is reported as done all the same
  // [ME3CAN1-Q 3.3.2, 3.5.1].
  process_data_pending_ = exchange_running_;
  done(Request::data_exchange, now);
}

void ModuleEngine::exchange_process_data(can::Time now) {
  process_data_pending_ = exchange_running_ = false;
  exchange_.exchange(node_);
  node_.values_changed(now);
}

// Settings that make no sense keep the module offline.
void ModuleEngine::go_online(can::Time now) {
  const auto wrong = layer2_.go_online(now);
  if (!wrong) return;
  errors_.record(WriteResult::invalid, *wrong);
  tell_of_word(*wrong, buffer_.word(*wrong),
               " does not go with the other Layer 2 settings: the module stays offline", now);
}

void ModuleEngine::hold_clear_nmt_errors(bool held, can::Time now) {
  nmt_errors_held_clear_ = held;
  if (!held || initializing() || !canopen_mode()) return;
  const auto node = static_cast<std::uint8_t>(buffer_.word(model_.words.error_clear_node));
  nmt_status_.clear_life_guarding(node);
  master_.clear_error_control(node, now);
}

void ModuleEngine::execute_command(can::Time now) {
  command_.execute(mode_->bit, now, profile_.command_time);
}

void ModuleEngine::begin_save(can::Time now) {
  settings_.begin_save(buffer_.written(model_.words.save_restore));
  save_end_ = can::later(now, profile_.save_time);
}

void ModuleEngine::end_save(can::Time now) {
  save_end_ = can::never;
  if (!settings_.end_save()) tell("the flash memory could not be written", now);
  if (settings_.restores()) {
    use_communication_settings();
    time_stamp_.correction_changed(now);
  }
  buffer_.set_word(model_.words.save_restore, 0);
  done(Request::save_restore, now);
}

std::vector<Led> ModuleEngine::leds(can::Time now) const {
  std::vector<Led> leds;
  for (const LedRow& row : model_.leds) {
    Led& led = leds.emplace_back(row.name);
    if (state_ == State::off) continue;
    const auto light = [&](bool on) { led.pattern = on ? LedPattern::on : LedPattern::off; };
    switch (row.use) {
      case LedUse::supply: light(true); break;
      case LedUse::error: light(errors_.any()); break;
      case LedUse::network_state: led.pattern = network_state_pattern(); break;
      case LedUse::traffic:
        light(state_ == State::running && last_frame_ != can::Time{} &&
              now - last_frame_ < traffic_afterglow);
        break;
      case LedUse::network_error:
        led.pattern = network_error_pattern();
        // Flickers in turn with the one for the state.
        led.opposite = led.pattern == LedPattern::flickering;
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
  if (state_ != State::running) return LedPattern::off;
  if (master_.lss_active()) return LedPattern::flickering;
  if (!canopen_mode()) return layer2_.online() ? LedPattern::on : LedPattern::off;
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
  if (state_ != State::running) return LedPattern::off;
  if (errors_.bit(model_.errors.bus_off)) return LedPattern::on;
  if (master_.lss_active()) return LedPattern::flickering;
  if (nmt_status_.any_failure()) return LedPattern::double_flash;
  if (error_counter() >= warning_counter) return LedPattern::single_flash;
  if (errors_.any()) return LedPattern::blinking;
  return LedPattern::off;
}

}  // namespace canopus::module
