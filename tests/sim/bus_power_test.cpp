// A controller without supply is not on the bus; with it, it has to find its way in.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/sim/bus/bus.hpp"

#include "sim/bus_station.hpp"

namespace canopus::sim::bus_power_test {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::ErrorState;
using can::Time;

constexpr can::Duration bit = 4us;  // 250 kbit/s
constexpr can::Duration length = 53 * bit;

class BusPower : public testing::Test {
 protected:
  can::Timeline timeline;
  Bus bus{"main", 250'000, timeline};
  Station a{bus, timeline, "a"};
  Station b{bus, timeline, "b"};
  can::Frame frame = data_frame(0x123, {0x55});
};

TEST_F(BusPower, Off_AcknowledgesNothing) {
  b.port.set_power(false);
  a.send_at(Time(1ms), frame);
  timeline.run_until(Time(10ms));
  EXPECT_TRUE(a.sent.empty());
  EXPECT_EQ(a.port.error_state(), ErrorState::error_passive);
  EXPECT_TRUE(b.heard.empty());
}

TEST_F(BusPower, Off_SendsNothingAndRefuses) {
  b.port.set_power(false);
  EXPECT_FALSE(b.port.has_room());
  EXPECT_FALSE(b.port.send(frame));
  timeline.run_until(Time(10ms));
  EXPECT_TRUE(a.heard.empty());
  b.port.set_power(true);
  EXPECT_TRUE(b.port.has_room());
  timeline.run_until(Time(20ms));
  EXPECT_TRUE(a.heard.empty());  // refused is lost
}

TEST_F(BusPower, SwitchedOff_LosesWhatWaitsAndStartsWithoutErrors) {
  b.port.plug(false);
  EXPECT_TRUE(b.port.send(frame));
  b.port.set_power(false);
  b.port.set_power(true);
  b.port.plug(true);
  timeline.run_until(Time(10ms));
  EXPECT_TRUE(a.heard.empty());
  b.port.set_power(false);
  a.send_at(Time(11ms), frame);
  timeline.run_until(Time(20ms));
  ASSERT_GT(a.port.transmit_error_counter(), 0);
  a.port.set_power(false);
  EXPECT_EQ(a.port.transmit_error_counter(), 0);
  EXPECT_EQ(a.port.error_state(), ErrorState::error_active);
}

TEST_F(BusPower, SwitchedOn_SendsAfterElevenRecessiveBits) {
  Station late(bus, timeline, "late");
  late.port.set_power(false);
  timeline.run_until(Time(1ms));
  late.port.set_power(true);
  EXPECT_TRUE(late.port.send(frame));
  timeline.run_until(Time(10ms));
  EXPECT_EQ(a.heard, (std::vector<Heard>{{frame, Time(1ms) + 11 * bit + length}}));
}

TEST_F(BusPower, SwitchedOnInAFrame_DisturbsNothingAndHearsTheNextOne) {
  Station late(bus, timeline, "late");
  late.port.set_power(false);
  a.send_at(Time(1ms), frame);
  const can::Frame next = data_frame(0x124, {1, 2});
  a.send_at(Time(2ms), next);
  timeline.run_until(Time(1ms) + 20 * bit);
  late.port.set_power(true);
  timeline.run_until(Time(10ms));
  EXPECT_EQ(b.frames(), (std::vector<can::Frame>{frame, next}));
  EXPECT_EQ(b.heard.front().at, Time(1ms) + length);
  EXPECT_EQ(late.frames(), std::vector<can::Frame>{next});
  EXPECT_EQ(b.port.counters().errors, 0U);
  EXPECT_EQ(late.port.counters().errors, 0U);
}

// The rest of the frame is missing on the wire: six recessive bits, and nobody repeats it.
TEST_F(BusPower, SwitchedOffInItsFrame_TheFrameBreaksOff) {
  Station c(bus, timeline, "c");
  a.send_at(Time(1ms), frame);
  timeline.run_until(Time(1ms) + 20 * bit);
  a.port.set_power(false);
  timeline.run_until(Time(10ms));
  EXPECT_TRUE(b.heard.empty());
  EXPECT_EQ(b.port.counters().errors, 1U);
  EXPECT_EQ(c.port.counters().errors, 1U);
  EXPECT_TRUE(a.sent.empty());
}

TEST_F(BusPower, OffAndUnplugged_BothHaveToEnd) {
  b.port.set_power(false);
  b.port.plug(false);
  b.port.set_power(true);
  a.send_at(Time(1ms), frame);
  timeline.run_until(Time(5ms));
  EXPECT_FALSE(b.port.plugged());
  EXPECT_TRUE(a.sent.empty());
  b.port.plug(true);
  timeline.run_until(Time(10ms));
  EXPECT_EQ(b.frames(), std::vector<can::Frame>{frame});
  b.port.set_power(false);
  b.port.plug(false);
  b.port.plug(true);
  EXPECT_TRUE(b.port.plugged());
  a.send_at(Time(11ms), frame);
  timeline.run_until(Time(20ms));
  EXPECT_EQ(b.frames().size(), 1U);
}

TEST_F(BusPower, ADelayedFrameIsLostWithTheSupply) {
  Fault fault;
  fault.kind = FaultKind::delay;
  fault.sender = "b";
  fault.delay = 5ms;
  ASSERT_TRUE(bus.set_faults({fault}, 1));
  EXPECT_TRUE(b.port.send(frame));
  b.port.set_power(false);
  b.port.set_power(true);
  timeline.run_until(Time(20ms));
  EXPECT_TRUE(a.heard.empty());
}

}  // namespace
}  // namespace canopus::sim::bus_power_test
