#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::rpdo_test {
namespace {

constexpr std::uint16_t rpdo1 = 0x1400;

struct RpdoTest : testing::Test, Conversation {
  int output(std::uint8_t sub = 1) { return node.dictionary().get<std::uint8_t>(0x6200, sub); }
};

TEST_F(RpdoTest, EventDriven_IsTakenOverAtReception) {
  set_up(rpdo1, {0x62000108, 0x64110110}, 0xFE);
  start();
  drain_events();
  EXPECT_EQ(receive("205 07 FE FF"), "");
  EXPECT_EQ(output(), 7);
  EXPECT_EQ(node.dictionary().get<std::int16_t>(0x6411, 1), -2);
  EXPECT_EQ(drain_events(), "rpdo 0");
}

TEST_F(RpdoTest, Synchronous_IsTakenOverAtTheNextSync) {
  set_up(rpdo1, {0x62000108}, 0xF0);
  start();
  drain_events();
  receive("205 07");
  receive("205 08");
  EXPECT_EQ(output(), 0);
  receive("080");
  EXPECT_EQ(output(), 8);
  EXPECT_EQ(drain_events(), "rpdo 0, sync 0");
  receive("080");
  EXPECT_EQ(drain_events(), "sync 0");
}

TEST_F(RpdoTest, OutsideOperational_IsNotProcessed) {
  set_up(rpdo1, {0x62000108}, 0xFE);
  EXPECT_EQ(receive("205 07"), "");
  EXPECT_EQ(output(), 0);
}

TEST_F(RpdoTest, ShorterFrame_IsDroppedAndReportedOnce) {
  set_up(rpdo1, {0x62000108, 0x62000208}, 0xFE);
  start();
  EXPECT_EQ(receive("205 07"), "085 10 82 11 00 00 00 00 00");
  EXPECT_EQ(receive("205 07"), "");
  EXPECT_EQ(output(), 0);
  EXPECT_EQ(receive("205 07 08"), "085 00 00 00 00 00 00 00 00");
  EXPECT_EQ(output(2), 8);
}

TEST_F(RpdoTest, LongerFrame_IsTakenAsFarAsMapped) {
  set_up(rpdo1, {0x62000108}, 0xFE);
  start();
  EXPECT_EQ(receive("205 07 08"), "085 20 82 11 00 00 00 00 00");
  EXPECT_EQ(output(), 7);
  EXPECT_EQ(output(2), 0);
}

TEST_F(RpdoTest, EventTimer_ReportsAMissingFrame) {
  set_up(rpdo1, {0x62000108}, 0xFE);
  write(rpdo1, 5, 50, 2);
  start();
  drain_events();
  EXPECT_EQ(wait(200ms), "");  // watching begins with the first frame
  receive("205 01");
  wait(40ms);
  receive("205 02");
  EXPECT_EQ(wait(200ms), "290: 085 50 82 11 00 00 00 00 00");
  EXPECT_EQ(drain_events(), "rpdo 0, rpdo 0, rpdo timed out 0");
  EXPECT_EQ(receive("205 03"), "085 00 00 00 00 00 00 00 00");
}

TEST_F(RpdoTest, DummyEntries_AreSkipped) {
  set_up(rpdo1, {0x00050008, 0x62000108, 0x00020008, 0x62000208}, 0xFE);
  start();
  receive("205 11 22 33 44");
  EXPECT_EQ(output(1), 0x22);
  EXPECT_EQ(output(2), 0x44);
}

TEST_F(RpdoTest, Bits_GoToTheirBooleans) {
  set_up(rpdo1, {0x62200101, 0x62200201, 0x00010001, 0x62200301, 0x62000108}, 0xFE);
  start();
  receive("205 FA 0F");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6220, 1), 0);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6220, 2), 1);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6220, 3), 1);
  EXPECT_EQ(output(), 0xFF);
}

TEST_F(RpdoTest, TwoRpdosOfOneIdentifier_BothTakeIt) {
  set_up(rpdo1, {0x62000108}, 0xFE);
  write(0x1601, 1, 0x62000208, 4);
  write(0x1601, 0, 1, 1);
  ASSERT_EQ(write(0x1401, 1, 0x205, 4), AbortCode::none);
  start();
  receive("205 07");
  EXPECT_EQ(output(1), 7);
  EXPECT_EQ(output(2), 7);
}

TEST_F(RpdoTest, AfterTheSynchronousWindow_IsIgnoredUntilTheNextSync) {
  write(0x1007, 0, 1000, 4);
  set_up(rpdo1, {0x62000108}, 0);
  start();
  receive("080");
  wait(2ms);
  receive("205 07");
  receive("080");
  EXPECT_EQ(output(), 0);
  wait(500us);
  receive("205 08");
  receive("080");
  EXPECT_EQ(output(), 8);
}

TEST_F(RpdoTest, AnotherIdentifier_TakesEffectAtOnce) {
  set_up(rpdo1, {0x62000108}, 0xFE);
  start();
  EXPECT_TRUE(node.wants(0x205));
  EXPECT_EQ(receive("605 23 00 14 01 05 02 00 80"), "585 60 00 14 01 00 00 00 00");
  EXPECT_EQ(receive("605 23 00 14 01 33 03 00 00"), "585 60 00 14 01 00 00 00 00");
  EXPECT_FALSE(node.wants(0x205));
  EXPECT_TRUE(node.wants(0x333));
  receive("333 09");
  EXPECT_EQ(output(), 9);
}

}  // namespace
}  // namespace canopus::canopen::rpdo_test
