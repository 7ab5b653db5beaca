#pragma once
// The MELSEC Q module ME3CAN1-Q: 32 points, buffer memory Un\G0..., one CAN port, three function modes:
// CANopen (CiA 405) and plain CAN with 11- or 29-bit identifiers.
//
// All of it is facts: model.cpp and the tables beside it. What they do is in canopus/module.

#include <memory>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/module/engine/module_engine.hpp"
#include "canopus/module/engine/module_model.hpp"

namespace canopus::module::me3can1_q {

/// What the manual says, as the engine reads it: model.cpp.
extern const ModuleModel model;
/// The object dictionary in CANopen 405 mode [ME3CAN1-Q Tab. 4-6 to 4-10, 4.9]. The same description for every module of this kind.
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> object_dictionary();

class Me3can1Q final : public ModuleEngine {
 public:
  /// Off until power_on(). The controller and the memory must outlive the module.
  Me3can1Q(can::Controller& controller, NonVolatileMemory& memory, const Profile& profile = {})
      : ModuleEngine(me3can1_q::model, controller, memory, profile) {}

  // Its signals, without the way over signals().
  [[nodiscard]] std::uint32_t inputs() const noexcept { return signals_->inputs(); }
  [[nodiscard]] std::uint32_t outputs() const noexcept { return signals_->outputs(); }
  void set_output(unsigned signal, bool on, can::Time now) { signals_->set_output(signal, on, now); }

 private:
  SignalAccess* signals_ = signals();
};

}  // namespace canopus::module::me3can1_q
