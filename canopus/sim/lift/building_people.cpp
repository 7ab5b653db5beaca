// The people of a building: they press buttons, get in and out, hold doors, and step back out of an overloaded car.

#include <algorithm>

#include "canopus/sim/lift/building.hpp"

namespace canopus::sim::lift {

namespace {

constexpr can::Duration transfer_time = std::chrono::milliseconds(1000);  // through the doorway
constexpr can::Duration notices_overload = std::chrono::seconds(2);
constexpr can::Duration patience = std::chrono::seconds(4);  // presses again when the lamp is not on

std::uint8_t direction_of(const Passenger& passenger) { return passenger.to > passenger.from ? up : down; }

}  // namespace

void Building::people(can::Time now) {
  while (coming_ < passengers_.size() && passengers_[coming_].comes <= now) {
    Passenger& passenger = passengers_[coming_++];
    passenger.state = Passenger::State::waiting;
    report_event({.kind = LiftEvent::Kind::passenger_came,
                  .time = now,
                  .floor = passenger.from,
                  .to = passenger.to,
                  .passenger = static_cast<std::uint32_t>(coming_)});
  }
  for (std::size_t car = 0; car < cars_.size(); ++car) board_and_leave(car, now);
  while (present_ < coming_ && passengers_[present_].state == Passenger::State::arrived) ++present_;
  for (std::size_t i = present_; i < coming_; ++i) press_buttons(i, now);
}

/// Would get into this car, which stands open there.
bool Building::can_board(const Passenger& passenger, std::size_t car, std::uint8_t floor) const {
  if (passenger.state != Passenger::State::waiting || passenger.from != floor || passenger.steps_back)
    return false;
  const std::uint8_t lantern = panel(floor).lantern(settings_.lifts[car] - 1U);
  return lantern == 0 || (lantern & direction_of(passenger)) != 0;
}

void Building::end_transfer(std::size_t number, can::Time now) {
  Car& car = cars_[number];
  const Transfer transfer = *car.transfer;
  car.transfer.reset();
  Passenger& passenger = passengers_[transfer.passenger];
  LiftEvent event{.time = now,
                  .lift = settings_.lifts[number],
                  .floor = nearest_floor(car.drive.motion(now).position),
                  .to = passenger.to,
                  .passenger = static_cast<std::uint32_t>(transfer.passenger + 1)};
  if (transfer.enters) {
    passenger.state = Passenger::State::riding;
    passenger.car = static_cast<std::uint8_t>(number);
    passenger.holds = {};
    passenger.boarded = now;
    passenger.next_press = now + std::chrono::milliseconds(300);
    car.load += passenger.mass;
    event.kind = LiftEvent::Kind::passenger_boarded;
  } else {
    car.load -= passenger.mass;
    if (passenger.steps_back) {
      passenger.state = Passenger::State::waiting;
      passenger.next_press = now + patience;
      event.kind = LiftEvent::Kind::passenger_stepped_back;
    } else {
      passenger.state = Passenger::State::arrived;
      passenger.arrived = now;
      event.kind = LiftEvent::Kind::passenger_arrived;
    }
  }
  report_event(event);
}

void Building::board_and_leave(std::size_t number, can::Time now) {
  Car& car = cars_[number];
  if (car.transfer && car.transfer->end <= now) end_transfer(number, now);
  if (car.transfer) return;
  const auto floor = floor_of(car, now);
  // A person who stepped back out of it presses again when it has gone.
  for (std::size_t i = present_; i < coming_; ++i) {
    Passenger& passenger = passengers_[i];
    if (passenger.state == Passenger::State::waiting && passenger.car == number && floor != passenger.from)
      passenger.steps_back = false;
  }
  if (!floor || !car.doors[settings_.floor_doors[*floor - 1U]].is_passable()) return;
  const auto pass = [&](std::size_t index, bool enters) {
    car.transfer =
        Transfer{index, enters, now + transfer_time + (enters ? passengers_[index].holds : can::Duration{})};
  };
  for (std::size_t i = present_; i < coming_; ++i) {
    const Passenger& passenger = passengers_[i];
    if (passenger.state == Passenger::State::riding && passenger.car == number && passenger.to == *floor)
      return pass(i, false);
  }
  if (is_overloaded(car)) {
    std::optional<std::size_t> last;
    for (std::size_t i = present_; i < coming_; ++i) {
      const Passenger& rider = passengers_[i];
      if (rider.state != Passenger::State::riding || rider.car != number) continue;
      if (!last || rider.boarded > passengers_[*last].boarded) last = i;
    }
    if (!last || now < passengers_[*last].boarded + notices_overload) return;
    passengers_[*last].steps_back = true;
    passengers_[*last].from = *floor;
    return pass(*last, false);
  }
  for (std::size_t i = present_; i < coming_; ++i) {
    if (!can_board(passengers_[i], number, *floor)) continue;
    const bool passes_elsewhere = std::ranges::any_of(
        cars_, [i](const Car& other) { return other.transfer && other.transfer->passenger == i; });
    if (!passes_elsewhere) return pass(i, true);
  }
}

void Building::press_buttons(std::size_t index, can::Time now) {
  Passenger& passenger = passengers_[index];
  if (passenger.next_press > now) return;
  if (passenger.state == Passenger::State::riding) {
    const Car& car = cars_[passenger.car];
    const DoorUnit& door = car.doors[settings_.floor_doors[passenger.to - 1U]];
    if (floor_of(car, now) == passenger.to && (door.is_passable() || door.moves())) return;
    Panel& panel = panels_[panel_number(0, passenger.car)];
    if (!panel.is_lit(passenger.to)) panel.press(car_call, passenger.to, now);
    passenger.next_press = now + patience;
  } else if (passenger.state == Passenger::State::waiting && !passenger.steps_back) {
    for (std::size_t number = 0; number < cars_.size(); ++number) {
      const Car& car = cars_[number];
      const DoorUnit& door = car.doors[settings_.floor_doors[passenger.from - 1U]];
      if (floor_of(car, now) == passenger.from && door.is_passable() &&
          can_board(passenger, number, passenger.from))
        return;
    }
    Panel& panel = panels_[panel_number(passenger.from, 0)];
    if (!panel.is_lit(direction_of(passenger))) panel.press(hall_call, direction_of(passenger), now);
    passenger.next_press = now + patience;
  }
}

}  // namespace canopus::sim::lift
