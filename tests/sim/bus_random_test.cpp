// Random scripts on a bus: stations are plugged in and out, restarted, set to another bit rate or to listen,
// they send, abort and answer, frames and wires have faults; all at times to the nanosecond, close to each other
// and to where bits begin and are sampled. Whatever happens, time goes on, what the bus reports fits together,
// frames arrive, in the end everybody hears everybody, and frame by frame and bit by bit are the same bus.
//
// CANOPUS_SEEDS: so many scripts instead of 200, or of 1000 in ./check --all; RC_PARAMS=seed=N: others. With
// CANOPUS_FIRST_SEED=N each script has a seed of its own, from N on: several runs can share a range of seeds.

#include <cstdint>
#include <cstdlib>

#include "sim/bus_run.hpp"
#include "support/random_cases.hpp"

namespace canopus::sim::bus_random_test {
namespace {

using namespace random_script;

/// Empty, or what is wrong.
std::string complaints_of(const Script& script) {
  const Outcome frame_by_frame = Run(script, false)();
  if (std::string found = complaints(frame_by_frame); !found.empty()) return found;
  const Outcome bit_by_bit = Run(script, true)();
  if (std::string found = complaints(bit_by_bit); !found.empty()) return found;
  return first_difference(frame_by_frame, bit_by_bit);
}

void check_seeds(std::uint64_t first, unsigned count, bool rough) {
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const Script one = script_of(seed, rough);
    EXPECT_EQ(complaints_of(one), "") << "seed " << seed << ": " << one;
  }
}

void check_scripts(bool rough) {
  if (const char* first = std::getenv("CANOPUS_FIRST_SEED"); first != nullptr)
    return check_seeds(std::strtoull(first, nullptr, 10), support::random_cases(200, 1000), rough);
  const auto property = [rough] { RC_ASSERT(complaints_of(*script(rough)) == ""); };
  support::expect_property(property, 200, 1000);
}

TEST(BusRandom, CalmScripts_EveryFrameArrivesAndBothWaysOfWorkingAgree) { check_scripts(false); }
TEST(BusRandom, RoughScripts_TimeGoesOnTheBusHealsAndBothWaysOfWorkingAgree) { check_scripts(true); }

TEST(BusRandom, ACorruptionAtAPortBehindACut_LeavesTheOtherWireAlone) {
  EXPECT_EQ(complaints_of({.bit_rate = 500'000,
                           .stations = 6,
                           .faults = {501, 2330, 2610},
                           .steps = {{.station = 0, .gap_in_64th_bits = 2561, .nanoseconds = -2},
                                     {.station = 2, .gap_in_64th_bits = 56, .nanoseconds = -2},
                                     {.station = 0, .gap_in_64th_bits = 8, .nanoseconds = -2}}}),
            "");
}

TEST(BusRandom, APortThatIsMovedAtTheEndOfItsIntermission_BeginsItsFrame) {
  EXPECT_EQ(complaints_of({.bit_rate = 125'000,
                           .stations = 2,
                           .faults = {229, 1174, 1794},
                           .steps = {{.act = Act::abort, .station = 4, .gap_in_64th_bits = 33},
                                     {.act = Act::send, .station = 3, .value = 1569, .gap_in_64th_bits = 36},
                                     {.act = Act::send, .station = 1, .value = 13223},
                                     {.act = Act::send, .station = 12},
                                     {.act = Act::unplug, .station = 13, .gap_in_64th_bits = 29667}}}),
            "");
}

TEST(BusRandom, EdgesANanosecondApart_AreSampledAtTheSameMoments) {
  EXPECT_EQ(complaints_of(
                {.bit_rate = 500'000,
                 .stations = 4,
                 .faults = {867, 155, 1278},
                 .steps = {{.act = Act::send, .station = 15},
                           {.act = Act::send, .station = 11, .gap_in_64th_bits = 4390, .nanoseconds = -2},
                           {.act = Act::plug, .station = 0, .gap_in_64th_bits = 6314},
                           {.act = Act::send, .station = 2, .gap_in_64th_bits = 342},
                           {.act = Act::manual_recovery, .station = 2},
                           {.act = Act::restart, .station = 0, .gap_in_64th_bits = 25945},
                           {.act = Act::send, .station = 2, .gap_in_64th_bits = 45269, .nanoseconds = -2},
                           {.act = Act::send, .station = 0, .gap_in_64th_bits = 493, .nanoseconds = -2},
                           {.act = Act::plug, .station = 0, .gap_in_64th_bits = 21, .nanoseconds = 3322}}}),
            "");
}

TEST(BusRandom, ACorruptedStartOfFrameWhoseSenderIsUnplugged_LastsToTheEndOfItsBit) {
  EXPECT_EQ(complaints_of({.bit_rate = 250'000,
                           .stations = 2,
                           .faults = {2},
                           .steps = {{.act = Act::send, .station = 1},
                                     {.act = Act::unplug, .station = 1},
                                     {.act = Act::take_part, .station = 1, .gap_in_64th_bits = 64}}}),
            "");
}

}  // namespace
}  // namespace canopus::sim::bus_random_test
