// [[lift]], [lift.doors], [lift.passengers] and [[lift.fault]].

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/sim/lift/lift_report.hpp"
#include "canopus/sim/lift/units.hpp"
#include "canopus/text/table_reader.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::plant {
namespace {

using sim::lift::BuildingSettings;
using sim::lift::LiftFault;

constexpr double mm = 1000;  // of a metre

/// A number within limits, or what it is without one.
double number(text::TableReader& table, std::string_view key, double otherwise, double low, double high,
              std::string_view unit) {
  const bool is_there = table.find(key) != nullptr;
  const auto value = table.number(key);
  if (!is_there || !value) return otherwise;
  if (*value >= low && *value <= high) return *value;
  table.error(key, fmt::format("expected {:g} to {:g}{}", low, high, unit));
  return otherwise;
}

std::vector<std::uint8_t> read_numbers(text::TableReader& table) {
  constexpr std::string_view expected =
      "a lift has a number 1 to 8; for a group of lifts a list of them, each once";
  std::vector<std::uint8_t> numbers;
  table.elements("number", [&](const toml::node& element) {
    const auto* one = element.as_integer();
    const auto value = one != nullptr ? one->get() : 0;
    const auto lift = static_cast<std::uint8_t>(value);
    if (value < 1 || value > static_cast<int>(sim::lift::most_lifts) ||
        std::ranges::count(numbers, lift) != 0) {
      return table.error("number", expected);
    }
    numbers.push_back(lift);
  });
  if (numbers.empty() && !table.is_wrong("number")) {
    if (table.find("number") != nullptr) table.error("number", expected);
    numbers.push_back(1);
  }
  std::ranges::sort(numbers);
  return numbers;
}

/// floors = 8 with floor_height = 3.0, or floors = [0, 4.5, 8.0] in m.
std::vector<double> read_floors(text::TableReader& table) {
  constexpr std::string_view expected =
      "expected the number of floors, 2 to 63, or their levels in m, rising by 2 to 20 each";
  constexpr std::int64_t most_floors = 63;
  const double height = number(table, "floor_height", 3, 2, 20, " m");
  std::vector<double> floors;
  const toml::node* node = table.find("floors");
  const auto wrong = [&] {
    table.error("floors", expected);
    return std::vector<double>{0, 3 * mm};
  };
  if (node == nullptr) return wrong();
  if (const auto* count = node->as_integer()) {
    if (count->get() < 2 || count->get() > most_floors) return wrong();
    for (std::int64_t i = 0; i < count->get(); ++i)
      floors.push_back(std::round(height * mm) * static_cast<double>(i));
    return floors;
  }
  const auto* levels = node->as_array();
  if (levels == nullptr || levels->size() < 2 || levels->size() > static_cast<std::size_t>(most_floors))
    return wrong();
  if (table.place("floor_height") != table.place())
    table.error("floor_height", "has no meaning beside levels of floors");
  for (const toml::node& level : *levels) {
    const auto metres = level.is_number() ? level.value<double>() : std::nullopt;
    if (!metres || !std::isfinite(*metres)) return wrong();
    const double way = floors.empty() ? 2 * mm : std::round(*metres * mm) - floors.back();
    if (std::abs(*metres) > 1000 || way < 2 * mm || way > 20 * mm) return wrong();
    floors.push_back(std::round(*metres * mm));
  }
  return floors;
}

can::Duration duration(text::TableReader& table, std::string_view key, can::Duration otherwise,
                       can::Duration low, can::Duration high, std::string_view expected) {
  const auto value = table.parsed(key, text::parse_duration);
  if (!value) return otherwise;
  if (*value >= low && *value <= high) return *value;
  table.error(key, expected);
  return otherwise;
}

void read_doors(text::TableReader& table, BuildingSettings& building) {
  using namespace std::chrono_literals;
  constexpr std::string_view expected = "a door takes 500ms to 20s";
  building.door.width = number(table, "width", building.door.width, 400, 5000, " mm");
  building.door.open_time = duration(table, "open_time", building.door.open_time, 500ms, 20s, expected);
  building.door.close_time = duration(table, "close_time", building.door.close_time, 500ms, 20s, expected);
  table.elements("rear_floors", [&](const toml::node& element) {
    const auto* floor = element.as_integer();
    if (floor == nullptr || floor->get() < 1 || floor->get() > std::ssize(building.floors)) {
      return table.error(text::place_of(element.source()),
                         fmt::format("rear_floors: found {}, expected floors 1 to {}",
                                     text::describe_found(element), building.floors.size()));
    }
    building.floor_doors[static_cast<std::size_t>(floor->get() - 1)] = 1;
  });
}

void read_passengers(text::TableReader& table, LiftSection& lift) {
  sim::lift::PassengerSettings& people = lift.building.passengers;
  constexpr std::int64_t most = 10'000;
  people.from = table.parsed("from", text::parse_duration).value_or(can::Duration{});
  const auto until = table.parsed("until", text::parse_duration);
  people.until = until.value_or(people.from + people.until);
  if (until && *until <= people.from) {
    table.error("until", fmt::format("must be later than from = {}", text::describe_duration(people.from)));
    people.until = people.from + can::Duration{1};
  }
  const auto count = table.integer("count", 0, most, "expected 0 to 10000 passengers");
  const bool has_rate = table.find("rate") != nullptr;
  const double rate = number(table, "rate", 0, 0, 600, " passengers a minute");
  if (count && has_rate) {
    table.error("rate", "expected count or rate, not both");
  } else if (!count && !has_rate && !table.is_wrong("count")) {
    table.error("count", "expected how many passengers come; or rate, how many a minute");
  }
  const double minutes = std::chrono::duration<double, std::ratio<60>>(people.until - people.from).count();
  const double by_rate = std::round(rate * minutes);
  if (by_rate > static_cast<double>(most)) table.error("rate", "these are more than 10000 passengers");
  people.count =
      static_cast<std::uint32_t>(count.value_or(static_cast<std::int64_t>(std::min<double>(by_rate, most))));
  people.to_main_floor = number(table, "main_floor", people.to_main_floor, 0, 1, "");
  people.holds_doors = number(table, "hold_doors", people.holds_doors, 0, 1, "");
  if (const auto seed = table.integer("seed", 0, INT64_MAX, "a seed is 0 or more")) {
    people.seed = static_cast<std::uint64_t>(*seed);
    lift.own_seed = true;
  }
}

LiftFault read_lift_fault(text::TableReader& table, const BuildingSettings& building) {
  using Kind = LiftFault::Kind;
  static constexpr Kind kinds[] = {Kind::light_barrier_blocked, Kind::light_barrier_defect, Kind::drive_fault,
                                   Kind::panel_unplugged,       Kind::position_lost,        Kind::overload};
  LiftFault fault;
  if (const auto kind = table.text("kind", true)) {
    const auto* known = std::ranges::find_if(kinds, [&](Kind one) { return *kind == sim::lift::name(one); });
    if (known == std::end(kinds)) {
      std::vector<std::string_view> names;
      for (const Kind one : kinds) names.emplace_back(sim::lift::name(one));
      table.error("kind", fmt::format("expected one of {}", fmt::join(names, ", ")));
    } else {
      fault.kind = *known;
    }
  }
  fault.at = can::Time{} + table.parsed("at", text::parse_duration, true).value_or(can::Duration{});
  if (const auto span = table.parsed("for", text::parse_duration)) fault.until = can::later(fault.at, *span);
  const auto lift =
      table.integer("number", 1, sim::lift::most_lifts, "expected the number of a lift of this section");
  if (lift) {
    const auto found = std::ranges::find(building.lifts, static_cast<std::uint8_t>(*lift));
    if (found == building.lifts.end()) {
      table.error("number", fmt::format("expected one of {}", fmt::join(building.lifts, ", ")));
    } else {
      fault.car = static_cast<std::uint8_t>(found - building.lifts.begin());
    }
  }
  const auto floor = table.integer("floor", 1, std::ssize(building.floors),
                                   fmt::format("expected a floor 1 to {}", building.floors.size()));
  if (floor && fault.kind != Kind::panel_unplugged) {
    table.error("floor", "is of a panel that is unplugged; other faults are of a lift: number");
  } else if (floor) {
    if (lift) table.error("number", "is of a car panel; with floor it is the panel of that floor");
    fault.floor = static_cast<std::uint8_t>(*floor);
  }
  return fault;
}

}  // namespace

LiftSection read_lift(text::TableReader& table) {
  LiftSection lift{.place = table.place()};
  BuildingSettings& building = lift.building;
  lift.bus = table.text("bus").value_or("");
  building.lifts = read_numbers(table);
  building.floors = read_floors(table);
  building.floor_doors.assign(building.floors.size(), 0);
  building.limits.speed = mm * number(table, "speed", 1, 0.1, 10, " m/s");
  building.limits.acceleration = mm * number(table, "acceleration", 0.8, 0.1, 3, " m/s^2");
  building.limits.jerk = mm * number(table, "jerk", 1, 0.1, 10, " m/s^3");
  building.car_mass = number(table, "car_mass", 900, 100, 20'000, " kg");
  building.rated_load = number(table, "rated_load", 630, 100, 10'000, " kg");
  table.table("doors", "lift.doors", "expected a table, written as [lift.doors]",
              [&](text::TableReader& inner) { read_doors(inner, building); });
  table.table("passengers", "lift.passengers", "expected a table, written as [lift.passengers]",
              [&](text::TableReader& inner) { read_passengers(inner, lift); });
  table.tables("fault", "lift.fault", [&](text::TableReader& inner) {
    building.faults.push_back(read_lift_fault(inner, building));
  });
  lift.first_node = static_cast<std::uint8_t>(
      table.integer("first_node", 1, 127, "a node-ID is 1 to 127").value_or(lift.first_node));
  const auto units = sim::lift::units_of(building.lifts, building.floor_doors);
  const std::size_t last_panel = lift.first_node + building.floors.size() + building.lifts.size() - 1;
  const std::size_t last = lift.first_node + units.size() - 1;
  if (last_panel > sim::lift::highest_panel) {
    table.error(
        table.place("first_node"),
        fmt::format("lift: its panels have the node-IDs {} to {}; a lift controller receives panels up "
                    "to {}: expected a "
                    "lower first_node",
                    lift.first_node, last_panel, sim::lift::highest_panel));
  } else if (last > 127) {
    table.error(table.place("first_node"),
                fmt::format("lift: its devices have the node-IDs {} to {}; expected a lower first_node",
                            lift.first_node, last));
  }
  return lift;
}

void add_lift(PlantFile& plant, LiftSection lift) {
  const auto units = sim::lift::units_of(lift.building.lifts, lift.building.floor_doors);
  for (std::size_t i = 0; i < units.size(); ++i) {
    plant.devices.push_back({.place = lift.place,
                             .eds_place = lift.place,
                             .store_place = lift.place,
                             .bus = lift.bus,
                             .name = sim::lift::name(units[i]),
                             .node = static_cast<std::uint8_t>(lift.first_node + i),
                             .lift = LiftUnitSection{plant.lifts.size(), i}});
  }
  plant.lifts.push_back(std::move(lift));
}

}  // namespace canopus::plant
