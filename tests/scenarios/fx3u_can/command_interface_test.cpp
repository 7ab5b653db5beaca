// The command interface: SDO, emergency message, errors [FX3U-CAN 10].

#include "scenarios/fx3u_can/scenario.hpp"

namespace canopus::scenario::fx3u_can_command_interface_test {
namespace {

// S110
TEST(FxCommand, ReadsObjects_OfTheOwnNode_WithoutTheBus) {
  RecordProperty("spec", "FX3U-CIF-001 FX3U-OD-005 FX3U-OD-006 FX3U-SDO-005");
  BlockScenario s;
  s.power_on();
  for (const std::uint16_t own : Words{0, 127}) {
    s.cif({0x0004, own, 0x1018, 2}).expect(1000, {0x0005, own, 0x1018, 2, 4, 0x1C02, 0});
    s.cif({0x0004, own, 0x1008, 0}).expect(1004, {8, 0x5846, 0x5533, 0x432D, 0x4E41});
    s.cif({0x0004, own, 0x1009, 0}).expect(1004, 4);
    s.cif({0x0004, own, 0x100A, 0}).expect(1004, {4, 0x2E31, 0x3231});
    s.no_tx();
  }
  for (std::uint16_t i = 1; i <= 3; ++i)
    s.write(static_cast<module::BufferAddress>(1000 + i), Words{0, 0x1000, 0}[i - 1]);
  s.write(1000, 0x0004).expect(1000, 0xFFFF).advance(1ms).expect(1000, 0x0005);
}

TEST(FxCommand, WritesAndReadsAnotherNode) {
  RecordProperty("spec", "FX3U-CIF-001 FX3U-SDO-005");
  BlockScenario s;
  s.power_on().cif({0x0002, 9, 0x6200, 1, 1, 0x5A}).tx(0x609, {0x2F, 0x00, 0x62, 1, 0x5A, 0, 0, 0});
  s.expect(1000, 0xFFFF).rx(0x589, {0x60, 0x00, 0x62, 1, 0, 0, 0, 0}).expect(1000, {0x0003, 9, 0x6200, 1, 0});
  s.cif({0x0004, 9, 0x6000, 1}).tx(0x609, {0x40, 0x00, 0x60, 1, 0, 0, 0, 0});
  s.rx(0x589, {0x4F, 0x00, 0x60, 1, 0xA5, 0, 0, 0}).expect(1000, {0x0005, 9, 0x6000, 1, 1, 0x00A5, 0});
  // 124 bytes both ways, in segments; 125 do not fit.
  Words command{0x0002, 9, 0x2000, 0, 124};
  for (std::uint16_t i = 0; i < 62; ++i) command.push_back(i);
  s.cif(command).tx(0x609, {0x21, 0x00, 0x20, 0, 124, 0, 0, 0}).rx(0x589, {0x60, 0x00, 0x20, 0, 0, 0, 0, 0});
  for (unsigned segment = 0; segment < 18; ++segment) {
    const auto toggle = static_cast<std::uint8_t>(segment % 2 * 0x10);
    s.ignore_tx().rx(0x589, {static_cast<std::uint8_t>(0x20 | toggle), 0, 0, 0, 0, 0, 0, 0});
  }
  s.expect(1000, 0x0003);
  s.cif({0x0002, 9, 0x2000, 0, 125}).expect(1000, {0x000F, 0x0003, 9}).no_tx();
  s.cif({0x0004, 9, 0x2000, 0}).ignore_tx().rx(0x589, {0x41, 0x00, 0x20, 0, 125, 0, 0, 0}).ignore_tx();
  s.expect_abort(0x6060'0000, 9);
}

// S111, S112
TEST(FxCommand, MultipleAccesses_AndTheOnesThatFail) {
  RecordProperty("spec", "FX3U-CIF-009 FX3U-CIF-010");
  BlockScenario s;
  s.power_on();
  const auto record = [](Words& command, const Words& words) {
    command.insert(command.end(), words.begin(), words.end());
    command.resize((command.size() + 6) / 8 * 8 + 1);
  };
  Words read{0x0008};
  record(read, {0, 0x1000, 0});
  record(read, {0, 0x2000, 0});
  record(read, {0xFFFF});
  s.cif(read)
      .expect(1000, 0x00F9)
      .expect(1001, {0, 0x1000, 0, 4, 405, 0})
      .expect(1009, {0x0F00, 0x2000, 0, 0, 0, 0x0602});
  Words write{0x0006};
  record(write, {0, 0x1017, 0, 2, 100});
  record(write, {0, 0x1008, 0, 2, 1});
  record(write, {0xFFFF});
  s.cif(write)
      .expect(1000, 0x00F7)
      .expect(1009, 0x0F00)
      .expect(1013, {0x0002, 0x0601})
      .expect_object(0x1017, 0, 100, 2)
      .ignore_tx();
  Words all{0x0008};
  for (int i = 0; i < 8; ++i) record(all, {0, 0x1018, static_cast<std::uint16_t>(1 + i % 3)});
  s.cif(all).expect(1000, 0x0009).expect(1057, {0, 0x1018, 2, 4, 0x1C02, 0});
}

// S113
TEST(FxCommand, ASilentNode_EndsWithATimeOut) {
  RecordProperty("spec", "FX3U-SDO-002 FX3U-SDO-003 FX3U-CIF-007");
  BlockScenario s;
  s.power_on().cif({0x0004, 9, 0x1000, 0}).tx(0x609, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  s.advance(498ms).expect(1000, 0xFFFF).advance(2ms).expect_abort(0x0504'0000, 9).ignore_tx();
  s.write(71, 50).cif({0x0004, 9, 0x1000, 0}).advance(50ms).expect_abort(0x0504'0000, 9).ignore_tx();
  for (const std::uint16_t bad : Words{49, 32768})
    s.write(71, bad).expect(29, 0x0041).expect(39, 71).expect(71, 50).write(29, 0);
  s.write(71, 32767).expect(71, 32767).expect(29, 0);
}

// S114
TEST(FxCommand, WhileItRuns_AWriteLocksIt_AndFFFFhFreesIt) {
  RecordProperty("spec", "FX3U-CIF-002 FX3U-CIF-003 FX3U-CIF-004 FX3U-L2CIF-004");
  BlockScenario s;
  s.power_on().cif({0x0004, 9, 0x1000, 0}).write(1001, 1).expect(1000, {0x000F, 0xFFFF}).ignore_tx();
  s.advance(1s).write(1000, 0x0004).advance(1ms).expect(1000, {0x000F, 0xFFFF});
  s.write(1000, 0xFFFF).advance(1ms).expect(1000, 0).ignore_tx();
  s.cif({0x0004, 0, 0x1000, 0}).expect(1000, 0x0005);
  // Stopped while it runs.
  s.cif({0x0004, 9, 0x1000, 0})
      .expect(1000, 0xFFFF)
      .ignore_tx()
      .write(1000, 0xFFFF)
      .advance(1ms)
      .expect(1000, 0)
      .ignore_tx();
  s.cif({0x0004, 0, 0x1000, 0}).expect(1000, 0x0005).no_tx();
}

// S115
TEST(FxCommand, UnknownCodes_AndThoseOfOtherModes) {
  RecordProperty("spec", "FX3U-CIF-005 FX3U-MODE-008 FX3U-L2CIF-005 FX3U-L2CIF-006");
  const Words canopen{0x0002, 0x0004, 0x0006, 0x0008, 0x000A, 0x6000, 0x6010,
                      0x7400, 0x7410, 0x8200, 0x8300, 0x8400, 0x8900};
  for (const std::uint16_t mode : Words{405, 11, 29}) {
    BlockScenario s;
    mode == 405 ? s.power_on() : s.power_on_layer2(mode).online();
    const auto is_known = [&](std::uint16_t code) {
      if (code == 0 || code == 0xFFFF) return true;
      const bool of_canopen = std::ranges::find(canopen, code) != canopen.end();
      return mode == 405 ? of_canopen : code == 0x000C;
    };
    for (unsigned number = 0; number <= 0xFFFF; number += number < 0x100 ? 1 : 16) {
      const auto code = static_cast<std::uint16_t>(number);
      s.cif({code, 0xFFFF, 0xFFFF});
      const bool unknown = s.read(1000) == 0x000F && s.read(1001) == 0x0064;
      ASSERT_EQ(unknown, !is_known(code)) << std::hex << code << " mode " << std::dec << mode;
      s.ignore_tx();
    }
  }
}

// S116
TEST(FxCommand, DisplaysTheLastParameters) {
  RecordProperty("spec", "FX3U-CIF-006 FX3U-CIF-002 FX3U-L2CIF-007");
  BlockScenario s;
  s.power_on().cif({0x0004, 9, 0x1000, 0}).advance(500ms).expect_abort(0x0504'0000, 9).ignore_tx();
  s.write(1000, 0)
      .advance(1ms)
      .expect(1000, {0, 9, 0x1000, 0})
      .write(1001, 8)
      .expect(1000, {0, 8, 0x1000, 0});
}

// S061
TEST(FxCommand, SendsAnEmergencyMessage) {
  RecordProperty("spec",
                 "FX3U-EMCY-004 FX3U-EMCY-013 FX3U-EMCY-014 FX3U-EREG-001 FX3U-EREG-002 FX3U-EMCY-002");
  BlockScenario s;
  s.power_on().cif({0x000A, 0x1000, 0xA101, 0xA3A2, 0xA5A4}).expect(1000, {0x000B, 0});
  s.tx(0x0FF, {0x00, 0x10, 0x01, 0xA1, 0xA2, 0xA3, 0xA4, 0xA5}).expect_object(0x1003, 0, 1, 1);
  s.cif({0x0004, 0, 0x1003, 1}).expect(1005, 0x1000).expect_object(0x1001, 0, 1, 1);
  s.set_object(0x1015, 0, 10000, 2).cif({0x000A, 0x2000, 0x0001}).expect(1000, 0x000B).ignore_tx();
  s.cif({0x000A, 0x2100, 0x0001}).expect(1000, {0x000C, 1}).advance(900ms).no_tx();
  s.advance(200ms).cif({0x000A, 0x2100, 0x0001}).expect(1000, 0x000B).ignore_tx();
  s.nmt(2).advance(2s).cif({0x000A, 0x2200, 0x0001}).expect(1000, {0x000C, 2}).no_tx();
  s.nmt(1).ignore_tx().cif({0x000A, 0x2300, 0x0001}).expect(1000, 0x000B).ignore_tx();
}

// S062
TEST(FxCommand, TheHistory_IsClearedByZeroAlone) {
  RecordProperty("spec", "FX3U-EREG-003 FX3U-EREG-004 FX3U-EMCY-014");
  BlockScenario s;
  s.power_on();
  for (std::uint16_t n = 1; n <= 17; ++n)
    s.cif({0x000A, static_cast<std::uint16_t>(0x1000 + n), 0x0081}).ignore_tx();
  s.expect_object(0x1003, 0, 15, 1).expect_object(0x1001, 0, 0x81, 1);
  for (std::uint16_t sub = 1; sub <= 15; ++sub)
    s.cif({0x0004, 0, 0x1003, sub}).expect(1005, static_cast<std::uint16_t>(0x1012 - sub));
  s.cif({0x0002, 0, 0x1003, 0, 1, 1}).expect_abort(0x0609'0030);
  s.set_object(0x1003, 0, 0, 1).expect_object(0x1003, 0, 0, 1).expect_object(0x1001, 0, 0, 1);
}

TEST(FxCommand, AccessRightsOfObjects) {
  RecordProperty("spec",
                 "FX3U-OD-008 FX3U-EMCY-003 FX3U-NMT-016 FX3U-OD-007 FX3U-OD-001 FX3U-STO-002 FX3U-EB-005");
  BlockScenario s;
  s.power_on();
  for (const std::uint16_t index : Words{0x1000, 0x1001, 0x1008, 0x1014, 0x102A})
    s.cif({0x0002, 0, index, 0, 4, 1, 0}).expect(1000, {0x000F, 0x0003}).expect(1003, {0x0002, 0x0601});
  s.cif({0x0004, 0, 0x1F25, 1}).expect_abort(0x0601'0001);
  s.cif({0x0004, 0, 0x1F82, 0x80}).expect_abort(0x0601'0001);
  s.cif({0x0004, 0, 0x1F83, 0x80}).expect_abort(0x0601'0001);
  s.expect_object(0x102A, 0, 0, 2).expect_object(0x1010, 1, 1, 4).expect_object(0x1011, 1, 1, 4);
  for (const std::uint16_t index :
       Words{0x0001, 0x0009, 0x009F, 0x0FFF, 0x1002, 0x1007, 0x100B, 0x1013, 0x1019, 0x1200, 0x1280,
             0x1F23, 0x1F8A, 0x2000, 0x5FFF, 0x6000, 0x9FFF, 0xA6C1, 0xAFFF, 0xB000, 0xFFFF})
    s.cif({0x0004, 0, index, 0}).expect_abort(0x0602'0000);
  s.cif({0x0002, 0, 0x1029, 1, 1, 3}).expect_abort(0x0609'0030);
}

TEST(FxCommand, BusOff_EndsCommands) {
  RecordProperty("spec", "FX3U-ERR-005 FX3U-CNT-001 FX3U-CNT-002 FX3U-L2CIF-008 FX3U-L2-029");
  for (const std::uint16_t mode : Words{405, 11}) {
    BlockScenario s;
    mode == 405 ? s.power_on_operational() : s.power_on_layer2(mode).online();
    s.ignore_tx().error_counters(95, 95).expect(35, {95, 95}).expect_bit(25, 1, false);
    s.error_counters(96, 0)
        .expect_bit(25, 1, true)
        .error_counters(0, 127)
        .expect_bit(25, 1, true)
        .expect(29, 0);
    s.error_counters(128, 0)
        .expect_bit(25, 1, false)
        .expect(29, 1U << 14)
        .ignore_tx()
        .error_counters(127, 0)
        .expect(29, 0);
    s.error_counters(0, 135).expect(36, 128).error_counters(0, 0).ignore_tx();
    s.error_counters(256, 0).expect(35, {256, 256}).expect(29, 0x0009).expect_bit(25, 1, false);
    s.cif(mode == 405 ? Words{0x0004, 9, 0x1000, 0} : Words{0x000C, 1, 0, 0, 0})
        .expect(1000, {0x000F, 0xB0FF});
  }
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_command_interface_test
