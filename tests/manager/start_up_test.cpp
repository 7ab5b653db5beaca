// The start-up of the network by an NMT master [CiA 302-2; ME3CAN1-Q 4.8.5, 4.8.6].

#include <gmock/gmock.h>

#include "master_bench.hpp"

namespace canopus::manager::test {
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
  hear(can::data_frame(0x702, {0x00}));
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
  hear(can::data_frame(0x702, {0x00}));
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
  hear(can::data_frame(0x702, {0x00}));
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
  hear(can::data_frame(0x703, {0x00}));
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

TEST_F(StartUp, LateBootUp_WhileOperational_BootsAndStartsTheSlave) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2);
  switch_on();
  run_until_ms(3000);
  sent();
  hear(can::data_frame(0x702, {0x00}));
  EXPECT_EQ(master.node_state(2), 0x7F);
  EXPECT_TRUE(master.starting());
  run_for(1s);
  EXPECT_THAT(sent(), ElementsAre("3000 602 40 00 10 00 00 00 00 00", "3001 000 01 02"));
  EXPECT_FALSE(master.starting());
}

TEST_F(StartUp, LateBootUp_WhileTheMasterIsStopped_IsNotFollowed) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2);
  switch_on();
  run_until_ms(3000);
  node.command(canopen::NmtCommand::stop, now);
  sent();
  hear(can::data_frame(0x702, {0x00}));
  run_for(10s);
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(StartUp, BootUpOfAnUnassignedNode_IsOnlyShown) {
  object(0x1F80, 0, 0x01);
  switch_on();
  run_until_ms(3000);
  sent();
  hear(can::data_frame(0x709, {0x00}));
  run_for(10s);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(master.node_state(9), 0x7F);
}

TEST_F(StartUp, BootUpInTheMiddleOfTheBoot_BeginsAgain) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  object(0x1F85, 2, 0x71);
  ScriptedSlave& device = slave(2);
  device.objects[{0x1018, 1}] = {0x71, 0, 0, 0};
  device.answer_delay = 10ms;
  switch_on();
  run_until_ms(20);  // 1018H:01 is being asked
  hear(can::data_frame(0x702, {0x00}));
  run_for(5s);
  EXPECT_EQ(only(sent(), " 602 40 00 10").size(), 2U);
  EXPECT_TRUE(std::count(events.begin(), events.end(), "booted 2") == 1);
}

TEST_F(StartUp, BootUpThatComesAfterAnAnswer_BelongsToTheReset_AndBeginsNothingAnew) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2).boot_up_delay = 3s;  // held up on a full bus
  switch_on();
  run_until_ms(10000);
  EXPECT_THAT(only(sent(), " 602 "), ElementsAre("1000 602 40 00 10 00 00 00 00 00"));
  hear(can::data_frame(0x702, {0x00}));  // the next one is a real one
  run_for(1s);
  EXPECT_THAT(sent(), ElementsAre("10000 602 40 00 10 00 00 00 00 00", "10001 000 01 02"));
}

TEST_F(StartUp, BootUpLongAfterTheReset_IsANewOne) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2).boots_up = false;
  switch_on();
  run_until_ms(10000);
  sent();
  hear(can::data_frame(0x702, {0x00}));
  run_for(1s);
  EXPECT_THAT(sent(), ElementsAre("10000 602 40 00 10 00 00 00 00 00", "10001 000 01 02"));
}

TEST_F(StartUp, ChannelInUseByTheApplication_IsTriedAgain) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2);
  channel_free = false;
  switch_on();
  run_until_ms(300);
  EXPECT_THAT(only(sent(), " 602 "), IsEmpty());
  channel_free = true;
  run_until_ms(400);
  EXPECT_THAT(only(sent(), " 602 "), ElementsAre("305 602 40 00 10 00 00 00 00 00"));
}

TEST_F(StartUp, TransmitQueueFull_CommandsAndRequestsComeLaterInOrder) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2);
  node.power_on(now);
  refuse_frames = 2;  // the reset is refused twice
  run_for(0ms);
  run_until_ms(100);
  EXPECT_THAT(commands(), ElementsAre("2 000 82 00", "8 000 01 02"));
}

TEST_F(StartUp, NmtInhibitTime_SeparatesCommands) {
  object(0x102A, 0, 100);  // 10 ms
  object(0x1F80, 0, 0x01);
  for (std::uint8_t id = 2; id <= 4; ++id) {
    object(0x1F81, id, mandatory);
    slave(id);
  }
  switch_on();
  run_for(1s);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00", "10 000 01 02", "20 000 01 03", "30 000 01 04"));
}

TEST_F(StartUp, ResetOfTheOwnCommunication_StartsTheNetworkAnew) {
  object(0x1F80, 0, 0x03);
  switch_on();
  run_until_ms(2000);
  sent();
  node.command(canopen::NmtCommand::reset_communication, now);
  EXPECT_FALSE(master.active());
  run_for(5s);
  EXPECT_THAT(sent(), ElementsAre("2000 701 00", "2000 000 82 00", "2500 000 01 00"));
  EXPECT_TRUE(master.active());
}

TEST_F(StartUp, Stop_IsSilentAndForgetsEverything) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  absent_slave(2);
  switch_on();
  run_until_ms(1200);
  sent();
  master.stop(now);
  run_for(60s);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(master.deadline(), can::never);
  EXPECT_EQ(master.node_state(2), 0);
}

TEST_F(StartUp, Boot126SlavesInParallel_AllAreStarted) {
  object(0x1F80, 0, 0x03);
  for (std::uint8_t id = 2; id <= 127; ++id) {
    object(0x1F81, id, mandatory);
    slave(id).answer_delay = std::chrono::milliseconds(id);
  }
  switch_on();
  run_until_ms(499);
  EXPECT_EQ(std::count_if(events.begin(), events.end(),
                          [](const std::string& event) { return event.starts_with("booted"); }),
            126);
  run_for(1s);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00", "500 000 01 00"));
}

// --- identity

struct Identity {
  std::uint8_t sub;  // 0: 1000H
  BootError error;
};
class StartUpIdentity : public MasterBench, public ::testing::WithParamInterface<Identity> {
 public:
  void assign(std::uint32_t configuration) {
    object(0x1F80, 0, 0x01);
    object(0x1F81, 2, configuration);
    object(static_cast<std::uint16_t>(0x1F84 + GetParam().sub), 2, 0x00020003);
    ScriptedSlave& device = slave(2);
    key = GetParam().sub == 0 ? ScriptedSlave::Key{0x1000, 0} : ScriptedSlave::Key{0x1018, GetParam().sub};
    device.objects[key] = {0x03, 0x00, 0x02, 0x00};
  }
  ScriptedSlave::Key key;
};

TEST_P(StartUpIdentity, Equal_IsStarted) {
  assign(mandatory);
  switch_on();
  run_for(1s);
  EXPECT_THAT(events, Contains("finished"));
}

TEST_P(StartUpIdentity, Different_MandatorySlave_EndsTheStartUp) {
  assign(mandatory);
  slaves.front().objects[key] = {0x04, 0x00, 0x02, 0x00};
  switch_on();
  run_for(60s);
  EXPECT_TRUE(master.halted());
  EXPECT_EQ(master.error_control(2), 0x10);
  EXPECT_EQ(node.state(), NmtState::pre_operational);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00"));
  const BootRecord& record = master.boot_record(2);
  EXPECT_EQ(record.error, GetParam().error);
  EXPECT_EQ(record.expected, 0x00020003U);
  EXPECT_EQ(record.received, 0x00020004U);
}

TEST_P(StartUpIdentity, Different_OptionalSlave_EndsOnlyItsOwn) {
  assign(optional);
  slaves.front().objects[key] = {0x04, 0x00, 0x02, 0x00};
  switch_on();
  run_for(60s);
  EXPECT_FALSE(master.halted());
  EXPECT_FALSE(master.starting());
  EXPECT_EQ(master.error_control(2), 0x10);
  EXPECT_EQ(node.state(), NmtState::operational);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00"));
}

// An abort of 1000H is no answer, which is another error: so this is for 1018H alone.
class StartUpIdentityObject : public StartUpIdentity {};

TEST_P(StartUpIdentityObject, NotReadable_IsTheSameErrorAsDifferent) {
  assign(mandatory);
  slaves.front().objects.erase(key);
  switch_on();
  run_for(1s);
  EXPECT_EQ(master.boot_record(2).error, GetParam().error);
  EXPECT_EQ(master.boot_record(2).abort_code, AbortCode::no_object);
}

std::string name_of(const ::testing::TestParamInfo<Identity>& row) {
  return row.param.sub == 0 ? std::string("DeviceType") : "Identity" + std::to_string(row.param.sub);
}

INSTANTIATE_TEST_SUITE_P(DeviceType, StartUpIdentity, ::testing::Values(Identity{0, BootError::device_type}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Entries, StartUpIdentity,
                         ::testing::Values(Identity{1, BootError::vendor}, Identity{2, BootError::product},
                                           Identity{3, BootError::revision}, Identity{4, BootError::serial}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Entries, StartUpIdentityObject,
                         ::testing::Values(Identity{1, BootError::vendor}, Identity{2, BootError::product},
                                           Identity{3, BootError::revision}, Identity{4, BootError::serial}),
                         name_of);

TEST_F(StartUp, RevisionRuleNewerMinor_TakesNewerMinorsOfTheSameMajorOnly) {
  for (const auto& [revision, booted] :
       {std::pair{0x00020003U, true}, {0x00020007U, true}, {0x00020002U, false}, {0x00030003U, false}}) {
    MasterOptions options;
    options.revision_rule = RevisionRule::same_major_newer_minor;
    master.options() = options;
    slaves.clear();
    ScriptedSlave& device = slave(2);
    device.objects[{0x1018, 3}] = canopen::little_endian(revision, 4);
    object(0x1F80, 0, 0x01);
    object(0x1F81, 2, mandatory);
    object(0x1F87, 2, 0x00020003);
    switch_on();
    run_for(1s);
    EXPECT_EQ(master.boot_record(2).step == BootStep::booted, booted) << revision;
  }
}

// --- keep alive

constexpr std::uint32_t kept = 0x1D;

class KeepAlive : public MasterBench {
 public:
  KeepAlive() {
    object(0x1F80, 0, 0x01);
    object(0x1F81, 2, kept);
  }
};

TEST_F(KeepAlive, ResetsEveryOtherNodeSingly) {
  switch_on();
  const auto lines = commands();
  ASSERT_EQ(lines.size(), 125U);
  EXPECT_EQ(lines.front(), "0 000 82 03");
  EXPECT_EQ(lines.back(), "0 000 82 7F");
}

TEST_F(KeepAlive, FoundOperationalByGuarding_IsLeftAlone) {
  ScriptedSlave& device = slave(2);
  device.state = 0x05;
  switch_on();
  sent();
  run_for(5s);
  EXPECT_THAT(sent(), ElementsAre("1 702 R"));
  EXPECT_EQ(master.boot_record(2).error, BootError::already_operational);
  EXPECT_EQ(master.error_control(2), 0);
  EXPECT_EQ(master.node_state(2), 5);
  EXPECT_EQ(node.state(), NmtState::operational);
}

TEST_F(KeepAlive, FoundOperational_IsNotConfigured) {
  files[2] = {1, 0, 0, 0, 0x17, 0x10, 0, 2, 0, 0, 0, 0xE8, 3};
  ScriptedSlave& device = slave(2);
  device.state = 0x05;
  switch_on();
  run_for(5s);
  EXPECT_TRUE(device.written.empty());
}

TEST_F(KeepAlive, FoundInAnotherState_IsResetAndThenConfiguredAndStarted) {
  files[2] = {1, 0, 0, 0, 0x17, 0x10, 0, 2, 0, 0, 0, 0xE8, 3};
  ScriptedSlave& device = slave(2);
  switch_on();
  sent();
  run_for(5s);
  EXPECT_THAT(sent(), ElementsAre("1 702 R", "2 000 82 02", "7 602 2B 17 10 00 E8 03 00 00", "8 000 01 02"));
  EXPECT_EQ(device.written.size(), 1U);
}

TEST_F(KeepAlive, NoBootUpAfterTheReset_FailsAfterASecond) {
  slave(2).boots_up = false;
  switch_on();
  run_until_ms(1001);
  EXPECT_FALSE(master.halted());
  run_until_ms(1002);
  EXPECT_TRUE(master.halted());
  EXPECT_EQ(master.boot_record(2).error, BootError::no_guarding_state);
}

TEST_F(KeepAlive, NoGuardingAnswerWithin100Ms_Fails) {
  slave(2).answers_guarding = false;
  switch_on();
  run_until_ms(100);
  EXPECT_FALSE(master.halted());
  run_until_ms(101);
  EXPECT_TRUE(master.halted());
  EXPECT_EQ(master.boot_record(2).error, BootError::no_guarding_state);
  EXPECT_EQ(master.error_control(2), 0x10);
}

TEST_F(KeepAlive, FoundOperationalByHeartbeat_IsLeftAlone) {
  object(0x1016, 1, 0x000203E8);
  slave(2).answers_guarding = false;
  switch_on();
  sent();
  heartbeats(2, 0x05, 900ms, 4s);
  run_for(4s);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(master.boot_record(2).error, BootError::already_operational);
}

TEST_F(KeepAlive, NoHeartbeatWithinItsConsumerTime_Fails) {
  object(0x1016, 1, 0x000203E8);
  slave(2);
  switch_on();
  run_until_ms(1000);
  EXPECT_FALSE(master.halted());
  run_until_ms(1001);
  EXPECT_TRUE(master.halted());
  EXPECT_EQ(master.boot_record(2).error, BootError::no_heartbeat_state);
}

// --- start of error control

TEST_F(StartUp, HeartbeatConfigured_TheSlaveIsStartedWithItsFirstHeartbeat_NotWithItsBootUp) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  object(0x1016, 1, 0x000205DC);
  slave(2).heartbeat_after_reset = 700ms;
  switch_on();
  run_until_ms(704);
  EXPECT_EQ(master.boot_record(2).step, BootStep::heartbeat_start);
  EXPECT_EQ(master.error_control(2), 0);
  run_until_ms(1000);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00", "705 000 01 02"));
  EXPECT_EQ(master.error_control(2), 0x02);
}

TEST_F(StartUp, HeartbeatConfigured_ButNoneComesInItsTime_Fails) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  object(0x1016, 1, 0x000205DC);
  slave(2);
  switch_on();
  run_until_ms(1505);
  EXPECT_FALSE(master.halted());
  run_until_ms(1506);
  EXPECT_TRUE(master.halted());
  EXPECT_EQ(master.boot_record(2).error, BootError::no_error_control);
  EXPECT_EQ(master.boot_record(2).failed_step, BootStep::heartbeat_start);
}

TEST_F(StartUp, GuardingConfigured_StartsWithItsFirstAnswer) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, 0x03E8030D);
  slave(2);
  switch_on();
  run_until_ms(500);
  EXPECT_THAT(sent(), ElementsAre("0 701 00", "0 000 82 00", "5 602 40 00 10 00 00 00 00 00", "6 702 R",
                                  "7 000 01 02"));
  EXPECT_EQ(master.error_control(2), 0x01);
}

TEST_F(StartUp, GuardingConfigured_ButNotAnsweredWithin100Ms_Fails) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, 0x03E8030D);
  slave(2).answers_guarding = false;
  switch_on();
  run_until_ms(105);
  EXPECT_FALSE(master.halted());
  run_until_ms(106);
  EXPECT_TRUE(master.halted());
  EXPECT_EQ(master.boot_record(2).error, BootError::no_error_control);
  EXPECT_EQ(master.boot_record(2).failed_step, BootStep::guarding_start);
}

TEST_F(StartUp, HeartbeatAndGuardingConfigured_OnlyTheHeartbeatIsUsed) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, 0x0064030D);
  object(0x1016, 1, 0x000205DC);
  slave(2).heartbeat_after_reset = 100ms;
  switch_on();
  run_for(1s);
  EXPECT_THAT(only(sent(), " R"), IsEmpty());
  EXPECT_EQ(master.error_control(2), 0x02);
}

TEST_F(StartUp, LssSearch_IsConfigured_OnlyByTheBootTimeAllFiveIdentityEntriesAndAMandatoryBootSlave) {
  const auto complete = [this](std::uint16_t without) {
    for (std::uint16_t index = 0x1F84; index <= 0x1F88; ++index) {
      node.dictionary().set(index, 5, index == without ? 0U : 7U);
    }
    node.dictionary().set(0x1F89, 0, without == 0x1F89 ? 0U : 10000U);
    node.dictionary().set(0x1F81, 5, 0x0DU);
    return master.lss_configured(5);
  };
  EXPECT_TRUE(complete(0));
  for (std::uint16_t index = 0x1F84; index <= 0x1F89; ++index) EXPECT_FALSE(complete(index));
  complete(0);
  for (const std::uint32_t assignment : {0x0CU, 0x09U, 0x05U}) {
    node.dictionary().set(0x1F81, 5, assignment);
    EXPECT_FALSE(master.lss_configured(5));
  }
  EXPECT_FALSE(master.lss_configured(6));
}

// --- why is my slave stuck?

TEST_F(StartUp, Explanation_OfAMissingSlave_SaysHowOftenItWasAskedAndWhatToCheck) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  switch_on();
  run_until_ms(3500);
  const std::string words = explain(master.boot_record(2), 2, now);
  EXPECT_THAT(words, HasSubstr("Node 2"));
  EXPECT_THAT(words, HasSubstr("Asked 2 times without an answer"));
  EXPECT_THAT(words, HasSubstr("since 0.5 s"));
  EXPECT_THAT(words, HasSubstr("bit rate"));
}

TEST_F(StartUp, Explanation_OfAWrongDevice_NamesBothValues) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  object(0x1F84, 2, 0x000F0192);
  slave(2);
  switch_on();
  run_for(1s);
  EXPECT_THAT(explain(master.boot_record(2), 2, now),
              HasSubstr("1000H:00 reads 000F0191H, expected 000F0192H"));
}

}  // namespace
}  // namespace canopus::manager::test
