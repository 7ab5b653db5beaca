// Identifiers, SDO server, values of two words, queues, flash memory, deadlines of RPDOs [FX3U-CAN 1.1.2, 5.6, 6, 14.2].

#include "canopus/module/interface/data_sheet.hpp"

#include "scenarios/fx3u_can/scenario.hpp"

namespace canopus::scenario::fx3u_can_data_corners_test {
namespace {

TEST(FxProcessData, RestrictedIdentifiers_AreRefused) {
  RecordProperty("spec", "FX3U-COB-002 FX3U-PDO-002 FX3U-EMCY-005");
  BlockScenario s;
  s.power_on();
  const auto refused = [&](std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
    s.cif({0x0002, 0, index, sub, 4, static_cast<std::uint16_t>(value),
           static_cast<std::uint16_t>(value >> 16)});
    s.expect_abort(0x0609'0030);
  };
  const Words restricted{0x000, 0x001, 0x07F, 0x101, 0x180, 0x581, 0x5FF, 0x601,
                         0x67F, 0x6E0, 0x6FF, 0x701, 0x77F, 0x780, 0x7FF};
  s.set_object(0x1012, 0, 0x100, 4);
  for (const std::uint32_t id : restricted) {
    SCOPED_TRACE(id);
    refused(0x1404, 1, id);
    refused(0x1804, 1, 0x4000'0000 | id);
    refused(0x1005, 0, id);
    refused(0x1012, 0, 0x8000'0000 | id);
    refused(0x1028, 5, id);
  }
  for (const std::uint16_t index : Words{0x1404, 0x1804}) {
    for (const std::uint32_t id : {0x080U, 0x100U, 0x181U, 0x580U, 0x600U, 0x680U, 0x6DFU, 0x700U})
      s.set_object(index, 1, 0x4000'0000U * (index == 0x1804) | id, 4)
          .set_object(index, 1, 0x8000'0000U | id, 4);
  }
  s.no_tx();
}

// S035, of the first PDO and the last one.
TEST(FxEmergency, AnRpdoThatStaysAway_IsReported_WithItsNumberAndText) {
  RecordProperty("spec", "FX3U-PDO-005 FX3U-EMCY-001");
  for (const std::uint8_t number : Bytes{1, 80}) {
    BlockScenario s;
    const auto index = static_cast<std::uint16_t>(0x1400 + number - 1);
    s.power_on()
        .set_object(index, 1, 0x8000'0345, 4)
        .set_object(index, 5, 100, 2)
        .set_object(index, 1, 0x345, 4);
    s.nmt(1).ignore_tx().advance(1s).no_tx();  // not before the first one
    s.rx(0x345, {1, 2, 3, 4, 5, 6, 7, 8}).advance(99ms).no_tx();
    s.rx(0x345, {1, 2, 3, 4, 5, 6, 7, 8}).advance(99ms).no_tx().advance(1ms);
    s.tx(0x0FF, {0x50, 0x82, 0x11, number, 0, 'O', 'D', 'P'}).advance(10s).no_tx();  // once
    s.cif({0x0004, 0, 0x1003, 1}).expect(1005, {0x8250, number});
    s.rx(0x345, {1, 2, 3, 4, 5, 6, 7, 8}).tx(0x0FF, {0, 0, 0, 0, 0, 0, 0, 0});
    s.set_object(index, 5, 0, 2).rx(0x345, {1, 2, 3, 4, 5, 6, 7, 8}).advance(10s).no_tx();
    // Synchronous ones are not watched.
    s.set_object(index, 5, 100, 2).set_object(index, 2, 1, 1).rx(0x345, {1, 2, 3, 4, 5, 6, 7, 8});
    s.advance(10s).no_tx();
  }
}

TEST(FxSdo, TheServer_AnswersInPreOperationalAndOperational_ValuesOfAnyLength) {
  RecordProperty("spec", "FX3U-SDO-001 FX3U-OD-005 FX3U-OD-007 FX3U-CM-001");
  BlockScenario s;
  s.power_on();
  for (const std::uint8_t command : Bytes{0x80, 0x01}) {
    s.nmt(command, 127)
        .rx(0x67F, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0})
        .tx(0x5FF, {0x41, 0x08, 0x10, 0, 8, 0, 0, 0});
    s.rx(0x67F, {0x60, 0, 0, 0, 0, 0, 0, 0}).tx(0x5FF, {0x00, 'F', 'X', '3', 'U', '-', 'C', 'A'});
    s.rx(0x67F, {0x70, 0, 0, 0, 0, 0, 0, 0}).tx(0x5FF, {0x1D, 'N', 0, 0, 0, 0, 0, 0});
    // One byte, two, four; 13 in segments: a concise DCF with one entry.
    s.rx(0x67F, {0x2F, 0x00, 0x18, 2, 0xFE, 0, 0, 0}).tx(0x5FF, {0x60, 0x00, 0x18, 2, 0, 0, 0, 0});
    s.rx(0x67F, {0x2B, 0x15, 0x10, 0, 0, 0, 0, 0}).tx(0x5FF, {0x60, 0x15, 0x10, 0, 0, 0, 0, 0});
    s.rx(0x67F, {0x23, 0x06, 0x10, 0, 0, 0, 0, 0}).tx(0x5FF, {0x60, 0x06, 0x10, 0, 0, 0, 0, 0});
    const std::uint8_t node = command == 0x80 ? 3 : 4;
    s.rx(0x67F, {0x21, 0x22, 0x1F, node, 13, 0, 0, 0}).tx(0x5FF, {0x60, 0x22, 0x1F, node, 0, 0, 0, 0});
    s.rx(0x67F, {0x00, 1, 0, 0, 0, 0x17, 0x10, 0}).tx(0x5FF, {0x20, 0, 0, 0, 0, 0, 0, 0});
    s.rx(0x67F, {0x13, 2, 0, 0, 0, 0xF4, 0x01, 0}).tx(0x5FF, {0x30, 0, 0, 0, 0, 0, 0, 0});
    // Nobody else's, and no other channel.
    s.rx(0x67E, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0}).rx(0x600, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0}).no_tx();
  }
  s.nmt(2, 127).rx(0x67F, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}).advance(10s).no_tx().expect(29, 0);
}

// Two words are two writes: what an exchange finds between them is sent, and nothing says so.
TEST(FxProcessData, AValueOfTwoWords_IsConsistentOnlyWhenBothAreWrittenBeforeTheExchange) {
  RecordProperty("spec", "FX3U-SPEC-009 FX3U-DX-004");
  BlockScenario s;
  s.power_on()
      .set_object(0x1800, 1, 0xC000'01FF, 4)
      .set_object(0x1A00, 0, 0, 1)
      .set_object(0x1A00, 1, 0xA200'0120, 4);
  s.set_object(0x1A00, 0, 1, 1).set_object(0x1800, 1, 0x4000'01FF, 4).nmt(1);
  s.write(11000, {0xFFFF, 0}).exchange().tx(0x1FF, {0xFF, 0xFF, 0, 0});
  s.write(11000, {0, 1}).exchange().tx(0x1FF, {0, 0, 1, 0});  // 0000FFFFH + 1
  s.write(11000, {0xFFFF, 0}).exchange().ignore_tx();
  s.write(11000, 0).exchange().tx(0x1FF, {0, 0, 0, 0}).write(11001, 1).exchange().tx(0x1FF, {0, 0, 1, 0});
  // Received: both words are of one message, whatever came since.
  s.set_object(0x1400, 1, 0x8000'027F, 4).set_object(0x1600, 0, 0, 1).set_object(0x1600, 1, 0xA680'0120, 4);
  s.set_object(0x1600, 0, 1, 1).set_object(0x1400, 1, 0x27F, 4).rx(0x27F, {0xFF, 0xFF, 0, 0}).exchange();
  s.expect(10000, 0xFFFF)
      .rx(0x27F, {0, 0, 1, 0})
      .expect(10001, 0)
      .exchange()
      .expect(10000, {0, 1})
      .expect(29, 0);
}

TEST(FxErrors, AQueueThatOverflows_IsReportedOnce_UntilItIsCleared) {
  RecordProperty("spec", "FX3U-ERR-010 FX3U-ERR-002 FX3U-ERR-001");
  BlockScenario s;
  s.power_on();
  for (const bool received : {false, true}) {
    (received ? s.controller().lost : s.controller().overflows) += 1;
    s.write(20, 0).tx(0x0FF, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0}).expect(29, 0x0101);
    (received ? s.controller().lost : s.controller().overflows) += 1;
    s.advance(10s).no_tx().write(29, 0xFFFF).expect(29, 0x0101).write(29, 0xFEFF).expect(29, 0);
  }
  // That its report finds no room either is the same overflow.
  s.controller().overflows += 1;
  s.controller().accepts = false;
  s.write(20, 0).expect(29, 0x0101);
  s.controller().accepts = true;
  s.advance(10s).write(29, 0).expect(29, 0).write(20, 0).expect(29, 0).no_tx();
  BlockScenario layer2;
  layer2.power_on_layer2().online();
  layer2.controller().lost = 1;
  layer2.write(20, 0).expect(29, 0x0101).no_tx().write(29, 0).expect(29, 0);
}

TEST(FxErrors, TheWarningLevel) {
  RecordProperty("spec", "FX3U-COM-006 FX3U-CNT-001 FX3U-CNT-002 FX3U-ERR-007");
  BlockScenario s;
  s.power_on();
  for (const bool transmits : {true, false}) {
    for (const auto& [counter, warning, passive] :
         std::vector<std::tuple<std::uint16_t, bool, bool>>{{0, false, false},
                                                            {95, false, false},
                                                            {96, true, false},
                                                            {127, true, false},
                                                            {128, false, true}}) {
      s.error_counters(transmits ? counter : 0, transmits ? 0 : counter);
      s.expect_bit(25, 1, warning)
          .expect_bit(29, 14, passive)
          .expect(transmits ? 35 : 36, counter)
          .ignore_tx();
    }
  }
  s.error_counters(0, 0).ignore_tx().error_counters(130, 100).tx(0x0FF, {0x20, 0x81, 0x11, 0, 0, 0, 0, 0});
  s.expect_bit(25, 1, false).error_counters(256, 0).expect_bit(25, 1, false).expect(35, {256, 256});
}

TEST(FxStartUp, TheFlashMemory_CountsItsWrites) {
  RecordProperty("spec", "FX3U-SPEC-013 FX3U-STO-003 FX3U-SAVE-003");
  BlockScenario s;
  s.power_on();
  EXPECT_EQ(s.plug_in().description().data_sheet->flash_writes, 10'000U);
  const auto writes = [&] { return s.plug_in().flash_writes(); };
  EXPECT_EQ(writes(), 0U);
  s.write(26, 50).write(70, 700).set_object(0x1017, 0, 100, 2).save(2).ignore_tx();
  EXPECT_EQ(writes(), 0U) << "in RAM only";
  s.save();
  EXPECT_EQ(writes(), 1U);
  s.store_objects();
  EXPECT_EQ(writes(), 2U);
  s.cif({0x0002, 0, 0x1F22, 3, 13, 1, 0, 0x1017, 0x0200, 0, 0xF400, 0x0001}).expect(1000, 0x0003);
  EXPECT_EQ(writes(), 3U) << "a concise DCF is stored at once";
  s.save(3);
  EXPECT_EQ(writes(), 4U);
  s.restart().advance(1min).ignore_tx();
  EXPECT_EQ(writes(), 4U);
}

// The manual advises Pre-operational; it does not forbid another state.
TEST(FxMapping, InOperational_ItIsCarriedOut_AndSendsNothingByItself) {
  RecordProperty("spec", "FX3U-MB-009 FX3U-MA-001 FX3U-M0-001");
  for (const std::uint16_t code : Words{0x8900, 0x8200, 0x8300}) {
    BlockScenario s;
    s.power_on_as(2).write(26, 0).nmt(1).write(11000, 5).exchange().ignore_tx();
    code == 0x8300 ? s.cif({code, 0, 0, 0xFFFF}) : s.cif({code});
    s.expect(1000, static_cast<std::uint16_t>(code + 1))
        .expect(25, 0x0201)
        .expect(11000, 0)
        .advance(1s)
        .no_tx();
    s.write(11000, 6).exchange().tx(0x182, {6, 0, 0, 0, 0, 0, 0, 0}).no_tx().expect(29, 0);
  }
}

TEST(FxProcessData, AFrameThatIsTooLong_IsTakenAsFarAsMapped_AndReported) {
  RecordProperty("spec", "FX3U-PDO-017");
  BlockScenario s;
  s.power_on()
      .set_object(0x1400, 1, 0x8000'027F, 4)
      .set_object(0x1600, 0, 0, 1)
      .set_object(0x1600, 1, 0xA580'0110, 4);
  s.set_object(0x1600, 0, 1, 1).set_object(0x1400, 1, 0x27F, 4).nmt(1).ignore_tx();
  s.rx(0x27F, {0x11, 0x22, 0x33})
      .tx(0x0FF, {0x20, 0x82, 0x11, 0, 0, 0, 0, 0})
      .exchange()
      .expect(10000, {0x2211, 0});
  s.rx(0x27F, {0x44, 0x55}).tx(0x0FF, {0, 0, 0, 0, 0, 0, 0, 0}).exchange().expect(10000, {0x5544, 0});
  s.rx(0x27F, {0x66})
      .tx(0x0FF, {0x10, 0x82, 0x11, 0, 0, 0, 0, 0})
      .exchange()
      .expect(10000, {0x5544, 0})
      .no_tx();
}

TEST(FxErrors, AHardwareError_StaysUntilTheSupplyIsOff_AndBusOffFollows1029h) {
  RecordProperty("spec", "FX3U-ERR-001 FX3U-ERR-003 FX3U-ERR-005 FX3U-EB-001 FX3U-EB-002 FX3U-EB-003");
  BlockScenario s;
  s.power_on();
  s.plug_in().inject(module::ModuleFault::hardware_error, s.now());
  s.expect(29, 0x0003)
      .write(29, 0)
      .expect(29, 0x0003)
      .supply_off()
      .supply_on()
      .wait_bit(25, 7, false)
      .expect(29, 0);
  s.ignore_tx();
  for (const std::uint32_t behaviour : {0U, 1U, 2U}) {
    BlockScenario off;
    off.power_on().set_object(0x1029, 1, behaviour, 1).nmt(1).ignore_tx().error_counters(256, 0).ignore_tx();
    off.expect(29, 0x0009).expect(25, behaviour == 0 ? 0x0100 : behaviour == 1 ? 0x0201 : 0);
  }
}

TEST(FxSetUp, OtherWordsThanSaveAndLoad_AreRefused) {
  RecordProperty("spec", "FX3U-STO-001 FX3U-STO-002 FX3U-STO-004");
  BlockScenario s;
  s.power_on().set_object(0x1017, 0, 100, 2).ignore_tx();
  for (const std::uint16_t index : Words{0x1010, 0x1011}) {
    for (const std::uint32_t word :
         {0U, 0x6576'6172U, 0x6461'6F6DU, index == 0x1010 ? 0x6461'6F6CU : 0x6576'6173U}) {
      s.cif(
          {0x0002, 0, index, 1, 4, static_cast<std::uint16_t>(word), static_cast<std::uint16_t>(word >> 16)});
      s.expect_abort(0x0800'0020);
    }
    s.expect_object(index, 1, 1, 4);
  }
  s.restart().expect_object(0x1017, 0, 0, 2);
}

// What is no setting of a Layer 2 mode is not touched by its save; the factory's are whole.
TEST(FxLayer2, ItsSave_LeavesTheOtherModesSettings_ButTheFactorysAreAll) {
  RecordProperty("spec", "FX3U-SAVE-002 FX3U-SAVE-004 FX3U-L2-016 FX3U-L2-017");
  for (const bool factory : {false, true}) {
    BlockScenario s;
    s.power_on().write(50, 2).write(59, 5).write(27, 9).write(70, 701).write(71, 601).save();
    s.write(21, 11).save().restart().write(26, 33).write(21, 405);
    s.save(factory ? 3 : 1)
        .restart()
        .expect(21, 405)
        .expect(26, factory ? 20 : 33)
        .expect(27, factory ? 127 : 9);
    s.expect(70, factory ? Words{500, 500} : Words{701, 601}).expect(59, factory ? 0 : 5);
  }
}

// 6.5: what 1010H has stored is deleted by the restart of a mode change; a Layer 2 mode has no objects to keep.
TEST(FxLayer2, AModeChange_DeletesTheStoredObjects) {
  RecordProperty("spec", "FX3U-MODE-003");
  for (const bool changes : {false, true}) {
    BlockScenario s;
    s.power_on().set_object(0x1017, 0, 200, 2).store_objects().write(21, 11);
    if (changes) s.save();
    s.restart().write(21, 405).save().restart().expect_object(0x1017, 0, changes ? 0 : 200, 2).ignore_tx();
  }
}

TEST(FxLayer2, OtherBitsOfTheExchange_DoNothing) {
  RecordProperty("spec", "FX3U-L2-014 FX3U-BFM-002");
  BlockScenario s;
  s.power_on_layer2()
      .write(26, 0)
      .write(1100, {0xFFFF, 0x5FFF, 0, 0})
      .write(100, {0x123, 0, 1})
      .online()
      .ignore_tx();
  s.write(20, 0xFFFE)
      .expect(20, 0)
      .advance(1s)
      .no_tx()
      .expect(29, 0)
      .write(20, 0xFFFF)
      .expect(20, 1)
      .advance(1ms);
  s.tx(0x123, {0}).expect(20, 0);
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_data_corners_test
