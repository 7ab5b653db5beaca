#include "canopus/plant/deferred_events.hpp"

#include <algorithm>
#include <iterator>
#include <string>

#include "canopus/can/bus.hpp"
#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/manager/boot/boot_record.hpp"
#include "canopus/module/interface/event_records.hpp"
#include "canopus/sim/lift/lift_report.hpp"

namespace canopus::plant {

namespace {

/// What an argument is kept as: texts may be gone when the event is handed on.
template <typename T>
const T& kept(const T& argument) {
  return argument;
}
std::string kept(std::string_view text) { return std::string(text); }

}  // namespace

template <typename... Parameters, typename... Arguments>
void DeferredEvents::pass(void (PlantObserver::*event)(Parameters...), const Arguments&... arguments) {
  if (!timeline_.runs_alone()) return (observer_.*event)(arguments...);
  held_.push_back({timeline_.stamp(), [event, ... copies = kept(arguments)](PlantObserver& observer) {
                     (observer.*event)(copies...);
                   }});
}

void DeferredEvents::release(std::span<const std::unique_ptr<DeferredEvents>> parts) {
  std::vector<Held> all;
  for (const auto& part : parts) {
    std::ranges::move(part->held_, std::back_inserter(all));
    part->held_.clear();
  }
  std::ranges::stable_sort(all, {}, &Held::stamp);
  for (const Held& held : all) held.event(parts.front()->observer_);
}

void DeferredEvents::booted(const NodeLabel& node, can::Time now) { pass(&PlantObserver::booted, node, now); }

void DeferredEvents::nmt_state_changed(const NodeLabel& node, canopen::NmtState state, can::Time now) {
  pass(&PlantObserver::nmt_state_changed, node, state, now);
}

void DeferredEvents::lss_configured(const NodeLabel& node, std::uint32_t bit_rate, can::Time now) {
  pass(&PlantObserver::lss_configured, node, bit_rate, now);
}

void DeferredEvents::emergency(const NodeLabel& node, const canopen::Emergency& message, can::Time now) {
  pass(&PlantObserver::emergency, node, message, now);
}

void DeferredEvents::unacknowledged(const NodeLabel& node, can::Time now) {
  pass(&PlantObserver::unacknowledged, node, now);
}

void DeferredEvents::bus_error(const BusErrorEvent& error, can::Time now) {
  pass(&PlantObserver::bus_error, error, now);
}

void DeferredEvents::controller_changed(const NodeLabel& node, const can::ControllerReport& report,
                                        can::Time now) {
  pass(&PlantObserver::controller_changed, node, report, now);
}

void DeferredEvents::slave_boot_went_on(const NodeLabel& slave, const NodeLabel& master,
                                        const manager::BootRecord& record, can::Time now) {
  pass(&PlantObserver::slave_boot_went_on, slave, master, record, now);
}

void DeferredEvents::signal_changed(std::string_view plc, char kind, unsigned number, bool on,
                                    can::Time now) {
  pass(&PlantObserver::signal_changed, plc, kind, number, on, now);
}

void DeferredEvents::buffer_changed(std::string_view plc, unsigned head, std::uint32_t address,
                                    std::uint16_t value, bool by_cpu, can::Time now) {
  pass(&PlantObserver::buffer_changed, plc, head, address, value, by_cpu, now);
}

void DeferredEvents::object_forced(const ForcedObject& object, can::Time now) {
  pass(&PlantObserver::object_forced, object, now);
}

void DeferredEvents::object_released(const ForcedObject& object, can::Time now) {
  pass(&PlantObserver::object_released, object, now);
}

void DeferredEvents::lift_event(std::string_view bus, const sim::lift::LiftEvent& event) {
  pass(&PlantObserver::lift_event, bus, event);
}

void DeferredEvents::load(std::string_view bus, const can::BusLoad& load, can::Time now) {
  pass(&PlantObserver::load, bus, load, now);
}

void DeferredEvents::warning(std::string_view source, std::string_view message, can::Time now) {
  pass(&PlantObserver::warning, source, message, now);
}

void DeferredEvents::module_event(std::string_view plc, std::string_view source,
                                  const module::ModuleEventRecord& record) {
  pass(&PlantObserver::module_event, plc, source, record);
}

void DeferredEvents::module_error(std::string_view plc, std::string_view source,
                                  const module::ModuleErrorRecord& record) {
  pass(&PlantObserver::module_error, plc, source, record);
}

void DeferredEvents::error(std::string_view source, std::string_view message, can::Time now) {
  pass(&PlantObserver::error, source, message, now);
}

}  // namespace canopus::plant
