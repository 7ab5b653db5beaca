// Findings about a bus's length, bit rate and clocks. Where the limits are, sim::TimedLine works and fails.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "canopus/can/controller.hpp"
#include "canopus/plant/plant_review.hpp"

namespace canopus::plant {
namespace {

/// Lengths that CiA recommends, m, by bit rate.
constexpr std::array<std::pair<std::uint32_t, double>, 8> recommended_lengths = {{{1'000'000, 25},
                                                                                  {800'000, 50},
                                                                                  {500'000, 100},
                                                                                  {250'000, 250},
                                                                                  {125'000, 500},
                                                                                  {50'000, 1'000},
                                                                                  {20'000, 2'500},
                                                                                  {10'000, 5'000}}};

/// Times of a line at a bit rate, in nanoseconds.
struct LineTimes {
  LineTimes(const LineSection& line, std::uint32_t bit_rate)
      : quantum(1e9 / bit_rate / line.timing.quanta()),
        way((line.length + 2 * line.stub) * line.nanoseconds_per_metre +
            static_cast<double>(line.transceiver_delay.count())),
        propagation(quantum * line.timing.propagation),
        sample_point(quantum * line.timing.sample_point()) {}

  /// A level is there and its answer back, seen up to a quantum late, before the bit is sampled.
  [[nodiscard]] bool is_in_time() const { return 2 * way + quantum <= sample_point; }
  /// PHASE1 is left for clocks that differ.
  [[nodiscard]] bool fits_propagation() const { return 2 * way <= propagation; }

  double quantum;
  double way;  // from one end to the other
  double propagation;
  double sample_point;
};

/// "At most 57 m, or 800 kbit/s." `time`: there and back may take as long.
std::string advice(const LineSection& line, std::uint32_t bit_rate, double time,
                   bool (LineTimes::*is_good)() const) {
  const double metres =
      (time / 2 - static_cast<double>(line.transceiver_delay.count())) / line.nanoseconds_per_metre -
      2 * line.stub;
  std::string text = metres >= 1 ? fmt::format("At most {:.0f} m, or ", std::floor(metres)) : "At most ";
  std::uint32_t best = 0;
  for (const std::uint32_t rate : can::bit_rates) {
    if (rate < bit_rate && rate > best && (LineTimes(line, rate).*is_good)()) best = rate;
  }
  return best == 0 ? "No bit rate is slow enough" : text + fmt::format("{} kbit/s", best / 1000);
}

}  // namespace

void find_line_troubles(const BusSection& bus, Warnings& warnings) {
  if (!bus.line) return;
  const LineSection& line = *bus.line;
  const LineTimes times(line, bus.bit_rate);
  const auto warn = [&](const std::string& what) {
    warnings.push_back({line.place, fmt::format("bus \"{}\": {}", bus.name, what)});
  };
  const auto* recommended =
      std::ranges::find(recommended_lengths, bus.bit_rate, &std::pair<std::uint32_t, double>::first);
  if (!times.is_in_time()) {
    warn(fmt::format(
        "{:g} m are too long for {} kbit/s: a level takes {:.0f} ns to the other end, an acknowledgement as "
        "long "
        "back, and either may be seen a quantum ({:.4g} ns) late, but a bit is sampled after {:.0f} ns. {}",
        line.length, bus.bit_rate / 1000, times.way, times.quantum, times.sample_point,
        advice(line, bus.bit_rate, times.sample_point - times.quantum, &LineTimes::is_in_time)));
  } else if (!times.fits_propagation()) {
    warn(
        fmt::format("{:g} m at {} kbit/s: there and back takes {:.0f} ns, but the propagation segment has "
                    "{:.0f} ns; what it "
                    "takes of PHASE1 is missing for clocks that differ. {}",
                    line.length, bus.bit_rate / 1000, 2 * times.way, times.propagation,
                    advice(line, bus.bit_rate, times.propagation, &LineTimes::fits_propagation)));
  } else if (recommended != recommended_lengths.end() && line.length > recommended->second) {
    warn(fmt::format("{:g} m are more than the {:g} m that CiA recommends at {} kbit/s", line.length,
                     recommended->second, bus.bit_rate / 1000));
  }
  if (const unsigned tolerance = sim::clock_tolerance(line.timing); line.clock_ppm > tolerance) {
    warn(
        fmt::format("clocks that are off by {:g} ppm do not keep together: with PHASE1 {}, PHASE2 {} and SJW "
                    "{} of {} quanta at "
                    "most {} ppm do",
                    line.clock_ppm, line.timing.phase1, line.timing.phase2, line.timing.jump_width,
                    line.timing.quanta(), tolerance));
  }
}

}  // namespace canopus::plant
