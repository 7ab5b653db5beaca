#include "canopus/canopen/messages/time_stamp.hpp"

#include <cstring>

#include "canopus/canopen/service/node_listener.hpp"

namespace canopus::canopen {

TimeStamp::TimeStamp(NodeContext& node) : node_(node) { node.dictionary.attach(0x1012, 0x1012, *this); }

void TimeStamp::start() {
  if (node_.state == NmtState::initialising) return;
  cob_id_ = CobId{node_.dictionary.get<std::uint32_t>(0x1012, 0)};
  if (is_restricted(cob_id_)) cob_id_ = CobId{0};  // neither sent nor received
  node_.change_identifiers();
}

void TimeStamp::stop() {
  cob_id_ = CobId{0};
  node_.change_identifiers();
}

void TimeStamp::receive(const can::Frame& frame, can::Time now) {
  if (!node_.communicates() || frame.length() < 6 || node_.listener == nullptr) return;
  TimeOfDay time;
  std::memcpy(&time.milliseconds, frame.data.data(), 4);
  std::memcpy(&time.days, frame.data.data() + 4, 2);
  time.milliseconds &= 0x0FFF'FFFF;
  node_.listener->time_received(time, now);
}

bool TimeStamp::send(const TimeOfDay& time) {
  if (!cob_id_.has_bit_30() || !node_.may_produce_time()) return false;
  can::Frame frame{.identifier = cob_id_.identifier(), .extended = cob_id_.is_extended()};
  frame.dlc = 6;
  const std::uint32_t milliseconds = time.milliseconds & 0x0FFF'FFFF;
  std::memcpy(frame.data.data(), &milliseconds, 4);
  std::memcpy(frame.data.data() + 4, &time.days, 2);
  return node_.sink.send(frame);
}

void TimeStamp::list_identifiers(std::vector<IdentifierTable::Route>& routes) const {
  if ((cob_id_.raw & CobId::invalid_bit) == 0) return;  // of TIME, bit 31 means: consumes
  routes.push_back(
      {IdentifierTable::key(cob_id_.identifier(), cob_id_.is_extended(), false), ServiceKind::time_stamp, 0});
}

AbortCode TimeStamp::before_write(ObjectDictionary& dictionary, const Entry& entry,
                                  std::span<const std::uint8_t> value, can::Time) {
  const CobId old_value{dictionary.get<std::uint32_t>(entry)};
  const CobId new_value = CobId::from(value);
  constexpr std::uint32_t active = CobId::invalid_bit | CobId::bit_30;
  if ((old_value.raw & new_value.raw & active) != 0 && !is_restricted(old_value) &&
      ((old_value.raw ^ new_value.raw) & 0x3FFF'FFFF) != 0) {
    return AbortCode::invalid_value;
  }
  return check_identifier(new_value, true, node_.options.extended_identifiers);
}

}  // namespace canopus::canopen
