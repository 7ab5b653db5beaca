#pragma once
// Mappable objects of a communication module, as in the details windows of its configuration tool: object
// names, and for each the parts of the buffer memory it can be [FX3U-CAN 15.1.2] [RJ71CN91 3.1].

#include <cstdint>
#include <string>
#include <vector>

#include "canopus/module_settings/module_windows.hpp"

namespace canopus::module_settings {

/// One object of a name, as a mapping entry has it.
struct MappableObject {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::string description{};  ///< "Un\G13000"; of dummies empty
};

/// Those that share a name, and with it a data type.
struct MappableObjects {
  std::string name{};     ///< "Buffer Memory Area Unsigned16"
  std::uint8_t bits = 0;  ///< of each
  std::vector<MappableObject> objects{};
};

/// For a window of PDOs, in the order of their indexes, dummies last; empty: the window has no mapping.
[[nodiscard]] std::vector<MappableObjects> mappable_objects(const module::ConfigurationTool& model,
                                                            const Window& window);

}  // namespace canopus::module_settings
