// Boot slave: identity, keep alive, start of error control, and what is said of a slave that is stuck [CiA 302-2; ME3CAN1-Q 4.8.6].

#include <gmock/gmock.h>

#include "master_bench.hpp"

namespace canopus::manager::test::boot_slave_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::uint32_t optional = 0x05;   // assigned, boot slave
constexpr std::uint32_t mandatory = 0x0D;  // and mandatory

class BootSlave : public MasterBench {};

// --- answers that are too short

TEST_F(BootSlave, IdentityOfSevenBytes_IsAnErrorThatNamesIt) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  object(0x1F85, 2, 0x23);
  ScriptedSlave& device = slave(2);
  device.objects[{0x1018, 1}] = {0x23, 0, 0, 0};
  device.lengths[{0x1018, 1}] = 7;
  switch_on();
  run_for(1s);
  EXPECT_EQ(master.boot_record(2).error, BootError::vendor);
  EXPECT_THAT(explain(master.boot_record(2), 2, now), HasSubstr("an answer of 7 bytes, expected 8"));
}

// --- identity

struct Identity {
  std::uint8_t sub;  // 0: 1000H
  BootError error;
};
class BootSlaveIdentity : public MasterBench, public ::testing::WithParamInterface<Identity> {
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

TEST_P(BootSlaveIdentity, Equal_IsStarted) {
  assign(mandatory);
  switch_on();
  run_for(1s);
  EXPECT_THAT(events, Contains("finished"));
}

TEST_P(BootSlaveIdentity, Different_MandatorySlave_EndsTheStartUp) {
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

TEST_P(BootSlaveIdentity, Different_OptionalSlave_EndsOnlyItsOwn) {
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
class BootSlaveIdentityObject : public BootSlaveIdentity {};

TEST_P(BootSlaveIdentityObject, NotReadable_IsTheSameErrorAsDifferent) {
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

INSTANTIATE_TEST_SUITE_P(DeviceType, BootSlaveIdentity,
                         ::testing::Values(Identity{0, BootError::device_type}), name_of);
INSTANTIATE_TEST_SUITE_P(Entries, BootSlaveIdentity,
                         ::testing::Values(Identity{1, BootError::vendor}, Identity{2, BootError::product},
                                           Identity{3, BootError::revision}, Identity{4, BootError::serial}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Entries, BootSlaveIdentityObject,
                         ::testing::Values(Identity{1, BootError::vendor}, Identity{2, BootError::product},
                                           Identity{3, BootError::revision}, Identity{4, BootError::serial}),
                         name_of);

TEST_F(BootSlave, RevisionRuleNewerMinor_TakesNewerMinorsOfTheSameMajorOnly) {
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

TEST_F(BootSlave, HeartbeatConfigured_TheSlaveIsStartedWithItsFirstHeartbeat_NotWithItsBootUp) {
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

TEST_F(BootSlave, HeartbeatConfigured_ButNoneComesInItsTime_Fails) {
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

TEST_F(BootSlave, GuardingConfigured_StartsWithItsFirstAnswer) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, 0x03E8030D);
  slave(2);
  switch_on();
  run_until_ms(500);
  EXPECT_THAT(sent(), ElementsAre("0 701 00", "0 000 82 00", "5 602 40 00 10 00 00 00 00 00", "6 702 R",
                                  "7 000 01 02"));
  EXPECT_EQ(master.error_control(2), 0x01);
}

TEST_F(BootSlave, GuardingConfigured_ButNotAnsweredWithin100Ms_Fails) {
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

TEST_F(BootSlave, HeartbeatAndGuardingConfigured_OnlyTheHeartbeatIsUsed) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, 0x0064030D);
  object(0x1016, 1, 0x000205DC);
  slave(2).heartbeat_after_reset = 100ms;
  switch_on();
  run_for(1s);
  EXPECT_THAT(only(sent(), " R"), IsEmpty());
  EXPECT_EQ(master.error_control(2), 0x02);
}

TEST_F(BootSlave, LssSearch_IsConfigured_OnlyByTheBootTimeAllFiveIdentityEntriesAndAMandatoryBootSlave) {
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

TEST_F(BootSlave, Explanation_OfAMissingSlave_SaysHowOftenItWasAskedAndWhatToCheck) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  switch_on();
  run_until_ms(3500);
  const std::string words = explain(master.boot_record(2), 2, now);
  EXPECT_THAT(words, HasSubstr("Node 2"));
  EXPECT_THAT(words, HasSubstr("Asked 2 times without an answer"));
  EXPECT_THAT(words, HasSubstr(", for 0.5 s"));
  EXPECT_THAT(words, HasSubstr("bit rate"));
}

TEST_F(BootSlave, Explanation_OfAWrongDevice_NamesBothValues) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  object(0x1F84, 2, 0x000F0192);
  slave(2);
  switch_on();
  run_for(1s);
  EXPECT_THAT(explain(master.boot_record(2), 2, now),
              HasSubstr("1000:00 reads 000F0191H, expected 000F0192H"));
}

}  // namespace
}  // namespace canopus::manager::test::boot_slave_test
