#pragma once
// [[lift]] of a plant file: a lift or a group of lifts, its devices and the people who use it.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopus/sim/lift/building_settings.hpp"
#include "canopus/text/file_error.hpp"

namespace canopus::plant {

struct LiftSection {
  text::Place place{};
  std::string bus{};
  std::uint8_t first_node = 2;  ///< node-ID of the first device; the others follow
  sim::lift::BuildingSettings building{};
  bool own_seed = false;  ///< its passengers have a seed of their own; otherwise it is the plant's
};

/// A device's lift (number of its section) and unit (see sim::lift::Building).
struct LiftUnitSection {
  std::size_t lift = 0;
  std::size_t unit = 0;
};

}  // namespace canopus::plant
