// Start, settings, status and error words [FX2N-32CAN 3, 4].

#include <algorithm>

#include "canopus/module/interface/led.hpp"
#include "canopus/module/models/fx2n_32can/data_sheet.hpp"

#include "scenarios/fx2n_32can/scenario.hpp"

namespace canopus::scenario::fx2n_32can_start_up_test {
namespace {

module::LedPattern pattern_of(Fx2nScenario& s, std::string_view name) {
  for (const module::Led& led : s.plug_in().leds(s.now()))
    if (led.name == name) return led.pattern;
  ADD_FAILURE() << name;
  return module::LedPattern::off;
}

// S-01, S-02
TEST(Fx2nStart, ANewModule_HasTheFactorySettings) {
  RecordProperty(
      "spec",
      "FX2N-GEN-001 FX2N-GEN-006 FX2N-BAUD-001 FX2N-NODE-001 FX2N-WDT-001 FX2N-STAT-006 FX2N-GEN-011 "
      "FX2N-NODE-007");
  Fx2nScenario s;
  s.supply_on().expect(30, 7100).expect(25, 0);
  s.wait_bit(25, 0, true).tx(0x77F, {0x00});
  EXPECT_EQ(s.controller().rate, 10'000U);
  s.expect(24, 10).expect(26, 20).expect(27, 127).expect(29, 0).expect(25, 0x0101).expect(30, 7100);
  s.write(30, 1).expect(30, 7100).expect(29, 0);
  EXPECT_EQ(s.plug_in().signals(), nullptr);
  EXPECT_EQ(s.plug_in().buffer_memory_size(), 32768U);
}

// S-03
TEST(Fx2nStart, RateAndNode_CountFromARestartOn) {
  RecordProperty(
      "spec",
      "FX2N-BAUD-002 FX2N-BAUD-003 FX2N-NODE-002 FX2N-NODE-003 FX2N-NODE-004 FX2N-STAT-001 FX2N-STAT-004 "
      "FX2N-STAT-006");
  Fx2nScenario s;
  s.start().write(24, 125).write(27, 5).expect(27, 127).expect(24, 125);
  EXPECT_EQ(s.controller().rate, 10'000U);
  s.rx(0x67F, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}).tx(0x5FF, {0x43, 0x00, 0x10, 0, 0x95, 0x01, 0, 0});
  s.write(25, 1).expect_bit(25, 0, false).expect(25, 0);
  s.rx(0x67F, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}).no_tx();
  s.wait_bit(25, 0, true).tx(0x705, {0x00}).expect(24, 125).expect(27, 5).expect(25, 0x0101);
  EXPECT_EQ(s.controller().rate, 125'000U);
  s.rx(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}).tx(0x585, {0x43, 0x00, 0x10, 0, 0x95, 0x01, 0, 0});
  s.rx(0x67F, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}).no_tx();
}

TEST(Fx2nStart, OtherBitsOfTheStatusWord_DoNothing) {
  RecordProperty("spec", "FX2N-STAT-003 FX2N-STAT-005 FX2N-STAT-004");
  Fx2nScenario s;
  s.start();
  for (const std::uint16_t value : Words{0, 0xFFFE}) s.write(25, value).expect(25, 0x0101).no_tx();
  s.write(25, 0xFFFF).expect(25, 0).wait_bit(25, 0, true).tx(0x77F, {0x00});
}

// S-04, S-07
TEST(Fx2nStart, Settings_AreKeptWithoutASaveCommand) {
  RecordProperty(
      "spec",
      "FX2N-NODE-002 FX2N-NODE-006 FX2N-BAUD-005 FX2N-WDT-007 FX2N-WDT-008 FX2N-BKP-001 FX2N-BKP-002");
  Fx2nScenario s;
  s.start_operational(9).rx(0x209, {1, 2, 3, 4, 5, 6, 7, 8}).write(0, 1).write(20, 1).ignore_tx();
  s.expect(0, 0x0201).write(24, 500).write(26, 50).write(27, 3).supply_off().supply_on().wait_bit(25, 0,
                                                                                                  true);
  s.tx(0x703, {0x00}).expect(24, 500).expect(26, 50).expect(27, 3);
  EXPECT_EQ(s.controller().rate, 500'000U);
  s.write(26, 0).expect(0, Words(20, 0)).expect(100, Words(100, 0)).expect(1000, Words(67, 0)).expect(20, 0);
  s.nmt(1).write(20, 1).no_tx();  // nothing to send was left, either
  // The cell is written when its value changes, not at every write.
  const std::uint32_t writes = s.plug_in().flash_writes();
  s.write(24, 500).write(27, 3).write(0, 7);
  EXPECT_EQ(s.plug_in().flash_writes(), writes);
  s.write(24, 250);
  EXPECT_EQ(s.plug_in().flash_writes(), writes + 1);
}

// S-05, S-06
TEST(Fx2nStart, WrongRatesAndNodes_ChangeNothing) {
  RecordProperty(
      "spec",
      "FX2N-BAUD-004 FX2N-NODE-005 FX2N-ERR-009 FX2N-ERR-010 FX2N-ERR-001 FX2N-ERR-016 FX2N-GEN-005 "
      "FX2N-GEN-006");
  Fx2nScenario s;
  s.start().write(24, 125);
  const std::vector<std::uint16_t> rates{10, 20, 50, 125, 250, 500, 800, 1000};
  std::uint16_t last = 125;
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    const auto value = static_cast<std::uint16_t>(word);
    s.plug_in().write_word(24, value, s.now());
    const bool is_rate = std::ranges::find(rates, value) != rates.end();
    if (is_rate) last = value;
    ASSERT_EQ(s.read(29), is_rate ? 0 : 0x0800) << value;
    ASSERT_EQ(s.read(24), last) << value;
  }
  s.write(24, 100).expect(29, 0x0800).write(29, 0).expect(29, 0x0800).write(24, 250).expect(29, 0);
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    const auto value = static_cast<std::uint16_t>(word);
    s.plug_in().write_word(27, value, s.now());
    ASSERT_EQ(s.read(29), value >= 1 && value <= 127 ? 0 : 0x1000) << value;
    ASSERT_EQ(s.read(27), 127) << value;
  }
  s.write(27, 7).expect(29, 0).restart().expect(27, 7);
  s.write(27, 128).expect(29, 0x1000).restart().expect(27, 7).expect(29, 0).ignore_tx();
}

// S-08
TEST(Fx2nErrors, LatchedBits_StayUntilAZeroIsWritten) {
  RecordProperty(
      "spec", "FX2N-ERR-006 FX2N-ERR-012 FX2N-ERR-002 FX2N-ERR-001 FX2N-ERR-014 FX2N-ERR-015 FX2N-ERR-013");
  Fx2nScenario s;
  s.start_operational();
  s.controller().accepts = false;
  s.rx_remote(0x701).expect(29, 0x0100);
  s.controller().accepts = true;
  s.error_counters(128, 0).expect(29, 0x4100).error_counters(0, 0).expect(29, 0x4100);
  s.plug_in().inject(module::ModuleFault::power_error, s.now());
  s.expect(29, 0x4105).write(29, 0xFFFF).expect(29, 0x4105);
  s.write(29, 0xFEFF).expect(29, 0x4005).write(29, 0xFFFB).expect(29, 0x4000).write(29, 0).expect(29, 0);
  // All at once; a cause that is there brings its bit back.
  s.plug_in().inject(module::ModuleFault::power_error, s.now());
  s.error_counters(0, 130).expect(29, 0x4005).write(29, 0).expect(29, 0x4000);
  s.error_counters(0, 0).write(29, 0).expect(29, 0).no_tx();
}

// S-09
TEST(Fx2nErrors, BusOff_IsThereAsLongAsItLasts) {
  RecordProperty("spec", "FX2N-ERR-003 FX2N-ERR-001 FX2N-ERR-016 FX2N-DX-001");
  Fx2nScenario s;
  s.start_operational().expect(20, 1);
  s.error_counters(256, 0).expect(29, 0x0009).expect(20, 0).write(29, 0).expect(29, 0x0009);
  s.error_counters(0, 0).expect(29, 0).expect(20, 1).no_tx();
  s.error_counters(256, 0).expect(29, 0x0009);
  s.restart().expect(29, 0);
}

TEST(Fx2nErrors, DamagedSettings_AreTheFactorys_UntilGoodOnesAreFound) {
  RecordProperty("spec", "FX2N-ERR-004 FX2N-ERR-001 FX2N-BKP-001");
  RamMemory memory;
  FreeBus bus;
  {
    module::fx2n_32can::Fx2n32Can module(bus, memory);
    module.power_on({});
    module.tick(can::Time{2s});
    module.write_word(24, 500, can::Time{2s});
  }
  for (auto& [name, content] : memory.blobs)
    if (!content.bytes.empty()) content.bytes.back() ^= 0x55;
  module::fx2n_32can::Fx2n32Can module(bus, memory);
  module.power_on({});
  module.tick(can::Time{2s});
  EXPECT_EQ(module.program_read(29, can::Time{2s}), 0x0011);
  EXPECT_EQ(module.program_read(24, can::Time{2s}), 10);
  module.write_word(24, 125, can::Time{2s});
  module.write_word(25, 1, can::Time{2s});
  module.tick(can::Time{20s});
  EXPECT_EQ(module.program_read(29, can::Time{20s}), 0);
  EXPECT_EQ(module.program_read(24, can::Time{20s}), 125);
}

// S-25
TEST(Fx2nStart, TheState_FollowsNmtCommands) {
  RecordProperty("spec", "FX2N-STAT-002 FX2N-STAT-007 FX2N-GEN-003 FX2N-GEN-014");
  Fx2nScenario s;
  s.start(1).expect(25, 0x0101).nmt(1, 1).expect(25, 0x0201).nmt(2, 1).expect(25, 0x0001);
  s.nmt(0x80).expect(25, 0x0101).nmt(1, 2).expect(25, 0x0101).nmt(1).expect(25, 0x0201);
  s.nmt(0x81, 1).expect(25, 0).advance(10ms).tx(0x701, {0x00}).expect(25, 0x0101);
  s.nmt(1).nmt(0x82).advance(10ms).tx(0x701, {0x00}).expect(25, 0x0101);
  // The PLC's STOP is none of the module's business.
  s.nmt(1).cpu(module::CpuState::stop).expect(25, 0x0201).nmt(0x80).nmt(1).expect(25, 0x0201).no_tx();
}

TEST(Fx2nStart, TheOldStandards_HaveNoHeartbeat_NoLss_NoFlyingMaster) {
  RecordProperty("spec", "FX2N-GEN-003 FX2N-GEN-014");
  Fx2nScenario s;
  s.start();
  for (const std::uint16_t index : Words{0x1003, 0x1012, 0x1014, 0x1015, 0x1016, 0x1017, 0x1018, 0x1028,
                                         0x1029, 0x1F22, 0x1F84, 0x1F89, 0x1F90})
    s.cif({0x0004, 0, index, 0}).expect_abort(0x0602'0000);
  s.cif({0x0002, 0, 0x1F80, 0, 4, 0x0021, 0}).expect_abort(0x0609'0030);
  s.rx(0x7E5, {0x04, 0x01, 0, 0, 0, 0, 0, 0}).advance(10s).no_tx();
}

TEST(Fx2nStart, AnUnsavedDictionary_IsLostInARestart) {
  RecordProperty("spec", "FX2N-STAT-008 FX2N-BKP-003 FX2N-BKP-004 FX2N-SDO-010");
  Fx2nScenario s;
  s.start(5).set_object(0x1006, 0, 50'000, 4).restart().expect_object(0x1006, 0, 0, 4);
  s.cif({0x8200}).expect(1000, 0x8201);
  s.restart().expect_object(0x1402, 1, 0x8000'0000, 4);
  // 1010H keeps the mapping, over power off, too; 1011H brings the factory's back.
  s.cif({0x8200}).expect(1000, 0x8201);
  s.cif({0x0002, 0, 0x1010, 1, 4, 0x6173, 0x6576}).expect(1000, 0x0003);
  s.supply_off().supply_on().wait_bit(25, 0, true).ignore_tx();
  s.expect_object(0x1402, 1, 0x381, 4);
  s.cif({0x0002, 5, 0x1011, 1, 4, 0x6F6C, 0x6461}).expect(1000, 0x0003);
  s.restart().expect_object(0x1402, 1, 0x8000'0000, 4);
  s.cif({0x0002, 0, 0x1010, 1, 4, 1, 0}).expect(1000, {0x000F, 0x0003}).no_tx();
}

TEST(Fx2nStart, Leds) {
  RecordProperty("spec", "FX2N-LED-001 FX2N-LED-002 FX2N-LED-003 FX2N-LED-004 FX2N-LED-005");
  Fx2nScenario s;
  for (const std::string_view name : {"RUN", "FROM/TO", "Tx/Rx", "ERROR", "POWER"})
    EXPECT_EQ(pattern_of(s, name), module::LedPattern::off);
  s.start(5).advance(1s);
  EXPECT_EQ(pattern_of(s, "POWER"), module::LedPattern::on);
  EXPECT_EQ(pattern_of(s, "RUN"), module::LedPattern::off);
  EXPECT_EQ(pattern_of(s, "FROM/TO"), module::LedPattern::off);
  EXPECT_EQ(pattern_of(s, "Tx/Rx"), module::LedPattern::on) << "whether frames go or not";
  s.nmt(1).expect(30, 7100);
  EXPECT_EQ(pattern_of(s, "RUN"), module::LedPattern::on);
  EXPECT_EQ(pattern_of(s, "FROM/TO"), module::LedPattern::on);
  EXPECT_EQ(pattern_of(s, "ERROR"), module::LedPattern::off);
  s.write(24, 1);
  EXPECT_EQ(pattern_of(s, "ERROR"), module::LedPattern::off);
  s.error_counters(256, 0);
  EXPECT_EQ(pattern_of(s, "ERROR"), module::LedPattern::on);
  EXPECT_EQ(pattern_of(s, "Tx/Rx"), module::LedPattern::off);
}

TEST(Fx2nStart, WhatIsPhysical_IsInItsDataSheet) {
  RecordProperty(
      "spec", "FX2N-GEN-002 FX2N-GEN-007 FX2N-GEN-009 FX2N-GEN-010 FX2N-GEN-013 FX2N-GEN-003 FX2N-GEN-008");
  Fx2nScenario s;
  EXPECT_EQ(s.plug_in().points(), 8U);
  EXPECT_EQ(s.plug_in().model(), "FX2N-32CAN");
  const module::DataSheet& sheet = *module::fx2n_32can::model.data_sheet;
  EXPECT_EQ(sheet.standards[0].version, "3.0");
  EXPECT_EQ(sheet.standards[1].version, "2.0");
  EXPECT_EQ(sheet.standards[2].version, "1.0");
  EXPECT_EQ(sheet.modules_per_cpu[0].kind, "FX1N, FX2N, FX2NC");
  const auto has = [&](std::string_view name, std::string_view value) {
    return std::ranges::any_of(sheet.properties, [&](const module::Property& property) {
      return property.name == name && property.value.find(value) != std::string_view::npos;
    });
  };
  EXPECT_TRUE(has("Supply", "5 V DC 130 mA"));
  EXPECT_TRUE(has("Nodes per segment", "30 without repeaters, 127"));
}

}  // namespace
}  // namespace canopus::scenario::fx2n_32can_start_up_test
