#pragma once
// The latest emergency messages of each node, as the master keeps them [AS-FCOPM 10.4.3].

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "canopus/canopen/service/node_listener.hpp"

namespace canopus::module::as_fcopm {

class EmergencyLog {
 public:
  static constexpr std::size_t most_stored = 5;
  using Bytes = std::array<std::uint8_t, 8>;
  struct Messages {
    std::uint8_t total = 0;                   ///< since the start; stays at 255
    std::uint8_t stored = 0;                  ///< 0..5
    std::array<Bytes, most_stored> latest{};  ///< the latest first
  };

  void clear() noexcept { nodes_.fill({}); }
  void record(const canopen::Emergency& message) noexcept {
    Messages& of_node = nodes_[message.node_id & 0x7FU];
    std::ranges::rotate(of_node.latest, of_node.latest.end() - 1);
    Bytes& bytes = of_node.latest.front();
    bytes = {static_cast<std::uint8_t>(message.code), static_cast<std::uint8_t>(message.code >> 8),
             message.error_register};
    std::ranges::copy(message.manufacturer, bytes.begin() + 3);
    if (of_node.total != 255) ++of_node.total;
    of_node.stored = std::min<std::uint8_t>(of_node.total, most_stored);
  }
  /// All of them, the latest of node 1 last.
  [[nodiscard]] std::vector<canopen::Emergency> all() const {
    std::vector<canopen::Emergency> messages;
    for (std::uint8_t node_id = 127; node_id != 0; --node_id) {
      const Messages& of_node = nodes_[node_id];
      for (std::size_t i = of_node.stored; i-- != 0;) {
        const Bytes& bytes = of_node.latest[i];
        canopen::Emergency message{.node_id = node_id,
                                   .code = static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8),
                                   .error_register = bytes[2]};
        std::copy(bytes.begin() + 3, bytes.end(), message.manufacturer.begin());
        messages.push_back(message);
      }
    }
    return messages;
  }
  /// Of node 1..127.
  [[nodiscard]] const Messages& of(std::uint8_t node_id) const noexcept { return nodes_[node_id & 0x7FU]; }

 private:
  std::array<Messages, 128> nodes_{};
};

}  // namespace canopus::module::as_fcopm
