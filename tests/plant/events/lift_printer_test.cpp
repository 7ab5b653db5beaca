// What a run says of lifts.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/plant/event.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/sim/lift/lift_report.hpp"

namespace canopus::plant::lift_printer_test {
namespace {

using namespace std::chrono_literals;
using sim::lift::LiftEvent;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr can::Time at{12'340ms};
constexpr LiftEvent hall_call{
    .kind = LiftEvent::Kind::call_registered, .time = at, .floor = 3, .direction = 2};
constexpr LiftEvent car_call{.kind = LiftEvent::Kind::call_answered, .time = at, .lift = 2, .floor = 5};
constexpr LiftEvent boarded{
    .kind = LiftEvent::Kind::passenger_boarded, .time = at, .lift = 1, .floor = 1, .to = 4, .passenger = 7};
constexpr LiftEvent reversed{
    .kind = LiftEvent::Kind::door_reversed, .time = at, .lift = 1, .floor = 1, .door = 2};
constexpr LiftEvent fault{.kind = LiftEvent::Kind::fault_began,
                          .time = at,
                          .lift = 1,
                          .fault = sim::lift::LiftFault::Kind::position_lost};

RunSummary::LiftCount two_lifts() {
  RunSummary::LiftCount lift{.bus = "hoist", .report = {}};
  lift.report.lifts = {1, 2};
  lift.report.cars = {{.starts = 30, .door_cycles = 28, .reversals = 2, .travelled = 96'000},
                      {.starts = 12, .door_cycles = 11}};
  lift.report.passengers = 20;
  lift.report.came = 19;
  lift.report.arrived = 18;
  lift.report.mean_waiting = 12'345ms;
  lift.report.longest_waiting = 40s;
  lift.report.mean_travel = 9s;
  lift.report.longest_travel = 31s;
  return lift;
}

TEST(LiftPrinter, EachEventIsOneLine) {
  text::TextOutput printed;
  JsonPrinter json(printed);
  for (const LiftEvent& event : {hall_call, car_call, boarded, reversed, fault})
    json.on({event.time, LiftChange{"hoist", event}});
  EXPECT_EQ(
      printed.text(),
      R"({"t":12.34,"event":"lift","bus":"hoist","what":"call registered","floor":3,"call":"down"})"
      "\n"
      R"({"t":12.34,"event":"lift","bus":"hoist","what":"call answered","lift":2,"floor":5,"call":"car"})"
      "\n"
      R"({"t":12.34,"event":"lift","bus":"hoist","what":"passenger boarded","lift":1,"floor":1,"to":4,"passenger":7})"
      "\n"
      R"({"t":12.34,"event":"lift","bus":"hoist","what":"door reversed","lift":1,"floor":1,"door":2})"
      "\n"
      R"({"t":12.34,"event":"lift","bus":"hoist","what":"fault began","lift":1,"fault":"position lost"})"
      "\n");
}

TEST(LiftPrinter, LinesAreForPeople) {
  text::TextOutput printed;
  LinePrinter lines(printed, printed, false);
  for (const LiftEvent& event : {hall_call, car_call, boarded, reversed, fault})
    lines.on({event.time, LiftChange{"hoist", event}});
  EXPECT_EQ(printed.text(),
            "   12.340000  hoist floor 3: call registered: down\n"
            "   12.340000  hoist lift 2 floor 5: call answered: car\n"
            "   12.340000  hoist lift 1 floor 1: passenger boarded: passenger 7 to floor 4\n"
            "   12.340000  hoist lift 1 floor 1: door reversed: door 2\n"
            "   12.340000  hoist lift 1: fault began: position lost\n");
  text::TextOutput nothing;
  LinePrinter quiet(nothing, nothing, true);
  quiet.on({fault.time, LiftChange{"hoist", fault}});
  EXPECT_EQ(nothing.text(), "");
}

TEST(LiftPrinter, Summary) {
  RunSummary::LiftCount lift = two_lifts();
  EXPECT_EQ(describe(lift),
            "hoist lift 1+2: 18 of 20 passengers arrived, waiting 12.3 s (at most 40.0 s), travel 9.0 s (at "
            "most 31.0 s); "
            "42 starts, 39 door cycles");
  lift.report.cars[0].overload_travels = 1;
  EXPECT_THAT(describe(lift), HasSubstr("39 door cycles; UNSAFE 1 time"));
  text::TextOutput printed;
  JsonPrinter json(printed);
  RunSummary summary{.end = at, .virtual_time = true};
  json.summary(summary);
  EXPECT_THAT(printed.text(), Not(HasSubstr("\"lifts\"")));
  summary.lifts.push_back(two_lifts());
  json.summary(summary);
  EXPECT_THAT(
      printed.text(),
      HasSubstr(
          R"("lifts":[{"bus":"hoist","passengers":20,"came":19,"arrived":18,"mean_waiting":12.345,)"
          R"("longest_waiting":40.0,"mean_travel":9.0,"longest_travel":31.0,"cars":[{"lift":1,"starts":30,)"
          R"("door_cycles":28,"door_reversals":2,"overloads":0,"travelled":96.0,"door_open_between_floors":0,)"
          R"("door_open_while_moving":0,"overload_travels":0,"overspeeds":0},{"lift":2,)"));
}

}  // namespace
}  // namespace canopus::plant::lift_printer_test
