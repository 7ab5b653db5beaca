// Events of lifts, as lines, and their summary at the end of a run.

#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/sim/lift/lift_report.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::plant {

using Json = text::Json;
using sim::lift::CarCounts;
using sim::lift::LiftEvent;

namespace {

double rounded_seconds(can::Duration span) {
  return static_cast<double>(span / std::chrono::milliseconds(1)) / 1e3;
}

bool is_fault(LiftEvent::Kind kind) {
  return kind == LiftEvent::Kind::fault_began || kind == LiftEvent::Kind::fault_ended;
}

bool is_call(LiftEvent::Kind kind) {
  return kind == LiftEvent::Kind::call_registered || kind == LiftEvent::Kind::call_answered;
}

std::string_view call_name(std::uint8_t direction) {
  constexpr std::uint8_t up = 1;
  return direction == 0 ? "car" : direction == up ? "up" : "down";
}

}  // namespace

void JsonPrinter::add(const LiftChange& change, can::Time) {
  const LiftEvent& event = change.event;
  Json line{{"t", event_seconds(event.time)}, {"event", "lift"}};
  line["bus"] = change.bus;
  line["what"] = sim::lift::name(event.kind);
  if (event.lift != 0) line["lift"] = event.lift;
  if (event.floor != 0) line["floor"] = event.floor;
  if (event.to != 0) line["to"] = event.to;
  if (event.door != 0) line["door"] = event.door;
  if (is_call(event.kind)) line["call"] = call_name(event.direction);
  if (event.passenger != 0) line["passenger"] = event.passenger;
  if (is_fault(event.kind)) line["fault"] = sim::lift::name(event.fault);
  print(line, event.time);
}

void LinePrinter::add(const LiftChange& change, can::Time) {
  if (quiet_) return;
  const LiftEvent& event = change.event;
  std::string text(change.bus);
  if (event.lift != 0) text += fmt::format(" lift {}", event.lift);
  if (event.floor != 0) text += fmt::format(" floor {}", event.floor);
  text += fmt::format(": {}", sim::lift::name(event.kind));
  if (is_call(event.kind)) text += fmt::format(": {}", call_name(event.direction));
  if (event.passenger != 0) text += fmt::format(": passenger {} to floor {}", event.passenger, event.to);
  if (event.door > 1) text += fmt::format(": door {}", event.door);
  if (is_fault(event.kind)) text += fmt::format(": {}", sim::lift::name(event.fault));
  line(event.time, text);
}

void JsonPrinter::add_lifts(Json& summary, const std::vector<RunSummary::LiftCount>& lifts) {
  if (lifts.empty()) return;
  summary["lifts"] = Json::array();
  for (const RunSummary::LiftCount& lift : lifts) {
    const sim::lift::LiftReport& report = lift.report;
    Json group{{"bus", lift.bus},
               {"passengers", report.passengers},
               {"came", report.came},
               {"arrived", report.arrived},
               {"mean_waiting", rounded_seconds(report.mean_waiting)},
               {"longest_waiting", rounded_seconds(report.longest_waiting)},
               {"mean_travel", rounded_seconds(report.mean_travel)},
               {"longest_travel", rounded_seconds(report.longest_travel)}};
    group["cars"] = Json::array();
    for (std::size_t i = 0; i < report.cars.size(); ++i) {
      const CarCounts& car = report.cars[i];
      group["cars"].push_back({{"lift", report.lifts[i]},
                               {"starts", car.starts},
                               {"door_cycles", car.door_cycles},
                               {"door_reversals", car.reversals},
                               {"overloads", car.overloads},
                               {"travelled", car.travelled / 1000},
                               {"door_open_between_floors", car.door_open_between_floors},
                               {"door_open_while_moving", car.door_open_while_moving},
                               {"overload_travels", car.overload_travels},
                               {"overspeeds", car.overspeeds}});
    }
    summary["lifts"].push_back(std::move(group));
  }
}

std::string describe(const RunSummary::LiftCount& lift) {
  const sim::lift::LiftReport& report = lift.report;
  std::uint32_t starts = 0, cycles = 0;
  for (const CarCounts& car : report.cars) {
    starts += car.starts;
    cycles += car.door_cycles;
  }
  std::string text = fmt::format("{} lift {}: ", lift.bus, fmt::join(report.lifts, "+"));
  if (report.passengers != 0) {
    text += fmt::format(
        "{} of {} passengers arrived, waiting {:.1f} s (at most {:.1f} s), travel {:.1f} s (at most {:.1f} "
        "s); ",
        report.arrived, report.passengers, rounded_seconds(report.mean_waiting),
        rounded_seconds(report.longest_waiting), rounded_seconds(report.mean_travel),
        rounded_seconds(report.longest_travel));
  }
  text += fmt::format("{} starts, {} door cycles", starts, cycles);
  if (const std::uint32_t unsafe = report.unsafe(); unsafe != 0) {
    text += "; UNSAFE " + ascii::counted(unsafe, "time");
  }
  return text;
}

}  // namespace canopus::plant
