#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::emcy_test {
namespace {

struct EmcyTest : testing::Test, Conversation {
  bool raise(std::uint16_t code, std::uint8_t bits = 0) {
    const std::uint8_t manufacturer[5] = {1, 2, 3, 4, 5};
    return node.emergency(code, bits, manufacturer, now);
  }
};

TEST_F(EmcyTest, Error_SetsRegisterAndHistoryAndIsSent) {
  EXPECT_TRUE(raise(0x2310, 0x02));
  EXPECT_EQ(bus.drain(), "085 10 23 03 01 02 03 04 05");
  EXPECT_EQ(receive("605 40 01 10 00 00 00 00 00"), "585 4F 01 10 00 03 00 00 00");
  EXPECT_EQ(receive("605 40 03 10 00 00 00 00 00"), "585 4F 03 10 00 01 00 00 00");
  EXPECT_EQ(receive("605 40 03 10 01 00 00 00 00"), "585 43 03 10 01 10 23 01 02");
  EXPECT_EQ(receive("605 40 03 10 02 00 00 00 00"), "585 80 03 10 02 24 00 00 08");
}

TEST_F(EmcyTest, History_KeepsTheNewestFirst) {
  for (const int code : {0x1000, 0x2000, 0x3000, 0x4000}) raise(static_cast<std::uint16_t>(code));
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x1003, 0), 3);
  EXPECT_EQ(node.dictionary().get<std::uint16_t>(0x1003, 1), 0x4000);
  EXPECT_EQ(node.dictionary().get<std::uint16_t>(0x1003, 3), 0x2000);
}

TEST_F(EmcyTest, History_IsDeletedByZeroAlone) {
  raise(0x1000);
  bus.drain();
  EXPECT_EQ(receive("605 2F 03 10 00 01 00 00 00"), "585 80 03 10 00 30 00 09 06");
  EXPECT_EQ(receive("605 23 03 10 01 00 00 00 00"), "585 80 03 10 01 02 00 01 06");
  EXPECT_EQ(receive("605 2F 03 10 00 00 00 00 00"), "585 60 03 10 00 00 00 00 00");
  EXPECT_EQ(receive("605 40 03 10 01 00 00 00 00"), "585 80 03 10 01 24 00 00 08");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x1001, 0), 1);
}

TEST_F(EmcyTest, Reset_ClearsTheRegister) {
  raise(0x1000);
  bus.drain();
  EXPECT_TRUE(node.emergency_reset(now));
  EXPECT_EQ(bus.drain(), "085 00 00 00 00 00 00 00 00");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x1001, 0), 0);
}

TEST_F(EmcyTest, InhibitTime_RefusesTheApplication) {
  write(0x1015, 0, 50, 2);
  EXPECT_TRUE(raise(0x1000));
  wait(4ms);
  EXPECT_FALSE(raise(0x2000));
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x1003, 0), 1);
  wait(1ms);
  EXPECT_TRUE(raise(0x2000));
}

TEST_F(EmcyTest, InhibitTime_DelaysTheNodesOwnMessages) {
  write(0x1015, 0, 50, 2);
  EXPECT_EQ(receive("080 01"), "085 40 82 11 00 00 00 00 00");
  EXPECT_EQ(receive("080"), "");
  EXPECT_EQ(wait(10ms), "5: 085 00 00 00 00 00 00 00 00");
}

TEST_F(EmcyTest, InStopped_NothingIsSent) {
  receive("000 02 05");
  EXPECT_FALSE(raise(0x1000));
  EXPECT_EQ(bus.drain(), "");
}

TEST_F(EmcyTest, SwitchedOff_TheRegisterIsStillKept) {
  EXPECT_EQ(write(0x1014, 0, 0x80000085, 4), AbortCode::none);
  EXPECT_TRUE(raise(0x1000));
  EXPECT_EQ(bus.drain(), "");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x1001, 0), 1);
}

TEST_F(EmcyTest, Identifier_CannotBeChangedWhileValid) {
  EXPECT_EQ(write(0x1014, 0, 0x86, 4), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1014, 0, 0x80000086, 4), AbortCode::none);
  EXPECT_EQ(write(0x1014, 0, 0x86, 4), AbortCode::none);
  raise(0x1000);
  EXPECT_EQ(bus.drain(), "086 00 10 01 01 02 03 04 05");
}

TEST_F(EmcyTest, Consumer_HearsTheNodesOf1028H) {
  receive("089 10 23 03 01 02 03 04 05");
  EXPECT_EQ(drain_events(), "");
  EXPECT_EQ(write(0x1028, 9, 0x89, 4), AbortCode::none);
  receive("089 10 23 03 01 02 03 04 05");
  EXPECT_EQ(drain_events(), "emcy 9 8976 3 5");
  receive("089 10 23 03");
  EXPECT_EQ(drain_events(), "");
  receive("000 02 05");
  drain_events();
  receive("089 10 23 03 01 02 03 04 05");
  EXPECT_EQ(drain_events(), "");
}

TEST(Emcy, ClearingTheHistory_CanClearTheRegister) {
  Conversation c(NodeOptions{.history_clears_error_register = true, .empty_history_reads_zero = true});
  const std::uint8_t none[5] = {};
  c.node.emergency(0x1000, 0, none, c.now);
  EXPECT_EQ(c.write(0x1003, 0, 0, 1), AbortCode::none);
  EXPECT_EQ(c.node.dictionary().get<std::uint8_t>(0x1001, 0), 0);
  c.bus.drain();
  EXPECT_EQ(c.receive("605 40 03 10 01 00 00 00 00"), "585 43 03 10 01 00 00 00 00");
}

}  // namespace
}  // namespace canopus::canopen::emcy_test
