// Start, configuration words, saving, restart [FX3U-CAN 6.1, 6.5 to 6.10, 6.15 to 6.18, 14.2].

#include "scenarios/fx3u_can/scenario.hpp"

namespace canopus::scenario::fx3u_can_start_up_test {
namespace {

// S001
TEST(FxStartUp, FactoryPowerUp) {
  RecordProperty(
      "spec",
      "FX3U-SPEC-001 FX3U-SPEC-011 FX3U-MODE-001 FX3U-BFM-006 FX3U-BAUD-001 FX3U-NODE-001 FX3U-DISP-001 "
      "FX3U-DISP-002 FX3U-NMT-001 FX3U-COM-003 FX3U-COM-004 FX3U-WDT-001 FX3U-TIME-012");
  BlockScenario s;
  s.supply_on().expect(25, 1U << 7).wait_bit(25, 7, false).tx(0x77F, {0x00}).no_tx();
  s.expect(20, {0, 405, 0}).expect(24, 250).expect(26, 20).expect(27, 127).expect(30, 7170);
  s.expect(35, {0, 0, 2500, 875, 0, 0}).expect(25, 0x0100).expect(29, 0);
  s.expect(50, {1, 12, 3, 1, 0, 0, 0, 4, 0, 0}).expect(70, {500, 500});
  s.expect(601, Words(126, 0)).expect(727, 0x7F);
  s.expect_object(0x1000, 0, 405, 4);
  s.expect_object(0x1018, 1, 0x71, 4);
  s.expect_object(0x1018, 2, 7170, 4);
  s.cif({0x0004, 0, 0x1008, 0}).expect(1000, {0x0005, 0, 0x1008, 0, 8, 0x5846, 0x5533, 0x432D, 0x4E41});
  s.write(30, 1).expect(30, 7170).expect(29, 0);
}

// S003
TEST(FxStartUp, NodeIdAndBitRate_CountAfterSaveAndRestart) {
  RecordProperty("spec",
                 "FX3U-SPEC-004 FX3U-BAUD-002 FX3U-BAUD-004 FX3U-NODE-002 FX3U-NODE-005 FX3U-COM-004");
  for (const bool saves : {true, false}) {
    BlockScenario s;
    s.power_on().write(27, 5).write(24, 500).expect(37, 2500).expect(27, 5).expect(24, 500);
    s.rx_remote(0x77F).advance(1ms).expect(727, 0x7F).ignore_tx();
    if (saves) s.save();
    s.expect(37, 2500).write(25, 1).ignore_tx().wait_bit(25, 7, false);
    s.tx(saves ? 0x705 : 0x77F, {0x00}).expect(37, saves ? 5000 : 2500);
    s.expect(24, saves ? 500 : 250).expect(27, saves ? 5 : 127).expect(saves ? 605 : 727, 0x7F);
    EXPECT_EQ(s.controller().rate, saves ? 500'000U : 250'000U);
    const std::uint32_t node = saves ? 5 : 127;
    s.expect_object(0x1014, 0, 0x80 + node, 4);
    s.expect_object(0x1400, 1, 0x200 + node, 4);
    s.expect_object(0x1403, 1, 0x500 + node, 4);
    s.expect_object(0x1800, 1, 0x4000'0180 + node, 4);
    s.expect_object(0x1803, 1, 0x4000'0480 + node, 4);
    s.expect_object(0x1F90, 6, 4000 + 10 * node, 2);
  }
}

TEST(FxStartUp, EveryBitRateAndNodeId_IsTaken) {
  RecordProperty("spec", "FX3U-SPEC-004 FX3U-SPEC-005 FX3U-DISP-001");
  for (const std::uint16_t rate : Words{10, 20, 50, 100, 125, 250, 500, 800, 1000}) {
    BlockScenario s;
    s.power_on().write(24, rate).expect(24, rate).expect(29, 0).save().restart();
    s.expect(37, static_cast<std::uint16_t>(10 * rate));
    EXPECT_EQ(s.controller().rate, rate * 1000U);
  }
  BlockScenario s;
  s.power_on();
  for (std::uint16_t node = 1; node <= 127; ++node) s.write(27, node).expect(27, node).expect(29, 0);
}

// S005; a mode is in force after save and restart.
TEST(FxStartUp, FunctionMode_OfTheManualOnly) {
  RecordProperty("spec", "FX3U-SPEC-012 FX3U-BFM-004 FX3U-MODE-003 FX3U-MODE-004");
  BlockScenario s;
  s.power_on().write(21, 1).expect(29, 0x0041).expect(39, 21).expect(21, 405);
  s.write(71, 49).expect(39, 21).expect(71, 500);
  s.write(29, 0).expect(29, 0).expect(39, 0);
  s.write(21, 11).expect(21, 11);
  EXPECT_EQ(s.plug_in().layer2_state(), module::Layer2State::inactive);
  s.restart().expect(21, 405);
  s.write(21, 11).save();
  EXPECT_EQ(s.plug_in().layer2_state(), module::Layer2State::inactive);
  s.restart().expect(21, 11);
  EXPECT_EQ(s.plug_in().layer2_state(), module::Layer2State::offline);
}

// S006, S007
TEST(FxStartUp, BadBitRate_AndBadNodeId_KeepTheFormerValue_UntilAGoodOneComes) {
  RecordProperty("spec", "FX3U-BAUD-003 FX3U-NODE-003 FX3U-ERR-003");
  BlockScenario s;
  s.power_on().write(24, 300).expect(24, 250).expect(29, 1U << 11 | 1U).expect(39, 0);
  s.write(29, 0).expect(29, 1U << 11 | 1U);  // not latched: it follows its cause
  s.write(24, 500).expect(29, 0).expect(24, 500);
  for (const std::uint16_t bad : Words{0, 128, 0xFFFF}) {
    s.write(27, bad).expect(27, 127).expect(29, 1U << 12 | 1U << 6 | 1U).expect(39, 27);
    s.write(29, 0).expect(29, 1U << 12 | 1U).expect(39, 0);
    s.write(27, 127).expect(29, 0);
  }
}

TEST(FxStartUp, NodeId_InALayer2Mode_IsASettingError) {
  RecordProperty("spec", "FX3U-NODE-004 FX3U-MODE-010 FX3U-L2-004");
  BlockScenario s;
  s.power_on_layer2();
  s.write(27, 5).expect_bit(29, 6, true).expect(39, 27);
  s.write(29, 0);
  for (const module::BufferAddress address : {0U, 19U, 50U, 59U, 70U, 71U, 601U, 750U, 859U, 900U, 963U,
                                              3000U, 3539U, 10000U, 10319U, 11000U, 11319U, 12000U, 13000U}) {
    s.write(address, 1).expect(address, 0);
  }
  s.expect(39, 0);
}

// S008
TEST(FxStartUp, WritesWhileItInitializes_HaveNoEffect_AndTheFirstIsShown) {
  RecordProperty("spec", "FX3U-BFM-003 FX3U-BFM-005 FX3U-ERR-002");
  BlockScenario s;
  s.power_on().write(25, 1).expect_bit(25, 7, true).write(27, 3).write(24, 500).wait_bit(25, 7, false);
  s.ignore_tx().expect(29, 0x0021).expect(40, 27).expect(27, 127).expect(24, 250);
  s.write(29, 0x0001 | 1U << 6).expect(29, 0).expect(40, 0);  // bit 5 alone
}

// S009
TEST(FxStartUp, SaveAndRestore_OfWords) {
  RecordProperty("spec", "FX3U-SAVE-001 FX3U-SAVE-003 FX3U-SAVE-004");
  BlockScenario s;
  s.power_on().write(26, 50).save();
  s.save(2).expect(26, 20).restart().expect(26, 50);
  s.write(27, 9).save().restart().expect(27, 9);
  s.save(3).restart().expect(26, 20).expect(27, 127).expect(21, 405).expect(24, 250);

  s.write(24, 500).write(26, 7).write(27, 8).write(70, 701).write(71, 702).write(50, 2).write(59, 11);
  s.write(51, 30).write(58, 3).write(0, 1).save().restart();
  s.expect(24, 500).expect(26, 7).expect(27, 8).expect(59, 11).expect(70, {701, 702});
  s.expect(50, 1).expect(51, 12).expect(58, 0).expect(11000, 0);
}

// The object dictionary has its own way.
TEST(FxStartUp, SavingWords_LeavesObjectsAlone) {
  RecordProperty("spec", "FX3U-SAVE-005");
  BlockScenario s;
  s.power_on().set_object(0x1017, 0, 200, 2).save().restart();
  s.expect_object(0x1017, 0, 0, 2);
  s.set_object(0x1017, 0, 200, 2).store_objects().save(3).restart();
  s.expect_object(0x1017, 0, 200, 2);
}

TEST(FxStartUp, PowerCutWhileSaving_IsAFlashError) {
  RecordProperty("spec", "FX3U-SAVE-006");
  BlockScenario s;
  s.power_on().write(26, 50).write(22, 1).advance(1ms);
  s.supply_off()
      .supply_on()
      .wait_bit(25, 7, false)
      .ignore_tx()
      .expect_bit(29, 4, true)
      .expect_bit(29, 0, true);
}

// S010
TEST(FxStartUp, Restart_LosesWhatIsNotSaved_AndSaysSo) {
  RecordProperty("spec", "FX3U-COM-001 FX3U-EMCY-012");
  BlockScenario s;
  s.power_on().set_object(0x1017, 0, 200, 2).ignore_tx();
  s.write(25, 1).tx(0x0FF, {0x00, 0x62, 0x01, '4', '0', '0', 'X', 'F'}).expect_bit(25, 7, true).no_tx();
  s.wait_bit(25, 7, false).tx(0x77F, {0x00}).expect_object(0x1017, 0, 0, 2);
}

// S011
TEST(FxStartUp, NmtReset_IsShownUntilTheProgramTakesNote) {
  RecordProperty("spec", "FX3U-COM-005 FX3U-NMT-008 FX3U-BFM-002");
  for (const std::uint8_t command : Bytes{0x82, 0x81}) {
    BlockScenario s;
    s.power_on().set_object(0x1017, 0, 5000, 2).set_object(0x1015, 0, 30, 2).ignore_tx();
    s.nmt(command, 127).expect_bit(25, 6, false).expect_bit(25, 7, true);
    s.wait_bit(25, 7, false).tx(0x77F, {0x00}).expect(25, 0x0140);
    s.expect_object(0x1017, 0, 0, 2);
    s.write(25, 0).expect(25, 0x0100);
    s.nmt(command, 127).wait_bit(25, 6, true).ignore_tx().nmt(command, 127).expect_bit(25, 6, false);
  }
}

// S013, and no way by signals.
TEST(FxStartUp, HasNoSignals_AndReservedNumbersReadZero) {
  RecordProperty("spec", "FX3U-SPEC-008 FX3U-BFM-001");
  BlockScenario s;
  s.power_on();
  EXPECT_EQ(s.plug_in().signals(), nullptr);
  EXPECT_EQ(s.plug_in().points(), 8U);
  EXPECT_EQ(s.plug_in().buffer_memory_size(), 32768U);
  for (const auto& [first, last] : std::vector<std::pair<unsigned, unsigned>>{{23, 23},
                                                                              {28, 28},
                                                                              {31, 34},
                                                                              {41, 49},
                                                                              {60, 69},
                                                                              {72, 99},
                                                                              {400, 400},
                                                                              {443, 600},
                                                                              {728, 749},
                                                                              {860, 899},
                                                                              {964, 999},
                                                                              {1067, 1899},
                                                                              {1928, 2999},
                                                                              {3540, 9999},
                                                                              {10320, 10999},
                                                                              {11320, 11999},
                                                                              {13540, 32767}}) {
    for (unsigned address = first; address <= last; ++address) s.write(address, 0x1234).expect(address, 0);
  }
  s.expect(29, 0).no_tx();
}

TEST(FxStartUp, ReservedBits_StayZero) {
  RecordProperty("spec", "FX3U-BFM-002");
  BlockScenario s;
  s.power_on().write(22, 0xFFFC).expect(22, 0).advance(1s).write(25, 0x0F2C).expect(25, 0x0100);
  s.write(20, 0xECFE).expect(20, 0).expect(29, 0).no_tx();
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_start_up_test
