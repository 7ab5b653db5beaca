#pragma once
// The MELSEC iQ-R module RJ71CN91: 32 points, buffer memory Un\G0 to Un\G32767, one CAN port, three function modes: CANopen
// (CiA 405) and plain CAN with 11- or 29-bit identifiers.
//
// All of it is facts: model.cpp and the tables beside it. What they do is in canopus/module.

#include <memory>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/module/engine/module_engine.hpp"
#include "canopus/module/engine/module_model.hpp"

namespace canopus::module::rj71cn91 {

/// What the manual says, as the engine reads it: model.cpp.
extern const ModuleModel model;
/// The object dictionary in CANopen 405 mode [RJ71CN91 App. 3]. The same description for every module of this kind.
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> object_dictionary();

class Rj71cn91 final : public ModuleEngine {
 public:
  /// Off until power_on(). The controller and the memory must outlive the module.
  Rj71cn91(can::Controller& controller, NonVolatileMemory& memory, const Profile& profile = {})
      : ModuleEngine(rj71cn91::model, controller, memory, profile) {}
};

}  // namespace canopus::module::rj71cn91
