#pragma once
// The SDO requests of the start-up are sent in the order in which they were made. A controller sends by priority; left
// to it, requests with low node-IDs would go first as long as there are any, and the transfers with high ones would
// time out in the middle, here or in the slave.
//
// Needs a report of what was transmitted; until it is for the first time, requests go straight through.

#include <array>
#include <cstddef>
#include <cstdint>

#include "canopus/can/controller.hpp"

namespace canopus::manager {

class SdoRequestQueue {
 public:
  /// Sends the request now, or when it is its turn. False when there is no room for it, or others wait and
  /// this node has its share of the queue: the segments of one block would fill it, and the transfers with
  /// the other nodes would pause for so long that their servers take segments for lost.
  bool send(const can::Frame& request, can::Sink& sink, can::Time now);
  /// The controller has sent a request with this identifier.
  void transmitted(std::uint32_t identifier, can::Sink& sink, can::Time now);
  /// A request with this identifier is in the queue or with the controller, and the queue moves.
  [[nodiscard]] bool waits(std::uint32_t identifier, can::Time now) const noexcept;
  /// Everything is given up.
  void clear() noexcept {
    first_ = count_ = 0;
    with_controller_ = none;
    waiting_of_ = {};
  }

 private:
  bool submit(const can::Frame& request, can::Sink& sink, can::Time now);
  void release(can::Sink& sink, can::Time now);

  [[nodiscard]] static std::size_t node(std::uint32_t identifier) noexcept { return identifier & 0x7F; }

  static constexpr std::uint32_t none = 0xFFFF'FFFF;
  /// Two for each node, and an abort, and a whole block of one: what a client sends but once, a request or
  /// the end of a block, always finds room.
  static constexpr std::size_t capacity = 512;
  static constexpr std::uint16_t share = 2;
  /// The controller has sent nothing for so long: what it had is lost.
  static constexpr can::Duration stall = std::chrono::milliseconds(100);

  std::array<can::Frame, capacity> waiting_{};
  std::array<std::uint16_t, 128> waiting_of_{};  // by node-ID
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  /// The one request that the controller has. Of two it would send the one with the lower node-ID, and the
  /// next, and the other one would wait for as long as lower ones come.
  std::uint32_t with_controller_ = none;
  bool has_reports_ = false;
  can::Time last_{};
};

}  // namespace canopus::manager
