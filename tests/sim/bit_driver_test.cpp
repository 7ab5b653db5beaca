// The bit driver: raw levels at exact times against controllers. Expected bits are those of slow_frame.hpp, which knows
// nothing of the program.

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/sim/bus/bus.hpp"

#include "can/slow_frame.hpp"
#include "sim/bus_station.hpp"

namespace canopus::sim::bit_driver_test {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::Frame;
using can::FrameField;
using can::Time;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<DrivenLevel> levels(std::string_view text) {
  auto parsed = parse_levels(text);
  EXPECT_TRUE(parsed.has_value()) << parsed.error();
  return parsed.value_or(std::vector<DrivenLevel>{});
}

struct BitDriverOnBus : ::testing::Test {
  void faults(const std::vector<Fault>& list) {
    const auto set = bus.set_faults(list, 1);
    ASSERT_TRUE(set.has_value()) << set.error();
  }
  static Fault drive_at(Time from, std::string_view text) {
    return {.kind = FaultKind::drive, .from = from, .levels = levels(text)};
  }
  can::Timeline timeline;
  Bus bus{"main", 1'000'000, timeline};
  Station a{bus, timeline, "a"};
  Station b{bus, timeline, "b"};
};

const Frame frame = data_frame(0x123, {0x55});  // 53 bits

TEST(DrivenLevels, OfAText) {
  using enum DrivenLevel;
  EXPECT_THAT(*parse_levels("0 1_R*2\n d r*3"),
              ElementsAre(dominant, released, recessive, recessive, dominant, released, released, released));
}

TEST(DrivenLevels, ThatAreWrong_SayWhere) {
  EXPECT_EQ(parse_levels("01x").error(),
            "character 3: expected 0 (dominant), 1 (released), R (forced recessive), * or blanks");
  EXPECT_EQ(parse_levels("*3").error(), "character 1: a count follows a level, as in 1*11");
  EXPECT_EQ(parse_levels("1*").error(), "character 2: expected a count from 1 after *");
  EXPECT_EQ(parse_levels("1*0").error(), "character 3: expected a count from 1 after *");
  EXPECT_EQ(parse_levels("1*100001").error(), "character 8: more than 100000 levels");
  EXPECT_EQ(parse_levels(" ").error(), "no level in it");
  EXPECT_TRUE(parse_levels("1*100000").has_value());
}

TEST_F(BitDriverOnBus, AFrameOfRawBits_IsReceivedByEverybody) {
  faults({drive_at(Time(100us), can::slow::wire(frame))});
  timeline.run_until(Time(1ms));
  EXPECT_THAT(a.heard, ElementsAre(Heard{frame, Time(153us)}));
  EXPECT_THAT(b.heard, ElementsAre(Heard{frame, Time(153us)}));
}

TEST_F(BitDriverOnBus, AFrameOfRawBitsWithAnotherBitTime_IsNotReceived) {
  Fault fault = drive_at(Time(100us), can::slow::wire(frame));
  fault.bit_time = 1500ns;
  faults({fault});
  timeline.run_until(Time(1ms));
  EXPECT_THAT(a.heard, IsEmpty());
  EXPECT_GT(a.port.counters().errors, 0U);
}

TEST_F(BitDriverOnBus, SixDominantBits_AreAStuffErrorAtTheSixth) {
  faults({drive_at(Time(100us), "0*6")});
  timeline.run_until(Time(1ms));
  EXPECT_EQ(a.port.receive_error_counter(), 1);
  EXPECT_EQ(bus.load(timeline.now()).error_frames, 1U);
}

TEST_F(BitDriverOnBus, FiveDominantBits_AreNoErrorAtOnce) {
  faults({drive_at(Time(100us), "0*5 1*5")});
  timeline.run_until(Time(110us));
  EXPECT_EQ(a.port.counters().errors, 0U);
}

TEST_F(BitDriverOnBus, ForcedRecessive_IsABitErrorOfTheSender) {
  a.send_at(Time(100us), frame);
  faults({drive_at(Time(100us), "1*14 R")});  // r0
  timeline.run_until(Time(1ms));
  EXPECT_EQ(a.port.transmit_error_counter(), 7);  // 8, and the repetition
  EXPECT_THAT(b.frames(), ElementsAre(frame));
}

TEST_F(BitDriverOnBus, Released_LeavesTheWireAsItIs) {
  a.send_at(Time(100us), frame);
  faults({drive_at(Time(50us), "1*500")});
  timeline.run_until(Time(1ms));
  EXPECT_THAT(b.heard, ElementsAre(Heard{frame, Time(153us)}));
  EXPECT_EQ(a.port.counters().errors, 0U);
}

TEST_F(BitDriverOnBus, TheLastBitOfEof_CanBeHitByItsField) {
  faults({{.kind = FaultKind::drive,
           .sender = "a",
           .count = 1,
           .bit = 6,
           .levels = levels("0"),
           .field = FrameField::end_of_frame}});
  a.send_at(Time(100us), frame);
  timeline.run_until(Time(1ms));
  // For the receiver the frame was valid one bit before; the transmitter ends it, too, and both answer with an
  // overload frame. The sender of ISO 11898-1 repeats it.
  EXPECT_GE(b.heard.size(), 1U);
  EXPECT_EQ(b.port.receive_error_counter(), 0);
}

TEST_F(BitDriverOnBus, ABitOfAField_IsCountedFromItsBeginning) {
  faults({{.kind = FaultKind::drive, .count = 1, .bit = 3, .levels = levels("R"), .field = FrameField::dlc}});
  std::vector<std::string> lines;
  struct Log : BusObserver {
    explicit Log(std::vector<std::string>& the_lines) : lines(the_lines) {}
    void frame_completed(const Frame&, Time, Time) override {}
    void errors_reported(std::span<const can::BusErrorReport> reports, Time) override {
      lines.push_back(std::string(can::name(reports[0].field)) + " " + std::to_string(reports[0].bit));
    }
    std::vector<std::string>& lines;
  } log(lines);
  bus.add_observer(log);
  a.send_at(Time(100us), frame);  // RTR 12, IDE 13, r0 14, DLC 15 16 (stuff 17) 18 19
  timeline.run_until(Time(180us));
  ASSERT_FALSE(lines.empty());
  EXPECT_EQ(lines[0], "DLC 18");
  bus.remove_observer(log);
}

TEST_F(BitDriverOnBus, AFrameWithoutTheField_IsNotCounted) {
  faults({{.kind = FaultKind::drive, .count = 1, .levels = levels("R"), .field = FrameField::data}});
  a.send_at(Time(100us), data_frame(0x100));
  a.send_at(Time(400us), frame);
  timeline.run_until(Time(390us));
  EXPECT_EQ(a.port.counters().errors, 0U);
  timeline.run_until(Time(1ms));
  EXPECT_EQ(a.port.counters().errors, 1U);  // its data begin with a 0: recessive is a bit error
}

TEST_F(BitDriverOnBus, OnceItIsOver_TheBusWorksFrameByFrameAgain) {
  faults({drive_at(Time(100us), "0*3 1*20")});
  a.send_at(Time(1ms), frame);
  timeline.run_until(Time(1ms));
  EXPECT_EQ(timeline.next(), Time(1ms) + 53us);
}

TEST_F(BitDriverOnBus, NewFaults_EndIt) {
  faults({drive_at(Time(100us), "0*1000")});
  timeline.run_until(Time(300us));
  faults({});
  a.send_at(Time(1ms), frame);
  timeline.run_until(Time(2ms));
  EXPECT_THAT(b.frames(), ElementsAre(frame));
}

TEST_F(BitDriverOnBus, SeveralDriversAreOneWire) {
  const std::string wire = can::slow::wire(frame);
  std::string even;
  std::string odd;
  for (std::size_t bit = 0; bit < wire.size(); ++bit) {
    even += wire[bit] == '0' && bit % 2 == 0 ? '0' : '1';
    odd += wire[bit] == '0' && bit % 2 == 1 ? '0' : '1';
  }
  faults({drive_at(Time(100us), even), drive_at(Time(100us), odd)});
  timeline.run_until(Time(1ms));
  EXPECT_THAT(b.heard, ElementsAre(Heard{frame, Time(153us)}));
}

TEST_F(BitDriverOnBus, FaultsThatCannotBe_AreRefused) {
  const auto wrong = [this](const Fault& fault) { return bus.set_faults({fault}, 1).error(); };
  EXPECT_EQ(wrong({.kind = FaultKind::drive}), "fault 1 (drive): levels are not 1 to 100000");
  EXPECT_EQ(wrong({.kind = FaultKind::drive, .levels = levels("0"), .field = FrameField::suspend}),
            "fault 1 (drive): field is none of a frame");
  EXPECT_EQ(wrong({.kind = FaultKind::drive, .levels = levels("0"), .bit_time = -1ns}),
            "fault 1 (drive): bit_time is negative");
}

/// Whatever is driven: the run ends, and afterwards the bus carries frames again.
RC_GTEST_PROP(BitDriverProperty, AnyLevelsAgainstAnyTraffic_LeaveABusThatWorks, ()) {
  const auto text = *rc::gen::container<std::string>(rc::gen::elementOf(std::string("0011R")));
  const auto bit_time = *rc::gen::inRange(100, 3000);
  const auto start = *rc::gen::inRange(0, 400);
  can::Timeline timeline;
  Bus bus("main", 1'000'000, timeline);
  Station a(bus, timeline, "a");
  Station b(bus, timeline, "b");
  Station c(bus, timeline, "c");
  Fault fault{.kind = FaultKind::drive, .from = Time(start * 1us), .bit_time = bit_time * 1ns};
  for (const char level : text) {
    fault.levels.push_back(level == '0'   ? DrivenLevel::dominant
                           : level == '1' ? DrivenLevel::released
                                          : DrivenLevel::recessive);
  }
  if (fault.levels.empty()) fault.levels.push_back(DrivenLevel::dominant);
  RC_ASSERT(bus.set_faults({fault}, 1).has_value());
  a.send_at(Time(100us), frame);
  b.send_at(Time(110us), data_frame(0x7FF));
  timeline.run_until(Time(20ms));
  const std::size_t before = c.heard.size();
  a.send_at(Time(20ms), data_frame(0x321, {1, 2, 3}));
  timeline.run_until(Time(21ms));
  RC_ASSERT(c.heard.size() == before + 1);
  RC_ASSERT(c.heard.back().frame == data_frame(0x321, {1, 2, 3}));
  RC_ASSERT(c.heard.back().at ==
            Time(20ms) + 1us * static_cast<int>(can::slow::wire(c.heard.back().frame).size()));
}

}  // namespace
}  // namespace canopus::sim::bit_driver_test
