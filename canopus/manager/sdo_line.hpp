#pragma once
// The SDO requests of the start-up wait in line: first made, first sent. A controller sends by priority; left
// to it, low node-IDs would go first for as long as they have something to ask, and the transfers with high
// ones would time out in the middle, here or in the slave.
//
// Needs to be told what was transmitted; until it is for the first time, requests go straight through.

#include <array>
#include <cstddef>

#include "canopus/can/controller.hpp"

namespace canopus::manager {

class SdoLine {
 public:
  /// Sends the request now, or when it is its turn. False when there is no room for it.
  bool send(const can::Frame& request, can::Sink& sink, can::Time now);
  /// The controller has sent a request.
  void transmitted(can::Sink& sink, can::Time now);
  /// A request with this identifier is in line, and the line moves.
  [[nodiscard]] bool waits(std::uint32_t identifier, can::Time now) const noexcept;
  /// Everything is given up.
  void clear() noexcept { first_ = count_ = in_flight_ = 0; }

 private:
  bool hand_over(const can::Frame& request, can::Sink& sink, can::Time now);
  void release(can::Sink& sink, can::Time now);

  /// A request and an abort for each node.
  static constexpr std::size_t places = 256;
  /// Requests with the controller: the next one is there when one is done.
  static constexpr unsigned at_once = 2;
  /// The controller has sent nothing for so long: what it had is lost.
  static constexpr can::Duration stall = std::chrono::milliseconds(100);

  std::array<can::Frame, places> waiting_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::size_t in_flight_ = 0;
  bool is_told_ = false;
  can::Time last_{};
};

}  // namespace canopus::manager
