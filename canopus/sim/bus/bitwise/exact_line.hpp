#pragma once
// A wire bit by bit on a line with length: each controller samples the wire once a quantum of its own clock, and sees what the
// others drive when it has come to its place.
//
// At a moment only the ports act that are due: whose bit begins, whose sample point it is, or who have to monitor the wire as a
// level is on its way. Each is due at a moment of its own.

#include <cstddef>
#include <vector>

#include "canopus/can/winner_tree.hpp"
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
  /// Every port comes to where its clock has it just before `until`.
  void catch_up(can::Time until);
  /// The members are others, or a port begins a frame: all are due at the next run().
  void make_all_due() noexcept { are_all_due_ = true; }
  /// The next moment of run().
  [[nodiscard]] can::Time next() const noexcept { return due_.earliest(); }

 private:
  /// Returns whether a quantum of the port begins now.
  bool begin(std::size_t number, can::Time now);
  void make_others_due(can::Time now);
  void set_due(std::size_t number, can::Time now);
  [[nodiscard]] can::Time next_due(std::size_t number, can::Time now) const noexcept;
  void set_all_due(can::Time now);
  void pass_end(std::size_t number);
  [[nodiscard]] bool may_pass_end(const BusPort& port, can::Time now) const noexcept;
  void begin_bit(BusPort& port, can::Time now);
  void drive(BusPort& port, can::Time now);
  void update_level(can::Time now, bool has_changed);
  [[nodiscard]] bool is_seen_dominant(const BusPort& port, can::Time now) const noexcept;
  void begin_quantum(BusPort& port, can::Time now);

  WireState& wire_;
  WireLevels& levels_;
  BitwiseWire& bits_;
  bool was_inverted_ = false;  // by noise or a corruption
  bool are_all_due_ = true;
  // Of the sampling ports, by their numbers:
  can::WinnerTree due_;
  std::vector<bool> passes_end_;     // due at a sample point: nothing comes of the end of the bit before it
  std::vector<bool> monitors_;       // due at the next quantum
  std::vector<std::size_t> acting_;  // due now
  std::vector<std::size_t> others_;  // of make_others_due(), kept for its memory
  std::vector<std::size_t> in_quantum_;  // a quantum begins now
};

}  // namespace canopus::sim
