#pragma once
// What a module shows of itself: its LEDs, and lines of the event history that no other part reports.

#include <vector>

#include "canopus/module/engine/module_context.hpp"
#include "canopus/module/interface/led.hpp"

namespace canopus::module {

/// What the LEDs of the model show. `last_frame`: when one was sent or received last; can::Time{} if none was.
[[nodiscard]] std::vector<Led> leds_of(const ModuleContext& parts, can::Time last_frame, can::Time now);

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
