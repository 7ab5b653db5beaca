// The PLC's side: words, signals, data exchange, and what is updated after every event.

#include <algorithm>
#include <cstdio>

#include "canopus/module/me3can1_q/buffer_table.hpp"
#include "canopus/module/me3can1_q/firmware.hpp"

namespace canopus::module::me3can1_q {

namespace {

// Bits of G20.
constexpr std::uint16_t process_data = 1U << 8;
constexpr std::uint16_t emergency_data = 1U << 12;

// Bits of G25 [ME3CAN1-Q Tab. 3-10].
constexpr std::uint16_t operational = 1U << 0;
constexpr std::uint16_t warning_level = 1U << 1;
constexpr std::uint16_t nmt_reset_seen = 1U << 6;
constexpr std::uint16_t initialization = 1U << 7;
constexpr unsigned network_state_shift = 8;
constexpr std::uint16_t lss_active = 1U << 10;
constexpr std::uint16_t time_seen = 1U << 12;
constexpr std::uint16_t slave_start_up = 1U << 14;
constexpr std::uint16_t nmt_master = 1U << 15;

// [ME3CAN1-Q 3.5.8]
constexpr unsigned warning_counter = 96;
constexpr unsigned passive_counter = 128;
constexpr std::uint16_t bus_off_counter = 256;

constexpr std::array<std::uint8_t, 5> no_detail{};

// The inhibit time of EMCY counts in milliseconds [ME3CAN1-Q 4.6.12].
constexpr can::Duration emergency_retry = std::chrono::milliseconds(1);

// A frame is too short to be seen.
constexpr can::Duration traffic_afterglow = std::chrono::milliseconds(50);

}  // namespace

std::uint16_t Me3can1Q::Firmware::read(BufferAddress address, can::Time now) {
  return state_ == State::off ? std::uint16_t{0} : buffer_.read(address, now);
}

void Me3can1Q::Firmware::write(BufferAddress address, std::uint16_t value, can::Time now) {
  if (state_ == State::off) return;
  const bool allowed = !initializing() || (state_ == State::stuck && command_.owns(address));
  const WriteResult result = allowed ? buffer_.write(address, value, now) : WriteResult::refused;
  errors_.record(result, address);
  if (result == WriteResult::done) {
    if (address == g::daily_correction) time_stamp_.correction_changed(now);
    if (address == g::start_all_delay || address == g::sdo_time_out) use_communication_settings();
    if (observer_ != nullptr) observer_->buffer_written(address, value, now);
  } else if (observer_ != nullptr && result != WriteResult::ignored) {
    std::array<char, 80> text{};
    const int length = std::snprintf(
        text.data(), text.size(), "G%u = %u: %s", address, value,
        result == WriteResult::invalid ? "not a value this word accepts" : "not to be written now");
    tell({text.data(), static_cast<std::size_t>(length)}, now);
  }
  update(now);
}

std::uint16_t Me3can1Q::Firmware::read_word(BufferAddress address, can::Time) {
  const bool bus_off = controller_.error_state() == can::ErrorState::bus_off;
  switch (address) {
    case g::data_exchange_control: return exchange_running_ ? process_data : std::uint16_t{0};
    case g::communication_status: return communication_status();
    case g::transmit_errors: return bus_off ? bus_off_counter : controller_.transmit_error_counter();
    case g::receive_errors:
      return bus_off ? bus_off_counter
                     : std::min<std::uint16_t>(controller_.receive_error_counter(), passive_counter);
    case g::active_baud_rate: return static_cast<std::uint16_t>(bit_rate_ * 10U);  // 0.1 kbit/s
    default: return buffer_.word(address);
  }
}

WriteResult Me3can1Q::Firmware::write_word(BufferAddress address, std::uint16_t value, can::Time now) {
  if (address == g::communication_status) {
    // Writing acts on bits 6 and 12 only, and only as a 0.
    if ((value & nmt_reset_seen) == 0) nmt_reset_seen_ = false;
    if ((value & time_seen) == 0) time_seen_ = false;
    return WriteResult::done;
  }
  // G20: what was chosen is not what is read, which shows whether an exchange runs.
  buffer_.set_word(address, value);
  if (address == g::time_stamp) {
    // Takes effect directly: bits 31 (consume) and 30 (produce) of 1012H [ME3CAN1-Q 3.5.11, 4.6.9].
    canopen::ObjectDictionary& objects = node_.dictionary();
    const std::uint32_t cob_id =
        (objects.get<std::uint32_t>(0x1012, 0) & 0x3FFF'FFFFU) | (value & 1U) << 31 | (value & 2U) << 29;
    const std::array<std::uint8_t, 4> bytes{
        static_cast<std::uint8_t>(cob_id & 0xFF), static_cast<std::uint8_t>(cob_id >> 8 & 0xFF),
        static_cast<std::uint8_t>(cob_id >> 16 & 0xFF), static_cast<std::uint8_t>(cob_id >> 24)};
    if (objects.write(0x1012, 0, bytes, now) != canopen::AbortCode::none) use_time_role();
  }
  return WriteResult::done;
}

void Me3can1Q::Firmware::use_time_role() {
  const auto cob_id = node_.dictionary().get<std::uint32_t>(0x1012, 0);
  time_stamp_.set_role((cob_id >> 31 & 1U) != 0, (cob_id >> 30 & 1U) != 0);
}

// A value out of range changes nothing; the request is answered all the same, so that the program can look at
// G29.
void Me3can1Q::Firmware::set_clock(can::Time now) {
  if (const auto wrong = time_stamp_.set_from_words(now)) {
    errors_.record(WriteResult::invalid, *wrong);
    tell("the time stamp words are not a date and time", now);
  }
  signals_.set_input(signal::time_set, true, now);
}

void Me3can1Q::Firmware::send_time(can::Time now) {
  node_.send_time(time_stamp_.time_of_day(now), now);  // only if 1012H, the role and the state allow
  time_stamp_.transmission_done(now);
}

std::uint16_t Me3can1Q::Firmware::communication_status() const {
  unsigned status = 0;
  if (initializing()) status |= initialization;
  if (nmt_reset_seen_) status |= nmt_reset_seen;
  if (time_seen_) status |= time_seen;
  if (state_ != State::running) return static_cast<std::uint16_t>(status);
  const unsigned counter =
      std::max<unsigned>(controller_.transmit_error_counter(), controller_.receive_error_counter());
  if (counter >= warning_counter && controller_.error_state() == can::ErrorState::error_active) {
    status |= warning_level;
  }
  if (!canopen_mode()) return static_cast<std::uint16_t>(status);
  switch (node_.state()) {
    case canopen::NmtState::operational: status |= operational | 2U << network_state_shift; break;
    case canopen::NmtState::pre_operational: status |= 1U << network_state_shift; break;
    case canopen::NmtState::stopped:
    case canopen::NmtState::initialising: break;
  }
  if (master_.lss_active()) status |= lss_active;
  if (master_.starting()) status |= slave_start_up;
  if (master_.active()) status |= nmt_master;
  return static_cast<std::uint16_t>(status);
}

void Me3can1Q::Firmware::set_output(unsigned number, bool on, can::Time now) {
  if (state_ == State::off || number >= 32 || !signals_.set_output(number, on, now)) return;
  if (on) {
    rising(number, now);
  } else {
    falling(number, now);
  }
  update(now);
}

void Me3can1Q::Firmware::rising(unsigned number, can::Time now) {
  if (number == signal::error) return errors_.hold_clear(true);
  // While a restart, or the start after power-on, runs, Y02 is looked at when it ends. An NMT reset it ends.
  const bool may_restart = number == signal::restart && state_ != State::initializing;
  const bool may_command = number == signal::command && state_ == State::stuck;
  if (initializing() && !may_restart && !may_command) return;
  switch (number) {
    case signal::data_exchange: return begin_exchange(now);
    case signal::restart: return begin_restart(now);
    case signal::online:
      if (!canopen_mode()) go_online(now);
      return;
    case signal::transmit_trigger:
      if (!canopen_mode()) layer2_.request_trigger(true);
      return;
    case signal::command: return command_.execute(static_cast<Modes>(mode_bit_), now, profile_.command_time);
    case signal::save_restore: return begin_save(now);
    case signal::nmt_error:
      if (canopen_mode()) clear_nmt_errors(now);
      return;
    case signal::emergency: return emergencies_.hold_clear(true);
    case signal::time_set:
      if (canopen_mode()) set_clock(now);
      return;
    case signal::time_read:
      if (!canopen_mode()) return;
      time_stamp_.show(now);
      return signals_.set_input(signal::time_read, true, now);
    default: return;
  }
}

// A completed signal goes OFF with its request.
void Me3can1Q::Firmware::falling(unsigned number, can::Time now) {
  switch (number) {
    case signal::restart: restart_again_at_ = can::never; [[fallthrough]];
    case signal::data_exchange:
    case signal::command:
    case signal::time_set:
    case signal::time_read:
    case signal::save_restore: return signals_.set_input(number, false, now);
    case signal::online: return layer2_.go_offline();
    case signal::transmit_trigger: return layer2_.request_trigger(false);
    case signal::error: return errors_.hold_clear(false);
    case signal::emergency: return emergencies_.hold_clear(false);
    default: return;
  }
}

void Me3can1Q::Firmware::begin_exchange(can::Time now) {
  if (canopen_mode()) {
    const std::uint16_t selection =
        buffer_.written(g::data_exchange_control) & (process_data | emergency_data);
    emergencies_pending_ = selection == 0 || (selection & emergency_data) != 0;
    if (selection == 0 || (selection & process_data) != 0) {
      exchange_running_ = true;
      exchange_.snapshot();
    }
  } else {
    layer2_.snapshot();
  }
  exchange_end_ = can::later(now, profile_.exchange_time);
}

void Me3can1Q::Firmware::end_exchange(can::Time now) {
  exchange_end_ = can::never;
  if (emergencies_pending_) emergencies_.refresh();
  emergencies_pending_ = false;
  if (!canopen_mode()) layer2_.exchange();
  // Process data wait for Operational; the exchange is reported as done all the same
  // [ME3CAN1-Q 3.3.2, 3.5.1].
  process_data_pending_ = exchange_running_;
  if (signals_.output(signal::data_exchange)) signals_.set_input(signal::data_exchange, true, now);
}

void Me3can1Q::Firmware::exchange_process_data(can::Time now) {
  process_data_pending_ = exchange_running_ = false;
  exchange_.exchange(node_);
  node_.values_changed(now);
}

// Settings that make no sense keep the module offline.
void Me3can1Q::Firmware::go_online(can::Time now) {
  const auto wrong = layer2_.go_online(now);
  if (!wrong) return;
  errors_.record(WriteResult::invalid, *wrong);
  std::array<char, 80> text{};
  const int length = std::snprintf(text.data(), text.size(),
                                   "stays offline: G%u = %u does not go with the other Layer 2 settings",
                                   *wrong, buffer_.word(*wrong));
  tell({text.data(), static_cast<std::size_t>(length)}, now);
}

void Me3can1Q::Firmware::clear_nmt_errors(can::Time now) {
  const auto node = static_cast<std::uint8_t>(buffer_.word(g::error_clear_node));
  nmt_status_.clear_life_guarding(node);
  master_.clear_error_control(node, now);
}

void Me3can1Q::Firmware::command_finished(can::Time now) {
  if (signals_.output(signal::command)) signals_.set_input(signal::command, true, now);
}

void Me3can1Q::Firmware::controller_changed(can::Time now) {
  if (state_ != State::running || !network_.is_open()) return;
  const can::ErrorState state = controller_.error_state();
  const bool was_off = errors_.bit(error_bit::bus_off);
  errors_.follow(error_bit::bus_off, state == can::ErrorState::bus_off);
  if (errors_.follow(error_bit::error_passive, state == can::ErrorState::error_passive) &&
      errors_.bit(error_bit::error_passive)) {
    raise_event({0x8120, 0x11, no_detail});
  }
  if (!was_off && errors_.bit(error_bit::bus_off)) {
    tell("the CAN controller is bus-off", now);
    command_.bus_lost(command_error::bus_off, now);
    if (canopen_mode()) node_.communication_error(now);
  }
  update(now);
}

void Me3can1Q::Firmware::tick(can::Time now) {
  if (now >= initialized_at_) end_initialization(now);
  if (now >= restart_again_at_) {
    restart_again_at_ = can::never;
    begin_restart(now);
  }
  if (now >= nmt_reset_end_) {
    nmt_reset_end_ = can::never;
    nmt_reset_seen_ = true;
    nmt_status_.set_state(node_.node_id(), static_cast<std::uint8_t>(node_.state()));
  }
  if (now >= exchange_end_) end_exchange(now);
  if (now >= save_end_) end_save(now);
  if (state_ == State::running && now >= time_stamp_.next_transmission()) send_time(now);
  if (now >= node_.deadline()) node_.tick(now);
  if (now >= master_.deadline()) master_.tick(now);
  if (now >= command_.deadline()) command_.tick(now);
  if (now >= layer2_.deadline()) layer2_.tick(now);
  update(now);
}

can::Time Me3can1Q::Firmware::deadline() const noexcept {
  const can::Time time_due = state_ == State::running ? time_stamp_.next_transmission() : can::never;
  return std::min({events_due_, initialized_at_, restart_again_at_, nmt_reset_end_, exchange_end_, save_end_,
                   time_due, node_.deadline(), master_.deadline(), command_.deadline(), layer2_.deadline()});
}

// After every event: what hangs on several causes.
void Me3can1Q::Firmware::update(can::Time now) {
  if (state_ == State::off) return;
  if (state_ == State::running) {
    const std::uint32_t overflows = controller_.transmit_overflows() + controller_.receive_overflows();
    if (overflows != overflows_) {
      overflows_ = overflows;
      if (errors_.raise(error_bit::queue_overflow)) {
        raise_event({0x8110, 0x11, no_detail});
        tell("a queue has overflown: frames were lost", now);
      }
    }
    if (canopen_mode()) {
      send_events(now);
      if (process_data_pending_ && node_.state() == canopen::NmtState::operational)
        exchange_process_data(now);
    } else {
      events_.clear();
      if (layer2_.any_slot_error() && errors_.raise(error_bit::message_slot)) {
        tell("messages of a slot were lost: they come faster than the module takes them", now);
      }
    }
  }
  if (told_writes_ != flash_.writes()) tell_wear(now);
  errors_.follow(error_bit::hardware, hardware_fault_);
  errors_.follow(error_bit::flash, flash_error_);
  signals_.set_input(signal::online, layer2_.online(), now);
  signals_.set_input(signal::transmit_trigger, layer2_.trigger_done(), now);
  signals_.set_input(signal::error, errors_.any(), now);
  signals_.set_input(signal::nmt_error, canopen_mode() && nmt_status_.any_failure(), now);
  signals_.set_input(signal::emergency, canopen_mode() && !emergencies_.empty(), now);
}

void Me3can1Q::Firmware::send_events(can::Time now) {
  if (node_.state() != canopen::NmtState::pre_operational &&
      node_.state() != canopen::NmtState::operational) {
    events_.clear();
  }
  const auto held_back = std::ranges::find_if_not(events_, [&](const Event& event) {
    return node_.emergency(event.code, event.error_register, event.manufacturer, now);
  });
  events_.erase(events_.begin(), held_back);
  events_due_ = events_.empty() ? can::never : can::later(now, emergency_retry);
}

std::vector<Led> Me3can1Q::Firmware::leds(can::Time now) const {
  std::vector<Led> leds{Led{"RUN"}, Led{"ERR."}, Led{"CAN RUN"}, Led{"TX/RX"}, Led{"CAN ERR"}};
  if (state_ == State::off) return leds;
  Led& run = leds[0];
  Led& error = leds[1];
  Led& can_run = leds[2];
  Led& traffic = leds[3];
  Led& can_error = leds[4];
  run.pattern = LedPattern::on;
  if (errors_.any()) error.pattern = LedPattern::on;
  if (state_ != State::running) return leds;
  if (master_.lss_active()) {
    can_run.pattern = LedPattern::flickering;
  } else if (canopen_mode()) {
    switch (node_.state()) {
      case canopen::NmtState::operational: can_run.pattern = LedPattern::on; break;
      case canopen::NmtState::pre_operational: can_run.pattern = LedPattern::blinking; break;
      case canopen::NmtState::stopped: can_run.pattern = LedPattern::single_flash; break;
      case canopen::NmtState::initialising: break;
    }
  } else if (layer2_.online()) {
    can_run.pattern = LedPattern::on;
  }
  if (last_frame_ != can::Time{} && now - last_frame_ < traffic_afterglow) traffic.pattern = LedPattern::on;
  // The most severe cause wins.
  const bool warning = std::max<unsigned>(controller_.transmit_error_counter(),
                                          controller_.receive_error_counter()) >= warning_counter;
  if (errors_.bit(error_bit::bus_off)) {
    can_error.pattern = LedPattern::on;
  } else if (master_.lss_active()) {
    can_error = {can_error.name, LedPattern::flickering, true};
  } else if (nmt_status_.any_failure()) {
    can_error.pattern = LedPattern::double_flash;
  } else if (warning) {
    can_error.pattern = LedPattern::single_flash;
  } else if (errors_.any()) {
    can_error.pattern = LedPattern::blinking;
  }
  return leds;
}

// What the real flash memory lasts for [ME3CAN1-Q 4.6]; this one goes on.
void Me3can1Q::Firmware::tell_wear(can::Time now) {
  const bool worn_before = told_writes_ > flash_endurance;
  told_writes_ = flash_.writes();
  if (told_writes_ > flash_endurance && !worn_before) {
    tell("the flash memory has been written more often than the real one lasts for (10000 times)", now);
  }
}

void Me3can1Q::Firmware::tell(std::string_view what, can::Time now) {
  if (observer_ != nullptr) observer_->error_raised(what, now);
}

}  // namespace canopus::module::me3can1_q
