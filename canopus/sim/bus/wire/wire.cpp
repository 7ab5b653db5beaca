#include "canopus/sim/bus/wire/wire.hpp"

namespace canopus::sim {

void WireState::notify_controller_changes(can::Time now) {
  if (!controllers_changed) return;
  controllers_changed = false;
  for (const auto& port : core.ports) {
    if (!has(*port) || !port->phase.changed) continue;
    port->phase.changed = false;
    if (port->participant != nullptr) port->participant->controller_changed(now);
  }
}

void Wire::suspended_offer_changed() {
  if (mode != Mode::idle || suspension.port->offer() == Arbiter::none || suspension.until >= deadline) return;
  deadline = std::max(core.timeline.now(), suspension.until);
  core.deadline_changed();
}

/// After an offer has changed while no whole frame is on the wire: the next one may begin earlier.
void Wire::update_start() {
  if (mode == Mode::lone_frame || arbiter.lowest() == Arbiter::none) return;
  const can::Time possible = std::max(core.timeline.now(), free_from);
  if (possible >= deadline) return;
  deadline = possible;
  core.deadline_changed();
}

void Wire::update_start_bitwise(const BusPort& port) {
  const can::Time now = core.timeline.now();
  if (now >= deadline || !may_begin_bitwise(port, now)) return;
  deadline = now;
  core.deadline_changed();
}

}  // namespace canopus::sim
