// spec/me3can1-q/scenarios.md, section 9: the module as NMT master - start-up (S57 to S60), 1F80H.

#include "scenarios/me3can1_q/nmt_master_slave.hpp"

namespace canopus::scenario::me3can1_q_nmt_master_start_up_test {
namespace {

using namespace nmt_master_slave;

CANOPUS_OF_BOTH_MODULES(NmtMasterStartUp);

// --- S57

TEST_P(NmtMasterStartUp, S57_SimpleStart_ResetsAll_WaitsG70_BecomesOperational_StartsAll) {
  spec("ME3-MST-009", "");
  IntelligentScenario s(GetParam());
  boot_master_with_its_delay(s, {{0x1F80, 0, 0x00000003}});
  s.tx(0x000, {0x82, 0x00}).no_tx();
  const can::Time reset = s.now();
  s.expect(25, 0xC100).expect(70, 500);
  s.advance(499ms).no_tx().expect_bit(25, 0, false);
  s.wait_tx(0x000, {0x01, 0x00});
  EXPECT_EQ(since(s, reset), 500ms);
  s.expect(25, 0x8201).no_tx();
}

TEST_P(NmtMasterStartUp, S57_G70_IsTheLeastPauseBetweenResetAllAndStartAll) {
  spec("ME3-DLY-001", "RJ71-BM-022");
  for (const unsigned g70 : {0U, 2000U, 65535U}) {
    IntelligentScenario s(GetParam());
    boot_master_with_its_delay(s, {{0x1F80, 0, 0x00000003}, {0x1F81, 2, mandatory}});
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

TEST_P(NmtMasterStartUp, S58_MandatorySlave_IsAskedUntilItAnswers_Started_AndThenTheMasterIsOperational) {
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
TEST_P(NmtMasterStartUp, S58_SdoTimeOut_IsG71) {
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
TEST_P(NmtMasterStartUp, S57_G70_CountsFromTheWriteOn) {
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

TEST_P(NmtMasterStartUp, PresenceCheck_IsRepeatedOneSecondAfterEachTimeOut_UntilTheBootTimeOrWithoutEnd) {
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

TEST(Me3NmtMasterStartUp, S59_MandatorySlaveMissing_TheStartUpStopsAtTheBootTime_UntilARestart) {
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

TEST_P(NmtMasterStartUp, MasterStoppedDuringTheStartUp_SendsAndTakesNoSdo) {
  spec("ME3-SDO-006", "");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}});
  s.tx(0x000, {0x82, 0x00}).rx(0x702, {0x00}).tx(0x602, ask_1000);
  s.set_object(0x1F82, 1, 0x04, 1);
  s.expect(25, 0xC000);
  s.rx(0x582, is_0191).advance(60s).no_tx().expect(25, 0xC000);
  s.set_object(0x1F82, 1, 0x7F, 1);
  s.wait_tx(0x602, time_out).wait_tx(0x602, ask_1000);
  s.rx(0x582, is_0191).tx(0x000, {0x01, 0x02}).expect(25, 0x8201).no_tx();
}

TEST_P(NmtMasterStartUp, BootTimeZero_IsNoLimit) {
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}});
  s.advance(3600s).ignore_tx().expect(402, 0).expect_bit(25, 14, true);
  slave_2_boots(s);
  s.tx(0x000, {0x01, 0x02}).expect(25, 0x8201);
}

TEST_P(NmtMasterStartUp, MandatoryHoldsTheStartBack_OptionalDoesNot) {
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

TEST(Me3NmtMasterStartUp, S60_WrongIdentity_EndsTheStartUp) {
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

TEST_P(NmtMasterStartUp, AllIdentityEntriesZero_OnlyThePresenceIsChecked) {
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}});
  s.tx(0x000, {0x82, 0x00});
  slave_2_boots(s);
  s.tx(0x000, {0x01, 0x02}).no_tx();
}

// --- 1F80H

TEST_P(NmtMasterStartUp, Bit1_StartsSinglyOrAllAtOnce) {
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
  t.rx(0x703, {0x00}).tx(0x603, ask_1000).rx(0x583, is_0191);
  if (!is_rj71cn91()) t.no_tx();  // whose G70 is 0 here
  t.wait_tx(0x000, {0x01, 0x00}).advance(5s).no_tx();
}

TEST_P(NmtMasterStartUp, Bit2_TheStartUpIsSuspendedUntil1f82hStartsTheMaster) {
  spec("ME3-MST-003", "RJ71-STARTUP-014");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x07}, {0x1F81, 2, mandatory}});
  s.tx(0x000, {0x82, 0x00});
  slave_2_boots(s);
  s.advance(60s).no_tx().expect(25, 0xC100);
  s.set_object(0x1F82, 1, 0x05, 1);
  s.tx(0x000, {0x01, 0x00}).expect(25, 0x8201);
}

TEST_P(NmtMasterStartUp, Bit3_TheMasterDoesNotStartTheSlaves) {
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

TEST_P(NmtMasterStartUp, Nmt102ah_Reads0_IsReadOnly_AndCommandsFollowEachOtherAtOnce) {
  spec("ME3-MST-014", "");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 3, 0x15}});
  for (std::uint8_t node = 2; node <= 127; ++node) {
    if (node != 3 && !is_rj71cn91()) s.tx(0x000, {0x82, node});  // which resets its slaves alone
  }
  s.ignore_tx();
  s.expect_object(0x102A, 0, 0, 2);
  s.cif({0x0002, 0, 0x102A, 0, 2, 10});
  s.expect_abort(0x06010002);
  s.ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_nmt_master_start_up_test
