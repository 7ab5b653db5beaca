#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::nmt_slave_test {
namespace {

struct NmtSlaveTest : testing::Test, Conversation {};

TEST_F(NmtSlaveTest, PowerOn_SaysBootUpAndIsPreOperational) {
  Notebook other;
  Node fresh(standard_objects().build(), 7, other);
  EXPECT_EQ(fresh.state(), NmtState::initialising);
  EXPECT_FALSE(fresh.wants(0x607));
  fresh.power_on(now);
  EXPECT_EQ(other.drain(), "707 00");
  EXPECT_EQ(fresh.state(), NmtState::pre_operational);
  EXPECT_TRUE(fresh.wants(0x607));
  EXPECT_TRUE(fresh.wants(0x707)) << "remote frames";
  EXPECT_FALSE(fresh.wants(0x605));
}

TEST_F(NmtSlaveTest, Commands_LeadToTheirStates) {
  receive("000 01 05");
  EXPECT_EQ(node.state(), NmtState::operational);
  receive("000 80 05");
  EXPECT_EQ(node.state(), NmtState::pre_operational);
  receive("000 02 00");
  EXPECT_EQ(node.state(), NmtState::stopped);
  receive("000 01 00");
  EXPECT_EQ(node.state(), NmtState::operational);
  EXPECT_EQ(drain_events(), "operational, pre-operational, stopped, operational");
}

TEST_F(NmtSlaveTest, WhatIsNotForIt_IsIgnored) {
  receive("000 01 06");
  receive("000 01");
  receive("000 01 05 00");
  receive("000 03 05");
  EXPECT_EQ(node.state(), NmtState::pre_operational);
}

TEST_F(NmtSlaveTest, ResetCommunication_RestoresTheCommunicationProfileOnly) {
  write(0x1017, 0, 100, 2);
  write(0x2004, 0, 9, 1);
  EXPECT_EQ(receive("000 82 05"), "705 00");
  EXPECT_EQ(drain_events(), "reset communication, reset done, pre-operational");
  EXPECT_EQ(node.dictionary().get<std::uint16_t>(0x1017, 0), 0);
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x2004, 0), 9);
  EXPECT_EQ(wait(1s), "");
}

TEST_F(NmtSlaveTest, ResetNode_RestoresEverything) {
  write(0x2004, 0, 9, 1);
  EXPECT_EQ(receive("000 81 00"), "705 00");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x2004, 0), 0);
}

struct SlowlyResettingNode : testing::Test, Conversation {
  SlowlyResettingNode() : Conversation(NodeOptions{.reset_time = 10ms}) {}
};

TEST_F(SlowlyResettingNode, HearsAndSaysNothingUntilItsBootUpMessage) {
  write(0x1017, 0, 4, 2);
  EXPECT_EQ(receive("000 82 05"), "");
  EXPECT_EQ(node.state(), NmtState::initialising);
  EXPECT_FALSE(node.wants(0x605));
  EXPECT_EQ(receive("605 40 00 10 00 00 00 00 00"), "");
  EXPECT_EQ(receive("000 01 00"), "");
  EXPECT_FALSE(node.emergency(0x1000, 0, std::array<std::uint8_t, 5>{}, now));
  EXPECT_EQ(wait(20ms), "10: 705 00");
  EXPECT_EQ(drain_events(), "reset communication, reset done, pre-operational");
  EXPECT_EQ(node.dictionary().get<std::uint16_t>(0x1017, 0), 0);
}

TEST_F(SlowlyResettingNode, ASecondResetStartsAnew_AndANodeResetIsTheGreater) {
  for (const bool node_first : {true, false}) {
    write(0x2004, 0, 9, 1);
    node.command(node_first ? NmtCommand::reset_node : NmtCommand::reset_communication, now);
    EXPECT_EQ(wait(6ms), "");
    node.command(node_first ? NmtCommand::reset_communication : NmtCommand::reset_node, now);
    EXPECT_EQ(wait(10ms), node_first ? "16: 705 00" : "32: 705 00");
    EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x2004, 0), 0);
  }
}

TEST_F(SlowlyResettingNode, SupplyOffDuringAReset_EndsIt) {
  node.command(NmtCommand::reset_node, now);
  node.power_off();
  EXPECT_EQ(wait(1s), "");
  node.power_on(now);
  EXPECT_EQ(bus.drain(), "705 00");
  EXPECT_EQ(wait(1s), "");
}

TEST_F(NmtSlaveTest, NewNodeId_TakesEffectAtReset) {
  node.set_node_id(9);
  EXPECT_EQ(receive("605 40 00 10 00 00 00 00 00"), "585 43 00 10 00 91 01 02 00");
  EXPECT_EQ(receive("000 82 05"), "709 00");
  EXPECT_EQ(receive("605 40 00 10 00 00 00 00 00"), "");
  EXPECT_EQ(receive("609 40 14 10 00 00 00 00 00"), "589 43 14 10 00 89 00 00 00");
}

TEST_F(NmtSlaveTest, ActiveMaster_IgnoresBroadcasts) {
  node.set_active_master(true, now);
  receive("000 01 00");
  EXPECT_EQ(node.state(), NmtState::pre_operational);
  receive("000 01 05");
  EXPECT_EQ(node.state(), NmtState::operational);
}

TEST_F(NmtSlaveTest, Start_NeedsTheApplicationsConsent) {
  may_start = false;
  receive("000 01 05");
  EXPECT_EQ(node.state(), NmtState::pre_operational);
}

TEST_F(NmtSlaveTest, PowerOff_IsSilent) {
  write(0x1017, 0, 100, 2);
  node.power_off();
  EXPECT_EQ(wait(1s), "");
  EXPECT_EQ(receive("605 40 00 10 00 00 00 00 00"), "");
  EXPECT_EQ(receive("000 81 05"), "");
  EXPECT_EQ(node.deadline(), can::never);
}

}  // namespace
}  // namespace canopus::canopen::nmt_slave_test
