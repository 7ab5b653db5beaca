#pragma once
// Who wants to go from where to where, and when: by a seed, the same on every machine.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "canopus/can/time.hpp"

namespace canopus::sim::lift {

/// Numbers of a seed (SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  /// 0 to `count` - 1; `count` above 0.
  std::uint64_t below(std::uint64_t count) { return next() % count; }
  /// 0 to below 1.
  double fraction() { return static_cast<double>(next() >> 11U) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

struct PassengerSettings {
  std::uint32_t count = 0;
  std::uint64_t seed = 1;
  can::Duration from{};                           ///< the first may come
  can::Duration until = std::chrono::minutes(5);  ///< the last has come; after `from`
  double to_main_floor = 0.3;  ///< share of them that goes to floor 1, or comes from there: 0 to 1
  double holds_doors = 0.05;   ///< share that stands in the doorway for some seconds when it enters: 0 to 1
};

struct Passenger {
  enum class State : std::uint8_t { not_here, waiting, riding, arrived };
  can::Time comes{};
  std::uint8_t from = 1;  ///< floor, from 1
  std::uint8_t to = 2;
  std::uint16_t mass = 75;  ///< kg
  can::Duration holds{};    ///< stands in the doorway so long when it enters the first time
  State state = State::not_here;
  std::uint8_t car = 0;  ///< 0, 1, ...: rides in it
  can::Time next_press{};
  can::Time boarded{};  ///< the last time
  can::Time arrived{};
  bool steps_back = false;  ///< had to leave an overloaded car, which is `car`, and waits until it is gone
};

/// In the order they come. `floors` from 2.
[[nodiscard]] std::vector<Passenger> passengers_of(const PassengerSettings& settings, std::size_t floors);

}  // namespace canopus::sim::lift
