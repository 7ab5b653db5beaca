#pragma once
// The settings of a building with lifts.

#include <cstdint>
#include <vector>

#include "canopus/sim/lift/door_unit.hpp"
#include "canopus/sim/lift/lift_fault.hpp"
#include "canopus/sim/lift/motion.hpp"
#include "canopus/sim/lift/passengers.hpp"

namespace canopus::sim::lift {

struct BuildingSettings {
  std::vector<std::uint8_t> lifts{1};           ///< numbers, 1 to 8, each once
  std::vector<double> floors{0, 3000};          ///< mm: level of each floor, rising, at least two
  std::vector<std::uint8_t> floor_doors{0, 0};  ///< door (0 to 2) by which each floor is reached
  MotionLimits limits{};
  DoorSettings door{};
  double car_mass = 900;    ///< kg, empty
  double rated_load = 630;  ///< kg; overload is 10 % above, at least 75 kg
  PassengerSettings passengers{};
  std::vector<LiftFault> faults{};
};

}  // namespace canopus::sim::lift
