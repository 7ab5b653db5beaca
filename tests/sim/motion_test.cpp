// The way of one axis: within its limits, exactly to its target, from whatever it did before.

#include "canopus/sim/drive/motion.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

namespace canopus::sim::motion_test {
namespace {

using namespace canopus;
using namespace std::chrono_literals;
using can::Time;
using sim::Motion;
using sim::MotionLimits;

constexpr Time at(can::Duration since_start) { return Time{since_start}; }

TEST(MotionOfAnAxis, StandsWhereItIs) {
  Motion motion;
  motion.stand(-7.5);
  EXPECT_EQ(motion.at(at(3s)).position, -7.5);
  EXPECT_FALSE(motion.moves(at(0s)));
}

// 1 s up to 100/s over 50, 3 s evenly over 300, 1 s down over 50.
TEST(MotionOfAnAxis, AWayWithAnEvenStretch_HasThreeParts) {
  Motion motion;
  motion.move_to(400, {.speed = 100, .acceleration = 100, .deceleration = 100}, at(1s));
  EXPECT_EQ(motion.end(), at(6s));
  EXPECT_NEAR(motion.at(at(1500ms)).position, 12.5, 1e-9);
  EXPECT_NEAR(motion.at(at(1500ms)).velocity, 50, 1e-9);
  EXPECT_NEAR(motion.at(at(3s)).position, 150, 1e-9);
  EXPECT_NEAR(motion.at(at(5500ms)).position, 387.5, 1e-9);
  EXPECT_EQ(motion.at(at(6s)).position, 400);
  EXPECT_EQ(motion.at(at(6s)).velocity, 0);
  EXPECT_EQ(motion.at(at(60s)).position, 400);
}

// sqrt(100 * 100) = 100/s would be the peak of 100 units; 25 units reach 50/s.
TEST(MotionOfAnAxis, AShortWay_NeverReachesItsSpeed) {
  Motion motion;
  motion.move_to(-25, {.speed = 100, .acceleration = 100, .deceleration = 100}, at(0s));
  EXPECT_EQ(motion.end(), at(1s));
  EXPECT_NEAR(motion.at(at(500ms)).velocity, -50, 1e-9);
  EXPECT_EQ(motion.at(at(1s)).position, -25);
}

TEST(MotionOfAnAxis, ThatIsTooFastForItsTarget_ComesBack) {
  Motion motion;
  motion.run_at(100, {.speed = 0, .acceleration = 100, .deceleration = 100}, at(0s));  // 1 s, 50 units
  ASSERT_NEAR(motion.at(at(2s)).position, 150, 1e-9);
  motion.move_to(160, {.speed = 100, .acceleration = 100, .deceleration = 100}, at(2s));
  EXPECT_NEAR(motion.at(at(3s)).position, 200, 1e-9);  // at rest
  EXPECT_NEAR(motion.at(at(3s)).velocity, 0, 1e-9);
  EXPECT_EQ(motion.at(motion.end()).position, 160);
}

TEST(MotionOfAnAxis, RunsOnUntilItIsStopped) {
  Motion motion;
  motion.run_at(-10, {.speed = 0, .acceleration = 10, .deceleration = 5}, at(0s));
  EXPECT_EQ(motion.end(), at(1s));
  EXPECT_TRUE(motion.moves(at(100s)));
  EXPECT_NEAR(motion.at(at(11s)).position, -105, 1e-9);
  motion.stop(5, at(11s));
  EXPECT_EQ(motion.end(), at(13s));
  EXPECT_NEAR(motion.at(at(13s)).position, -115, 1e-9);
  EXPECT_FALSE(motion.moves(at(13s)));
}

// Commands at any moment of any motion: speed and acceleration within the limits, no jump, and the target is met.
RC_GTEST_PROP(MotionOfAnAxis, AnyCommands_KeepTheLimits, ()) {
  Motion motion;
  motion.stand(*rc::gen::inRange(-1000, 1000));
  Time now{};
  double highest_speed = 0;
  for (int i = 0; i < 6; ++i) {
    const MotionLimits limits{.speed = *rc::gen::inRange(1, 500) * 1.0,
                              .acceleration = *rc::gen::inRange(1, 2000) * 1.0,
                              .deceleration = *rc::gen::inRange(1, 2000) * 1.0};
    const double target = *rc::gen::inRange(-5000, 5000);
    const int kind = *rc::gen::inRange(0, 4);
    const Motion::State before = motion.at(now);
    highest_speed = std::max({limits.speed, std::abs(before.velocity)});
    if (kind == 0) motion.run_at(target >= 0 ? limits.speed : -limits.speed, limits, now);
    if (kind == 1) motion.stop(limits.deceleration, now);
    if (kind >= 2) motion.move_to(target, limits, now);
    RC_ASSERT(std::abs(motion.at(now).position - before.position) < 1e-6);
    RC_ASSERT(std::abs(motion.at(now).velocity - before.velocity) < 1e-6);
    if (kind >= 2) RC_ASSERT(motion.at(motion.end()).position == target);
    if (kind >= 1) RC_ASSERT(motion.at(motion.end()).velocity == 0);
    const double hardest = std::max(limits.acceleration, limits.deceleration);
    const int looks = *rc::gen::inRange(1, 40);
    const auto step = std::chrono::milliseconds(*rc::gen::inRange(1, 200));
    Motion::State last = motion.at(now);
    for (int look = 0; look < looks; ++look) {
      now += step;
      const Motion::State is = motion.at(now);
      const double seconds = std::chrono::duration<double>(step).count();
      RC_ASSERT(std::abs(is.velocity) <= highest_speed + 1e-6);
      RC_ASSERT(std::abs(is.velocity - last.velocity) <= hardest * seconds + 1e-6);
      RC_ASSERT(std::abs(is.position - last.position) <= highest_speed * seconds + 1e-5);
      last = is;
    }
  }
}

}  // namespace
}  // namespace canopus::sim::motion_test
