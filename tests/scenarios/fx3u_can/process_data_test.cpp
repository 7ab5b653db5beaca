// Process data in CANopen 405 mode: words, network variables, exchange, PDOs [FX3U-CAN 5.6.5, 5.9, 6.4, 7.1].

#include "scenarios/fx3u_can/scenario.hpp"

namespace canopus::scenario::fx3u_can_process_data_test {
namespace {

// S020
TEST(FxProcessData, ChangedWords_GoOutWithTheExchange) {
  RecordProperty("spec", "FX3U-DX-001 FX3U-DX-004 FX3U-PDO-008 FX3U-COM-002 FX3U-D405-006 FX3U-SPEC-010");
  BlockScenario s;
  s.power_on().write(26, 0).nmt(1, 127).expect(25, 0x0201);
  s.write(11000, {0x1111, 0x2222, 0x3333, 0x4444}).advance(1s).no_tx();
  s.write(20, 1).expect(20, 0x0101).advance(1ms).expect(20, 0);
  s.tx(0x1FF, {0x11, 0x11, 0x22, 0x22, 0x33, 0x33, 0x44, 0x44});
  s.exchange().no_tx();
  s.write(0, 0x5555).expect(11000, 0x5555).exchange();
  s.tx(0x1FF, {0x55, 0x55, 0x22, 0x22, 0x33, 0x33, 0x44, 0x44}).no_tx();
  // Two changed words of two PDOs leave together.
  s.write(11003, 1).write(11004, 2).advance(100ms).no_tx().exchange();
  s.tx(0x1FF, {0x55, 0x55, 0x22, 0x22, 0x33, 0x33, 1, 0}).tx(0x2FF, {2, 0, 0, 0, 0, 0, 0, 0}).no_tx();
}

// S021
TEST(FxProcessData, ReceivedData_AreSeenAfterTheExchange) {
  RecordProperty("spec", "FX3U-DX-001 FX3U-DX-003 FX3U-D405-002 FX3U-D405-006");
  BlockScenario s;
  s.power_on_operational().write(26, 0).rx(0x27F, {1, 2, 3, 4, 5, 6, 7, 8}).expect(10000, 0);
  s.exchange().expect(10000, {0x0201, 0x0403, 0x0605, 0x0807}).expect(0, {0x0201, 0x0403, 0x0605, 0x0807});
  s.rx(0x27F, {9, 9, 9, 9, 9, 9, 9, 9}).advance(1s).expect(10000, {0x0201, 0x0403, 0x0605, 0x0807});
  s.exchange().expect(10000, 0x0909).ignore_tx();
}

// S022
TEST(FxProcessData, AnExchangeBeforeOperational_Waits) {
  RecordProperty("spec", "FX3U-DX-005 FX3U-DX-006");
  for (const std::uint16_t bit : Words{1U << 0, 1U << 8}) {
    BlockScenario s;
    s.power_on().write(11000, 1).write(20, bit).advance(1s).expect(20, 0x0101).no_tx();
    s.nmt(1).tx(0x1FF, {1, 0, 0, 0, 0, 0, 0, 0}).expect(20, 0);
  }
}

// S023
TEST(FxProcessData, WhileItRuns_TheControlWordTakesNothing) {
  RecordProperty("spec", "FX3U-DX-002 FX3U-DX-007");
  BlockScenario s;
  s.power_on().write(20, 1).advance(10ms).rx(0x085, {0x00, 0x10, 0x01, 1, 2, 3, 4, 5});
  s.write(20, 0x1000).advance(10ms).expect(20, 0x0101).expect(750, {0, 0});
  s.nmt(1).expect(20, 0).expect(750, {0, 0});
  s.write(11000, 7)
      .write(20, 0x1000)
      .expect(20, 0)
      .advance(1ms)
      .expect(750, {5, 0x1000, 0x0101, 0x0302, 0x0504});
  s.no_tx();  // bit 12 leaves process data alone
  s.rx(0x085, {0x00, 0x20, 0x01, 0, 0, 0, 0, 0}).write(20, 1U << 8).advance(1ms).expect(755, 0);
  s.tx(0x1FF, {7, 0, 0, 0, 0, 0, 0, 0});  // bit 8 leaves received messages alone
  s.exchange().expect(755, {5, 0x2000});
}

// S024, S025
TEST(FxProcessData, OnlyMappedObjectsAreCopied_AndTheLastWriteOfAnAliasIsSeen) {
  RecordProperty("spec", "FX3U-D405-004 FX3U-D405-005");
  BlockScenario s;
  s.power_on_operational().write(11000, 0x1234).exchange().ignore_tx();
  s.expect_object(0xA100, 1, 0x1234, 2);
  s.expect_object(0xA040, 1, 0, 1);
  s.expect_object(0xA200, 1, 0, 4);
  s.set_object(0xA580, 1, 0x1234, 2).set_object(0xA4C0, 1, 0xFF, 1).exchange().expect(10000, 0x12FF);
  s.expect_object(0xA580, 1, 0x1234, 2);
  s.expect_object(0xA4C0, 1, 0xFF, 1);
}

struct PlaceRow {
  std::uint16_t word, legacy, word_index, word_sub, byte_index, byte_sub, long_sub;
  bool high;
};

// S026: each row of the table, both directions.
TEST(FxProcessData, Addresses_OfWordsBytesAndDoubleWords) {
  RecordProperty("spec", "FX3U-D405-001 FX3U-D405-002 FX3U-D405-003 FX3U-NV-003 FX3U-PDO-014 FX3U-PDO-001");
  for (const PlaceRow& row : {PlaceRow{0, 0, 0, 0x01, 0, 0x01, 0x01, false},
                              {19, 19, 0, 0x14, 0, 0x27, 0x0A, true},
                              {20, 100, 0, 0x15, 0, 0x29, 0x0B, false},
                              {119, 199, 0, 0x78, 0, 0xEF, 0x3C, true},
                              {120, 200, 1, 0x01, 1, 0x01, 0x3D, false},
                              {239, 319, 1, 0x78, 1, 0xEF, 0x78, true},
                              {240, 320, 2, 0x01, 2, 0x01, 0x79, false},
                              {319, 399, 2, 0x50, 2, 0x9F, 0xA0, true}}) {
    BlockScenario s;
    s.power_on();
    const std::uint32_t shift = row.high ? 16 : 0;
    // TPDO1 sends the word, its two bytes and the double word.
    s.set_object(0x1800, 1, 0xC000'01FF, 4).set_object(0x1A00, 0, 0, 1);
    s.set_object(0x1A00, 1, (0xA100U + row.word_index) << 16 | row.word_sub << 8U | 16U, 4);
    s.set_object(0x1A00, 2, (0xA040U + row.byte_index) << 16 | row.byte_sub << 8U | 8U, 4);
    s.set_object(0x1A00, 3, (0xA040U + row.byte_index) << 16 | (row.byte_sub + 1U) << 8U | 8U, 4);
    s.set_object(0x1A00, 4, 0xA200'0000U | row.long_sub << 8U | 32U, 4);
    s.set_object(0x1A00, 0, 4, 1).set_object(0x1800, 1, 0x4000'01FF, 4).nmt(1).ignore_tx();
    s.write(row.legacy, 0xBEEF).expect(11000U + row.word, 0xBEEF).exchange();
    Bytes sent{0xEF, 0xBE, 0xEF, 0xBE, 0, 0, 0, 0};
    sent[4 + shift / 8] = 0xEF;
    sent[5 + shift / 8] = 0xBE;
    s.tx(0x1FF, sent);
    // An SDO write shows at both numbers.
    s.set_object(static_cast<std::uint16_t>(0xA580 + row.word_index), static_cast<std::uint8_t>(row.word_sub),
                 0x1234, 2);
    s.exchange().expect(10000U + row.word, 0x1234).expect(row.legacy, 0x1234);
    s.set_object(static_cast<std::uint16_t>(0xA4C0 + row.byte_index),
                 static_cast<std::uint8_t>(row.byte_sub + 1), 0x56, 1);
    s.exchange().expect(row.legacy, 0x5634);
    s.set_object(0xA680, static_cast<std::uint8_t>(row.long_sub), 0xCAFEU << shift, 4);
    s.exchange().expect(row.legacy, 0xCAFE).expect(11000U + row.word, 0xBEEF).ignore_tx();
  }
  BlockScenario s;
  s.power_on();
  for (const auto& [index, count] : std::vector<std::pair<std::uint16_t, std::uint32_t>>{
           {0xA000, 0xF0}, {0xA001, 0xF0}, {0xA002, 0xA0}, {0xA040, 0xF0}, {0xA042, 0xA0},
           {0xA0C0, 0x78}, {0xA0C2, 0x50}, {0xA100, 0x78}, {0xA101, 0x78}, {0xA102, 0x50},
           {0xA1C0, 0xA0}, {0xA200, 0xA0}, {0xA240, 0xA0}, {0xA480, 0xF0}, {0xA4C2, 0xA0},
           {0xA540, 0x78}, {0xA582, 0x50}, {0xA640, 0xA0}, {0xA680, 0xA0}, {0xA6C0, 0xA0}})
    s.expect_object(index, 0, count, 1);
  for (const std::uint16_t index : Words{0xA003, 0xA103, 0xA1C1, 0xA201, 0xA241, 0xA483, 0xA583, 0xA6C1})
    s.cif({0x0004, 0, index, 0}).expect_abort(0x06020000);
}

TEST(FxProcessData, InputVariablesAreReadOnly_OutputVariablesAreNot_AndEachHasItsDirection) {
  RecordProperty("spec", "FX3U-NV-001 FX3U-NV-002 FX3U-PDO-014");
  BlockScenario s;
  s.power_on();
  for (const std::uint16_t index : Words{0xA000, 0xA040, 0xA0C0, 0xA100, 0xA1C0, 0xA200, 0xA240}) {
    const std::uint16_t length = index < 0xA0C0 ? 1 : index < 0xA1C0 ? 2 : 4;
    s.cif({0x0002, 0, index, 1, length, 1, 0}).expect_abort(0x06010002);
    s.set_object(0x1400, 1, 0x8000'027F, 4).set_object(0x1600, 0, 0, 1);
    s.cif({0x0002, 0, 0x1600, 1, 4, static_cast<std::uint16_t>(0x0100 | 8 * length), index})
        .expect_abort(0x06040041);
  }
  for (const std::uint16_t index : Words{0xA480, 0xA4C0, 0xA540, 0xA580, 0xA640, 0xA680, 0xA6C0}) {
    const std::uint16_t length = index < 0xA540 ? 1 : index < 0xA640 ? 2 : 4;
    s.set_object(index, 1, 1, length).expect_object(index, 1, 1, length);
    s.set_object(0x1800, 1, 0xC000'01FF, 4).set_object(0x1A00, 0, 0, 1);
    s.cif({0x0002, 0, 0x1A00, 1, 4, static_cast<std::uint16_t>(0x0100 | 8 * length), index})
        .expect_abort(0x06040041);
  }
}

TEST(FxProcessData, EightyPdosEachWay) {
  RecordProperty("spec", "FX3U-SPEC-002 FX3U-SPEC-006 FX3U-D405-006 FX3U-COB-001 FX3U-PDO-015 FX3U-OD-003");
  BlockScenario s;
  s.power_on();
  for (const std::uint16_t index : Words{0x1450, 0x1650, 0x1850, 0x1A50})
    s.cif({0x0004, 0, index, 0}).expect_abort(0x06020000);
  for (const std::uint16_t index : Words{0x1400, 0x144F, 0x1800, 0x184F}) {
    s.expect_object(index, 0, 5, 1);
    s.cif({0x0004, 0, index, 4}).expect_abort(0x06090011);
  }
  for (unsigned pdo = 0; pdo < 80; ++pdo) {
    const auto at = [pdo](unsigned first) { return static_cast<std::uint16_t>(first + pdo); };
    const bool is_default = pdo < 4;
    s.expect_object(at(0x1400), 1, is_default ? 0x27F + 0x100 * pdo : 0x8000'0000, 4);
    s.expect_object(at(0x1800), 1, is_default ? 0x4000'01FF + 0x100 * pdo : 0xC000'0000, 4);
    s.expect_object(at(0x1400), 2, 0xFE, 1);
    s.expect_object(at(0x1800), 2, 0xFE, 1);
    for (const std::uint8_t sub : Bytes{3, 5}) {
      s.expect_object(at(0x1400), sub, 0, 2);
      s.expect_object(at(0x1800), sub, 0, 2);
    }
    s.expect_object(at(0x1600), 0, 4, 1);
    s.expect_object(at(0x1A00), 0, 4, 1);
    for (unsigned k = 1; k <= 4; ++k) {
      const std::uint32_t place = pdo / 30 << 16 | ((4 * pdo + k - 1) % 120 + 1) << 8 | 16;
      s.expect_object(at(0x1600), static_cast<std::uint8_t>(k), 0xA580'0000 + place, 4);
      s.expect_object(at(0x1A00), static_cast<std::uint8_t>(k), 0xA100'0000 + place, 4);
    }
    s.expect_object(at(0x1600), 8, 0, 4);
    s.expect_object(at(0x1A00), 8, 0, 4);
  }
  s.set_object(0x144F, 1, 0x333, 4).set_object(0x184F, 1, 0x4000'0344, 4).nmt(1).ignore_tx();
  s.rx(0x333, {1, 0, 2, 0, 3, 0, 4, 0})
      .write(11316, {5, 6, 7, 8})
      .exchange()
      .expect(10316, {1, 2, 3, 4})
      .expect(396, {1, 2, 3, 4});
  s.tx(0x344, {5, 0, 6, 0, 7, 0, 8, 0});
  s.rx_remote(0x344, 8).rx_remote(0x1FF, 8).no_tx();
  s.expect_object(0x1800, 1, 0x4000'01FF, 4);
  s.set_object(0x1805, 1, 0x8000'0000, 4).expect_object(0x1805, 1, 0xC000'0000, 4);
}

// S027
TEST(FxProcessData, AMappingIsChangedInTheManualsOrder_AndInNoOther) {
  RecordProperty("spec", "FX3U-PDO-001 FX3U-PDO-002 FX3U-PDO-014 FX3U-PDO-015");
  BlockScenario s;
  s.power_on();
  s.cif({0x0002, 0, 0x1A00, 1, 4, 0x0120, 0xA200});  // while the PDO is valid
  s.expect(1000, {0x000F, 0x0003});
  s.set_object(0x1800, 1, 0xC000'01FF, 4).set_object(0x1A00, 0, 0, 1).set_object(0x1A00, 1, 0xA200'0120, 4);
  s.set_object(0x1A00, 0, 1, 1).set_object(0x1800, 1, 0x4000'01FF, 4).nmt(1);
  s.write(11000, {0x5678, 0x1234}).exchange().tx(0x1FF, {0x78, 0x56, 0x34, 0x12});
  // More than 64 bits, an object that is none.
  s.set_object(0x1800, 1, 0xC000'01FF, 4).set_object(0x1A00, 0, 0, 1);
  s.set_object(0x1A00, 2, 0xA200'0220, 4).set_object(0x1A00, 3, 0xA100'0510, 4);
  s.cif({0x0002, 0, 0x1A00, 0, 1, 3}).expect_abort(0x06040042);
  s.cif({0x0002, 0, 0x1A00, 0, 1, 9});
  s.expect(1000, {0x000F, 0x0003});
  s.cif({0x0002, 0, 0x1A00, 1, 4, 0x0008, 0x1017}).expect_abort(0x06040041);
  // Bits 11 to 29 are 0, and there is no 29-bit identifier.
  for (const std::uint32_t bad : {0xC000'09FFU, 0xE000'01FFU, 0x8000'0A7FU}) {
    const std::uint16_t index = bad < 0xC000'0000U ? 0x1400 : 0x1800;
    s.cif({0x0002, 0, index, 1, 4, static_cast<std::uint16_t>(bad), static_cast<std::uint16_t>(bad >> 16)})
        .expect_abort(0x06090030);
  }
}

// S028 to S032: the manual's five cases of inhibit time and event timer.
TEST(FxProcessData, InhibitTimeAndEventTimer_FiveCases) {
  RecordProperty("spec",
                 "FX3U-PDO-008 FX3U-PDO-009 FX3U-PDO-010 FX3U-PDO-011 FX3U-PDO-012 FX3U-PDO-013 FX3U-DX-004");
  const Bytes a{1, 0, 0, 0, 0, 0, 0, 0}, b{2, 0, 0, 0, 0, 0, 0, 0}, c{3, 0, 0, 0, 0, 0, 0, 0};
  const auto start = [](BlockScenario& s, std::uint16_t inhibit, std::uint16_t event) {
    s.power_on().write(26, 0).set_object(0x1800, 1, 0xC000'01FF, 4);
    s.set_object(0x1800, 3, inhibit, 2).set_object(0x1800, 5, event, 2).set_object(0x1800, 1, 0x4000'01FF, 4);
    s.nmt(1).ignore_tx();
  };
  {
    SCOPED_TRACE("1: neither");
    BlockScenario s;
    start(s, 0, 0);
    s.write(0, 1).write(20, 1).advance(1ms).tx(0x1FF, a).write(20, 1).advance(1ms).no_tx();
    s.write(0, 2).advance(10s).no_tx();
  }
  {
    SCOPED_TRACE("2: inhibit time 50 ms");
    BlockScenario s;
    start(s, 500, 0);
    s.write(0, 1).write(20, 1).advance(1ms).tx(0x1FF, a).advance(9ms);
    s.write(0, 2).write(20, 1).advance(10ms).no_tx().write(0, 3).write(20, 1).advance(40ms).no_tx();
    s.write(20, 1).advance(1ms).tx(0x1FF, c).advance(89ms).write(20, 1).advance(1s).no_tx();
  }
  {
    SCOPED_TRACE("3: event timer 100 ms");
    BlockScenario s;
    start(s, 0, 100);
    s.advance(200ms).ignore_tx();
    s.write(0, 1).write(20, 1).advance(1ms).tx(0x1FF, a).advance(99ms).no_tx().advance(1ms).tx(0x1FF, a);
    s.advance(29ms).write(0, 2).write(20, 1).advance(1ms).tx(0x1FF, b).advance(99ms).no_tx();
    s.advance(1ms).tx(0x1FF, b);
  }
  {
    SCOPED_TRACE("4: inhibit time 50 ms, event timer 100 ms");
    BlockScenario s;
    start(s, 500, 100);
    s.advance(200ms).ignore_tx().advance(60ms).ignore_tx();
    s.write(0, 1).write(20, 1).advance(1ms).tx(0x1FF, a).advance(19ms);
    s.write(0, 2).write(20, 1).advance(80ms).no_tx().advance(2ms).tx(0x1FF, b);
  }
  {
    SCOPED_TRACE("5: inhibit time 200 ms, event timer 100 ms");
    BlockScenario s;
    start(s, 2000, 100);
    s.advance(1s)
        .ignore_tx()
        .nmt(0x80)
        .nmt(1)
        .ignore_tx()
        .advance(300ms)
        .ignore_tx()
        .nmt(0x80)
        .advance(300ms)
        .nmt(1);
    s.ignore_tx().write(0, 1).write(20, 1).advance(1ms).tx(0x1FF, a);
    s.advance(49ms).write(0, 2).write(20, 1).advance(100ms).no_tx().advance(52ms).tx(0x1FF, b);
  }
}

// S033
TEST(FxProcessData, SynchronousTpdos) {
  RecordProperty("spec", "FX3U-PDO-006 FX3U-PDO-007 FX3U-SYNC-005");
  const Bytes zero(8, 0), one{1, 0, 0, 0, 0, 0, 0, 0};
  for (const std::uint32_t type : {1U, 3U, 240U}) {
    BlockScenario s;
    s.power_on().set_object(0x1800, 2, type, 1).nmt(1).ignore_tx();
    for (std::uint32_t n = 1; n <= 2 * type; ++n) {
      s.rx(0x080);
      if (n % type == 0) s.tx(0x1FF, zero);
      s.no_tx();
    }
  }
  BlockScenario s;
  s.power_on().set_object(0x1800, 2, 0, 1).nmt(1).ignore_tx().rx(0x080).no_tx();
  s.write(0, 1).exchange().no_tx().rx(0x080).tx(0x1FF, one).rx(0x080).no_tx();
  s.exchange().rx(0x080).no_tx();
}

// S034
TEST(FxProcessData, SynchronousRpdos_TakeEffectAfterTheSync) {
  RecordProperty("spec", "FX3U-PDO-003 FX3U-PDO-004");
  for (const std::uint32_t type : {0U, 1U, 0xF0U}) {
    BlockScenario s;
    s.power_on()
        .set_object(0x1400, 2, type, 1)
        .set_object(0x1400, 3, 5000, 2)
        .expect_object(0x1400, 3, 5000, 2);
    s.nmt(1).ignore_tx();
    s.rx(0x27F, {0xAA, 0, 0, 0, 0, 0, 0, 0}).exchange().expect(10000, 0);
    s.rx(0x080).exchange().expect(10000, 0x00AA);
    s.rx(0x27F, {0xBB, 0, 0, 0, 0, 0, 0, 0})
        .rx(0x27F, {0xCC, 0, 0, 0, 0, 0, 0, 0})
        .rx(0x080)
        .exchange()
        .expect(10000, 0x00CC);
  }
  BlockScenario s;
  s.power_on_operational();
  for (const std::uint16_t reserved : Words{0xF1, 0xFC, 0xFD}) {
    s.cif({0x0002, 0, 0x1400, 2, 1, reserved}).expect_abort(0x06090030);
    s.cif({0x0002, 0, 0x1800, 2, 1, reserved}).expect_abort(0x06090030);
  }
}

// 5.6.5 prints FEH for 405 mode and FFH for 417 mode, 15.1.2 has both for the tool of 405 mode: "0x00 to 0xFF".
TEST(FxProcessData, BothEventDrivenTypes_AreThereInBothModes) {
  RecordProperty("spec", "FX3U-PDO-003 FX3U-PDO-008");
  for (const std::uint16_t mode : Words{405, 417}) {
    for (const std::uint32_t type : {0xFEU, 0xFFU}) {
      BlockScenario s;
      s.power_on().write(26, 0).write(21, mode).save().restart();
      s.set_object(0x1400, 1, 0x8000'0345, 4).set_object(0x1400, 2, type, 1).set_object(0x1400, 1, 0x345, 4);
      s.set_object(0x1800, 1, 0xC000'0346, 4).set_object(0x1800, 2, type, 1).set_object(0x1800, 1, 0x346, 4);
      s.expect_object(0x1400, 2, type, 1).expect_object(0x1800, 2, type, 1).nmt(1).ignore_tx();
      s.rx(0x345, {0x11, 0x22, 0, 0, 0, 0, 0, 0}).exchange().expect(10000, 0x2211);
      s.rx(0x080).no_tx().write(11000, 5).exchange().tx(0x346, {5, 0, 0, 0, 0, 0, 0, 0}).exchange().no_tx();
      for (const std::uint16_t reserved : Words{0xF1, 0xFD}) {
        s.cif({0x0002, 0, 0x1400, 2, 1, reserved}).expect_abort(0x06090030);
        s.cif({0x0002, 0, 0x1800, 2, 1, reserved}).expect_abort(0x06090030);
      }
    }
  }
}

// "Bit 30: fixed to OFF (0)", as bits 11 to 29 are [5.6.5, 5.6.13].
TEST(FxProcessData, Bit30_OfRpdosAndOfEmergencyConsumers_IsFixed) {
  RecordProperty("spec", "FX3U-PDO-002 FX3U-EMCY-005");
  BlockScenario s;
  s.power_on();
  const auto refused = [&](std::uint16_t index, std::uint16_t sub, std::uint32_t value) {
    s.cif({0x0002, 0, index, sub, 4, static_cast<std::uint16_t>(value),
           static_cast<std::uint16_t>(value >> 16)});
    s.expect_abort(0x0609'0030);
  };
  for (const std::uint32_t bit : {0x4000'0000U, 0xC000'0000U}) {
    refused(0x1400, 1, bit | 0x27F);
    refused(0x144F, 1, bit | 0x345);
    refused(0x1028, 1, bit | 0x081);
    refused(0x1028, 127, bit | 0x0FF);
  }
  s.expect_object(0x1400, 1, 0x27F, 4).expect_object(0x144F, 1, 0x8000'0000, 4);
  s.expect_object(0x1028, 1, 0x081, 4).expect_object(0x1028, 127, 0x0FF, 4);
  // Bit 30 of TPDOs is constantly ON.
  for (const std::uint16_t index : Words{0x1800, 0x184F}) {
    s.set_object(index, 1, 0x8000'0346, 4).expect_object(index, 1, 0xC000'0346, 4);
    s.set_object(index, 1, 0x0000'0346, 4).expect_object(index, 1, 0x4000'0346, 4);
    s.set_object(index, 1, 0x8000'0346, 4);
  }
}

// S037
TEST(FxProcessData, DummyEntries_SkipBytesOfAnRpdo) {
  RecordProperty("spec", "FX3U-OD-002 FX3U-PDO-016");
  BlockScenario s;
  s.power_on().set_object(0x1400, 1, 0x8000'027F, 4).set_object(0x1600, 0, 0, 1);
  s.set_object(0x1600, 1, 0x0005'0008, 4).set_object(0x1600, 2, 0xA4C0'0108, 4).set_object(0x1600, 0, 2, 1);
  s.set_object(0x1400, 1, 0x27F, 4)
      .nmt(1)
      .rx(0x27F, {0x11, 0x22})
      .exchange()
      .expect(10000, 0x0022)
      .ignore_tx();
  for (std::uint16_t index = 2; index <= 8; ++index) {
    s.cif({0x0004, 0, index, 0}).expect_abort(0x06020000);
    s.cif({0x0002, 0, index, 0, 1, 1}).expect_abort(0x06020000);
  }
}

TEST(FxProcessData, FramesOfAnotherLength_AreReported) {
  RecordProperty("spec", "FX3U-PDO-017");
  BlockScenario s;
  s.power_on_operational().rx(0x27F, {1, 2, 3}).exchange().expect(10000, 0);
  s.tx(0x0FF, {0x10, 0x82, 0x11, 0, 0, 0, 0, 0});
}

TEST(FxProcessData, Pdos_InOperationalOnly) {
  RecordProperty("spec", "FX3U-PDO-018 FX3U-NMT-004 FX3U-NMT-005 FX3U-NMT-006");
  BlockScenario s;
  s.power_on().rx(0x27F, {1, 2, 3, 4, 5, 6, 7, 8}).write(0, 1).write(20, 1).advance(1s).no_tx();
  s.nmt(1).tx(0x1FF, {1, 0, 0, 0, 0, 0, 0, 0}).expect(10000, 0);
  s.rx(0x67F, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}).tx(0x5FF, {0x43, 0x00, 0x10, 0, 0x95, 0x01, 0, 0});
  s.nmt(2).write(0, 2).write(20, 1).advance(1s).no_tx();
  s.rx(0x67F, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}).no_tx().expect(29, 0);
  s.nmt(0x80)
      .no_tx()
      .rx(0x67F, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0})
      .tx(0x5FF, {0x43, 0x00, 0x10, 0, 0x95, 0x01, 0, 0});
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_process_data_test
