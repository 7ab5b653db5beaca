#pragma once

#include "canopus/module/engine/module_context.hpp"

namespace canopus::module {

/// Brings into the event history, and to the module errors, what nobody reports: it is seen from one event to the next.
class ChangeLog {
 public:
  explicit ChangeLog(ModuleContext& parts) : parts_(parts) {}
  /// After every event.
  void look(can::Time now) {
    if (parts_.diagnostics.reports()) look_at_parts(now);
  }

 private:
  void look_at_parts(can::Time now);

  ModuleContext& parts_;
  bool online_ = false;  // as logged last
  bool active_ = false;
};

}  // namespace canopus::module
