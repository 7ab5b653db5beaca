#pragma once
// Another device in the place of a node: the project takes over the identity of the device, in the node's own DCF
// and in the list of its manager [CiA 302-2: 1F84H to 1F88H], and nothing else.

#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <vector>

#include "canopus/network_project/network_project.hpp"

namespace canopus::network_project {

/// A value of 1000:00 or 1018:01 to 04, as far as the device has them.
struct IdentityValue {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint32_t value = 0;
};

struct AcceptedValue {
  std::uint8_t node_id = 0;  ///< whose DCF
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint32_t before = 0;
  std::uint32_t after = 0;
};

/// The differences: first the objects of the node's DCF, then of each manager the checks of this node that
/// are on (not 0). A check that is off stays off.
[[nodiscard]] std::vector<AcceptedValue> find_accepted_values(const NetworkProject& project,
                                                              std::uint8_t node_id,
                                                              std::span<const IdentityValue> found);

/// Puts that into the project. Fails with a sentence, and changes nothing then.
[[nodiscard]] std::expected<void, std::string> accept_values(NetworkProject& project,
                                                             std::span<const AcceptedValue> values);

}  // namespace canopus::network_project
