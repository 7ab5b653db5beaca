#pragma once
// The FX3U-CAN as far as its tables show that it fits the engine: FROM and TO planes, requests by bits of words,
// node states of two nodes per word [FX3U-CAN 6, 7, 9, 10]. Not the module: mode 417, the PDO mapping modes and
// most of its limits are missing.

#include "canopus/module/engine/module_engine.hpp"

namespace canopus::scenario {

extern const module::ModuleModel fx3u_can_sketch;

class Fx3uCanSketch final : public module::ModuleEngine {
 public:
  Fx3uCanSketch(can::Controller& controller, module::NonVolatileMemory& memory)
      : ModuleEngine(fx3u_can_sketch, controller, memory, {}) {}
};

}  // namespace canopus::scenario
