// The start-up of the network by an NMT master [CiA 302-2; ME3CAN1-Q 4.8.5, 4.8.6].

#include <gmock/gmock.h>

#include "master_bench.hpp"

namespace canopus::manager::test::start_up_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::uint32_t optional = 0x05;   // assigned, boot slave
constexpr std::uint32_t mandatory = 0x0D;  // and mandatory

class StartUp : public MasterBench {};

TEST_F(StartUp, Bit0Clear_IsNoMaster_AndSendsNothing) {
  object(0x1F80, 0, 0x0A);
  object(0x1F81, 2, mandatory);
  switch_on();
  run_for(20s);
  EXPECT_THAT(sent(), ElementsAre("0 701 00"));
  EXPECT_FALSE(master.active());
  EXPECT_FALSE(master.starting());
  EXPECT_EQ(master.request_nmt(2, 0x05, now), AbortCode::device_state);
}

TEST_F(StartUp, NothingAssigned_ResetsAll_WaitsTheDelay_BecomesOperational_StartsAll) {
  object(0x1F80, 0, 0x03);
  switch_on();
  EXPECT_THAT(sent(), ElementsAre("0 701 00", "0 000 82 00"));
  EXPECT_TRUE(master.active());
  EXPECT_TRUE(master.starting());
  run_until_ms(499);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(node.state(), NmtState::pre_operational);
  run_until_ms(500);
  EXPECT_THAT(sent(), ElementsAre("500 000 01 00"));
  EXPECT_EQ(node.state(), NmtState::operational);
  EXPECT_FALSE(master.starting());
  EXPECT_THAT(events, ElementsAre("active", "starting", "finished", "started"));
}

TEST_F(StartUp, NothingAssigned_DelayOfTwoSeconds_IsKept) {
  object(0x1F80, 0, 0x03);
  master.options().start_all_delay = 2s;
  switch_on();
  run_for(10s);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00", "2000 000 01 00"));
}

TEST_F(StartUp, NothingAssigned_StartNodesSingly_HasNobodyToStart) {
  object(0x1F80, 0, 0x01);
  switch_on();
  run_for(10s);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00"));
  EXPECT_EQ(node.state(), NmtState::operational);
}

TEST_F(StartUp, MandatorySlaveFails_SlavesThatAreNotStarted_NameIt) {
  object(0x1F80, 0, 0x03);  // all at once, when all mandatory slaves are booted
  object(0x1F81, 2, optional);
  object(0x1F81, 3, mandatory);
  object(0x1F81, 4, optional);
  object(0x1F84, 3, 0x000F0192);
  slave(2);
  slave(3);
  object(0x1F89, 0, 10000);
  switch_on();
  run_for(20s);
  ASSERT_TRUE(master.halted());
  EXPECT_EQ(master.boot_record(2).step, BootStep::booted);
  EXPECT_EQ(master.boot_record(2).halted_by, 3);
  EXPECT_THAT(explain(master.boot_record(2), now),
              HasSubstr("Not started: the boot of the mandatory slave 3 failed, which ended the start-up."));
  EXPECT_EQ(master.boot_record(3).halted_by, 0) << "it has a reason of its own";
  EXPECT_EQ(master.boot_record(4).step, BootStep::idle) << "it does not answer; its boot was given up";
  EXPECT_EQ(master.boot_record(4).halted_by, 3);
  ASSERT_TRUE(slaves.back().objects.contains({0x1000, 0}));
  object(0x1F84, 3, 0x000F0191);
  node.command(canopen::NmtCommand::reset_communication, now);
  run_for(1s);
  EXPECT_EQ(master.boot_record(2).halted_by, 0) << "a new start-up";
}

TEST_F(StartUp, MandatorySlave_IsIdentifiedAndStarted_ThenTheMasterBecomesOperational) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  object(0x1F84, 2, 0x000F0191);
  object(0x1F89, 0, 10000);
  slave(2);
  switch_on();
  EXPECT_EQ(master.node_state(2), 0);
  run_until_ms(5);
  EXPECT_EQ(master.node_state(2), 0x7F);
  EXPECT_EQ(node.state(), NmtState::pre_operational);
  EXPECT_TRUE(master.starting());
  run_for(10s);
  EXPECT_THAT(sent(), ElementsAre("0 701 00", "0 000 82 00", "5 602 40 00 10 00 00 00 00 00", "6 000 01 02"));
  EXPECT_EQ(node.state(), NmtState::operational);
  EXPECT_EQ(master.node_state(2), 5);
  EXPECT_FALSE(master.starting());
  EXPECT_EQ(master.error_control(2), 0);
  EXPECT_THAT(events, ElementsAre("active", "starting", "booted 2", "finished", "started"));
}

TEST_F(StartUp, SilentSlave_IsAskedAgainOneSecondAfterEachTimeOut_UntilItAnswers) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  ScriptedSlave& device = absent_slave(2);
  device.boots_up = false;
  switch_on();
  run_until_ms(4500);
  EXPECT_THAT(only(sent(), " 602 40"),
              ElementsAre("1000 602 40 00 10 00 00 00 00 00", "2500 602 40 00 10 00 00 00 00 00",
                          "4000 602 40 00 10 00 00 00 00 00"));
  EXPECT_EQ(master.node_state(2), 1);
  EXPECT_EQ(master.boot_record(2).attempts, 3U);
  device.present = true;
  run_for(2s);
  EXPECT_THAT(commands(), ElementsAre("5501 000 01 02"));
}

TEST_F(StartUp, SdoTimeOutAndRetry_AreSettable) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  absent_slave(2);
  master.options().sdo_time_out = 50ms;
  master.options().presence_retry = 200ms;
  master.options().wait_after_reset = 0ms;
  switch_on();
  run_until_ms(600);
  EXPECT_THAT(only(sent(), " 602 40"),
              ElementsAre("0 602 40 00 10 00 00 00 00 00", "250 602 40 00 10 00 00 00 00 00",
                          "500 602 40 00 10 00 00 00 00 00"));
}

TEST_F(StartUp, BootUpMessageDuringThePause_AsksAtOnce) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  ScriptedSlave& device = absent_slave(2);
  switch_on();
  run_until_ms(1800);
  sent();
  device.present = true;
  receive(can::data_frame(0x702, {0x00}));
  run_for(1s);
  EXPECT_THAT(sent(), ElementsAre("1800 602 40 00 10 00 00 00 00 00", "1801 000 01 02"));
}

TEST_F(StartUp, BootUpMessageWhile1000hIsAsked_AsksAgainRightAfterTheTimeOut) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  ScriptedSlave& device = absent_slave(2);
  switch_on();
  run_until_ms(1200);
  device.present = true;
  receive(can::data_frame(0x702, {0x00}));
  run_for(2s);
  EXPECT_THAT(only(sent(), " 602 40"),
              ElementsAre("1000 602 40 00 10 00 00 00 00 00", "1500 602 40 00 10 00 00 00 00 00"));
}

TEST_F(StartUp, AbortOf1000h_CountsAsNoAnswer) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2).aborts[{0x1000, 0}] = 0x08000022;
  switch_on();
  run_until_ms(100);
  EXPECT_EQ(master.boot_record(2).error, BootError::no_answer);
  EXPECT_EQ(master.boot_record(2).abort_code, AbortCode::device_state);
  EXPECT_EQ(master.boot_record(2).step, BootStep::presence_pause);
  EXPECT_EQ(describe(master.boot_record(2)), "no answer to 1000H, waiting to ask again (asked once)");
}

TEST_F(StartUp, BootTimeElapsed_MandatorySlaveMissing_HaltsForGood) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  object(0x1F89, 0, 10000);
  ScriptedSlave& device = absent_slave(2);
  switch_on();
  run_until_ms(9999);
  EXPECT_EQ(master.error_control(2), 0);
  EXPECT_FALSE(master.halted());
  run_until_ms(10000);
  EXPECT_TRUE(master.halted());
  EXPECT_FALSE(master.starting());
  EXPECT_TRUE(master.active());
  EXPECT_EQ(master.error_control(2), 0x10);
  EXPECT_EQ(node.state(), NmtState::pre_operational);
  EXPECT_THAT(events, ElementsAre("active", "starting", "failed 2 B", "started", "halted by 2 B"));
  sent();
  device.present = true;
  receive(can::data_frame(0x702, {0x00}));
  run_for(60s);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(node.state(), NmtState::pre_operational);
}

TEST_F(StartUp, BootTimeElapsed_MarksEveryMissingMandatorySlave_NotTheOthers) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  object(0x1F81, 3, mandatory);
  object(0x1F81, 4, mandatory);
  object(0x1F81, 5, optional);
  object(0x1F89, 0, 5000);
  slave(3);
  switch_on();
  run_until_ms(5000);
  EXPECT_EQ(master.error_control(2), 0x10);
  EXPECT_EQ(master.error_control(3), 0);
  EXPECT_EQ(master.error_control(4), 0x10);
  EXPECT_EQ(master.error_control(5), 0);
  EXPECT_THAT(events, ElementsAre("active", "starting", "booted 3", "failed 2 B", "failed 4 B", "started",
                                  "halted by 2 B"));
}

TEST_F(StartUp, BootTimeZero_WaitsWithoutEnd) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  switch_on();
  run_for(3600s);
  EXPECT_FALSE(master.halted());
  EXPECT_TRUE(master.starting());
}

TEST_F(StartUp, OptionalSlaveMissing_DoesNotHoldTheMasterBack_AndIsAskedForWithoutEnd) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, optional);
  object(0x1F89, 0, 5000);
  switch_on();
  EXPECT_EQ(node.state(), NmtState::operational);
  run_for(100s);
  EXPECT_EQ(master.error_control(2), 0);
  EXPECT_EQ(only(sent(), " 602 40").size(), 67U);
}

TEST_F(StartUp, Start1f80Bit2_WaitsUntilTheApplicationStartsTheOwnNode) {
  object(0x1F80, 0, 0x07);
  object(0x1F81, 2, mandatory);
  slave(2);
  switch_on();
  run_until_ms(20000);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00"));
  EXPECT_EQ(node.state(), NmtState::pre_operational);
  EXPECT_TRUE(master.starting());
  EXPECT_EQ(write(0x1F82, 1, 0x05, 1), AbortCode::none);
  EXPECT_EQ(node.state(), NmtState::operational);
  EXPECT_THAT(commands(), ElementsAre("20000 000 01 00"));
  EXPECT_FALSE(master.starting());
}

TEST_F(StartUp, OwnNodeMayNotStart_WaitsUntilItIsOperational) {
  object(0x1F80, 0, 0x03);
  cpu_runs = false;
  switch_on();
  run_until_ms(3000);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00"));
  cpu_runs = true;
  node.command(canopen::NmtCommand::start, now);
  run_for(0ms);
  EXPECT_THAT(commands(), ElementsAre("3000 000 01 00"));
}

TEST_F(StartUp, Start1f80Bit3_LeavesTheSlavesToTheApplication) {
  object(0x1F80, 0, 0x09);
  object(0x1F81, 2, mandatory);
  slave(2);
  switch_on();
  run_for(10s);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00"));
  EXPECT_EQ(node.state(), NmtState::operational);
  EXPECT_EQ(master.node_state(2), 0x7F);
}

TEST_F(StartUp, StartAll_ComesNotBeforeTheDelay_WhenTheSlavesAreReadyEarlier) {
  object(0x1F80, 0, 0x03);
  object(0x1F81, 2, mandatory);
  object(0x1F81, 3, mandatory);
  slave(2);
  slave(3);
  switch_on();
  run_until_ms(10);
  EXPECT_EQ(node.state(), NmtState::operational);
  run_for(10s);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00", "500 000 01 00"));
  EXPECT_EQ(master.node_state(2), 5);
  EXPECT_EQ(master.node_state(3), 5);
}

TEST_F(StartUp, StartAll_WithAnOptionalSlaveMissing_StartsTheOthersSingly) {
  object(0x1F80, 0, 0x03);
  object(0x1F81, 2, mandatory);
  object(0x1F81, 3, optional);
  object(0x1F81, 4, mandatory);
  slave(2);
  ScriptedSlave& late = absent_slave(3);
  slave(4);
  switch_on();
  run_until_ms(5000);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00", "500 000 01 02", "500 000 01 04"));
  late.present = true;
  receive(can::data_frame(0x703, {0x00}));
  run_for(1s);
  EXPECT_THAT(commands(), ElementsAre("5001 000 01 03"));
}

TEST_F(StartUp, WithoutTheBootSlaveBit_NothingIsAskedAndNothingStarted) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, 0x01);
  slave(2);
  switch_on();
  run_for(10s);
  EXPECT_THAT(sent(), ElementsAre("0 701 00", "0 000 82 00"));
  EXPECT_EQ(node.state(), NmtState::operational);
}

TEST_F(StartUp, OwnNodeIdIn1f81_IsIgnored) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 1, mandatory);
  switch_on();
  run_for(10s);
  EXPECT_THAT(sent(), ElementsAre("0 701 00", "0 000 82 00"));
  EXPECT_EQ(node.state(), NmtState::operational);
}

}  // namespace
}  // namespace canopus::manager::test::start_up_test
