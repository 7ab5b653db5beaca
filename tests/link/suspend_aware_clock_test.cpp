// The clock of those who wait for answers: a machine that stands still makes nobody late.
#include "canopus/link/suspend_aware_clock.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::link::suspend_aware_clock_test {
namespace {

using namespace std::chrono_literals;

TEST(SuspendAwareClock, LookedAtOftenIsTheRealClock) {
  SuspendAwareClock clock;
  clock.start(5s);
  for (can::Duration real = 5s; real <= 6s; real += 10ms) {
    clock.advance(real);
    EXPECT_EQ(clock.at(real), real);
    EXPECT_EQ(clock.at(real + 9ms), real + 9ms);
  }
}

TEST(SuspendAwareClock, CountsLittleOfALongStandstill) {
  SuspendAwareClock clock;
  clock.start(0s);
  clock.advance(10ms);
  EXPECT_EQ(clock.at(10s), 10ms + SuspendAwareClock::most);
  clock.advance(10s);
  EXPECT_EQ(clock.at(10s), 10ms + SuspendAwareClock::most);
  clock.advance(10s + 10ms);
  EXPECT_EQ(clock.at(10s + 15ms), 25ms + SuspendAwareClock::most);
}

RC_GTEST_PROP(SuspendAwareClock, NeverGoesBackAndNeverAhead, ()) {
  SuspendAwareClock clock;
  clock.start(0s);
  can::Duration real{0};
  can::Duration counted{0};
  for (const auto step :
       *rc::gen::container<std::vector<std::uint16_t>>(rc::gen::arbitrary<std::uint16_t>())) {
    real += std::chrono::microseconds(step);
    const can::Duration now = clock.at(real);
    RC_ASSERT(now >= counted);
    RC_ASSERT(now <= real);
    clock.advance(real);
    RC_ASSERT(clock.at(real) == now);
    counted = now;
  }
}

}  // namespace
}  // namespace canopus::link::suspend_aware_clock_test
