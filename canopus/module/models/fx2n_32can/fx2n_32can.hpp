#pragma once
// The FX2N-32CAN: a special function block with BFM #0..., one CAN port, and requests by bits of words instead of signals. A
// CANopen node of the older standards: no heartbeat, no LSS, no flying master.
//
// All of it is facts: model.cpp and the tables beside it. What they do is in canopus/module.

#include <memory>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/module/engine/module_engine.hpp"
#include "canopus/module/engine/module_model.hpp"

namespace canopus::module::fx2n_32can {

/// What the manual says, as the engine reads it: model.cpp.
extern const ModuleModel model;
/// The object dictionary [FX2N-32CAN 5, 7.4, 8].
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> object_dictionary();

class Fx2n32Can final : public ModuleEngine {
 public:
  /// Off until power_on(). The controller and the memory must outlive the module.
  Fx2n32Can(can::Controller& controller, NonVolatileMemory& memory, const Profile& profile = {})
      : ModuleEngine(fx2n_32can::model, controller, memory, profile) {}
};

}  // namespace canopus::module::fx2n_32can
