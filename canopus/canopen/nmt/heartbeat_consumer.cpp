#include "canopus/canopen/nmt/heartbeat_consumer.hpp"

#include <algorithm>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/service/emcy_code.hpp"
#include "canopus/canopen/service/node_listener.hpp"

namespace canopus::canopen {
namespace {

struct ConsumerEntry {
  std::uint8_t node_id;
  std::uint16_t milliseconds;
  [[nodiscard]] bool is_used() const { return node_id >= 1 && node_id <= 127 && milliseconds != 0; }
};

ConsumerEntry decode(std::uint32_t value) {
  return {static_cast<std::uint8_t>(value >> 16), static_cast<std::uint16_t>(value)};
}

}  // namespace

HeartbeatConsumer::HeartbeatConsumer(NodeContext& node) : node_(node) {
  if (const ObjectDescription* object = node.dictionary.description().find(0x1016)) {
    watches_.resize(std::min<std::size_t>(object->highest_sub, 0xFE));
  }
  first_timer_ = node.timers.add(watches_.size());
  node.dictionary.attach(0x1016, 0x1016, *this);
}

void HeartbeatConsumer::start() {
  for (std::size_t i = 0; i < watches_.size(); ++i) read(i);
}

void HeartbeatConsumer::stop() {
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    watches_[i] = {};
    node_.timers.stop(static_cast<TimerQueue::Number>(first_timer_ + i));
  }
  node_.change_identifiers();
}

void HeartbeatConsumer::read(std::size_t number) {
  const auto sub = static_cast<std::uint8_t>(number + 1);
  const ConsumerEntry entry = decode(node_.dictionary.get<std::uint32_t>(0x1016, sub));
  watches_[number] = entry.is_used() ? Watch{entry.node_id, State::waiting, entry.milliseconds} : Watch{};
  node_.timers.stop(static_cast<TimerQueue::Number>(first_timer_ + number));
  node_.change_identifiers();
}

void HeartbeatConsumer::receive(std::uint16_t number, const can::Frame& frame, can::Time now) {
  Watch& watch = watches_[number];
  if (frame.dlc != 1 || (frame.data[0] & 0x80) != 0) return;  // bit 7 set: an answer to node guarding
  const auto state = static_cast<NmtState>(frame.data[0]);
  const bool was_lost = watch.state == State::lost;
  const auto timer = static_cast<TimerQueue::Number>(first_timer_ + number);
  if (state == NmtState::initialising) {
    watch.state = State::waiting;
    node_.timers.stop(timer);
  } else {
    watch.state = State::alive;
    node_.timers.set(timer, now + std::chrono::milliseconds(watch.milliseconds));
  }
  const std::uint8_t node_id = watch.node_id;
  if (was_lost) node_.error_ended({emcy_code::life_guard_or_heartbeat, {node_id}}, now);
  if (node_.listener != nullptr) node_.listener->heartbeat_received(node_id, state, now);
}

void HeartbeatConsumer::tick(std::uint16_t number, can::Time now) {
  Watch& watch = watches_[number];
  if (watch.state != State::alive) return;
  watch.state = State::lost;
  const std::uint8_t node_id = watch.node_id;
  const bool named = node_.options.guarding_emergency_names_node;
  const auto code =
      static_cast<std::uint16_t>(named ? emcy_code::node_lost + node_id : emcy_code::life_guard_or_heartbeat);
  node_.error_began({code, {named ? std::uint8_t{0} : node_id}}, now);
  if (node_.listener != nullptr) node_.listener->heartbeat_lost(node_id, now);
  if (!node_.active_master) node_.communication_error(now);
}

void HeartbeatConsumer::list_identifiers(std::vector<IdentifierTable::Route>& routes) const {
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    if (watches_[i].state == State::unused) continue;
    routes.push_back(
        {cob_id::error_control + watches_[i].node_id, ServiceKind::heartbeat, static_cast<std::uint16_t>(i)});
  }
}

AbortCode HeartbeatConsumer::before_write(ObjectDictionary& dictionary, const Entry& entry,
                                          std::span<const std::uint8_t> value, can::Time) {
  if (entry.sub == 0 || value.size() != 4) return AbortCode::write_of_read_only;
  if (value[3] != 0) return AbortCode::invalid_value;
  const ConsumerEntry wanted{value[2], can::load_as<std::uint16_t>(&value[0])};
  if (!wanted.is_used()) return AbortCode::none;
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    const auto sub = static_cast<std::uint8_t>(i + 1);
    if (sub == entry.sub) continue;
    const ConsumerEntry other = decode(dictionary.get<std::uint32_t>(0x1016, sub));
    if (other.is_used() && other.node_id == wanted.node_id) return AbortCode::parameter_incompatible;
  }
  return AbortCode::none;
}

void HeartbeatConsumer::after_write(ObjectDictionary&, const Entry& entry, can::Time now) {
  const std::size_t number = entry.sub - 1U;
  const Watch before = watches_[number];
  read(number);
  if (before.state == State::lost)
    node_.error_ended({emcy_code::life_guard_or_heartbeat, {before.node_id}}, now);
}

}  // namespace canopus::canopen
