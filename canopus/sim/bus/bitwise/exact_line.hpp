#pragma once
// A wire bit by bit on a line with length: each controller samples the wire once a quantum of its own clock, and sees what the
// others drive when it has come to its place.

#include <vector>

#include "canopus/sim/bus/bitwise/wire_levels.hpp"
#include "canopus/sim/bus/wire/wire.hpp"

namespace canopus::sim {

class BitwiseWire;

/// Only for a bus with BusCore::clocks.
class ExactLine {
 public:
  ExactLine(WireState& wire, WireLevels& levels, BitwiseWire& bits) noexcept
      : wire_(wire), levels_(levels), bits_(bits) {}

  /// Begins the bits that begin now and lets the ports see the wire whose quantum begins now. `has_changed`: something about a
  /// port or the wire did, since the last time.
  void run(can::Time now, bool has_changed);
  /// The next moment of run().
  [[nodiscard]] can::Time next(can::Time now) const noexcept;

 private:
  void begin_bit(BusPort& port, can::Time now);
  void drive(BusPort& port, can::Time now);
  void update_level(can::Time now, bool has_changed);
  [[nodiscard]] bool is_seen_dominant(const BusPort& port, can::Time now) const noexcept;
  void begin_quantum(BusPort& port, can::Time now);

  WireState& wire_;
  WireLevels& levels_;
  BitwiseWire& bits_;
  bool was_inverted_ = false;         // by noise or a corruption
  std::vector<BusPort*> in_quantum_;  // of the sampling ports: a quantum begins now
};

}  // namespace canopus::sim
