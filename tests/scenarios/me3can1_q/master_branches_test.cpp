// The branches of the NMT start-up that section 9 of spec/me3can1-q/scenarios.md leaves out: who is a master
// at all (1F80H bit 0), the configuration step (S77, S78, S80; 1F22H, 1F26H, 1F27H), keep alive, slaves that
// are not to be booted, SDO connections that the start-up occupies, heartbeat instead of guarding.

#include <chrono>

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {
namespace {

CANOPUS_OF_BOTH_MODULES(ErrorBehaviour);
CANOPUS_OF_BOTH_MODULES(ErrorControl);
CANOPUS_OF_BOTH_MODULES(KeepAlive);
CANOPUS_OF_BOTH_MODULES(MasterRole);
CANOPUS_OF_BOTH_MODULES(SdoChannelInMasterBranches);
CANOPUS_OF_BOTH_MODULES(VerifyConfiguration);

constexpr std::uint32_t only_watched = 0x01;  // 1F81H: assigned
constexpr std::uint32_t optional = 0x05;      // and boot slave
constexpr std::uint32_t mandatory = 0x0D;     // and mandatory
constexpr std::uint32_t kept_alive = 0x1D;    // and not to be reset while Operational

const Bytes ask_1000{0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0};
const Bytes is_0191{0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00};
const Bytes ask_date{0x40, 0x20, 0x10, 0x01, 0, 0, 0, 0};
const Bytes ask_time{0x40, 0x20, 0x10, 0x02, 0, 0, 0, 0};
const Bytes write_1017{0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0};
const Bytes written_1017{0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0};
const Bytes write_1800{0x23, 0x00, 0x18, 0x01, 0x81, 0x01, 0x00, 0x80};
const Bytes written_1800{0x60, 0x00, 0x18, 0x01, 0, 0, 0, 0};

Bytes answer(std::uint8_t sub, std::uint32_t value) {
  return {0x43,
          0x20,
          0x10,
          sub,
          static_cast<std::uint8_t>(value & 0xFF),
          static_cast<std::uint8_t>(value >> 8 & 0xFF),
          static_cast<std::uint8_t>(value >> 16 & 0xFF),
          static_cast<std::uint8_t>(value >> 24)};
}

struct Object {
  std::uint16_t index;
  std::uint8_t sub;
  std::uint32_t value;
};

void set(IntelligentScenario& s, std::initializer_list<Object> objects, Where where = Where::current()) {
  for (const Object& object : objects) s.set_object(object.index, object.sub, object.value, 4, where);
}

/// 1F22H/02: 1017H:00 = 1000, 1800H:01 = 80000181H.
void store_concise_dcf(IntelligentScenario& s, Where where = Where::current()) {
  s.cif({0x0002, 0, 0x1F22, 2, 24, 0x0002, 0x0000, 0x1017, 0x0200, 0x0000, 0xE800, 0x0003, 0x0118, 0x0004,
         0x0000, 0x0181, 0x8000},
        where);
}

/// Node 1 with these objects stored, after a restart: Reset communication was sent just now.
void start_with(IntelligentScenario& s, std::initializer_list<Object> objects,
                Where where = Where::current()) {
  set(s, objects, where);
  s.store_objects(where);
  s.y(0x02, true).wait_x(0x02, true, 60s, where).y(0x02, false);
}

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
    for (std::uint8_t node = 3; node <= 127; ++node) s.tx(0x000, {0x82, node});
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
    s.rx(0x702, {0x00}).tx(0x000, {0x01, 0x02}).no_tx().expect(25, 0x8201);
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
  slave.advance(1ms).tx(0x082, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).expect(25, 0x0100).expect(402, 0x0040);

  IntelligentScenario configured(GetParam());  // on both sides: remote frames go on
  configured.power_on_as(1);
  start_with(configured, {{0x1F80, 0, 1}, {0x1F81, 2, 0x00640300 | kept_alive}});
  configured.ignore_tx().rx(0x582, is_0191).tx_remote(0x702).rx(0x702, {0x05});
  configured.tx_remote(0x702).rx(0x702, {0x85}).advance(100ms).tx_remote(0x702).ignore_tx();
}

// --- SDO connections

TEST_P(SdoChannelInMasterBranches, FirstStart_OccupiesAllNodes_LaterOnlyTheOneThatFailed) {
  spec("ME3-CIF-025", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1F80, 0, 1, 4);
  for (std::uint8_t node = 2; node <= 127; ++node) s.set_object(0x1F81, node, optional, 4);
  s.set_object(0x1016, 1, 0x000205DC, 4);
  s.store_objects();
  s.y(0x02, true).wait_x(0x02, true, 60s).y(0x02, false);
  s.wait_tx(0x081, {0x00, 0x62, 0x01, 0x4D, 0x45, 0x30, 0x30, 0x34});
  s.wait_tx(0x701, {0x00}).tx(0x000, {0x82, 0x00});
  for (std::uint8_t node = 2; node <= 127; ++node) {  // all at one time
    s.rx(0x700U + node, {0x00}).tx(0x600U + node, ask_1000);
  }
  for (const std::uint16_t node : Words{2, 64, 127}) {
    s.cif({0x0004, node, 0x1018, 1});
    s.expect_abort(0x060A0023, node).expect_bit(25, 14, true).no_tx();
  }
  for (std::uint8_t node = 2; node <= 127; ++node) {
    s.rx(0x580U + node, is_0191);
    if (node == 2) s.rx(0x702, {0x7F});
    s.tx(0x000, {0x01, node});
  }
  s.expect_bit(25, 14, false).no_tx();
  const auto reads = [&](std::uint8_t node) {
    s.write(1000, {0x0004, node, 0x1018, 1});
    s.y(0x17, true).advance(1ms).tx(0x600U + node, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0});
    s.rx(0x580U + node, {0x43, 0x18, 0x10, 0x01, 0x71, 0, 0, 0});
    s.expect(1000, {0x0005, node, 0x1018, 1, 4, 0x0071}).y(0x17, false).no_tx();
  };
  reads(2);
  reads(64);
  s.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x82, 0x02});
  s.rx(0x702, {0x00}).ignore_tx();
  s.expect_bit(25, 14, true);
  s.cif({0x0004, 2, 0x1018, 1});
  s.expect_abort(0x060A0023, 2);
  reads(64);
  s.ignore_tx();
}

// --- error control

TEST_P(ErrorControl, NodesWord_IsThatOfItsNumber_HeartbeatAndGuarding) {
  spec("ME3-NEC-002 ME3-NEC-003 ME3-NEC-004 ME3-NEC-011", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1F80, 0, 1, 4);
  for (std::uint8_t node = 2; node <= 127; ++node) {
    if (node % 2 == 0) {
      s.set_object(0x1016, node, std::uint32_t{node} << 16 | 60'000U, 4);
    } else {
      s.set_object(0x1F81, node, 0xFFFF0301, 4);
    }
  }
  s.store_objects();
  s.restart();
  s.ignore_tx();
  const auto others_are_quiet = [&](unsigned node) {
    for (unsigned n = node + 1; n <= 127; ++n) s.expect(static_cast<std::uint16_t>(400 + n), 0);
  };
  for (std::uint8_t node = 2; node <= 127; ++node) {
    others_are_quiet(node - 1U);
    s.rx(0x700U + node, {0x00}).rx(0x700U + node, {0x7F});
    s.expect(static_cast<std::uint16_t>(400 + node), node % 2 == 0 ? 0x0002 : 0x0001);
  }
  s.expect(401, 0).expect_x(0x10, false);
  s.ignore_tx();
  // Not in the layer 2 modes.
  s.write(21, 11);
  s.save();
  s.restart();
  s.rx(0x702, {0x05});
  for (std::uint16_t address = 401; address <= 527; ++address) s.expect(address, 0);
}

TEST_P(ErrorControl, HeartbeatWinsOverGuarding_AtTheMasterAndAtTheSlave) {
  spec("ME3-NG-008", "RJ71-NG-007 RJ71-NG-008");
  IntelligentScenario s(GetParam());  // 1016H watches node 2: no remote frame, not even on request
  s.power_on_as(1);
  start_with(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x00640301}, {0x1016, 1, 0x000205DC}});
  s.ignore_tx();
  s.rx(0x702, {0x00}).rx(0x702, {0x7F}).advance(1s).no_tx();
  s.set_object(0x1F83, 2, 1, 1);
  s.no_tx().advance(400ms).no_tx();
  s.expect_object(0x1F83, 2, 0, 1).expect(402, 0x0002);
  s.wait_bit(402, 7, true).expect(402, 0x0082).ignore_tx();  // the heartbeat's bit, none of guarding

  IntelligentScenario slave(GetParam());  // 1017H: neither answered nor watched
  slave.power_on_as(2);
  slave.set_object(0x100C, 0, 100, 2);
  slave.set_object(0x100D, 0, 3, 1);
  slave.nmt(0x01, 2).rx_remote(0x702, 1).tx(0x702, {0x05});
  slave.set_object(0x1017, 0, 10'000, 2);
  slave.ignore_tx().rx_remote(0x702, 1).no_tx();
  slave.advance(5s).no_tx().expect(402, 0).expect(25, 0x0201);
}

TEST_P(ErrorControl, ConsumerTimeShorterThanTheProducers_IsTakenAndLosesEveryHeartbeat) {
  spec("ME3-HB-005", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1016, 1, 0x00020064, 4);  // 100 ms, and node 2 sends one every second
  s.expect_object(0x1016, 1, 0x00020064, 4).expect(29, 0);
  for (int again = 0; again < 3; ++again) {
    s.rx(0x702, {0x05}).ignore_tx().expect_bit(402, 1, true);
    s.y(0x10, true).advance(1ms).y(0x10, false).expect_bit(402, 7, false);
    s.advance(98ms).no_tx().expect_bit(402, 7, false);
    s.advance(1ms).tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).expect_bit(402, 7, true);
    s.advance(900ms).no_tx();
  }
  s.set_object(0x1016, 1, 0x000205DC, 4);  // longer: nothing is missed
  s.ignore_tx();
  for (int again = 0; again < 10; ++again) s.rx(0x702, {0x05}).ignore_tx().advance(1000ms).no_tx();
}

TEST_P(ErrorBehaviour, Causes_AsSlaveHeartbeatAndLifeGuarding_AsMasterNeitherHeartbeatNorGuardingOfSlaves) {
  spec("ME3-EB-005", "");
  {
    IntelligentScenario s(GetParam());  // slave: heartbeat of node 2 missing
    s.power_on_as(1);
    s.set_object(0x1016, 1, 0x000205DC, 4);
    s.nmt(0x01, 1).rx(0x702, {0x05}).expect(25, 0x0201);
    s.advance(1499ms).expect(25, 0x0201).advance(1ms).expect(25, 0x0100).ignore_tx();
  }
  {
    IntelligentScenario s(GetParam());  // slave: life guarding
    s.power_on_as(1);
    s.set_object(0x100C, 0, 100, 2);
    s.set_object(0x100D, 0, 3, 1);
    s.nmt(0x01, 1).rx_remote(0x701, 1).advance(299ms).expect(25, 0x0201).advance(1ms).expect(25, 0x0100);
    s.ignore_tx();
  }
  {
    IntelligentScenario s(GetParam());  // bus-off, in either role
    s.power_on_as(1);
    s.nmt(0x01, 1).expect(25, 0x0201).error_counters(256, 0).expect_bit(25, 0, false).ignore_tx();
    s.supply_off();
  }
  {
    IntelligentScenario s(GetParam());  // CPU in STOP
    s.power_on_as(1);
    s.nmt(0x01, 1).cpu(module::CpuState::stop).expect(25, 0x0100).ignore_tx();
  }
  {
    IntelligentScenario s(GetParam());  // master: both kinds of losses, and Operational all the same
    s.power_on_as(1);
    start_with(s, {{0x1F80, 0, 1}, {0x1016, 1, 0x000205DC}, {0x1F81, 3, 0x00640301}});
    s.ignore_tx().advance(1s).ignore_tx();
    s.rx(0x702, {0x05}).rx(0x703, {0x00}).rx(0x703, {0x7F}).ignore_tx().expect_bit(25, 0, true);
    s.wait_bit(403, 3, true).expect_bit(25, 0, true).wait_bit(402, 7, true).expect_bit(25, 0, true);
    s.error_counters(256, 0).expect_bit(25, 0, false);  // but bus-off it is
    s.ignore_tx();
  }
}

TEST(Me3Emergency, CodesTheModuleSendsByItself) {
  RecordProperty("spec", "ME3-EMCY-006");
  IntelligentScenario s;
  s.power_on_as(1);
  s.set_object(0x1016, 1, 0x007F03E8, 4);
  s.set_object(0x1400, 1, 0x00000201, 4);
  s.nmt(0x01, 1).ignore_tx();
  const auto code = [&](std::uint16_t expected, Where where = Where::current()) {
    bool found = false;
    while (!s.controller().sent.empty()) {
      const can::Frame frame = s.controller().sent.front();
      s.controller().sent.pop_front();
      if (frame.identifier != 0x081) continue;
      const auto sent = static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8);
      found = found || sent == expected;
      // 8.2.1, what is ticked.
      const bool allowed = sent == 0x0000 || sent == 0x6200 || sent == 0x8110 || sent == 0x8120 ||
                           sent == 0x8200 || sent == 0x8210 || sent == 0x8220 || sent == 0x8250 ||
                           (sent >= 0x8F01 && sent <= 0x8F7F) || sent == 0xFF00;
      EXPECT_TRUE(allowed) << std::hex << sent << " at line " << std::dec << where.line();
    }
    EXPECT_TRUE(found) << std::hex << expected << " at line " << std::dec << where.line();
  };
  s.rx(0x201, {1, 2, 3});
  code(0x8210);
  s.rx(0x201, {1, 2, 3, 4, 5, 6, 7, 8});
  code(0x0000);
  s.set_object(0x1400, 1, 0x80000201, 4);
  s.set_object(0x1600, 0, 0, 1);
  s.set_object(0x1600, 1, 0xA5800110, 4);
  s.set_object(0x1600, 0, 1, 1);
  s.set_object(0x1400, 1, 0x00000201, 4);
  s.ignore_tx();
  s.rx(0x201, {1, 2, 3, 4, 5, 6, 7, 8});
  code(0x8220);
  s.rx(0x080, {0x01});  // 1019H does not exist: a SYNC has no byte
  code(0x8200);
  s.error_counters(130, 0);
  code(0x8120);
  s.error_counters(0, 0);
  s.controller().overflows = 1;
  s.write(20, 0);
  code(0x8110);
  s.rx(0x77F, {0x05}).advance(1s);
  code(0x8F7F);
  s.nmt(0x01, 1).cpu(module::CpuState::stop);
  code(0xFF00);
  s.cpu(module::CpuState::run).y(0x02, true).advance(1ms);
  code(0x6200);
  s.y(0x02, false).advance(10s).ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario
