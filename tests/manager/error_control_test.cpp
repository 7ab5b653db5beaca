// What a master does when a slave is lost, and its node guarding [CiA 302-2; ME3CAN1-Q 4.8.7-4.8.9].

#include <gmock/gmock.h>

#include "master_bench.hpp"

namespace canopus::manager::test::error_control_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr std::uint32_t optional = 0x05;
constexpr std::uint32_t mandatory = 0x0D;

class ErrorControl : public MasterBench {};

/// Slave 2 is watched by heartbeat (1500 ms) and running; its heartbeats end at about 3 s.
class LostHeartbeat : public MasterBench {
 public:
  void run(std::uint32_t start_up, std::uint32_t assignment) {
    object(0x1F80, 0, start_up);
    object(0x1F81, 2, assignment);
    object(0x1016, 1, 0x000205DC);
    ScriptedSlave& device = slave(2);
    device.heartbeat_after_reset = 10ms;
    switch_on();
    heartbeats(2, 0x7F, 5ms, 15ms);
    run_until_ms(1000);
    receive(can::data_frame(0x702, {0x05}));
    run_until_ms(2000);
    receive(can::data_frame(0x702, {0x05}));
    run_until_ms(3000);
    receive(can::data_frame(0x702, {0x05}));
    ASSERT_EQ(node.state(), NmtState::operational);
    ASSERT_EQ(master.boot_record(2).step, BootStep::booted);
    device.heartbeat_after_reset = 100ms;
    sent();
    events.clear();
    run_until_ms(4499);
    ASSERT_THAT(sent(), IsEmpty());
    run_until_ms(4500);
  }
};

TEST_F(LostHeartbeat, OptionalSlave_IsResetAndBootedAgain) {
  run(0x01, optional);
  EXPECT_EQ(master.error_control(2), 0x82);
  EXPECT_TRUE(master.starting());
  run_for(1s);
  EXPECT_THAT(sent(), ElementsAre("4500 000 82 02", "4505 602 40 00 10 00 00 00 00 00", "4605 000 01 02"));
  EXPECT_EQ(events[0], "event 2 heartbeat");
  EXPECT_THAT(events, Contains("booted 2"));
  EXPECT_FALSE(master.starting());
}

TEST_F(LostHeartbeat, HeartbeatWithAReservedState_IsShownAsUnknown) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, optional);
  object(0x1016, 1, 0x000205DC);
  slave(2).heartbeat_after_reset = 10ms;
  switch_on();
  run_until_ms(1000);
  heartbeat(2, 0x05);
  EXPECT_EQ(master.node_state(2), node_state::operational);
  heartbeat(2, 0x01);  // as if it were "missing"
  EXPECT_EQ(master.node_state(2), node_state::unknown);
}

TEST_F(LostHeartbeat, MandatorySlave_IsTreatedTheSameAlone) {
  run(0x01, mandatory);
  run_for(1s);
  EXPECT_THAT(sent(), ElementsAre("4500 000 82 02", "4505 602 40 00 10 00 00 00 00 00", "4605 000 01 02"));
}

TEST_F(LostHeartbeat, MandatorySlave_Bit4_ResetsAllAndStartsTheNetworkAnew) {
  run(0x11, mandatory);
  EXPECT_EQ(node.state(), NmtState::pre_operational);
  run_for(1s);
  EXPECT_THAT(sent(), ElementsAre("4500 000 82 00", "4505 602 40 00 10 00 00 00 00 00", "4605 000 01 02"));
  EXPECT_EQ(node.state(), NmtState::operational);
}

TEST_F(LostHeartbeat, OptionalSlave_Bit4_IsStillTreatedAlone) {
  run(0x11, optional);
  EXPECT_THAT(commands(), ElementsAre("4500 000 82 02"));
}

TEST_F(LostHeartbeat, MandatorySlave_Bit6_StopsAllForGood) {
  run(0x41, mandatory);
  EXPECT_EQ(node.state(), NmtState::stopped);
  EXPECT_TRUE(master.halted());
  EXPECT_FALSE(master.starting());
  EXPECT_EQ(master.node_state(2), 4);
  EXPECT_THAT(sent(), ElementsAre("4500 000 02 00"));
  receive(can::data_frame(0x702, {0x00}));
  run_for(60s);
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(LostHeartbeat, MandatorySlave_Bits6And4_Bit6Wins) {
  run(0x51, mandatory);
  run_for(60s);
  EXPECT_THAT(sent(), ElementsAre("4500 000 02 00"));
}

TEST_F(LostHeartbeat, StoppedNetwork_IsBroughtBackByAResetOfAllByRequest) {
  run(0x41, mandatory);
  sent();
  run_until_ms(5000);
  EXPECT_EQ(write(0x1F82, 0x80, 0x07, 1), AbortCode::none);
  run_for(1s);
  EXPECT_FALSE(master.halted());
  EXPECT_EQ(node.state(), NmtState::operational);
  EXPECT_THAT(commands(), ElementsAre("5000 000 82 00", "5000 000 82 00", "5105 000 01 02"));
}

TEST_F(LostHeartbeat, OptionalSlave_Bit6_IsStillTreatedAlone) {
  run(0x41, optional);
  EXPECT_THAT(commands(), ElementsAre("4500 000 82 02"));
}

TEST_F(LostHeartbeat, WhileTheMasterIsStopped_NothingIsDone) {
  object(0x1F80, 0, 0x01);
  run(0x01, mandatory);  // lost once, and coming back
  run_for(1s);
  node.command(canopen::NmtCommand::stop, now);
  sent();
  run_for(10s);
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(LostHeartbeat, ResetNodeAsErrorReset_IsAnOption) {
  master.options().error_reset = canopen::NmtCommand::reset_node;
  run(0x01, optional);
  EXPECT_THAT(commands(), ElementsAre("4500 000 81 02"));
}

TEST_F(ErrorControl, UnassignedNodeLost_IsOnlyShown) {
  object(0x1F80, 0, 0x01);
  object(0x1016, 1, 0x000205DC);
  switch_on();
  run_until_ms(1000);
  EXPECT_EQ(master.error_control(2), 0);
  receive(can::data_frame(0x702, {0x05}));
  EXPECT_EQ(master.error_control(2), 0x02);
  EXPECT_EQ(master.node_state(2), 5);
  sent();
  run_until_ms(2499);
  EXPECT_EQ(master.error_control(2), 0x02);
  run_until_ms(2500);
  EXPECT_EQ(master.error_control(2), 0x82);
  run_for(10s);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(master.node_state(2), 5);
}

TEST_F(ErrorControl, HeartbeatAgain_ResolvesTheEvent_AndKeepsTheErrorBitUntilItIsCleared) {
  object(0x1F80, 0, 0x01);
  object(0x1016, 1, 0x000205DC);
  switch_on();
  heartbeat(2, 0x05);
  run_for(2s);
  EXPECT_THAT(events, Contains("event 2 heartbeat"));
  heartbeat(2, 0x04);
  EXPECT_THAT(events, Contains("resolved 2"));
  EXPECT_EQ(master.error_control(2), 0x82);
  EXPECT_EQ(master.node_state(2), 4);
  master.clear_error_control(3, now);
  EXPECT_EQ(master.error_control(2), 0x82);
  master.clear_error_control(2, now);
  EXPECT_EQ(master.error_control(2), 0x02);
}

TEST_F(ErrorControl, AsSlave_WatchedNodesAreShown_AndNothingIsSent) {
  object(0x1016, 1, 0x000205DC);
  switch_on();
  heartbeat(2, 0x05);
  EXPECT_EQ(master.node_state(2), 5);
  heartbeat(2, 0x00);
  EXPECT_EQ(master.node_state(2), 0x7F);
  heartbeat(2, 0x05);
  sent();
  run_for(10s);
  EXPECT_EQ(master.error_control(2), 0x82);
  EXPECT_THAT(sent(), IsEmpty());
}

// --- guarding

/// Slave 2 is guarded every 100 ms with retry factor 3, and not booted by the master; the first answer came
/// at 6 ms (boot-up message at 5 ms, remote frame at once).
class Guarding : public MasterBench {
 public:
  Guarding() {
    object(0x1F80, 0, 0x01);
    object(0x1F81, 2, 0x00640301);
    slave(2);
  }
  ScriptedSlave& device() { return slaves.front(); }
};

TEST_F(Guarding, AsksEveryGuardTime_AndShowsTheState) {
  switch_on();
  run_until_ms(410);
  EXPECT_THAT(only(sent(), "702"),
              ElementsAre("5 702 R", "105 702 R", "205 702 R", "305 702 R", "405 702 R"));
  EXPECT_EQ(master.error_control(2), 0x01);
  EXPECT_EQ(master.node_state(2), 0x7F);
  EXPECT_TRUE(master.guarding(2));
}

TEST_F(Guarding, OneMissedAnswer_IsMarkedAtTheNextRequest_WithoutAnyReaction) {
  switch_on();
  run_until_ms(150);
  device().answers_guarding = false;
  run_until_ms(304);
  EXPECT_EQ(master.error_control(2), 0x01);
  run_until_ms(305);
  EXPECT_EQ(master.error_control(2), 0x05);
  device().answers_guarding = true;
  run_until_ms(3000);
  EXPECT_EQ(master.error_control(2), 0x05);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00"));
}

TEST_F(Guarding, SilenceForTheLifeTime_LosesTheSlave) {
  switch_on();
  run_until_ms(150);
  device().present = false;  // heard last at 106 ms
  run_until_ms(405);
  EXPECT_EQ(master.error_control(2) & 0x08, 0);
  run_until_ms(406);
  EXPECT_EQ(master.error_control(2), 0x0D);
  EXPECT_THAT(events, Contains("event 2 lost"));
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00", "406 000 82 02"));
}

TEST_F(Guarding, AnswersAgainAfterTheLoss_ResolveTheEvent) {
  switch_on();
  run_until_ms(150);
  device().present = false;
  run_until_ms(1000);
  device().present = true;
  run_until_ms(1200);
  EXPECT_THAT(events, Contains("resolved 2"));
  EXPECT_TRUE(master.guarding(2));
}

TEST_F(Guarding, WrongToggleBit_IsMarked) {
  switch_on();
  run_until_ms(150);
  device().toggle = !device().toggle;
  run_until_ms(205);
  EXPECT_EQ(master.error_control(2), 0x01);
  run_until_ms(206);
  EXPECT_EQ(master.error_control(2), 0x05);
}

TEST_F(Guarding, FirstAnswerAfterABootUp_HasToggleBit0) {
  switch_on();
  run_until_ms(4);
  device().toggle = true;
  run_until_ms(106);
  EXPECT_EQ(master.error_control(2) & 0x04, 0x04);
}

TEST_F(Guarding, UnexpectedState_IsMarked_AndTheSlaveIsResetAndBootedAgain) {
  switch_on();
  run_until_ms(150);
  device().state = 0x04;
  run_until_ms(206);
  EXPECT_EQ(master.error_control(2), 0x21);
  EXPECT_THAT(events, Contains("event 2 state"));
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00", "206 000 82 02"));
  EXPECT_EQ(master.node_state(2), 0);
  run_until_ms(1000);
  EXPECT_EQ(master.boot_record(2).step, BootStep::booted);
}

TEST_F(Guarding, StateThatWasCommanded_IsExpected) {
  switch_on();
  run_until_ms(150);
  EXPECT_EQ(write(0x1F82, 2, 0x05, 1), AbortCode::none);
  run_until_ms(1000);
  EXPECT_EQ(master.error_control(2), 0x01);
  EXPECT_EQ(master.node_state(2), 5);
}

TEST_F(Guarding, Request1f83_StopsAndStartsIt) {
  switch_on();
  run_until_ms(150);
  EXPECT_EQ(read(0x1F83, 2), 1U);
  EXPECT_EQ(write(0x1F83, 2, 0, 1), AbortCode::none);
  EXPECT_EQ(read(0x1F83, 2), 0U);
  EXPECT_EQ(master.error_control(2), 0x00);
  sent();
  run_until_ms(1000);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(write(0x1F83, 0x80, 1, 1), AbortCode::none);
  EXPECT_EQ(read(0x1F83, 2), 1U);
  EXPECT_EQ(read(0x1F83, 3), 0U);
  run_until_ms(1150);
  EXPECT_THAT(sent(), ElementsAre("1000 702 R", "1100 702 R"));
  EXPECT_EQ(write(0x1F83, 2, 2, 1), AbortCode::invalid_value);
}

TEST_F(Guarding, Request1f83_OfANodeWithoutGuardTime_StartsNothing) {
  switch_on();
  sent();
  EXPECT_EQ(write(0x1F83, 5, 1, 1), AbortCode::none);
  run_until_ms(4);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(read(0x1F83, 5), 0U);
}

TEST_F(Guarding, GuardTimeWritten_WhileRunning_TakesEffect) {
  switch_on();
  run_until_ms(150);
  sent();
  EXPECT_EQ(write(0x1F81, 2, 0x00C80301, 4), AbortCode::none);
  run_until_ms(600);
  EXPECT_THAT(sent(), ElementsAre("150 702 R", "350 702 R", "550 702 R"));
}

// 8400H of an FX2N-32CAN or FX3U-CAN is taken during the 500 ms of the master's own start-up, too.
TEST_F(ErrorControl, Guarding_OfASlaveAssignedDuringTheStartUp_BeginsAtOnce) {
  object(0x1F80, 0, 0x01);
  switch_on();
  run_until_ms(100);
  ASSERT_TRUE(master.starting());
  sent();
  EXPECT_EQ(write(0x1F81, 2, 0x00C80301, 4), AbortCode::none);
  run_until_ms(600);
  EXPECT_THAT(only(sent(), " R"), ElementsAre("100 702 R", "300 702 R", "500 702 R"));
}

TEST_F(ErrorControl, ASlaveAssignedDuringTheStartUp_IsBooted_WhereEachAssignedOneIs) {
  master.options().boot_bit_is_for_recovery = true;
  object(0x1F80, 0, 0x01);
  slave(2);
  switch_on();
  run_until_ms(100);
  ASSERT_TRUE(master.starting());
  EXPECT_EQ(write(0x1F81, 2, 0x01, 4), AbortCode::none);
  run_until_ms(1000);
  EXPECT_EQ(master.boot_record(2).step, BootStep::booted);
}

TEST_F(Guarding, RetryFactor1_AnswersWithJitter_LoseNobody) {
  object(0x1F81, 2, 0x00640101);
  switch_on();
  for (int i = 0; i < 100; ++i) {
    device().answer_delay = std::chrono::milliseconds(i % 2 == 0 ? 1 : 20);
    run_for(100ms);
  }
  EXPECT_EQ(master.error_control(2), 0x01);
  device().present = false;
  run_for(200ms);
  EXPECT_EQ(master.error_control(2), 0x0D);
}

TEST_F(ErrorControl, Guarding_WithoutBit0Assigned_DoesNotRun) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, 0x00640300);
  switch_on();
  run_for(1s);
  EXPECT_THAT(only(sent(), " R"), IsEmpty());
}

TEST_F(ErrorControl, Guarding_NotByASlave) {
  object(0x1F81, 2, 0x00640301);
  switch_on();
  run_for(1s);
  EXPECT_THAT(only(sent(), " R"), IsEmpty());
  EXPECT_EQ(write(0x1F83, 2, 1, 1), AbortCode::device_state);
}

}  // namespace
}  // namespace canopus::manager::test::error_control_test
