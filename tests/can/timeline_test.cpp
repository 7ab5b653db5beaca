#include "canopus/can/timeline.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace canopus::can::timeline_test {
namespace {

using namespace std::chrono_literals;

struct Alarm : Ticker {
  Alarm(std::string alarm_name, std::vector<Time> alarm_moments, std::vector<std::string>& alarm_log)
      : name(std::move(alarm_name)), moments(std::move(alarm_moments)), log(alarm_log) {}
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
  timeline.add(bus, "bus", Timeline::Rank::bus);
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

TEST(Timeline, Refresh_ToTheMomentOfTheFirst_KeepsTheOrderOfAdd) {
  Log log;
  Timeline timeline;
  Alarm a("a", {Time(9ms)}, log);
  Alarm b("b", {Time(2ms)}, log);
  Alarm c("c", {Time(9ms)}, log);
  const auto handle_a = timeline.add(a);
  timeline.add(b);
  const auto handle_c = timeline.add(c);
  for (auto [alarm, handle] : {std::pair(&c, handle_c), std::pair(&a, handle_a)}) {
    alarm->moments = {Time(2ms)};
    timeline.refresh(handle);
  }
  timeline.run_until(Time(2ms));
  EXPECT_EQ(log, (Log{"a@2", "b@2", "c@2"}));
}

TEST(Timeline, WhereNobodyIsEverDue_ARunWithoutEndEnds) {
  Log log;
  Timeline timeline;
  Alarm idle("idle", {}, log);
  timeline.add_part().add(idle);
  timeline.run_until(never);
  EXPECT_EQ(log, Log{});
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

TEST(Timeline, ABusThatGivesItsPlaceToAnotherInsideItsTick_HasNoFurtherOne) {
  struct Bus final : Alarm {
    using Alarm::Alarm;
    Time tick_and_tell(Time now) override {
      tick(now);
      return deadline();
    }
  };
  Log log;
  Timeline timeline;
  Bus first("first", {Time(1ms), Time(2ms), Time(3ms)}, log);
  Bus second("second", {Time(4ms), Time(5ms)}, log);
  const auto handle = timeline.add(first, {}, Timeline::Rank::bus);
  first.then = [&] {
    timeline.remove(handle);
    timeline.add(second, {}, Timeline::Rank::bus);
  };
  timeline.run_until(Time(9ms));
  EXPECT_EQ(log, (Log{"first@1", "second@4", "second@5"}));
}

TEST(Timeline, Empty_HasNoNextAndRuns) {
  Timeline timeline;
  EXPECT_EQ(timeline.next(), never);
  timeline.run_until(Time(1s));
  EXPECT_EQ(timeline.now(), Time(1s));
}

/// Alarms in a timeline, and a list of all their moments.
struct SortedAlarms {
  void add(std::vector<Time> moments) {
    std::sort(moments.begin(), moments.end());
    for (const Time moment : moments) all.emplace_back(moment, alarms.size());
    alarms.push_back(std::make_unique<Alarm>(std::to_string(alarms.size()), std::move(moments), log));
    timeline.add(*alarms.back());
  }
  /// What the log has to be after all of them.
  [[nodiscard]] Log expected() {
    std::sort(all.begin(), all.end());
    Log sorted;
    for (const auto& [moment, number] : all)
      sorted.push_back(std::to_string(number) + "@" + std::to_string(moment.time_since_epoch() / 1ms));
    return sorted;
  }

  Log log;
  Timeline timeline;
  std::vector<std::unique_ptr<Alarm>> alarms;
  std::vector<std::pair<Time, std::size_t>> all;
};

TEST(Timeline, RandomAlarms_TickAsASortedListHasThem) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 200; ++round) {
    SortedAlarms sorted;
    for (std::size_t number = 0; number < 1 + random() % 40; ++number) {
      std::vector<Time> moments(random() % 10);
      for (Time& moment : moments) moment = Time(1ms * static_cast<std::int64_t>(random() % 50));
      sorted.add(std::move(moments));
    }
    sorted.timeline.run_until(Time(1s));
    ASSERT_EQ(sorted.log, sorted.expected());
  }
}

/// Deadlines from the present one to years away, moved and removed from inside of ticks: whoever ticks is always the
/// first of all.
struct Crowd {
  struct Member : Ticker {
    void tick(Time now) override { crowd->ticked(*this, now); }
    [[nodiscard]] Time deadline() const noexcept override { return at; }
    Time tick_and_tell(Time now) override {
      if (!tells) return Ticker::tick_and_tell(now);
      tick(now);
      return at;
    }
    [[nodiscard]] auto place() const { return std::tuple(at, is_bus, number); }
    Crowd* crowd = nullptr;
    bool is_bus = false;
    bool tells = false;
    std::size_t number = 0;
    Timeline::Handle handle = 0;
    Time at = never;
    bool is_there = true;
  };

  explicit Crowd(std::uint64_t seed) : random(seed) {}

  void add(bool is_bus = false) {
    Member& member = *members.emplace_back(std::make_unique<Member>());
    member.crowd = this;
    member.number = members.size() - 1;
    member.is_bus = is_bus;
    member.tells = is_bus || member.number % 2 == 1;
    member.at = some_time();
    member.handle = timeline.add(member, {}, is_bus ? Timeline::Rank::bus : Timeline::Rank::node);
  }
  Time some_time() {
    const auto kind = random() % 12;
    if (kind == 0) return never;
    if (kind == 1) return std::max(Time{}, now - Duration(static_cast<Duration::rep>(random() % 1'000'000)));
    if (kind == 2) return now;
    // Up to 2^kind us: near and far; whole microseconds, so that some are equal.
    const std::uint64_t reach = std::uint64_t{1} << 6 * (kind - 3);
    return later(now, std::chrono::microseconds(static_cast<Duration::rep>(random() % reach)));
  }
  void ticked(Member& member, Time time) {
    now = time;
    ++ticks;
    is_in_order = is_in_order && member.is_there && timeline.moment().time >= member.at && time <= end;
    for (const auto& other : members) {
      if (!other->is_there || other->number == member.number) continue;
      is_in_order = is_in_order && member.place() < other->place();
    }
    if (member.is_bus) {
      member.at = time + std::chrono::microseconds(1 + random() % 5);
    } else {
      member.at = later(std::max(some_time(), time), 1us);
    }
    Member& other = random() % 20 == 0 ? member : *members[random() % members.size()];
    if (other.is_there && random() % 2 == 0) {
      other.at = some_time();
      timeline.refresh(other.handle);
    }
    if (random() % 50 == 0 && other.is_there) {
      other.is_there = false;
      timeline.remove(other.handle);
    }
    if (random() % 50 == 0 && members.size() < 80) add(random() % 8 == 0);
  }
  [[nodiscard]] Time first() const {
    Time earliest = never;
    for (const auto& member : members) {
      if (member->is_there) earliest = std::min(earliest, member->at);
    }
    return earliest;
  }

  std::mt19937_64 random;
  Timeline timeline;
  std::vector<std::unique_ptr<Member>> members;
  Time now{};
  Time end = never;  // of the run
  std::uint64_t ticks = 0;
  bool is_in_order = true;
};

TEST(Timeline, DeadlinesNearAndYearsAway_MovedFromInside_TickInTheirOrder) {
  std::uint64_t ticks = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Crowd crowd(seed);
    for (std::size_t buses = seed % 3; buses > 0; --buses) crowd.add(true);
    for (std::size_t count = 1 + seed % 40; count > 0; --count) crowd.add();
    for (int step = 0; step < 60 && crowd.first() != never; ++step) {
      ASSERT_EQ(crowd.timeline.next(), crowd.first()) << "seed " << seed;
      const Time end = std::max(crowd.now, later(crowd.first(), Duration(1'000 * (step % 7))));
      crowd.end = end;
      crowd.timeline.run_until(end);
      crowd.now = end;
      ASSERT_TRUE(crowd.is_in_order) << "seed " << seed << ", step " << step;
      ASSERT_TRUE(crowd.first() > end) << "seed " << seed;
    }
    ticks += crowd.ticks;
  }
  EXPECT_GT(ticks, 2'000U);
}

TEST(Timeline, OneFarAway_IsFoundAtOnce) {
  Log log;
  Timeline timeline;
  Alarm years("years", {Time(24h * 365 * 100)}, log);
  timeline.add(years);
  EXPECT_EQ(timeline.next(), Time(24h * 365 * 100));
  Alarm soon("soon", {Time(1ms)}, log);
  timeline.add(soon);
  EXPECT_EQ(timeline.next(), Time(1ms));
  timeline.run_until(Time(24h * 365 * 101));
  EXPECT_EQ(log.size(), 2U);
}

TEST(Timeline, MomentsHoursDaysAndYearsAway_TickAsASortedListHasThem) {
  constexpr Duration reaches[] = {1ms, 1h, 5h, 24h * 30, 24h * 365 * 90};
  std::mt19937_64 random(11);
  for (int round = 0; round < 200; ++round) {
    SortedAlarms sorted;
    const std::size_t count = 1 + random() % 9;
    for (std::size_t number = 0; number < count; ++number) {
      std::vector<Time> moments(1 + random() % 5);
      for (Time& moment : moments)
        moment = Time(1ms * (1 + random() % 3) + reaches[random() % std::size(reaches)] * (random() % 3));
      sorted.add(std::move(moments));
    }
    sorted.timeline.run_until(Time(24h * 365 * 200));
    ASSERT_EQ(sorted.log, sorted.expected()) << "round " << round;
  }
}

/// Asks for each moment so often.
struct Insistent : Ticker {
  explicit Insistent(std::uint64_t how_often, Time first = Time(1ms)) : times(how_often), at(first) {}
  void tick(Time) override {
    ++ticks;
    if (times != for_ever && ticks % times == 0) at += 1ms;
    if (then) then();
  }
  [[nodiscard]] Time deadline() const noexcept override { return at; }

  static constexpr std::uint64_t for_ever = 0;
  std::uint64_t times;
  std::uint64_t ticks = 0;
  Time at;
  std::function<void()> then;
};

TEST(TimelineStall, AParticipantThatAsksForOneMomentWithoutEnd_IsTakenOutAndNamed) {
  Log log;
  Timeline timeline;
  std::vector<Timeline::Stall> stalls;
  timeline.set_stall_handler([&](const Timeline::Stall& stall) { stalls.push_back(stall); });
  Insistent spinner(Insistent::for_ever, Time(1500ms));
  Alarm other("other", {Time(1s), Time(1500ms), Time(2s)}, log);
  const auto handle = timeline.add(spinner, "bus main");
  timeline.add(other);
  timeline.run_until(Time(3s));
  ASSERT_EQ(stalls.size(), 1U);
  EXPECT_EQ(stalls[0].text(),
            "bus main asks for the moment 1.500000000 s without end: it gets no ticks any more");
  EXPECT_LE(spinner.ticks, 2 * Timeline::most_ticks);
  EXPECT_EQ(log, (Log{"other@1000", "other@1500", "other@2000"}));
  EXPECT_EQ(timeline.now(), Time(3s));
  // Whoever holds its handle may go on using it.
  timeline.refresh(handle);
  EXPECT_EQ(timeline.next(), never);
  timeline.remove(handle);
  timeline.run_until(Time(4s));
  EXPECT_EQ(stalls.size(), 1U);
}

TEST(TimelineStall, ADeadlineThatStaysInThePast_IsOneToo) {
  Timeline timeline;
  timeline.run_until(Time(1s));
  std::vector<Timeline::Stall> stalls;
  timeline.set_stall_handler([&](const Timeline::Stall& stall) { stalls.push_back(stall); });
  Insistent spinner(Insistent::for_ever, Time(1ms));
  timeline.add(spinner);
  timeline.run_until(Time(1s));
  ASSERT_EQ(stalls.size(), 1U);
  EXPECT_EQ(stalls[0].name, "participant 0");
  EXPECT_EQ(stalls[0].now, Time(1s));
}

TEST(TimelineStall, TwoThatWakeEachOther_AreFound) {
  Timeline timeline;
  std::vector<std::string> names;
  timeline.set_stall_handler([&](const Timeline::Stall& stall) { names.push_back(stall.name); });
  Insistent one(1);
  Insistent two(1);
  const auto first = timeline.add(one, "one");
  const auto second = timeline.add(two, "two");
  one.then = [&] {
    two.at = timeline.now();
    timeline.refresh(second);
  };
  two.then = [&] {
    one.at = timeline.now();
    timeline.refresh(first);
  };
  timeline.run_until(Time(1ms));
  EXPECT_EQ(names.size(), 1U);  // the other one has nobody who wakes it
  EXPECT_EQ(timeline.now(), Time(1ms));
}

TEST(TimelineStall, WithoutAHandler_IsThrown) {
  Timeline timeline;
  Insistent spinner(Insistent::for_ever);
  timeline.add(spinner, "slave 3");
  try {
    timeline.run_until(Time(1s));
    FAIL() << "nothing was thrown";
  } catch (const std::logic_error& error) {
    EXPECT_STREQ(error.what(),
                 "slave 3 asks for the moment 0.001000000 s without end: it gets no ticks any more");
  }
  timeline.run_until(Time(1s));
  EXPECT_EQ(timeline.now(), Time(1s));
}

TEST(TimelineStall, ManyTicksAtOneMoment_AreNoStall) {
  Timeline timeline;
  Insistent busy(Timeline::most_ticks / 2);
  Insistent as_busy(Timeline::most_ticks - 1);
  timeline.add(busy);
  timeline.add(as_busy);
  std::vector<std::unique_ptr<Insistent>> many;
  for (int number = 0; number < 3'000; ++number) {
    many.push_back(std::make_unique<Insistent>(10));
    timeline.add(*many.back());
  }
  EXPECT_NO_THROW(timeline.run_until(Time(3ms)));
  EXPECT_EQ(as_busy.ticks, 3 * (Timeline::most_ticks - 1));
  EXPECT_EQ(many.back()->ticks, 30U);
}

TEST(TimelineStall, RunUntilTheSameMomentAgainAndAgain_IsNoStall) {
  Timeline timeline;
  Insistent restless(1);
  const auto handle = timeline.add(restless);
  for (std::uint32_t number = 0; number < 3 * Timeline::most_ticks; ++number) {
    restless.at = Time(1ms);
    timeline.refresh(handle);
    EXPECT_NO_THROW(timeline.run_until(Time(1ms)));
  }
}

TEST(Later, BeyondWhatTimeHolds_IsNever) {
  EXPECT_EQ(later(Time(1s), Duration::max()), never);
  EXPECT_EQ(later(never, 1ns), never);
  EXPECT_EQ(later(Time(1s), 2s), Time(3s));
}

TEST(Timeline, Parts_RunTogetherInTheOrderOfOne) {
  const auto log_of = [](bool divided) {
    Log log;
    Timeline timeline;
    Timeline& one = divided ? timeline.add_part() : timeline;
    Timeline& other = divided ? timeline.add_part() : timeline;
    Alarm bus("bus", {Time(1ms), Time(3ms)}, log);
    Alarm a("a", {Time(1ms), Time(2ms), Time(3ms)}, log);
    Alarm b("b", {Time(1ms), Time(3ms)}, log);
    Alarm c("c", {Time(1ms), Time(3ms), Time(4ms)}, log);
    Alarm outside("outside", {Time(2ms), Time(3ms)}, log);
    one.add(bus, "bus", Timeline::Rank::bus);
    other.add(b);
    one.add(a);
    timeline.add(outside);
    other.add(c);
    timeline.run_until(Time(3ms));
    EXPECT_EQ(one.now(), Time(3ms));
    EXPECT_EQ(timeline.next(), Time(4ms));
    return log;
  };
  EXPECT_EQ(log_of(true), (Log{"b@1", "a@1", "c@1", "bus@1", "a@2", "outside@2", "b@3", "a@3", "outside@3",
                               "c@3", "bus@3"}));
  EXPECT_EQ(log_of(true), log_of(false));
}

TEST(Timeline, WhoeverBelongsToNoPartAndIsMadeEarlierByOne_StillComesInOrder) {
  Log log;
  Timeline timeline;
  Timeline& part = timeline.add_part();
  Alarm outside("outside", {Time(9ms)}, log);
  const auto handle = timeline.add(outside);
  Alarm first("first", {Time(1ms)}, log);
  Alarm second("second", {Time(1ms)}, log);
  first.then = [&] {
    outside.moments = {Time(1ms)};
    timeline.refresh(handle);
  };
  part.add(first);
  const auto second_handle = part.add(second);
  Alarm third("third", {Time(5ms)}, log);
  outside.then = [&] {
    second.moments = {Time(2ms)};
    part.refresh(second_handle);
  };
  timeline.add(third);
  timeline.run_until(Time(6ms));
  EXPECT_EQ(log, (Log{"first@1", "outside@1", "second@2", "third@5"}));
}

TEST(Timeline, AMomentOfAParts_IsItsPlaceInTheOrderOfAll) {
  Log log;
  Timeline timeline;
  Timeline& one = timeline.add_part();
  Timeline& other = timeline.add_part();
  std::vector<std::pair<Moment, std::string>> said;
  const auto say = [&said](Timeline& line, std::string what) {
    return [&said, &line, what] {
      EXPECT_TRUE(line.is_apart());
      said.emplace_back(line.moment(), what);
    };
  };
  Alarm a("a", {Time(1ms)}, log);
  Alarm b("b", {Time(1ms)}, log);
  Alarm c("c", {Time(1ms)}, log);
  Alarm bus("bus", {Time(1ms)}, log);
  a.then = say(one, "a");
  b.then = say(other, "b");
  c.then = say(one, "c");
  bus.then = say(one, "bus");
  one.add(bus, "bus", Timeline::Rank::bus);
  one.add(a);
  other.add(b);
  one.add(c);
  other.run_apart(Time(2ms));
  one.run_apart(Time(2ms));
  timeline.meet(Time(2ms));
  EXPECT_FALSE(one.is_apart());
  std::ranges::sort(said);
  Log order;
  for (const auto& [moment, what] : said) order.push_back(what);
  EXPECT_EQ(order, (Log{"a", "b", "c", "bus"}));
}

}  // namespace
}  // namespace canopus::can::timeline_test
