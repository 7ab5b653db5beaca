#include "canopus/sim/lift/passengers.hpp"

#include <algorithm>

namespace canopus::sim::lift {

std::uint64_t Random::next() {
  state_ += 0x9E3779B97F4A7C15;
  std::uint64_t mixed = state_;
  mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9;
  mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EB;
  return mixed ^ (mixed >> 31U);
}

std::vector<Passenger> passengers_of(const PassengerSettings& settings, std::size_t floors) {
  Random random(settings.seed);
  std::vector<Passenger> passengers;
  passengers.reserve(settings.count);
  const double span = static_cast<double>((settings.until - settings.from).count());
  for (std::uint32_t i = 0; i < settings.count; ++i) {
    Passenger passenger;
    const auto after = static_cast<can::Duration::rep>(random.fraction() * span);
    passenger.comes = can::Time{} + settings.from + can::Duration{after};
    passenger.from = static_cast<std::uint8_t>(1 + random.below(floors));
    passenger.to = static_cast<std::uint8_t>(1 + random.below(floors - 1));
    if (passenger.to >= passenger.from) ++passenger.to;
    if (random.fraction() < settings.to_main_floor) {
      const auto other = static_cast<std::uint8_t>(2 + random.below(floors - 1));
      const bool leaves = random.below(2) == 0;
      passenger.from = leaves ? other : std::uint8_t{1};
      passenger.to = leaves ? std::uint8_t{1} : other;
    }
    passenger.mass = static_cast<std::uint16_t>(50 + random.below(51));
    const auto holds = std::chrono::milliseconds(3000 + random.below(5000));
    if (random.fraction() < settings.holds_doors) passenger.holds = holds;
    passenger.next_press = passenger.comes;
    passengers.push_back(passenger);
  }
  std::ranges::stable_sort(passengers, {}, &Passenger::comes);
  return passengers;
}

}  // namespace canopus::sim::lift
