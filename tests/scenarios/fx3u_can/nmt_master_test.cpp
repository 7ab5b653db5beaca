// NMT: the module as slave, as master, as flying master; LSS; configuration manager [FX3U-CAN 5.8].

#include "scenarios/fx3u_can/master_steps.hpp"

namespace canopus::scenario::fx3u_can_nmt_master_test {
namespace {

// S070
TEST(FxNmt, ASlave_FollowsItsCommands) {
  RecordProperty("spec", "FX3U-NMT-002 FX3U-NMT-007 FX3U-COM-003 FX3U-NMT-006");
  BlockScenario s;
  s.power_on()
      .advance(1h)
      .no_tx()
      .expect(25, 0x0100)
      .nmt(1, 127)
      .expect(25, 0x0201)
      .nmt(0x80, 127)
      .expect(25, 0x0100);
  s.nmt(2, 127)
      .expect(25, 0)
      .rx(0x67F, {0x40, 0, 0x10, 0, 0, 0, 0, 0})
      .no_tx()
      .expect(29, 0)
      .nmt(1, 0)
      .expect(25, 0x0201);
  s.nmt(2, 126)
      .expect(25, 0x0201)
      .nmt(0x82, 127)
      .wait_tx(0x77F, {0x00})
      .nmt(0x81, 0)
      .wait_tx(0x77F, {0x00})
      .no_tx();
}

// S080
TEST(FxNmt, TheMasterRole_CountsFromTheNextStartOn) {
  RecordProperty("spec", "FX3U-BOOT-001 FX3U-COM-008 FX3U-COM-013 FX3U-NMT-003");
  BlockScenario s;
  s.power_on()
      .set_object(0x1F80, 0, 1, 4)
      .store_objects()
      .advance(1s)
      .expect_bit(25, 15, false)
      .restart()
      .expect_bit(25, 15, true);
  s.advance(2s).ignore_tx().expect_bit(25, 0, true).nmt(2, 0).expect_bit(25, 0, true).ignore_tx();
}

// S081
TEST(FxNmt, SimpleStartUp_WaitsForTheDelay) {
  RecordProperty("spec", "FX3U-BOOT-003 FX3U-BOOT-006 FX3U-BOOT-007 FX3U-BOOT-004");
  for (const std::uint16_t delay : Words{500, 2000}) {
    BlockScenario s;
    s.power_on().write(70, delay);
    s.set_object(0x1F80, 0, 3, 4)
        .store_objects()
        .save()
        .ignore_tx()
        .write(25, 1)
        .ignore_tx()
        .wait_bit(25, 7, false)
        .tx(0x77F, {0x00});
    s.tx(0x000, {0x82, 0})
        .advance(std::chrono::milliseconds(delay - 1))
        .no_tx()
        .advance(1ms)
        .tx(0x000, {0x01, 0})
        .no_tx()
        .expect_bit(25, 0, true);
  }
}

// S082
TEST(FxNmt, EachSlave_IsIdentified_AndStarted) {
  RecordProperty("spec", "FX3U-BOOT-002 FX3U-BOOT-008 FX3U-COM-009 FX3U-IDENT-001");
  BlockScenario s;
  prepare_master(s, {{0x1F80, 0, 1, 4},
                     {0x1F81, 3, 0x0D, 4},
                     {0x1F84, 3, type_of_slave, 4},
                     {0x1F85, 3, 0x71, 4},
                     {0x1F89, 0, 10000, 4}});
  s.tx(0x000, {0x82, 0}).expect_bit(25, 14, true).rx(0x703, {0x00});
  identify_slave(s, 3, type_of_slave);
  s.tx(0x603, {0x40, 0x18, 0x10, 1, 0, 0, 0, 0}).rx(0x583, {0x43, 0x18, 0x10, 1, 0x71, 0, 0, 0});
  s.wait_tx(0x000, {0x01, 3})
      .advance(100ms)
      .expect_bit(25, 14, false)
      .expect_bit(25, 0, true)
      .expect_bit(25, 11, false)
      .ignore_tx();
}

TEST(FxNmt, AMissingMandatorySlave_EndsTheStartUp_AndAnOptionalOneIsSought) {
  RecordProperty("spec", "FX3U-BOOT-008 FX3U-BOOT-009 FX3U-COM-010 FX3U-COM-011 FX3U-NMT-015");
  BlockScenario s;
  prepare_master(s, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x0D, 4}, {0x1F89, 0, 5000, 4}});
  s.tx(0x000, {0x82, 0});
  unsigned asked = 0;
  for (int i = 0; i < 49; ++i) {
    s.advance(100ms);
    for (const can::Frame& frame : s.controller().sent)
      asked += frame.identifier == 0x603 && frame.data[0] == 0x40 ? 1 : 0;
    s.ignore_tx();
  }
  EXPECT_GE(asked, 3U);
  s.expect_bit(25, 11, false)
      .advance(300ms)
      .expect_bit(25, 11, true)
      .expect_bit(25, 14, false)
      .expect(603, 1)
      .ignore_tx()
      .advance(1min)
      .no_tx();
  BlockScenario optional;
  prepare_master(optional, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x05, 4}, {0x1F89, 0, 5000, 4}});
  optional.advance(10s).expect_bit(25, 11, false).expect_bit(25, 0, true).ignore_tx();
  for (int i = 0; i < 5; ++i) {
    const can::Time before = when_first_sent(optional, 0x603, {0x40, 0, 0x10, 0, 0, 0, 0, 0});
    optional.advance(1ms);
    EXPECT_LE(when_first_sent(optional, 0x603, {0x40, 0, 0x10, 0, 0, 0, 0, 0}) - before, 1600ms);
    optional.advance(1ms);
  }
}

TEST(FxNmt, AWrongIdentity_StopsTheStartUp) {
  RecordProperty("spec", "FX3U-IDENT-002 FX3U-COM-010 FX3U-COM-011");
  BlockScenario s;
  prepare_master(s, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x0D, 4}, {0x1F84, 3, type_of_slave, 4}});
  s.tx(0x000, {0x82, 0});
  identify_slave(s, 3, 0x12345);
  s.advance(5s).expect_bit(25, 11, true).no_tx();
  BlockScenario optional;
  prepare_master(optional, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x05, 4}, {0x1F84, 3, type_of_slave, 4}});
  optional.tx(0x000, {0x82, 0});
  identify_slave(optional, 3, 0x12345);
  optional.advance(1s).expect_bit(25, 13, true).expect_bit(25, 11, false).ignore_tx();
}

// S083
TEST(FxNmt, StartUpBits2And3) {
  RecordProperty("spec", "FX3U-BOOT-004 FX3U-BOOT-005 FX3U-CIF-011");
  BlockScenario s;
  prepare_master(s, {{0x1F80, 0, 5, 4}});
  s.advance(5s)
      .expect(25, 0x8100 | 1U << 14)
      .ignore_tx()
      .set_object(0x1F82, 127, 5, 1)
      .advance(1s)
      .expect_bit(25, 0, true)
      .ignore_tx();
  BlockScenario quiet;
  prepare_master(quiet, {{0x1F80, 0, 9, 4}, {0x1F81, 3, 0x05, 4}});
  quiet.tx(0x000, {0x82, 0}).rx(0x703, {0x00});
  identify_slave(quiet, 3, 1);
  quiet.advance(5s).expect_bit(25, 0, true).no_tx();
  // The program starts them all.
  quiet.cif({0x0002, 0, 0x1F82, 0x80, 1, 5})
      .expect(1000, {0x0003, 0, 0x1F82, 0x80})
      .tx(0x000, {0x01, 0})
      .expect(601, Words(127, 5));
}

// S085, S086
TEST(FxNmt, RequestsOfTheProgram) {
  RecordProperty("spec", "FX3U-NMT-009 FX3U-NMT-010 FX3U-NMT-011 FX3U-NMT-012 FX3U-NMT-014 FX3U-CIF-011");
  BlockScenario s;
  prepare_master(s, {{0x1F80, 0, 1, 4}});
  s.advance(2s).ignore_tx().expect_bit(25, 0, true);
  for (const auto& [value, command, state] :
       std::vector<std::tuple<std::uint32_t, std::uint8_t, std::uint16_t>>{
           {4, 0x02, 4}, {5, 0x01, 5}, {0x7F, 0x80, 0x7F}}) {
    s.set_object(0x1F82, 9, value, 1)
        .tx(0x000, {command, 9})
        .expect(609, state)
        .expect_object(0x1F82, 9, state, 1);
  }
  for (const auto& [value, command] :
       std::vector<std::pair<std::uint32_t, std::uint8_t>>{{6, 0x81}, {7, 0x82}})
    s.set_object(0x1F82, 9, value, 1).tx(0x000, {command, 9});
  for (const auto& [value, command, state] :
       std::vector<std::tuple<std::uint32_t, std::uint8_t, std::uint16_t>>{
           {0x84, 0x02, 4}, {0x85, 0x01, 5}, {0x8F, 0x80, 0x7F}}) {
    s.set_object(0x1F82, 0x80, value, 1)
        .tx(0x000, {command, 0})
        .expect(601, Words(126, state))
        .expect_bit(25, 0, true);
  }
  s.set_object(0x1F82, 0x80, 4, 1)
      .tx(0x000, {0x02, 0})
      .expect(25, 0x8000)
      .expect(727, 4)
      .advance(1h)
      .expect(25, 0x8000)
      .no_tx();
  s.cif({0x0002, 0, 0x1F82, 9, 1, 3}).expect(1000, 0x000F);
  BlockScenario slave;
  slave.power_on_operational().cif({0x0002, 0, 0x1F82, 9, 1, 5}).expect(1000, 0x000F).no_tx();
}

// S084
TEST(FxNmt, ALostSlave_IsDealtWithAsTheStartUpBitsSay) {
  RecordProperty("spec", "FX3U-BOOT-015 FX3U-BOOT-016 FX3U-BOOT-017 FX3U-BOOT-018");
  struct Row {
    std::uint32_t start_up, assignment;
    Bytes command;
  };
  for (const Row& row :
       {Row{0x01, 0x05, {0x82, 3}}, Row{0x41, 0x05, {0x82, 3}}, Row{0x01, 0x0D, {0x82, 3}},
        Row{0x11, 0x0D, {0x82, 0}}, Row{0x41, 0x0D, {0x02, 0}}, Row{0x51, 0x0D, {0x02, 0}}}) {
    BlockScenario s;
    prepare_master(
        s, {{0x1F80, 0, row.start_up, 4}, {0x1F81, 3, row.assignment, 4}, {0x1016, 1, 0x0003'0064, 4}});
    s.tx(0x000, {0x82, 0}).rx(0x703, {0x00});
    identify_slave(s, 3, 1);
    s.advance(10ms)
        .rx(0x703, {0x7F})
        .advance(50ms)
        .ignore_tx()
        .rx(0x703, {0x05})
        .advance(90ms)
        .ignore_tx()
        .advance(10ms);
    bool found = false;
    for (const can::Frame& frame : s.controller().sent)
      found = found || text(frame) == text(can::data_frame(0, row.command));
    EXPECT_TRUE(found) << std::hex << row.start_up << ' ' << row.assignment;
    s.ignore_tx();
    if (row.command[0] != 0x82 || row.command[1] != 3) continue;
    s.rx(0x703, {0x00}).tx(0x0FF, {0, 0, 0, 0, 0, 0, 0, 0});  // the error is over
    identify_slave(s, 3, 1);                                  // booted again
    s.ignore_tx();
  }
  BlockScenario off;
  prepare_master(off, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x01, 4}});
  off.advance(2s).ignore_tx().rx(0x703, {0x00}).advance(5s).no_tx();
}

// S087
TEST(FxNmt, FlyingMasters_ByPriorityAndNodeId) {
  RecordProperty("spec",
                 "FX3U-FM-001 FX3U-FM-002 FX3U-FM-003 FX3U-FM-005 FX3U-FM-006 FX3U-FM-007 FX3U-FM-008 "
                 "FX3U-FM-011 FX3U-RS-005");
  BlockScenario s;
  s.power_on_as(5).write(26, 0).set_object(0x1F80, 0, 0x21, 4).store_objects().save().restart();
  when_first_sent(s, 0x073, {});
  const can::Time requested = when_first_sent(s, 0x072, {});
  const can::Duration answered = when_first_sent(s, 0x071, {1, 5}) - requested;
  EXPECT_GE(answered, 1550ms);  // 1 x 1500 + 5 x 10
  EXPECT_LE(answered, 1555ms);
  s.advance(10ms).expect_bit(25, 15, true).ignore_tx();
  s.advance(3s);
  unsigned beats = 0;
  for (const can::Frame& frame : s.controller().sent) beats += frame.identifier == 0x705 ? 1 : 0;
  EXPECT_EQ(beats, 3U);
  s.ignore_tx().cpu(module::CpuState::stop).ignore_tx().expect_bit(25, 15, false).advance(10s);
  for (const can::Frame& frame : s.controller().sent) EXPECT_NE(frame.identifier, 0x705U);
  s.ignore_tx().cpu(module::CpuState::run).advance(10s).expect_bit(25, 15, true).ignore_tx();

  BlockScenario loser;
  loser.power_on_as(6).write(26, 0).set_object(0x1F80, 0, 0x21, 4).store_objects().save().restart();
  loser.wait_tx(0x073, {}, 1s)
      .rx(0x071, {1, 5})
      .advance(1s)
      .ignore_tx()
      .expect_bit(25, 15, false)
      .rx(0x705, {0x05});
  loser.advance(1559ms).expect_bit(25, 15, false).ignore_tx();
  loser.advance(20s).expect_bit(25, 15, true).ignore_tx();
}

TEST(FxNmt, TheTimesOfFlyingMasters) {
  RecordProperty("spec", "FX3U-FM-003 FX3U-FM-004 FX3U-NODE-005");
  BlockScenario s;
  s.power_on();
  for (const auto& [sub, value] : std::vector<std::pair<std::uint8_t, std::uint32_t>>{
           {1, 100}, {2, 500}, {3, 1}, {4, 1500}, {5, 10}, {6, 4000 + 1270}})
    s.expect_object(0x1F90, sub, value, 2);
}

// S088
TEST(FxNmt, AMissingSlave_IsSoughtByLss) {
  RecordProperty("spec", "FX3U-LSS-001 FX3U-LSS-002 FX3U-LSS-004 FX3U-COM-012 FX3U-LSS-005");
  for (const bool complete : {true, false}) {
    BlockScenario s;
    prepare_master(s, {{0x1F80, 0, 1, 4},
                       {0x1F81, 10, 0x0D, 4},
                       {0x1F89, 0, 2000, 4},
                       {0x1F84, 10, 1, 4},
                       {0x1F85, 10, 2, 4},
                       {0x1F86, 10, 3, 4},
                       {0x1F87, 10, 4, 4},
                       {0x1F88, 10, complete ? 5U : 0U, 4}});
    s.advance(2100ms).expect_bit(25, 10, complete).ignore_tx();
    if (!complete) s.expect_bit(25, 11, true).advance(10s).no_tx();
    unsigned flickering = 0;
    for (const module::Led& led : s.plug_in().leds(s.now()))
      flickering +=
          (led.name == "RUN" || led.name == "ERROR") && led.pattern == module::LedPattern::flickering ? 1 : 0;
    EXPECT_EQ(flickering, complete ? 2U : 0U);
    s.advance(10min).expect_bit(25, 10, false).ignore_tx();
  }
  BlockScenario slave;
  slave.power_on().rx(0x7E5, {0x04, 0x01, 0, 0, 0, 0, 0, 0}).rx(0x7E5, {0x5E, 0, 0, 0, 0, 0, 0, 0}).no_tx();
}

// S089
TEST(FxNmt, ConciseDcfs_ConfigureSlaves) {
  RecordProperty("spec",
                 "FX3U-CM-001 FX3U-CM-002 FX3U-CM-003 FX3U-CM-004 FX3U-CM-005 FX3U-CM-007 FX3U-BOOT-010 "
                 "FX3U-STO-003 FX3U-STO-005");
  BlockScenario s;
  s.power_on().write(26, 0);
  const Words file{1, 0, 0x1017, 0x0200, 0, 0xF400, 0x0001};  // 13 bytes: 1017:00 = 500
  const auto write_file = [&](std::uint16_t node) {
    Words command{0x0002, 0, 0x1F22, node, 13};
    command.insert(command.end(), file.begin(), file.end());
    s.cif(command);
  };
  s.cif({0x0002, 0, 0x1F25, 3, 4, 0x6F63, 0x666E}).expect(1000, 0x000F);
  write_file(3);
  s.expect(1000, 0x0003);
  write_file(3);
  s.expect_abort(0x0601'0002);
  s.set_object(0x1F80, 0, 1, 4)
      .set_object(0x1F81, 3, 0x05, 4)
      .store_objects()
      .save()
      .ignore_tx()
      .write(25, 1)
      .ignore_tx()
      .wait_bit(25, 7, false)
      .ignore_tx();
  s.rx(0x703, {0x00});
  identify_slave(s, 3, 1);
  s.wait_tx(0x603, {0x2B, 0x17, 0x10, 0, 0xF4, 0x01, 0, 0})
      .rx(0x583, {0x60, 0x17, 0x10, 0, 0, 0, 0, 0})
      .wait_tx(0x000, {0x01, 3})
      .advance(1s)
      .ignore_tx();
  s.cif({0x0002, 0, 0x1F25, 3, 4, 0x6F63, 0x666E})
      .expect(1000, 0x0003)
      .tx(0x603, {0x2B, 0x17, 0x10, 0, 0xF4, 0x01, 0, 0});
  s.rx(0x583, {0x60, 0x17, 0x10, 0, 0, 0, 0, 0}).advance(10ms).ignore_tx();
  s.cif({0x0002, 0, 0x1F25, 4, 4, 0x6F63, 0x666E}).expect_abort(0x0800'0024);
  s.cif({0x0002, 0, 0x1F25, 127, 4, 0x6F63, 0x666E}).expect(1000, 0x0003).no_tx();
  s.cif({0x0002, 0, 0x1F22, 3, 4, 0, 0}).expect(1000, 0x0003);
  write_file(4);
  s.expect_abort(0x0606'0000);
  s.advance(10s).ignore_tx();
  write_file(4);
  s.expect(1000, 0x0003)
      .cif({0x6010, 0, 0xFFFF})
      .expect(1000, 0x6011)
      .cif({0x0002, 0, 0x1F25, 4, 4, 0x6F63, 0x666E})
      .expect_abort(0x0800'0024);
}

TEST(FxNmt, AChangeOfAnObject_MakesTheConfigurationsDateInvalid) {
  RecordProperty("spec", "FX3U-CM-008");
  BlockScenario s;
  s.power_on()
      .set_object(0x1020, 1, 1234, 4)
      .set_object(0x1020, 2, 5678, 4)
      .expect_object(0x1020, 1, 1234, 4)
      .expect_object(0x1020, 2, 5678, 4);
  s.set_object(0x1017, 0, 0, 2).expect_object(0x1020, 1, 0, 4).expect_object(0x1020, 2, 0, 4);
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_nmt_master_test
