// The branches of the NMT start-up that section 9 of spec/me3can1-q/scenarios.md leaves out: who is a master
// at all (1F80H bit 0), the configuration step (S77, S78, S80; 1F22H, 1F26H, 1F27H), keep alive, slaves that
// are not to be booted, SDO connections that the start-up occupies, heartbeat instead of guarding.

#include "scenarios/me3can1_q/master_branches.hpp"

namespace canopus::scenario::me3can1_q_master_branches_test {
namespace {

using namespace nmt_master_slave;

CANOPUS_OF_BOTH_MODULES(KeepAlive);
CANOPUS_OF_BOTH_MODULES(MasterRole);
CANOPUS_OF_BOTH_MODULES(VerifyConfiguration);

// --- 1F80H bit 0

TEST_P(MasterRole, Bit0Clear_AllOtherSettingsAreIgnored_AndItIsTheDefault) {
  spec("ME3-MST-001", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.expect_object(0x1F80, 0, 0, 4);
  start_with(s, {{0x1F80, 0, 0x0000007E}, {0x1F81, 2, 0x0064030D}, {0x1F89, 0, 1000}});
  s.ignore_tx();
  s.rx(0x702, {0x00}).advance(60s).no_tx();
  s.expect(25, 0x0140 & ~0x40).expect(402, 0).expect_x(0x10, false);
  s.rx(0x000, {0x01, 0x00}).expect(25, 0x0201);  // a slave like any other
  if (is_rj71cn91()) return;  // which sends for a slave, too: rj71cn91/node_control_test.cpp
  s.cif({0x0002, 0, 0x1F82, 2, 1, 5});
  s.expect_abort(0x08000022).no_tx();
}

TEST_P(MasterRole, Bit0_TakesEffectAfterStoreAndRestart_OrResetNode) {
  for (const bool by_restart : {true, false}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.set_object(0x1F80, 0, 0x00000001, 4);
    s.advance(10s).no_tx().expect_bit(25, 15, false);   // not yet
    s.nmt(0x81, 1).wait_bit(25, 7, false).ignore_tx();  // not stored: a slave again
    s.advance(10s).no_tx().expect_bit(25, 15, false);
    s.expect_object(0x1F80, 0, 0, 4);
    s.set_object(0x1F80, 0, 0x00000001, 4);
    s.store_objects();
    s.ignore_tx();
    if (by_restart) {
      s.y(0x02, true).wait_tx(0x081, {0x00, 0x62, 0x01, 0x4D, 0x45, 0x30, 0x30, 0x34}).y(0x02, false);
    } else {
      s.nmt(0x81, 1);
    }
    s.wait_tx(0x701, {0x00}).tx(0x000, {0x82, 0x00}).expect_bit(25, 15, true);
    s.rx(0x000, {0x02, 0x00}).expect_bit(25, 15, true).expect_bit(25, 8, true);  // "all nodes" ignored
    s.ignore_tx();
  }
}

// --- configuration: S77, S78

class Me3Configuration : public ::testing::Test {
 public:
  Me3Configuration() {
    s.power_on_as(1);
    store_concise_dcf(s);
  }
  void slave_2_comes(Where where = Where::current()) {
    s.tx(0x701, {0x00}, where).tx(0x000, {0x82, 0x00}, where);
    s.rx(0x702, {0x00}).tx(0x602, ask_1000, where).rx(0x582, is_0191);
  }
  void is_configured(Where where = Where::current()) {
    s.tx(0x602, write_1017, where).rx(0x582, written_1017);
    s.tx(0x602, write_1800, where).rx(0x582, written_1800);
  }
  IntelligentScenario s;
  const std::uint32_t date =
      static_cast<std::uint32_t>((std::chrono::sys_days{std::chrono::year{2014} / 10 / 15} -
                                  std::chrono::sys_days{std::chrono::year{1984} / 1 / 1})
                                     .count());
  const std::uint32_t time = 45'000'000;  // 12:30:00, in ms after midnight
};

TEST_F(Me3Configuration, S78_DateAndTimeAsExpected_NoDownload) {
  RecordProperty("spec", "ME3-CFG-011");
  EXPECT_EQ(date, 11245U);
  start_with(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}, {0x1F26, 2, date}, {0x1F27, 2, time}});
  s.tx(0x081, {0x00, 0x62, 0x01, 0x4D, 0x45, 0x30, 0x30, 0x34});
  slave_2_comes();
  s.tx(0x602, ask_date).rx(0x582, answer(1, 11245)).tx(0x602, ask_time).rx(0x582, answer(2, 45'000'000));
  s.tx(0x000, {0x01, 0x02}).no_tx().expect(25, 0x8201).expect(402, 0);
}

TEST_F(Me3Configuration, S78_AnyDifference_DownloadsEveryEntry_BeforeTheStart) {
  RecordProperty("spec", "ME3-CFG-009 ME3-SLV-009");
  struct Row {
    std::uint32_t expected_date, expected_time, date, time;
  };
  for (const Row& row :
       {Row{date, time, date + 1, time}, Row{date, time, date, time + 1}, Row{date, time, 0, 0}}) {
    Me3Configuration_S78_AnyDifference_DownloadsEveryEntry_BeforeTheStart_Test other;
    IntelligentScenario& t = other.s;
    start_with(t, {{0x1F80, 0, 1},
                   {0x1F81, 2, mandatory},
                   {0x1F26, 2, row.expected_date},
                   {0x1F27, 2, row.expected_time}});
    t.tx(0x081, {0x00, 0x62, 0x01, 0x4D, 0x45, 0x30, 0x30, 0x34});
    other.slave_2_comes();
    t.tx(0x602, ask_date).rx(0x582, answer(1, row.date));
    if (row.date == row.expected_date) t.tx(0x602, ask_time).rx(0x582, answer(2, row.time));
    other.is_configured();
    t.tx(0x000, {0x01, 0x02}).no_tx().expect(25, 0x8201);
  }
  // Nothing expected: downloaded without a question.
  start_with(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}});
  s.tx(0x081, {0x00, 0x62, 0x01, 0x4D, 0x45, 0x30, 0x30, 0x34});
  slave_2_comes();
  is_configured();
  s.tx(0x000, {0x01, 0x02}).no_tx().expect(25, 0x8201);
}

TEST_F(Me3Configuration, SlaveWithoutVerifyConfiguration_IsConfigured) {
  start_with(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}, {0x1F26, 2, date}, {0x1F27, 2, time}});
  s.ignore_tx().rx(0x702, {0x00}).tx(0x602, ask_1000).rx(0x582, is_0191);
  s.tx(0x602, ask_date).rx(0x582, {0x80, 0x20, 0x10, 0x01, 0x00, 0x00, 0x02, 0x06});
  is_configured();
  s.tx(0x000, {0x01, 0x02}).no_tx();
}

TEST_F(Me3Configuration, Abort_StopsTheConfigurationAndTheStartUp_ButNotThatOfAReadOnlyObject) {
  RecordProperty("spec", "ME3-CFG-015");
  start_with(s, {{0x1F80, 0, 1}, {0x1F81, 2, mandatory}});
  s.ignore_tx().rx(0x702, {0x00}).tx(0x602, ask_1000).rx(0x582, is_0191);
  s.tx(0x602, write_1017).rx(0x582, {0x80, 0x17, 0x10, 0x00, 0x02, 0x00, 0x01, 0x06});  // read only
  s.tx(0x602, write_1800).rx(0x582, written_1800).tx(0x000, {0x01, 0x02}).no_tx().expect(402, 0);
  s.restart();
  s.ignore_tx().rx(0x702, {0x00}).tx(0x602, ask_1000).rx(0x582, is_0191);
  s.tx(0x602, write_1017).rx(0x582, {0x80, 0x17, 0x10, 0x00, 0x30, 0x00, 0x09, 0x06});  // another
  s.no_tx().expect(402, 0x0010).expect_x(0x10, true).expect(25, 0x8140 & ~0x40);
  s.advance(60s).no_tx();
  // A slave that falls silent in the middle of it.
  s.restart();
  s.ignore_tx().rx(0x702, {0x00}).tx(0x602, ask_1000).rx(0x582, is_0191).tx(0x602, write_1017);
  s.advance(499ms).no_tx().expect(402, 0);
  s.advance(1ms).tx(0x602, {0x80, 0x17, 0x10, 0x00, 0x00, 0x00, 0x04, 0x05}).expect(402, 0x0010);
  s.advance(60s).no_tx();
}

TEST_F(Me3Configuration, BootSlaveBit_ConfigurationAndStart_AfterBootUpAndErrorControlEvents) {
  RecordProperty("spec", "ME3-SLV-003");
  start_with(s, {{0x1F80, 0, 1}, {0x1F81, 2, optional}, {0x1016, 1, 0x000205DC}});
  s.ignore_tx();
  const auto boots = [&] {
    s.rx(0x702, {0x00}).tx(0x602, ask_1000).rx(0x582, is_0191);
    is_configured();
    s.rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02}).no_tx();
  };
  boots();
  boots();  // a boot-up message in between
  s.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x82, 0x02}).no_tx();
  s.rx(0x702, {0x00}).tx(0x081, {0, 0, 0, 0, 0, 0, 0, 0}).tx(0x602, ask_1000).rx(0x582, is_0191);
  is_configured();
  s.rx(0x702, {0x7F}).tx(0x000, {0x01, 0x02}).no_tx();
}

TEST_F(Me3Configuration, WithoutTheBootSlaveBit_NeitherAskedNorConfiguredNorStarted) {
  start_with(s, {{0x1F80, 0, 1}, {0x1F81, 2, only_watched}, {0x1016, 1, 0x000205DC}});
  s.ignore_tx();
  s.rx(0x702, {0x00}).rx(0x702, {0x7F}).advance(1s).no_tx().expect_bit(25, 14, false);
  s.rx(0x702, {0x00}).rx(0x702, {0x7F}).no_tx();
  s.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x82, 0x02}).no_tx();
  s.rx(0x702, {0x00}).tx(0x081, {0, 0, 0, 0, 0, 0, 0, 0}).rx(0x702, {0x7F}).advance(1s).no_tx();
}

TEST_P(VerifyConfiguration, S80_ChangeOf1017h_BothRead0) {
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  set(s, {{0x1020, 1, 5}, {0x1020, 2, 6}});
  s.expect_object(0x1020, 1, 5, 4).expect_object(0x1020, 2, 6, 4);
  s.set_object(0x1017, 0, 1000, 2);
  s.ignore_tx();
  s.expect_object(0x1020, 1, 0, 4).expect_object(0x1020, 2, 0, 4);
  s.ignore_tx();
}

// --- keep alive

TEST_P(KeepAlive, Bit4_OperationalSlaveIsNotReset_OthersAre) {
  spec("ME3-SLV-005", "RJ71-STARTUP-005");
  const auto start = [](IntelligentScenario& s, std::uint32_t assignment) {
    s.power_on_as(1);
    start_with(s, {{0x1F80, 0, 1}, {0x1F81, 2, assignment}});
    s.tx(0x081, {0x00, 0x62, 0x01, 0x4D, 0x45, 0x30, 0x30, 0x34}).tx(0x701, {0x00});
  };
  const auto is_not_reset = [](IntelligentScenario& s) {
    for (std::uint8_t node = 3; node <= 127 && !is_rj71cn91(); ++node) s.tx(0x000, {0x82, node});
    s.tx(0x602, ask_1000).no_tx().rx(0x582, is_0191).tx_remote(0x702);
  };
  {  // Operational: neither reset nor started
    IntelligentScenario s(GetParam());
    start(s, kept_alive);
    is_not_reset(s);
    s.rx(0x702, {0x05}).no_tx().expect(25, 0x8201).expect(602, 5);
  }
  {  // Pre-operational: reset now
    IntelligentScenario s(GetParam());
    start(s, kept_alive);
    is_not_reset(s);
    s.rx(0x702, {0x7F}).tx(0x000, {0x82, 0x02}).no_tx().expect_bit(25, 0, false);
    s.rx(0x702, {0x00});
    if (is_rj71cn91()) s.no_tx().advance(500ms);  // G70
    s.tx(0x000, {0x01, 0x02}).no_tx().expect(25, 0x8201);
  }
  {  // bit 4 clear: reset with all the others
    IntelligentScenario s(GetParam());
    start(s, mandatory);
    s.tx(0x000, {0x82, 0x00}).no_tx();
  }
}

TEST_P(KeepAlive, SlaveThatGuardsItsMaster_MissesTheRemoteFrames_WhenTheMasterHasNoGuarding) {
  spec("ME3-SLV-012", "");
  IntelligentScenario master(GetParam());  // one remote frame to learn the slave's state, and no more
  master.power_on_as(1);
  start_with(master, {{0x1F80, 0, 1}, {0x1F81, 2, kept_alive}});
  master.ignore_tx().rx(0x582, is_0191).tx_remote(0x702).rx(0x702, {0x05});
  master.advance(60s).no_tx().expect(402, 0).expect_x(0x10, false);

  IntelligentScenario slave(GetParam());  // 100 ms, 3 times
  slave.power_on_as(2);
  slave.set_object(0x100C, 0, 100, 2);
  slave.set_object(0x100D, 0, 3, 1);
  slave.nmt(0x01, 2).rx_remote(0x702, 1).tx(0x702, {0x05});
  slave.advance(299ms).no_tx().expect(25, 0x0201);
  slave.advance(1ms).tx(0x082, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).expect(25, 0x0100);
  slave.expect(402, either(0x0040, 0x0044));

  IntelligentScenario configured(GetParam());  // on both sides: remote frames go on
  configured.power_on_as(1);
  start_with(configured, {{0x1F80, 0, 1}, {0x1F81, 2, 0x00640300 | kept_alive}});
  configured.ignore_tx().rx(0x582, is_0191).tx_remote(0x702).rx(0x702, {0x05});
  configured.tx_remote(0x702).rx(0x702, {0x85}).advance(100ms).tx_remote(0x702).ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_master_branches_test
