#pragma once

#include <cstdint>

#include "canopus/can/alarm.hpp"
#include "canopus/module/engine/module_context.hpp"

namespace canopus::module {

/// What the CAN controller's error states and full queues are to a module.
class ControllerMonitor {
 public:
  explicit ControllerMonitor(ModuleContext& parts) : parts_(parts) {}

  /// The controller begins anew, at this bit rate (bit/s).
  void restart(std::uint32_t bit_rate);
  /// Its error state or its counters have changed.
  void changed(can::Time now);
  /// Frames that its queues had no room for.
  void look_at_overflows(can::Time now);
  /// Whether an overflow is over: when alarm() is due.
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return overflow_ends_; }

 private:
  ModuleContext& parts_;
  bool logged_warning_ = false;  // in the event history
  std::uint32_t overflows_ = 0;  // known
  can::Alarm overflow_ends_;
};

}  // namespace canopus::module
