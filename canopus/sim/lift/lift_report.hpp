#pragma once
// Reports of lifts: events as they happen, and the statistics at the end.

#include <cstdint>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/sim/lift/lift_fault.hpp"

namespace canopus::sim::lift {

struct LiftEvent {
  enum class Kind : std::uint8_t {
    started,      ///< the car began to move
    stopped,      ///< and is at rest again
    door_opened,  ///< fully
    door_closed,
    door_reversed,    ///< began to reopen
    call_registered,  ///< a lamp went on: of a hall call (`direction`), or with direction 0 of a car call
    call_answered,    ///< and off
    passenger_came,   ///< `floor` to `to`
    passenger_boarded,
    passenger_stepped_back,  ///< out of an overloaded car
    passenger_arrived,
    fault_began,
    fault_ended,
    door_open_between_floors,  ///< unsafe: a door opened where no landing door is
    door_open_while_moving,    ///< unsafe: the car moves with an open door; the safety circuit stops it
    overload_travel,           ///< unsafe: an overloaded car began to move
    overspeed,                 ///< unsafe
  };
  Kind kind = Kind::started;
  can::Time time{};
  std::uint8_t lift = 0;        ///< number, 1 to 8; 0: of a floor of the group
  std::uint8_t floor = 0;       ///< from 1: where; the nearest one
  std::uint8_t to = 0;          ///< floor a passenger goes to
  std::uint8_t door = 0;        ///< 1 to 3
  std::uint8_t direction = 0;   ///< bit 0 up, bit 1 down
  std::uint32_t passenger = 0;  ///< from 1, in the order they come
  LiftFault::Kind fault = LiftFault::Kind::light_barrier_blocked;
};

/// Callbacks of these events.
class LiftObserver {
 public:
  virtual void lift_event(const LiftEvent&) {}
  /// While the car or its doors move; `door`: mm that the widest one is open.
  virtual void car_moved(std::uint8_t /*lift*/, double /*position, mm*/, double /*door*/, can::Time) {}

 protected:
  ~LiftObserver() = default;
};

/// The counts of one car.
struct CarCounts {
  std::uint32_t starts = 0;
  std::uint32_t door_cycles = 0;  ///< times a door left its closed position
  std::uint32_t reversals = 0;
  std::uint32_t overloads = 0;  ///< times it was overloaded
  double travelled = 0;         ///< mm
  // Unsafe.
  std::uint32_t door_open_between_floors = 0;
  std::uint32_t door_open_while_moving = 0;
  std::uint32_t overload_travels = 0;
  std::uint32_t overspeeds = 0;

  [[nodiscard]] std::uint32_t unsafe() const {
    return door_open_between_floors + door_open_while_moving + overload_travels + overspeeds;
  }
};

struct LiftReport {
  std::vector<std::uint8_t> lifts{};  ///< numbers
  std::vector<CarCounts> cars{};      ///< of each
  std::uint32_t passengers = 0;       ///< of the whole run
  std::uint32_t came = 0;             ///< so far
  std::uint32_t arrived = 0;
  // From coming to boarding, and from boarding to arriving, of the passengers that have done so.
  can::Duration mean_waiting{}, longest_waiting{};
  can::Duration mean_travel{}, longest_travel{};

  [[nodiscard]] std::uint32_t unsafe() const {
    std::uint32_t sum = 0;
    for (const CarCounts& car : cars) sum += car.unsafe();
    return sum;
  }
};

/// A car at a moment.
struct CarView {
  std::uint8_t lift = 0;   ///< number
  double position = 0;     ///< mm
  double velocity = 0;     ///< mm/s
  double door = 0;         ///< mm that the widest door is open
  std::uint8_t floor = 0;  ///< the nearest one
  std::uint32_t load = 0;  ///< kg
  std::uint32_t riders = 0;
  bool overloaded = false;
};

/// "door open between floors", as in event lines.
[[nodiscard]] const char* name(LiftEvent::Kind kind) noexcept;
/// "light barrier blocked", as in a plant file.
[[nodiscard]] const char* name(LiftFault::Kind kind) noexcept;

}  // namespace canopus::sim::lift
