#include "canopus/can/timeline.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace canopus::can {
namespace {

using namespace std::chrono_literals;

struct Alarm : Participant {
  Alarm(std::string alarm_name, std::vector<Time> alarm_moments, std::vector<std::string>& alarm_log)
      : name(std::move(alarm_name)), moments(std::move(alarm_moments)), log(alarm_log) {}
  void receive(const Frame&, Time) override {}
  void tick(Time now) override {
    log.push_back(name + "@" + std::to_string(now.time_since_epoch() / 1ms));
    moments.erase(moments.begin());
    if (then) then();
  }
  [[nodiscard]] Time deadline() const noexcept override { return moments.empty() ? never : moments.front(); }

  std::string name;
  std::vector<Time> moments;
  std::vector<std::string>& log;
  std::function<void()> then;
};

using Log = std::vector<std::string>;

TEST(Timeline, RunUntil_TicksInOrderOfTime) {
  Log log;
  Timeline timeline;
  Alarm late("late", {Time(7ms)}, log);
  Alarm early("early", {Time(3ms), Time(9ms)}, log);
  timeline.add(late);
  timeline.add(early);
  timeline.run_until(Time(20ms));
  EXPECT_EQ(log, (Log{"early@3", "late@7", "early@9"}));
  EXPECT_EQ(timeline.now(), Time(20ms));
}

TEST(Timeline, RunUntil_TicksADeadlineAtTheEndAndNoneAfterIt) {
  Log log;
  Timeline timeline;
  Alarm alarm("a", {Time(5ms), Time(6ms)}, log);
  timeline.add(alarm);
  timeline.run_until(Time(5ms));
  EXPECT_EQ(log, (Log{"a@5"}));
  EXPECT_EQ(timeline.next(), Time(6ms));
}

TEST(Timeline, EqualDeadlines_TickByRankThenInTheOrderOfAdd) {
  Log log;
  Timeline timeline;
  Alarm bus("bus", {Time(1ms)}, log);
  Alarm first("first", {Time(1ms)}, log);
  Alarm second("second", {Time(1ms)}, log);
  timeline.add(bus, Timeline::Rank::bus);
  timeline.add(first);
  timeline.add(second);
  timeline.run_until(Time(1ms));
  EXPECT_EQ(log, (Log{"first@1", "second@1", "bus@1"}));
}

TEST(Timeline, Refresh_TakesOverAnEarlierAndALaterDeadline) {
  Log log;
  Timeline timeline;
  Alarm a("a", {Time(5ms)}, log);
  Alarm b("b", {Time(6ms)}, log);
  const auto handle_a = timeline.add(a);
  const auto handle_b = timeline.add(b);
  a.moments = {Time(8ms)};
  timeline.refresh(handle_a);
  EXPECT_EQ(timeline.next(), Time(6ms));
  b.moments = {Time(2ms)};
  timeline.refresh(handle_b);
  EXPECT_EQ(timeline.next(), Time(2ms));
}

TEST(Timeline, ADeadlineThatHasPassed_TicksAtOnceAndTimeDoesNotGoBack) {
  Log log;
  Timeline timeline;
  timeline.run_until(Time(10ms));
  Alarm alarm("a", {Time(4ms)}, log);
  timeline.add(alarm);
  timeline.run_until(Time(10ms));
  EXPECT_EQ(log, (Log{"a@10"}));
}

TEST(Timeline, Remove_InsideATick_TakesEffectAtOnce) {
  Log log;
  Timeline timeline;
  Alarm a("a", {Time(1ms)}, log);
  Alarm b("b", {Time(1ms)}, log);
  timeline.add(a);
  const auto handle_b = timeline.add(b);
  a.then = [&] { timeline.remove(handle_b); };
  timeline.run_until(Time(5ms));
  EXPECT_EQ(log, (Log{"a@1"}));
  EXPECT_EQ(timeline.next(), never);
}

TEST(Timeline, Empty_HasNoNextAndRuns) {
  Timeline timeline;
  EXPECT_EQ(timeline.next(), never);
  timeline.run_until(Time(1s));
  EXPECT_EQ(timeline.now(), Time(1s));
}

TEST(Timeline, RandomAlarms_TickAsASortedListHasThem) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 200; ++round) {
    Log log;
    Timeline timeline;
    std::vector<std::unique_ptr<Alarm>> alarms;
    std::vector<std::pair<Time, std::size_t>> all;
    for (std::size_t number = 0; number < 1 + random() % 40; ++number) {
      std::vector<Time> moments(random() % 10);
      for (Time& moment : moments) moment = Time(1ms * static_cast<std::int64_t>(random() % 50));
      std::sort(moments.begin(), moments.end());
      for (const Time moment : moments) all.emplace_back(moment, number);
      alarms.push_back(std::make_unique<Alarm>(std::to_string(number), moments, log));
      timeline.add(*alarms.back());
    }
    std::sort(all.begin(), all.end());
    Log expected;
    for (const auto& [moment, number] : all) {
      expected.push_back(std::to_string(number) + "@" + std::to_string(moment.time_since_epoch() / 1ms));
    }
    timeline.run_until(Time(1s));
    ASSERT_EQ(log, expected);
  }
}

TEST(Later, BeyondWhatTimeHolds_IsNever) {
  EXPECT_EQ(later(Time(1s), Duration::max()), never);
  EXPECT_EQ(later(never, 1ns), never);
  EXPECT_EQ(later(Time(1s), 2s), Time(3s));
}

}  // namespace
}  // namespace canopus::can
