#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/sim/bus/bus.hpp"

#include "sim/bus_station.hpp"

namespace canopus::sim::bus_faults_test {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::ErrorState;
using can::Frame;
using can::Time;

using Frames = std::vector<Frame>;

struct BusFaults : ::testing::Test {
  void faults(const std::vector<Fault>& list, std::uint64_t seed = 1) {
    const auto set = bus.set_faults(list, seed);
    ASSERT_TRUE(set.has_value()) << set.error();
  }
  std::string refusal(const Fault& fault) {
    const auto set = bus.set_faults({{.kind = FaultKind::drop}, fault}, 1);
    return set.has_value() ? "" : set.error();
  }

  can::Timeline timeline;
  Bus bus{"main", 1'000'000, timeline};
  Station a{bus, timeline, "a"};
  Station b{bus, timeline, "b"};
  Station c{bus, timeline, "c"};
};

Frame numbered(std::uint8_t number) { return data_frame(0x180, {number}); }

void send_numbered(Station& station, int count) {
  for (int number = 1; number <= count; ++number) {
    station.send_at(Time(number * 1ms), numbered(static_cast<std::uint8_t>(number)));
  }
}

TEST_F(BusFaults, Drop_LosesTheFrameInItsReceiversThoughItIsAcknowledged) {
  faults({{.kind = FaultKind::drop, .first = 2, .every = 3, .count = 2}});
  send_numbered(a, 10);
  timeline.run_until(Time(1s));
  EXPECT_EQ(b.frames(), (Frames{numbered(1), numbered(3), numbered(4), numbered(6), numbered(7), numbered(8),
                                numbered(9), numbered(10)}));
  EXPECT_EQ(a.sent.size(), 10U);
  EXPECT_EQ(a.port.transmit_error_counter(), 0);
}

TEST_F(BusFaults, Drop_AtOneReceiver_LeavesTheOthersTheirs) {
  faults({{.kind = FaultKind::drop, .first = 1, .count = 1, .receiver = "b"}});
  send_numbered(a, 2);
  timeline.run_until(Time(1s));
  EXPECT_EQ(b.frames(), (Frames{numbered(2)}));
  EXPECT_EQ(c.frames(), (Frames{numbered(1), numbered(2)}));
}

struct NeedsBits final : WireObserver {
  void level_changed(bool, Time) override {}
  void transmit_changed(const Port&, bool, Time) override {}
  void activity_changed(const Port&, bool, bool, Time) override {}
};

TEST_F(BusFaults, TheFirstOnesOfABusThatWasWatched_LeaveNothingDueInThePast) {
  NeedsBits bits;
  timeline.run_until(Time(1s));
  bus.add_observer(bits);
  timeline.run_until(Time(100s));
  faults({{.kind = FaultKind::drop}});
  EXPECT_GE(timeline.next(), timeline.now());
  bus.remove_observer(bits);
}

TEST_F(BusFaults, FrameRules_MatchIdentifierSenderAndTime) {
  faults({{.kind = FaultKind::drop, .from = Time(2ms), .until = Time(4ms), .sender = "a"},
          {.kind = FaultKind::drop, .identifier = 0x181}});
  send_numbered(a, 5);
  b.send_at(Time(2'500us), data_frame(0x180, {0xBB}));
  b.send_at(Time(9ms), data_frame(0x181));
  b.send_at(Time(10ms), {.identifier = 0x181, .extended = true});
  timeline.run_until(Time(1s));
  EXPECT_EQ(c.frames(), (Frames{numbered(1),
                                data_frame(0x180, {0xBB}),
                                numbered(4),
                                numbered(5),
                                {.identifier = 0x181, .extended = true}}));
}

TEST_F(BusFaults, Corrupt_CostsAnErrorFrameAndTheFrameIsRepeated) {
  faults({{.kind = FaultKind::corrupt, .first = 2, .count = 1, .bit = 24}});
  send_numbered(a, 3);
  timeline.run_until(Time(1s));
  EXPECT_EQ(b.frames(), (Frames{numbered(1), numbered(2), numbered(3)}));
  EXPECT_EQ(a.port.counters().errors, 1U);
  EXPECT_EQ(a.port.transmit_error_counter(), 6);  // 8, and two frames since
}

/// The moments at which the level of the wire changes; the first one is to dominant.
struct Edges final : WireObserver {
  void level_changed(bool, Time now) override { at.push_back(now); }
  void transmit_changed(const Port&, bool, Time) override {}
  void activity_changed(const Port&, bool, bool, Time) override {}
  std::vector<Time> at;
};

/// A dominant bit is seen as recessive by its sender, which finds an error at its sample point.
TEST_F(BusFaults, Corrupt_LastsToTheEndOfItsBitWhateverHappensOnTheBusMeanwhile) {
  faults({{.kind = FaultKind::corrupt, .count = 1, .bit = 1}});
  Edges edges;
  bus.add_observer(static_cast<WireObserver&>(edges));
  a.send_at(Time(100us), data_frame(0));
  timeline.run_until(Time(101'900ns));
  c.port.restart(1'000'000);
  timeline.run_until(Time(103us));
  EXPECT_EQ(edges.at, (std::vector<Time>{Time(100us), Time(101us), Time(102us)}));
}

struct Errors final : BusObserver {
  void frame_completed(const Frame&, Time, Time) override {}
  void error_detected(const Port& port, BusError error, Time now) override {
    all.push_back(port.name() + " " + std::string(can::name(error)) + " at " +
                  std::to_string(now.time_since_epoch().count()));
  }
  std::vector<std::string> all;
};

/// A fault inverts the SOF, and its sender is unplugged as it begins: the bit is dominant, as nothing is driven. Returns the errors
/// that the other stations find in what they take for a frame.
std::vector<std::string> errors_of_a_corrupted_start_of_frame(unsigned receivers, bool is_watched) {
  can::Timeline timeline;
  Bus bus("main", 1'000'000, timeline);
  Station sender(bus, timeline, "sender");
  std::vector<std::unique_ptr<Station>> others;
  for (unsigned number = 0; number < receivers; ++number)
    others.push_back(std::make_unique<Station>(bus, timeline, std::to_string(number)));
  Errors errors;
  NeedsBits bits;
  bus.add_observer(static_cast<BusObserver&>(errors));
  if (is_watched) bus.add_observer(bits);
  EXPECT_TRUE(bus.set_faults({{.kind = FaultKind::corrupt, .count = 1, .bit = 0}}, 1).has_value());
  sender.send_at(Time(100us), data_frame(0x100));
  timeline.run_until(Time(100us));
  sender.port.plug(false);
  timeline.run_until(Time(1ms));
  if (is_watched) bus.remove_observer(bits);
  return errors.all;
}

// Six recessive bits behind it are an error of stuffing, at the sample point of the sixth.
TEST_F(BusFaults, Corrupt_OfAStartOfFrameWhoseSenderIsUnplugged_IsAStartOfFrameForTheOthers) {
  const std::vector<std::string> of_one = {"0 stuff at 106875"};
  EXPECT_EQ(errors_of_a_corrupted_start_of_frame(1, false), of_one);
  EXPECT_EQ(errors_of_a_corrupted_start_of_frame(1, true), of_one);
  const std::vector<std::string> of_two = {"0 stuff at 106875", "1 stuff at 106875"};
  EXPECT_EQ(errors_of_a_corrupted_start_of_frame(2, false), of_two);
  EXPECT_EQ(errors_of_a_corrupted_start_of_frame(2, true), of_two);
}

/// A dominant level that one station alone sees in the second bit of the intermission makes it send an overload flag, which the
/// others take for a SOF. Returns what a station hears of two frames of c and one of b, and when.
std::vector<Heard> heard_behind_an_intermission_with_a_fault(bool is_watched) {
  can::Timeline timeline;
  Bus bus("main", 1'000'000, timeline);
  Station a(bus, timeline, "a");
  Station b(bus, timeline, "b");
  Station c(bus, timeline, "c");
  NeedsBits bits;
  if (is_watched) bus.add_observer(bits);
  const unsigned length = can::frame_bits(data_frame(0x42));
  EXPECT_TRUE(
      bus.set_faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "b", .bit = length + 1}}, 1)
          .has_value());
  b.send_at(Time(100us), data_frame(0x100));
  c.send_at(Time(100us), data_frame(0x42));
  c.send_at(Time(100us), data_frame(0x43));
  timeline.run_until(Time(100us) + length * 1us + 5'500ns);
  a.port.restart(1'000'000);
  timeline.run_until(Time(2ms));
  if (is_watched) bus.remove_observer(bits);
  return a.heard;
}

TEST_F(BusFaults, AStationThatHasLostArbitration_TakesNoPartInAFrameThatBeginsInTheIntermission) {
  const std::vector<Heard> heard = heard_behind_an_intermission_with_a_fault(false);
  EXPECT_EQ(heard.size(), 3U);
  EXPECT_EQ(heard, heard_behind_an_intermission_with_a_fault(true));
}

TEST_F(BusFaults, NewFaults_EndACorruptionAtOnce) {
  faults({{.kind = FaultKind::corrupt, .count = 1, .bit = 1}});
  Edges edges;
  bus.add_observer(static_cast<WireObserver&>(edges));
  a.send_at(Time(100us), data_frame(0));
  timeline.run_until(Time(101'300ns));
  faults({});
  timeline.run_until(Time(103us));
  EXPECT_EQ(edges.at, (std::vector<Time>{Time(100us), Time(101us), Time(101'300ns)}));
}

TEST_F(BusFaults, Corrupt_OfAnyBit_NeverLosesOrChangesAFrame) {
  // The last bit of EOF duplicates the frame, every other one has it repeated.
  faults({{.kind = FaultKind::corrupt, .every = 10}}, 77);
  send_numbered(a, 250);
  timeline.run_until(Time(1s));
  std::vector<Frame> once = b.frames();
  once.erase(std::unique(once.begin(), once.end()), once.end());
  ASSERT_EQ(once.size(), 250U);
  for (std::size_t number = 0; number < once.size(); ++number) {
    EXPECT_EQ(once[number], numbered(static_cast<std::uint8_t>(number + 1)));
  }
  EXPECT_GE(a.port.counters().errors, 20U);
}

TEST_F(BusFaults, Corrupt_WithAProbability_IsTheSameRunForTheSameSeed) {
  const auto run = [](std::uint64_t seed) {
    can::Timeline own_timeline;
    Bus own_bus("own", 500'000, own_timeline);
    Station from(own_bus, own_timeline, "from");
    Station to(own_bus, own_timeline, "to");
    EXPECT_TRUE(own_bus.set_faults({{.kind = FaultKind::corrupt, .probability = 0.3}}, seed).has_value());
    send_numbered(from, 200);
    own_timeline.run_until(Time(1s));
    return std::pair(to.heard, from.port.counters().errors);
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2));
  EXPECT_GE(run(1).second, 40U);
  EXPECT_LE(run(1).second, 140U);
}

TEST_F(BusFaults, Duplicate_ReachesTheReceiversTwice) {
  faults({{.kind = FaultKind::duplicate, .first = 2, .count = 1}});
  send_numbered(a, 3);
  timeline.run_until(Time(1s));
  EXPECT_EQ(b.frames(), (Frames{numbered(1), numbered(2), numbered(2), numbered(3)}));
  EXPECT_EQ(a.sent.size(), 3U);
  EXPECT_EQ(b.port.receive_error_counter(), 0);
}

TEST_F(BusFaults, Delay_KeepsAFrameWhileOthersPass) {
  faults({{.kind = FaultKind::delay, .identifier = 0x180, .count = 1, .delay = 5ms}});
  a.send_at(Time(1ms), numbered(1));
  a.send_at(Time(2ms), numbered(2));
  timeline.run_until(Time(1s));
  ASSERT_EQ(b.frames(), (Frames{numbered(2), numbered(1)}));
  EXPECT_GE(b.heard[1].at, Time(6ms));
  EXPECT_LE(b.heard[1].at, Time(6ms) + 60us);
}

TEST_F(BusFaults, Babble_WithAnInterval_SendsAtThatInterval) {
  faults({{.kind = FaultKind::babble,
           .from = Time(10ms),
           .until = Time(20ms),
           .ports = {"c"},
           .frame = data_frame(0x001),
           .interval = 2ms}});
  timeline.run_until(Time(1s));
  ASSERT_EQ(b.heard.size(), 5U);
  EXPECT_EQ(b.heard[1].at - b.heard[0].at, 2ms);
  EXPECT_TRUE(c.sent.empty());
  EXPECT_EQ(c.port.counters().transmitted, 5U);
}

TEST_F(BusFaults, Babble_WithoutInterval_StarvesHigherIdentifiersOnly) {
  faults({{.kind = FaultKind::babble,
           .from = Time(1ms),
           .until = Time(11ms),
           .ports = {"c"},
           .frame = data_frame(0x100)}});
  a.send_at(Time(2ms), data_frame(0x200));
  a.send_at(Time(3ms), data_frame(0x080));
  timeline.run_until(Time(1s));
  ASSERT_EQ(a.sent.size(), 2U);
  EXPECT_EQ(a.sent[0].frame, data_frame(0x080));
  EXPECT_LE(a.sent[0].at, Time(3ms) + 120us);
  EXPECT_EQ(a.sent[1].frame, data_frame(0x200));
  EXPECT_GE(a.sent[1].at, Time(11ms));
  EXPECT_GE(c.port.counters().transmitted, 180U);
}

TEST_F(BusFaults, StuckDominant_SilencesTheBusUntilItEnds) {
  faults({{.kind = FaultKind::stuck_dominant, .from = Time(1ms), .until = Time(3ms), .ports = {"c"}}});
  a.send_at(Time(1'500us), numbered(1));
  timeline.run_until(Time(2'999us));
  EXPECT_TRUE(b.heard.empty());
  EXPECT_EQ(b.port.error_state(), ErrorState::error_passive);
  EXPECT_EQ(a.port.transmit_error_counter(), 0);  // it never began
  timeline.run_until(Time(1s));
  EXPECT_EQ(b.frames(), (Frames{numbered(1)}));
}

TEST_F(BusFaults, StuckDominantInAFrame_EndsInBusOffOfItsTransmitter) {
  a.port.set_automatic_recovery(false);
  faults({{.kind = FaultKind::stuck_dominant, .from = Time(1ms), .until = Time(3ms), .ports = {"c"}}});
  a.send_at(Time(980us), numbered(1));
  timeline.run_until(Time(1s));
  // 8 for the bit error, 8 more for each 8 dominant bits after the flag.
  EXPECT_EQ(a.port.error_state(), ErrorState::bus_off);
  EXPECT_TRUE(b.heard.empty());
}

TEST_F(BusFaults, Jam_KeepsWhatFitsAndLosesTheRest) {
  faults(
      {{.kind = FaultKind::jam, .from = Time(2'500us), .until = Time(20ms), .ports = {"b"}, .capacity = 3}});
  send_numbered(a, 8);
  timeline.run_until(Time(19ms));
  EXPECT_EQ(b.frames(), (Frames{numbered(1), numbered(2)}));
  EXPECT_EQ(b.port.receive_overflows(), 3U);
  timeline.run_until(Time(1s));
  EXPECT_EQ(b.frames(), (Frames{numbered(1), numbered(2), numbered(3), numbered(4), numbered(5)}));
  EXPECT_EQ(b.heard.back().at, Time(20ms));
  EXPECT_EQ(c.frames().size(), 8U);
}

TEST_F(BusFaults, Cut_MakesTwoBusesAndTheirEndOneAgain) {
  Station d(bus, timeline, "d");
  faults({{.kind = FaultKind::cut, .from = Time(2ms), .until = Time(50ms), .ports = {"c", "d"}}});
  send_numbered(a, 3);
  c.send_at(Time(10ms), data_frame(0x333));
  a.send_at(Time(60ms), data_frame(0x444));
  timeline.run_until(Time(1s));
  EXPECT_EQ(b.frames(), (Frames{numbered(1), numbered(2), numbered(3), data_frame(0x444)}));
  EXPECT_EQ(d.frames(), (Frames{numbered(1), data_frame(0x333), data_frame(0x444)}));
}

TEST_F(BusFaults, Cut_InAFrame_LeavesTheFarSideAnError) {
  Station d(bus, timeline, "d");
  faults({{.kind = FaultKind::cut, .from = Time(1'020us), .until = Time(50ms), .ports = {"c", "d"}}});
  a.send_at(Time(1ms), numbered(1));
  d.send_at(Time(2ms), data_frame(0x333));
  timeline.run_until(Time(40ms));
  EXPECT_EQ(b.frames(), (Frames{numbered(1)}));
  EXPECT_EQ(a.sent.size(), 1U);
  EXPECT_EQ(c.frames(), (Frames{data_frame(0x333)}));
  EXPECT_EQ(d.port.receive_error_counter(), 1);
}

TEST_F(BusFaults, Cut_OfOneStation_LeavesItAloneAndPassive) {
  faults({{.kind = FaultKind::cut, .from = Time(1ms), .until = Time(500ms), .ports = {"c"}}});
  c.send_at(Time(2ms), numbered(1));
  timeline.run_until(Time(499ms));
  EXPECT_EQ(c.port.error_state(), ErrorState::error_passive);
  EXPECT_EQ(c.port.transmit_error_counter(), 128);
  timeline.run_until(Time(1s));
  EXPECT_EQ(b.frames(), (Frames{numbered(1)}));
}

TEST_F(BusFaults, NewFaults_EndTheOldOnes) {
  faults({{.kind = FaultKind::jam, .ports = {"b"}}, {.kind = FaultKind::drop, .receiver = "c"}});
  send_numbered(a, 2);
  timeline.run_until(Time(1'500us));
  EXPECT_TRUE(b.heard.empty());
  faults({});
  EXPECT_EQ(b.frames(), (Frames{numbered(1)}));
  timeline.run_until(Time(1s));
  EXPECT_EQ(b.frames(), (Frames{numbered(1), numbered(2)}));
  EXPECT_EQ(c.frames(), (Frames{numbered(2)}));
}

TEST_F(BusFaults, WrongFaults_AreRefusedWithNumberKindAndReason) {
  EXPECT_EQ(refusal({.kind = FaultKind::corrupt, .sender = "x"}),
            "fault 2 (corrupt): no port \"x\" on bus \"main\"");
  EXPECT_EQ(refusal({.kind = FaultKind::drop, .receiver = "y"}),
            "fault 2 (drop): no port \"y\" on bus \"main\"");
  EXPECT_EQ(refusal({.kind = FaultKind::cut, .ports = {"a", "z"}}),
            "fault 2 (cut): no port \"z\" on bus \"main\"");
  EXPECT_EQ(refusal({.kind = FaultKind::jam}), "fault 2 (jam): it names no port");
  EXPECT_EQ(refusal({.kind = FaultKind::drop, .first = 0}),
            "fault 2 (drop): first = 0: frames are numbered from 1");
  EXPECT_EQ(refusal({.kind = FaultKind::drop, .every = 0}), "fault 2 (drop): every = 0: 1 means every frame");
  EXPECT_EQ(refusal({.kind = FaultKind::drop, .probability = 1.5}),
            "fault 2 (drop): probability is not 0 to 1");
  EXPECT_EQ(refusal({.kind = FaultKind::delay}), "fault 2 (delay): delay is not longer than 0");
  EXPECT_EQ(refusal({.kind = FaultKind::corrupt, .bit = 160}), "fault 2 (corrupt): bit is not 0 to 159");
  EXPECT_EQ(refusal({.kind = FaultKind::drop, .from = Time(2s), .until = Time(1s)}),
            "fault 2 (drop): until is before from");
  EXPECT_EQ(refusal({.kind = FaultKind::babble, .ports = {"a"}, .frame = data_frame(0x800)}),
            "fault 2 (babble): identifier is above 7FFH");
  EXPECT_EQ(refusal({.kind = FaultKind::babble, .ports = {"a"}, .interval = -1ns}),
            "fault 2 (babble): interval is negative");
}

TEST_F(BusFaults, Babble_OfTwoThatOverlap_TheOneThatIsLeftHasItsOwnPlaceInArbitration) {
  const auto babble = [](std::uint32_t identifier, Time from, Time until) {
    return Fault{.kind = FaultKind::babble,
                 .from = from,
                 .until = until,
                 .ports = {"c"},
                 .frame = data_frame(identifier),
                 .interval = 1ms};
  };
  faults({babble(0x300, Time(10ms), Time(11ms)), babble(0x100, Time(10ms), Time(10ms) + 20us)});
  a.send_at(Time(10ms), data_frame(0x001));  // on the wire when the second babble ends
  a.send_at(Time(10ms) + 30us, data_frame(0x200));
  timeline.run_until(Time(12ms));
  EXPECT_EQ(b.frames(), (std::vector<Frame>{data_frame(0x001), data_frame(0x200), data_frame(0x300)}));
}

TEST_F(BusFaults, RefusedFaults_LeaveTheOldOnesAtWork) {
  faults({{.kind = FaultKind::drop}});
  EXPECT_FALSE(bus.set_faults({{.kind = FaultKind::jam}}, 1).has_value());
  send_numbered(a, 1);
  timeline.run_until(Time(1s));
  EXPECT_TRUE(b.heard.empty());
}

TEST_F(BusFaults, OneIsEnded_AndTheOthersGoOn) {
  faults({{.kind = FaultKind::drop, .receiver = "b"},
          {.kind = FaultKind::delay, .delay = 100us},
          {.kind = FaultKind::stuck_recessive, .ports = {"b"}}});
  send_numbered(a, 4);
  timeline.run_until(Time(2'500us));
  EXPECT_TRUE(bus.fault_states()[2].is_active);
  EXPECT_TRUE(bus.end_fault(0));
  EXPECT_TRUE(bus.end_fault(2));
  EXPECT_FALSE(bus.end_fault(3));
  timeline.run_until(Time(1s));
  EXPECT_EQ(b.frames(), (Frames{numbered(3), numbered(4)}));
  EXPECT_EQ(c.frames(), (Frames{numbered(1), numbered(2), numbered(3), numbered(4)}));
  const auto states = bus.fault_states();
  ASSERT_EQ(states.size(), 3U);
  EXPECT_EQ(states[0].hits, 2U);
  EXPECT_EQ(states[1].hits, 4U);
  EXPECT_FALSE(states[2].is_active);
}

TEST_F(BusFaults, OneThatIsEndedBeforeItBegins_NeverBegins) {
  faults({{.kind = FaultKind::cut, .from = Time(5ms), .ports = {"c"}}});
  EXPECT_TRUE(bus.end_fault(0));
  timeline.run_until(Time(1s));
  EXPECT_FALSE(bus.fault_states()[0].is_active);
}

TEST_F(BusFaults, RawLevelsAreNotEndedAlone) {
  faults({{.kind = FaultKind::drive, .from = Time(5ms), .levels = std::vector<DrivenLevel>(1)}});
  EXPECT_FALSE(bus.end_fault(0));
}

TEST_F(BusFaults, EachSideOfACutWireHasItsOwnLoad) {
  Station d(bus, timeline, "d");
  EXPECT_TRUE(bus.sides(timeline.now()).empty());
  faults({{.kind = FaultKind::cut, .from = Time(0ms), .until = Time(3s), .ports = {"c", "d"}}});
  for (int i = 0; i < 100; ++i) a.send_at(Time(i * 10ms), data_frame(0x180, {1, 2, 3, 4, 5, 6, 7, 8}));
  for (int i = 0; i < 10; ++i) c.send_at(Time(i * 100ms), data_frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8}));
  timeline.run_until(Time(1'500ms));
  const auto sides = bus.sides(timeline.now());
  ASSERT_EQ(sides.size(), 2U);
  EXPECT_EQ(sides[0].ports, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(sides[1].ports, (std::vector<std::string>{"c", "d"}));
  EXPECT_EQ(sides[0].frames, 100U);
  EXPECT_EQ(sides[1].frames, 10U);
  // 8 bytes are 111 bits, with stuff bits up to 135, and 3 of intermission: at 1 Mbit/s 100 of them a second are above 1.1 %.
  EXPECT_GT(sides[0].now, 0.0111);
  EXPECT_LT(sides[0].now, 0.0138);
  EXPECT_GT(sides[1].now, 0.00111);
  EXPECT_LT(sides[1].now, 0.00138);
  timeline.run_until(Time(4s));
  EXPECT_TRUE(bus.sides(timeline.now()).empty());
}

}  // namespace
}  // namespace canopus::sim::bus_faults_test
