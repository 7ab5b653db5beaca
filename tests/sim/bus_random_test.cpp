// Random scripts on a bus: stations are plugged in and out, restarted, set to another bit rate or to listen,
// they send, abort and answer, frames and wires have faults; all at times to the nanosecond, close to each other
// and to where bits begin and are sampled. Whatever happens, time goes on, what the bus reports fits together,
// frames arrive, in the end everybody hears everybody, and frame by frame and bit by bit are the same bus.
//
// CANOPUS_SEEDS: so many scripts instead of 200, or of 1000 in ./check --all; RC_PARAMS=seed=N: others.

#include "sim/bus_run.hpp"
#include "support/random_cases.hpp"

namespace canopus::sim::bus_random_test {
namespace {

using namespace random_script;

void check_scripts(bool rough) {
  const auto property = [rough] {
    const Script one = *script(rough);
    const Outcome frame_by_frame = Run(one, false)();
    RC_ASSERT(complaints(frame_by_frame) == "");
    const Outcome bit_by_bit = Run(one, true)();
    RC_ASSERT(complaints(bit_by_bit) == "");
    RC_ASSERT(first_difference(frame_by_frame, bit_by_bit) == "");
  };
  support::expect_property(property, 200, 1000);
}

TEST(BusRandom, CalmScripts_EveryFrameArrivesAndBothWaysOfWorkingAgree) { check_scripts(false); }
TEST(BusRandom, RoughScripts_TimeGoesOnTheBusHealsAndBothWaysOfWorkingAgree) { check_scripts(true); }

}  // namespace
}  // namespace canopus::sim::bus_random_test
