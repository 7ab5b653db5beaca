// Faults of drivers, controllers and the line: stuck recessive, late, noise, overload, single-shot, termination.

#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/sim/bus/faults/termination.hpp"

#include "sim/bus_station.hpp"

namespace canopus::sim::bus_line_faults_test {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::ErrorState;
using can::Frame;
using can::Time;

struct BusLineFaults : ::testing::Test {
  void faults(const std::vector<Fault>& list, std::uint64_t seed = 1) {
    const auto set = bus.set_faults(list, seed);
    ASSERT_TRUE(set.has_value()) << set.error();
  }
  std::string refusal(const Fault& fault) {
    const auto set = bus.set_faults({fault}, 1);
    return set.has_value() ? "" : set.error();
  }

  can::Timeline timeline;
  Bus bus{"main", 1'000'000, timeline};
  Station a{bus, timeline, "a"};
  Station b{bus, timeline, "b"};
  Station c{bus, timeline, "c"};
};

const Frame frame = data_frame(0x181, {1, 2, 3});
const can::Duration frame_length = can::bit_time(can::frame_bits(frame), 1'000'000);

TEST_F(BusLineFaults, StuckRecessive_ItsOwnFrameIsABitErrorUntilItIsBusOffAndNobodyElseNotices) {
  faults({{.kind = FaultKind::stuck_recessive, .until = Time(10ms), .ports = {"a"}}});
  a.port.set_automatic_recovery(false);
  a.send_at(Time(1ms), frame);
  b.send_at(Time(2ms), frame);
  timeline.run_until(Time(3ms));
  EXPECT_EQ(a.port.error_state(), ErrorState::bus_off);
  EXPECT_EQ(c.frames(), (std::vector<Frame>{frame}));
  EXPECT_EQ(b.port.counters().errors, 0U);
  EXPECT_EQ(c.port.receive_error_counter(), 0);
}

TEST_F(BusLineFaults, StuckRecessive_ItsAcknowledgementIsMissing) {
  c.port.plug(false);
  faults({{.kind = FaultKind::stuck_recessive, .until = Time(10ms), .ports = {"a"}}});
  b.send_at(Time(1ms), frame);
  timeline.run_until(Time(9ms));
  EXPECT_TRUE(b.sent.empty());
  EXPECT_GE(b.port.counters().errors, 16U);
  timeline.run_until(Time(1s));  // mended
  EXPECT_EQ(b.sent.size(), 1U);
  EXPECT_EQ(a.frames(), (std::vector<Frame>{frame}));
}

TEST_F(BusLineFaults, Late_ShiftsWhatOthersSeeAndGoesUnnoticedUpToTheSamplePoint) {
  faults({{.kind = FaultKind::late, .delay = 870ns, .ports = {"a"}}});
  a.send_at(Time(1ms), frame);
  b.send_at(Time(2ms), frame);
  timeline.run_until(Time(10ms));
  ASSERT_EQ(b.heard.size(), 1U);
  EXPECT_EQ(b.heard[0].at, Time(1ms) + 870ns + frame_length);
  EXPECT_EQ(c.frames(), (std::vector<Frame>{frame, frame}));
  EXPECT_EQ(a.port.counters().errors + b.port.counters().errors + c.port.counters().errors, 0U);
}

TEST_F(BusLineFaults, Late_BehindTheSamplePointFailsBothAsSenderAndAsReceiver) {
  c.port.plug(false);
  faults({{.kind = FaultKind::late, .until = Time(5ms), .delay = 880ns, .ports = {"a"}}});
  a.send_at(Time(1ms), frame);
  b.send_at(Time(3ms), frame);
  timeline.run_until(Time(2ms));
  EXPECT_TRUE(a.sent.empty());
  EXPECT_GE(a.port.counters().errors, 1U);
  timeline.run_until(Time(4ms));
  EXPECT_TRUE(b.sent.empty());
  EXPECT_GE(b.port.counters().errors, 1U);
  timeline.run_until(Time(2s));
  EXPECT_EQ(b.sent.size(), 1U);
}

TEST_F(BusLineFaults, Noise_HitsAsManyBitsAsItsRateSays) {
  const auto errors = [](double rate, std::uint64_t seed) {
    can::Timeline own_timeline;
    Bus own_bus("own", 1'000'000, own_timeline);
    Station from(own_bus, own_timeline, "from");
    Station to(own_bus, own_timeline, "to");
    EXPECT_TRUE(own_bus.set_faults({{.kind = FaultKind::noise, .bit_error_rate = rate}}, seed).has_value());
    own_timeline.run_until(Time(10s));
    const can::BusLoad load = own_bus.load(own_timeline.now());
    EXPECT_LE(load.bits, 30 * load.error_frames) << "the bits of the error frames, and no more";
    EXPECT_LE(load.peak, 0.01);
    return load.error_frames;
  };
  // 10,000,000 idle bits: each hit is a false SOF, and six recessive bits after it an error frame.
  const std::uint64_t hits = errors(1e-5, 1);
  EXPECT_GE(hits, 70U);
  EXPECT_LE(hits, 130U);
  EXPECT_EQ(errors(1e-5, 1), hits);
  EXPECT_NE(errors(1e-5, 2), hits);
  EXPECT_GE(errors(1e-4, 1), 900U);
  EXPECT_LE(errors(1e-4, 1), 1100U);
}

TEST_F(BusLineFaults, Noise_CostsErrorFramesAndNoFrames) {
  faults({{.kind = FaultKind::noise, .bit_error_rate = 1e-4}});
  for (int number = 0; number < 500; ++number) {
    a.send_at(Time(number * 1ms), data_frame(0x100, {static_cast<std::uint8_t>(number), 0x55}));
  }
  timeline.run_until(Time(1s));
  EXPECT_EQ(a.sent.size(), 500U);
  EXPECT_GE(b.heard.size(), 500U);  // a frame hit in its last bit comes twice
  EXPECT_GE(a.port.counters().errors, 1U);
}

TEST_F(BusLineFaults, Noise_OfAPort_IsSeenByThatPortFirst) {
  faults({{.kind = FaultKind::noise, .ports = {"b"}, .bit_error_rate = 1e-3}});
  struct First final : BusObserver {
    void frame_completed(const Frame&, Time, Time) override {}
    void errors_reported(std::span<const can::BusErrorReport> reports, Time) override {
      for (const can::BusErrorReport& report : reports) {
        if (report.first) (report.port == wanted ? hits : others) += 1;
      }
    }
    const can::Port* wanted = nullptr;
    int hits = 0;
    int others = 0;
  } first;
  first.wanted = &b.port;
  bus.add_observer(first);
  timeline.run_until(Time(100ms));
  EXPECT_GE(first.hits, 50);
  EXPECT_EQ(first.others, 0);
  bus.remove_observer(first);
}

TEST_F(BusLineFaults, Noise_OfEveryBit_IsADominantBusWhileItIsIdle) {
  faults({{.kind = FaultKind::noise, .from = Time(1ms), .until = Time(2ms), .bit_error_rate = 1}});
  struct Wire final : WireObserver {
    void level_changed(bool dominant, Time now) override { changes.emplace_back(dominant, now); }
    void transmit_changed(const can::Port&, bool, Time) override {}
    void activity_changed(const can::Port&, bool, bool, Time) override {}
    std::vector<std::pair<bool, Time>> changes;
  } wire;
  a.port.set_listen_only(true);
  b.port.set_listen_only(true);
  c.port.set_listen_only(true);
  bus.add_observer(wire);
  timeline.run_until(Time(3ms));
  bus.remove_observer(wire);
  EXPECT_EQ(wire.changes, (std::vector<std::pair<bool, Time>>{{true, Time(1ms)}, {false, Time(2ms)}}));
}

TEST_F(BusLineFaults, Overload_PutsItsOverloadFramesBetweenTwoFrames) {
  const auto gap = [](unsigned overloads) {
    can::Timeline own_timeline;
    Bus own_bus("own", 1'000'000, own_timeline);
    Station from(own_bus, own_timeline, "from");
    Station slow(own_bus, own_timeline, "slow");
    if (overloads > 0) {
      EXPECT_TRUE(
          own_bus
              .set_faults({{.kind = FaultKind::overload, .ports = {"slow"}, .overload_frames = overloads}}, 1)
              .has_value());
    }
    from.send_at(Time(1ms), frame);
    from.send_at(Time(1ms), frame);
    own_timeline.run_until(Time(10ms));
    EXPECT_EQ(slow.heard.size(), 2U);
    EXPECT_EQ(from.port.counters().errors + slow.port.counters().errors, 0U);
    EXPECT_EQ(from.port.transmit_error_counter(), 0);
    return slow.heard[1].at - slow.heard[0].at - frame_length;
  };
  EXPECT_EQ(gap(0), 3us);
  // A flag of six bits, the others' one bit behind it, eight bits of delimiter; then the intermission.
  EXPECT_EQ(gap(1), 3us + 15us);
  EXPECT_EQ(gap(2), 3us + 30us);
}

TEST_F(BusLineFaults, SingleShot_DropsAFrameThatMetAnError) {
  faults({{.kind = FaultKind::single_shot, .ports = {"a"}},
          {.kind = FaultKind::corrupt, .first = 1, .count = 1, .bit = 20}});
  a.send_at(Time(1ms), data_frame(0x181, {1}));
  a.send_at(Time(2ms), data_frame(0x181, {2}));
  timeline.run_until(Time(1s));
  EXPECT_EQ(b.frames(), (std::vector<Frame>{data_frame(0x181, {2})}));
  EXPECT_EQ(a.sent.size(), 1U);
}

TEST_F(BusLineFaults, SingleShot_DropsAFrameThatLostArbitration) {
  faults({{.kind = FaultKind::single_shot, .until = Time(2ms), .ports = {"a"}}});
  a.send_at(Time(1ms), data_frame(0x181, {1}));
  b.send_at(Time(1ms), data_frame(0x180, {2}));
  a.send_at(Time(3ms), data_frame(0x181, {3}));
  b.send_at(Time(3ms), data_frame(0x180, {4}));
  timeline.run_until(Time(1s));
  EXPECT_EQ(c.frames(),
            (std::vector<Frame>{data_frame(0x180, {2}), data_frame(0x180, {4}), data_frame(0x181, {3})}));
}

TEST_F(BusLineFaults, SingleShot_NobodyAcknowledges_TheFrameIsTriedOnce) {
  b.port.plug(false);
  c.port.plug(false);
  faults({{.kind = FaultKind::single_shot, .ports = {"a"}}});
  a.send_at(Time(1ms), frame);
  timeline.run_until(Time(1s));
  EXPECT_EQ(a.port.counters().errors, 1U);
  EXPECT_EQ(a.port.transmit_error_counter(), 8);
}

TEST_F(BusLineFaults, Termination_IsAModelThatSaysWhatItAssumes) {
  EXPECT_EQ(termination(2, 40, 3), Termination{});
  // 2 nF of line and 0.3 nF of nodes: from 2.58 V through 118.6 ohms, from 2 V through 59.8 ohms.
  EXPECT_NEAR(static_cast<double>(termination(1, 40, 3).release.count()), 257, 5);
  // The nodes' inputs alone: 10 kilohms.
  EXPECT_NEAR(static_cast<double>(termination(0, 40, 3).release.count()), 45'500, 500);
  EXPECT_EQ(termination(3, 40, 3).release, can::Duration{});
  EXPECT_FALSE(termination(7, 40, 3).is_weak);
  EXPECT_TRUE(termination(8, 40, 3).is_weak);
}

struct Line {
  std::uint32_t bit_rate;
  unsigned resistors;
  double length;
};

bool works(const Line& line) {
  can::Timeline timeline;
  Bus bus("line", line.bit_rate, timeline);
  Station a(bus, timeline, "a");
  Station b(bus, timeline, "b");
  Station c(bus, timeline, "c");
  const auto set = bus.set_faults(
      {{.kind = FaultKind::termination, .resistors = line.resistors, .length = line.length}}, 1);
  EXPECT_TRUE(set.has_value());
  a.send_at(Time(1ms), frame);
  b.send_at(Time(1ms), data_frame(0x182, {0x55}));
  timeline.run_until(Time(1s));
  const auto errors = a.port.counters().errors + b.port.counters().errors + c.port.counters().errors;
  EXPECT_EQ(errors == 0, c.heard.size() == 2);
  return errors == 0;
}

TEST(BusTermination, AMissingResistorMattersWhereBitsAreShortOrTheLineIsLong) {
  EXPECT_TRUE(works({.bit_rate = 1'000'000, .resistors = 2, .length = 200}));
  EXPECT_TRUE(works({.bit_rate = 1'000'000, .resistors = 1, .length = 40}));
  EXPECT_FALSE(works({.bit_rate = 1'000'000, .resistors = 1, .length = 200}));
  EXPECT_TRUE(works({.bit_rate = 250'000, .resistors = 1, .length = 200}));
  EXPECT_FALSE(works({.bit_rate = 125'000, .resistors = 0, .length = 40}));
  EXPECT_TRUE(works({.bit_rate = 10'000, .resistors = 0, .length = 40}));
}

TEST(BusTermination, TooManyResistorsLeaveNothingOfADominantBit) {
  EXPECT_TRUE(works({.bit_rate = 125'000, .resistors = 7, .length = 40}));
  EXPECT_FALSE(works({.bit_rate = 125'000, .resistors = 8, .length = 40}));
}

TEST_F(BusLineFaults, WrongOnes_AreRefused) {
  EXPECT_EQ(refusal({.kind = FaultKind::stuck_recessive}), "fault 1 (stuck recessive): it names no port");
  EXPECT_EQ(refusal({.kind = FaultKind::overload}), "fault 1 (overload): it names no port");
  EXPECT_EQ(refusal({.kind = FaultKind::single_shot, .ports = {"x"}}),
            "fault 1 (single-shot): no port \"x\" on bus \"main\"");
  EXPECT_EQ(refusal({.kind = FaultKind::late, .ports = {"a"}}), "fault 1 (late): delay is not longer than 0");
  EXPECT_EQ(refusal({.kind = FaultKind::late, .delay = 1us, .ports = {"a"}}),
            "fault 1 (late): delay is not shorter than a bit");
  EXPECT_EQ(refusal({.kind = FaultKind::overload, .ports = {"a"}, .overload_frames = 3}),
            "fault 1 (overload): overload_frames is not 1 or 2");
  for (const double rate : {0.0, -1.0, 1.5}) {
    EXPECT_EQ(refusal({.kind = FaultKind::noise, .bit_error_rate = rate}),
              "fault 1 (noise): bit_error_rate is not above 0, up to 1");
  }
  EXPECT_EQ(refusal({.kind = FaultKind::termination, .resistors = 21}),
            "fault 1 (termination): resistors are not 0 to 20");
  EXPECT_EQ(refusal({.kind = FaultKind::termination, .length = 10'001}),
            "fault 1 (termination): length is not 0 to 10000 m");
}

}  // namespace
}  // namespace canopus::sim::bus_line_faults_test
