#include "canopus/plant/events/event_printer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/plant/event.hpp"

namespace canopus::plant::event_printer_test {
namespace {

using namespace std::chrono_literals;

constexpr NodeLabel encoder{"line1", "encoder", 3};
constexpr NodeLabel stranger{"line1", "", 77};
constexpr can::Time at{1'250'000us};

TEST(JsonPrinter, EachEventIsOneLineAsDocumented) {
  text::TextOutput printed;
  JsonPrinter json(printed);
  json.on({at, BootUp{encoder}});
  json.on({at, NmtStateChange{stranger, canopen::NmtState::operational}});
  json.on(
      {at, EmergencySent{
               encoder,
               {.node_id = 3, .code = 0x8130, .error_register = 0x11, .manufacturer = {1, 2, 3, 4, 0xFF}}}});
  json.on({at, SignalChange{"plc1", 'X', 0x10, true}});
  json.on({at, BufferChange{"plc1", 0x30, 10000, 513, false}});
  json.on({at, Failure{"real time", "a \"quote\""}});
  EXPECT_EQ(
      printed.text(),
      R"({"t":1.25,"event":"boot","bus":"line1","node":3,"name":"encoder"})"
      "\n"
      R"({"t":1.25,"event":"nmt","bus":"line1","node":77,"state":"operational"})"
      "\n"
      R"({"t":1.25,"event":"emcy","bus":"line1","node":3,"name":"encoder","code":"8130","register":17,)"
      R"("data":"01020304FF"})"
      "\n"
      R"({"t":1.25,"event":"signal","plc":"plc1","signal":"X10","on":true})"
      "\n"
      R"({"t":1.25,"event":"buffer","plc":"plc1","module":"U3","address":10000,"value":513,"by":"module"})"
      "\n"
      R"({"t":1.25,"event":"error","source":"real time","message":"a \"quote\""})"
      "\n");
}

/// A stuff error that two nodes saw at one moment.
BusErrorEvent stuff_error() {
  BusErrorEvent event{
      .bus = "line1", .error = can::BusError::stuff, .field = can::FrameField::data, .bit = 45};
  event.nodes.push_back({encoder, {.transmitter = true, .transmit_errors = 8}});
  event.nodes.push_back(
      {stranger, {.state = can::ErrorState::error_passive, .transmit_errors = 0, .receive_errors = 130}});
  return event;
}

TEST(JsonPrinter, ABusErrorIsOneLineWithWhoSawIt) {
  text::TextOutput printed;
  JsonPrinter json(printed);
  json.on({at, stuff_error()});
  json.on(
      {at, ControllerChange{
               encoder, {.state = can::ErrorState::error_passive, .warning = true, .transmit_errors = 128}}});
  EXPECT_EQ(printed.text(),
            R"({"t":1.25,"event":"bus error","bus":"line1","error":"stuff","field":"data","bit":45,"nodes":[)"
            R"({"node":3,"name":"encoder","transmitter":true,"tec":8,"rec":0,"state":"error active"},)"
            R"({"node":77,"transmitter":false,"tec":0,"rec":130,"state":"error passive"}]})"
            "\n"
            R"({"t":1.25,"event":"controller","bus":"line1","node":3,"name":"encoder",)"
            R"("state":"error passive","warning":true,"tec":128,"rec":0})"
            "\n");
}

TEST(LinePrinter, OfAController_AreItsStates_AndSingleErrorsAreNone) {
  text::TextOutput printed;
  LinePrinter lines(printed, printed, false);
  lines.on({at, stuff_error()});
  lines.on({at, ControllerChange{
                    encoder, {.state = can::ErrorState::bus_off, .warning = true, .transmit_errors = 256}}});
  lines.on({at, ControllerChange{encoder, {.warning = true, .receive_errors = 96}}});
  EXPECT_EQ(printed.text(),
            "    1.250000  line1 node 3 (encoder): bus-off, TEC 256, REC 0\n"
            "    1.250000  line1 node 3 (encoder): error active (warning), TEC 0, REC 96\n");
  EXPECT_EQ(describe(stuff_error()), "stuff error in data, bit 45, seen by encoder (sending), node 77");
}

TEST(JsonPrinter, ANameThatIsNotUtf8DoesNotBreakTheLine) {
  text::TextOutput printed;
  JsonPrinter json(printed);
  json.on({at, BootUp{{"line1", "Ger\xE4t", 3}}});
  EXPECT_EQ(printed.text(),
            "{\"t\":1.25,\"event\":\"boot\",\"bus\":\"line1\",\"node\":3,\"name\":\"Ger\xEF\xBF\xBDt\"}\n");
}

TEST(LinePrinter, LinesAreForPeople) {
  text::TextOutput printed;
  LinePrinter lines(printed, printed, false);
  lines.on({at, BootUp{encoder}});
  lines.on({at, SignalChange{"plc1", 'Y', 0x02, false}});
  lines.on({at, BufferChange{"plc1", 0, 13000, 65535, true}});
  EXPECT_EQ(printed.text(),
            "    1.250000  line1 node 3 (encoder): boot-up\n"
            "    1.250000  plc1 Y02 OFF\n"
            "    1.250000  plc1 U0\\G13000 = 65535 (FFFFH) written by the CPU\n");
}

TEST(LinePrinter, QuietMeansNothing) {
  text::TextOutput printed;
  LinePrinter lines(printed, printed, true);
  lines.on({at, BootUp{encoder}});
  lines.on({at, NmtStateChange{encoder, canopen::NmtState::stopped}});
  lines.summary({});
  EXPECT_EQ(printed.text(), "");
}

TEST(Summary, SaysWhoIsNotOperational) {
  RunSummary summary{.end = can::Time{10s}, .wall = 100ms, .virtual_time = true};
  summary.nodes.push_back(
      {.state = canopen::NmtState::operational, .is_on = true, .pdos = 5, .label = encoder});
  summary.nodes.push_back({.state = canopen::NmtState::stopped, .is_on = true, .label = stranger});
  EXPECT_THAT(describe(summary),
              testing::ElementsAre("ran 10.000 s of plant time in 100.0 ms, 100 times as fast as real time",
                                   "line1 node 3 (encoder): operational, 5 PDOs sent",
                                   "line1 node 77: stopped, 0 PDOs sent", "1 of 2 nodes operational"));
}

TEST(Summary, ASpeedBelowTenTimes_HasADecimal) {
  const auto speed = [](can::Duration wall) {
    return describe(RunSummary{.end = can::Time{10s}, .wall = wall, .virtual_time = true}).front();
  };
  EXPECT_EQ(speed(40s), "ran 10.000 s of plant time in 40.000 s, 0.2 times as fast as real time");
  EXPECT_EQ(speed(10s), "ran 10.000 s of plant time in 10.000 s, 1.0 times as fast as real time");
  EXPECT_EQ(speed(1s), "ran 10.000 s of plant time in 1.000 s, 10 times as fast as real time");
}

}  // namespace
}  // namespace canopus::plant::event_printer_test
