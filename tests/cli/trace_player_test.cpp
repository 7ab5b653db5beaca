#include "canopus/cli/trace/trace_player.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::cli::trace_player_test {
namespace {

using namespace std::chrono_literals;

struct SentFrames final : can::Sink {
  bool send(const can::Frame& frame) override {
    if (full) return false;
    sent.push_back(frame.identifier);
    return true;
  }
  bool full = false;
  std::vector<std::uint32_t> sent;
};

class TracePlayerTest : public testing::Test {
 protected:
  TracePlayer::Source source() {
    return [this]() -> std::optional<TracePlayer::Step> {
      if (at == steps.size()) return std::nullopt;
      return steps[at++];
    };
  }
  static TracePlayer::Step step(can::Duration time, std::uint32_t identifier) {
    return {time, can::data_frame(identifier)};
  }
  std::vector<TracePlayer::Step> steps{step(0ms, 1), step(10ms, 2), step(30ms, 3)};
  std::size_t at = 0;
  SentFrames bus;
};

TEST_F(TracePlayerTest, Frames_AreSentAtTheirTimes) {
  TracePlayer player(bus, source(), 1);
  player.start(can::Time(1s), {});
  player.tick(can::Time(1s));
  EXPECT_EQ(bus.sent, (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(player.deadline(), can::Time(1s + 10ms));
  player.tick(can::Time(1s + 10ms));
  EXPECT_EQ(player.deadline(), can::Time(1s + 30ms));
  player.tick(can::Time(1s + 30ms));
  EXPECT_TRUE(player.is_done());
  EXPECT_EQ(player.sent(), 3U);
}

TEST_F(TracePlayerTest, TwiceAsFast_HalvesTheTimes) {
  TracePlayer player(bus, source(), 2);
  player.start(can::Time(1s), {});
  player.tick(can::Time(1s));
  EXPECT_EQ(player.deadline(), can::Time(1s + 5ms));
}

TEST_F(TracePlayerTest, AsFastAsTheBusTakesThem_WaitsForNothing) {
  TracePlayer player(bus, source(), 0);
  player.start(can::Time(1s), {});
  player.tick(can::Time(1s));
  EXPECT_TRUE(player.is_done());
  EXPECT_EQ(bus.sent, (std::vector<std::uint32_t>{1, 2, 3}));
}

TEST_F(TracePlayerTest, FullBus_IsTriedAgainAndLosesNothing) {
  TracePlayer player(bus, source(), 0);
  bus.full = true;
  player.start(can::Time(1s), {});
  player.tick(can::Time(1s));
  EXPECT_GT(player.deadline(), can::Time(1s));
  EXPECT_LT(player.deadline(), can::Time(1s + 100ms));
  EXPECT_TRUE(player.is_held());
  bus.full = false;
  player.tick(player.deadline());
  EXPECT_FALSE(player.is_held());
  EXPECT_EQ(bus.sent, (std::vector<std::uint32_t>{1, 2, 3}));
}

TEST_F(TracePlayerTest, TimeThatGoesBack_KeepsTheOrder) {
  steps = {step(0ms, 1), step(20ms, 2), step(5ms, 3)};
  TracePlayer player(bus, source(), 1);
  player.start(can::Time{}, {});
  player.tick(can::Time{});
  EXPECT_EQ(player.deadline(), can::Time(20ms));
  player.tick(can::Time(20ms));
  EXPECT_EQ(bus.sent, (std::vector<std::uint32_t>{1, 2, 3}));
}

TEST_F(TracePlayerTest, EmptyTrace_IsDoneAtOnce) {
  steps.clear();
  TracePlayer player(bus, source(), 1);
  player.start(can::Time{}, {});
  EXPECT_TRUE(player.is_done());
  EXPECT_EQ(player.deadline(), can::never);
}

TEST_F(TracePlayerTest, WhatIsLeftOutAtTheBegin_IsNotWaitedFor) {
  steps = {step(10s, 1), step(11s, 2)};
  TracePlayer player(bus, source(), 1);
  player.start(can::Time{}, 10s);
  player.tick(can::Time{});
  EXPECT_EQ(bus.sent, (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(player.deadline(), can::Time(1s));
}

/// A bus that takes so many frames in a row, then none so many times, and so on.
struct Reluctant final : can::Sink {
  bool send(const can::Frame& frame) override {
    if (left == 0) {
      takes = at == turns.size() || !takes;
      left = at == turns.size() ? ~0U : turns[at++];
      if (left == 0) return send(frame);
    }
    --left;
    if (takes) sent.push_back(frame.identifier);
    return takes;
  }
  std::vector<unsigned> turns;
  std::size_t at = 0;
  unsigned left = 0;
  bool takes = false;
  std::vector<std::uint32_t> sent;
};

RC_GTEST_PROP(TracePlayerProperties, BusThatTakesFramesNowAndThen_GetsAllInOrderAndNoneTooEarly, ()) {
  Reluctant bus;
  bus.turns = *rc::gen::container<std::vector<unsigned>>(rc::gen::inRange(0U, 300U));
  const auto count = *rc::gen::inRange(0U, 1000U);
  const auto apart = *rc::gen::element<can::Duration>(0ms, 1ms, 7ms);
  const auto speed = *rc::gen::element(0.0, 1.0, 3.0);
  std::uint32_t next = 0;
  TracePlayer player(
      bus,
      [&]() -> std::optional<TracePlayer::Step> {
        if (next == count) return std::nullopt;
        const std::uint32_t identifier = next++;
        return TracePlayer::Step{apart * identifier, can::data_frame(identifier)};
      },
      speed);
  player.start(can::Time{}, {});
  can::Time now{};
  for (unsigned ticks = 0; !player.is_done(); ++ticks) {
    RC_ASSERT(ticks < 100'000U);
    RC_ASSERT(player.deadline() != can::never);
    now = std::max(now, player.deadline());
    player.tick(now);
    RC_ASSERT(player.sent() == bus.sent.size());
    if (speed == 1 && !bus.sent.empty()) RC_ASSERT(now.time_since_epoch() >= apart * bus.sent.back());
  }
  RC_ASSERT(bus.sent.size() == count);
  for (std::uint32_t i = 0; i < count; ++i) RC_ASSERT(bus.sent[i] == i);
}

}  // namespace
}  // namespace canopus::cli::trace_player_test
