#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::sync_test {
namespace {

struct SyncTest : testing::Test, Conversation {};

TEST_F(SyncTest, Producer_SendsEveryPeriodAfterBit30IsSet) {
  write(0x1006, 0, 10000, 4);
  EXPECT_EQ(wait(15ms), "");
  EXPECT_EQ(write(0x1005, 0, 0x40000080, 4), AbortCode::none);
  EXPECT_EQ(wait(25ms), "25: 080 | 35: 080");
  EXPECT_EQ(write(0x1005, 0, 0x80, 4), AbortCode::none);
  EXPECT_EQ(wait(25ms), "");
}

TEST_F(SyncTest, Counter_RunsFromOneToItsOverflowValue) {
  write(0x1019, 0, 3, 1);
  write(0x1006, 0, 10000, 4);
  write(0x1005, 0, 0x40000080, 4);
  EXPECT_EQ(wait(40ms), "10: 080 01 | 20: 080 02 | 30: 080 03 | 40: 080 01");
}

TEST_F(SyncTest, InStopped_NothingIsProducedAndTheCounterStartsAnew) {
  write(0x1019, 0, 3, 1);
  write(0x1006, 0, 10000, 4);
  write(0x1005, 0, 0x40000080, 4);
  wait(10ms);
  receive("000 02 05");
  EXPECT_EQ(wait(50ms), "");
  receive("000 80 05");
  EXPECT_EQ(wait(10ms), "70: 080 01");
}

TEST_F(SyncTest, OwnSync_TriggersOwnTpdos) {
  set_up(0x1800, {0x60000108}, 1);
  write(0x1006, 0, 10000, 4);
  write(0x1005, 0, 0x40000080, 4);
  start();
  EXPECT_EQ(wait(10ms), "10: 080 | 10: 185 00");
}

TEST_F(SyncTest, LengthThatDoesNotFitTheCounter_IsReportedAndNotActedUpon) {
  set_up(0x1800, {0x60000108}, 1);
  start();
  drain_events();
  EXPECT_EQ(receive("080 01"), "085 40 82 11 00 00 00 00 00");
  EXPECT_EQ(receive("080 02"), "");
  EXPECT_EQ(drain_events(), "");
  EXPECT_EQ(receive("080"), "085 00 00 00 00 00 00 00 00 | 185 00");
}

TEST_F(SyncTest, CobId_IsChecked) {
  EXPECT_EQ(write(0x1005, 0, 0x40000080, 4), AbortCode::none);
  EXPECT_EQ(write(0x1005, 0, 0x40000081, 4), AbortCode::invalid_value) << "while producing";
  EXPECT_EQ(write(0x1005, 0, 0x00000081, 4), AbortCode::none);
  EXPECT_EQ(write(0x1005, 0, 0x00000705, 4), AbortCode::invalid_value) << "restricted";
}

TEST_F(SyncTest, CounterOverflow_IsChecked) {
  EXPECT_EQ(write(0x1019, 0, 1, 1), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1019, 0, 241, 1), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1019, 0, 240, 1), AbortCode::none);
  write(0x1006, 0, 1000, 4);
  EXPECT_EQ(write(0x1019, 0, 0, 1), AbortCode::device_state);
}

TEST(Sync, AsActiveMasterOnly_WhenSoConfigured) {
  Conversation c(NodeOptions{.sync_needs_active_master = true, .sync_period_resolution = 1ms});
  c.write(0x1006, 0, 5999, 4);
  c.write(0x1005, 0, 0x40000080, 4);
  EXPECT_EQ(c.wait(20ms), "");
  c.node.set_active_master(true, c.now);
  EXPECT_EQ(c.wait(12ms), "25: 080 | 30: 080");
  c.node.set_active_master(false, c.now);
  EXPECT_EQ(c.wait(12ms), "");
}

TEST(Sync, PeriodBelowItsResolution_ActsAsOneStep) {
  Conversation c(NodeOptions{.sync_period_resolution = 1ms});
  c.write(0x1006, 0, 1, 4);
  c.write(0x1005, 0, 0x40000080, 4);
  EXPECT_EQ(c.wait(2ms), "1: 080 | 2: 080");
}

struct TimeTest : testing::Test, Conversation {};

TEST_F(TimeTest, Consumer_TellsTheTime) {
  EXPECT_EQ(write(0x1012, 0, 0x80000100, 4), AbortCode::none);
  receive("100 40 E2 01 F0 10 27");
  EXPECT_EQ(drain_events(), "time 123456 10000");
  receive("100 40 E2 01 00 10");
  EXPECT_EQ(drain_events(), "");
}

TEST_F(TimeTest, WithoutBit31_NothingIsConsumed) {
  receive("100 40 E2 01 00 10 27");
  EXPECT_EQ(drain_events(), "");
}

TEST_F(TimeTest, Producer_NeedsBit30AndNotStopped) {
  EXPECT_FALSE(node.send_time({123456, 10000}, now));
  write(0x1012, 0, 0x40000100, 4);
  EXPECT_TRUE(node.send_time({123456, 10000}, now));
  EXPECT_EQ(bus.drain(), "100 40 E2 01 00 10 27");
  receive("000 02 05");
  EXPECT_FALSE(node.send_time({123456, 10000}, now));
}

}  // namespace
}  // namespace canopus::canopen::sync_test
