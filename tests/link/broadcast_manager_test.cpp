// Send jobs and filters of a client: what is sent when, and which frames are passed on.

#include "canopus/link/broadcast_manager.hpp"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::link::broadcast_manager_test {
namespace {

using can::Frame;
using can::Time;
using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

/// "20 123 11": at 20 ms.
std::string text(const Frame& frame, Time time) {
  std::string text = fmt::format("{} {:X}", time.time_since_epoch() / 1ms, frame.identifier);
  for (const std::uint8_t byte : frame.bytes()) text += fmt::format(" {:02X}", byte);
  return text;
}

class BroadcastManagerTest : public testing::Test, public can::Sink, public BroadcastManager::Receiver {
 protected:
  bool send(const Frame& frame) override {
    if (is_full) return false;
    sent.push_back(text(frame, now));
    return true;
  }
  void filtered_frame(const Frame& frame, Time time) override { passed.push_back(text(frame, time)); }
  void run_until(can::Duration end) {
    while (manager.deadline() <= Time{end}) {
      now = std::max(now, manager.deadline());
      manager.tick(now);
    }
    now = Time{end};
  }
  void hear(std::initializer_list<std::uint8_t> bytes, std::uint32_t identifier = 0x123) {
    manager.receive(can::data_frame(identifier, bytes), now);
  }

  Time now{};
  bool is_full = false;
  std::vector<std::string> sent;
  std::vector<std::string> passed;
  BroadcastManager manager{*this, *this};
};

TEST_F(BroadcastManagerTest, Job_IsSentAtOnceAndEachPeriod) {
  EXPECT_TRUE(manager.add(can::data_frame(0x123, {0x42}), 20ms, now));
  run_until(65ms);
  EXPECT_THAT(sent, ElementsAre("0 123 42", "20 123 42", "40 123 42", "60 123 42"));
}

TEST_F(BroadcastManagerTest, JobWithoutAPeriod_IsSentOnceAndStaysToBeUpdated) {
  EXPECT_TRUE(manager.add(can::data_frame(0x123, {0x42}), {}, now));
  run_until(1s);
  EXPECT_THAT(sent, ElementsAre("0 123 42"));
  EXPECT_TRUE(manager.update(can::data_frame(0x123, {0x43})));
  EXPECT_EQ(sent.size(), 1U) << "an update sends nothing";
}

TEST_F(BroadcastManagerTest, Update_ChangesTheContentAndKeepsTheTimes) {
  manager.add(can::data_frame(0x123, {0x42}), 20ms, now);
  run_until(30ms);
  EXPECT_TRUE(manager.update(can::data_frame(0x123, {1, 2})));
  run_until(45ms);
  EXPECT_THAT(sent, ElementsAre("0 123 42", "20 123 42", "40 123 01 02"));
  EXPECT_FALSE(manager.update(can::data_frame(0x124, {1})));
}

TEST_F(BroadcastManagerTest, SecondJobOfAnIdentifier_TakesThePlaceOfTheFirst) {
  manager.add(can::data_frame(0x123, {1}), 20ms, now);
  run_until(10ms);
  manager.add(can::data_frame(0x123, {2}), 50ms, now);
  Frame extended = can::data_frame(0x123, {3});
  extended.extended = true;
  manager.add(extended, 100ms, now);
  run_until(70ms);
  EXPECT_THAT(sent, ElementsAre("0 123 01", "10 123 02", "10 123 03", "60 123 02"));
}

TEST_F(BroadcastManagerTest, Delete_EndsAJob) {
  manager.add(can::data_frame(0x123, {1}), 20ms, now);
  EXPECT_TRUE(manager.remove({0x123, false}));
  EXPECT_FALSE(manager.remove({0x123, false}));
  EXPECT_FALSE(manager.remove({0x123, true}));
  EXPECT_EQ(manager.deadline(), can::never);
}

TEST_F(BroadcastManagerTest, FullBus_IsTriedAgainAndMissesPeriods) {
  is_full = true;
  manager.add(can::data_frame(0x123, {1}), 20ms, now);
  run_until(50ms);
  EXPECT_THAT(sent, IsEmpty());
  is_full = false;
  run_until(75ms);
  EXPECT_THAT(sent, ElementsAre("60 123 01"));
  is_full = true;
  manager.add(can::data_frame(0x124, {1}), {}, now);
  run_until(78ms);
  is_full = false;
  run_until(79ms);
  EXPECT_EQ(sent.back(), "79 124 01") << "a single frame is not lost";
}

TEST_F(BroadcastManagerTest, ShortPeriods_AreThoseOfTheShortestFrame) {
  manager.add(can::data_frame(0x123), 1ns, now);
  EXPECT_EQ(manager.deadline(), Time{47us});
}

TEST_F(BroadcastManagerTest, Subscription_PassesEveryFrameOfItsIdentifier) {
  EXPECT_TRUE(manager.subscribe({0x123, false}, {}));
  hear({1});
  hear({1});
  hear({1}, 0x124);
  manager.receive(can::remote_frame(0x123, 1), now);
  Frame extended = can::data_frame(0x123, {3});
  extended.extended = true;
  manager.receive(extended, now);
  EXPECT_THAT(passed, ElementsAre("0 123 01", "0 123 01"));
  EXPECT_TRUE(manager.unsubscribe({0x123, false}));
  EXPECT_FALSE(manager.unsubscribe({0x123, false}));
  hear({1});
  EXPECT_EQ(passed.size(), 2U);
}

TEST_F(BroadcastManagerTest, SubscriptionWithAnInterval_PassesTheLatestAtItsEnd) {
  manager.subscribe({0x123, false}, 100ms);
  hear({1});
  run_until(10ms);
  hear({2});
  run_until(20ms);
  hear({3});
  EXPECT_THAT(passed, ElementsAre("0 123 01"));
  run_until(100ms);
  EXPECT_THAT(passed, ElementsAre("0 123 01", "20 123 03")) << "with the time that it was on the bus";
  run_until(150ms);
  hear({4});
  EXPECT_EQ(passed.size(), 2U);
  run_until(400ms);
  EXPECT_EQ(passed.back(), "150 123 04");
  hear({5});
  EXPECT_EQ(passed.back(), "400 123 05") << "the interval has long ended";
}

TEST_F(BroadcastManagerTest, Filter_PassesTheFirstFrameAndChangesWithinItsMask) {
  manager.filter({0x123, false}, 0x00FF, {});
  hear({1, 1});
  hear({1, 2});
  hear({2, 2});
  hear({});
  EXPECT_THAT(passed, ElementsAre("0 123 01 01", "0 123 02 02", "0 123"));
}

TEST_F(BroadcastManagerTest, MultiplexFilter_ComparesEachNumberForItself) {
  // The first byte is the number; of 33H the second byte counts, of 56H the third.
  manager.filter_multiplex({0x123, false}, 0xFF, {0xFF33, 0xFF0056}, {});
  hear({0x33, 1, 1});
  hear({0x33, 1, 2});
  hear({0x56, 1, 1});
  hear({0x56, 2, 1});
  hear({0x33, 2, 1});
  hear({0x56, 2, 2});
  hear({0x44, 9, 9});
  EXPECT_THAT(passed, ElementsAre("0 123 33 01 01", "0 123 56 01 01", "0 123 33 02 01", "0 123 56 02 02"));
}

TEST_F(BroadcastManagerTest, IntervalOfAMultiplexFilter_KeepsTheLatestOfEachNumber) {
  manager.filter_multiplex({0x123, false}, 0xFF, {0xFF33, 0xFF56}, 100ms);
  hear({0x33, 1});
  hear({0x33, 2});
  hear({0x56, 1});
  hear({0x33, 3});
  EXPECT_THAT(passed, ElementsAre("0 123 33 01"));
  run_until(100ms);
  EXPECT_THAT(passed, ElementsAre("0 123 33 01", "0 123 33 03", "0 123 56 01"));
}

TEST_F(BroadcastManagerTest, JobsAndFilters_AreLimited) {
  for (std::uint32_t i = 0; i < BroadcastManager::most_jobs; ++i)
    EXPECT_TRUE(manager.add(can::data_frame(i, {1}), 1s, now));
  EXPECT_FALSE(manager.add(can::data_frame(0x700, {1}), 1s, now));
  EXPECT_TRUE(manager.add(can::data_frame(0, {2}), 1s, now)) << "in the place of another";
  for (std::uint32_t i = 0; i < BroadcastManager::most_filters; ++i)
    EXPECT_TRUE(manager.subscribe({i, false}, {}));
  EXPECT_FALSE(manager.subscribe({0x700, false}, {}));
  const std::vector<BroadcastManager::Content> many(BroadcastManager::most_contents, 1);
  EXPECT_FALSE(manager.filter_multiplex({0, false}, 0xFF, many, {}));
  manager.clear();
  EXPECT_TRUE(manager.filter_multiplex({0, false}, 0xFF, many, {}));
  EXPECT_EQ(manager.deadline(), can::never);
}

RC_GTEST_PROP(BroadcastManagerProperties, AFilterPassesWhatDiffersInItsMask, (std::uint64_t mask)) {
  struct Ends : can::Sink, BroadcastManager::Receiver {
    bool send(const Frame&) override { return true; }
    void filtered_frame(const Frame&, Time) override { ++count; }
    std::size_t count = 0;
  } ends;
  BroadcastManager manager(ends, ends);
  manager.filter({0x123, false}, mask, {});
  const auto contents = *rc::gen::container<std::vector<std::uint64_t>>(rc::gen::arbitrary<std::uint64_t>());
  std::size_t expected = 0;
  for (std::size_t i = 0; i < contents.size(); ++i) {
    Frame frame{.identifier = 0x123, .dlc = 8};
    for (unsigned byte = 0; byte < 8; ++byte)
      frame.data[byte] = static_cast<std::uint8_t>(contents[i] >> (8 * byte));
    manager.receive(frame, {});
    if (i == 0 || (contents[i] & mask) != (contents[i - 1] & mask)) ++expected;
  }
  RC_ASSERT(ends.count == expected);
}

}  // namespace
}  // namespace canopus::link::broadcast_manager_test
