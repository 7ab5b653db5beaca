#include "canopus/serve/pace.hpp"

#include <gtest/gtest.h>

namespace canopus::serve::pace_test {
namespace {

using namespace std::chrono_literals;

constexpr can::Time at(can::Duration moment) { return can::Time{} + moment; }

TEST(Pace, WokenInTime_RunsUpToNowWithoutLag) {
  Pace pace;
  const Pace::Step step = pace.step({.elapsed = 100ms}, at(0ms), at(100ms));
  EXPECT_EQ(step.run_until, at(100ms));
  EXPECT_EQ(step.lag, 0ms);
  EXPECT_EQ(step.suspended, 0ms);
}

TEST(Pace, WokenBeforeTheDeadline_HasNoLag) {
  Pace pace;
  const Pace::Step step = pace.step({.elapsed = 100ms}, at(0ms), at(900ms));
  EXPECT_EQ(step.run_until, at(100ms));
  EXPECT_EQ(step.lag, 0ms);
}

TEST(Pace, NothingDueForLong_IsNoLagAndNoSuspension) {
  Pace pace;
  const Pace::Step step = pace.step({.elapsed = 1h}, at(0ms), can::never);
  EXPECT_EQ(step.run_until, at(1h));
  EXPECT_EQ(step.lag, 0ms);
  EXPECT_EQ(step.suspended, 0ms);
}

TEST(Pace, LateForADeadline_IsLagAndCatchesUpInSlices) {
  Pace pace;
  Pace::Step step = pace.step({.elapsed = 150ms}, at(0ms), at(100ms));
  EXPECT_EQ(step.lag, 50ms);
  EXPECT_EQ(step.run_until, at(120ms));
  step = pace.step({.elapsed = 151ms}, at(120ms), at(121ms));
  EXPECT_EQ(step.lag, 30ms);
  EXPECT_EQ(step.run_until, at(141ms));
  step = pace.step({.elapsed = 152ms}, at(141ms), at(152ms));
  EXPECT_EQ(step.lag, 0ms);
  EXPECT_EQ(step.run_until, at(152ms));
}

TEST(Pace, PlantThatIsAlwaysTooSlow_LagsMoreAndMore) {
  Pace pace;
  can::Time now{};
  can::Duration lag{};
  for (can::Duration elapsed{}; elapsed < 60s; elapsed += 40ms) {  // a slice of 20 ms takes 40 ms
    const Pace::Step step = pace.step({.elapsed = elapsed}, now, now);
    EXPECT_EQ(step.suspended, 0ms);
    EXPECT_GE(step.lag, lag);
    lag = step.lag;
    now = step.run_until;
  }
  EXPECT_GT(lag, 29s);
}

TEST(Pace, StoppedBySignal_PlantTimeStandsStillAndNothingIsLate) {
  Pace pace;
  (void)pace.step({.elapsed = 1s}, at(0s), at(1s));
  Pace::Step step = pace.step({.elapsed = 3s, .continued = true}, at(1s), at(1100ms));
  EXPECT_EQ(step.suspended, 1900ms);
  EXPECT_EQ(step.lag, 0ms);
  EXPECT_EQ(step.run_until, at(1100ms));
  EXPECT_EQ(pace.elapsed_at(at(1200ms)), 3100ms);
  step = pace.step({.elapsed = 3100ms}, at(1100ms), at(1200ms));
  EXPECT_EQ(step.suspended, 0ms);
  EXPECT_EQ(step.lag, 0ms);
  EXPECT_EQ(step.run_until, at(1200ms));
}

TEST(Pace, StoppedWhileNothingWasDue_HasLostNothing) {
  Pace pace;
  const Pace::Step step = pace.step({.elapsed = 3s, .continued = true}, at(0s), at(4s));
  EXPECT_EQ(step.suspended, 0ms);
  EXPECT_EQ(step.run_until, at(3s));
}

TEST(Pace, StoppedWhileBehind_LagsNoMoreThanBefore) {
  Pace pace;
  (void)pace.step({.elapsed = 200ms}, at(0s), at(100ms));  // runs to 120 ms
  const Pace::Step step = pace.step({.elapsed = 10'200ms, .continued = true}, at(120ms), at(121ms));
  EXPECT_EQ(step.suspended, 10s);
  EXPECT_EQ(step.lag, 79ms);
}

TEST(Pace, GapLongerThanAnyScheduling_IsASuspensionWithoutItsSignalToo) {
  Pace pace;
  Pace::Step step = pace.step({.elapsed = 4'999ms}, at(0s), at(0s));
  EXPECT_EQ(step.suspended, 0ms);
  EXPECT_EQ(step.lag, 4'999ms);
  Pace frozen;
  step = frozen.step({.elapsed = 12s}, at(0s), at(0s));
  EXPECT_EQ(step.suspended, 12s);
  EXPECT_EQ(step.lag, 0ms);
}

TEST(Pace, MachineThatSlept_IsReportedAndItsClockStoodStillAnyway) {
  Pace pace;
  (void)pace.step({.elapsed = 1s}, at(0s), at(1s));
  Pace::Step step = pace.step({.elapsed = 1100ms, .asleep = 1h}, at(1s), at(1100ms));
  EXPECT_EQ(step.suspended, 1h);
  EXPECT_EQ(step.lag, 0ms);
  EXPECT_EQ(step.run_until, at(1100ms));
  step = pace.step({.elapsed = 1200ms, .asleep = 1h + 3ms}, at(1100ms), at(1200ms));
  EXPECT_EQ(step.suspended, 0ms);
}

TEST(Pace, WakesForEachDeadline_UnlessTheyMayWaitForEachOther) {
  Pace pace;
  EXPECT_EQ(pace.wake_for(at(100us), at(0ms)), at(100us));
  pace.wake_together(1ms);
  EXPECT_EQ(pace.wake_for(at(100us), at(0ms)), at(1ms));
  EXPECT_EQ(pace.wake_for(at(1ms), at(0ms)), at(1ms));
  EXPECT_EQ(pace.wake_for(at(1500us), at(0ms)), at(1500us)) << "alone there is nothing to wait for";
  EXPECT_EQ(pace.wake_for(can::never, at(0ms)), can::never);
}

TEST(Pace, WhileSomebodyOutsideMayWaitForAnAnswer_WakesForEachDeadline) {
  Pace pace;
  pace.wake_together(1ms);
  pace.attend(at(10ms));
  EXPECT_EQ(pace.wake_for(at(10100us), at(10ms)), at(10100us));
  const can::Time over = at(10ms) + Pace::attention;
  EXPECT_EQ(pace.wake_for(over, over - 1ns), over);
  EXPECT_EQ(pace.wake_for(over + 100us, over), over + 1ms);
}

// Plant time beside the clock.

TEST(Pace, Faster_GoesSoManyTimesAsFarFromThenOn) {
  Pace pace;
  EXPECT_EQ(pace.step({.elapsed = 100ms}, at(100ms), at(100ms)).run_until, at(100ms));
  pace.set_speed(10, at(100ms), 100ms);
  EXPECT_EQ(pace.speed(), 10);
  EXPECT_EQ(pace.elapsed_at(at(600ms)), 150ms);
  const Pace::Step step = pace.step({.elapsed = 101ms}, at(100ms), at(110ms));
  EXPECT_EQ(step.run_until, at(110ms));
  EXPECT_EQ(step.lag, 0ms);
}

TEST(Pace, Slower_GoesAPartOfIt) {
  Pace pace;
  pace.set_speed(0.1, at(0ms), 0ms);
  EXPECT_EQ(pace.step({.elapsed = 100ms}, at(0ms), at(50ms)).run_until, at(10ms));
  EXPECT_EQ(pace.elapsed_at(at(50ms)), 500ms);
}

TEST(Pace, StandingStill_NothingIsDueAndNothingIsLate) {
  Pace pace;
  pace.set_speed(0, at(100ms), 100ms);
  const Pace::Step step = pace.step({.elapsed = 1h}, at(100ms), at(101ms));
  EXPECT_EQ(step.run_until, at(100ms));
  EXPECT_EQ(step.lag, 0ms);
  EXPECT_EQ(step.suspended, 0ms);
  EXPECT_EQ(pace.elapsed_at(at(101ms)), can::Duration::max());
  // And goes on where it was.
  pace.set_speed(1, at(100ms), 1h);
  EXPECT_EQ(pace.elapsed_at(at(101ms)), 1h + 1ms);
  EXPECT_EQ(pace.step({.elapsed = 1h + 1ms}, at(100ms), at(101ms)).run_until, at(101ms));
}

TEST(Pace, UntilAMoment_ThenItStandsStill) {
  Pace pace;
  pace.set_speed(1, at(100ms), 5s, at(110ms));
  EXPECT_EQ(pace.elapsed_at(at(110ms)), 5010ms);
  EXPECT_EQ(pace.elapsed_at(at(110ms) + 1ns), can::Duration::max());
  const Pace::Step step = pace.step({.elapsed = 6s}, at(105ms), at(111ms));
  EXPECT_EQ(step.run_until, at(110ms));
  EXPECT_EQ(step.lag, 0ms);
}

TEST(Pace, UntilAMoment_IsWokenThereAndThenNoMore) {
  Pace pace;
  pace.set_speed(1, at(100ms), 5s, at(110ms));
  EXPECT_EQ(pace.elapsed_to_wake(at(105ms), at(100ms)), 5005ms);
  EXPECT_EQ(pace.elapsed_to_wake(at(111ms), at(105ms)), 5010ms);
  EXPECT_EQ(pace.elapsed_to_wake(at(111ms), at(110ms)), can::Duration::max());
  pace.set_speed(1, at(110ms), 9s);
  EXPECT_EQ(pace.elapsed_to_wake(at(111ms), at(110ms)), 9001ms);
}

TEST(Pace, FasterThanTheMachine_DoesNotCatchUpLater) {
  Pace pace;
  pace.set_speed(50, at(0ms), 0ms);
  can::Time now{};
  for (can::Duration elapsed{}; elapsed < 60s;
       elapsed += 20ms) {  // a slice of 20 ms takes 20 ms: no faster than the clock
    const Pace::Step step = pace.step({.elapsed = elapsed}, now, now);
    EXPECT_LE(step.lag, Pace::most_behind);
    EXPECT_EQ(step.suspended, 0ms);
    now = step.run_until;
  }
  EXPECT_NEAR(can::seconds(now), 60, 0.1);
  // What is behind is run at once when it goes with the clock again: nothing.
  pace.set_speed(1, now, 60s);
  EXPECT_EQ(pace.step({.elapsed = 60s}, now, now).lag, 0ms);
}

TEST(Pace, Faster_ASuspensionIsOneOfTheClock) {
  Pace pace;
  pace.set_speed(10, at(0ms), 0ms);
  Pace::Step step = pace.step({.elapsed = 4s}, at(0ms), at(0ms));
  EXPECT_EQ(step.suspended, 0ms);
  step = pace.step({.elapsed = 10s}, at(20ms), at(20ms));
  EXPECT_GE(step.suspended, 5s);
}

TEST(Pace, Faster_DeadlinesAreWaitedForTogetherByTheClock) {
  Pace pace;
  pace.wake_together(1ms);
  pace.set_speed(10, at(0ms), 0ms);
  EXPECT_EQ(pace.wake_for(at(1ms), at(0ms)), at(10ms));
  pace.set_speed(0.1, at(0ms), 0ms);
  EXPECT_EQ(pace.wake_for(at(0ms), at(0ms)), at(1ms));
}

TEST(Pace, Slower_WhatIsFarAwayStaysAMoment) {
  Pace pace;
  pace.set_speed(0.01, at(0ms), 1h);
  EXPECT_GT(pace.elapsed_at(at(1000000h)), 1000000h);
  EXPECT_EQ(pace.elapsed_at(can::never), can::Duration::max());
}

}  // namespace
}  // namespace canopus::serve::pace_test
