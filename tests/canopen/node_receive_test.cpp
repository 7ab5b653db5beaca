// What nearly all frames on a bus are, for one node: PDOs and heartbeats, of its own and of others.

#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::node_receive_test {
namespace {

struct NodeReceiveTest : testing::Test, Conversation {};

TEST_F(NodeReceiveTest, AFrameOfItsRpdo_IsProcessData) {
  set_up(0x1400, {0x62000108}, 0xFE);
  start();
  drain_events();
  EXPECT_EQ(receive("205 07"), "");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 7);
  EXPECT_EQ(drain_events(), "rpdo 0");
}

TEST_F(NodeReceiveTest, AFrameOfAnotherLength_IsAnError_UntilTheNextGoodOne) {
  set_up(0x1400, {0x62000108}, 0xFE);
  start();
  EXPECT_EQ(receive("205 07 08"), "085 20 82 11 00 00 00 00 00");
  EXPECT_EQ(receive("205 09"), "085 00 00 00 00 00 00 00 00");
  EXPECT_EQ(receive("205 0A"), "");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 10);
}

TEST_F(NodeReceiveTest, AnIdentifierOfTwoRpdos_IsForBoth) {
  set_up(0x1400, {0x62000108}, 0xFE);
  set_up(0x1401, {0x62000208}, 0xFE);
  ASSERT_EQ(write(0x1401, 1, 0x80000305, 4), AbortCode::none);
  ASSERT_EQ(write(0x1401, 1, 0x205, 4), AbortCode::none);
  start();
  drain_events();
  EXPECT_EQ(receive("205 07"), "");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 7);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 2), 7);
  EXPECT_EQ(drain_events(), "rpdo 0, rpdo 1");
}

TEST_F(NodeReceiveTest, HeartbeatsCount_AnswersToNodeGuardingAndOtherLengthsDoNot) {
  ASSERT_EQ(write(0x1016, 1, 0x00090064, 4), AbortCode::none);
  receive("709 7F");
  receive("709 05");
  receive("709 05");
  EXPECT_EQ(drain_events(), "heartbeat 9 pre-operational, heartbeat 9 operational, heartbeat 9 operational");
  receive("709 85");
  receive("709 05 00");
  EXPECT_EQ(drain_events(), "");
  receive("709 00");
  receive("709 7F");
  EXPECT_EQ(drain_events(), "heartbeat 9 initialising, heartbeat 9 pre-operational");
  EXPECT_EQ(wait(100ms), "100: 085 30 81 11 09 00 00 00 00");
  EXPECT_EQ(receive("709 7F"), "085 00 00 00 00 00 00 00 00") << "it is back";
}

TEST_F(NodeReceiveTest, WhatItDoesNotListenTo_ChangesNothing) {
  EXPECT_EQ(receive("206 07"), "");
  EXPECT_EQ(receive("606 40 00 10 00 00 00 00 00"), "");
  EXPECT_EQ(drain_events(), "");
  EXPECT_NE(receive("605 40 00 10 00 00 00 00 00"), "");
  receive("080");
  EXPECT_EQ(drain_events(), "sync 0");
  receive("000 01 05");
  EXPECT_EQ(node.state(), NmtState::operational);
}

}  // namespace
}  // namespace canopus::canopen::node_receive_test
