// The faults of a building, and their durations.

#include <algorithm>

#include "canopus/sim/lift/building.hpp"

namespace canopus::sim::lift {

namespace {

// Emergency error codes: CiA 402, CiA 406, [FX3U-CAN 5.10.15].
constexpr std::uint16_t over_current = 0x2310, sensor_fault = 0x7305, light_barrier_defective = 0xFF01;

}  // namespace

std::size_t Building::unit_of(UnitKind kind, std::size_t car, unsigned door) const {
  const auto found = std::ranges::find_if(
      units_, [&](const Unit& unit) { return unit.kind == kind && unit.car == car && unit.door == door; });
  return static_cast<std::size_t>(found - units_.begin());
}

void Building::carry_out_faults(can::Time now) {
  enum : std::uint8_t { before, present, over };
  for (std::size_t i = 0; i < settings_.faults.size(); ++i) {
    const LiftFault& fault = settings_.faults[i];
    if (fault_states_[i] == before && fault.at <= now) {
      fault_states_[i] = present;
      set_fault(fault, true, now);
    }
    if (fault_states_[i] == present && fault.until <= now) {
      fault_states_[i] = over;
      set_fault(fault, false, now);
    }
  }
}

void Building::set_fault(const LiftFault& fault, bool begins, can::Time now) {
  Car& car = cars_[fault.car];
  const auto count = [begins](unsigned& number) { begins ? ++number : --number; };
  const auto emergency = [&](UnitKind kind, std::uint16_t code) {
    const std::size_t unit = unit_of(kind, fault.car);
    if (begins) {
      shown_[unit].emergency = code;
    } else {
      shown_[unit].recovers = true;
    }
    shown_[unit].alarm = now;
  };
  switch (fault.kind) {
    case LiftFault::Kind::light_barrier_blocked: count(car.blocked); break;
    case LiftFault::Kind::light_barrier_defect:
      count(car.defective);
      emergency(UnitKind::car_door_unit, light_barrier_defective);
      break;
    case LiftFault::Kind::drive_fault:
      begins ? car.drive.fail(true, now) : car.drive.repaired();
      emergency(UnitKind::car_drive_unit, over_current);
      break;
    case LiftFault::Kind::panel_unplugged: {
      const std::size_t unit = panel_number(fault.floor, fault.car);
      if (begins) panels_[unit].forget();
      if (devices_ != nullptr) devices_->unit_plugged(unit, !begins, now);
      break;
    }
    case LiftFault::Kind::position_lost:
      count(car.lost);
      emergency(UnitKind::car_position_unit, sensor_fault);
      break;
    case LiftFault::Kind::overload: count(car.weights); break;
  }
  report_event({.kind = begins ? LiftEvent::Kind::fault_began : LiftEvent::Kind::fault_ended,
                .time = now,
                .lift = fault.kind == LiftFault::Kind::panel_unplugged && fault.floor != 0
                            ? std::uint8_t{0}
                            : settings_.lifts[fault.car],
                .floor = fault.floor,
                .fault = fault.kind});
}

}  // namespace canopus::sim::lift
