// spec/me3can1-q/scenarios.md, section 9: the module as NMT master - lost and late slaves (S61, S62), 1F81H.

#include "scenarios/me3can1_q/nmt_master_slave.hpp"

namespace canopus::scenario::me3can1_q_nmt_master_slaves_test {
namespace {

using namespace nmt_master_slave;

CANOPUS_OF_BOTH_MODULES(NmtMasterSlaves);

// --- 1F81H

TEST_P(NmtMasterSlaves, ReservedConfigurationBits_AreRefused) {
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

TEST_P(NmtMasterSlaves, Layout_ConfigurationRetryFactorGuardTime_OwnSubIndexIgnored_Stored) {
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

TEST_P(NmtMasterSlaves, NotAssigned_IsNeitherBootedNorGuarded) {
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

TEST(Me3NmtMasterSlaves, StartOfErrorControl_HeartbeatInItsTime_OrGuardingAnswerIn100Ms) {
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

TEST(Me3NmtMasterSlaves, GuardingProbeWithoutSettings_OnlyForASlaveThatIsToBeKeptAlive) {
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

TEST_P(NmtMasterSlaves, StartStep_EachBootedSlaveSingly_UnlessBit1OrBit3) {
  spec("ME3-SLV-013", "RJ71-STARTUP-010");
  for (const std::uint32_t start_up : {0x01U, 0x03U, 0x09U}) {
    IntelligentScenario s(GetParam());
    boot_master(s, {{0x1F80, 0, start_up}, {0x1F81, 2, mandatory}, {0x1F81, 3, optional}});
    s.tx(0x000, {0x82, 0x00});
    slave_2_boots(s);
    const bool waits = start_up == 0x03 && !s.is_rj71cn91();  // 500 ms after the reset; G70 is 0 there
    // Without bit 1 the master is Operational only after this. With it: node 3 is not there, so no Start all.
    if (start_up != 0x09 && !waits) s.tx(0x000, {0x01, 0x02});
    s.expect_bit(25, 0, true).no_tx();
    s.advance(600ms);
    if (waits) s.tx(0x000, {0x01, 0x02});
    s.ignore_tx();
    s.rx(0x703, {0x00}).advance(2s);
    s.tx(0x603, ask_1000);
    s.ignore_tx().rx(0x703, {0x00}).tx(0x603, ask_1000).rx(0x583, is_0191);
    if (start_up != 0x09) s.tx(0x000, {0x01, 0x03});
    s.no_tx();
  }
}

// --- S61

TEST(Me3NmtMasterSlaves, S61_LostOptionalSlave_IsResetAndBootedAgain) {
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

TEST(Me3NmtMasterSlaves, S61_LostMandatorySlave_Bits6And4Clear_IsResetAndBootedAgain) {
  RecordProperty("spec", "ME3-ERH-002");
  IntelligentScenario s;
  run_with_slave_2(s, 0x01, mandatory);
  s.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x82, 0x02}).no_tx();
  slave_2_boots_again(s);
  s.rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02}).no_tx();
}

TEST(Me3NmtMasterSlaves, S61_LostMandatorySlave_Bit4_ResetsTheNetworkAndStartsItAnew) {
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

TEST(Me3NmtMasterSlaves, S61_LostMandatorySlave_Bit6_StopsAllUntilARestart) {
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

TEST_P(NmtMasterSlaves, ErrorSources_HeartbeatGuardingAndUnexpectedState) {
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
    s.expect(402, either(0x000D, 0x000C));
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

TEST_P(NmtMasterSlaves, UnassignedNodeLost_IsShownWithoutAnyCommand) {
  spec("ME3-ERH-006", "RJ71-ERREV-002");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x51}, {0x1016, 1, 0x000205DC}});
  s.tx(0x000, {0x82, 0x00}).advance(1s).rx(0x702, {0x05}).no_tx();
  s.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).advance(60s).no_tx();
  s.expect(402, either(0x0082, 0x0080)).expect_x(0x10, true).expect_bit(25, 0, true);
}

// --- S62

TEST_P(NmtMasterSlaves, S62_LateBootUp_IsFollowedByTheSlavesStartUp) {
  spec("ME3-SLV-014 ME3-MST-013", "RJ71-BOOTUP-001 RJ71-BOOTUP-002");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, optional}});
  s.tx(0x000, {0x82, 0x00});
  slave_2_boots(s);
  s.tx(0x000, {0x01, 0x02}).advance(100s).expect_bit(25, 14, false).no_tx();
  s.rx(0x702, {0x00}).tx(0x602, ask_1000).expect(602, 0x7F).expect_bit(25, 14, true);
  s.rx(0x582, is_0191).tx(0x000, {0x01, 0x02}).no_tx().expect_bit(25, 14, false).expect(602, 5);
  // Master Stopped: nothing.
  s.set_object(0x1F82, 1, 0x04, 1);
  s.expect_bit(25, 8, false).expect_bit(25, 9, false);
  s.rx(0x702, {0x00}).advance(60s).no_tx().expect_bit(25, 14, false);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_nmt_master_slaves_test
