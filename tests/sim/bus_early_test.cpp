// A controller that begins its frame before the bus is idle.

#include <vector>

#include <gtest/gtest.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/sim/bus/line/line.hpp"

#include "sim/bus_station.hpp"

namespace canopus::sim::bus_early_test {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::Frame;
using can::Time;

const Frame first = data_frame(0x101, {1, 2, 3});
const Frame early = data_frame(0x181, {4});
const can::Duration first_length = can::bit_time(can::frame_bits(first), 1'000'000);
const can::Duration early_length = can::bit_time(can::frame_bits(early), 1'000'000);

struct BusEarly : ::testing::Test {
  /// `b` waits for the end of a frame of `a`, but for so many bits of it.
  void run(unsigned bits) {
    const auto set = bus.set_faults({{.kind = FaultKind::early,
                                      .until = Time(1ms) + first_length + 5us,
                                      .ports = {"b"},
                                      .early_bits = bits}},
                                    1);
    ASSERT_TRUE(set.has_value()) << set.error();
    a.send_at(Time(1ms), first);
    b.send_at(Time(1ms) + 10us, early);
    timeline.run_until(Time(11ms));
  }

  can::Timeline timeline;
  Bus bus{"main", 1'000'000, timeline};
  Station a{bus, timeline, "a"};
  Station b{bus, timeline, "b"};
  Station c{bus, timeline, "c"};
};

TEST_F(BusEarly, InTheLastBitOfTheIntermission_ItIsAFrameLikeAnother) {
  run(1);
  EXPECT_EQ(b.sent, (std::vector<Heard>{{early, Time(1ms) + first_length + 2us + early_length}}));
  EXPECT_EQ(c.frames(), (std::vector<Frame>{first, early}));
  EXPECT_EQ(a.port.counters().errors + b.port.counters().errors + c.port.counters().errors, 0U);
}

// A dominant bit in the first two bits of the intermission asks for an overload frame, whose flag breaks the frame's
// stuffing for whoever sent it.
TEST_F(BusEarly, InTheSecondBitOfTheIntermission_TheOthersAnswerWithAnOverloadFrame) {
  run(2);
  EXPECT_EQ(c.frames(), (std::vector<Frame>{first, early}));
  EXPECT_GT(b.port.counters().errors, 0U);
  EXPECT_EQ(a.port.counters().errors + c.port.counters().errors, 0U);
  EXPECT_GT(b.sent.at(0).at, Time(1ms) + first_length + 3us + early_length);
}

TEST_F(BusEarly, InTheFirstBitOfTheIntermission_TheOthersAnswerWithAnOverloadFrame) {
  run(3);
  EXPECT_EQ(c.frames(), (std::vector<Frame>{first, early}));
  EXPECT_GT(b.port.counters().errors, 0U);
  EXPECT_EQ(a.port.counters().errors + c.port.counters().errors, 0U);
}

TEST_F(BusEarly, InTheLastBitOfEof_ReceiversHaveTheFrameAndItsSenderRepeatsIt) {
  run(4);
  EXPECT_EQ(c.frames(), (std::vector<Frame>{first, first, early}));
  EXPECT_EQ(a.port.counters().errors, 1U);
  EXPECT_EQ(c.port.counters().errors, 0U);
  EXPECT_EQ(b.frames(), (std::vector<Frame>{first})) << "the first one was not over for it";
}

TEST_F(BusEarly, InTheFirstBitOfEof_TheFrameIsDestroyedForAll) {
  run(10);
  EXPECT_EQ(c.frames(), (std::vector<Frame>{first, early}));
  EXPECT_GT(a.port.counters().errors, 0U);
  EXPECT_GT(c.port.counters().errors, 0U);
}

TEST_F(BusEarly, AFrameOfItsOwn_IsSentToItsEnd) {
  ASSERT_TRUE(bus.set_faults({{.kind = FaultKind::early, .ports = {"b"}, .early_bits = 10}}, 1).has_value());
  b.send_at(Time(1ms), early);
  b.send_at(Time(1ms), early);
  timeline.run_until(Time(1ms) + early_length + 1us);
  EXPECT_EQ(b.sent, (std::vector<Heard>{{early, Time(1ms) + early_length}}));
  EXPECT_EQ(c.frames(), (std::vector<Frame>{early}));
}

TEST_F(BusEarly, OnALine_ItIsTheSame) {
  bus.set_line({.length = 20, .clock_ppm = 100});
  run(4);
  EXPECT_EQ(c.frames(), (std::vector<Frame>{first, first, early}));
  EXPECT_EQ(a.port.counters().errors, 1U);
}

TEST_F(BusEarly, WrongNumbers_AreRefused) {
  for (const unsigned bits : {0U, 11U}) {
    const auto set = bus.set_faults({{.kind = FaultKind::early, .ports = {"b"}, .early_bits = bits}}, 1);
    ASSERT_FALSE(set.has_value());
    EXPECT_EQ(set.error(), "fault 1 (early): early_bits are not 1 to 10");
  }
  EXPECT_EQ(bus.set_faults({{.kind = FaultKind::early}}, 1).error(), "fault 1 (early): it names no port");
}

}  // namespace
}  // namespace canopus::sim::bus_early_test
