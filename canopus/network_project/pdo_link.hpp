#pragma once
// Signals that go from one node to another: found in the PDOs of a project, and PDOs made for new ones.

#include <cstdint>
#include <expected>
#include <string>
#include <vector>

#include "canopus/network_project/network_project.hpp"

namespace canopus::network_project {

/// A sub-index of a node.
struct SignalEnd {
  std::uint8_t node_id = 0;
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  friend bool operator==(const SignalEnd&, const SignalEnd&) = default;
};

/// A signal that one node sends and another one takes.
struct SignalLink {
  SignalEnd from;
  SignalEnd to;
  unsigned tpdo = 0;  ///< of the sender, from 1
  unsigned rpdo = 0;
  canopen::CobId cob_id{};
  unsigned first_bit = 0;
  unsigned bits = 0;
};

/// All signals between nodes that are present. Bits that differ between the two sides are none: network_review.hpp reports them.
[[nodiscard]] std::vector<SignalLink> find_links(const NetworkProject& project);

/// A PDO that was changed for a link.
struct PdoChange {
  std::uint8_t node_id = 0;
  Pdo before{};
  Pdo after{};
};

/// Connects `from` to `to`. The signal's own TPDO is used if there is one, else one that goes to that node
/// already, one that is not in use, one with room; the RPDO has unused bits before the signal as needed.
/// Changes nothing, with the reason as error, when the two do not have the same length, are not mappable, or
/// have no PDO left. Already connected: no changes.
[[nodiscard]] std::expected<std::vector<PdoChange>, std::string> link_signals(NetworkProject& project,
                                                                              const SignalEnd& from,
                                                                              const SignalEnd& to);

/// A CAN-ID of 11 bits for a PDO of this node, lower ones and those that hold its node-ID first, that nothing in the project
/// uses; 0: none.
[[nodiscard]] std::uint32_t free_can_id(const NetworkProject& project, std::uint8_t node_id);

}  // namespace canopus::network_project
