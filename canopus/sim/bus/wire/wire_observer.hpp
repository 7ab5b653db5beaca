#pragma once
// What the simulated bus reports of its wire to observers, e.g. a waveform.
//
// A frame that went well on a healthy wire is reported as a whole when it is complete, unless an observer needs bits: a
// WireFrame has what the observer needs besides the bits of the frame. Of a frame that went bit by bit a WireArbitration
// has the senders, which the bits do not show.

#include <cstddef>
#include <cstdint>
#include <span>

#include "canopus/can/bus.hpp"
#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"

namespace canopus::sim {

class BusPort;

struct WireFrame {
  /// A port that began to send with the SOF.
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
  /// The sender of the frame, and the ports that lost to it: in the order of the ports, `lost_at` as it was on the wire.
  std::span<const WireFrame::Sender> senders;
};

/// Observes the wire itself. While there is one that needs_bits(), the bus works bit by bit.
class WireObserver {
 public:
  /// Needs every change at its time. If no observer does, a frame on a healthy wire is reported as a whole, by
  /// frame_passed(), when it is complete: of its bits and of the intermission behind it nothing else is reported, and
  /// nothing before them is reported later.
  [[nodiscard]] virtual bool needs_bits() const noexcept { return true; }
  virtual void frame_passed(const WireFrame& /*frame*/) {}
  /// A frame that went bit by bit is complete; a sender that did not lose to it, but failed before, is not in it.
  virtual void arbitration_passed(const WireArbitration& /*arbitration*/) {}
  /// The level of the wire; under a cut that of its near side.
  virtual void level_changed(bool dominant, can::Time now) = 0;
  /// The level of the far side of a cut; recessive while there is none.
  virtual void far_level_changed(bool /*dominant*/, can::Time /*now*/) {}
  /// What a controller drives; not reported for a port that is on no wire.
  virtual void transmit_changed(const can::Port& port, bool dominant, can::Time now) = 0;
  /// A controller sends its error or overload flag, or its frame takes part in arbitration.
  virtual void activity_changed(const can::Port& port, bool flagging, bool arbitrating, can::Time now) = 0;
  /// Which field the bit belongs to that begins for a controller; the same field may be reported again.
  virtual void field_changed(const can::Port& /*port*/, can::FrameField /*field*/, can::Time /*now*/) {}
  /// A controller sampled a bit or started anew: its counters may have changed.
  virtual void counters_changed(const can::Port& /*port*/, can::Time /*now*/) {}

 protected:
  ~WireObserver() = default;
};

}  // namespace canopus::sim
