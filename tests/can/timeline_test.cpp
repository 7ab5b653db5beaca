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

/// Ticks at these moments.
struct Appointments : Ticker {
  Appointments(std::string alarm_name, std::vector<Time> alarm_moments, std::vector<std::string>& alarm_log)
      : name(std::move(alarm_name)), moments(std::move(alarm_moments)), log(alarm_log) {
    set_alarm();
  }
  void tick(Time now) override {
    log.push_back(name + "@" + std::to_string(now.time_since_epoch() / 1ms));
    moments.erase(moments.begin());
    if (then) then();
    set_alarm();
  }
  void set(std::vector<Time> others) {
    moments = std::move(others);
    set_alarm();
  }
  void set_alarm() { alarm() = moments.empty() ? never : moments.front(); }

  std::string name;
  std::vector<Time> moments;
  std::vector<std::string>& log;
  std::function<void()> then;
};

using Log = std::vector<std::string>;

TEST(Timeline, RunUntil_TicksInOrderOfTime) {
  Log log;
  Timeline timeline;
  Appointments late("late", {Time(7ms)}, log);
  Appointments early("early", {Time(3ms), Time(9ms)}, log);
  timeline.add(late);
  timeline.add(early);
  timeline.run_until(Time(20ms));
  EXPECT_EQ(log, (Log{"early@3", "late@7", "early@9"}));
  EXPECT_EQ(timeline.now(), Time(20ms));
}

TEST(Timeline, RunUntil_TicksADeadlineAtTheEndAndNoneAfterIt) {
  Log log;
  Timeline timeline;
  Appointments alarm("a", {Time(5ms), Time(6ms)}, log);
  timeline.add(alarm);
  timeline.run_until(Time(5ms));
  EXPECT_EQ(log, (Log{"a@5"}));
  EXPECT_EQ(timeline.next(), Time(6ms));
}

TEST(Timeline, EqualDeadlines_TickByRankThenInTheOrderOfAdd) {
  Log log;
  Timeline timeline;
  Appointments bus("bus", {Time(1ms)}, log);
  Appointments first("first", {Time(1ms)}, log);
  Appointments second("second", {Time(1ms)}, log);
  timeline.add(bus, "bus", Timeline::Rank::bus);
  timeline.add(first);
  timeline.add(second);
  timeline.run_until(Time(1ms));
  EXPECT_EQ(log, (Log{"first@1", "second@1", "bus@1"}));
}

TEST(Timeline, AnAlarmThatIsSet_IsTheNewDeadlineAtOnce) {
  Log log;
  Timeline timeline;
  Appointments a("a", {Time(5ms)}, log);
  Appointments b("b", {Time(6ms)}, log);
  timeline.add(a);
  timeline.add(b);
  a.set({Time(8ms)});
  EXPECT_EQ(timeline.next(), Time(6ms));
  b.set({Time(2ms)});
  EXPECT_EQ(timeline.next(), Time(2ms));
}

TEST(Timeline, AnAlarmThatIsSetToTheMomentOfTheFirst_KeepsTheOrderOfAdd) {
  Log log;
  Timeline timeline;
  Appointments a("a", {Time(9ms)}, log);
  Appointments b("b", {Time(2ms)}, log);
  Appointments c("c", {Time(9ms)}, log);
  timeline.add(a);
  timeline.add(b);
  timeline.add(c);
  for (Appointments* late : {&c, &a}) late->set({Time(2ms)});
  timeline.run_until(Time(2ms));
  EXPECT_EQ(log, (Log{"a@2", "b@2", "c@2"}));
}

TEST(Timeline, WhereNobodyIsEverDue_ARunWithoutEndEnds) {
  Log log;
  Timeline timeline;
  Appointments idle("idle", {}, log);
  timeline.add_partition().add(idle);
  timeline.run_until(never);
  EXPECT_EQ(log, Log{});
}

TEST(Timeline, ADeadlineThatHasPassed_TicksAtOnceAndTimeDoesNotGoBack) {
  Log log;
  Timeline timeline;
  timeline.run_until(Time(10ms));
  Appointments alarm("a", {Time(4ms)}, log);
  timeline.add(alarm);
  timeline.run_until(Time(10ms));
  EXPECT_EQ(log, (Log{"a@10"}));
}

TEST(Timeline, Remove_InsideATick_TakesEffectAtOnce) {
  Log log;
  Timeline timeline;
  Appointments a("a", {Time(1ms)}, log);
  Appointments b("b", {Time(1ms)}, log);
  timeline.add(a);
  const auto handle_b = timeline.add(b);
  a.then = [&] { timeline.remove(handle_b); };
  timeline.run_until(Time(5ms));
  EXPECT_EQ(log, (Log{"a@1"}));
  EXPECT_EQ(timeline.next(), never);
}

TEST(Timeline, ABusThatGivesItsPlaceToAnotherInsideItsTick_HasNoFurtherOne) {
  Log log;
  Timeline timeline;
  Appointments first("first", {Time(1ms), Time(2ms), Time(3ms)}, log);
  Appointments second("second", {Time(4ms), Time(5ms)}, log);
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

/// Participants in a timeline, and a list of all their moments.
struct SortedAppointments {
  void add(std::vector<Time> moments) {
    std::sort(moments.begin(), moments.end());
    for (const Time moment : moments) all.emplace_back(moment, alarms.size());
    alarms.push_back(std::make_unique<Appointments>(std::to_string(alarms.size()), std::move(moments), log));
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
  std::vector<std::unique_ptr<Appointments>> alarms;
  std::vector<std::pair<Time, std::size_t>> all;
};

TEST(Timeline, RandomAlarms_TickAsASortedListHasThem) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 200; ++round) {
    SortedAppointments sorted;
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
    [[nodiscard]] auto place() const { return std::tuple(at, is_bus, number); }
    void set(Time time) {
      at = time;
      alarm() = time;
    }
    Crowd* crowd = nullptr;
    bool is_bus = false;
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
    member.set(some_time());
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
    is_in_order = is_in_order && member.is_there && timeline.stamp().time >= member.at && time <= end;
    for (const auto& other : members) {
      if (!other->is_there || other->number == member.number) continue;
      is_in_order = is_in_order && member.place() < other->place();
    }
    if (member.is_bus) {
      member.set(time + std::chrono::microseconds(1 + random() % 5));
    } else {
      member.set(later(std::max(some_time(), time), 1us));
    }
    Member& other = random() % 20 == 0 ? member : *members[random() % members.size()];
    if (other.is_there && random() % 2 == 0) {
      other.set(some_time());
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
  Appointments years("years", {Time(24h * 365 * 100)}, log);
  timeline.add(years);
  EXPECT_EQ(timeline.next(), Time(24h * 365 * 100));
  Appointments soon("soon", {Time(1ms)}, log);
  timeline.add(soon);
  EXPECT_EQ(timeline.next(), Time(1ms));
  timeline.run_until(Time(24h * 365 * 101));
  EXPECT_EQ(log.size(), 2U);
}

TEST(Timeline, MomentsHoursDaysAndYearsAway_TickAsASortedListHasThem) {
  constexpr Duration reaches[] = {1ms, 1h, 5h, 24h * 30, 24h * 365 * 90};
  std::mt19937_64 random(11);
  for (int round = 0; round < 200; ++round) {
    SortedAppointments sorted;
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
  explicit Insistent(std::uint64_t how_often, Time first = Time(1ms)) : times(how_often) { alarm() = first; }
  void tick(Time) override {
    ++ticks;
    if (times != for_ever && ticks % times == 0) alarm() = deadline() + 1ms;
    if (then) then();
  }

  static constexpr std::uint64_t for_ever = 0;
  std::uint64_t times;
  std::uint64_t ticks = 0;
  std::function<void()> then;
};

TEST(TimelineStall, AParticipantThatAsksForOneMomentWithoutEnd_IsTakenOutAndNamed) {
  Log log;
  Timeline timeline;
  std::vector<Timeline::Stall> stalls;
  timeline.set_stall_handler([&](const Timeline::Stall& stall) { stalls.push_back(stall); });
  Insistent spinner(Insistent::for_ever, Time(1500ms));
  Appointments other("other", {Time(1s), Time(1500ms), Time(2s)}, log);
  const auto handle = timeline.add(spinner, "bus main");
  timeline.add(other);
  timeline.run_until(Time(3s));
  ASSERT_EQ(stalls.size(), 1U);
  EXPECT_EQ(stalls[0].text(),
            "bus main sets its deadline to 1.500000000 s without end: it gets no ticks any more");
  EXPECT_LE(spinner.ticks, 2 * Timeline::most_ticks);
  EXPECT_EQ(log, (Log{"other@1000", "other@1500", "other@2000"}));
  EXPECT_EQ(timeline.now(), Time(3s));
  // It may go on setting its alarm, and whoever holds its handle using that.
  spinner.alarm() = Time(3500ms);
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
  timeline.add(one, "one");
  timeline.add(two, "two");
  one.then = [&] { two.alarm() = timeline.now(); };
  two.then = [&] { one.alarm() = timeline.now(); };
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
                 "slave 3 sets its deadline to 0.001000000 s without end: it gets no ticks any more");
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
  timeline.add(restless);
  for (std::uint32_t number = 0; number < 3 * Timeline::most_ticks; ++number) {
    restless.alarm() = Time(1ms);
    EXPECT_NO_THROW(timeline.run_until(Time(1ms)));
  }
}

TEST(Later, BeyondWhatTimeHolds_IsNever) {
  EXPECT_EQ(later(Time(1s), Duration::max()), never);
  EXPECT_EQ(later(never, 1ns), never);
  EXPECT_EQ(later(Time(1s), 2s), Time(3s));
}

TEST(Timeline, Partitions_RunTogetherInTheOrderOfOne) {
  const auto log_of = [](bool divided) {
    Log log;
    Timeline timeline;
    Timeline& one = divided ? timeline.add_partition() : timeline;
    Timeline& other = divided ? timeline.add_partition() : timeline;
    Appointments bus("bus", {Time(1ms), Time(3ms)}, log);
    Appointments a("a", {Time(1ms), Time(2ms), Time(3ms)}, log);
    Appointments b("b", {Time(1ms), Time(3ms)}, log);
    Appointments c("c", {Time(1ms), Time(3ms), Time(4ms)}, log);
    Appointments outside("outside", {Time(2ms), Time(3ms)}, log);
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

TEST(Timeline, WhoeverBelongsToNoPartitionAndIsMadeEarlierByOne_StillComesInOrder) {
  Log log;
  Timeline timeline;
  Timeline& part = timeline.add_partition();
  Appointments outside("outside", {Time(9ms)}, log);
  timeline.add(outside);
  Appointments first("first", {Time(1ms)}, log);
  Appointments second("second", {Time(1ms)}, log);
  first.then = [&] { outside.set({Time(1ms)}); };
  part.add(first);
  part.add(second);
  Appointments third("third", {Time(5ms)}, log);
  outside.then = [&] { second.set({Time(2ms)}); };
  timeline.add(third);
  timeline.run_until(Time(6ms));
  EXPECT_EQ(log, (Log{"first@1", "outside@1", "second@2", "third@5"}));
}

TEST(Timeline, AStampOfAPartitions_IsItsPlaceInTheOrderOfAll) {
  Log log;
  Timeline timeline;
  Timeline& one = timeline.add_partition();
  Timeline& other = timeline.add_partition();
  std::vector<std::pair<TickStamp, std::string>> said;
  const auto note = [&said](Timeline& line, std::string what) {
    return [&said, &line, what] {
      EXPECT_TRUE(line.runs_alone());
      said.emplace_back(line.stamp(), what);
    };
  };
  Appointments a("a", {Time(1ms)}, log);
  Appointments b("b", {Time(1ms)}, log);
  Appointments c("c", {Time(1ms)}, log);
  Appointments bus("bus", {Time(1ms)}, log);
  a.then = note(one, "a");
  b.then = note(other, "b");
  c.then = note(one, "c");
  bus.then = note(one, "bus");
  one.add(bus, "bus", Timeline::Rank::bus);
  one.add(a);
  other.add(b);
  one.add(c);
  other.run_partition(Time(2ms));
  one.run_partition(Time(2ms));
  timeline.join_partitions(Time(2ms));
  EXPECT_FALSE(one.runs_alone());
  std::ranges::sort(said);
  Log order;
  for (const auto& [moment, what] : said) order.push_back(what);
  EXPECT_EQ(order, (Log{"a", "b", "c", "bus"}));
}

}  // namespace
}  // namespace canopus::can::timeline_test
