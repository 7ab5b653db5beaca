// Life cycle: construction, power, initialization, restart, stored settings.

#include "canopus/module/me3can1_q/firmware.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "canopus/module/me3can1_q/buffer_table.hpp"
#include "canopus/module/me3can1_q/object_table.hpp"
#include "canopus/module/stored_settings.hpp"

namespace canopus::module::me3can1_q {

namespace {

// Names in the non-volatile memory.
constexpr std::string_view words_name = "buffer-memory";
constexpr std::string_view objects_name = "object-dictionary";
constexpr std::string_view concise_dcfs_name = "concise-dcf";
// There while a save runs: found at a start, the supply went off in the middle of one.
constexpr std::string_view saving_name = "saving";

constexpr std::uint32_t save_signature = 0x65766173;  // "save"
constexpr std::uint32_t load_signature = 0x64616F6C;  // "load"

constexpr unsigned stack_records = 11;
constexpr unsigned ring_records = 11;

canopen::NodeOptions node_options() {
  return {
      .dismiss_events_during_inhibit = true,
      .unsent_values_are_changed = false,
      .send_tpdos_on_start = false,
      .sdo_write_is_event = false,
      .tpdo_rtr_bit_is_constant = true,
      .rtr_transmission_types = false,
      .profile_event_transmission_type = false,
      .inhibit_time_resolution = std::chrono::milliseconds(1),
      .extended_identifiers = false,
      .sync_needs_active_master = true,
      .sync_period_resolution = std::chrono::milliseconds(1),
      .history_clears_error_register = true,
      .empty_history_reads_zero = true,
      .guarding_emergency_names_node = true,
      .sync_length_error = 0x8200,
  };
}

Layer2Rules layer2_rules(const Profile& profile) {
  return {.cycle_unit = profile.layer2_cycle_unit,
          .message_time = profile.layer2_message_time,
          .waiting_messages = profile.layer2_waiting_messages};
}

// No software check, no restore [ME3CAN1-Q Tab. 4-30]; the manual knows no SDO block transfer.
manager::MasterOptions master_options() {
  manager::MasterOptions options;
  options.assignment_bits = 0x1D;
  options.block_from = 0;
  return options;
}

Modes mode_bit(std::uint16_t function_mode) {
  switch (function_mode) {
    case 11: return layer2_11;
    case 29: return layer2_29;
    default: return canopen_405;
  }
}

std::uint32_t number(std::span<const std::uint8_t> value) {
  std::uint32_t result = 0;
  for (std::size_t i = 0; i < value.size() && i < 4; ++i) {
    result |= static_cast<std::uint32_t>(value[i]) << (8 * i);
  }
  return result;
}

}  // namespace

Me3can1Q::Firmware::Firmware(can::Controller& controller, NonVolatileMemory& memory, Profile profile)
    : controller_(controller),
      network_(controller),
      memory_(memory),
      flash_(memory, {words_name, objects_name, concise_dcfs_name}),
      profile_(std::move(profile)),
      buffer_(buffer_table),
      errors_(error_layout),
      emergencies_(g::emergencies, stack_records, ring_records),
      nmt_status_(g::error_clear_node, g::nmt_state),
      node_(object_dictionary(), 127, network_, node_options()),
      master_(node_, controller, master_options()),
      command_(g::command, command_table, *this, network_),
      exchange_(exchange_layout, buffer_),
      layer2_(layer2_layout, layer2_rules(profile_), buffer_, controller),
      time_stamp_(time_stamp_layout, buffer_),
      concise_dcfs_(node_, master_, flash_, concise_dcfs_name, {.erase_time = profile_.erase_time}) {
  controller_.set_automatic_recovery(false);  // the way out of bus-off is a restart [ME3CAN1-Q 3.5.7]
  node_.set_listener(this);
  master_.set_listener(this);
  node_.dictionary().attach(0x0002, 0x0008, *this);
  node_.dictionary().attach(0x1010, 0x1011, *this);
  exchange_.attach(node_.dictionary());

  buffer_.attach(g::data_exchange_control, g::data_exchange_control, *this);
  buffer_.attach(g::communication_status, g::communication_status, *this);
  buffer_.attach(g::transmit_errors, g::active_baud_rate, *this);
  buffer_.attach(g::time_stamp, g::time_stamp, *this);
  buffer_.attach(g::error_status, g::error_status, errors_);
  buffer_.attach(g::setting_error, g::refused_write, errors_);
  buffer_.attach(g::error_clear_node + 1, g::error_clear_node + 127, nmt_status_);
  buffer_.attach(g::nmt_state + 1, g::nmt_state + 127, nmt_status_);
  buffer_.attach(g::emergencies, emergencies_.last_address(), emergencies_);
  buffer_.attach(g::command, g::command + CommandInterface::word_count - 1, command_);
  events_.reserve(most_events);
}

bool Me3can1Q::Firmware::preset_word(BufferAddress address, std::uint16_t value) {
  const bool is_stored = std::ranges::any_of(buffer_table, [&](const BufferRow& row) {
    return row.stored == Stored::yes && address >= row.first && address <= row.last &&
           (address - row.first) % row.stride == 0;
  });
  if (!is_stored) return false;
  const auto mode = shelf_words_.find(g::function_mode);
  const Modes modes =
      address == g::function_mode || mode == shelf_words_.end() ? all_modes : mode_bit(mode->second);
  if (buffer_.check(address, value, modes) != WriteResult::done) return false;
  shelf_words_[address] = value;
  return true;
}

Modes Me3can1Q::Firmware::preset_mode() const {
  const auto mode = shelf_words_.find(g::function_mode);
  return mode == shelf_words_.end() ? canopen_405 : mode_bit(mode->second);
}

bool Me3can1Q::Firmware::takes_word(BufferAddress address, std::uint16_t value) const {
  return buffer_.check(address, value, preset_mode()) == WriteResult::done;
}

std::optional<BufferAddress> Me3can1Q::Firmware::layer2_preset_error() const {
  const Modes modes = preset_mode();
  if ((modes & layer2) == 0) return std::nullopt;
  BufferMemory words(buffer_table);
  words.select_mode(modes);
  words.apply_stored(shelf_words_);
  Layer2Settings settings(layer2_layout, layer2_rules(profile_), words);
  settings.select(modes == layer2_29);
  return settings.first_error();
}

canopen::AbortCode Me3can1Q::Firmware::preset_object(std::uint16_t index, std::uint8_t sub,
                                                     std::span<const std::uint8_t> value) {
  // A dictionary of its own, without the services' handlers: the order of the presets must not matter.
  canopen::ObjectDictionary scratch(object_dictionary(), 127);
  const auto entry = scratch.find(index, sub);
  if (!entry) return entry.error();
  if (const auto code = scratch.write(index, sub, value, {}); code != canopen::AbortCode::none) return code;
  if (!entry->description->stored) return canopen::AbortCode::cannot_store;
  const manager::MasterOptions& rules = master_.options();
  const bool bad_role = index == 0x1F80 && (number(value) & ~rules.start_up_bits) != 0;
  const bool bad_assignment = index == 0x1F81 && (value[0] & ~rules.assignment_bits) != 0;
  if (bad_role || bad_assignment) return canopen::AbortCode::invalid_value;
  shelf_objects_[{index, sub}] = {value.begin(), value.end()};
  return canopen::AbortCode::none;
}

void Me3can1Q::Firmware::set_observer(ModuleObserver* observer) {
  observer_ = observer;
  signals_.set_observer(observer);
}

bool Me3can1Q::Firmware::initializing() const noexcept {
  return state_ == State::initializing || state_ == State::stuck || nmt_reset_end_ != can::never;
}

bool Me3can1Q::Firmware::canopen_mode() const noexcept { return mode_ == 405; }

Layer2State Me3can1Q::Firmware::layer2_state() const noexcept {
  if (canopen_mode()) return Layer2State::inactive;
  return layer2_.online() ? Layer2State::online : Layer2State::offline;
}

void Me3can1Q::Firmware::power_on(can::Time now) {
  if (state_ != State::off) return;
  for (unsigned y = 0; y < 32; ++y) signals_.set_output(y, false, now);
  restarting_ = false;
  clear_concise_dcfs_ = false;  // kept in RAM: only a restart carries it out
  begin_initialization(profile_.power_on_time, now);
}

void Me3can1Q::Firmware::power_off(can::Time now) {
  if (state_ == State::off) return;
  state_ = State::off;
  hardware_fault_ = false;
  master_.stop(now);
  node_.power_off();
  layer2_.go_offline();
  command_.reset();
  signals_.clear_inputs(now);
  initialized_at_ = restart_again_at_ = nmt_reset_end_ = exchange_end_ = save_end_ = can::never;
  events_.clear();
  events_due_ = can::never;
}

void Me3can1Q::Firmware::inject(ModuleFault fault, can::Time now) {
  if (state_ == State::off) return;
  switch (fault) {
    case ModuleFault::hardware_error:
      hardware_fault_ = true;
      signals_.set_input(signal::ready, false, now);
      tell("hardware error", now);
      // A severe error that the device causes itself acts as a communication error does [ME3CAN1-Q 4.7].
      if (state_ == State::running && canopen_mode()) node_.communication_error(now);
      return update(now);
    case ModuleFault::watchdog_error:
      power_off(now);  // until the supply has been off
      return tell("watchdog error", now);
  }
}

// [ME3CAN1-Q 3.3.2, 3.5.5] From the start of a restart on the module is off the bus; what it holds is what
// its flash memory holds.
void Me3can1Q::Firmware::begin_initialization(can::Duration duration, can::Time now) {
  state_ = State::initializing;
  initialized_at_ = can::later(now, duration);
  restart_again_at_ = nmt_reset_end_ = exchange_end_ = save_end_ = can::never;
  process_data_pending_ = emergencies_pending_ = exchange_running_ = false;
  nmt_reset_seen_ = time_seen_ = false;
  save_request_ = 0;
  events_.clear();
  events_due_ = can::never;
  master_.stop(now);
  node_.power_off();
  layer2_.go_offline();
  errors_.reset();
  emergencies_.clear();
  nmt_status_.reset();
  command_.reset();
  exchange_.reset();
  const bool ready = signals_.input(signal::ready);
  signals_.clear_inputs(now);
  signals_.set_input(signal::ready, ready, now);
  if (std::exchange(clear_concise_dcfs_, false)) concise_dcfs_.clear();
  load_settings();
  layer2_.start(mode_ == 29);
  update(now);
}

void Me3can1Q::Firmware::load_settings() {
  flash_error_ = false;
  flash_.load();
  told_writes_ = flash_.writes();
  if (memory_.read(saving_name).state != NonVolatileMemory::Content::State::missing) {
    flash_error_ = true;
    memory_.erase(saving_name);
  }
  stored_words_.clear();
  const NonVolatileMemory::Content content = flash_.read(words_name);
  if (content.state == NonVolatileMemory::Content::State::missing) {
    stored_words_ = shelf_words_;
  } else if (auto words = content.state == NonVolatileMemory::Content::State::good
                              ? decode_words(content.bytes)
                              : std::nullopt) {
    stored_words_ = std::move(*words);
  } else {
    flash_error_ = true;
  }
  if (!use_stored_words()) {  // answered with the factory's defaults, all of them
    flash_error_ = true;
    stored_words_.clear();
    use_stored_words();
  }
  if (canopen_mode()) time_stamp_.reset();
  // In a layer 2 mode all settings of the object dictionary are deleted [ME3CAN1-Q 3.5.2].
  if (!canopen_mode() && flash_.read(objects_name).state != NonVolatileMemory::Content::State::missing) {
    flash_.write(objects_name, {});
  }
}

// Function mode and words. False when they are not all what a module can have stored.
bool Me3can1Q::Firmware::use_stored_words() {
  const auto mode = stored_words_.find(g::function_mode);
  mode_ = mode != stored_words_.end() && one_of(function_modes).contains(mode->second) ? mode->second : 405;
  mode_bit_ = mode_bit(mode_);
  buffer_.select_mode(static_cast<Modes>(mode_bit_));
  return buffer_.apply_stored(stored_words_);
}

void Me3can1Q::Firmware::end_initialization(can::Time now) {
  initialized_at_ = can::never;
  if (canopen_mode() && configuration_is_faulty(now)) {
    state_ = State::stuck;
    return;
  }
  state_ = State::running;
  bit_rate_ = buffer_.word(g::baud_rate);
  controller_.restart(bit_rate_ * 1000U);
  overflows_ = 0;
  if (canopen_mode()) {
    node_.set_node_id(static_cast<std::uint8_t>(buffer_.word(g::node_address)));
    use_communication_settings();
    node_.power_on(now);
  } else if (signals_.output(signal::online)) {
    go_online(now);
  }
  signals_.set_input(signal::ready, !hardware_fault_, now);
  const bool restarted = std::exchange(restarting_, false);
  if (signals_.output(signal::restart)) {
    if (restarted) signals_.set_input(signal::restart, true, now);
    restart_again_at_ = restarted ? can::later(now, profile_.restart_repeat_time) : now;
  }
  controller_changed(now);
}

// A faulty CANopen configuration keeps the module in its initial state; the way out is the object
// dictionary's reset by the command interface, and a restart [ME3CAN1-Q 8.1.2].
bool Me3can1Q::Firmware::configuration_is_faulty(can::Time now) {
  const NonVolatileMemory::Content content = flash_.read(objects_name);
  if (content.state != NonVolatileMemory::Content::State::good) return false;
  canopen::ObjectDictionary scratch(object_dictionary(),
                                    static_cast<std::uint8_t>(buffer_.word(g::node_address)));
  if (!apply_objects(content.bytes, scratch)) return false;  // damaged, not faulty: the defaults hold
  const auto faulty = first_faulty_mapping(scratch);
  if (!faulty) return false;
  std::array<char, 120> text{};
  const int length =
      std::snprintf(text.data(), text.size(),
                    "stays in initialization: the stored object dictionary is faulty at %04XH:%02X; "
                    "write 1011H:01 by the CIF and restart",
                    faulty->index, faulty->sub);
  tell({text.data(), static_cast<std::size_t>(length)}, now);
  return true;
}

void Me3can1Q::Firmware::begin_restart(can::Time now) {
  if (save_end_ != can::never)
    end_save(now);  // a restart is no cut of the supply: what was asked for is saved
  // The frame is in the controller's queue before the node goes off; the controller starts anew only at the
  // end of the initialization, so it leaves.
  if (state_ == State::running && canopen_mode()) {
    node_.emergency(0x6200, 0x01, std::array<std::uint8_t, 5>{0x4D, 0x45, 0x30, 0x30, 0x34}, now);  // "ME004"
  }
  restarting_ = true;
  begin_initialization(profile_.restart_time, now);
}

void Me3can1Q::Firmware::use_communication_settings() {
  master_.options().start_all_delay = std::chrono::milliseconds(buffer_.word(g::start_all_delay));
  master_.options().sdo_time_out = sdo_time_out();
  master_.options().bit_rate = bit_rate_ * 1000U;
}

// The node has its defaults again; what was stored goes on top.
void Me3can1Q::Firmware::load_objects() {
  canopen::ObjectDictionary& objects = node_.dictionary();
  if (!concise_dcfs_.load()) flash_error_ = true;
  // Its default depends on the node-ID in a way of its own [ME3CAN1-Q 4.8.10].
  objects.set<std::uint16_t>(0x1F90, 6, static_cast<std::uint16_t>(4000 + 10 * node_.node_id()));
  const NonVolatileMemory::Content content = flash_.read(objects_name);
  switch (content.state) {
    case NonVolatileMemory::Content::State::missing:
      for (const auto& [place, value] : shelf_objects_) {
        objects.assign(objects.description().find(place.first, place.second), value);
      }
      break;
    case NonVolatileMemory::Content::State::good:
      if (!apply_objects(content.bytes, objects)) flash_error_ = true;
      break;
    case NonVolatileMemory::Content::State::damaged: flash_error_ = true; break;
  }
}

void Me3can1Q::Firmware::reset_requested(canopen::NmtCommand, can::Time now) {
  nmt_reset_seen_ = false;
  if (state_ != State::running) return;
  nmt_reset_end_ = can::later(now, profile_.nmt_reset_time);
  master_.stop(now);
}

void Me3can1Q::Firmware::reset_done(canopen::NmtCommand, can::Time now) {
  load_objects();
  use_time_role();
  nmt_status_.reset();
  master_.start(now);
}

// The data types 0002H-0008H [ME3CAN1-Q 4.5].
canopen::AbortCode Me3can1Q::Firmware::before_read(canopen::ObjectDictionary&, const canopen::Entry& entry,
                                                   can::Time) {
  return entry.index <= 0x0008 ? canopen::AbortCode::no_object : canopen::AbortCode::none;
}

// 1010H and 1011H [ME3CAN1-Q 4.6.10, 4.6.11].
canopen::AbortCode Me3can1Q::Firmware::before_write(canopen::ObjectDictionary& dictionary,
                                                    const canopen::Entry& entry,
                                                    std::span<const std::uint8_t> value, can::Time) {
  if (entry.index <= 0x0008) return canopen::AbortCode::no_object;
  const bool storing = entry.index == 0x1010;
  if (number(value) != (storing ? save_signature : load_signature)) return canopen::AbortCode::cannot_store;
  // Restored settings are factory defaults, not those of the shelf: an empty content, not a missing one.
  const bool written =
      storing ? flash_.write(objects_name, encode_objects(dictionary)) : flash_.write(objects_name, {});
  if (written && !storing) clear_concise_dcfs_ = true;
  return written ? canopen::AbortCode::none : canopen::AbortCode::hardware_error;
}

void Me3can1Q::Firmware::after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                     can::Time) {
  dictionary.set<std::uint32_t>(entry, 1);  // saves, or restores, on command
}

void Me3can1Q::Firmware::begin_save(can::Time now) {
  save_request_ = buffer_.written(g::save_restore) & 3U;
  if ((save_request_ & 1U) != 0) memory_.write(saving_name, {});
  save_end_ = can::later(now, profile_.save_time);
}

void Me3can1Q::Firmware::end_save(can::Time now) {
  save_end_ = can::never;
  if ((save_request_ & 2U) != 0) {
    buffer_.restore_initial();
    use_communication_settings();
    time_stamp_.correction_changed(now);
  }
  if ((save_request_ & 1U) != 0) {
    if ((save_request_ & 2U) != 0) stored_words_.clear();  // of all modes
    buffer_.collect_stored(stored_words_);
    const bool written = flash_.write(words_name, encode_words(stored_words_));
    memory_.erase(saving_name);
    if (!written) {
      flash_error_ = true;
      tell("the flash memory could not be written", now);
    }
  }
  buffer_.set_word(g::save_restore, 0);
  signals_.set_input(signal::save_restore, true, now);
}

}  // namespace canopus::module::me3can1_q
