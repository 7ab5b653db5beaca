#pragma once
// The FX3U-CAN: a special function block with BFM #0..., one CAN port, and requests by bits of words instead of signals.
// Four function modes: CANopen (CiA 405), CANopen for lifts (CiA 417), and plain CAN with 11- or 29-bit identifiers.
//
// All of it is facts: model.cpp and the tables beside it. What they do is in canopus/module.

#include "canopus/module/engine/module_engine.hpp"
#include "canopus/module/engine/module_model.hpp"

namespace canopus::module::fx3u_can {

/// What the manual says, as the engine reads it: model.cpp.
extern const ModuleModel model;

class Fx3uCan final : public ModuleEngine {
 public:
  /// Off until power_on(). The controller and the memory must outlive the module.
  Fx3uCan(can::Controller& controller, NonVolatileMemory& memory, const Profile& profile = {})
      : ModuleEngine(fx3u_can::model, controller, memory, profile) {}
};

}  // namespace canopus::module::fx3u_can
