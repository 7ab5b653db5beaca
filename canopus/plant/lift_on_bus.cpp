#include "canopus/plant/lift_on_bus.hpp"

#include <utility>

#include "canopus/plant/event.hpp"

namespace canopus::plant {

LiftOnBus::LiftOnBus(const LiftSection& section, sim::lift::BuildingSettings settings,
                     can::Timeline& timeline, PlantObserver& observer)
    : section_(&section), observer_(&observer), building_(std::move(settings)) {
  building_.connect(this, this);
  timeline.add(building_, "lift on " + section.bus);
}

void LiftOnBus::add_unit(DeviceOnBus& seat) {
  seat.device().set_application(building_.application(units_.size()));
  units_.push_back(&seat);
}

void LiftOnBus::unit_plugged(std::size_t unit, bool plugged, can::Time now) {
  if (plugged) {
    units_[unit]->plug_in(now);
  } else {
    units_[unit]->unplug();
  }
}

void LiftOnBus::lift_event(const sim::lift::LiftEvent& event) {
  observer_->on({event.time, LiftChange{section_->bus, event}});
  if (listener_ != nullptr) listener_->lift_event(event);
}

void LiftOnBus::car_moved(std::uint8_t lift, double position, double door, can::Time now) {
  if (listener_ != nullptr) listener_->car_moved(lift, position, door, now);
}

}  // namespace canopus::plant
