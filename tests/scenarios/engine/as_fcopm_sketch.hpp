#pragma once
// The AS-FCOPM as far as its tables show that it fits the engine: no buffer memory and no signals, but registers of
// the CPU; process data that are exchanged all the time; requests by messages in registers, of which the sketch
// knows the reading of EMCYs [AS-FCOPM 10.1.2, 10.4.3, 10.5.1]. Not the module.

#include "canopus/module/engine/module_engine.hpp"

namespace canopus::scenario {

namespace sketch {
extern const module::ModuleModel as_fcopm_sketch;
}

class AsFcopmSketch final : public module::ModuleEngine {
 public:
  AsFcopmSketch(can::Controller& controller, module::NonVolatileMemory& memory)
      : ModuleEngine(sketch::as_fcopm_sketch, controller, memory, {}) {}
};

}  // namespace canopus::scenario
