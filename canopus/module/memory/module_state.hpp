#pragma once
// The function modes of a module (CANopen, or plain CAN with 11- or 29-bit identifiers: Layer 2), and its phase. The engine
// (module_engine.hpp) changes it; all others only read it.

#include <cstdint>
#include <memory>

#include "canopus/can/time.hpp"
#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/module/interface/module_types.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

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

struct ModuleState {
  enum class Phase : std::uint8_t {
    off,           ///< no supply
    initializing,  ///< power-on or restart until the settings are in force
    stuck,         ///< initializing for ever: the stored object dictionary is faulty
    running,
    failed,  ///< stopped by its watchdog until the supply goes off: it shows that, and does nothing
  };

  Phase phase = Phase::off;
  const FunctionModeRow* mode = nullptr;  ///< the function mode in use
  std::uint16_t bit_rate = 250;           ///< in force, kbit/s
  bool hardware_fault = false;            ///< until the supply goes off
  can::Time last_access{};                ///< of the program to a word

  [[nodiscard]] bool running() const noexcept { return phase == Phase::running; }
  /// It has a supply, and has not failed.
  [[nodiscard]] bool works() const noexcept { return phase != Phase::off && phase != Phase::failed; }
  /// No program may use the module: settings are being put in force.
  [[nodiscard]] bool initializing() const noexcept {
    return phase == Phase::initializing || phase == Phase::stuck;
  }
  [[nodiscard]] bool canopen_mode() const noexcept { return mode->kind == FunctionModeRow::Kind::canopen; }
};

}  // namespace canopus::module
