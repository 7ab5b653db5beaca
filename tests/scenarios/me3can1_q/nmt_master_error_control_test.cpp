// spec/me3can1-q/scenarios.md, section 9: the module as NMT master - requests, heartbeat and guarding (S63 to S66).

#include "scenarios/me3can1_q/nmt_master_slave.hpp"

namespace canopus::scenario::me3can1_q_nmt_master_error_control_test {
namespace {

using namespace nmt_master_slave;

CANOPUS_OF_BOTH_MODULES(NmtMasterErrorControl);

// --- S63, S64

TEST_P(NmtMasterErrorControl, S63_RequestsExcludingTheMaster_LeaveTheOwnStateAlone) {
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

TEST_P(NmtMasterErrorControl, S63_ReadingRequestNmt_GivesTheWordsOfTheStateArea) {
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

TEST_P(NmtMasterErrorControl, SlaveStoppedByRequest_IsNotStartedAgainBeforeARestart) {
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

TEST_P(NmtMasterErrorControl, S64_BroadcastCommandsAreIgnoredByTheActiveMaster) {
  spec("ME3-NMT-009", "RJ71-NODECTL-012");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x01}});
  s.tx(0x000, {0x82, 0x00}).advance(1s).expect(25, 0x8201);
  for (const std::uint8_t command : Bytes{0x02, 0x80, 0x81, 0x82, 0x01}) {
    s.rx(0x000, {command, 0x00}).advance(1s).no_tx().expect(25, 0x8201);
  }
}

// --- S65

TEST(Me3NmtMasterErrorControl, S65_HeartbeatConsumer_WatchesFromTheFirstHeartbeatOn) {
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

TEST_P(NmtMasterErrorControl, S65_HeartbeatsAreShownInAnyRole) {
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1016, 127, 0x006403E8}});
  s.rx(0x764, {0x04}).expect(700, 4).expect(500, 0x0002);
  s.advance(1s).expect(500, either(0x0082, 0x0080)).ignore_tx();
}

// --- S66

TEST_P(NmtMasterErrorControl, S66_Guarding_AsksEveryGuardTime_AndFindsMissesLossAndReturn) {
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

TEST_P(NmtMasterErrorControl, S66_Guarding_NeedsAssignment_RetryFactorAndGuardTime) {
  spec("ME3-NG-004", "RJ71-NG-001");
  for (const std::uint32_t assignment : {0x00640300U, 0x00640001U, 0x00000301U, 0x00000001U}) {
    IntelligentScenario s(GetParam());
    boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, assignment}});
    s.ignore_tx().rx(0x702, {0x00}).advance(500ms);
    for (const can::Frame& frame : s.controller().sent) EXPECT_FALSE(frame.remote) << std::hex << assignment;
    s.ignore_tx().expect_bit(402, 0, false);
  }
}

TEST_P(NmtMasterErrorControl, S66_Guarding_OnlyOfTheActiveMaster_AndNotOfAHeartbeatNode) {
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

TEST_P(NmtMasterErrorControl, S66_RequestGuarding_StopsAndStartsIt) {
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

TEST_P(NmtMasterErrorControl, S66_HeartbeatEntry_OverridesTheGuardingSettings) {
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x00640301}, {0x1016, 1, 0x000205DC}});
  s.tx(0x000, {0x82, 0x00}).rx(0x702, {0x00}).rx(0x702, {0x7F}).advance(1s).no_tx();
  s.set_object(0x1F83, 2, 1, 1);
  s.no_tx();
  s.expect_object(0x1F83, 2, 0, 1).expect(402, 0x0002);
}

// --- clearing

TEST_P(NmtMasterErrorControl, ClearingTheFailures_KeepsTheActivityBits) {
  spec("ME3-NEC-012", "");
  IntelligentScenario s(GetParam());
  boot_master(s, {{0x1F80, 0, 0x0D}, {0x1F81, 3, 0x00640301}, {0x1016, 1, 0x000205DC}});
  s.tx(0x000, {0x82, 0x00}).rx(0x702, {0x05});
  s.rx(0x703, {0x00}).tx_remote(0x703).rx(0x703, {0x7F});
  s.advance(100ms).tx_remote(0x703).rx(0x703, {0x7F});  // toggle bit wrong
  s.expect(403, 0x0005);
  s.advance(1400ms).expect_bit(402, 7, true).ignore_tx();
  s.y(0x10, true).wait_x(0x10, false);
  s.expect(402, either(0x0002, 0)).expect(403, 0x0001);
  s.ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_nmt_master_error_control_test
