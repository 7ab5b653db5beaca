// Errors as the bus reports them: place in the frame, who saw them, what they did to the counters.

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/can/error_frame.hpp"
#include "canopus/sim/bus/bus.hpp"

#include "sim/bus_station.hpp"

namespace canopus::sim::bus_error_report_test {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::ErrorState;
using can::FrameField;
using can::Time;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// "3: b stuff ID.28-21 5, REC 1": a call for each moment, its number first.
struct ReportLog : BusObserver {
  void frame_completed(const can::Frame&, Time, Time) override {}
  void errors_reported(std::span<const can::BusErrorReport> reports, Time) override {
    ++calls;
    for (const can::BusErrorReport& report : reports) {
      lines.push_back(std::to_string(calls) + ": " + report.port->name() +
                      (report.transmitter ? " sending " : " ") + std::string(can::name(report.error)) + " " +
                      std::string(can::name(report.field)) + " " + std::to_string(report.bit) +
                      (report.dominant ? " d " : " r ") + std::to_string(report.transmit_errors) + "/" +
                      std::to_string(report.receive_errors) + (report.first ? " first" : ""));
      all.push_back(report);
    }
  }
  void controller_changed(const can::ControllerReport& report, Time) override {
    states.push_back(report.port->name() + " " + std::string(can::name(report.before)) + " -> " +
                     std::string(can::name(report.state)) + (report.warning ? " warning " : " ") +
                     std::to_string(report.transmit_errors) + "/" + std::to_string(report.receive_errors));
  }
  unsigned calls = 0;
  std::vector<std::string> lines;
  std::vector<std::string> states;
  std::vector<can::BusErrorReport> all;
};

struct ErrorReports : ::testing::Test {
  ErrorReports() { bus.add_observer(log); }
  void faults(std::vector<Fault> list) { ASSERT_TRUE(bus.set_faults(list, 1).has_value()); }

  can::Timeline timeline;
  Bus bus{"main", 1'000'000, timeline};
  ReportLog log;
  Station a{bus, timeline, "a"};
  Station b{bus, timeline, "b"};
  Station c{bus, timeline, "c"};
};

// 0 00100100011 0 0 0 00(1)01 01010101 010001101100011 1 1 1 1111111
// 0 1        11 12 .. 15   19 20    27 28           42 43 44 45 46..52
const can::Frame frame_of_53_bits = data_frame(0x123, {0x55});
const can::Frame all_dominant = data_frame(0x000);

TEST_F(ErrorReports, OfAStuffErrorOfOneReceiver_AreOneForEachMomentAndWhoSawIt) {
  faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "b", .bit = 5}});
  a.port.send(all_dominant);
  timeline.run_until(Time(28us));
  EXPECT_THAT(log.lines, ElementsAre("1: b stuff ID.28-21 5 d 0/1 first",
                                     "2: a sending stuff ID.20-18 11 d 0/0", "2: c stuff ID.20-18 11 d 0/1"));
}

TEST_F(ErrorReports, NameTheFieldOfEachBitOfAFrame) {
  const std::vector<std::pair<unsigned, const char*>> bits{
      {0, "SOF"},       {1, "ID.28-21"},       {8, "ID.28-21"},
      {9, "ID.20-18"},  {12, "RTR"},           {13, "IDE"},
      {14, "r0"},       {15, "DLC"},           {17, "DLC"},
      {19, "DLC"},      {20, "data"},          {27, "data"},
      {28, "CRC"},      {42, "CRC"},           {43, "CRC delimiter"},
      {44, "ACK slot"}, {45, "ACK delimiter"}, {46, "EOF"},
      {51, "EOF"}};
  for (const auto& [bit, field] : bits) {
    can::Timeline clock;
    Bus one("one", 1'000'000, clock);
    ReportLog reports;
    one.add_observer(reports);
    Station sender(one, clock, "sender");
    Station hearer(one, clock, "hearer");
    ASSERT_TRUE(
        one.set_faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "sender", .bit = bit}}, 1));
    sender.port.send(frame_of_53_bits);
    clock.run_until(Time(80us));
    ASSERT_FALSE(reports.all.empty()) << bit;
    EXPECT_EQ(can::name(reports.all[0].field), field) << bit;
    EXPECT_EQ(reports.all[0].bit, bit);
  }
}

TEST_F(ErrorReports, NameTheFieldsOfAnExtendedFrame) {
  // 0 01010101010 1 1 01010 10101010 10101 0 0 0 0001 ...: no stuff bit before the data.
  const can::Frame frame{
      .identifier = 0x2AAu << 18 | 0b010101010101010101u, .extended = true, .dlc = 1, .data = {0x55}};
  const std::vector<std::pair<unsigned, const char*>> bits{
      {12, "RTR"},     {13, "IDE"},    {14, "ID.17-13"}, {18, "ID.17-13"},       {19, "ID.12-5"},
      {26, "ID.12-5"}, {27, "ID.4-0"}, {31, "ID.4-0"},   {32, "RTR (extended)"}, {33, "r1"},
      {34, "r0"}};
  for (const auto& [bit, field] : bits) {
    const auto begin = field_begin(frame, [&] {
      FrameField found{};
      EXPECT_TRUE(can::field_of(field, found));
      return found;
    }());
    ASSERT_TRUE(begin.has_value()) << field;
    EXPECT_LE(*begin, bit) << field;
  }
  EXPECT_EQ(field_begin(frame, FrameField::identifier_17_13), 14U);
  EXPECT_EQ(field_begin(frame, FrameField::identifier_12_5), 19U);
  EXPECT_EQ(field_begin(frame, FrameField::identifier_4_0), 27U);
  EXPECT_EQ(field_begin(frame, FrameField::extended_rtr), 32U);
  EXPECT_EQ(field_begin(frame, FrameField::r1), 33U);
  EXPECT_EQ(field_begin(frame, FrameField::r0), 34U);
}

TEST_F(ErrorReports, OfAControllerThatIsAlone_SayItsWayToErrorPassive) {
  b.port.plug(false);
  c.port.plug(false);
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(5ms));
  ASSERT_GE(log.lines.size(), 17U);
  EXPECT_EQ(log.lines[0], "1: a sending acknowledgement ACK slot 44 r 8/0 first");
  EXPECT_EQ(log.lines[15], "16: a sending acknowledgement ACK slot 44 r 128/0 first");
  EXPECT_EQ(log.lines[16], "17: a sending acknowledgement ACK slot 44 r 128/0 first");
  EXPECT_THAT(log.states, ElementsAre("a error active -> error active warning 96/0",
                                      "a error active -> error passive warning 128/0"));
}

TEST_F(ErrorReports, SayBusOffAndTheWayBack) {
  faults({{.kind = FaultKind::corrupt, .sender = "a", .count = 40, .receiver = "a", .bit = 20}});
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(20ms));
  EXPECT_THAT(log.states, ::testing::Contains("a error passive -> bus-off warning 256/0"));
  EXPECT_THAT(log.states, ::testing::Contains("a bus-off -> error active 0/0"));
}

TEST(FrameFields, AreFoundByTheirNames) {
  for (unsigned number = 1; number < can::frame_fields; ++number) {
    FrameField field{};
    const auto wanted = static_cast<FrameField>(number);
    EXPECT_TRUE(can::field_of(can::name(wanted), field)) << number;
    EXPECT_EQ(field, wanted);
  }
  FrameField field{};
  EXPECT_FALSE(can::field_of("idle", field));
  EXPECT_FALSE(can::field_of("", field));
}

TEST_F(ErrorReports, AStuffBitBelongsToTheFieldBeforeIt) {
  // The stuff bit 17 of frame_of_53_bits lies within the DLC; bit 5 of all_dominant within the identifier.
  faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "b", .bit = 11}});
  a.port.send(all_dominant);  // stuff bit after bit 8 of the identifier's first eight and two more
  timeline.run_until(Time(28us));
  ASSERT_FALSE(log.lines.empty());
  EXPECT_EQ(log.lines[0], "1: b stuff ID.20-18 11 d 0/1 first");
}

TEST_F(ErrorReports, AreNoneWhereNothingIsWrong) {
  a.port.send(frame_of_53_bits);
  b.port.send(data_frame(0x7FF, {1, 2, 3}));
  timeline.run_until(Time(5ms));
  EXPECT_THAT(log.lines, IsEmpty());
  EXPECT_THAT(log.states, IsEmpty());
}

}  // namespace
}  // namespace canopus::sim::bus_error_report_test
