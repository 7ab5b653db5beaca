// Controllers of more than one bit rate on a wire, and what an edge does to a bit.

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/sim/bus/bus.hpp"

#include "sim/bus_station.hpp"

namespace canopus::sim {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::ErrorState;
using can::Frame;
using can::Time;

struct BusRates : ::testing::Test {
  void faults(const std::vector<Fault>& list) { ASSERT_TRUE(bus.set_faults(list, 1).has_value()); }

  can::Timeline timeline;
  Bus bus{"main", 1'000'000, timeline};
  Station a{bus, timeline, "a"};
  Station b{bus, timeline, "b"};
  Station c{bus, timeline, "c"};
};

const Frame frame_of_53_bits = data_frame(0x123, {0x55});

TEST_F(BusRates, StationWithAnotherBitRate_DestroysFramesUntilItIsPassive) {
  for (Station* station : {&a, &b, &c}) station->port.restart(125'000);
  Station wrong(bus, timeline, "wrong");
  wrong.port.restart(500'000);
  for (int number = 0; number < 20; ++number) {
    a.send_at(Time(1ms) + number * 100ms, data_frame(0x111, {0x00, 0xFF, static_cast<std::uint8_t>(number)}));
  }
  timeline.run_until(Time(10s));
  EXPECT_EQ(wrong.port.error_state(), ErrorState::error_passive);
  EXPECT_TRUE(wrong.heard.empty());
  EXPECT_GE(wrong.port.counters().errors, 5U);
  EXPECT_GE(a.port.counters().errors, 1U);
  EXPECT_EQ(a.port.error_state(), ErrorState::error_active);
  EXPECT_EQ(a.sent.size(), 20U);
  EXPECT_EQ(b.heard.size(), 20U);
}

TEST_F(BusRates, PassiveStationOfAnotherBitRate_StaysOnTheWireAndGoesOnCounting) {
  a.port.restart(500'000);
  b.port.restart(500'000);
  for (int i = 1; i <= 40; ++i) a.send_at(Time(i * 5ms), frame_of_53_bits);
  timeline.run_until(Time(150ms));
  ASSERT_EQ(c.port.error_state(), ErrorState::error_passive);
  const std::uint64_t errors = c.port.counters().errors;
  timeline.run_until(Time(300ms));
  EXPECT_GE(c.port.counters().errors, errors + 10);  // one for each frame at least
  EXPECT_EQ(b.heard.size(), 40U);
}

// The edges come from a stuck output: b, at 100 kbit/s, samples 8.75 us after the beginning of its bit.
TEST_F(BusRates, SecondEdgeBetweenTwoSamplePoints_MovesNothing) {
  b.port.restart(100'000);
  c.port.plug(false);
  a.port.set_listen_only(true);
  faults({{.kind = FaultKind::stuck_dominant, .from = Time(1ms), .until = Time(1001us), .ports = {"a"}},
          {.kind = FaultKind::stuck_dominant, .from = Time(1002us), .until = Time(1059us), .ports = {"a"}}});
  timeline.run_until(Time(1ms) + 58'749ns);
  EXPECT_EQ(b.port.counters().errors, 0U);
  timeline.run_until(Time(1ms) + 58'750ns);
  EXPECT_EQ(b.port.counters().errors, 1U);  // the edge at 1002 us would have moved it to 60 us
}

TEST_F(BusRates, EdgeAfterADominantSample_MovesNothing) {
  b.port.restart(100'000);
  c.port.plug(false);
  a.port.set_listen_only(true);
  faults(
      {{.kind = FaultKind::stuck_dominant, .from = Time(1ms), .until = Time(1ms) + 8'900ns, .ports = {"a"}},
       {.kind = FaultKind::stuck_dominant,
        .from = Time(1ms) + 9'200ns,
        .until = Time(1059us),
        .ports = {"a"}}});
  timeline.run_until(Time(1ms) + 58'749ns);
  EXPECT_EQ(b.port.counters().errors, 0U);  // the edge at 9.2 us would have moved it to 57.95 us
  timeline.run_until(Time(1ms) + 58'750ns);
  EXPECT_EQ(b.port.counters().errors, 1U);
}

TEST_F(BusRates, PassiveStationLeftBehindByTheOthers_HearsThemAgainWhenTheyAreBack) {
  a.port.restart(500'000);
  b.port.restart(500'000);
  for (int i = 1; i <= 40; ++i) a.send_at(Time(i * 5ms), frame_of_53_bits);
  timeline.run_until(Time(300ms));
  EXPECT_EQ(c.port.error_state(), ErrorState::error_passive);
  EXPECT_EQ(b.heard.size(), 40U);
  EXPECT_TRUE(c.heard.empty());
  a.port.restart(1'000'000);
  timeline.run_until(Time(301ms));
  b.port.restart(1'000'000);
  timeline.run_until(Time(310ms));
  const std::uint64_t errors = a.port.counters().errors;
  a.send_at(Time(310ms), frame_of_53_bits);
  timeline.run_until(Time(311ms));
  EXPECT_EQ(b.heard.size(), 41U);
  EXPECT_EQ(c.frames(), std::vector<Frame>{frame_of_53_bits});
  EXPECT_EQ(a.port.counters().errors, errors);
}

TEST_F(BusRates, SenderWithAnotherBitRate_IsHeardByNobodyAndWhenItIsGoneTheOthersGoOn) {
  Station wrong(bus, timeline, "wrong");
  wrong.port.restart(250'000);
  wrong.port.send(frame_of_53_bits);
  timeline.run_until(Time(1s));
  // All become passive; then nobody acknowledges and nobody disturbs, and it repeats its frame for ever.
  EXPECT_EQ(wrong.port.error_state(), ErrorState::error_passive);
  EXPECT_TRUE(wrong.sent.empty());
  EXPECT_TRUE(b.heard.empty());
  EXPECT_EQ(b.port.error_state(), ErrorState::error_passive);
  wrong.port.plug(false);
  timeline.run_until(Time(2s));
  b.port.send(data_frame(0x44));
  timeline.run_until(Time(3s));
  EXPECT_EQ(c.frames(), (std::vector<Frame>{data_frame(0x44)}));
  EXPECT_EQ(c.port.receive_error_counter(), 127);
}

TEST_F(BusRates, AllStationsOnANewBitRate_AreABusAgain) {
  for (Station* station : {&a, &b, &c}) station->port.restart(125'000);
  timeline.run_until(Time(1ms));
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(10ms));
  EXPECT_EQ(b.heard, (std::vector<Heard>{{frame_of_53_bits, Time(1ms) + 53 * 8us}}));
}

}  // namespace
}  // namespace canopus::sim
