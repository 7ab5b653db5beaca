#include "canopus/module/engine/controller_monitor.hpp"

#include <utility>

namespace canopus::module {

void ControllerMonitor::restart(std::uint32_t bit_rate) {
  parts_.controller.restart(bit_rate);
  parts_.state.boot_up_waits = false;  // nothing waits any more
  overflows_ = 0;
  overflow_ends_.cancel();
}

void ControllerMonitor::changed(can::Time now) {
  const can::ErrorState state = parts_.controller.error_state();
  ErrorStatus& errors = parts_.errors;
  const bool was_off = errors.has(ModuleError::bus_off);
  errors.follow(ModuleError::bus_off, state == can::ErrorState::bus_off);
  const bool was_passive = errors.has(ModuleError::error_passive);
  errors.track(ModuleError::error_passive, state == can::ErrorState::error_passive);
  if (!was_passive && errors.has(ModuleError::error_passive)) {
    parts_.own_emergencies.raise(parts_.model.emergencies.error_passive);
    parts_.diagnostics.log(ModuleEvent::error_passive, now);
  }
  const bool warning =
      state == can::ErrorState::error_active && error_counter(parts_.controller) >= warning_counter;
  if (!std::exchange(logged_warning_, warning) && warning) {
    parts_.diagnostics.log(ModuleEvent::warning_level, now);
  }
  if (was_off || !errors.has(ModuleError::bus_off)) return;
  parts_.report("the CAN controller is bus-off", now);
  parts_.diagnostics.raise(Diagnosis::bus_off, now);
  parts_.command.bus_lost(command_error::bus_off, now);
  if (parts_.state.canopen_mode()) parts_.node.communication_error(now);
}

void ControllerMonitor::look_at_overflows(can::Time now) {
  const std::uint32_t overflows =
      parts_.controller.transmit_overflows() + parts_.controller.receive_overflows();
  if (std::exchange(overflows_, overflows) == overflows) return;
  const auto& layout = parts_.model.error_status;
  if (layout && layout->overflow_lasts) overflow_ends_ = can::later(now, *layout->overflow_lasts);
  if (!parts_.errors.raise(ModuleError::queue_overflow)) return;
  parts_.own_emergencies.raise(parts_.model.emergencies.queue_overflow);
  parts_.own_emergencies.send(now);
  // It may have found no room itself: that is the same overflow.
  overflows_ = parts_.controller.transmit_overflows() + parts_.controller.receive_overflows();
  parts_.report("a queue has overflown: frames were lost", now);
  parts_.diagnostics.raise(Diagnosis::queue_overflow, now);
}

void ControllerMonitor::tick(can::Time now) {
  if (now < overflow_ends_) return;
  overflow_ends_.cancel();
  if (parts_.controller.has_room()) {
    parts_.errors.follow(ModuleError::queue_overflow, false);
  } else {
    overflow_ends_ = can::later(now, *parts_.model.error_status->overflow_lasts);
  }
}

}  // namespace canopus::module
