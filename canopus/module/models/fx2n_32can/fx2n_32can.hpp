#pragma once
// The FX2N-32CAN: a special function block with BFM #0..., one CAN port, and requests by bits of words instead of signals. A
// CANopen node of the older standards: no heartbeat, no LSS, no flying master.
//
// All of it is facts: model.cpp and the tables beside it. What they do is in canopus/module.

#include "canopus/module/engine/module_engine.hpp"
#include "canopus/module/models/fx2n_32can/model.hpp"

namespace canopus::module::fx2n_32can {

class Fx2n32Can final : public ModuleEngine {
 public:
  /// Off until power_on(). The controller and the memory must outlive the module.
  Fx2n32Can(can::Controller& controller, NonVolatileMemory& memory, const Profile& profile = {})
      : ModuleEngine(fx2n_32can::model, controller, memory, profile) {}
};

}  // namespace canopus::module::fx2n_32can
