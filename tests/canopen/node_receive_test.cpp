// What nearly all frames on a bus are, for one node: PDOs and heartbeats, of its own and of others.

#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::node_receive_test {
namespace {

struct NodeReceiveTest : testing::Test, Conversation {};

TEST_F(NodeReceiveTest, AFrameOfItsRpdo_IsProcessData) {
  set_up(0x1400, {0x62000108}, 0xFE);
  start();
  take_events();
  EXPECT_EQ(hear("205 07"), "");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 7);
  EXPECT_EQ(take_events(), "rpdo 0");
}

TEST_F(NodeReceiveTest, AFrameOfAnotherLength_IsAnError_UntilTheNextGoodOne) {
  set_up(0x1400, {0x62000108}, 0xFE);
  start();
  EXPECT_EQ(hear("205 07 08"), "085 20 82 11 00 00 00 00 00");
  EXPECT_EQ(hear("205 09"), "085 00 00 00 00 00 00 00 00");
  EXPECT_EQ(hear("205 0A"), "");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 10);
}

TEST_F(NodeReceiveTest, AnIdentifierOfTwoRpdos_IsForBoth) {
  set_up(0x1400, {0x62000108}, 0xFE);
  set_up(0x1401, {0x62000208}, 0xFE);
  ASSERT_EQ(write(0x1401, 1, 0x80000305, 4), AbortCode::none);
  ASSERT_EQ(write(0x1401, 1, 0x205, 4), AbortCode::none);
  start();
  take_events();
  EXPECT_EQ(hear("205 07"), "");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 7);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 2), 7);
  EXPECT_EQ(take_events(), "rpdo 0, rpdo 1");
}

TEST_F(NodeReceiveTest, HeartbeatsCount_AnswersToNodeGuardingAndOtherLengthsDoNot) {
  ASSERT_EQ(write(0x1016, 1, 0x00090064, 4), AbortCode::none);
  hear("709 7F");
  hear("709 05");
  hear("709 05");
  EXPECT_EQ(take_events(), "heartbeat 9 pre-operational, heartbeat 9 operational, heartbeat 9 operational");
  hear("709 85");
  hear("709 05 00");
  EXPECT_EQ(take_events(), "");
  hear("709 00");
  hear("709 7F");
  EXPECT_EQ(take_events(), "heartbeat 9 initialising, heartbeat 9 pre-operational");
  EXPECT_EQ(wait(100ms), "100: 085 30 81 11 09 00 00 00 00");
  EXPECT_EQ(hear("709 7F"), "085 00 00 00 00 00 00 00 00") << "it is back";
}

TEST_F(NodeReceiveTest, WhatItDoesNotListenTo_ChangesNothing) {
  EXPECT_EQ(hear("206 07"), "");
  EXPECT_EQ(hear("606 40 00 10 00 00 00 00 00"), "");
  EXPECT_EQ(take_events(), "");
  EXPECT_NE(hear("605 40 00 10 00 00 00 00 00"), "");
  hear("080");
  EXPECT_EQ(take_events(), "sync 0");
  hear("000 01 05");
  EXPECT_EQ(node.state(), NmtState::operational);
}

}  // namespace
}  // namespace canopus::canopen::node_receive_test
