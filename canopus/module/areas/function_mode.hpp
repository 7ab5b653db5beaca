#pragma once
// The function modes of a module: CANopen, or plain CAN (Layer 2) with 11- or 29-bit identifiers.

#include <cstdint>

#include "canopus/module/areas/buffer_memory.hpp"

namespace canopus::module {

/// A function mode of a module. The first of a model's list is the one it has as factory setting.
struct FunctionModeRow {
  enum class Kind : std::uint8_t { canopen, layer2_base, layer2_extended };
  std::uint16_t value = 0;  ///< of the function mode word
  Modes bit = 0;            ///< in the tables
  Kind kind = Kind::canopen;
};

}  // namespace canopus::module
