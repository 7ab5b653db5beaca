// CANopen 417 mode: entering and leaving it, lift number, words and exchange [FX3U-CAN 5.10, 6.4, 6.5, 8].

#include "scenarios/fx3u_can/lift_scenario.hpp"

namespace canopus::scenario::fx3u_can_lift_mode_test {
namespace {

// T417-01, T417-02
TEST(FxLiftMode, IsEntered_BySaveAndRestart_AndNotOtherwise) {
  RecordProperty("spec",
                 "FX3U-LIFT-001 FX3U-LIFT-002 FX3U-LIFT-004 FX3U-LIFT-005 FX3U-MODE-006 FX3U-MODE-007");
  BlockScenario s;
  s.power_on().write(21, 417).write(24, 250).write(27, 1).expect(29, 0);
  s.restart().expect(21, 405).expect_object(0x1000, 0, 0x195, 4).expect(13000, 0).expect(12050, 0);
  s.write(21, 417).write(27, 1).save();
  s.expect_object(0x1000, 0, 0x195, 4).ignore_tx();
  s.write(25, 1).ignore_tx().expect_bit(25, 7, true).wait_bit(25, 7, false).tx(0x701, {0x00});
  s.expect(21, 417).expect(13000, 1).expect(12050, 0xFFFF).expect(13050, 0xFFFF);
  s.rx(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}).tx(0x581, {0x43, 0x00, 0x10, 0x00, 0xA1, 0x01, 0, 0});
  s.advance(999ms).no_tx().advance(1ms).tx(0x701, {0x7F}).advance(1s).tx(0x701, {0x7F}).no_tx();
  s.expect_object(0x1017, 0, 1000, 2);
  // And left again.
  s.write(21, 405).save().restart().expect(21, 405).expect(13000, 0).expect(12050, 0);
  s.expect_object(0x1000, 0, 0x195, 4).expect_object(0x1017, 0, 0, 2).advance(5s).no_tx();
  s.cif({0x0004, 0, 0x6001, 0}).expect_abort(0x06020000);
}

// T417-03
TEST(FxLiftMode, FourModes_AndNoOthers) {
  RecordProperty("spec", "FX3U-LIFT-001 FX3U-MODE-002");
  BlockScenario s;
  for (const std::uint16_t mode : Words{11, 29, 417, 405}) {
    s.supply_off().supply_on().wait_bit(25, 7, false).ignore_tx();
    s.write(21, mode).expect(29, 0).save().restart().expect(21, mode);
    EXPECT_EQ(s.plug_in().layer2_state(),
              mode < 405 ? module::Layer2State::offline : module::Layer2State::inactive);
    s.expect(12050, mode == 417 ? 0xFFFF : 0).ignore_tx();
  }
  for (const std::uint16_t value : Words{0, 1, 404, 406, 416, 418, 0xFFFF}) {
    s.supply_off().power_on().write(21, value).expect(29, 0x0041).expect(39, 21).expect(21, 405);
    s.write(29, 0).expect(29, 0).expect(39, 0);
  }
}

// T417-04
TEST(FxLiftMode, StoredObjects_GoWithTheMode) {
  RecordProperty("spec", "FX3U-LIFT-003 FX3U-OD417-006 FX3U-MODE-005");
  BlockScenario s;
  s.power_on_as(1).set_object(0x1017, 0, 500, 2).set_object(0x1015, 0, 70, 2).store_objects();
  s.restart().expect_object(0x1017, 0, 500, 2).ignore_tx();
  s.write(21, 417).save().restart();
  s.expect_object(0x1017, 0, 1000, 2).expect_object(0x1015, 0, 0, 2).ignore_tx();
  // Stored in 417 mode it is there at the next start in it,
  s.set_object(0x1017, 0, 700, 2).set_object(0x1902, 3, 30, 2).set_object(0x1902, 5, 40, 2);
  s.set_object(0x1902, 2, 1, 1).set_object(0x1902, 1, 0x40000182, 4).set_object(0x1503, 1, 0x80000183, 4);
  s.store_objects().restart().ignore_tx();
  s.expect_object(0x1017, 0, 700, 2).expect_object(0x1902, 1, 0x40000182, 4).expect_object(0x1902, 5, 40, 2);
  s.expect_object(0x1902, 3, 30, 2).expect_object(0x1902, 2, 1, 1).expect_object(0x1503, 1, 0x80000183, 4);
  s.supply_off().supply_on().wait_bit(25, 7, false).ignore_tx();
  s.expect_object(0x1017, 0, 700, 2).expect_object(0x1902, 1, 0x40000182, 4).ignore_tx();
  // and gone in 405 mode, and after it.
  s.write(21, 405).save().restart().expect_object(0x1017, 0, 0, 2);
  s.write(21, 417).save().restart().expect_object(0x1017, 0, 1000, 2);
  s.expect_object(0x1902, 1, 0xC0000182, 4).ignore_tx();
  // A mode that was selected and not started in deletes nothing.
  s.set_object(0x1017, 0, 900, 2).store_objects().write(21, 405).save().write(21, 417).save();
  s.restart().expect_object(0x1017, 0, 900, 2).ignore_tx();
}

// T417-05
TEST(FxLiftMode, LiftNumber_IsOneObject_StoredWithIt) {
  RecordProperty("spec", "FX3U-LIFT-010 FX3U-LIFT-011 FX3U-LIFT-012");
  BlockScenario s;
  start_lift_mode(s);
  s.expect(3000, 1).expect(13000, 1).expect_object(0x6001, 0, 1, 1);
  s.write(13000, 5).expect(3000, 5).expect(13000, 5).expect_object(0x6001, 0, 5, 1);
  s.write(3000, 0xFF).expect(3000, 0xFF).expect(13000, 0xFF).expect_object(0x6001, 0, 0xFF, 1);
  s.set_object(0x6001, 0, 2, 1).expect(3000, 2).expect(13000, 2);
  s.write(13000, 0x0100).expect(13000, 2).expect(29, 0x0041).expect(39, 13000).write(29, 0);
  s.save().restart().expect(13000, 1).expect(3000, 1);  // #22 does not store it
  s.write(13000, 3).store_objects().restart().expect(13000, 3).expect(3000, 3);
  s.write(13000, 7).restart().expect(13000, 3).ignore_tx();
}

TEST(FxLiftMode, VirtualDevices_AndObjectsOfEachLift) {
  RecordProperty("spec",
                 "FX3U-LIFT-006 FX3U-LIFT-007 FX3U-LIFT-009 FX3U-OD417-008 FX3U-OD417-010 FX3U-LIFT-008");
  BlockScenario s;
  start_lift_mode(s);  // as node 1: the lowest node-ID is the one to be given
  s.expect_object(0x6000, 0, 3, 1).expect_object(0x6000, 1, 0x0100, 2).expect_object(0x6000, 2, 0x0400, 2);
  s.expect_object(0x6000, 3, 0x0800, 2).expect_object(0x6008, 0, 0x2021, 2);
  struct Object {
    unsigned index;
    std::uint8_t subs;  // 0: a variable
    unsigned length;
    std::uint32_t initial;
    bool writes;
  };
  for (const Object& object : std::vector<Object>{{0x6300, 4, 2, 0xFFFF, false},
                                                  {0x6301, 4, 2, 0xFFFF, true},
                                                  {0x6302, 4, 2, 0xFFFF, true},
                                                  {0x6310, 4, 1, 0xFF, true},
                                                  {0x6383, 4, 4, 0xFFFFFFFF, true},
                                                  {0x6390, 4, 2, 0, true},
                                                  {0x6391, 4, 2, 0, true},
                                                  {0x6400, 0, 2, 0, false},
                                                  {0x6401, 0, 2, 0, true},
                                                  {0x6403, 0, 1, 0, false},
                                                  {0x6404, 0, 1, 0, true},
                                                  {0x6406, 0, 4, 0, true},
                                                  {0x6407, 0, 4, 0xFFFFFFFF, true},
                                                  {0x6420, 0, 4, 0, false},
                                                  {0x6423, 0, 4, 0, false},
                                                  {0x6430, 0, 4, 0, false},
                                                  {0x6433, 0, 4, 0, true}}) {
    for (unsigned lift = 0; lift < 8; ++lift) {
      const auto index = static_cast<std::uint16_t>(object.index + 0x0800 * lift);
      if (object.subs != 0) s.expect_object(index, 0, object.subs, 1);
      const std::uint8_t first = object.subs == 0 ? 0 : 1;
      for (std::uint8_t sub = first; sub <= std::max(first, object.subs); ++sub) {
        s.expect_object(index, sub, object.initial, object.length);
        const auto length = static_cast<std::uint16_t>(object.length);
        s.cif({0x0002, 0, index, sub, length, 0x55, 0});
        if (object.writes) {
          s.expect(1000, 0x0003).expect_object(index, sub, 0x55, object.length);
        } else {
          s.expect_abort(0x06010002).expect_object(index, sub, object.initial, object.length);
        }
      }
      s.cif({0x0004, 0, index, static_cast<std::uint16_t>(object.subs + 1)}).expect_abort(0x06090011);
    }
  }
  for (unsigned lift = 0; lift < 8; ++lift) {
    const auto load = static_cast<std::uint16_t>(0x6480 + 0x0800 * lift);
    s.expect_object(load, 1, 0xFFFF, 2).expect_object(load, 2, 2, 2).set_object(load, 2, 0x0301, 2);
    const auto signal = static_cast<std::uint16_t>(0x6482 + 0x0800 * lift);
    s.expect_object(signal, 1, 0, 1).expect_object(signal, 2, 0, 1).set_object(signal, 2, 8, 1);
  }
  for (const std::uint16_t index : Words{0x6000, 0x6008}) {
    const std::uint16_t sub = index == 0x6000 ? 1 : 0;
    s.cif({0x0002, 0, index, sub, 2, 1}).expect_abort(0x06010002);
  }
  s.cif({0x0002, 0, 0x6011, 0, 6, 1, 2, 3}).expect_abort(0x06010002);
  // A filler of a PDO is no object, nor is what lies beyond the lifts.
  for (const std::uint16_t index : Words{0x67FE, 0x62FF, 0x6303, 0xA300, 0x6005}) {
    s.cif({0x0004, 0, index, 0}).expect_abort(0x06020000);
    s.cif({0x0002, 0, index, 0, 1, 1}).expect_abort(0x06020000);
  }
  // Not in the flash memory.
  s.store_objects().restart().ignore_tx();
  s.expect_object(0x6301, 1, 0xFFFF, 2).expect_object(0x6480, 2, 2, 2).expect_object(0x9C82, 2, 0, 1);
}

TEST(FxLiftMode, OlderWords_AreTwo_WhereWhatIsReceivedAndSentDiffer) {
  RecordProperty("spec", "FX3U-LIFT-015 FX3U-LIFT-016 FX3U-LIFT-017 FX3U-LIFT-018 FX3U-DRV-017");
  BlockScenario s;
  start_lift_operational(s);
  s.write(3050, 0x1FFF).expect(13050, 0x1FFF).expect(3050, 0xFFFF).expect(12050, 0xFFFF);
  s.write(13050, 0x4FFF).expect(13050, 0x4FFF).expect(3050, 0xFFFF);
  s.write(3460, {0x2345, 0x0001}).expect(13460, {0x2345, 0x0001}).expect(3460, {0xFFFF, 0xFFFF});
  s.write(3492, {100, 0}).expect(13492, {100, 0}).expect(3492, {0, 0});
  s.write(3476, {1500, 0}).expect(13476, {1500, 0}).expect(3476, {0, 0});
  s.rx(0x183, {0x37, 0x06, 3, 0, 0xF4, 1, 0, 0}).exchange(0x0100).ignore_tx();
  s.expect(12492, {500, 0}).expect(3492, {500, 0}).expect(13492, {100, 0});
  // Every received word at both numbers; writes reach none of them.
  for (module::BufferAddress word = 1; word < 540; ++word) {
    if (word < 5) continue;  // virtual inputs
    s.expect(3000 + word, s.read(12000 + word));
    const std::uint16_t before = s.read(12000 + word);
    s.write(12000 + word, 0x1234).expect(12000 + word, before);
  }
  s.expect(29, 0);
  // Words of no use read 0 and take nothing.
  for (const module::BufferAddress word :
       {3005U, 3049U, 3146U, 3299U, 3540U, 9999U, 12000U, 12005U, 12146U, 12476U, 12491U, 12540U, 13004U,
        13082U, 13299U, 13300U, 13444U, 13508U, 13540U}) {
    s.write(word, 0x1234).expect(word, 0);
  }
  s.expect(29, 0).expect(39, 0).ignore_tx();
}

TEST(FxLiftMode, OnlyAssignedLifts_AreUpdatedAndSent) {
  RecordProperty("spec", "FX3U-LIFT-013 FX3U-LIFT-014");
  BlockScenario s;
  start_lift_operational(s);
  s.set_object(0x1912, 1, 0x40000192, 4).set_object(0x1902, 1, 0x40000182, 4).ignore_tx();
  s.rx(0x193, {0x21, 0, 1, 0, 9, 0, 0, 0}).write(13429, 6).exchange(0x0100).no_tx();
  s.expect(12429, 0).expect(12494, 0);
  s.write(13428, 7).exchange(0x0100).tx(0x182, {7, 0, 0, 0, 0, 0, 0, 0}).no_tx();
  s.write(13000, 3).rx(0x193, {0x21, 0, 1, 0, 9, 0, 0, 0}).exchange(0x0100);
  s.tx(0x192, {6, 0, 0, 0, 0, 0, 0, 0}).no_tx().expect(12429, 0x0021).expect(12437, 1).expect(12494, {9, 0});
  // A lift that is taken away keeps what it had.
  s.write(13000, 1).rx(0x193, {0x23, 0, 1, 0, 9, 0, 0, 0}).exchange(0x0100).expect(12429, 0x0021).no_tx();
}

// T417-13 and the bits of #20
TEST(FxLiftMode, Exchange_AsItsBitsSay) {
  RecordProperty("spec", "FX3U-LIFT-019 FX3U-LIFT-020 FX3U-LIFT-021 FX3U-LIFT-022 FX3U-DX-008");
  const Bytes call{2, 1, 1, 3, 1, 1}, door{0xFF, 0x1F, 0, 0}, emergency{0x01, 0xFF, 0x81, 0, 0, 0, 0, 0};
  for (const std::uint16_t bits : Words{0x0001, 0x0100, 0x0200, 0x1000, 0x0300, 0x0000}) {
    BlockScenario s;
    start_lift_operational(s);
    s.rx(0x485, call).rx(0x485, call).rx(0x201, door).rx(0x087, emergency);
    s.write(13001, {0x0102, 0x0301, 0x8101});
    s.expect(12001, {0, 0, 0, 2}).expect(12050, 0xFFFF).expect(750, 0).no_tx();
    s.exchange(bits);
    const bool all = bits == 0x0001, data = all || (bits & 0x0100) != 0, input = all || (bits & 0x0200) != 0;
    if (data) s.tx(0x400, {2, 1, 1, 3, 1, 0x81});
    s.no_tx().expect(20, 0);
    s.expect(12050, data ? 0x1FFF : 0xFFFF).expect(12082, data ? 0 : 0xFFFF);
    s.expect(12001, input ? Words{0x0102, 0x0301, 0x0101, 1} : Words{0, 0, 0, 2});
    s.expect(750, all || bits == 0x1000 ? 7 : 0).ignore_tx();
  }
  // What has come shows itself with an exchange only: the last of it.
  BlockScenario s;
  start_lift_operational(s);
  for (const std::uint8_t mm : Bytes{10, 20, 30}) s.rx(0x201, {0xFF, 0x2F, mm, 0}).expect(12082, 0xFFFF);
  s.exchange(0x0100).expect(12082, 30).rx(0x201, {0xFF, 0x2F, 40, 0}).expect(12082, 30);
  s.exchange(0x0200).expect(12082, 30).exchange(0x0100).expect(12082, 40).no_tx();
  // While bit 0 is 1, writes are ignored.
  s.write(13001, 1).write(20, 1).expect(20, 0x0101).write(20, 0x0200).expect(20, 0x0101);
  s.advance(1ms).expect(20, 0).ignore_tx();
  // What is sent is what stood there at the request.
  s.write(13001, {0x0102, 0x0401, 0x8101}).write(20, 1).write(13001, 0x0103).advance(1ms);
  s.tx(0x400, {2, 1, 1, 4, 1, 0x81}).no_tx().exchange(0x0100).tx(0x400, {3, 1, 1, 4, 1, 0x81});
}

// T417-19
TEST(FxLiftMode, OutsideOfOperational_DataWait_AndNoPdoIsTaken) {
  RecordProperty("spec", "FX3U-LIFT-023 FX3U-LIFT-024");
  for (const std::uint8_t command : Bytes{0x80, 0x02}) {
    for (const std::uint16_t bits : Words{0x0001, 0x0100}) {
      BlockScenario s;
      start_lift_operational(s);
      s.nmt(command).ignore_tx();
      s.rx(0x485, {2, 1, 1, 3, 1, 1}).rx(0x201, {0xFF, 0x1F, 0, 0});
      s.write(13001, {0x0102, 0x0301, 0x8101}).write(20, bits).advance(100ms).no_tx();
      s.expect(20, 0x0101).expect(12001, {0, 0, 0, 0}).expect(12050, 0xFFFF);
      s.nmt(0x01).advance(1ms).tx(0x400, {2, 1, 1, 3, 1, 0x81}).no_tx().expect(20, 0).expect(12050, 0xFFFF);
      s.exchange(0x0200).expect(12001, {0, 0, 0, 0}).no_tx();
    }
  }
}

TEST(FxLiftMode, LiftPdos_AreEventDriven_AndSentOnChange) {
  RecordProperty("spec", "FX3U-LIFT-025 FX3U-LIFT-026 FX3U-LIFT-027");
  BlockScenario s;
  start_lift_operational(s);
  for (const std::uint16_t index :
       Words{0x1400, 0x1481, 0x14C0, 0x1501, 0x1573, 0x15F1, 0x1800, 0x1900, 0x1902, 0x1978})
    s.expect_object(index, 2, 0xFF, 1);
  s.write(13001, {0x0102, 0x0301, 0x0101}).exchange().tx(0x400, {2, 1, 1, 3, 1, 1});
  s.exchange().no_tx().exchange(0x0100).no_tx();
  s.write(13003, 0x0001).exchange().tx(0x400, {2, 1, 1, 3, 1, 0}).no_tx();
  s.set_object(0x1900, 5, 100, 2).ignore_tx().advance(100ms).tx(0x400, {2, 1, 1, 3, 1, 0});
  s.advance(99ms).no_tx().advance(1ms).tx(0x400, {2, 1, 1, 3, 1, 0}).no_tx();
  s.write(13003, 0x0101).advance(100ms).tx(0x400, {2, 1, 1, 3, 1, 0});  // not exchanged
  s.set_object(0x1900, 5, 0, 2).ignore_tx();
  // By SYNC, where the type says so.
  s.set_object(0x1902, 2, 1, 1).set_object(0x1902, 1, 0x40000182, 4).ignore_tx();
  s.write(13428, 6).exchange(0x0100).tx(0x400, {2, 1, 1, 3, 1, 1}).no_tx();
  s.rx(0x080).tx(0x182, {6, 0, 0, 0, 0, 0, 0, 0}).no_tx();
  s.set_object(0x1503, 2, 1, 1).rx(0x183, {0x27, 0, 0, 0, 0, 0, 0, 0}).exchange(0x0100).expect(12428, 0);
  s.rx(0x080).ignore_tx().exchange(0x0100).expect(12428, 0x27).ignore_tx();
}

// T417-48
TEST(FxLiftMode, RpdoEventTimer) {
  RecordProperty("spec", "FX3U-LIFT-028");
  BlockScenario s;
  start_lift_operational(s);
  s.set_object(0x1503, 5, 200, 2).advance(5s).no_tx();  // from the first frame on
  s.rx(0x183, {0, 0, 0, 0, 0, 0, 0, 0}).advance(199ms).no_tx().advance(1ms);
  s.tx(0x081, {0x50, 0x82, 0x11, 0x04, 0x01, 'O', 'D', 'P'}).ignore_tx();  // RPDO 104H counted from 1
}

// T417-49
TEST(FxLiftMode, FromToWatchdog_CoversTheLiftWords) {
  RecordProperty("spec", "FX3U-LIFT-029");
  for (const module::BufferAddress word : {3000U, 3428U, 3539U}) {
    BlockScenario s;
    start_lift_operational(s);
    s.write(26, 20).advance(10s).no_tx().expect_bit(29, 7, false);
    (void)s.read(word);
    s.advance(199ms).no_tx().advance(1ms).tx(0x081, {0x00, 0x62, 0x01, '3', '0', '0', 'X', 'F'});
    s.expect_bit(29, 7, true).expect_bit(25, 0, false).write(26, 20).expect_bit(29, 7, false).ignore_tx();
  }
}

// T417-62
TEST(FxLiftMode, OneFreePdoEachWay) {
  RecordProperty("spec", "FX3U-LIFT-030 FX3U-OD417-002 FX3U-MODE-009");
  BlockScenario s;
  start_lift_operational(s);
  s.expect_object(0x1400, 1, 0x80000000, 4).expect_object(0x1800, 1, 0xC0000000, 4);
  s.set_object(0x1800, 1, 0x40000281, 4).set_object(0x1400, 1, 0x281, 4).ignore_tx();
  s.write(11000, {1, 2, 3, 4}).exchange(0x0100).tx(0x281, {1, 0, 2, 0, 3, 0, 4, 0});
  s.write(2, 7).exchange(0x0100).tx(0x281, {1, 0, 2, 0, 7, 0, 4, 0}).expect(11002, 7);
  s.rx(0x281, {5, 0, 6, 0, 7, 0, 8, 0}).exchange(0x0100).expect(10000, {5, 6, 7, 8}).expect(0, {5, 6, 7, 8});
  // Mapped otherwise.
  s.set_object(0x1800, 1, 0xC0000281, 4).set_object(0x1A00, 0, 0, 1).set_object(0x1A00, 1, 0xA1000410, 4);
  s.set_object(0x1A00, 0, 1, 1).set_object(0x1800, 1, 0x40000281, 4).ignore_tx();
  s.write(11003, 9).exchange(0x0100).tx(0x281, {9, 0}).no_tx();
  // The other process data words are none.
  for (const module::BufferAddress word : {4U, 19U, 100U, 399U, 10004U, 10319U, 11004U, 11319U})
    s.write(word, 0x1234).expect(word, 0);
  s.expect(29, 0).ignore_tx();
}

// T417-63
TEST(FxLiftMode, Commands_ButMappingAndLayer2) {
  RecordProperty("spec", "FX3U-LIFT-031");
  BlockScenario s;
  start_lift_operational(s);
  for (const std::uint16_t code : Words{0x8200, 0x8300, 0x8900, 0x000C})
    s.cif({code, 0, 0, 0}).expect(1000, {0x000F, 0x0064});
  s.cif({0x0004, 0, 0x1000, 0}).expect(1000, 0x0005);
  s.cif({0x0002, 0, 0x1017, 0, 2, 0}).expect(1000, 0x0003);
  s.cif({0x0008, 0, 0x1000, 0, 0, 0, 0, 0, 0, 0xFFFF}).expect(1000, 0x0009);
  s.cif({0x0006, 0, 0x1017, 0, 2, 0, 0, 0, 0, 0xFFFF}).expect(1000, 0x0007);
  s.cif({0x7410, 0, 0, 0xFFFF}).expect(1000, 0x7411);
  s.cif({0x7400, 0, 9, 1000, 0xFFFF}).expect(1000, 0x7401);
  s.cif({0x6000, 0, 0xFFFF}).expect(1000, 0x6001);
  s.cif({0x6010, 0, 0xFFFF}).expect(1000, 0x6011);
  s.cif({0x0000}).expect(1000, 0x0000);
  // T417-64: emergency messages of lifts, by the program; none comes by itself.
  for (const std::uint16_t code :
       Words{0x0010, 0x3111, 0x3121, 0x3211, 0x3221, 0xFF01, 0xFF02, 0xFF03, 0xFF04}) {
    s.ignore_tx().cif({0x000A, code, 0x0081, 0, 0});
    s.tx(0x081, {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8), 0x81, 0, 0, 0, 0, 0});
    s.expect(1000, {0x000B, 0});
  }
}

TEST(FxLiftMode, ValuesOf32Bits_LowWordFirst) {
  RecordProperty("spec", "FX3U-LIFT-032");
  BlockScenario s;
  start_lift_operational(s);
  s.set_object(0x1904, 1, 0x40000180, 4).ignore_tx();
  s.write(13460, {0x5678, 0x1234}).write(13476, {0xBEEF, 0xDEAD}).exchange(0x0100);
  s.tx(0x180, {0x78, 0x56, 0x34, 0x12, 0xEF, 0xBE, 0xAD, 0xDE}).no_tx();
  s.expect_object(0x6420, 0, 0x12345678, 4).expect_object(0x6423, 0, 0xDEADBEEF, 4);
  s.rx(0x18C, {0x78, 0x56, 0x34, 0x12}).rx(0x181, {1, 0, 0, 0x80}).exchange(0x0100);
  s.expect(12300, {0x5678, 0x1234}).expect(12444, {0x0001, 0x8000}).no_tx();
}

TEST(FxLiftMode, NmtMaster_EmergenciesSyncAndTime_AsIn405Mode) {
  RecordProperty("spec", "FX3U-LIFT-033");
  BlockScenario s;
  start_lift_mode(s);
  s.set_object(0x1017, 0, 0, 2).set_object(0x1F80, 0, 1, 4).set_object(0x1F81, 5, 0x00640305, 4);
  s.set_object(0x1005, 0, 0x40000080, 4).set_object(0x1006, 0, 100'000, 4).store_objects().restart();
  s.wait_bit(25, 15, true).ignore_tx().rx(0x705, {0x00}).advance(2s);
  bool sync = false, boots = false;
  for (const can::Frame& frame : s.controller().sent) {
    sync = sync || frame.identifier == 0x080;
    boots = boots || frame.identifier == 0x605;
  }
  EXPECT_TRUE(sync);
  EXPECT_TRUE(boots);
  s.ignore_tx().rx(0x085, {0x01, 0xFF, 0x81, 1, 2, 3, 4, 5}).write(20, 0x1000).advance(1ms).expect(750, 5);
  s.expect(751, {0xFF01, 0x0181, 0x0302, 0x0504}).expect_bit(29, 13, true);
  s.rx(0x100, {0, 0, 0, 0, 0x4D, 0x39}).expect_bit(25, 12, true).ignore_tx();
}

TEST(FxLiftMode, FactorySettings_AreIn405Mode_AfterARestart) {
  RecordProperty("spec", "FX3U-LIFT-034");
  BlockScenario s;
  start_lift_mode(s);
  s.save(2).expect(21, 405).expect(27, 127).expect_object(0x1000, 0, 0x1A1, 4).expect(13000, 1);
  s.restart().expect(21, 417).expect(27, 1).ignore_tx();
  s.save(3).expect(21, 405).expect_object(0x1000, 0, 0x1A1, 4).ignore_tx();
  s.restart().expect(21, 405).expect_object(0x1000, 0, 0x195, 4).expect(13000, 0);
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_lift_mode_test
