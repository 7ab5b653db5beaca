#pragma once
// One electrically connected piece of wire and its two ways of working: whole frames (WholeFrames) while nothing is wrong, and
// bit by bit (BitwiseWire) as soon as anything could go another way, until the wire is idle and healthy again. Only the sources
// of the bus include this.

#include "canopus/sim/bus/bitwise/bitwise_wire.hpp"
#include "canopus/sim/bus/whole_frames.hpp"
#include "canopus/sim/bus/wire/wire.hpp"

namespace canopus::sim {

class Segment final : public Wire {
 public:
  /// `near`: the wire, or the near side of a cut.
  Segment(BusCore& bus_core, bool near) : Wire(bus_core, near), frames_(*this), bits_(*this) {}

  /// A port was added to the bus, whether to this segment or not.
  void resize();
  /// Updates the members, and whether frames can be computed as a whole.
  void update_members();
  void before_change() override;
  void after_change() override;
  void tick(can::Time now) {
    if (now < deadline) return;
    switch (mode) {
      case Mode::idle: return start(now);
      case Mode::frame: return frames_.finish(now);
      case Mode::lone_frame: return frames_.fail_lone(now);
      case Mode::bits: return tick_bits(now);
    }
  }

  /// A frame is on the wire, or something of one.
  [[nodiscard]] bool is_busy() const noexcept;
  /// Since when the wire is busy with what the statistics have not counted yet; can::never: there is nothing.
  [[nodiscard]] can::Time busy_since() const noexcept;
  [[nodiscard]] can::FaultConfinement counters_of(const BusPort& port) const noexcept override {
    return frames_.counters_of(port);
  }
  /// See Bus::report_wire().
  void report_wire();

  // Faults, from now on:
  void drive(const DrivenWire& driven);
  /// Noise: what there is on the wire is inverted, or again as it is.
  void invert();
  void set_termination(const Termination& termination);
  /// Nothing more is to happen to the frame on the wire.
  void cancel_faults();
  /// The port comes from that segment and keeps what its controller is doing.
  void move_in(BusPort& port, Segment& from);

 private:
  void start(can::Time now) {
    if (!frames_.start(now)) start_bits(now);
  }
  void start_bits(can::Time now);
  void tick_bits(can::Time now);
  void enter_bits();
  [[nodiscard]] bool leave_bits(can::Time now);
  [[nodiscard]] bool shows_bits() const noexcept;
  [[nodiscard]] bool may_begin_bitwise(const BusPort& port, can::Time now) const noexcept override {
    return bits_.may_begin(port, now);
  }

  WholeFrames frames_;
  BitwiseWire bits_;
};

}  // namespace canopus::sim
