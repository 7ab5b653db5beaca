// Node::take() does what receive() does, and says whether anybody has to look further.

#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::node_receive_usual_test {
namespace {

using ReceiveResult = Node::ReceiveResult;

struct NodeTakeTest : testing::Test, Conversation {
  ReceiveResult take(const char* frame) { return node.receive_usual(from_text(frame), now); }
};

TEST_F(NodeTakeTest, AFrameOfItsRpdo_IsProcessData) {
  set_up(0x1400, {0x62000108}, 0xFE);
  start();
  take_events();
  EXPECT_EQ(take("205 07"), ReceiveResult::process_data);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 7);
  EXPECT_EQ(take_events(), "rpdo 0");
}

TEST_F(NodeTakeTest, AFrameOfAnotherLength_AndTheFirstGoodOneAfterIt_AreMore) {
  set_up(0x1400, {0x62000108}, 0xFE);
  start();
  EXPECT_EQ(take("205 07 08"), ReceiveResult::other);
  EXPECT_EQ(bus.take(), "085 20 82 11 00 00 00 00 00");
  EXPECT_EQ(take("205 09"), ReceiveResult::other);
  EXPECT_EQ(bus.take(), "085 00 00 00 00 00 00 00 00");
  EXPECT_EQ(take("205 0A"), ReceiveResult::process_data);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 10);
}

TEST_F(NodeTakeTest, AnIdentifierOfTwoRpdos_IsMore) {
  set_up(0x1400, {0x62000108}, 0xFE);
  set_up(0x1401, {0x62000208}, 0xFE);
  ASSERT_EQ(write(0x1401, 1, 0x80000305, 4), AbortCode::none);
  ASSERT_EQ(write(0x1401, 1, 0x205, 4), AbortCode::none);
  start();
  EXPECT_EQ(take("205 07"), ReceiveResult::other);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 7);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 2), 7);
}

TEST_F(NodeTakeTest, OnlyTheHeartbeatsOfANodeThatIsAlive_AreHeartbeats) {
  ASSERT_EQ(write(0x1016, 1, 0x00090064, 4), AbortCode::none);
  EXPECT_EQ(take("709 7F"), ReceiveResult::other) << "the first one";
  EXPECT_EQ(take("709 05"), ReceiveResult::heartbeat);
  EXPECT_EQ(take("709 05"), ReceiveResult::heartbeat);
  take_events();
  EXPECT_EQ(take("709 85"), ReceiveResult::other) << "an answer to node guarding";
  EXPECT_EQ(take("709 05 00"), ReceiveResult::other) << "of another length";
  EXPECT_EQ(take_events(), "");
  EXPECT_EQ(take("709 00"), ReceiveResult::other) << "boot-up";
  EXPECT_EQ(take("709 7F"), ReceiveResult::other) << "the first one after it";
  EXPECT_EQ(wait(100ms), "100: 085 30 81 11 09 00 00 00 00") << "each of them is watched";
  EXPECT_EQ(take("709 7F"), ReceiveResult::other) << "it is back";
}

TEST_F(NodeTakeTest, WhatItDoesNotListenTo_IsNothing_AndAllElseMore) {
  EXPECT_EQ(take("206 07"), ReceiveResult::nothing);
  EXPECT_EQ(take("606 40 00 10 00 00 00 00 00"), ReceiveResult::nothing);
  EXPECT_EQ(take("605 40 00 10 00 00 00 00 00"), ReceiveResult::other);
  EXPECT_NE(bus.take(), "");
  EXPECT_EQ(take("080"), ReceiveResult::other) << "SYNC";
  EXPECT_EQ(take("000 01 05"), ReceiveResult::other);
  EXPECT_EQ(node.state(), NmtState::operational);
}

}  // namespace
}  // namespace canopus::canopen::node_receive_usual_test
