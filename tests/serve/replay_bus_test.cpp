#include "canopus/serve/replay_bus.hpp"

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

namespace canopus::serve::replay_bus_test {
namespace {

using namespace std::chrono_literals;

class ReplayBusTest : public testing::Test, public link::BusClientListener {
 protected:
  ~ReplayBusTest() override { std::filesystem::remove(path); }
  void open(const std::string& trace, const std::string& channel = {}) {
    std::ofstream(path) << trace;
    auto opened = ReplayBus::open(path, channel, timeline);
    ASSERT_TRUE(opened) << opened.error();
    bus = std::move(*opened);
    bus->set_user(this);
  }
  void frame_received(const can::Frame&) override { ++frames; }
  void frame_sent(const can::Frame&) override {}
  void bus_lost(const std::string&) override {}
  void bus_complains(std::string_view text) override { complaints.emplace_back(text); }

  std::string path = testing::TempDir() + "replay_bus_" + std::to_string(::getpid()) + ".log";
  can::Timeline timeline;
  std::unique_ptr<ReplayBus> bus;
  int frames = 0;
  std::vector<std::string> complaints;
};

std::string lines(int count, const std::string& channel) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "(1.000000) " + channel + " 123#01\n";
  return text;
}

TEST_F(ReplayBusTest, TraceWhoseTimeStandsStill_IsPlayedInPortions) {
  open(lines(2500, "a"));
  timeline.run_until(can::Time{});
  EXPECT_EQ(frames, 1000);
  timeline.run_until(can::Time{1ms});
  EXPECT_EQ(frames, 2000);
  timeline.run_until(can::Time{2ms});
  EXPECT_EQ(frames, 2500);
}

TEST_F(ReplayBusTest, ManyFramesOfAnotherChannel_AreSkippedInPortions) {
  open(lines(1, "b") + lines(15'000, "a") + lines(1, "b"), "b");
  timeline.run_until(can::Time{});
  EXPECT_EQ(frames, 1);
  timeline.run_until(can::Time{1ms});
  EXPECT_EQ(frames, 2);
}

TEST_F(ReplayBusTest, ChannelThatBeginsLate_IsFound) {
  open(lines(25'000, "a") + lines(1, "b"), "b");
  timeline.run_until(can::Time{10ms});
  EXPECT_EQ(frames, 1);
}

TEST_F(ReplayBusTest, WhatTheTraceLeavesOut_IsSaidAtItsEnd) {
  open("(1.0) a 123#01\n(1.0) a 124##101\n(1.001) a 125#02\n");
  timeline.run_until(can::Time{10ms});
  EXPECT_EQ(frames, 2);
  EXPECT_EQ(complaints, std::vector<std::string>{"left out of the trace: 1 CAN FD frame"});
}

TEST_F(ReplayBusTest, TraceOfCanFdAlone_IsRefused) {
  std::ofstream(path) << "(1.0) a 124##101\n";
  const auto opened = ReplayBus::open(path, {}, timeline);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error(), path + ": nothing of it was read; left out: 1 CAN FD frame");
}

}  // namespace
}  // namespace canopus::serve::replay_bus_test
