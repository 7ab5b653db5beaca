#pragma once
// Where a module is in its life, as its parts see it. The engine (module_engine.hpp) and what hears its node
// (node_events.hpp) change it; everybody else only looks.

#include <cstdint>

#include "canopus/can/time.hpp"
#include "canopus/module/areas/function_mode.hpp"
#include "canopus/module/interface/module.hpp"

namespace canopus::module {

struct ModuleState {
  enum class Phase : std::uint8_t {
    off,           ///< no supply
    initializing,  ///< power-on or restart until the settings are in force
    stuck,         ///< initializing for ever: the stored object dictionary is faulty
    running,
  };

  Phase phase = Phase::off;
  const FunctionModeRow* mode = nullptr;  ///< the function mode in use
  std::uint16_t bit_rate = 250;           ///< in force, kbit/s
  CpuState cpu = CpuState::run;
  bool nmt_resetting = false;   ///< the node is in an NMT reset
  bool hardware_fault = false;  ///< until the supply goes off
  bool cpu_fault = false;       ///< an error of the CPU, until its next RUN
  can::Time last_access{};      ///< of the program to a word

  [[nodiscard]] bool running() const noexcept { return phase == Phase::running; }
  /// No program may use the module: settings are being put in force.
  [[nodiscard]] bool initializing() const noexcept {
    return phase == Phase::initializing || phase == Phase::stuck || nmt_resetting;
  }
  [[nodiscard]] bool canopen_mode() const noexcept { return mode->kind == FunctionModeRow::Kind::canopen; }
};

}  // namespace canopus::module
