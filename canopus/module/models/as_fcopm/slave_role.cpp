#include "canopus/module/models/as_fcopm/slave_role.hpp"

#include <algorithm>
#include <utility>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/emcy_code.hpp"
#include "canopus/module/models/as_fcopm/object_table.hpp"

namespace canopus::module::as_fcopm {

namespace {

constexpr std::uint8_t generic_error = 0x01;
constexpr std::uint8_t internal_error = 0x80;
/// Of an error that stopped the CPU; the manual prints no codes.
constexpr std::uint16_t internal_software = 0x6100;

constexpr std::uint8_t shown(std::uint8_t error_register) {
  if ((error_register & internal_error) != 0) return internal_error;
  return error_register != 0 ? generic_error : std::uint8_t{0};
}

}  // namespace

bool SlaveRole::Outlet::send(const can::Frame& frame) {
  constexpr std::uint32_t emcy = 0x80;
  if (frame.extended || frame.identifier != emcy + node_id_ || frame.dlc != 8) return sink_.send(frame);
  can::Frame message = frame;
  message.data[2] = shown(frame.data[2]);
  return sink_.send(message);
}

SlaveRole::SlaveRole(std::shared_ptr<const canopen::DictionaryDescription> objects, std::uint8_t node_id,
                     can::Sink& sink, const Profile& profile)
    : outlet_(sink, node_id), node_(std::move(objects), node_id, outlet_, node_options(profile)) {
  node_.set_listener(this);
  node_.attach(0x1001, 0x1001, *this);
  alarm().add_part(node_.alarm());
  alarm().add_part(next_scan_);
}

void SlaveRole::stop(can::Time) {
  node_.power_off();
  next_scan_ = can::never;
}

canopen::AbortCode SlaveRole::before_read(canopen::ObjectDictionary& objects, const canopen::Entry& entry,
                                          can::Time) {
  objects.set(entry, shown(objects.get<std::uint8_t>(entry)));
  return canopen::AbortCode::none;
}

void SlaveRole::cpu_failed(bool failed, can::Time now) {
  if (std::exchange(cpu_has_failed_, failed) == failed) return;
  if (failed) {
    node_.emergency(internal_software, internal_error, std::array<std::uint8_t, 5>{}, now);
  } else if (!heartbeat_is_lost_ && wrong_lengths_ == 0) {
    node_.emergency_reset(now);
  }
}

OwnCode SlaveRole::code() const noexcept {
  if (wrong_lengths_ != 0) return OwnCode::pdo_length;
  if (heartbeat_is_lost_) return OwnCode::heartbeat_time_out;
  switch (node_.state()) {
    case canopen::NmtState::initialising: return OwnCode::initializing;
    case canopen::NmtState::pre_operational: return OwnCode::pre_operational;
    default: return OwnCode::none;
  }
}

std::uint16_t SlaveRole::read(BufferAddress address) const noexcept {
  if (address >= input_first && address - input_first < slave_words) {
    const auto sub = static_cast<std::uint8_t>(address - input_first + 1);
    return node_.dictionary().get<std::uint16_t>(slave_input_index, sub);
  }
  if (address >= output_first && address - output_first < slave_words)
    return outputs_[address - output_first];
  return 0;
}

void SlaveRole::write(BufferAddress address, std::uint16_t value, can::Time now) {
  if (address < output_first || address - output_first >= slave_words) return;
  outputs_[address - output_first] = value;
  node_.dictionary().set(slave_output_index, static_cast<std::uint8_t>(address - output_first + 1), value);
  next_scan_.bring_forward(can::later(now, scan));
}

void SlaveRole::tick(can::Time now) {
  if (now >= next_scan_) {
    next_scan_ = can::never;
    send_changes(now);
  }
  if (now >= node_.deadline()) node_.tick(now);
}

SlaveRole::Content SlaveRole::content(std::uint16_t number) const noexcept {
  const canopen::ObjectDictionary& objects = node_.dictionary();
  const auto mapping = static_cast<std::uint16_t>(0x1A00 + number);
  const auto count = std::min<std::uint8_t>(objects.get<std::uint8_t>(mapping, 0), 4);
  Content words{};
  for (std::uint8_t sub = 1; sub <= count; ++sub) {
    const auto mapped = objects.get<std::uint32_t>(mapping, sub);
    words[sub - 1U] = objects.get<std::uint16_t>(static_cast<std::uint16_t>(mapped >> 16),
                                                 static_cast<std::uint8_t>(mapped >> 8 & 0xFF));
  }
  return words;
}

// [10.6] A TxPDO with an event timer goes out by it alone; one without at each change, type 0 with the next SYNC.
void SlaveRole::send_changes(can::Time now) {
  if (node_.state() != canopen::NmtState::operational) return;
  const canopen::ObjectDictionary& objects = node_.dictionary();
  for (std::uint16_t number = 0; number < pdos; ++number) {
    const auto parameters = static_cast<std::uint16_t>(0x1800 + number);
    const auto type = objects.get<std::uint8_t>(parameters, 2);
    const bool by_event = type >= 254 && objects.get<std::uint16_t>(parameters, 5) == 0;
    if (!by_event && type != 0) continue;
    const Content now_there = content(number);
    if (now_there != sent_[number] && node_.tpdo_event(number, now)) sent_[number] = now_there;
  }
}

void SlaveRole::nmt_state_changed(canopen::NmtState state, can::Time now) {
  if (state != canopen::NmtState::operational) return;
  sent_.fill({});
  next_scan_ = can::later(now, scan);
}

// A reset leaves the program's words alone.
void SlaveRole::reset_done(canopen::NmtCommand, can::Time) {
  wrong_lengths_ = taken_longer_ = 0;
  heartbeat_is_lost_ = false;
  for (std::uint8_t word = 0; word < slave_words; ++word)
    node_.dictionary().set(slave_output_index, static_cast<std::uint8_t>(word + 1), outputs_[word]);
}

void SlaveRole::rpdo_received(std::uint16_t number, can::Time) {
  const unsigned bit = 1U << number;
  if ((taken_longer_ & bit) == 0) wrong_lengths_ &= ~bit;
  taken_longer_ &= ~bit;
}

void SlaveRole::rpdo_length_wrong(std::uint16_t number, std::uint16_t code, can::Time) {
  const unsigned bit = 1U << number;
  wrong_lengths_ |= bit;
  if (code == canopen::emcy_code::pdo_too_long) taken_longer_ |= bit;
}

void SlaveRole::heartbeat_received(std::uint8_t, canopen::NmtState, can::Time) { heartbeat_is_lost_ = false; }

void SlaveRole::heartbeat_lost(std::uint8_t, can::Time) { heartbeat_is_lost_ = true; }

void SlaveRole::object_written(const canopen::Entry& entry, can::Time now) {
  if (entry.index == 0x1016) heartbeat_is_lost_ = false;
  if (entry.index >= 0x1800 && entry.index < 0x1C00) next_scan_.bring_forward(can::later(now, scan));
}

}  // namespace canopus::module::as_fcopm
