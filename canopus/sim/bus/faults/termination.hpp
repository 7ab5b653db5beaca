#pragma once
// What other than two resistors at the ends do to a line. A model, and a simple one:
//
//   - The line and its nodes are one capacitor: 50 pF a metre and 100 pF a node. Reflections are not there.
//   - It discharges through the resistors (120 ohms each) and the nodes' inputs (30 kilohms each).
//   - A node that drives dominant is 3.67 V behind 50 ohms: 2 V at two resistors.
//   - Dominant is seen from 0.9 V on [ISO 11898-2]; a line that was dominant counts as recessive below 0.5 V.
//
// With two resistors the bus is as everywhere else in this room: what they cost is not counted again.

#include <cstddef>

#include "canopus/can/time.hpp"

namespace canopus::sim {

inline constexpr unsigned max_resistors = 20;
inline constexpr double max_line_length = 10'000;  ///< m

struct Termination {
  can::Duration release{};  ///< the line stays dominant so much longer than it is driven
  bool is_weak = false;     ///< no node sees a dominant bit

  friend bool operator==(const Termination&, const Termination&) = default;
};

/// `resistors`: 0 to max_resistors. `length`: m, 0 to max_line_length.
[[nodiscard]] Termination termination(unsigned resistors, double length, std::size_t nodes) noexcept;

}  // namespace canopus::sim
