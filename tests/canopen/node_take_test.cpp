// Node::take() does what receive() does, and says whether anybody has to look further.

#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::node_take_test {
namespace {

using Taken = Node::Taken;

struct NodeTakeTest : testing::Test, Conversation {
  Taken take(const char* frame) { return node.take(from_text(frame), now); }
};

TEST_F(NodeTakeTest, AFrameOfItsRpdo_IsProcessData) {
  set_up(0x1400, {0x62000108}, 0xFE);
  start();
  take_events();
  EXPECT_EQ(take("205 07"), Taken::process_data);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 7);
  EXPECT_EQ(take_events(), "rpdo 0");
}

TEST_F(NodeTakeTest, AFrameOfAnotherLength_AndTheFirstGoodOneAfterIt_AreMore) {
  set_up(0x1400, {0x62000108}, 0xFE);
  start();
  EXPECT_EQ(take("205 07 08"), Taken::other);
  EXPECT_EQ(bus.take(), "085 20 82 11 00 00 00 00 00");
  EXPECT_EQ(take("205 09"), Taken::other);
  EXPECT_EQ(bus.take(), "085 00 00 00 00 00 00 00 00");
  EXPECT_EQ(take("205 0A"), Taken::process_data);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 10);
}

TEST_F(NodeTakeTest, AnIdentifierOfTwoRpdos_IsMore) {
  set_up(0x1400, {0x62000108}, 0xFE);
  set_up(0x1401, {0x62000208}, 0xFE);
  ASSERT_EQ(write(0x1401, 1, 0x80000305, 4), AbortCode::none);
  ASSERT_EQ(write(0x1401, 1, 0x205, 4), AbortCode::none);
  start();
  EXPECT_EQ(take("205 07"), Taken::other);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 7);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 2), 7);
}

TEST_F(NodeTakeTest, OnlyTheHeartbeatsOfANodeThatIsAlive_AreHeartbeats) {
  ASSERT_EQ(write(0x1016, 1, 0x00090064, 4), AbortCode::none);
  EXPECT_EQ(take("709 7F"), Taken::other) << "the first one";
  EXPECT_EQ(take("709 05"), Taken::heartbeat);
  EXPECT_EQ(take("709 05"), Taken::heartbeat);
  take_events();
  EXPECT_EQ(take("709 85"), Taken::other) << "an answer to node guarding";
  EXPECT_EQ(take("709 05 00"), Taken::other) << "of another length";
  EXPECT_EQ(take_events(), "");
  EXPECT_EQ(take("709 00"), Taken::other) << "boot-up";
  EXPECT_EQ(take("709 7F"), Taken::other) << "the first one after it";
  EXPECT_EQ(wait(100ms), "100: 085 30 81 11 09 00 00 00 00") << "each of them is watched";
  EXPECT_EQ(take("709 7F"), Taken::other) << "it is back";
}

TEST_F(NodeTakeTest, WhatItDoesNotListenTo_IsNothing_AndAllElseMore) {
  EXPECT_EQ(take("206 07"), Taken::nothing);
  EXPECT_EQ(take("606 40 00 10 00 00 00 00 00"), Taken::nothing);
  EXPECT_EQ(take("605 40 00 10 00 00 00 00 00"), Taken::other);
  EXPECT_NE(bus.take(), "");
  EXPECT_EQ(take("080"), Taken::other) << "SYNC";
  EXPECT_EQ(take("000 01 05"), Taken::other);
  EXPECT_EQ(node.state(), NmtState::operational);
}

}  // namespace
}  // namespace canopus::canopen::node_take_test
