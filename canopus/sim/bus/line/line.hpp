#pragma once
// The line of a bus: how long it is, where its nodes are and how they take their time.

#include <optional>
#include <string>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/sim/bus/controller/bit_timing.hpp"

namespace canopus::sim {

struct Line {
  /// What one node has of its own.
  struct Node {
    std::string port{};                 ///< its name; the first of a name counts
    std::optional<double> place{};      ///< m, from the beginning of the line
    std::optional<double> stub{};       ///< m, from the line to the node
    std::optional<double> clock_ppm{};  ///< positive: fast; above -1,000,000
  };

  double length = 0;                     ///< m, between the two nodes furthest apart
  double stub = 0;                       ///< m, of every node
  double nanoseconds_per_metre = 5;      ///< 5: copper with polyethylene
  can::Duration transceiver_delay{120};  ///< of a node's driver and another one's receiver together
  /// How far a clock is off. Nodes without a clock of their own have in turn a fast one, two slow ones and a fast one.
  double clock_ppm = 0;
  BitTiming timing{};  ///< of every node, without problem()
  /// A port that is not here is at the beginning and at the end of the line in turn, in the order of the ports: the worst
  /// case as soon as there are two.
  std::vector<Node> nodes{};
};

}  // namespace canopus::sim
