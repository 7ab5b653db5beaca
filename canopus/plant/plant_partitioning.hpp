#pragma once
// Which buses and racks of a plant have to do with each other.

#include <cstddef>
#include <string_view>
#include <vector>

#include "canopus/plant/file/plant_file.hpp"

namespace canopus::plant {

/// The parts of a plant, in the order of their first buses in the plant file. Buses that a rack or a bridge joins are one
/// part; a rack without a module is in the first one.
struct PlantPartitioning {
  std::size_t count = 0;             ///< 0: there is no bus
  std::vector<std::size_t> buses{};  ///< part of each bus
  std::vector<std::size_t> racks{};  ///< part of each PLC's rack

  [[nodiscard]] static PlantPartitioning of(const PlantFile& file);
};

}  // namespace canopus::plant
