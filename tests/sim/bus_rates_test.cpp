// Controllers of more than one bit rate on a wire, and what an edge does to a bit.

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/sim/bus/bus.hpp"

#include "sim/bus_station.hpp"

namespace canopus::sim::bus_rates_test {
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

/// When a port began to drive dominant.
struct DrivenBy final : WireObserver {
  DrivenBy(Bus& the_bus, const Port& the_port) : bus(the_bus), port(the_port) { bus.add_observer(*this); }
  DrivenBy(const DrivenBy&) = delete;
  DrivenBy& operator=(const DrivenBy&) = delete;
  ~DrivenBy() { bus.remove_observer(*this); }
  void level_changed(bool, Time) override {}
  void transmit_changed(const Port& of, bool dominant, Time now) override {
    if (&of == &port && dominant) begins.push_back({now, of.error_state()});
  }
  void activity_changed(const Port&, bool, bool, Time) override {}

  struct Begin {
    Time at;
    ErrorState state;
  };
  Bus& bus;
  const Port& port;
  std::vector<Begin> begins;
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

// b, at 100 kbit/s, is in the first bit of its intermission from 1200 us on: six bits that end with the stuff error, its
// flag, its delimiter of eight.
struct BusIntermission : BusRates {
  /// When b's overload flag begins, if a dominant pulse of 9 us begins then.
  Time flag_after(can::Duration pulse) {
    b.port.restart(100'000);
    c.port.plug(false);
    a.port.set_listen_only(true);
    const Time edge = Time(1ms) + pulse;
    faults({{.kind = FaultKind::stuck_dominant, .from = Time(1ms), .until = Time(1060us), .ports = {"a"}},
            {.kind = FaultKind::stuck_dominant, .from = edge, .until = edge + 9us, .ports = {"a"}}});
    const DrivenBy driven(bus, b.port);
    timeline.run_until(Time(2ms));
    if (driven.begins.size() != 2) return can::never;
    EXPECT_EQ(driven.begins[0].at, Time(1060us));
    return driven.begins[1].at;
  }
};

TEST_F(BusIntermission, EdgeInItsFirstBit_MovesTheBitByTheJumpWidth) {
  EXPECT_EQ(flag_after(204us), Time(1211us) + 250ns);
}

TEST_F(BusIntermission, EdgeInItsSecondBit_RestartsTheBit) { EXPECT_EQ(flag_after(214us), Time(1224us)); }

// Of those that are error active all have the wrong rate. Those of the right one are still a bus.
TEST_F(BusRates, OneActiveStationOfASlowRate_DoesNotMakeThePassiveMajorityDeaf) {
  Station slow(bus, timeline, "slow");
  slow.port.restart(250'000);
  slow.port.send(frame_of_53_bits);
  timeline.run_until(Time(1s));
  for (Station* station : {&a, &b, &c}) ASSERT_EQ(station->port.error_state(), ErrorState::error_passive);
  slow.port.restart(250'000);
  timeline.run_until(Time(1010ms));
  ASSERT_EQ(slow.port.error_state(), ErrorState::error_active);
  const std::uint64_t errors = c.port.counters().errors;
  slow.port.send(frame_of_53_bits);
  timeline.run_until(Time(1011ms));
  EXPECT_GT(c.port.counters().errors, errors);
  slow.port.abort_transmissions();
  timeline.run_until(Time(1020ms));
  a.port.send(data_frame(0x44));
  timeline.run_until(Time(2s));
  EXPECT_EQ(a.sent.size(), 1U);
  EXPECT_EQ(b.frames(), std::vector<Frame>{data_frame(0x44)});
  EXPECT_EQ(c.frames(), std::vector<Frame>{data_frame(0x44)});
}

// An overload flag is dominant whatever the state [ISO 11898-1]: error passive is not harmless.
TEST_F(BusRates, PassiveStationOfAnotherBitRate_StillDrivesOverloadFlags) {
  for (Station* station : {&a, &b}) station->port.restart(250'000);
  c.port.restart(125'000);
  const DrivenBy driven(bus, c.port);
  for (int i = 1; i <= 40; ++i) a.send_at(Time(i * 1ms), frame_of_53_bits);
  b.on_receive = [this](const Frame&, Time) { b.port.send(data_frame(0x7E4, {0x44})); };
  timeline.run_until(Time(60ms));
  ASSERT_EQ(c.port.error_state(), ErrorState::error_passive);
  ASSERT_FALSE(driven.begins.empty());
  EXPECT_EQ(driven.begins.back().state, ErrorState::error_passive);
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
  // All become passive; then no node acknowledges and nobody disturbs, and it repeats its frame for ever.
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
}  // namespace canopus::sim::bus_rates_test
