// Random scripts on a bus that is a line with length: within its limits it is the ideal bus but for times, and beyond them
// time goes on and the bus heals.
//
// CANOPUS_SEEDS: so many scripts instead of the number below; RC_PARAMS=seed=N: others. A share of them takes seconds, as
// most go bit by bit to their end.

#include "sim/bus_run.hpp"
#include "support/random_cases.hpp"

namespace canopus::sim::bus_line_random_test {
namespace {

using namespace random_script;

BitTiming any_timing() {
  BitTiming timing;
  timing.propagation = *rc::gen::inRange(3U, 9U);
  timing.phase1 = *rc::gen::inRange(2U, 9U);
  timing.phase2 = *rc::gen::inRange(3U, 9U);
  timing.jump_width = *rc::gen::inRange(2U, 1 + std::min({4U, timing.phase1, timing.phase2}));
  timing.triple_sampling = *rc::gen::arbitrary<bool>();
  return timing;
}

/// Nodes at any places, with any clocks that go together, on a line that is not too long: levels are there and back within
/// PROP but for the quantum by which they are seen late, and the one that triple sampling looks earlier each.
Line good_line(std::uint32_t bit_rate) {
  Line line{.timing = any_timing()};
  if (line.timing.quanta() < 8) line.timing.propagation = 8;
  const double quantum = 1e9 / bit_rate / line.timing.quanta();
  const unsigned early = line.timing.triple_sampling ? 2 : 0;
  const double way = quantum * std::max(0.5, (line.timing.propagation - 1.0 - early) / 2);
  line.transceiver_delay = can::Duration(static_cast<std::int64_t>(way / 4));
  line.length = 3 * way / 4 / line.nanoseconds_per_metre;
  const double ppm = std::min(500U, clock_tolerance(line.timing) / 3);
  for (int number = 0; number < 20; ++number) {
    line.nodes.push_back({.port = std::to_string(number),
                          .place = line.length * *rc::gen::inRange(0, 101) / 100,
                          .clock_ppm = ppm * *rc::gen::inRange(-100, 101) / 100});
  }
  return line;
}

/// Any line.
Line some_line() {
  Line line{.timing = any_timing()};
  if (line.timing.quanta() < 8) line.timing.propagation = 8;
  line.length = *rc::gen::inRange(0, 300);
  line.clock_ppm = *rc::gen::inRange(0, 30'000);
  return line;
}

/// What was heard and sent, without moments and order.
std::vector<std::string> without_times(const Outcome& outcome) {
  std::vector<std::string> lines;
  for (const std::string& line : outcome.lines) {
    const bool has_time = line.find(" heard ") != line.npos || line.find(" sent ") != line.npos;
    if (line.starts_with("frame ") || line.starts_with("error ")) continue;
    lines.push_back(has_time ? line.substr(0, line.rfind(' ')) : line);
  }
  std::sort(lines.begin(), lines.end());
  return lines;
}

void check_within_limits() {
  Script one = *script(false);
  one.stations = std::max(one.stations, 2U);  // how often a lone one repeats its frame depends on its clock
  const Line line = good_line(one.bit_rate);
  const Outcome ideal = Run(one, false)();
  const Outcome on_line = Run(one, false, &line)();
  RC_ASSERT(complaints(on_line) == "");
  RC_ASSERT(without_times(ideal) == without_times(on_line));
}

void check_any_line() {
  const Script one = *script(true);
  const Line line = some_line();
  const Outcome outcome = Run(one, false, &line)();
  for (const std::string& complaint : outcome.complaints) {
    const bool is_of_the_line = complaint.starts_with("a frame that begins before") ||
                                complaint.starts_with("frame ") || complaint.starts_with("station ") ||
                                complaint.starts_with("a station that stays") ||
                                complaint.starts_with("a wire that stays");
    if (!is_of_the_line) RC_FAIL(complaint);
  }
}

void check_healing() {
  const Script one = *script(true);
  const Line line = good_line(one.bit_rate);
  RC_ASSERT(complaints(Run(one, false, &line)()) == "");
}

/// An observer of the wire needs each bit of each port; without one ports act only where something may come of it.
void check_watched() {
  const Script one = *script(true);
  const Line line = good_line(one.bit_rate);
  RC_ASSERT(first_difference(Run(one, false, &line)(), Run(one, true, &line)()) == "");
}

TEST(BusLineRandom, ALineThatIsWatched_DoesTheSameAtTheSameMoments) {
  support::expect_property(check_watched, 20, 60);
}
TEST(BusLineRandom, WithinItsLimits_ALineIsTheIdealBusButForTimes) {
  support::expect_property(check_within_limits, 30, 100);
}
TEST(BusLineRandom, OnAnyLineWithAnyFaults_TimeGoesOnAndCountersAreRight) {
  support::expect_property(check_any_line, 4, 15);
}
TEST(BusLineRandom, OnAGoodLine_TheBusHealsFromAnyFaults) {
  support::expect_property(check_healing, 40, 100);
}

}  // namespace
}  // namespace canopus::sim::bus_line_random_test
