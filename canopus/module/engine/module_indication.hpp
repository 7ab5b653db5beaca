#pragma once
// What a module shows of itself: its LEDs, and lines of the event history that no other part reports.

#include <vector>

#include "canopus/module/engine/layer2_mode.hpp"
#include "canopus/module/engine/module_node.hpp"
#include "canopus/module/interface/led.hpp"

namespace canopus::module {

/// What LEDs show.
struct LedSources {
  const ModuleContext& context;
  const ModuleNode& node;
  const Layer2Mode& layer2;
  const CpuStateHandler& cpu;
};
/// What the LEDs of the model show. `last_frame`: when one was sent or received last; can::Time{} if none was.
[[nodiscard]] std::vector<Led> leds_of(const LedSources& module, can::Time last_frame, can::Time now);

/// Adds to the event history, and to the module errors, the changes that no callback reports: found by comparison after each event.
class ChangeLog {
 public:
  ChangeLog(ModuleContext& context, const ModuleNode& node, const Layer2Mode& layer2)
      : context_(context), node_(node), layer2_(layer2) {}
  /// After every event.
  void update(can::Time now) {
    if (context_.diagnostics.reports()) log_changes(now);
  }

 private:
  void log_changes(can::Time now);

  ModuleContext& context_;
  const ModuleNode& node_;
  const Layer2Mode& layer2_;
  bool online_ = false;  // as logged last
  bool active_ = false;
};

}  // namespace canopus::module
