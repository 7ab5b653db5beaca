#pragma once
// The CANopen nodes of a plant at power-on, to decode the frames of its buses.

#include <cstdint>
#include <string>
#include <vector>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/text/output.hpp"
#include "canopus/trace/decode/names.hpp"

namespace canopus::plant {

/// A node with the values that power-on gives it.
struct InitialPlantNode {
  std::string bus;
  std::string name;          ///< as the live table shows it; may be empty
  std::uint8_t node_id = 0;  ///< 1..127
  canopen::ObjectDictionary objects;
};

/// Devices and modules that have a node-ID, modules first. The plant must not have been switched on.
[[nodiscard]] std::vector<InitialPlantNode> initial_nodes(Plant& plant);

/// Adds the names of the nodes and objects of the plant in this file, for the decoder. False after its mistakes were printed on `err`.
[[nodiscard]] bool add_plant_names(const std::string& path, trace::Names& names, text::Output& err);

}  // namespace canopus::plant
