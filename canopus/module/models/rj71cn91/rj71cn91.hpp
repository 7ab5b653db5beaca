#pragma once
// The MELSEC iQ-R module RJ71CN91: 32 points, buffer memory Un\G0 to Un\G32767, one CAN port, three function modes: CANopen
// (CiA 405) and plain CAN with 11- or 29-bit identifiers.
//
// All of it is facts: model.cpp and the tables beside it. What they do is in canopus/module.

#include "canopus/module/engine/module_engine.hpp"
#include "canopus/module/models/rj71cn91/model.hpp"

namespace canopus::module::rj71cn91 {

class Rj71cn91 final : public ModuleEngine {
 public:
  /// Off until power_on(). The controller and the memory must outlive the module.
  Rj71cn91(can::Controller& controller, NonVolatileMemory& memory, const Profile& profile = {})
      : ModuleEngine(rj71cn91::model, controller, memory, profile) {}
};

}  // namespace canopus::module::rj71cn91
