#pragma once
// One electrically connected piece of wire and the controllers on it: all of a bus, or one side of a cut. Only the sources
// of the bus include this.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "canopus/can/fault_confinement.hpp"
#include "canopus/sim/bus/faults/fault_plan.hpp"
#include "canopus/sim/bus/wire/arbiter.hpp"
#include "canopus/sim/bus/wire/bus_core.hpp"
#include "canopus/sim/bus/wire/bus_port.hpp"

namespace canopus::sim {

/// What of a bit follows its sample point: CiA recommends the sample point at 87.5 % of the bit.
[[nodiscard]] constexpr can::Duration after_sample_point(can::Duration bit) noexcept { return bit / 8; }

/// What the two ways of working of a wire share: whole frames (WholeFrames) and bit by bit (BitwiseWire).
struct WireState {
  enum class Mode : std::uint8_t {
    idle,        ///< whole frames, nothing on the wire; `deadline` is the next start, or never
    frame,       ///< a whole frame; `deadline` is the end of its EOF
    lone_frame,  ///< a whole frame without acknowledgement; `deadline` is the sample point of its ACK slot
    bits,        ///< bit by bit; `deadline` is the next sample point or start of a bit
  };
  /// Of an error passive port that was the last to send: it is not offered to the arbiter before `until`.
  struct Suspension {
    BusPort* port = nullptr;  ///< null: none
    can::Time until{};
  };

  /// `near`: the wire, or the near side of a cut.
  WireState(BusCore& bus_core, bool near) : core(bus_core), is_near(near) {}
  WireState(const WireState&) = delete;
  WireState& operator=(const WireState&) = delete;

  [[nodiscard]] inline bool has(const BusPort& port) const noexcept;
  /// By a fault of the frame on the wire the port's controller loses it.
  [[nodiscard]] bool drops_at(const BusPort& port) const noexcept {
    return faults.drop_everywhere || faults.drop_at == &port;
  }
  /// Cancels what is to happen to the frame on the wire.
  void clear_faults() noexcept {
    faults = {};
    faults_ready = false;
  }
  /// What was on this wire counts for the bus, and for its side of a cut.
  void count_frame(const can::Frame& frame) noexcept {
    core.statistics.frame(frame);
    if (!is_near) [[unlikely]]
      core.far_statistics.frame(frame);
  }
  void count_error_frame() noexcept {
    core.statistics.error_frame();
    if (!is_near) core.far_statistics.error_frame();
  }
  void count_busy(can::Time start, can::Time end, std::uint64_t bits) noexcept {
    core.statistics.busy(start, end, bits);
    if (!is_near) [[unlikely]]
      core.far_statistics.busy(start, end, bits);
  }
  /// Notifies the participants whose controllers have changed.
  void notify_controller_changes(can::Time now);

  BusCore& core;
  const bool is_near;      // levels of the far side are reported by a function of their own
  Mode mode = Mode::idle;  // which way works: an offer of a port means another thing in each
  // Some participant has to be notified of its controller at the end of the step.
  bool controllers_changed = false;
  // `faults` were found before the frame begins, which goes bit by bit because of them.
  bool faults_ready = false;
  // Set by the way that works, and moved by an offer.
  can::Time deadline = can::never;
  // Whole frames: end of the last intermission, before which no offer starts a frame.
  can::Time free_from{};
  // Of the frame on the wire, a whole one or one with deferred contenders: ports keep with it what they offered when the frame
  // began.
  std::uint64_t frame_number = 0;
  // Bit by bit: the sender of the frame on the wire, if the ports that lose arbitration to it, as its bits and theirs say, were
  // not made to begin: they receive from the start. Null: all that began were.
  BusPort* uncontended = nullptr;
  // Whole frames: an offer of this port starts no frame yet.
  Suspension suspension;
  // Of the ports' offers. The port of a whole frame on the wire may still be in it.
  Arbiter arbiter;
  // The ports that can do anything to the wire, or receive from it.
  std::vector<BusPort*> members;
  // Of the frame on the wire: lost receptions concern both ways.
  FrameFaults faults;
};

/// What is on the wire when it goes from whole frames to single bits.
struct WireHandover {
  enum class Kind : std::uint8_t {
    idle,
    frame,
    failed_lone_frame,  ///< the error frame of a port without a receiver, which has been counted already
    intermission,       ///< behind a frame that is complete, or the transmitter's suspension after that
  };
  Kind kind = Kind::idle;
  BusPort* transmitter = nullptr;
  can::Time start{};             ///< of the frame's SOF; intermission: of its first bit
  BusPort* suspended = nullptr;  ///< a port that was suspended when the frame began ...
  unsigned suspended_bits = 0;   ///< ... and had sampled so many bits of its suspension
  can::Time counted_until{};     ///< intermission: the statistics have the wire as busy up to here
};

/// A wire as its ports use it.
class Wire : public WireState {
 public:
  using WireState::WireState;

  /// What the port offers is going to change, without before_change(): a frame on the wire whose contenders come to be
  /// simulated needs what it was.
  void snapshot_pending(BusPort& port) noexcept {
    if ((mode == Mode::frame || uncontended != nullptr) && port.pending.frame_number != frame_number)
      port.snapshot_pending(frame_number);
  }
  /// It has changed.
  [[gnu::always_inline]] void offer_changed(BusPort& port) {
    if (&port == suspension.port) [[unlikely]]
      return suspended_offer_changed();
    arbiter.set(port.index, port.offer());
    if (mode == Mode::frame) return;
    if (mode == Mode::bits) [[unlikely]]
      return update_start_bitwise(port);
    update_start();
  }
  /// Something about a port or the wire is going to change now that needs single bits: the wire works bit by bit from here.
  virtual void before_change() = 0;
  /// It has changed.
  virtual void after_change() = 0;
  /// The port's error counters now. Within a whole frame they are those of its bits.
  [[nodiscard]] virtual can::FaultConfinement counters_of(const BusPort& port) const noexcept = 0;

 protected:
  ~Wire() = default;
  /// Bit by bit: the port may begin its frame now.
  [[nodiscard]] virtual bool may_begin_bitwise(const BusPort& port, can::Time now) const noexcept = 0;

 private:
  void suspended_offer_changed();
  void update_start();
  void update_start_bitwise(const BusPort& port);
};

inline bool WireState::has(const BusPort& port) const noexcept {
  return &static_cast<const WireState&>(*port.wire) == this;
}

}  // namespace canopus::sim
