// What the start-up master, the flying master, the LSS master and the configuration manager do besides the main road
// [FX3U-CAN 5.6.8, 5.8.7 to 5.8.13, 14.2].

#include "canopus/canopen/dictionary/stored_values.hpp"
#include "canopus/module/storage/flash_memory.hpp"

#include "scenarios/fx3u_can/master_steps.hpp"

namespace canopus::scenario::fx3u_can_master_corners_test {
namespace {

/// Node 3 is there, and boots.
void slave_3_boots(BlockScenario& s, Where where = Where::current()) {
  s.tx(0x000, {0x82, 0}, where).rx(0x703, {0x00});
  identify_slave(s, 3, type_of_slave, where);
}

TEST(FxBoot, ErrorControlStarts_WithTheHeartbeat_OrAnAnswerWithin100Ms) {
  RecordProperty("spec", "FX3U-BOOT-011 FX3U-NG-008");
  for (const bool answers : {true, false}) {
    BlockScenario heartbeat;
    prepare_master(heartbeat, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x0064'030D, 4}, {0x1016, 1, 0x0003'05DC, 4}});
    slave_3_boots(heartbeat);
    heartbeat.advance(1499ms).no_tx().expect(901, 0).expect_bit(25, 14, true);
    answers ? heartbeat.rx(0x703, {0x7F}).tx(0x000, {0x01, 3}).expect(25, 0x8201).expect(901, 0x0002)
            : heartbeat.advance(1ms).expect(901, 0x0010).expect(25, 0x8900).expect(29, 0x0401);
    if (!answers) heartbeat.advance(1min).no_tx();
    heartbeat.ignore_tx();

    BlockScenario guarding;
    prepare_master(guarding, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x03E8'030D, 4}});
    slave_3_boots(guarding);
    guarding.tx_remote(0x703).advance(99ms).no_tx().expect_bit(901, 4, false);
    answers ? guarding.rx(0x703, {0x7F}).tx(0x000, {0x01, 3}).expect(25, 0x8201).expect(901, 0x0001)
            : guarding.advance(1ms).expect_bit(901, 4, true).expect(25, 0x8900).expect_bit(29, 10, true);
    guarding.ignore_tx();
  }
}

TEST(FxBoot, Bit4_KeepsAnOperationalSlaveFromBeingReset) {
  RecordProperty("spec", "FX3U-BOOT-012");
  for (const bool is_operational : {true, false}) {
    BlockScenario s;
    prepare_master(s, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x1D, 4}});
    for (std::uint8_t node = 1; node < 127; ++node)
      if (node != 3) s.tx(0x000, {0x82, node});
    identify_slave(s, 3, type_of_slave);
    s.tx_remote(0x703).rx(0x703, {static_cast<std::uint8_t>(is_operational ? 0x05 : 0x7F)});
    if (!is_operational) {
      s.tx(0x000, {0x82, 3}).no_tx().rx(0x703, {0x00}).tx(0x000, {0x01, 3});
    }
    s.no_tx().expect(25, 0x8201).expect(603, 5);
  }
  // A negotiation of flying masters resets them all the same.
  BlockScenario flying;
  flying.power_on().write(26, 0).set_object(0x1F80, 0, 0x21, 4).set_object(0x1F81, 3, 0x1D, 4);
  flying.store_objects().save().restart();
  when_first_sent(flying, 0x000, {0x82, 0});
}

TEST(FxBoot, TheOwnNumber_IsNoSlave) {
  RecordProperty("spec", "FX3U-BOOT-014 FX3U-CM-004");
  BlockScenario s;
  prepare_master(s, {{0x1F80, 0, 1, 4}, {0x1F81, 127, 0x00C8'030D, 4}, {0x1F89, 0, 1000, 4}});
  s.tx(0x000, {0x82, 0}).advance(5s).no_tx().expect(25, 0x8201).expect(29, 0).expect(963, 0);
  s.expect_object(0x1F81, 127, 0x00C8'030D, 4);
}

TEST(FxErrorControl, AHeartbeatGoesBeforeGuarding) {
  RecordProperty("spec", "FX3U-NG-006 FX3U-NG-004 FX3U-NG-009");
  BlockScenario s;
  prepare_master(s, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x0064'0301, 4}, {0x1016, 1, 0x0003'05DC, 4}});
  s.tx(0x000, {0x82, 0}).rx(0x703, {0x00}).rx(0x703, {0x7F}).advance(1s).no_tx().expect(901, 0x0002);
  s.set_object(0x1F83, 3, 1, 1).advance(400ms).no_tx().expect_object(0x1F83, 3, 0, 1).expect(901, 0x0002);
  s.advance(200ms).expect_bit(901, 7, true).expect_bit(901, 2, false).expect_bit(901, 3, false).ignore_tx();
  // Any of the three that is missing: no guarding, not on request either.
  for (const std::uint32_t assignment : {0x0064'0300U, 0x0064'0001U, 0x0000'0301U}) {
    BlockScenario none;
    prepare_master(none, {{0x1F80, 0, 1, 4}, {0x1F81, 3, assignment, 4}});
    none.tx(0x000, {0x82, 0}).rx(0x703, {0x00}).advance(1s).no_tx();
    none.set_object(0x1F83, 3, 1, 1).advance(1s).no_tx().expect_object(0x1F83, 3, 0, 1).expect(901, 0);
  }
  BlockScenario slave;
  slave.power_on().set_object(0x100C, 0, 100, 2).set_object(0x100D, 0, 3, 1);
  slave.rx_remote(0x77F).tx(0x77F, {0x7F}).set_object(0x1017, 0, 10'000, 2).ignore_tx();
  slave.rx_remote(0x77F).advance(5s).no_tx().expect(29, 0);
}

TEST(FxErrorControl, AGuardedSlaveThatAnswersAgain_IsFollowedAgain) {
  RecordProperty("spec", "FX3U-NG-007 FX3U-NG-005");
  BlockScenario s;
  prepare_master(s, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x0064'0301, 4}});
  s.tx(0x000, {0x82, 0}).rx(0x703, {0x00}).tx_remote(0x703).rx(0x703, {0x7F}).expect(901, 1).ignore_tx();
  s.wait_bit(901, 3, true).ignore_tx().expect_bit(29, 10, true);
  // Back: asked as before, its state is shown, and nothing is in the way of clearing the failure.
  for (const std::uint8_t answer : Bytes{0x04, 0x84, 0x04}) {
    s.wait_bit(25, 7, false).advance(100ms).tx_remote(0x703).rx(0x703, {answer}).ignore_tx();
    s.expect(603, 4).expect_bit(901, 0, true);
  }
  s.write(29, 0).expect(29, 0).expect(901, 0x0001);
  // The same of a slave that has missed its master: EMCY 0000H when its requests are there again.
  BlockScenario slave;
  slave.power_on().set_object(0x100C, 0, 100, 2).set_object(0x100D, 0, 3, 1);
  slave.rx_remote(0x77F).ignore_tx().advance(300ms).tx(0x0FF, {0x7F, 0x8F, 0x11, 0, 0, 0, 0, 0});
  slave.expect(963, 0x0040 | slave.read(963)).expect_bit(29, 10, true);
  slave.rx_remote(0x77F).tx(0x77F, {0xFF}).tx(0x0FF, {0, 0, 0, 0, 0, 0, 0, 0}).no_tx();
  slave.write(29, 0).expect(29, 0).expect_bit(963, 6, false).rx_remote(0x77F).ignore_tx();
}

TEST(FxNmt, ARequestToANodeThatIsNotTheMaster_IsRefused) {
  RecordProperty("spec", "FX3U-NMT-017 FX3U-CM-010");
  BlockScenario s;
  s.power_on_operational();
  for (const std::uint16_t sub : Words{3, 127, 0x80}) {
    for (const std::uint16_t request : Words{4, 5, 6, 7, 0x7F})
      s.cif({0x0002, 0, 0x1F82, sub, 1, request}).expect_abort(0x0800'0022).no_tx();
    s.cif({0x0002, 0, 0x1F83, sub, 1, 1}).expect_abort(0x0800'0022).no_tx();
    if (sub != 127) s.cif({0x0002, 0, 0x1F25, sub, 4, 0x6F63, 0x666E}).expect_abort(0x0800'0022).no_tx();
  }
  s.expect(25, 0x0201);
}

/// 1017:00 = 500, then 1800:02 = 1.
void write_concise_dcf(BlockScenario& s, std::uint16_t node, Where where = Where::current()) {
  Words command{0x0002, 0, 0x1F22, node, 21};
  const Words file{2, 0, 0x1017, 0x0200, 0, 0xF400, 0x0001, 0x0218, 0x0001, 0x0000, 0x0001};
  command.insert(command.end(), file.begin(), file.end());
  s.cif(command).expect(1000, 0x0003, where);
}
const Bytes write_1017{0x2B, 0x17, 0x10, 0, 0xF4, 0x01, 0, 0}, written_1017{0x60, 0x17, 0x10, 0, 0, 0, 0, 0};
const Bytes write_1800{0x2F, 0x00, 0x18, 2, 0x01, 0x00, 0, 0}, written_1800{0x60, 0x00, 0x18, 2, 0, 0, 0, 0};

TEST(FxConfiguration, ARequestToAll_IsForEveryNodeWithData) {
  RecordProperty("spec", "FX3U-CM-006 FX3U-CM-004 FX3U-CM-005");
  BlockScenario s;
  prepare_master(s, {{0x1F80, 0, 1, 4}});
  s.advance(2s).ignore_tx();
  // 08000024H is for :01 to :7F alone [5.8.13].
  s.cif({0x0002, 0, 0x1F25, 0x80, 4, 0x6F63, 0x666E}).expect(1000, 0x0003).no_tx();
  for (const std::uint16_t node : Words{1, 126})
    s.cif({0x0002, 0, 0x1F25, node, 4, 0x6F63, 0x666E}).expect_abort(0x0800'0024).no_tx();
  write_concise_dcf(s, 127);  // its own: never downloaded
  for (const std::uint16_t sub : Words{0x80, 127})
    s.cif({0x0002, 0, 0x1F25, sub, 4, 0x6F63, 0x666E}).expect(1000, 0x0003).no_tx();
  for (const std::uint16_t node : Words{1, 9, 126}) write_concise_dcf(s, node);
  s.cif({0x0002, 0, 0x1F25, 0x80, 4, 0x6F63, 0x666E}).expect(1000, 0x0003);
  for (const std::uint32_t node : {1U, 9U, 126U}) s.tx(0x600 + node, write_1017);
  s.no_tx();
  for (const std::uint32_t node : {1U, 9U, 126U}) s.rx(0x580 + node, written_1017);
  for (const std::uint32_t node : {1U, 9U, 126U})
    s.tx(0x600 + node, write_1800).rx(0x580 + node, written_1800);
  s.no_tx();
  for (const std::uint16_t wrong : Words{0, 0x6F64})
    s.cif({0x0002, 0, 0x1F25, 1, 4, wrong, 0x666E}).expect(1000, 0x000F);
  s.no_tx();
}

TEST(FxConfiguration, AReadOnlyEntryIsPassedOver_AnyOtherFailureEndsIt) {
  RecordProperty("spec", "FX3U-CM-009 FX3U-CM-007 FX3U-BOOT-010");
  struct Row {
    std::uint32_t abort;  // 0: silence
    bool goes_on;
  };
  for (const Row& row :
       {Row{0x0601'0002, true}, Row{0x0609'0030, false}, Row{0x0602'0000, false}, Row{0, false}}) {
    BlockScenario s;
    s.power_on().write(26, 0);
    write_concise_dcf(s, 3);
    s.set_object(0x1F80, 0, 1, 4).set_object(0x1F81, 3, 0x0D, 4).store_objects().save().restart();
    s.ignore_tx().rx(0x703, {0x00});
    identify_slave(s, 3, type_of_slave);
    s.tx(0x603, write_1017);
    if (row.abort == 0) {
      s.advance(500ms).tx(0x603, {0x80, 0x17, 0x10, 0, 0x00, 0x00, 0x04, 0x05});
    } else {
      Bytes abort{0x80, 0x17, 0x10, 0};
      for (unsigned i = 0; i < 4; ++i) abort.push_back(static_cast<std::uint8_t>(row.abort >> (8 * i)));
      s.rx(0x583, abort);
    }
    if (row.goes_on) {
      s.tx(0x603, write_1800)
          .rx(0x583, written_1800)
          .tx(0x000, {0x01, 3})
          .no_tx()
          .expect(25, 0x8201)
          .expect(29, 0);
    } else {
      s.no_tx().expect(901, 0x0010).expect(25, 0x8900).expect(29, 0x0401).advance(1min).no_tx();
    }
  }
  // 1020H as 1F26H and 1F27H say: nothing is written; one of them else: all is.
  for (const std::uint8_t time : Bytes{2, 3}) {
    BlockScenario s;
    s.power_on().write(26, 0);
    write_concise_dcf(s, 3);
    s.set_object(0x1F26, 3, 1, 4).set_object(0x1F27, 3, 2, 4);
    s.set_object(0x1F80, 0, 1, 4).set_object(0x1F81, 3, 0x0D, 4).store_objects().save().restart();
    s.ignore_tx().rx(0x703, {0x00});
    identify_slave(s, 3, type_of_slave);
    s.tx(0x603, {0x40, 0x20, 0x10, 1, 0, 0, 0, 0}).rx(0x583, {0x43, 0x20, 0x10, 1, 1, 0, 0, 0});
    s.tx(0x603, {0x40, 0x20, 0x10, 2, 0, 0, 0, 0}).rx(0x583, {0x43, 0x20, 0x10, 2, time, 0, 0, 0});
    if (time != 2)
      s.tx(0x603, write_1017).rx(0x583, written_1017).tx(0x603, write_1800).rx(0x583, written_1800);
    s.tx(0x000, {0x01, 3}).no_tx();
  }
}

/// Node 5, a flying master of the level 1.
void flying_master(BlockScenario& s) {
  s.power_on_as(5).write(26, 0).set_object(0x1F80, 0, 0x21, 4).store_objects().save().restart();
}

// S087.3
TEST(FxNmt, AFlyingMaster_MakesRoomForABetterOne_AndStaysBeforeAWorse) {
  RecordProperty("spec", "FX3U-FM-009 FX3U-FM-002");
  BlockScenario s;
  flying_master(s);
  s.advance(6s).expect_bit(25, 15, true).ignore_tx();
  s.rx(0x073).tx(0x071, {1, 5}).no_tx();              // node 4 asks for the active master,
  s.rx(0x076).tx(0x072).expect_bit(25, 15, false);    // forces a negotiation,
  s.advance(1540ms).rx(0x071, {1, 4}).advance(20ms);  // and is first, by its node-ID
  s.rx(0x704, {0x05}).advance(500ms).expect_bit(25, 15, false).ignore_tx();
  // The other side of it: node 5 joins a network of node 6, and of node 4.
  for (const std::uint8_t active : Bytes{4, 6}) {
    BlockScenario joins;
    flying_master(joins);
    joins.wait_tx(0x073, {}, 1s).rx(0x071, {1, active});
    if (active == 6) joins.tx(0x076).tx(0x072).rx(0x072);
    joins.no_tx();
    for (int i = 0; i < 20 && active == 4; ++i) joins.rx(0x704, {0x05}).advance(100ms);
    joins.advance(active == 6 ? 2s : 0s).expect_bit(25, 15, active == 6).ignore_tx();
  }
}

TEST(FxNmt, AForeignMasterWithoutAHeartbeat_IsResetWithoutEnd) {
  RecordProperty("spec", "FX3U-FM-010 FX3U-FM-007");
  BlockScenario s;
  flying_master(s);
  s.wait_tx(0x073, {}, 2s);
  for (int again = 0; again < 10; ++again) {
    s.rx(0x071, {0, 9});
    const can::Time answered = s.now();
    EXPECT_EQ(when_first_sent(s, 0x000, {0x82, 0}) - answered, 1550ms);  // 1500 + 10 x 5
    when_first_sent(s, 0x073, {});
  }
  s.ignore_tx();
}

TEST(FxNmt, LssSearch_AtOtherBitRates) {
  RecordProperty("spec", "FX3U-LSS-003 FX3U-LSS-002 FX3U-LSS-004 FX3U-COM-012");
  const auto start = [](BlockScenario& s) {
    prepare_master(s, {{0x1F80, 0, 1, 4},
                       {0x1F81, 10, 0x0D, 4},
                       {0x1F89, 0, 2000, 4},
                       {0x1F84, 10, type_of_slave, 4},
                       {0x1F85, 10, 0x71, 4},
                       {0x1F86, 10, 3, 4},
                       {0x1F87, 10, 4, 4},
                       {0x1F88, 10, 5, 4}});
    s.advance(1999ms).expect_bit(25, 10, false).ignore_tx().advance(1ms).expect_bit(25, 10, true);
  };
  const auto asks = [](BlockScenario& s, can::Duration at_most = 20s) {
    s.wait_tx(0x7E5, {0x40, 0x71, 0, 0, 0, 0, 0, 0}, at_most).wait_tx(0x7E5, {0x41, 3, 0, 0, 0, 0, 0, 0});
    s.wait_tx(0x7E5, {0x42, 4, 0, 0, 0, 0, 0, 0}).wait_tx(0x7E5, {0x43, 5, 0, 0, 0, 0, 0, 0});
  };
  {
    SCOPED_TRACE("there, at the own rate: it gets its number and keeps the rate");
    BlockScenario s;
    start(s);
    asks(s);
    s.rx(0x7E4, {0x44, 0, 0, 0, 0, 0, 0, 0}).tx(0x7E5, {0x11, 10, 0, 0, 0, 0, 0, 0});
    s.rx(0x7E4, {0x11, 0, 0, 0, 0, 0, 0, 0}).tx(0x7E5, {0x13, 0, 3, 0, 0, 0, 0, 0});
    s.rx(0x7E4, {0x13, 0, 0, 0, 0, 0, 0, 0}).tx(0x7E5, {0x17, 0, 0, 0, 0, 0, 0, 0});
    s.rx(0x7E4, {0x17, 0, 0, 0, 0, 0, 0, 0}).tx(0x7E5, {0x04, 0, 0, 0, 0, 0, 0, 0});
    s.wait_bit(25, 10, false).expect(37, 2500).ignore_tx();
    EXPECT_EQ(s.controller().rate, 250'000U);
  }
  {
    SCOPED_TRACE("nowhere: every other rate is tried once, and the own one comes back");
    BlockScenario s;
    start(s);
    std::vector<std::uint32_t> rates;
    for (const can::Time end = s.now() + 1min; (s.read(25) >> 10 & 1U) != 0 && s.now() < end;) {
      if (rates.empty() || rates.back() != s.controller().rate) rates.push_back(s.controller().rate);
      s.ignore_tx().advance(1ms);
      if (s.controller().rate == 500'000) s.error_counters(256, 0).expect(29, 0).error_counters(0, 0);
    }
    EXPECT_EQ(rates, (std::vector<std::uint32_t>{250'000, 1'000'000, 800'000, 500'000, 125'000, 50'000,
                                                 20'000, 10'000}));
    EXPECT_EQ(s.controller().rate, 250'000U);
    s.expect_bit(25, 11, true).ignore_tx().advance(20s).no_tx();
  }
}

/// Into what 1010H has stored, past the checks of the node.
void store_besides_checks(RamMemory& memory, std::uint16_t index, std::uint8_t sub, const Bytes& value) {
  module::FlashMemory flash(memory, {"object-dictionary"});
  flash.load();
  auto content = flash.read("object-dictionary").bytes;
  canopen::append_stored_value(content, canopen::StoredLength::two_bytes, index, sub, value);
  flash.write("object-dictionary", content);
}

TEST(FxStartUp, AFaultyStoredConfiguration_KeepsItInitializing_UntilItIsRestored) {
  RecordProperty("spec", "FX3U-ERR-011");
  for (const bool by_supply : {false, true}) {
    BlockScenario s;
    s.power_on().set_object(0x1017, 0, 1000, 2).store_objects();
    store_besides_checks(s.flash(), 0x1A00, 1, {0x10, 0x01, 0x99, 0x5F});  // maps 5F99H, which is no object
    store_besides_checks(s.flash(), 0x1A00, 0, {1});
    s.supply_off()
        .ignore_tx()
        .supply_on()
        .advance(1min)
        .expect(25, 0x0080)
        .no_tx();  // no boot-up, no heartbeat
    s.write(24, 125).expect(29, 0x0021).expect(40, 24).write(20, 1).write(22, 1).write(51, 1).advance(1s);
    s.expect(20, 0).expect(22, 0).expect(24, 250);
    // By the command interface, although it initializes; in force after a restart.
    s.cif({0x6010, 0, 0xFFFF}).expect(1000, {0x6011, 0}).advance(1min).expect(25, 0x0080).no_tx();
    by_supply ? s.supply_off().supply_on() : s.write(25, 1);
    s.wait_bit(25, 7, false).tx(0x77F, {0x00}).expect(25, 0x0100).no_tx();
    s.expect_object(0x1017, 0, 0, 2).expect_object(0x1A00, 0, 4, 1).expect_object(0x1A00, 1, 0xA100'0110, 4);
  }
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_master_corners_test
