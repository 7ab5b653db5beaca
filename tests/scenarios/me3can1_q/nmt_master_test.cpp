// spec/me3can1-q/scenarios.md, section 9: the module as NMT master (S57 to S66).

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {
namespace {

CANOPUS_OF_BOTH_MODULES(NmtMaster);

constexpr std::uint32_t optional = 0x05;   // 1F81H: assigned, boot slave
constexpr std::uint32_t mandatory = 0x0D;  // and mandatory

struct Object {
  std::uint16_t index;
  std::uint8_t sub;
  std::uint32_t value;
};

/// Node 1 with these objects stored; supply on up to its boot-up frame.
void boot_master(IntelligentScenario& s, std::initializer_list<Object> objects,
                 Where where = Where::current()) {
  s.plug_in().preset_word(27, 1);
  for (const Object& object : objects) {
    const unsigned length = object.index == 0x1017 || object.index == 0x100C ? 2
                            : object.index == 0x1029                         ? 1
                                                                             : 4;
    EXPECT_EQ(
        s.plug_in().preset_object(object.index, object.sub, canopen::little_endian(object.value, length)),
        canopen::AbortCode::none);
  }
  s.supply_on().wait_tx(0x701, {0x00}, 20s, where);
}

const Bytes ask_1000{0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0};
const Bytes is_0191{0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00};

const Bytes time_out{0x80, 0x00, 0x10, 0x00, 0x00, 0x00, 0x04, 0x05};

/// The next question for 1000H, after the end of the one that was just asked: G71, then 1 s.
void asked_again(IntelligentScenario& s, Where where = Where::current()) {
  const can::Time asked = s.now();
  s.wait_tx(0x602, time_out, 20s, where);
  EXPECT_EQ(s.now() - asked, 500ms);
  s.wait_tx(0x602, ask_1000, 20s, where);
  EXPECT_EQ(s.now() - asked, 1500ms);
}

/// Slave 2 comes after its reset, is identified, and is started.
void slave_2_boots(IntelligentScenario& s, Where where = Where::current()) {
  s.rx(0x702, {0x00}).tx(0x602, ask_1000, where).rx(0x582, is_0191);
}

const Bytes no_error{0, 0, 0, 0, 0, 0, 0, 0};

/// The same after its heartbeat was missing: the module takes its emergency message back.
void slave_2_boots_again(IntelligentScenario& s, Where where = Where::current()) {
  s.rx(0x702, {0x00}).tx(0x081, no_error, where).tx(0x602, ask_1000, where).rx(0x582, is_0191);
}

/// Slave 2 (heartbeat watched, 1500 ms) was booted and started and is heard.
void run_with_slave_2(IntelligentScenario& s, std::uint32_t start_up, std::uint32_t assignment,
                      Where where = Where::current()) {
  boot_master(s, {{0x1F80, 0, start_up}, {0x1F81, 2, assignment}, {0x1016, 1, 0x000205DC}}, where);
  s.tx(0x000, {0x82, 0x00}, where);
  slave_2_boots(s, where);
  s.advance(10ms).rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02}, where);
  s.advance(10ms).rx(0x702, {0x05}).no_tx(where);
  s.expect(602, 5, where).expect_bit(25, 0, true, where).expect_bit(25, 14, false, where);
}

can::Duration since(const IntelligentScenario& s, can::Time from) { return s.now() - from; }

// --- S57

TEST_P(NmtMaster, S57_SimpleStart_ResetsAll_WaitsG70_BecomesOperational_StartsAll) {
  spec("ME3-MST-009", "");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x00000003}});
  s.tx(0x000, {0x82, 0x00}).no_tx();
  const can::Time reset = s.now();
  s.expect(25, 0xC100).expect(70, 500);
  s.advance(499ms).no_tx().expect_bit(25, 0, false);
  s.wait_tx(0x000, {0x01, 0x00});
  EXPECT_EQ(since(s, reset), 500ms);
  s.expect(25, 0x8201).no_tx();
}

TEST_P(NmtMaster, S57_G70_IsTheLeastPauseBetweenResetAllAndStartAll) {
  spec("ME3-DLY-001", "RJ71-BM-022");
  for (const unsigned g70 : {0U, 2000U, 65535U}) {
    IntelligentScenario s(GetParam());
    boot_master(s, {{0x1F80, 0, 0x00000003}, {0x1F81, 2, mandatory}});
    s.expect(70, 500);  // the default
    s.write(70, static_cast<std::uint16_t>(g70)).expect(70, static_cast<std::uint16_t>(g70));
    s.save();
    s.ignore_tx().supply_off().supply_on().wait_tx(0x701, {0x00}).tx(0x000, {0x82, 0x00});
    s.expect(70, static_cast<std::uint16_t>(g70));
    const can::Time reset = s.now();
    slave_2_boots(s);
    s.expect_bit(25, 0, true);  // the master itself need not wait
    if (g70 == 0) {
      s.tx(0x000, {0x01, 0x00});
    } else {
      s.no_tx().wait_tx(0x000, {0x01, 0x00}, 70s);
    }
    EXPECT_EQ(since(s, reset), std::chrono::milliseconds(g70));
    s.no_tx();
  }
}

// --- S58

TEST_P(NmtMaster, S58_MandatorySlave_IsAskedUntilItAnswers_Started_AndThenTheMasterIsOperational) {
  spec("ME3-MST-008 ME3-MST-010", "");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}, {0x1F84, 2, 0x000F0191}, {0x1F89, 0, 10000}});
  s.tx(0x000, {0x82, 0x00});
  s.expect_bit(25, 15, true).expect_bit(25, 14, true).expect_bit(25, 8, true);
  s.wait_tx(0x602, ask_1000);
  asked_again(s);
  s.expect(25, 0xC100);  // still Pre-operational
  s.rx(0x582, is_0191).tx(0x000, {0x01, 0x02}).no_tx();
  s.expect(25, 0x8201).expect(602, 5).expect(402, 0);
}

// G71 is the time-out of every SDO, the start-up's as well, from the write on.
TEST_P(NmtMaster, S58_SdoTimeOut_IsG71) {
  spec("ME3-DLY-002", "RJ71-BM-022");
  for (const bool at_run_time : {false, true}) {
    IntelligentScenario s(GetParam());
    if (!at_run_time) s.plug_in().preset_word(71, 200);
    boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, optional}});
    if (at_run_time) s.write(71, 200);
    s.ignore_tx().wait_tx(0x602, ask_1000);
    const can::Time asked = s.now();
    s.wait_tx(0x602, time_out);
    EXPECT_EQ(since(s, asked), 200ms);
    s.wait_tx(0x602, ask_1000);
    EXPECT_EQ(since(s, asked), 1200ms);
    s.save(2);  // the factory's 500 ms, for the next transfer
    s.expect(71, 500).wait_tx(0x602, time_out).wait_tx(0x602, ask_1000);
    const can::Time again = s.now();
    s.wait_tx(0x602, time_out);
    EXPECT_EQ(since(s, again), 500ms);
    s.ignore_tx();
  }
}

// G70 written while the module runs counts at the next start-up, saved or not.
TEST_P(NmtMaster, S57_G70_CountsFromTheWriteOn) {
  spec("ME3-DLY-001", "RJ71-BM-022");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x00000003}});
  s.tx(0x000, {0x82, 0x00}).wait_tx(0x000, {0x01, 0x00}).write(70, 1234);
  s.cif({0x0002, 0, 0x1F82, 0x80, 1, 7});
  s.tx(0x000, {0x82, 0x00}).wait_tx(0x701, {0x00}).tx(0x000, {0x82, 0x00});
  const can::Time reset = s.now();
  s.wait_tx(0x000, {0x01, 0x00});
  EXPECT_EQ(since(s, reset), 1234ms);
  s.no_tx();
}

TEST_P(NmtMaster, PresenceCheck_IsRepeatedOneSecondAfterEachTimeOut_UntilTheBootTimeOrWithoutEnd) {
  spec("ME3-SLV-007", "");
  for (const std::uint32_t assignment : {mandatory, optional}) {
    IntelligentScenario s(GetParam());
    boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, assignment}, {0x1F89, 0, 10000}});
    s.tx(0x000, {0x82, 0x00});
    const can::Time reset = s.now();
    s.wait_tx(0x602, ask_1000);
    if (assignment == mandatory) {
      for (int again = 0; again < 5; ++again) asked_again(s);
      EXPECT_EQ(since(s, reset), 8500ms);
      s.wait_tx(0x602, time_out).advance(60s).no_tx().expect_bit(25, 14, false);
    } else {
      for (int again = 0; again < 100; ++again) asked_again(s);
      s.expect_bit(25, 14, true);
    }
  }
}

// --- S59

TEST(Me3NmtMaster, S59_MandatorySlaveMissing_TheStartUpStopsAtTheBootTime_UntilARestart) {
  RecordProperty("spec", "ME3-MST-011 ME3-MST-012 ME3-NEC-007 ME3-SLV-015");
  IntelligentScenario s;
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}, {0x1F81, 3, optional}, {0x1F89, 0, 10000}});
  s.tx(0x000, {0x82, 0x00});
  const can::Time reset = s.now();
  s.advance(9999ms).expect(402, 0).expect_x(0x10, false).expect_bit(25, 14, true);
  s.advance(1ms).expect(402, 0x0010).expect_x(0x10, true).expect_bit(25, 14, false);
  EXPECT_EQ(since(s, reset), 10s);
  s.expect(25, 0x8100).expect(403, 0);  // still master, Pre-operational
  s.ignore_tx();
  s.rx(0x702, {0x00}).rx(0x703, {0x00}).advance(60s).no_tx();
  s.expect(25, 0x8100);
  s.restart();
  s.expect_bit(25, 14, true);
  s.wait_tx(0x602, ask_1000).ignore_tx();
}

TEST_P(NmtMaster, MasterStoppedDuringTheStartUp_SendsAndTakesNoSdo) {
  spec("ME3-SDO-006", "");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}});
  s.tx(0x000, {0x82, 0x00}).rx(0x702, {0x00}).tx(0x602, ask_1000);
  s.rx(0x000, {0x02, 0x01}).expect(25, 0xC000);
  s.rx(0x582, is_0191).advance(60s).no_tx().expect(25, 0xC000);
  s.rx(0x000, {0x80, 0x01}).wait_tx(0x602, time_out).wait_tx(0x602, ask_1000);
  s.rx(0x582, is_0191).tx(0x000, {0x01, 0x02}).expect(25, 0x8201).no_tx();
}

TEST_P(NmtMaster, BootTimeZero_IsNoLimit) {
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}});
  s.advance(3600s).ignore_tx().expect(402, 0).expect_bit(25, 14, true);
  slave_2_boots(s);
  s.tx(0x000, {0x01, 0x02}).expect(25, 0x8201);
}

TEST_P(NmtMaster, MandatoryHoldsTheStartBack_OptionalDoesNot) {
  spec("ME3-SLV-004", "");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, optional}, {0x1F81, 3, optional}});
  s.tx(0x000, {0x82, 0x00}).expect_bit(25, 0, true);
  s.supply_off().ignore_tx();

  IntelligentScenario t(GetParam());
  boot_master(t, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}, {0x1F81, 3, optional}});
  t.tx(0x000, {0x82, 0x00}).advance(100700ms).expect_bit(25, 0, false).ignore_tx();
  slave_2_boots(t);
  t.tx(0x000, {0x01, 0x02}).expect_bit(25, 0, true);
}

// --- S60

TEST(Me3NmtMaster, S60_WrongIdentity_EndsTheStartUp) {
  RecordProperty("spec", "ME3-ID-001 ME3-ID-002 ME3-SLV-008");
  struct Entry {
    std::uint16_t expected;  // 1F84H..1F88H
    std::uint16_t index;
    std::uint8_t sub;
  };
  const std::vector<Entry> entries{{0x1F84, 0x1000, 0},
                                   {0x1F85, 0x1018, 1},
                                   {0x1F86, 0x1018, 2},
                                   {0x1F87, 0x1018, 3},
                                   {0x1F88, 0x1018, 4}};
  for (const Entry& entry : entries) {
    for (const bool right : {true, false}) {
      IntelligentScenario s;
      boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}, {entry.expected, 2, 0x00020304}});
      s.tx(0x000, {0x82, 0x00}).rx(0x702, {0x00}).tx(0x602, ask_1000);
      const std::uint8_t lowest = right ? 0x04 : 0x05;
      const auto low = static_cast<std::uint8_t>(entry.index);
      if (entry.index == 0x1018) {
        s.rx(0x582, is_0191).tx(0x602, {0x40, low, 0x10, entry.sub, 0, 0, 0, 0});
      }
      s.rx(0x582, {0x43, low, 0x10, entry.sub, lowest, 0x03, 0x02, 0x00});
      if (right) {
        s.tx(0x000, {0x01, 0x02}).expect(402, 0).expect(25, 0x8201);
      } else {
        s.expect(402, 0x0010).expect_x(0x10, true).expect(25, 0x8100);
        s.rx(0x702, {0x00}).advance(60s).no_tx();  // the whole process is over
      }
    }
  }
}

TEST_P(NmtMaster, AllIdentityEntriesZero_OnlyThePresenceIsChecked) {
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}});
  s.tx(0x000, {0x82, 0x00});
  slave_2_boots(s);
  s.tx(0x000, {0x01, 0x02}).no_tx();
}

// --- 1F80H

TEST_P(NmtMaster, Bit1_StartsSinglyOrAllAtOnce) {
  spec("ME3-MST-002", "");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x01}, {0x1F81, 2, mandatory}, {0x1F81, 3, mandatory}});
  s.tx(0x000, {0x82, 0x00});
  slave_2_boots(s);
  s.tx(0x000, {0x01, 0x02});
  s.rx(0x703, {0x00}).tx(0x603, ask_1000).rx(0x583, is_0191).tx(0x000, {0x01, 0x03}).advance(5s).no_tx();

  IntelligentScenario t(GetParam());
  boot_master(t, {{0x1F80, 0, 0x03}, {0x1F81, 2, mandatory}, {0x1F81, 3, mandatory}});
  t.tx(0x000, {0x82, 0x00});
  slave_2_boots(t);
  t.rx(0x703, {0x00}).tx(0x603, ask_1000).rx(0x583, is_0191).no_tx();
  t.wait_tx(0x000, {0x01, 0x00}).advance(5s).no_tx();
}

TEST_P(NmtMaster, Bit2_TheStartUpIsSuspendedUntil1f82hStartsTheMaster) {
  spec("ME3-MST-003", "RJ71-STARTUP-014");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x07}, {0x1F81, 2, mandatory}});
  s.tx(0x000, {0x82, 0x00});
  slave_2_boots(s);
  s.advance(60s).no_tx().expect(25, 0xC100);
  s.set_object(0x1F82, 1, 0x05, 1);
  s.tx(0x000, {0x01, 0x00}).expect(25, 0x8201);
}

TEST_P(NmtMaster, Bit3_TheMasterDoesNotStartTheSlaves) {
  spec("ME3-MST-004", "RJ71-STARTUP-016");
  for (const std::uint32_t start_up : {0x09U, 0x0BU}) {
    IntelligentScenario s(GetParam());
    boot_master(s, {{0x1F80, 0, start_up}, {0x1F81, 2, mandatory}});
    s.tx(0x000, {0x82, 0x00});
    slave_2_boots(s);
    s.advance(60s).no_tx().expect(25, 0x8201);
    s.set_object(0x1F82, 2, 0x05, 1);
    s.tx(0x000, {0x01, 0x02});
  }
}

TEST_P(NmtMaster, Nmt102ah_Reads0_IsReadOnly_AndCommandsFollowEachOtherAtOnce) {
  spec("ME3-MST-014", "");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 3, 0x15}});
  for (std::uint8_t node = 2; node <= 127; ++node) {
    if (node != 3) s.tx(0x000, {0x82, node});
  }
  s.ignore_tx();
  s.expect_object(0x102A, 0, 0, 2);
  s.cif({0x0002, 0, 0x102A, 0, 2, 10});
  s.expect_abort(0x06010002);
  s.ignore_tx();
}

// --- 1F81H

TEST_P(NmtMaster, ReservedConfigurationBits_AreRefused) {
  spec("ME3-SLV-006", "");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x0D}});
  s.ignore_tx();
  for (const std::uint16_t bit : Words{0x02, 0x20, 0x40, 0x80}) {
    s.cif({0x0002, 0, 0x1F81, 2, 4, bit, 0});
    s.expect_abort(0x06090030);
    s.expect_object(0x1F81, 2, 0, 4);
  }
  s.set_object(0x1F81, 2, 0x0000001D, 4);
  s.expect_object(0x1F81, 2, 0x0000001D, 4);
}

TEST_P(NmtMaster, Layout_ConfigurationRetryFactorGuardTime_OwnSubIndexIgnored_Stored) {
  spec("ME3-SLV-001", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1F80, 0, 0x01, 4);
  s.set_object(0x1F81, 1, 0x00C8020D, 4);  // own node
  s.set_object(0x1F81, 9, 0x00C80201, 4);  // 200 ms, 2 tries, assigned
  s.store_objects();
  s.restart();
  s.rx(0x709, {0x00}).tx_remote(0x709).rx(0x709, {0x7F});
  const can::Time heard = s.now();
  s.advance(200ms).tx_remote(0x709).no_tx().expect_bit(409, 3, false);
  s.wait_bit(409, 3, true);
  EXPECT_EQ(since(s, heard), 400ms);
  s.ignore_tx().expect(401, 0);
  s.expect_object(0x1F81, 9, 0x00C80201, 4);
  s.expect_object(0x1F81, 1, 0x00C8020D, 4);
}

TEST_P(NmtMaster, NotAssigned_IsNeitherBootedNorGuarded) {
  spec("ME3-SLV-002", "");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x0064030C}});
  s.tx(0x000, {0x82, 0x00}).advance(1s).expect_bit(25, 0, true);
  s.rx(0x702, {0x00}).advance(60s).no_tx();
  s.supply_off();

  IntelligentScenario t(GetParam());
  boot_master(t, {{0x1F80, 0, 1}, {0x1F81, 2, 0x0064030D}});
  t.tx(0x000, {0x82, 0x00}).rx(0x702, {0x00}).tx(0x602, ask_1000).rx(0x582, is_0191).tx_remote(0x702);
  t.rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02});
}

TEST(Me3NmtMaster, StartOfErrorControl_HeartbeatInItsTime_OrGuardingAnswerIn100Ms) {
  RecordProperty("spec", "ME3-SLV-010");
  {  // the heartbeat comes
    IntelligentScenario s;
    boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x0064030D}, {0x1016, 1, 0x000205DC}});
    s.tx(0x000, {0x82, 0x00});
    slave_2_boots(s);
    s.advance(1499ms).no_tx().expect(25, 0xC100);
    s.rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02}).expect(25, 0x8201);
  }
  {  // it does not
    IntelligentScenario s;
    boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x0064030D}, {0x1016, 1, 0x000205DC}});
    s.tx(0x000, {0x82, 0x00});
    slave_2_boots(s);
    s.advance(1499ms).expect(402, 0);
    s.advance(1ms).expect(402, 0x0010).expect(25, 0x8100).advance(60s).no_tx();
  }
  {  // guarding answered
    IntelligentScenario s;
    boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x03E8030D}});
    s.tx(0x000, {0x82, 0x00});
    slave_2_boots(s);
    s.tx_remote(0x702).advance(99ms).no_tx();
    s.rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02}).expect(25, 0x8201);
  }
  {  // not answered
    IntelligentScenario s;
    boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x03E8030D}});
    s.tx(0x000, {0x82, 0x00});
    slave_2_boots(s);
    s.tx_remote(0x702).advance(99ms).expect_bit(402, 4, false);
    s.advance(1ms).expect_bit(402, 4, true).expect(25, 0x8100).no_tx();
    s.ignore_tx();
  }
}

TEST(Me3NmtMaster, GuardingProbeWithoutSettings_OnlyForASlaveThatIsToBeKeptAlive) {
  RecordProperty("spec", "ME3-SLV-011");
  IntelligentScenario s;
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x1D}});
  for (std::uint8_t node = 3; node <= 127; ++node) s.tx(0x000, {0x82, node});
  s.tx(0x602, ask_1000).rx(0x582, is_0191).tx_remote(0x702);
  s.advance(99ms).expect(402, 0).advance(1ms).expect(402, 0x0010).expect(25, 0x8100).no_tx();

  IntelligentScenario t;
  boot_master(t, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}});
  t.tx(0x000, {0x82, 0x00});
  slave_2_boots(t);
  t.tx(0x000, {0x01, 0x02}).no_tx();
}

TEST_P(NmtMaster, StartStep_EachBootedSlaveSingly_UnlessBit1OrBit3) {
  spec("ME3-SLV-013", "RJ71-STARTUP-010");
  for (const std::uint32_t start_up : {0x01U, 0x03U, 0x09U}) {
    IntelligentScenario s(GetParam());
    boot_master(s, {{0x1F80, 0, start_up}, {0x1F81, 2, mandatory}, {0x1F81, 3, optional}});
    s.tx(0x000, {0x82, 0x00});
    slave_2_boots(s);
    if (start_up == 0x01) s.tx(0x000, {0x01, 0x02});  // the master is Operational only after this
    s.expect_bit(25, 0, true).no_tx();
    s.advance(600ms);
    if (start_up == 0x03) s.tx(0x000, {0x01, 0x02});  // node 3 is not there: no Start all
    s.ignore_tx();
    s.rx(0x703, {0x00}).advance(2s);
    s.tx(0x603, ask_1000);
    s.ignore_tx().rx(0x703, {0x00}).tx(0x603, ask_1000).rx(0x583, is_0191);
    if (start_up != 0x09) s.tx(0x000, {0x01, 0x03});
    s.no_tx();
  }
}

// --- S61

TEST(Me3NmtMaster, S61_LostOptionalSlave_IsResetAndBootedAgain) {
  RecordProperty("spec", "ME3-ERH-001 ME3-STAT-010");
  for (const std::uint32_t start_up : {0x01U, 0x11U, 0x41U, 0x51U}) {
    IntelligentScenario s;
    run_with_slave_2(s, start_up, optional);
    const can::Time heard = s.now();
    s.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x82, 0x02}).no_tx();
    EXPECT_EQ(since(s, heard), 1500ms);
    s.expect_bit(25, 14, true).expect_bit(25, 0, true);
    slave_2_boots_again(s);
    s.rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02}).no_tx().expect_bit(25, 14, false);
  }
}

TEST(Me3NmtMaster, S61_LostMandatorySlave_Bits6And4Clear_IsResetAndBootedAgain) {
  RecordProperty("spec", "ME3-ERH-002");
  IntelligentScenario s;
  run_with_slave_2(s, 0x01, mandatory);
  s.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x82, 0x02}).no_tx();
  slave_2_boots_again(s);
  s.rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02}).no_tx();
}

TEST(Me3NmtMaster, S61_LostMandatorySlave_Bit4_ResetsTheNetworkAndStartsItAnew) {
  RecordProperty("spec", "ME3-ERH-003 ME3-MST-005");
  IntelligentScenario s;
  run_with_slave_2(s, 0x11, mandatory);
  s.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x82, 0x00}).no_tx();
  s.expect(25, 0xC101 & ~1U);  // Pre-operational again until the slave is booted
  slave_2_boots_again(s);
  s.expect_bit(25, 0, false);
  s.rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02}).no_tx().expect(25, 0x8201);

  IntelligentScenario clear;  // 0: that node alone
  run_with_slave_2(clear, 0x01, mandatory);
  clear.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x82, 0x02}).no_tx();

  IntelligentScenario both;  // bit 6 wins
  run_with_slave_2(both, 0x51, mandatory);
  both.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x02, 0x00}).no_tx();

  IntelligentScenario single;  // an optional slave always alone
  run_with_slave_2(single, 0x11, optional);
  single.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x82, 0x02}).no_tx();
}

TEST(Me3NmtMaster, S61_LostMandatorySlave_Bit6_StopsAllUntilARestart) {
  RecordProperty("spec", "ME3-ERH-004 ME3-MST-007");
  enum class Way : std::uint8_t { restart, reset_communication, reset_node };
  for (const Way way : {Way::restart, Way::reset_communication, Way::reset_node}) {
    IntelligentScenario s;
    run_with_slave_2(s, 0x41, mandatory);
    s.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x02, 0x00}).no_tx();
    s.expect(25, 0x8000);  // Stopped, nothing in progress
    s.rx(0x702, {0x00}).rx(0x702, {0x7F}).advance(60s).ignore_tx().rx(0x702, {0x00}).advance(60s).no_tx();
    // Nor does it go on when the module leaves Stopped without a reset.
    s.rx(0x000, {0x80, 0x01}).expect(25, 0x8100).rx(0x702, {0x00}).rx(0x702, {0x7F}).advance(1s);
    s.no_tx().rx(0x000, {0x01, 0x01}).rx(0x702, {0x00}).advance(1s).no_tx();
    s.rx(0x000, {0x02, 0x01}).expect(25, 0x8000).ignore_tx();
    if (way == Way::restart) {
      s.restart();
    } else {
      // Stopped: the command interface works on the own dictionary all the same.
      s.cif({0x0002, 0, 0x1F82, 0x80, 1, static_cast<std::uint16_t>(way == Way::reset_node ? 6 : 7)});
      s.expect(1000, 0x0003);
      s.tx(0x000, {static_cast<std::uint8_t>(way == Way::reset_node ? 0x81 : 0x82), 0x00});
      s.wait_tx(0x701, {0x00}).tx(0x000, {0x82, 0x00});
    }
    s.ignore_tx();
    slave_2_boots(s);
    s.rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02}).expect_bit(25, 0, true);
  }
}

TEST_P(NmtMaster, ErrorSources_HeartbeatGuardingAndUnexpectedState) {
  spec("ME3-ERH-005 ME3-NG-006 ME3-NEC-008", "RJ71-ERREV-001 RJ71-NG-003");
  {  // heartbeat
    IntelligentScenario s(GetParam());
    run_with_slave_2(s, 0x01, mandatory);
    s.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x82, 0x02});
    s.expect_bit(402, 7, true).ignore_tx();
  }
  const auto guarded = [](IntelligentScenario& s) {
    boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x0064030D}});
    s.tx(0x000, {0x82, 0x00});
    slave_2_boots(s);
    s.tx_remote(0x702).rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02}).expect(402, 0x0001);
    s.advance(100ms).tx_remote(0x702).rx(0x702, {0x85}).no_tx().expect(402, 0x0001).expect(602, 5);
  };
  {  // no answer in the life time: bit 3
    IntelligentScenario s(GetParam());
    guarded(s);
    s.advance(200ms).ignore_tx().expect(402, 0x0005);
    s.advance(99ms).no_tx();
    s.advance(1ms);
    s.expect(402, 0x000D);
    s.tx_remote(0x702).tx(0x000, {0x82, 0x02}).tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).no_tx();
  }
  {  // another state than the one commanded last: bit 5
    IntelligentScenario s(GetParam());
    guarded(s);
    s.advance(100ms).tx_remote(0x702).rx(0x702, {0x7F}).expect(402, 0x0021);
    s.tx(0x000, {0x82, 0x02}).tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).no_tx();
  }
  {  // a wrong toggle bit, one miss: bit 2 and no more
    IntelligentScenario s(GetParam());
    guarded(s);
    s.advance(100ms).tx_remote(0x702).rx(0x702, {0x85}).expect(402, 0x0005).no_tx();
    s.supply_off();
    IntelligentScenario t(GetParam());
    guarded(t);
    t.advance(100ms).tx_remote(0x702).advance(100ms).tx_remote(0x702).expect(402, 0x0005).no_tx();
  }
}

TEST_P(NmtMaster, UnassignedNodeLost_IsShownWithoutAnyCommand) {
  spec("ME3-ERH-006", "RJ71-ERREV-002");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x51}, {0x1016, 1, 0x000205DC}});
  s.tx(0x000, {0x82, 0x00}).advance(1s).rx(0x702, {0x05}).no_tx();
  s.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).advance(60s).no_tx();
  s.expect(402, 0x0082).expect_x(0x10, true).expect_bit(25, 0, true);
}

// --- S62

TEST_P(NmtMaster, S62_LateBootUp_IsFollowedByTheSlavesStartUp) {
  spec("ME3-SLV-014 ME3-MST-013", "RJ71-BOOTUP-001 RJ71-BOOTUP-002");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, optional}});
  s.tx(0x000, {0x82, 0x00});
  slave_2_boots(s);
  s.tx(0x000, {0x01, 0x02}).advance(100s).expect_bit(25, 14, false).no_tx();
  s.rx(0x702, {0x00}).tx(0x602, ask_1000).expect(602, 0x7F).expect_bit(25, 14, true);
  s.rx(0x582, is_0191).tx(0x000, {0x01, 0x02}).no_tx().expect_bit(25, 14, false).expect(602, 5);
  // Master Stopped: nothing.
  s.rx(0x000, {0x02, 0x01}).expect_bit(25, 8, false).expect_bit(25, 9, false);
  s.rx(0x702, {0x00}).advance(60s).no_tx().expect_bit(25, 14, false);
}

// --- S63, S64

TEST_P(NmtMaster, S63_RequestsExcludingTheMaster_LeaveTheOwnStateAlone) {
  spec("ME3-RQN-003", "RJ71-NODECTL-006");
  const std::vector<std::pair<std::uint16_t, std::uint8_t>> services{
      {0x84, 0x02}, {0x85, 0x01}, {0x86, 0x81}, {0x87, 0x82}, {0x8F, 0x80}};
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x09}});
  s.tx(0x000, {0x82, 0x00}).advance(1s).expect(25, 0x8201);
  for (const auto& [value, command] : services) {
    s.set_object(0x1F82, 2, value, 1);
    s.tx(0x000, {command, 0x02}).no_tx().expect(25, 0x8201).expect(601, 5);
    s.set_object(0x1F82, 0x80, value, 1);
    s.tx(0x000, {command, 0x00}).no_tx().expect(25, 0x8201).expect(601, 5);
  }
}

TEST_P(NmtMaster, S63_ReadingRequestNmt_GivesTheWordsOfTheStateArea) {
  spec("ME3-RQN-005 ME3-NST-001", "RJ71-NODECTL-009 RJ71-NODECTL-010 RJ71-BM-018");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x0D}, {0x1F81, 3, optional}});
  s.tx(0x000, {0x82, 0x00}).advance(3s).ignore_tx();
  s.expect(602, 0x00);
  s.expect_object(0x1F82, 2, 0x00, 1);  // unknown
  s.expect(603, 0x01);
  s.expect_object(0x1F82, 3, 0x01, 1);  // missing
  const std::map<std::uint16_t, std::uint16_t> states{{0x04, 0x04}, {0x05, 0x05}, {0x7F, 0x7F}};
  for (const auto& [request, state] : states) {
    s.set_object(0x1F82, 127, request, 1);
    s.expect(727, state);
    s.expect_object(0x1F82, 127, state, 1);
  }
  s.set_object(0x1F82, 127, 0x85, 1);
  s.expect(727, 0x05);
  s.expect_object(0x1F82, 127, 0x05, 1);  // the state, not what was written
  s.expect(601, 0x7F);
  s.expect_object(0x1F82, 1, 0x7F, 1);
  s.ignore_tx();
  s.cif({0x0004, 0, 0x1F82, 0x80});
  s.expect_abort(0x06010001);  // write only
  s.set_object(0x1F82, 1, 0x07, 1);
  s.expect(601, 0x07);  // in the middle of its own reset
  s.wait_bit(25, 7, false).expect(601, 0x7F).ignore_tx();
}

TEST_P(NmtMaster, SlaveStoppedByRequest_IsNotStartedAgainBeforeARestart) {
  spec("ME3-RQN-006", "");
  for (const std::uint16_t request : Words{0x04, 0x7F}) {
    IntelligentScenario s(GetParam());
    boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, optional}});
    s.tx(0x000, {0x82, 0x00});
    slave_2_boots(s);
    s.tx(0x000, {0x01, 0x02});
    s.set_object(0x1F82, 2, request, 1);
    s.ignore_tx();
    s.rx(0x702, {0x00}).tx(0x602, ask_1000).rx(0x582, is_0191).advance(60s).no_tx();
    s.restart();
    s.ignore_tx();
    slave_2_boots(s);
    s.tx(0x000, {0x01, 0x02});
  }
}

TEST_P(NmtMaster, S64_BroadcastCommandsAreIgnoredByTheActiveMaster) {
  spec("ME3-NMT-009", "RJ71-NODECTL-012");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x01}});
  s.tx(0x000, {0x82, 0x00}).advance(1s).expect(25, 0x8201);
  for (const std::uint8_t command : Bytes{0x02, 0x80, 0x81, 0x82, 0x01}) {
    s.rx(0x000, {command, 0x00}).advance(1s).no_tx().expect(25, 0x8201);
  }
}

// --- S65

TEST(Me3NmtMaster, S65_HeartbeatConsumer_WatchesFromTheFirstHeartbeatOn) {
  RecordProperty("spec", "ME3-HB-003 ME3-HB-004 ME3-NEC-004 ME3-NST-004 ME3-NST-006");
  IntelligentScenario s;
  boot_master(s, {{0x1F80, 0, 0x0D}, {0x1016, 1, 0x000205DC}});
  s.tx(0x000, {0x82, 0x00}).advance(60s).no_tx();
  s.expect(402, 0).expect_x(0x10, false);
  s.rx(0x702, {0x05}).expect(402, 0x0002).expect(602, 5);
  s.advance(1000ms).rx(0x702, {0x04}).expect(602, 4);
  s.set_object(0x1F82, 2, 0x05, 1);
  s.tx(0x000, {0x01, 0x02}).expect(602, 4);  // what is heard counts, not what was commanded
  s.rx(0x702, {0x05}).expect(602, 5);
  s.advance(1499ms).expect(402, 0x0002).no_tx();
  s.advance(1ms).expect(402, 0x0082).expect_x(0x10, true);
  s.tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).no_tx();
  s.expect(602, 5);  // may be stale
  s.rx(0x702, {0x00}).expect(602, 0x7F).advance(60s).expect(602, 0x7F).tx(0x081, no_error).no_tx();
  s.rx(0x702, {0x05}).expect(602, 5);
}

TEST_P(NmtMaster, S65_HeartbeatsAreShownInAnyRole) {
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1016, 127, 0x006403E8}});
  s.rx(0x764, {0x04}).expect(700, 4).expect(500, 0x0002);
  s.advance(1s).expect(500, 0x0082).ignore_tx();
}

// --- S66

TEST_P(NmtMaster, S66_Guarding_AsksEveryGuardTime_AndFindsMissesLossAndReturn) {
  spec("ME3-NG-004 ME3-NG-005 ME3-NEC-003 ME3-NEC-005 ME3-NEC-006 ME3-NG-007", "RJ71-NG-001");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x00640301}, {0x1F81, 1, 0x00640301}});
  s.tx(0x000, {0x82, 0x00}).no_tx();  // nothing for the own node
  s.rx(0x702, {0x00}).tx_remote(0x702).expect(402, 0x0001);
  s.rx(0x702, {0x7F});
  bool toggle = true;
  for (int i = 0; i < 5; ++i) {
    s.advance(99ms).no_tx().advance(1ms).tx_remote(0x702);
    s.rx(0x702, {static_cast<std::uint8_t>(toggle ? 0xFF : 0x7F)}).no_tx();
    toggle = !toggle;
  }
  s.expect(402, 0x0001).expect(602, 0x7F);
  // One miss.
  s.advance(100ms).tx_remote(0x702).advance(99ms).expect(402, 0x0001).advance(1ms).tx_remote(0x702);
  s.expect(402, 0x0005).expect_x(0x10, true);
  s.rx(0x702, {static_cast<std::uint8_t>(toggle ? 0xFF : 0x7F)});
  // Life time 3 x 100 ms.
  const can::Time heard = s.now();
  s.wait_bit(402, 3, true);
  EXPECT_EQ(since(s, heard), 300ms);
  s.ignore_tx();
  // It goes on asking, and hears it again.
  s.wait_bit(25, 7, false)
      .advance(100ms)
      .tx_remote(0x702)
      .rx(0x702, {0x04})
      .expect(602, 4)
      .expect_bit(402, 0, true);
  s.ignore_tx();
}

TEST_P(NmtMaster, S66_Guarding_NeedsAssignment_RetryFactorAndGuardTime) {
  spec("ME3-NG-004", "RJ71-NG-001");
  for (const std::uint32_t assignment : {0x00640300U, 0x00640001U, 0x00000301U, 0x00000001U}) {
    IntelligentScenario s(GetParam());
    boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, assignment}});
    s.ignore_tx().rx(0x702, {0x00}).advance(500ms);
    for (const can::Frame& frame : s.controller().sent) EXPECT_FALSE(frame.remote) << std::hex << assignment;
    s.ignore_tx().expect_bit(402, 0, false);
  }
}

TEST_P(NmtMaster, S66_Guarding_OnlyOfTheActiveMaster_AndNotOfAHeartbeatNode) {
  spec("ME3-NST-005", "RJ71-NODECTL-011");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F81, 2, 0x00640301}});
  s.rx(0x702, {0x00}).advance(5s).no_tx().rx(0x702, {0x05}).expect(602, 0).expect(402, 0);

  IntelligentScenario t(GetParam());
  boot_master(t, {{0x1F80, 0, 1}, {0x1F81, 2, 0x00640301}});
  t.tx(0x000, {0x82, 0x00}).rx(0x702, {0x00}).tx_remote(0x702).rx(0x702, {0x05}).expect(602, 5).ignore_tx();

  IntelligentScenario u(GetParam());  // heartbeat consuming in any role
  boot_master(u, {{0x1016, 1, 0x000205DC}});
  u.rx(0x702, {0x05}).expect(602, 5).expect(402, 0x0002);
}

TEST_P(NmtMaster, S66_RequestGuarding_StopsAndStartsIt) {
  spec("ME3-NG-009", "RJ71-NG-004 RJ71-NG-009");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x00640301}, {0x1F81, 3, 0x00640301}, {0x1F81, 4, 0x00000001}});
  s.tx(0x000, {0x82, 0x00});
  s.rx(0x702, {0x00}).tx_remote(0x702).rx(0x702, {0x7F});
  s.rx(0x703, {0x00}).tx_remote(0x703).rx(0x703, {0x7F});
  s.rx(0x704, {0x00}).no_tx();
  s.expect_object(0x1F83, 2, 1, 1);
  s.expect_object(0x1F83, 3, 1, 1);
  s.expect_object(0x1F83, 4, 0, 1);
  s.set_object(0x1F83, 2, 0, 1);
  s.expect_object(0x1F83, 2, 0, 1).expect_bit(402, 0, false);
  s.expect_object(0x1F83, 3, 1, 1);
  s.set_object(0x1F83, 0x80, 0, 1);
  s.ignore_tx();
  s.expect_object(0x1F83, 3, 0, 1).advance(5s).no_tx();
  s.set_object(0x1F83, 2, 1, 1);
  s.tx_remote(0x702).no_tx();
  s.expect_object(0x1F83, 2, 1, 1);
  s.set_object(0x1F83, 2, 0, 1);
  s.set_object(0x1F83, 0x80, 1, 1);
  s.ignore_tx();
  s.expect_object(0x1F83, 2, 1, 1);
  s.expect_object(0x1F83, 3, 1, 1);
  s.expect_object(0x1F83, 4, 0, 1);
  for (const std::uint16_t reserved : Words{0x02, 0x7F, 0xFF}) {
    s.cif({0x0002, 0, 0x1F83, 2, 1, reserved});
    s.expect_abort(0x06090030);
  }
  s.ignore_tx();

  IntelligentScenario slave(GetParam());
  boot_master(slave, {{0x1F81, 2, 0x00640301}});
  slave.cif({0x0002, 0, 0x1F83, 2, 1, 1});
  slave.expect_abort(0x08000022).no_tx();
}

TEST_P(NmtMaster, S66_HeartbeatEntry_OverridesTheGuardingSettings) {
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x00640301}, {0x1016, 1, 0x000205DC}});
  s.tx(0x000, {0x82, 0x00}).rx(0x702, {0x00}).rx(0x702, {0x7F}).advance(1s).no_tx();
  s.set_object(0x1F83, 2, 1, 1);
  s.no_tx();
  s.expect_object(0x1F83, 2, 0, 1).expect(402, 0x0002);
}

// --- clearing

TEST_P(NmtMaster, ClearingTheFailures_KeepsTheActivityBits) {
  spec("ME3-NEC-012", "");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x0D}, {0x1F81, 3, 0x00640301}, {0x1016, 1, 0x000205DC}});
  s.tx(0x000, {0x82, 0x00}).rx(0x702, {0x05});
  s.rx(0x703, {0x00}).tx_remote(0x703).rx(0x703, {0x7F});
  s.advance(100ms).tx_remote(0x703).rx(0x703, {0x7F});  // toggle bit wrong
  s.expect(403, 0x0005);
  s.advance(1400ms).expect_bit(402, 7, true).ignore_tx();
  s.y(0x10, true).wait_x(0x10, false);
  s.expect(402, 0x0002).expect(403, 0x0001);
  s.ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario
