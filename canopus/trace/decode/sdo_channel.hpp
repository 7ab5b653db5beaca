#pragma once
// The transfers of one SDO channel. CiA 301 has one client for each channel, but tools and masters share the default one:
// a second request comes before the answer to the first. An answer names its object, so each request finds its own.

#include <cstdint>
#include <span>
#include <vector>

#include "canopus/trace/decode/sdo_follower.hpp"

namespace canopus::trace {

/// A transfer that ended without a frame of its own, and the last frame that it had.
struct EndedSdoTransfer {
  SdoTransfer transfer{};
  can::Frame frame{};
};

class SdoChannel {
 public:
  /// Requests that are kept while they have no answer; the oldest one ends unanswered beyond that.
  static constexpr std::size_t most_requests = 16;

  /// The next frame, of 8 bytes; as SdoFollower::follow().
  [[nodiscard]] SdoFollower::Step follow(const can::Frame& frame, bool from_client, can::Time now);
  /// An answer of fewer than 8 bytes, which is none.
  void note_short_answer(std::span<const std::uint8_t> bytes);
  /// Ends the transfers in which nothing has happened for that time.
  [[nodiscard]] std::vector<EndedSdoTransfer> expire(can::Time now, can::Duration time_out);
  /// Ends all of them.
  [[nodiscard]] std::vector<EndedSdoTransfer> give_up();

 private:
  using Place = std::vector<SdoFollower>::iterator;
  [[nodiscard]] Place follower_of(const can::Frame& frame, bool from_client);
  /// The newest request of this object that waits for its answer; the end of the list if there is none.
  [[nodiscard]] Place request_of(std::uint16_t index, std::uint8_t sub);
  /// The newest transfer that has had its first answer; the end of the list if there is none.
  [[nodiscard]] Place under_way();

  std::vector<SdoFollower> followers_{};  // of one transfer each, the oldest first
};

}  // namespace canopus::trace
