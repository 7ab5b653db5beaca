#pragma once
// A frame that went well on a healthy wire, told as a whole when it is complete: what a WireObserver needs to know of
// it besides its bits. And of a frame that went bit by bit who sent with its SOF, which its bits do not say.

#include <cstddef>
#include <cstdint>
#include <span>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"

namespace canopus::sim {

class BusPort;

struct WireFrame {
  /// Whoever began to send with the SOF.
  struct Sender {
    static constexpr unsigned won = ~0U;
    std::size_t port;  ///< as in Bus::ports()
    unsigned
        lost_at;  ///< the first bit, from SOF = 0 and without stuff bits, where it was recessive and the frame not
    std::uint32_t arbitration;  ///< can::arbitration() of its frame
  };

  const can::Frame& frame;
  const BusPort& transmitter;
  std::span<BusPort* const>
      members;               ///< all that are on the wire, with the counters they had before the frame
  std::uint64_t membership;  ///< another number when the members are others, or others of them acknowledge
  std::span<const Sender> senders;  ///< of the members, in the same order, the transmitter too
  can::Time start;                  ///< of SOF
  can::Duration bit;
  can::Duration sample_point;  ///< from a bit's start
  bool counting;               ///< some member has an error counter that is not 0
};

/// Of a frame that went bit by bit and is complete.
struct WireArbitration {
  const can::Frame& frame;
  can::Time start;  ///< of SOF, as BusObserver::frame_completed() has it
  /// Whoever sent the frame, and whoever lost to it: by ports, `lost_at` as it was on the wire.
  std::span<const WireFrame::Sender> senders;
};

}  // namespace canopus::sim
