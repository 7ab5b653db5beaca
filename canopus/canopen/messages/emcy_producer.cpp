#include "canopus/canopen/messages/emcy_producer.hpp"

#include <algorithm>
#include <cstring>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/service/node_listener.hpp"

namespace canopus::canopen {

EmcyProducer::EmcyProducer(NodeContext& node) : node_(node), timer_(node.timers.add()) {
  node.dictionary.attach(0x1003, 0x1003, *this);
  node.dictionary.attach(0x1014, 0x1015, *this);
}

void EmcyProducer::read() {
  const std::uint32_t otherwise =
      node_.options.predefined_emergency ? cob_id::emcy + node_.node_id : CobId::invalid_bit;
  cob_id_ = usable(CobId{node_.dictionary.get<std::uint32_t>(0x1014, 0, otherwise)});
  inhibit_time_ = in_steps(node_.dictionary.get<std::uint16_t>(0x1015, 0), std::chrono::microseconds(100),
                           node_.options.inhibit_time_resolution);
}

void EmcyProducer::start() {
  stop();
  read();
}

void EmcyProducer::stop() {
  cob_id_ = {};
  inhibited_until_ = {};
  waiting_count_ = 0;
  active_errors_ = 0;
  node_.timers.stop(timer_);
}

std::uint32_t EmcyProducer::history_field(std::uint16_t code, std::uint8_t first,
                                          std::uint8_t second) const noexcept {
  const bool first_high = node_.options.history_has_first_byte_high;
  return code | std::uint32_t{first} << (first_high ? 24 : 16) |
         std::uint32_t{second} << (first_high ? 16 : 24);
}

void EmcyProducer::remember(std::uint16_t code, std::uint8_t first, std::uint8_t second) {
  ObjectDictionary& d = node_.dictionary;
  const ObjectDescription* history = d.description().find(0x1003);
  if (history == nullptr || history->highest_sub == 0) return;
  const auto capacity = std::min<std::uint8_t>(history->highest_sub, 0xFE);
  const auto count = std::min(d.get<std::uint8_t>(0x1003, 0), capacity);
  const auto new_count = static_cast<std::uint8_t>(count < capacity ? count + 1 : capacity);
  for (std::uint8_t sub = new_count; sub > 1; --sub) {
    d.set(0x1003, sub, d.get<std::uint32_t>(0x1003, static_cast<std::uint8_t>(sub - 1)));
  }
  d.set(0x1003, 1, history_field(code, first, second));
  d.set(0x1003, 0, new_count);
}

void EmcyProducer::send(const Message& message, can::Time now) {
  if (cob_id_.is_valid()) {
    can::Frame frame{.identifier = cob_id_.identifier(), .extended = cob_id_.is_extended()};
    frame.dlc = 8;
    frame.data = message;
    node_.sink.send(frame);
    if (inhibit_time_ != can::Duration{}) inhibited_until_ = can::later(now, inhibit_time_);
  }
}

bool EmcyProducer::raise(std::uint16_t code, std::uint8_t error_register,
                         std::span<const std::uint8_t, 5> manufacturer, can::Time now) {
  if (!node_.communicates() || inhibited(now)) return false;
  if (code >= 0x0100) error_register |= generic_error;
  error_register |= node_.dictionary.get<std::uint8_t>(0x1001, 0);
  node_.dictionary.set(0x1001, 0, error_register);
  if (code != 0) remember(code, manufacturer[0], manufacturer[1]);
  Message message{static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8), error_register};
  std::ranges::copy(manufacturer, message.begin() + 3);
  send(message, now);
  if (node_.listener != nullptr) {
    Emergency emergency{node_.node_id, code, error_register, {}};
    std::ranges::copy(manufacturer, emergency.manufacturer.begin());
    node_.listener->emergency_raised(emergency, now);
  }
  return true;
}

bool EmcyProducer::reset(can::Time now) {
  if (!node_.communicates() || inhibited(now)) return false;
  node_.dictionary.set(0x1001, 0, std::uint8_t{0});
  active_errors_ = 0;
  send({}, now);
  if (node_.listener != nullptr) node_.listener->emergency_raised({node_.node_id, 0, 0, {}}, now);
  return true;
}

void EmcyProducer::forget(std::uint16_t code, std::span<const std::uint8_t, 5> manufacturer, can::Time now) {
  ObjectDictionary& d = node_.dictionary;
  const std::uint32_t entry = history_field(code, manufacturer[0], manufacturer[1]);
  const auto count = d.get<std::uint8_t>(0x1003, 0);
  std::uint8_t kept = 0;
  for (std::uint8_t sub = 1; sub <= count; ++sub) {
    const auto value = d.get<std::uint32_t>(0x1003, sub);
    if (value != entry) d.set(0x1003, ++kept, value);
  }
  if (kept == count) return;
  d.set(0x1003, 0, kept);
  if (kept == 0) history_emptied(now);
}

void EmcyProducer::history_emptied(can::Time now) {
  node_.dictionary.set(0x1001, 0, std::uint8_t{0});
  active_errors_ = 0;
  send_or_wait({}, now);
}

void EmcyProducer::send_or_wait(const CommunicationError& error, can::Time now) {
  const auto error_register = node_.dictionary.get<std::uint8_t>(0x1001, 0);
  Message message{static_cast<std::uint8_t>(error.code), static_cast<std::uint8_t>(error.code >> 8),
                  error_register};
  std::ranges::copy(error.manufacturer, message.begin() + 3);
  if (node_.communicates()) {
    if (!inhibited(now) && waiting_count_ == 0) {
      send(message, now);
    } else if (waiting_count_ < waiting_.size()) {
      waiting_[waiting_count_++] = message;
      node_.timers.set(timer_, inhibited_until_);
    }
  }
  if (node_.listener != nullptr)
    node_.listener->emergency_raised({node_.node_id, error.code, error_register, error.manufacturer}, now);
}

void EmcyProducer::error_began(const CommunicationError& error, can::Time now) {
  ++active_errors_;
  const auto old_register = node_.dictionary.get<std::uint8_t>(0x1001, 0);
  node_.dictionary.set(0x1001, 0,
                       static_cast<std::uint8_t>(old_register | generic_error | communication_error));
  remember(error.code, error.manufacturer[0], error.manufacturer[1]);
  send_or_wait(error, now);
}

void EmcyProducer::error_ended(const CommunicationError&, can::Time now) {
  if (active_errors_ == 0 || --active_errors_ != 0 || node_.options.errors_end_with_history) return;
  auto error_register =
      static_cast<std::uint8_t>(node_.dictionary.get<std::uint8_t>(0x1001, 0) & ~communication_error);
  if (error_register == generic_error) error_register = 0;
  node_.dictionary.set(0x1001, 0, error_register);
  send_or_wait({}, now);
}

void EmcyProducer::tick(can::Time now) {
  if (waiting_count_ == 0) return;
  const Message message = waiting_.front();
  std::shift_left(waiting_.begin(), waiting_.begin() + waiting_count_, 1);
  --waiting_count_;
  if (node_.communicates()) send(message, now);
  if (waiting_count_ != 0) node_.timers.set(timer_, std::max(inhibited_until_, now));
}

AbortCode EmcyProducer::before_read(ObjectDictionary& dictionary, const Entry& entry, can::Time) {
  if (entry.index != 0x1003 || entry.sub <= dictionary.get<std::uint8_t>(0x1003, 0)) return AbortCode::none;
  if (entry.sub == 0) return AbortCode::none;
  if (!node_.options.empty_history_reads_zero) return AbortCode::no_data;
  dictionary.set(entry, std::uint32_t{0});
  return AbortCode::none;
}

AbortCode EmcyProducer::before_write(ObjectDictionary& dictionary, const Entry& entry,
                                     std::span<const std::uint8_t> value, can::Time) {
  if (entry.index == 0x1003) {
    if (entry.sub != 0) return AbortCode::write_of_read_only;
    return value.size() == 1 && value[0] == 0 ? AbortCode::none : AbortCode::invalid_value;
  }
  if (entry.index == 0x1014) {
    return check_change(CobId{dictionary.get<std::uint32_t>(entry)}, CobId::from(value),
                        node_.options.extended_identifiers);
  }
  return AbortCode::none;
}

void EmcyProducer::after_write(ObjectDictionary& dictionary, const Entry& entry, can::Time now) {
  if (entry.index != 0x1003) {
    if (node_.state != NmtState::initialising) read();
    return;
  }
  if (node_.options.errors_end_with_history) return history_emptied(now);
  if (node_.options.history_clears_error_register) dictionary.set(0x1001, 0, std::uint8_t{0});
}

}  // namespace canopus::canopen
