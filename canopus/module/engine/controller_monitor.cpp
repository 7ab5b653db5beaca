#include "canopus/module/engine/controller_monitor.hpp"

#include <utility>

#include "canopus/module/engine/module_node.hpp"

namespace canopus::module {

ControllerMonitor::ControllerMonitor(ModuleContext& context, can::Controller& controller, ModuleNode& node)
    : context_(context), controller_(controller), node_(node) {
  controller_.set_power(false);
  controller_.set_automatic_recovery(false);
}

void ControllerMonitor::restart(std::uint32_t bit_rate) {
  controller_.restart(bit_rate);
  node_.frames_lost();
  overflows_ = 0;
  overflow_ends_.cancel();
}

bool ControllerMonitor::send(const can::Frame& frame) {
  return controller_.error_state() != can::ErrorState::bus_off && controller_.has_room() &&
         controller_.send(frame);
}

void ControllerMonitor::changed(can::Time now) {
  const can::ErrorState state = controller_.error_state();
  ErrorStatus& errors = context_.errors;
  const bool was_off = errors.has(ModuleError::bus_off);
  errors.follow(ModuleError::bus_off, state == can::ErrorState::bus_off);
  const bool was_passive = errors.has(ModuleError::error_passive);
  errors.track(ModuleError::error_passive, state == can::ErrorState::error_passive);
  if (!was_passive && errors.has(ModuleError::error_passive)) {
    node_.raise_emergency(context_.model.emergencies.error_passive);
    context_.diagnostics.log(ModuleEvent::error_passive, now);
  }
  const bool warning =
      state == can::ErrorState::error_active && error_counter(controller_) >= warning_counter;
  if (!std::exchange(logged_warning_, warning) && warning) {
    context_.diagnostics.log(ModuleEvent::warning_level, now);
  }
  if (was_off || !errors.has(ModuleError::bus_off)) return;
  context_.report("the CAN controller is bus-off", now);
  context_.diagnostics.raise(Diagnosis::bus_off, now);
  node_.bus_off(now);
}

void ControllerMonitor::report_overflows(can::Time now) {
  const std::uint32_t overflows = this->overflows();
  if (std::exchange(overflows_, overflows) == overflows) return;
  const auto& layout = context_.model.error_status;
  if (layout && layout->overflow_lasts) overflow_ends_ = can::later(now, *layout->overflow_lasts);
  if (!context_.errors.raise(ModuleError::queue_overflow)) return;
  node_.raise_emergency(context_.model.emergencies.queue_overflow);
  node_.send_emergencies(now);
  // It may have found no room itself: that is the same overflow.
  overflows_ = this->overflows();
  context_.report("a queue has overflown: frames were lost", now);
  context_.diagnostics.raise(Diagnosis::queue_overflow, now);
}

void ControllerMonitor::tick(can::Time now) {
  if (now < overflow_ends_) return;
  overflow_ends_.cancel();
  if (controller_.has_room()) {
    context_.errors.follow(ModuleError::queue_overflow, false);
  } else {
    overflow_ends_ = can::later(now, *context_.model.error_status->overflow_lasts);
  }
}

}  // namespace canopus::module
