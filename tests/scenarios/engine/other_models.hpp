#pragma once
// A made-up model for the engine whose every word, bit and signal is elsewhere than the ME3CAN1-Q's, and what a
// scenario of any model needs.

#include <utility>

#include "canopus/module/engine/module_engine.hpp"

#include "scenarios/scenario.hpp"

namespace canopus::scenario {

namespace other_models {
/// All addresses, bits and signals differ from the ME3CAN1-Q's; 8 words and 2 PDOs each way, four-digit year.
extern const module::ModuleModel elsewhere;
}  // namespace other_models

/// Signals: 1C ready, 1B data exchange, 1A restart, 19 error, 18 NMT error, 17 emergency, 16 set clock, 15
/// read clock, 14 command, 13 save/restore, 12 online (Layer 2), 11 transmit trigger (Layer 2).
class ElsewhereModule final : public module::ModuleEngine {
 public:
  ElsewhereModule(can::Controller& controller, module::NonVolatileMemory& memory)
      : ModuleEngine(other_models::elsewhere, controller, memory, {}) {}
};

template <typename Model>
struct OtherBench {
  RamMemory memory;
  FreeBus bus;
  Model module{bus, memory};
};

template <typename Model>
class OtherScenario : private OtherBench<Model>, public ModuleScenario {
 public:
  OtherScenario() : ModuleScenario(OtherBench<Model>::module, OtherBench<Model>::bus) {}
  [[nodiscard]] Model& plug_in() { return OtherBench<Model>::module; }
  [[nodiscard]] FreeBus& controller() { return OtherBench<Model>::bus; }
  [[nodiscard]] RamMemory& flash() { return OtherBench<Model>::memory; }
};

}  // namespace canopus::scenario
