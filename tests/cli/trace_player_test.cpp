#include "canopus/cli/trace/trace_player.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace canopus::cli {
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
  bus.full = false;
  player.tick(player.deadline());
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

}  // namespace
}  // namespace canopus::cli
