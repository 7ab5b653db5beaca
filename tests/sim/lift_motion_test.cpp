// The S-curve of a lift's drive.

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/sim/lift/motion.hpp"

namespace canopus::sim::lift::lift_motion_test {
namespace {

using namespace std::chrono_literals;

constexpr double slack = 1e-6;

double seconds_of(can::Duration span) { return std::chrono::duration<double>(span).count(); }

TEST(LiftMotion, FullTravel_HasSevenPieces) {
  Motion motion(0);
  const MotionLimits limits{1000, 1000, 2000};
  motion.move_to(10'000, limits, can::Time{});
  // jerk 0.5 s, 0.5 s of full acceleration, jerk 0.5 s: 1 m/s after 1.5 s and 750 mm; as long at the end.
  EXPECT_NEAR(motion.at(can::Time{500ms}).acceleration, 1000, slack);
  EXPECT_NEAR(motion.at(can::Time{500ms}).velocity, 250, slack);
  EXPECT_NEAR(motion.at(can::Time{1s}).velocity, 750, slack);
  EXPECT_NEAR(motion.at(can::Time{1500ms}).velocity, 1000, slack);
  EXPECT_NEAR(motion.at(can::Time{1500ms}).position, 750, slack);
  EXPECT_NEAR(motion.at(can::Time{10s}).position, 9250, slack);
  EXPECT_FALSE(motion.is_done(can::Time{11499ms}));
  EXPECT_TRUE(motion.is_done(can::Time{11501ms}));
  EXPECT_EQ(motion.at(can::Time{12s}).position, 10'000);
  EXPECT_EQ(motion.at(can::Time{12s}).velocity, 0);
}

TEST(LiftMotion, ShortTravel_DoesNotReachItsSpeed) {
  Motion motion(5000);
  motion.move_to(4990, {1000, 1000, 1000}, can::Time{1s});
  // 10 mm in four pieces of constant jerk: t = cbrt(10 / 2000) s each.
  const double piece = std::cbrt(10.0 / 2000.0);
  const auto at = [&](double pieces) {
    return motion.at(can::Time{1s} + std::chrono::duration_cast<can::Duration>(
                                         std::chrono::duration<double>(pieces * piece)));
  };
  EXPECT_NEAR(at(2).velocity, -1000 * piece * piece, 1e-3);
  EXPECT_NEAR(at(2).position, 4995, 1e-3);
  EXPECT_EQ(at(4.01).position, 4990);
}

/// From rest or in the middle of something else.
RC_GTEST_PROP(LiftMotion, KeepsItsLimits_AndArrivesExactly, ()) {
  const auto within = [](int low, int high) { return static_cast<double>(*rc::gen::inRange(low, high + 1)); };
  const MotionLimits limits{within(200, 4000), within(100, 2000), within(100, 5000)};
  Motion motion(within(-50'000, 50'000));
  can::Time now{};
  const int orders = *rc::gen::inRange(1, 5);
  double target = 0;
  for (int order = 0; order < orders; ++order) {
    const bool last = order + 1 == orders;
    if (last || *rc::gen::inRange(0, 3) != 0) {
      target = within(-100'000, 100'000);
      motion.move_to(target, limits, now);
    } else {
      motion.run_at(within(-1000, 1000) / 1000 * limits.speed, limits, now);
    }
    MotionState before = motion.at(now);
    const can::Duration step = 20ms;
    for (int i = last ? 1'000'000 : *rc::gen::inRange(1, 2000); i > 0 && !motion.is_done(now); --i) {
      now += step;
      const MotionState is = motion.at(now);
      RC_ASSERT(std::abs(is.velocity) <= limits.speed + slack);
      RC_ASSERT(std::abs(is.acceleration) <= limits.acceleration + slack);
      RC_ASSERT(std::abs(is.acceleration - before.acceleration) <= limits.jerk * seconds_of(step) + slack);
      // What it shows fits together.
      const double middle = (is.velocity + before.velocity) / 2;
      RC_ASSERT(std::abs(is.position - before.position - middle * seconds_of(step)) <= limits.jerk * 1e-6);
      before = is;
    }
  }
  RC_ASSERT(motion.is_done(now));
  RC_ASSERT(motion.at(now).position == target);
  RC_ASSERT(motion.at(now).velocity == 0.0);
  RC_ASSERT(motion.at(now).acceleration == 0.0);
}

TEST(LiftMotion, Stops_AndGoesOnFromThere) {
  Motion motion(0);
  const MotionLimits limits{2000, 1000, 1000};
  motion.move_to(30'000, limits, can::Time{});
  motion.run_at(0, limits, can::Time{4s});
  EXPECT_TRUE(motion.is_done(can::Time{10s}));
  const double stopped = motion.at(can::Time{10s}).position;
  EXPECT_EQ(motion.at(can::Time{20s}).position, stopped);
  motion.move_to(30'000, limits, can::Time{20s});
  EXPECT_EQ(motion.at(can::Time{60s}).position, 30'000);
}

}  // namespace
}  // namespace canopus::sim::lift::lift_motion_test
