#include "canopus/module/engine/emergency_queue.hpp"

#include <algorithm>

namespace canopus::module {

namespace {

// The inhibit time of EMCY counts in milliseconds [ME3CAN1-Q 4.6.12].
constexpr can::Duration retry_after = std::chrono::milliseconds(1);

}  // namespace

EmergencyQueue::EmergencyQueue(canopen::Node& node) : node_(&node) { messages_.reserve(most_messages); }

void EmergencyQueue::raise(const EmergencyRow& row, std::uint8_t node_id) {
  if (row.code != 0 && messages_.size() < most_messages) messages_.push_back({&row, node_id});
}

void EmergencyQueue::send_waiting(can::Time now) {
  const canopen::NmtState state = node_->state();
  if (state != canopen::NmtState::pre_operational && state != canopen::NmtState::operational) {
    messages_.clear();
  }
  const auto held_back = std::ranges::find_if_not(messages_, [&](const Message& message) {
    return node_->emergency(static_cast<std::uint16_t>(message.row->code + message.node_id),
                            message.row->error_register, message.row->manufacturer, now);
  });
  messages_.erase(messages_.begin(), held_back);
  due_ = messages_.empty() ? can::never : can::later(now, retry_after);
}

void EmergencyQueue::clear() noexcept {
  messages_.clear();
  due_ = can::never;
}

}  // namespace canopus::module
