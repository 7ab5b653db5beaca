#pragma once
// Random scripts of what can happen on a bus, at times to the nanosecond.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <ostream>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/sim/bus/bus.hpp"

#include "sim/bus_station.hpp"

namespace canopus::sim::random_script {

using namespace std::chrono_literals;
using can::Duration;
using can::Frame;
using can::Time;

enum class Act : std::uint8_t {
  send,
  send_burst,
  plug,
  unplug,
  restart,
  other_bit_rate,
  listen_only,
  take_part,
  manual_recovery,
  automatic_recovery,
  abort,
  add_station,
  new_faults,
};
inline constexpr const char* act_names[] = {
    "send",      "send burst", "plug",    "unplug", "restart",     "other bit rate", "listen only",
    "take part", "no recover", "recover", "abort",  "add station", "new faults"};

/// One thing that happens. Times are in 1/64 of a bit and nanoseconds after the step before, so that a script
/// gets shorter and simpler when rapidcheck shrinks it.
struct Step {
  Act act = Act::send;
  unsigned station = 0;
  unsigned value = 0;
  unsigned gap_in_64th_bits = 0;
  int nanoseconds = 0;
  bool after_the_bus = false;  // at one moment: after the bus has acted

  friend std::ostream& operator<<(std::ostream& out, const Step& step) {
    return out << "+" << step.gap_in_64th_bits / 64.0 << " bits " << step.nanoseconds << " ns"
               << (step.after_the_bus ? " after the bus" : "") << ": " << step.station << " "
               << act_names[static_cast<int>(step.act)] << " " << step.value;
  }
};

struct Script {
  std::uint32_t bit_rate = 1'000'000;
  unsigned stations = 2;
  bool answers = false;
  std::vector<unsigned> faults;  // see fault_of()
  std::vector<Step> steps;

  friend std::ostream& operator<<(std::ostream& out, const Script& script) {
    out << script.bit_rate << " bit/s, " << script.stations << " stations"
        << (script.answers ? " that answer" : "") << ", faults";
    for (const unsigned fault : script.faults) out << " " << fault;
    for (const Step& step : script.steps) out << "\n  " << step;
    return out << "\n";
  }
};

inline rc::Gen<Step> step(bool rough) {
  return rc::gen::exec([rough] {
    Step step;
    const auto calm = rc::gen::weightedElement<Act>({{12, Act::send}, {2, Act::send_burst}});
    const auto any = rc::gen::weightedElement<Act>({{12, Act::send},
                                                    {2, Act::send_burst},
                                                    {5, Act::plug},
                                                    {4, Act::unplug},
                                                    {3, Act::restart},
                                                    {1, Act::other_bit_rate},
                                                    {2, Act::listen_only},
                                                    {2, Act::take_part},
                                                    {1, Act::manual_recovery},
                                                    {1, Act::automatic_recovery},
                                                    {1, Act::abort},
                                                    {1, Act::add_station},
                                                    {1, Act::new_faults}});
    step.act = *(rough ? any : calm);
    step.station = *rc::gen::inRange(0U, 20U);
    step.value = *rc::gen::inRange(0U, 1U << 16);
    // Close together, about one integration apart, about one frame apart, far apart; on whole bits and off them.
    step.gap_in_64th_bits = *rc::gen::weightedOneOf<unsigned>(
        {{3, rc::gen::inRange(0U, 64U)},
         {3, rc::gen::inRange(0U, 14U * 64)},
         {2, rc::gen::map(rc::gen::inRange(0U, 30U), [](unsigned bits) { return 64 * bits; })},
         {3, rc::gen::inRange(0U, 140U * 64)},
         {1, rc::gen::inRange(0U, 1'000U * 64)}});
    step.nanoseconds = *rc::gen::weightedOneOf<int>(
        {{3, rc::gen::just(0)}, {2, rc::gen::inRange(-2, 3)}, {1, rc::gen::inRange(0, 4'000)}});
    step.after_the_bus = *rc::gen::arbitrary<bool>();
    return step;
  });
}

inline rc::Gen<Script> script(bool rough) {
  return rc::gen::exec([rough] {
    Script script;
    script.bit_rate = *rc::gen::element<std::uint32_t>(1'000'000, 800'000, 500'000, 250'000, 125'000, 10'000);
    script.stations =
        *rc::gen::weightedOneOf<unsigned>({{5, rc::gen::inRange(1U, 7U)}, {1, rc::gen::inRange(7U, 21U)}});
    script.answers = *rc::gen::arbitrary<bool>();
    if (rough) {
      script.faults =
          *rc::gen::scale(0.05, rc::gen::container<std::vector<unsigned>>(rc::gen::inRange(0U, 1U << 16)));
    }
    script.steps = *rc::gen::container<std::vector<Step>>(step(rough));
    return script;
  });
}

/// The script of this seed, whatever was tried before it. Their sizes go round.
inline Script script_of(std::uint64_t seed, bool rough) {
  return script(rough)(rc::Random(seed), static_cast<int>(1 + seed % 100)).value();
}

}  // namespace canopus::sim::random_script
