#pragma once
// The function modes of a module: CANopen, or plain CAN (Layer 2) with 11- or 29-bit identifiers.

#include <cstdint>
#include <memory>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/canopen/service/node_options.hpp"
#include "canopus/module/areas/buffer_memory.hpp"

namespace canopus::module {

/// A function mode of a module. The first of a model's list is the one it has as factory setting.
struct FunctionModeRow {
  enum class Kind : std::uint8_t { canopen, layer2_base, layer2_extended };
  std::uint16_t value = 0;  ///< of the function mode word
  Modes bit = 0;            ///< in the tables
  Kind kind = Kind::canopen;
  /// Of a CANopen mode with an object dictionary other than the model's; what 1010H has stored of one dictionary goes when
  /// the module starts with another [FX3U-CAN 6.5].
  std::shared_ptr<const canopen::DictionaryDescription> (*object_dictionary)() = nullptr;
  canopen::NodeOptions (*node_options)() = nullptr;  ///< likewise
};

}  // namespace canopus::module
