#pragma once
// What faults do to the level of a wire, and to what single ports see of it: corruptions of the frame, noise, the bit driver,
// a termination, stuck outputs.

#include "canopus/can/time.hpp"
#include "canopus/sim/bus/faults/bit_driver.hpp"
#include "canopus/sim/bus/faults/termination.hpp"
#include "canopus/sim/bus/wire/wire.hpp"

namespace canopus::sim {

/// What the bit driver does to a wire.
struct DrivenWire {
  bool is_busy = false;  ///< the wire is its own, whether it drives a level or not
  DrivenLevel level = DrivenLevel::released;
  friend bool operator==(const DrivenWire&, const DrivenWire&) = default;
};

class WireLevels {
 public:
  explicit WireLevels(const WireState& wire) noexcept : wire_(wire) {}

  // From now on; only between Wire::before_change() and Wire::after_change():
  void drive(const DrivenWire& driven) noexcept { driven_ = driven; }
  [[nodiscard]] const DrivenWire& driven() const noexcept { return driven_; }
  /// Noise: what there is on the wire is inverted, or again as it is.
  void invert() noexcept { is_inverted_ = !is_inverted_; }
  void set_termination(const Termination& termination) noexcept { termination_ = termination; }

  /// The members, or their faults, are others.
  void update_members() noexcept;
  /// A frame begins, with WireState::faults, whose corruptions count bits of this length from its SOF.
  void begin_frame(can::Time now, can::Duration bit) noexcept;

  /// No whole frames: something else than the ports' outputs makes the level.
  [[nodiscard]] bool are_disturbed() const noexcept {
    return has_stuck_dominant_ || driven_.is_busy || is_inverted_ || is_terminated_wrongly();
  }
  /// Some port on the wire is stuck dominant.
  [[nodiscard]] bool has_stuck_dominant() const noexcept { return has_stuck_dominant_; }
  /// Some port may see another level than the wire's.
  [[nodiscard]] bool differ() const noexcept { return differ_; }

  /// The wire's level from now on, while outputs of ports drive it dominant, or none does.
  [[nodiscard]] bool level(bool is_driven, can::Time now) noexcept;
  /// What the port sees of the wire's level, where levels are everywhere at once.
  [[nodiscard]] bool seen_at(const BusPort& port, bool dominant, can::Time now) const noexcept {
    return dominant != is_inverted(&port, now);
  }
  /// What the port sees, on a line with length, of outputs that are dominant at its place, or of none.
  [[nodiscard]] bool seen_on_line(const BusPort& port, bool is_driven, can::Time now) const noexcept;
  /// A fault inverts what there is on the wire (null), or what one port sees of it.
  [[nodiscard]] bool is_inverted(const BusPort* at, can::Time now) const noexcept;
  /// The corruption, of WireState::faults, inverts the present bit.
  [[nodiscard]] bool is_at_work(const FrameFaults::Corruption& corruption, can::Time now) const noexcept {
    const can::Time begin = frame_start_ + bit_ * corruption.bit;
    return now >= begin && now < begin + bit_;
  }
  /// Some corruption does.
  [[nodiscard]] bool is_corrupted(can::Time now) const noexcept;
  /// By its termination the wire stays dominant for a time that has an end.
  [[nodiscard]] bool is_held() const noexcept { return released_ != can::never; }

  /// Until when nothing but the ports' outputs makes the level from here on, and all see the same; the moment itself: a fault is
  /// at work. Only while not are_disturbed().
  [[nodiscard]] can::Time undisturbed_until(can::Time from) const noexcept;
  /// When the faults change the level next by themselves; never: they do not.
  [[nodiscard]] can::Time next_change(can::Time now) const noexcept;

 private:
  [[nodiscard]] bool is_terminated_wrongly() const noexcept { return termination_ != Termination{}; }
  void update_differ() noexcept;
  [[nodiscard]] bool terminated(bool is_driven, can::Time now) noexcept;

  const WireState& wire_;
  bool has_stuck_dominant_ = false;
  bool differ_ = false;
  DrivenWire driven_;
  bool is_inverted_ = false;  // by noise
  Termination termination_;
  bool was_driven_ = false;          // dominant, as the termination saw it last
  can::Time released_ = can::never;  // the wire is recessive from here on
  can::Time frame_start_{};          // of the corruptions
  can::Duration bit_{};              // likewise
};

}  // namespace canopus::sim
