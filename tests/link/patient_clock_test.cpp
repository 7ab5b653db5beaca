// The clock of those who wait for answers: a machine that stands still makes nobody late.
#include "canopus/link/patient_clock.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::link::patient_clock_test {
namespace {

using namespace std::chrono_literals;

TEST(PatientClock, LookedAtOftenIsTheRealClock) {
  PatientClock clock;
  clock.start(5s);
  for (can::Duration real = 5s; real <= 6s; real += 10ms) {
    clock.look(real);
    EXPECT_EQ(clock.at(real), real);
    EXPECT_EQ(clock.at(real + 9ms), real + 9ms);
  }
}

TEST(PatientClock, CountsLittleOfALongStandstill) {
  PatientClock clock;
  clock.start(0s);
  clock.look(10ms);
  EXPECT_EQ(clock.at(10s), 10ms + PatientClock::most);
  clock.look(10s);
  EXPECT_EQ(clock.at(10s), 10ms + PatientClock::most);
  clock.look(10s + 10ms);
  EXPECT_EQ(clock.at(10s + 15ms), 25ms + PatientClock::most);
}

RC_GTEST_PROP(PatientClock, NeverGoesBackAndNeverAhead, ()) {
  PatientClock clock;
  clock.start(0s);
  can::Duration real{0};
  can::Duration counted{0};
  for (const auto step :
       *rc::gen::container<std::vector<std::uint16_t>>(rc::gen::arbitrary<std::uint16_t>())) {
    real += std::chrono::microseconds(step);
    const can::Duration now = clock.at(real);
    RC_ASSERT(now >= counted);
    RC_ASSERT(now <= real);
    clock.look(real);
    RC_ASSERT(clock.at(real) == now);
    counted = now;
  }
}

}  // namespace
}  // namespace canopus::link::patient_clock_test
