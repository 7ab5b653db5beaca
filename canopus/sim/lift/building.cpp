#include "canopus/sim/lift/building.hpp"

#include <algorithm>
#include <cmath>

namespace canopus::sim::lift {

namespace {

constexpr can::Duration step = std::chrono::milliseconds(10);
constexpr can::Duration idle_step = std::chrono::milliseconds(40);
constexpr double levelled = 20;            // mm: level enough to get in and out
constexpr double unlocking_zone = 200;     // mm [EN 81-20]
constexpr double pre_opening_speed = 300;  // mm/s: a door may open while the car levels
constexpr double gravity = 9.81;           // m/s^2

}  // namespace

const char* name(LiftEvent::Kind kind) noexcept {
  using enum LiftEvent::Kind;
  switch (kind) {
    case started: return "started";
    case stopped: return "stopped";
    case door_opened: return "door opened";
    case door_closed: return "door closed";
    case door_reversed: return "door reversed";
    case call_registered: return "call registered";
    case call_answered: return "call answered";
    case passenger_came: return "passenger came";
    case passenger_boarded: return "passenger boarded";
    case passenger_stepped_back: return "passenger stepped back";
    case passenger_arrived: return "passenger arrived";
    case fault_began: return "fault began";
    case fault_ended: return "fault ended";
    case door_open_between_floors: return "door open between floors";
    case door_open_while_moving: return "door open while moving";
    case overload_travel: return "overload travel";
    case overspeed: return "overspeed";
  }
  return "";
}

const char* name(LiftFault::Kind kind) noexcept {
  using enum LiftFault::Kind;
  switch (kind) {
    case light_barrier_blocked: return "light barrier blocked";
    case light_barrier_defect: return "light barrier defect";
    case drive_fault: return "drive fault";
    case panel_unplugged: return "panel unplugged";
    case position_lost: return "position lost";
    case overload: return "overload";
  }
  return "";
}

Building::Building(BuildingSettings settings)
    : settings_(std::move(settings)),
      units_(units_of(settings_.lifts, settings_.floor_doors)),
      shown_(units_.size()),
      passengers_(passengers_of(settings_.passengers, settings_.floors.size())),
      fault_states_(settings_.faults.size()) {
  alarm() = can::Time{};
  for (const Unit& unit : units_) {
    if (unit.kind != UnitKind::hall_panel && unit.kind != UnitKind::car_panel) break;
    panels_.emplace_back(unit.floor, unit.lifts, unit.door);
  }
  const unsigned doors = *std::ranges::max_element(settings_.floor_doors) + 1U;
  const DriveSettings drive{settings_.limits, settings_.floors.front(), settings_.floors.back()};
  for (std::size_t i = 0; i < settings_.lifts.size(); ++i) {
    cars_.push_back({.drive = DriveUnit(drive, settings_.floors.front()),
                     .doors = std::vector<DoorUnit>(doors, DoorUnit(settings_.door))});
  }
}

std::size_t Building::panel_number(std::uint8_t floor, std::size_t car) const {
  return floor != 0 ? floor - 1U : settings_.floors.size() + car;
}

const Panel& Building::panel(std::uint8_t floor, std::size_t car) const {
  return panels_[panel_number(floor, car)];
}

std::uint8_t Building::nearest_floor(double position) const {
  const auto nearest = std::ranges::min_element(
      settings_.floors, {}, [position](double level) { return std::abs(level - position); });
  return static_cast<std::uint8_t>(nearest - settings_.floors.begin() + 1);
}

std::optional<std::uint8_t> Building::floor_of(const Car& car, can::Time now) const {
  if (car.drive.moves(now)) return std::nullopt;
  const double position = car.drive.motion(now).position;
  const std::uint8_t floor = nearest_floor(position);
  if (std::abs(settings_.floors[floor - 1U] - position) > levelled) return std::nullopt;
  return floor;
}

double Building::load_of(const Car& car) const {
  return car.load + (car.weights > 0 ? 1.5 * settings_.rated_load : 0.0);
}

bool Building::is_overloaded(const Car& car) const {
  return load_of(car) > settings_.rated_load + std::max(75.0, settings_.rated_load / 10);
}

std::uint8_t Building::load_signal(const Car& car) const {
  constexpr double empty = 15;  // kg
  constexpr unsigned zero_load = 1, norm_load = 2, full_load = 4, overload = 8;
  const double load = load_of(car);
  unsigned signal = load < empty ? zero_load : norm_load;
  if (load >= 0.8 * settings_.rated_load) signal = full_load;
  if (is_overloaded(car)) signal |= overload;
  return static_cast<std::uint8_t>(signal);
}

/// Per mille of the rated torque, upward positive; the counterweight balances the car with half of its rated load.
double Building::effort(const Car& car, can::Time now) const {
  if (car.drive.state() != DriveUnit::State::operation_enabled) return 0;  // the brake holds
  const double half = settings_.rated_load / 2;
  const double mass = 2 * settings_.car_mass + half;
  const double force =
      (load_of(car) - half) * gravity + (mass + load_of(car)) * car.drive.motion(now).acceleration / 1000;
  const double rated = half * gravity + (mass + settings_.rated_load) * settings_.limits.acceleration / 1000;
  return 1000 * force / rated;
}

bool Building::is_blocked(const Car& car, std::size_t door) const {
  if (car.blocked > 0 || car.defective > 0) return true;
  if (!car.transfer) return false;
  const Passenger& passenger = passengers_[car.transfer->passenger];
  const std::uint8_t floor = car.transfer->enters ? passenger.from : passenger.to;
  return settings_.floor_doors[floor - 1U] == door || passenger.steps_back;
}

CarView Building::car(std::size_t number, can::Time now) const {
  const Car& car = cars_[number];
  const MotionState is = car.drive.motion(now);
  CarView view{.lift = settings_.lifts[number],
               .position = is.position,
               .velocity = is.velocity,
               .floor = nearest_floor(is.position),
               .load = static_cast<std::uint32_t>(load_of(car)),
               .overloaded = is_overloaded(car)};
  for (const DoorUnit& door : car.doors) view.door = std::max(view.door, door.position());
  view.riders =
      static_cast<std::uint32_t>(std::ranges::count_if(passengers_, [&](const Passenger& passenger) {
        return passenger.state == Passenger::State::riding && passenger.car == number;
      }));
  return view;
}

void Building::report_event(LiftEvent event) {
  if (observer_ != nullptr) observer_->lift_event(event);
}

void Building::tick(can::Time now) {
  const bool was_idle = deadline() - last_ > step;
  const can::Duration elapsed = was_idle ? std::min<can::Duration>(step, now - last_) : now - last_;
  last_ = now;
  carry_out_faults(now);
  bool moves = false;
  for (std::size_t i = 0; i < cars_.size(); ++i) {
    move_car(i, elapsed, now);
    watch_doors(i, now);
    watch_safety(i, now);
    const Car& car = cars_[i];
    moves = moves || car.moved || car.transfer || std::ranges::any_of(car.doors, [](const DoorUnit& door) {
              return door.moves() || !door.is_closed();
            });
  }
  people(now);
  show_changes(now);
  alarm() = can::later(now, moves ? step : idle_step);
}

void Building::move_car(std::size_t number, can::Duration elapsed, can::Time now) {
  Car& car = cars_[number];
  car.drive.command(car.command, now);
  for (std::size_t door = 0; door < car.doors.size(); ++door)
    car.doors[door].step(elapsed, is_blocked(car, door));
  const bool moves = car.drive.moves(now);
  const CarView view = this->car(number, now);
  if (moves) car.counts.travelled += std::abs(view.velocity) * std::chrono::duration<double>(elapsed).count();
  if (moves != car.moved) {
    car.moved = moves;
    if (moves) ++car.counts.starts;
    report_event({.kind = moves ? LiftEvent::Kind::started : LiftEvent::Kind::stopped,
                  .time = now,
                  .lift = view.lift,
                  .floor = view.floor});
    if (moves && is_overloaded(car)) {
      ++car.counts.overload_travels;
      report_event(
          {.kind = LiftEvent::Kind::overload_travel, .time = now, .lift = view.lift, .floor = view.floor});
    }
  }
  if (is_overloaded(car) && !car.overloaded) ++car.counts.overloads;
  car.overloaded = is_overloaded(car);
  const bool doors_move = std::ranges::any_of(car.doors, [](const DoorUnit& door) { return door.moves(); });
  if (observer_ != nullptr && (moves || doors_move || car.last_change == now - elapsed)) {
    observer_->car_moved(view.lift, view.position, view.door, now);
    if (moves || doors_move) car.last_change = now;
  }
}

void Building::watch_doors(std::size_t number, can::Time now) {
  Car& car = cars_[number];
  std::uint32_t openings = 0, reversals = 0;
  for (std::size_t i = 0; i < car.doors.size(); ++i) {
    const DoorUnit& door = car.doors[i];
    openings += door.openings();
    reversals += door.reversals();
    LiftEvent event{.time = now,
                    .lift = settings_.lifts[number],
                    .floor = nearest_floor(car.drive.motion(now).position),
                    .door = static_cast<std::uint8_t>(i + 1)};
    const auto report_door = [&](LiftEvent::Kind kind) {
      event.kind = kind;
      report_event(event);
    };
    if (door.is_open() && !car.was_open[i]) report_door(LiftEvent::Kind::door_opened);
    if (door.is_closed() && !car.was_closed[i]) report_door(LiftEvent::Kind::door_closed);
    if (door.reversals() != car.reversals[i]) report_door(LiftEvent::Kind::door_reversed);
    car.was_open[i] = door.is_open();
    car.was_closed[i] = door.is_closed();
    car.reversals[i] = door.reversals();
  }
  car.counts.door_cycles = openings;
  car.counts.reversals = reversals;
}

void Building::watch_safety(std::size_t number, can::Time now) {
  Car& car = cars_[number];
  const MotionState is = car.drive.motion(now);
  const std::uint8_t floor = nearest_floor(is.position);
  const bool in_zone = std::abs(settings_.floors[floor - 1U] - is.position) <= unlocking_zone;
  bool any_open = false, at_a_wall = false;
  for (std::size_t i = 0; i < car.doors.size(); ++i) {
    if (car.doors[i].is_closed()) continue;
    any_open = true;
    at_a_wall = at_a_wall || settings_.floor_doors[floor - 1U] != i;
  }
  const auto watch = [&](bool is_now, bool& was, std::uint32_t& count, LiftEvent::Kind kind) {
    if (is_now && !was) {
      ++count;
      report_event({.kind = kind, .time = now, .lift = settings_.lifts[number], .floor = floor});
    }
    was = is_now;
  };
  const bool moves_open = any_open && car.moved && (!in_zone || std::abs(is.velocity) > pre_opening_speed);
  watch(any_open && (!in_zone || at_a_wall), car.open_between, car.counts.door_open_between_floors,
        LiftEvent::Kind::door_open_between_floors);
  watch(moves_open, car.open_moving, car.counts.door_open_while_moving,
        LiftEvent::Kind::door_open_while_moving);
  watch(std::abs(is.velocity) > 1.05 * settings_.limits.speed + 1, car.overspeed, car.counts.overspeeds,
        LiftEvent::Kind::overspeed);
  if (moves_open) car.drive.fail(false, now);  // the safety circuit
}

LiftReport Building::report() const {
  LiftReport report{.lifts = settings_.lifts, .passengers = static_cast<std::uint32_t>(passengers_.size())};
  for (const Car& car : cars_) report.cars.push_back(car.counts);
  can::Duration waiting{}, travel{};
  can::Duration::rep boarded = 0;
  for (const Passenger& passenger : passengers_) {
    if (passenger.state == Passenger::State::not_here) continue;
    ++report.came;
    if (passenger.state == Passenger::State::waiting) continue;
    ++boarded;
    waiting += passenger.boarded - passenger.comes;
    report.longest_waiting = std::max(report.longest_waiting, passenger.boarded - passenger.comes);
    if (passenger.state != Passenger::State::arrived) continue;
    ++report.arrived;
    travel += passenger.arrived - passenger.boarded;
    report.longest_travel = std::max(report.longest_travel, passenger.arrived - passenger.boarded);
  }
  if (boarded > 0) report.mean_waiting = waiting / boarded;
  if (report.arrived > 0) report.mean_travel = travel / static_cast<can::Duration::rep>(report.arrived);
  return report;
}

}  // namespace canopus::sim::lift
