// spec/me3can1-q/scenarios.md, section 9: network management.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_network_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Network);

// Node 1 with these settings stored, just restarted: boot-up frame and the master's frames not looked at yet.
void start_as_master(
    IntelligentScenario& s, std::uint32_t start_up,
    const std::vector<std::pair<std::pair<std::uint16_t, std::uint8_t>, std::uint32_t>>& objects = {}) {
  s.power_on_as(1);
  for (const auto& [place, value] : objects) s.set_object(place.first, place.second, value, 4);
  s.set_object(0x1F80, 0, start_up, 4);
  s.store_objects();
  s.y(0x02, true);
  s.ignore_tx();
  s.wait_x(0x02, true);
  s.y(0x02, false);
}

TEST(Me3Network, S56_StateMachine_AsSlave) {
  RecordProperty("spec", "ME3-NMT-003 ME3-NMT-005 ME3-NMT-007 ME3-STAT-004 ME3-STAT-005 ME3-NST-002");
  IntelligentScenario s;
  s.power_on_as(1);
  s.nmt(0x01, 1);
  s.expect(25, 0x0201).expect(601, 5);
  s.nmt(0x80, 0);
  s.expect(25, 0x0100).expect(601, 0x7F);
  s.nmt(0x02, 1);
  s.expect(25, 0x0000).expect(601, 4).expect(727, 0);
  s.rx(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.no_tx();
  s.nmt(0x01, 0);
  s.expect(25, 0x0201);
  s.nmt(0x02, 2);  // somebody else
  s.expect(25, 0x0201);
  s.set_object(0x1015, 0, 77, 2);
  s.nmt(0x82, 1);
  s.expect_bit(25, 7, true).expect_bit(25, 6, false);
  s.write(70, 1);
  s.expect_bit(29, 5, true).expect(40, 70);
  s.wait_bit(25, 7, false);
  s.tx(0x701, {0x00}).no_tx();
  s.expect(25, 0x0140);
  s.expect_object(0x1015, 0, 0, 2);
  s.write(25, 0xFFBF);
  s.expect(25, 0x0100);
  s.nmt(0x82, 0);
  s.wait_bit(25, 7, false);
  s.expect_bit(25, 6, true);
  s.nmt(0x82, 0);
  s.expect_bit(25, 6, false);  // goes at the beginning of the next reset
  s.wait_bit(25, 7, false);
  s.expect_bit(25, 6, true);
  s.ignore_tx();
}

TEST(Me3Network, ResetNode_BringsStoredValuesBack) {
  RecordProperty("spec", "ME3-NMT-006");
  IntelligentScenario s;
  s.power_on_as(1);
  s.set_object(0x1015, 0, 33, 2);
  s.store_objects();
  s.set_object(0x1015, 0, 77, 2);
  s.set_object(0xA580, 1, 0x1234, 2);
  s.nmt(0x81, 1);
  s.expect_bit(25, 7, true);
  s.wait_bit(25, 7, false);
  s.tx(0x701, {0x00}).no_tx();
  s.expect_bit(25, 6, true);
  s.expect_object(0x1015, 0, 33, 2);
  s.expect_object(0xA580, 1, 0, 2);
}

TEST_P(Network, S57_SimpleMasterStart_WaitsG70BetweenResetAndStart) {
  spec("ME3-MST-009 ME3-MST-002 ME3-DLY-001 ME3-STAT-011", "RJ71-BM-022");
  for (const std::uint16_t delay : Words{500, 2000}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.expect_bit(25, 15, false);
    s.write(70, delay);
    s.save();
    s.set_object(0x1F80, 0, 0x00000003, 4);
    s.store_objects();
    s.y(0x02, true);
    s.ignore_tx();
    s.wait_x(0x02, true);
    s.y(0x02, false);
    s.tx(0x701, {0x00});
    s.tx(0x000, {0x82, 0x00});
    s.no_tx();
    const can::Time reset = s.now();
    s.wait_tx(0x000, {0x01, 0x00});
    EXPECT_GE(s.now() - reset, std::chrono::milliseconds(delay));
    EXPECT_LT(s.now() - reset, std::chrono::milliseconds(delay + 100));
    s.expect(25, 0x8201).expect(601, 5).no_tx();
  }
}

TEST_P(Network, S58_MasterStart_BringsItsSlaveToOperational) {
  spec("ME3-MST-008 ME3-MST-010 ME3-SLV-007 ME3-SLV-008 ME3-SLV-013 ME3-STAT-010",
       "RJ71-STARTUP-010 RJ71-STARTUP-013");
  IntelligentScenario s(GetParam());
  start_as_master(s, 1, {{{0x1F81, 2}, 0x0D}, {{0x1F84, 2}, 0x000F0191}, {{0x1F89, 0}, 10000}});
  s.tx(0x701, {0x00});
  s.tx(0x000, {0x82, 0x00});
  s.expect_bit(25, 14, true).expect_bit(25, 15, true);
  s.wait_tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.advance(500ms);
  s.ignore_tx();  // the abort of the request that was not answered
  const can::Time silent = s.now();
  s.wait_tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_NEAR(can::seconds(s.now()) - can::seconds(silent), 1.0, 0.6);
  s.expect_bit(25, 0, false).expect(602, 1);  // missing
  s.rx(0x582, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00});
  s.wait_bit(25, 14, false);
  s.tx(0x000, {0x01, 0x02}).no_tx();
  s.expect(25, 0x8201).expect(602, 5).expect(601, 5).expect(402, 0).expect_x(0x10, false);
}

TEST(Me3Network, S59_MandatorySlaveMissing_StopsTheStartUp) {
  RecordProperty("spec", "ME3-MST-012 ME3-NEC-007 ME3-SLV-015");
  IntelligentScenario s;
  start_as_master(s, 1, {{{0x1F81, 2}, 0x0D}, {{0x1F84, 2}, 0x000F0191}, {{0x1F89, 0}, 10000}});
  s.advance(9s);
  s.expect_bit(25, 14, true).expect_bit(402, 4, false).expect_x(0x10, false);
  s.advance(3s);
  s.expect_bit(25, 14, false).expect(25, 0x8100).expect_bit(402, 4, true).expect_x(0x10, true);
  s.ignore_tx();
  s.rx(0x702, {0x00});  // too late
  s.advance(30s);
  s.no_tx().expect(25, 0x8100);
}

TEST_P(Network, S60_WrongIdentity_EndsTheStartUpOfTheSlave) {
  spec("ME3-ID-001 ME3-ID-002", "");
  const std::vector<std::array<std::uint32_t, 3>> identity{{0x1000, 0, 0x1F84},
                                                           {0x1018, 1, 0x1F85},
                                                           {0x1018, 2, 0x1F86},
                                                           {0x1018, 3, 0x1F87},
                                                           {0x1018, 4, 0x1F88}};
  for (std::size_t wrong = 0; wrong < identity.size(); ++wrong) {
    IntelligentScenario s(GetParam());
    std::vector<std::pair<std::pair<std::uint16_t, std::uint8_t>, std::uint32_t>> settings{
        {{0x1F81, 2}, 0x0D}};
    for (std::size_t i = 0; i < identity.size(); ++i) {
      settings.push_back(
          {{static_cast<std::uint16_t>(identity[i][2]), 2}, static_cast<std::uint32_t>(0x1000 + i)});
    }
    start_as_master(s, 1, settings);
    s.tx(0x701, {0x00});
    s.tx(0x000, {0x82, 0x00});
    for (std::size_t i = 0; i <= wrong; ++i) {
      const auto low = static_cast<std::uint8_t>(identity[i][0] & 0xFF);
      const auto high = static_cast<std::uint8_t>(identity[i][0] >> 8);
      const auto sub = static_cast<std::uint8_t>(identity[i][1]);
      const auto value = static_cast<std::uint8_t>(i == wrong ? i - 1 : i);  // a revision that is too old
      s.wait_tx(0x602, {0x40, low, high, sub, 0, 0, 0, 0});
      s.rx(0x582, {0x43, low, high, sub, value, 0x10, 0, 0});
    }
    s.advance(20s);
    s.expect_bit(402, 4, true).expect_x(0x10, true).expect_bit(25, 0, false).expect_bit(25, 14, false);
    s.no_tx();
  }
}

TEST_P(Network, S64_ActiveMaster_IgnoresBroadcasts) {
  spec("ME3-NMT-009", "RJ71-NODECTL-012");
  IntelligentScenario s(GetParam());
  start_as_master(s, 1);
  s.advance(5s);
  s.ignore_tx();
  s.expect(25, 0x8201);
  for (const std::uint8_t command : Bytes{0x02, 0x80, 0x81, 0x82}) {
    s.nmt(command, 0);
    s.expect(25, 0x8201).no_tx();
  }
}

TEST_P(Network, S68_ErrorBehavior_OnCpuStop) {
  spec("ME3-EB-001 ME3-EB-002 ME3-EB-003 ME3-EB-006", "RJ71-ERRB-001 RJ71-ERRB-003 RJ71-ERRB-004");
  for (const std::uint8_t behaviour : Bytes{0, 1, 2}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.expect_object(0x1029, 1, 0, 1);
    s.set_object(0x1029, 1, behaviour, 1);
    s.nmt(0x01, 1);
    s.expect(25, 0x0201);
    s.cpu(module::CpuState::stop);
    s.expect(25, behaviour == 2 ? 0x0000 : 0x0100);
    s.nmt(0x01, 1);
    s.expect(25, behaviour == 1 ? 0x0201 : behaviour == 2 ? 0x0000 : 0x0100);
    s.cpu(module::CpuState::run);
    s.nmt(0x01, 1);
    s.expect(25, 0x0201);
    // A communication error: bus-off.
    s.error_counters(256, 0);
    s.expect_bit(25, 0, behaviour == 1).expect_bit(25, 8, behaviour == 0);
    s.ignore_tx();
    // In Stopped nothing changes.
    s.restart();
    s.set_object(0x1029, 1, behaviour, 1);
    s.nmt(0x02, 1);
    s.error_counters(256, 0);
    s.expect(25, 0x0000);
    s.cpu(module::CpuState::stop);
    s.expect(25, 0x0000);
    s.cpu(module::CpuState::run);
    s.ignore_tx();
    // In Pre-operational, 0 and 1 change nothing.
    s.restart();
    s.set_object(0x1029, 1, behaviour, 1);
    s.error_counters(256, 0);
    s.expect(25, behaviour == 2 ? 0x0000 : 0x0100);
    s.ignore_tx();
  }
}

TEST_P(Network, ErrorBehavior_OtherValues_AreRefused) {
  spec("ME3-EB-004", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  for (std::uint16_t value = 3; value <= 0xFE; ++value) {
    s.cif({0x0002, 0, 0x1029, 1, 1, value});
    s.expect_abort(0x06090030);
  }
  s.expect_object(0x1029, 1, 0, 1);
}

TEST_P(Network, S67_GuardedAsSlave_AnswersWithToggle_AndReportsTheMissingMaster) {
  spec("ME3-NG-001 ME3-NG-002 ME3-NEC-009", "RJ71-NG-006");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x100C, 0, 100, 2);
  s.set_object(0x100D, 0, 3, 1);
  s.rx_remote(0x701, 1).tx(0x701, {0x7F});
  s.rx_remote(0x701, 1).tx(0x701, {0xFF});
  s.nmt(0x01, 1);
  s.rx_remote(0x701, 1).tx(0x701, {0x05}).no_tx();
  s.nmt(0x02, 1);
  s.rx_remote(0x701, 1).tx(0x701, {0x84}).no_tx();
  s.advance(299ms);
  s.expect(401, either(0, 0x0005)).expect_x(0x10, is_rj71cn91());
  s.advance(2ms);
  s.expect_bit(401, 6, true).expect_x(0x10, true);
  s.write(400, 1);
  s.y(0x10, true);
  s.expect_bit(401, 6, false).expect_x(0x10, false);
  s.ignore_tx();
}

TEST_P(Network, S65_HeartbeatProducer) {
  spec("ME3-HB-001", "RJ71-HB-001");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.advance(5s);
  s.no_tx();
  s.set_object(0x1017, 0, 100, 2);
  s.ignore_tx();
  const can::Time start = s.now();
  for (int i = 0; i < 5; ++i) s.wait_tx(0x701, {0x7F});
  EXPECT_NEAR(can::seconds(s.now()) - can::seconds(start), 0.5, 0.002);
  s.nmt(0x01, 1);
  s.wait_tx(0x701, {0x05});
  s.nmt(0x02, 1);
  s.wait_tx(0x701, {0x04});
  s.nmt(0x80, 1);
  s.set_object(0x1017, 0, 0, 2);
  s.ignore_tx();
  s.advance(5s);
  s.no_tx();
}

TEST_P(Network, S69_SyncProducer_OnlyAsActiveMaster) {
  spec("ME3-SYNC-001 ME3-SYNC-002 ME3-SYNC-003 ME3-SYNC-004", "RJ71-SYNC-001 RJ71-SYNC-002");
  {
    IntelligentScenario s(GetParam());  // a slave
    s.power_on_as(1);
    s.set_object(0x1006, 0, 10000, 4);
    s.set_object(0x1005, 0, 0x40000080, 4);
    s.advance(1s);
    s.no_tx();
  }
  IntelligentScenario s(GetParam());
  start_as_master(s, 1);
  s.advance(5s);
  s.ignore_tx();
  s.expect_object(0x1005, 0, 0x80, 4);
  const auto period = [&](std::uint32_t microseconds) {
    s.set_object(0x1006, 0, microseconds, 4);
    s.ignore_tx();
    s.wait_tx(0x080);
    const can::Time first = s.now();
    for (int i = 0; i < 10; ++i) s.wait_tx(0x080);
    return std::chrono::duration_cast<std::chrono::microseconds>(s.now() - first).count() / 10;
  };
  s.set_object(0x1006, 0, 10000, 4);
  s.set_object(0x1005, 0, 0x40000080, 4);
  EXPECT_EQ(period(10000), 10000);
  EXPECT_EQ(period(2999), 2000);
  EXPECT_EQ(period(999), 1000);
  EXPECT_EQ(period(1), 1000);
  EXPECT_EQ(period(1000), 1000);
  EXPECT_EQ(period(1'000'999), 1'000'000);
  s.set_object(0x1006, 0, 0, 4);
  s.ignore_tx();
  s.advance(1s);
  s.no_tx();
  s.set_object(0x1006, 0, 10000, 4);
  s.ignore_tx();
  s.advance(10ms);
  s.tx(0x080);
  s.set_object(0x1005, 0, 0x00000080, 4);  // does not generate
  s.ignore_tx().advance(1s).no_tx();
  s.set_object(0x1005, 0, 0x000000A0, 4);
  s.set_object(0x1005, 0, 0x400000A0, 4);
  s.ignore_tx().wait_tx(0x0A0).ignore_tx();
  s.cif({0x0004, 0, 0x1019, 0});
  s.expect_abort(0x06020000);
  s.ignore_tx();
  s.store_objects();
  s.restart();
  s.expect_object(0x1005, 0, 0x400000A0, 4);
  s.advance(5s).ignore_tx().wait_tx(0x0A0).advance(10ms).tx(0x0A0).no_tx();
  s.cif({0x0002, 0, 0x1F82, 0x80, 1, 4});  // Stopped
  s.ignore_tx();
  s.advance(1s);
  s.no_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_network_test
