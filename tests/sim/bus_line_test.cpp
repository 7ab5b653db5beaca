// A bus that is a line with length, and nodes with clocks of their own. Metres are worked out by hand.

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/sim/bus/line/line.hpp"

#include "sim/bus_station.hpp"

namespace canopus::sim::bus_line_test {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::Frame;

class LineBus {
 public:
  LineBus(std::uint32_t bit_rate, unsigned nodes, const Line* line) : bus("line", bit_rate, timeline) {
    for (unsigned number = 0; number < nodes; ++number) {
      stations.push_back(std::make_unique<Station>(bus, timeline, std::to_string(number)));
    }
    if (line != nullptr) bus.set_line(*line);
  }
  void run_until(can::Time end) { timeline.run_until(end); }
  [[nodiscard]] std::uint64_t errors() const {
    std::uint64_t sum = 0;
    for (const auto& station : stations) sum += station->port.counters().errors;
    return sum;
  }

  can::Timeline timeline;
  Bus bus;
  std::vector<std::unique_ptr<Station>> stations;
};

/// Errors of a frame that begins at any moment of the receiver's quanta.
std::uint64_t errors_over(std::uint32_t bit_rate, double metres) {
  const Line line{.length = metres};
  std::uint64_t errors = 0;
  const can::Duration quantum = can::bit_time(1, bit_rate) / line.timing.quanta();
  for (can::Duration late{}; late <= quantum; late += 2ns) {
    LineBus bus(bit_rate, 2, &line);
    bus.stations[0]->send_at(can::Time(1ms) + late, data_frame(0x181, {1, 2, 3}));
    bus.run_until(can::Time(1ms) + can::bit_time(90, bit_rate));
    errors += bus.errors();
  }
  return errors;
}

// 2 * (57 m * 5 ns + 120 ns) and a quantum are 872.5 ns, and the sample point is at 875 ns.
TEST(BusLine, At1Mbit_58MetresAreTooLong) {
  EXPECT_EQ(errors_over(1'000'000, 57), 0U);
  EXPECT_GT(errors_over(1'000'000, 58), 0U);
}

TEST(BusLine, At500kbit_139MetresAreTooLong) {
  EXPECT_EQ(errors_over(500'000, 138), 0U);
  EXPECT_GT(errors_over(500'000, 139), 0U);
}

TEST(BusLine, FrameOverALine_IsHeardLaterByTheWayOfItsLevels) {
  const Line line{.length = 100, .nodes = {{.port = "1", .place = 20}, {.port = "2", .place = 100}}};
  LineBus bus(250'000, 3, &line);
  const Frame frame = data_frame(0x181, {1, 2, 3});
  bus.stations[0]->send_at(can::Time(1ms), frame);
  bus.run_until(can::Time(10ms));
  const can::Time ideal = can::Time(1ms) + can::bit_time(can::frame_bits(frame), 250'000);
  ASSERT_EQ(bus.stations[1]->heard.size(), 1U);
  ASSERT_EQ(bus.stations[2]->heard.size(), 1U);
  // The acknowledgement comes late, and moves the sender's bits by the jump width.
  const can::Duration quantum = can::bit_time(1, 250'000) / 16;
  EXPECT_EQ(bus.stations[0]->sent, (std::vector<Heard>{{frame, ideal + 2 * quantum}}));
  const can::Duration near = 120ns + 20 * 5ns;
  const can::Duration far = 120ns + 100 * 5ns;
  EXPECT_GE(bus.stations[1]->heard[0].at, ideal + near);
  EXPECT_LE(bus.stations[1]->heard[0].at, ideal + near + quantum);
  EXPECT_GE(bus.stations[2]->heard[0].at, ideal + far);
  EXPECT_LE(bus.stations[2]->heard[0].at, ideal + far + quantum);
}

// An error passive sender's flag destroys nothing any more: then the receiver hears a frame that is not acknowledged for
// its sender.
TEST(BusLine, AcknowledgementsThatComeTooLate_MakeTheSenderPassive) {
  const Line line{.length = 200};
  LineBus bus(1'000'000, 2, &line);
  bus.stations[0]->send_at(can::Time(1ms), data_frame(0x181, {1, 2, 3}));
  bus.run_until(can::Time(2ms));
  EXPECT_TRUE(bus.stations[1]->heard.empty());
  bus.run_until(can::Time(20ms));
  EXPECT_EQ(bus.stations[0]->port.error_state(), can::ErrorState::error_passive);
  EXPECT_TRUE(bus.stations[0]->sent.empty());
}

std::uint64_t errors_between(const Line& line) {
  LineBus bus(1'000'000, 2, &line);
  bus.stations[0]->send_at(can::Time(1ms), data_frame(0x181, {0xF8, 0x78, 0x78, 0x78, 0x78, 0x78}));
  bus.run_until(can::Time(1200us));
  return bus.errors();
}

TEST(BusLine, NodesWithoutPlaceAndClock_AreAtBothEndsFastAndSlow) {
  EXPECT_GT(errors_between({.length = 70}), 0U);
  EXPECT_EQ(errors_between({.clock_ppm = 1'000}), 0U);
  EXPECT_GT(errors_between({.clock_ppm = 15'000}), 0U);
}

TEST(BusLine, AStub_IsMoreWay) {
  EXPECT_EQ(errors_between({.length = 40, .stub = 8}), 0U);
  EXPECT_GT(errors_between({.length = 40, .stub = 15}), 0U);
  EXPECT_GT(errors_between({.length = 40, .nodes = {{.port = "1", .stub = 30}}}), 0U);
}

TEST(BusLine, TripleSampling_OutvotesWhatASampleAloneWouldSee) {
  const auto errors = [](bool triple) {
    const Line line{.timing = {.triple_sampling = triple}};
    LineBus bus(1'000'000, 2, &line);
    // A dominant level of one quantum, at the sample point of a recessive bit of nobody's frame.
    Fault glitch{.kind = FaultKind::drive, .identifier = 0x181, .levels = {DrivenLevel::dominant}};
    glitch.bit = 30;
    glitch.bit_time = 120ns;
    glitch.levels = {DrivenLevel::released, DrivenLevel::released, DrivenLevel::released,
                     DrivenLevel::released, DrivenLevel::released, DrivenLevel::released,
                     DrivenLevel::released, DrivenLevel::dominant};
    EXPECT_TRUE(bus.bus.set_faults({glitch}, 1).has_value());
    bus.stations[0]->send_at(can::Time(1ms), data_frame(0x181, {0xFF, 0xFF, 0xFF}));
    bus.run_until(can::Time(2ms));
    return bus.errors();
  };
  EXPECT_GT(errors(false), 0U);
  EXPECT_EQ(errors(true), 0U);
}

struct BusLineWithFaults : ::testing::Test {
  void faults(const std::vector<Fault>& list) {
    const auto set = bus.bus.set_faults(list, 1);
    ASSERT_TRUE(set.has_value()) << set.error();
  }
  [[nodiscard]] Station& station(unsigned number) const { return *bus.stations[number]; }

  const Line line{.length = 30, .clock_ppm = 50};
  LineBus bus{500'000, 3, &line};
  const Frame frame = data_frame(0x181, {1, 2, 3});
};

TEST_F(BusLineWithFaults, CorruptedAtOneReceiver_ItAloneFindsTheFirstError) {
  faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "2", .bit = 20}});
  station(0).send_at(can::Time(1ms), frame);
  bus.run_until(can::Time(10ms));
  EXPECT_GT(station(2).port.counters().errors, 0U);
  EXPECT_EQ(station(1).frames(), (std::vector<Frame>{frame}));
}

TEST_F(BusLineWithFaults, Cut_TheFarSideHearsNothing) {
  faults({{.kind = FaultKind::cut, .from = can::Time(100us), .until = can::Time(5ms), .ports = {"2"}}});
  const Frame other = data_frame(0x281);
  station(0).send_at(can::Time(1ms), frame);
  station(2).send_at(can::Time(1ms) + 30us, other);
  bus.run_until(can::Time(4ms));
  EXPECT_EQ(station(1).frames(), (std::vector<Frame>{frame}));
  EXPECT_TRUE(station(2).heard.empty());
  EXPECT_EQ(station(0).port.counters().errors + station(1).port.counters().errors, 0U);
  station(0).send_at(can::Time(16ms), frame);
  bus.run_until(can::Time(30ms));
  EXPECT_EQ(station(2).frames(), (std::vector<Frame>{frame}));
  EXPECT_EQ(station(1).frames(), (std::vector<Frame>{frame, other, frame}));
}

TEST_F(BusLineWithFaults, StuckDominant_StopsTheBusUntilItIsUnplugged) {
  faults({{.kind = FaultKind::stuck_dominant, .from = can::Time(500us), .ports = {"2"}}});
  station(0).send_at(can::Time(1ms), frame);
  bus.run_until(can::Time(4ms));
  EXPECT_TRUE(station(1).heard.empty());
  station(2).port.plug(false);
  bus.run_until(can::Time(100ms));
  EXPECT_EQ(station(1).frames(), (std::vector<Frame>{frame}));
}

TEST_F(BusLineWithFaults, ABitDriversBit_IsSeenByNodesThatAreIdle) {
  faults({{.kind = FaultKind::drive, .from = can::Time(1ms), .levels = {DrivenLevel::dominant}}});
  bus.run_until(can::Time(3ms));
  for (const auto& one : bus.stations) EXPECT_EQ(one->port.counters().errors, 1U) << one->port.name();
}

TEST_F(BusLineWithFaults, PluggedInLater_ItHearsWhatComes) {
  bus.run_until(can::Time(1ms));
  Station late(bus.bus, bus.timeline, "late");
  station(0).send_at(can::Time(2ms), frame);
  bus.run_until(can::Time(3ms));
  EXPECT_EQ(late.frames(), (std::vector<Frame>{frame}));
}

TEST(BusLine, TripleSamplingWithoutAnyDelay_CarriesFrames) {
  Line line{.transceiver_delay = {}, .timing = {.triple_sampling = true}};
  line.nodes = {{.port = "1", .place = 0}};
  EXPECT_EQ(errors_between(line), 0U);
}

TEST(BusLine, ClocksTooFarApart_DestroyFrames) {
  for (const double ppm : {3'100.0, 3'300.0, 20'000.0}) {
    const Line line{.nodes = {{.port = "0", .clock_ppm = ppm}, {.port = "1", .clock_ppm = -ppm}}};
    LineBus bus(1'000'000, 2, &line);
    for (int number = 0; number < 50; ++number) {
      bus.stations[0]->send_at(can::Time(1ms) + number * 200us,
                               data_frame(0x181, {0xF8, 0x78, 0x78, 0x78, 0x78, 0x78, 0x78, 0x78}));
    }
    bus.run_until(can::Time(100ms));
    if (ppm < 3'154) {
      EXPECT_EQ(bus.errors(), 0U);
      EXPECT_EQ(bus.stations[1]->heard.size(), 50U);
    } else {
      EXPECT_GT(bus.errors(), 0U) << ppm;
      EXPECT_GT(bus.bus.load(can::Time(100ms)).error_frames, 0U) << ppm;
    }
  }
}

}  // namespace
}  // namespace canopus::sim::bus_line_test
