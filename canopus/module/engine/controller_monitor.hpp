#pragma once

#include <cstdint>

#include "canopus/can/alarm.hpp"
#include "canopus/module/engine/module_context.hpp"

namespace canopus::module {

class ModuleNode;

/// The CAN controller of a module: its power and bit rate, and what its error states and full queues are to the module.
class ControllerMonitor {
 public:
  /// `node` may be under construction. The controller is off, and stays bus-off until restart() [ME3CAN1-Q 3.5.7].
  ControllerMonitor(ModuleContext& context, can::Controller& controller, ModuleNode& node);

  void set_power(bool on) { controller_.set_power(on); }
  /// Whether bus-off ends by itself.
  void set_automatic_recovery(bool on) { controller_.set_automatic_recovery(on); }
  /// The controller begins anew, at this bit rate (bit/s).
  void restart(std::uint32_t bit_rate);
  /// False: it is bus-off, or its queue is full.
  bool send(const can::Frame& frame);
  /// Its error state or its counters have changed.
  void changed(can::Time now);
  /// Frames that its queues had no room for.
  void report_overflows(can::Time now);
  /// Whether an overflow is over: when alarm() is due.
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return overflow_ends_; }

 private:
  [[nodiscard]] std::uint32_t overflows() const {
    return controller_.transmit_overflows() + controller_.receive_overflows();
  }

  ModuleContext& context_;
  can::Controller& controller_;
  ModuleNode& node_;
  bool logged_warning_ = false;  // in the event history
  std::uint32_t overflows_ = 0;  // known
  can::Alarm overflow_ends_;
};

}  // namespace canopus::module
