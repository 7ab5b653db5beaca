#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "canopus/canopen/node/node.hpp"
#include "canopus/module/engine/module_model.hpp"

namespace canopus::module {

/// Emergency messages of the module's own finding. They are sent after what caused them is dealt with, each when the
/// inhibit time of EMCY (1015H) lets it out, and none before the boot-up message: in a controller that sends by priority
/// it would overtake the message that ends Initialisation.
class EmergencyQueue {
 public:
  explicit EmergencyQueue(canopen::Node& node);

  /// `node_id` is added to the code. Eight can wait; more are lost.
  void raise(const EmergencyRow& row, std::uint8_t node_id = 0);
  /// Sends what can go now. In a state without emergency messages all that wait are dropped.
  void send(can::Time now) {
    if (!messages_.empty()) send_waiting(now);
  }
  void clear() noexcept;
  /// When send() is to be called again.
  [[nodiscard]] can::Alarm& alarm() noexcept { return due_; }

 private:
  struct Message {
    const EmergencyRow* row = nullptr;
    std::uint8_t node_id = 0;
  };
  static constexpr std::size_t most_messages = 8;

  void send_waiting(can::Time now);

  canopen::Node* node_;
  std::vector<Message> messages_;
  can::Alarm due_;
};

}  // namespace canopus::module
