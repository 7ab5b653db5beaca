#include "canopus/can/alarm.hpp"

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/can/timeline.hpp"

namespace canopus::can::alarm_test {
namespace {

using namespace std::chrono_literals;

/// Writes down its ticks.
struct Sleeper final : Ticker {
  void tick(Time now) override {
    ticks.push_back(now);
    alarm().cancel();
  }
  std::vector<Time> ticks;
};

TEST(Alarm, OfAWhole_IsTheEarliestOfItsOwnAndItsParts) {
  Alarm whole;
  Alarm one;
  Alarm other;
  one = Time(3ms);
  whole.add_part(one);
  whole.add_part(other);
  EXPECT_EQ(whole.deadline(), Time(3ms));
  other = Time(2ms);
  EXPECT_EQ(whole.deadline(), Time(2ms));
  whole = Time(1ms);
  EXPECT_EQ(whole.deadline(), Time(1ms));
  whole.cancel();
  other.cancel();
  EXPECT_EQ(whole.deadline(), Time(3ms));
  whole.remove_part(one);
  EXPECT_EQ(whole.deadline(), never);
  one = Time(1ms);
  EXPECT_EQ(whole.deadline(), never) << "it is no part any more";
}

TEST(Alarm, OfAPartThatIsDestroyed_CountsNoMore) {
  Alarm whole;
  auto part = std::make_unique<Alarm>();
  whole.add_part(*part);
  *part = Time(1ms);
  part.reset();
  EXPECT_EQ(whole.deadline(), never);
}

TEST(Alarm, WhoseWholeIsDestroyed_BelongsToNobody) {
  Alarm part;
  {
    Alarm whole;
    whole.add_part(part);
  }
  part = Time(1ms);
  Alarm other;
  other.add_part(part);
  EXPECT_EQ(other.deadline(), Time(1ms));
}

TEST(Alarm, BringForward_NeverMakesItLater) {
  Alarm alarm;
  alarm.bring_forward(Time(2ms));
  alarm.bring_forward(Time(3ms));
  EXPECT_EQ(alarm.deadline(), Time(2ms));
}

TEST(Alarm, SetDeepInAPart_WakesTheParticipantOfTheWhole) {
  Timeline timeline;
  Sleeper sleeper;
  Alarm middle;
  Alarm part;
  sleeper.alarm().add_part(middle);
  middle.add_part(part);
  timeline.add(sleeper);
  EXPECT_EQ(timeline.next(), never);
  part = Time(2ms);
  EXPECT_EQ(timeline.next(), Time(2ms));
  part = Time(5ms);
  EXPECT_EQ(timeline.next(), Time(5ms));
}

TEST(Alarm, WhileItIsHeld_PassesNothingOn) {
  Timeline timeline;
  Sleeper sleeper;
  Alarm part;
  sleeper.alarm().add_part(part);
  timeline.add(sleeper);
  {
    const Alarm::Hold hold(sleeper.alarm());
    part = Time(1ms);
    part = Time(4ms);
    EXPECT_EQ(timeline.next(), never);
  }
  EXPECT_EQ(timeline.next(), Time(4ms));
}

TEST(Alarm, OfAParticipantThatIsDestroyed_LeavesTheTimeline) {
  Timeline timeline;
  auto sleeper = std::make_unique<Sleeper>();
  sleeper->alarm() = Time(1ms);
  timeline.add(*sleeper);
  sleeper.reset();
  EXPECT_EQ(timeline.next(), never);
  timeline.run_until(Time(2ms));
}

TEST(Alarm, OfATimelineThatIsDestroyed_MayGoOnBeingSet) {
  Sleeper sleeper;
  {
    Timeline timeline;
    timeline.add(sleeper);
  }
  sleeper.alarm() = Time(1ms);
  Timeline other;
  other.add(sleeper);
  other.run_until(Time(2ms));
  EXPECT_EQ(sleeper.ticks, std::vector{Time(1ms)});
}

TEST(Alarm, OfManyWholes_IsTheEarliestWhateverIsSetAndWhoeverGoes) {
  std::mt19937 random(7);
  for (int round = 0; round < 100; ++round) {
    Alarm whole;
    std::vector<std::unique_ptr<Alarm>> parts;
    Time own = never;
    for (int step = 0; step < 100; ++step) {
      const Time time = random() % 5 == 0 ? never : Time(1us * static_cast<std::int64_t>(random() % 20));
      switch (random() % 4) {
        case 0:
          parts.push_back(std::make_unique<Alarm>());
          *parts.back() = time;
          whole.add_part(*parts.back());
          break;
        case 1:
          if (!parts.empty())
            parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(random() % parts.size()));
          break;
        case 2:
          if (!parts.empty()) *parts[random() % parts.size()] = time;
          break;
        default: whole = own = time; break;
      }
      Time earliest = own;
      for (const auto& part : parts) earliest = std::min(earliest, part->deadline());
      ASSERT_EQ(whole.deadline(), earliest) << "round " << round << ", step " << step;
    }
  }
}

}  // namespace
}  // namespace canopus::can::alarm_test
