#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::error_control_test {
namespace {

struct HeartbeatTest : testing::Test, Conversation {};
struct NodeGuardingTest : testing::Test, Conversation {};
struct ErrorBehaviourTest : testing::Test, Conversation {};

TEST_F(HeartbeatTest, Producer_SendsTheStateEveryPeriod) {
  EXPECT_EQ(wait(1s), "");
  write(0x1017, 0, 100, 2);
  EXPECT_EQ(wait(250ms), "1100: 705 7F | 1200: 705 7F");
  start();
  EXPECT_EQ(wait(100ms), "1300: 705 05");
  receive("000 02 05");
  EXPECT_EQ(wait(100ms), "1400: 705 04");
  write(0x1017, 0, 0, 2);
  EXPECT_EQ(wait(1s), "");
}

TEST_F(HeartbeatTest, Consumer_BeginsWithTheFirstHeartbeat) {
  EXPECT_EQ(write(0x1016, 1, 0x00090064, 4), AbortCode::none);
  EXPECT_EQ(wait(1s), "");
  receive("709 7F");
  EXPECT_EQ(drain_events(), "heartbeat 9 pre-operational");
  EXPECT_EQ(wait(99ms), "");
  receive("709 05");
  EXPECT_EQ(wait(1s), "1199: 085 30 81 11 09 00 00 00 00");
  EXPECT_EQ(drain_events(), "heartbeat 9 operational, lost 9");
  EXPECT_EQ(receive("709 05"), "085 00 00 00 00 00 00 00 00");
  EXPECT_EQ(drain_events(), "heartbeat 9 operational");
}

TEST_F(HeartbeatTest, BootUpOfAWatchedNode_IsToldAndEndsWatching) {
  write(0x1016, 1, 0x00090064, 4);
  receive("709 05");
  receive("709 00");
  EXPECT_EQ(drain_events(), "heartbeat 9 operational, heartbeat 9 initialising");
  EXPECT_EQ(wait(1s), "");
}

TEST_F(HeartbeatTest, GuardingAnswerWithToggleBit_IsNoHeartbeat) {
  write(0x1016, 1, 0x00090064, 4);
  receive("709 85");
  EXPECT_EQ(drain_events(), "");
}

TEST_F(HeartbeatTest, SameNodeTwice_IsRefused) {
  write(0x1016, 1, 0x00090064, 4);
  EXPECT_EQ(write(0x1016, 2, 0x000900C8, 4), AbortCode::parameter_incompatible);
  EXPECT_EQ(write(0x1016, 2, 0x00090000, 4), AbortCode::none) << "time 0: not used";
  EXPECT_EQ(write(0x1016, 1, 0x000900C8, 4), AbortCode::none) << "the entry itself";
  EXPECT_EQ(write(0x1016, 3, 0x010800C8, 4), AbortCode::invalid_value) << "reserved bits";
}

TEST_F(HeartbeatTest, LostHeartbeat_LeavesOperational) {
  write(0x1016, 1, 0x00090064, 4);
  start();
  receive("709 05");
  wait(200ms);
  EXPECT_EQ(node.state(), NmtState::pre_operational);
}

TEST_F(HeartbeatTest, LostHeartbeat_DoesNotConcernTheActiveMaster) {
  write(0x1016, 1, 0x00090064, 4);
  start();
  node.set_active_master(true, now);
  receive("709 05");
  wait(200ms);
  EXPECT_EQ(node.state(), NmtState::operational);
}

TEST(Heartbeat, LostNode_CanBeNamedInTheCode) {
  Conversation c(NodeOptions{.guarding_emergency_names_node = true});
  c.write(0x1016, 1, 0x00090064, 4);
  c.receive("709 05");
  EXPECT_EQ(c.wait(200ms), "100: 085 09 8F 11 00 00 00 00 00");
}

TEST_F(NodeGuardingTest, Answer_AlternatesTheToggleBit) {
  EXPECT_EQ(receive("705 R1"), "705 7F");
  EXPECT_EQ(receive("705 R"), "705 FF");
  start();
  EXPECT_EQ(receive("705 R1"), "705 05");
  receive("000 02 05");
  EXPECT_EQ(receive("705 R1"), "705 84");
  receive("000 82 05");
  EXPECT_EQ(receive("705 R1"), "705 7F");
}

TEST_F(NodeGuardingTest, Heartbeat_HasPriority) {
  write(0x1017, 0, 100, 2);
  EXPECT_EQ(receive("705 R1"), "");
}

TEST_F(NodeGuardingTest, LifeGuarding_BeginsWithTheFirstRemoteFrame) {
  write(0x100C, 0, 100, 2);
  write(0x100D, 0, 3, 1);
  start();
  EXPECT_EQ(wait(1s), "");
  drain_events();
  receive("705 R1");
  wait(299ms);
  receive("705 R1");
  EXPECT_EQ(wait(1s), "1599: 085 30 81 11 05 00 00 00 00");
  EXPECT_EQ(drain_events(), "life guarding lost, pre-operational");
  EXPECT_EQ(receive("705 R1"), "705 7F | 085 00 00 00 00 00 00 00 00");
  EXPECT_EQ(drain_events(), "life guarding back");
}

TEST_F(ErrorBehaviourTest, CommunicationError_DoesWhat1029HSays) {
  start();
  node.communication_error(now);
  EXPECT_EQ(node.state(), NmtState::pre_operational);
  node.communication_error(now);
  EXPECT_EQ(node.state(), NmtState::pre_operational);
  write(0x1029, 1, 1, 1);
  start();
  node.communication_error(now);
  EXPECT_EQ(node.state(), NmtState::operational);
  write(0x1029, 1, 2, 1);
  node.communication_error(now);
  EXPECT_EQ(node.state(), NmtState::stopped);
}

TEST_F(ErrorBehaviourTest, OtherValues_AreRefused) {
  EXPECT_EQ(write(0x1029, 1, 3, 1), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1029, 1, 2, 1), AbortCode::none);
}

}  // namespace
}  // namespace canopus::canopen::error_control_test
