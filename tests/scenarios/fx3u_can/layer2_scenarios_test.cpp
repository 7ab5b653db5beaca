// spec/fx3u-can/scenarios-417-l2.md, G to I: the Layer 2 modes as a program uses them [FX3U-CAN 9].

#include "scenarios/fx3u_can/layer2_slots.hpp"

namespace canopus::scenario::fx3u_can_layer2_scenarios_test {
namespace {

/// READY-L2.
void ready(BlockScenario& s, std::uint16_t mode = 11) { s.power_on_layer2(mode).write(26, 0).expect(29, 0); }

TEST(FxLayer2Scenarios, TL2_01_Activate_ConfigureGoOnlineAndExchange) {
  RecordProperty("spec", "FX3U-L2-001 FX3U-L2-002 FX3U-L2-005 FX3U-L2-007 FX3U-MODE-003 FX3U-L2TX-001");
  for (const BlockForm& form : block_forms) {
    BlockScenario s;
    s.power_on().write(21, form.mode).write(24, 250).write(26, 0).save();
    s.write(25, 1)
        .ignore_tx()
        .wait_bit(25, 7, false)
        .expect(25, 0)
        .expect(21, form.mode)
        .no_tx();  // no boot-up
    EXPECT_EQ(s.plug_in().leds(s.now())[0].pattern, module::LedPattern::off);
    // TL2-02
    s.write(100, {0x0123, 0, 0x0003})
        .write(1100, {0xFFFF, 0x5FFF, 0, 0})
        .write(25, 0x0010)
        .expect(25, 0x0011);
    EXPECT_EQ(s.plug_in().leds(s.now())[0].pattern, module::LedPattern::on);
    s.no_tx().write(103, {0x2211, 0x0033}).exchange().tx(data(form, 0x123, {0x11, 0x22, 0x33}));
    s.exchange().tx(data(form, 0x123, {0x11, 0x22, 0x33})).no_tx();
  }
}

// The manual says nothing of it; the RJ71CN91 sends each slot once. This module sends when it is asked to.
TEST(FxLayer2Scenarios, GoingOnline_SendsNothingByItself) {
  RecordProperty("spec", "FX3U-L2TX-015 FX3U-L2TX-002 FX3U-L2TX-003 FX3U-L2TX-006");
  for (const BlockForm& form : block_forms) {
    BlockScenario s;
    ready(s, form.mode);
    for (std::uint16_t type = 0; type <= 4; ++type)
      send_slot(s, type + 1U, 0x100U + type, 0x5FFF, type, 1, 10);
    s.online()
        .no_tx()
        .advance(99ms)
        .no_tx()
        .advance(1ms)
        .tx(data(form, 0x102, {0}))
        .no_tx();  // the cyclic one
    // TL2-03: a change is one against what was sent last.
    s.offline().ignore_tx().online();
    s.write(bfm_block(2) + 3, 0x11)
        .exchange()
        .tx(data(form, 0x100, {0}))
        .tx(data(form, 0x101, {0x11}))
        .tx(data(form, 0x102, {0}))
        .no_tx();
    s.exchange().tx(data(form, 0x100, {0})).tx(data(form, 0x102, {0})).no_tx();
    s.write(bfm_block(2) + 3, 0x12).exchange();
    s.tx(data(form, 0x100, {0})).tx(data(form, 0x101, {0x12})).tx(data(form, 0x102, {0})).no_tx();
  }
}

// The table of 9.3.1 counts in 10 ms; "if cycle time is set to K0, cycle time operates as 1 ms".
TEST(FxLayer2Scenarios, TL2_04_Cycles_OfTenMilliseconds_AndTheSmallest) {
  RecordProperty("spec", "FX3U-L2TX-003 FX3U-L2TX-004 FX3U-L2TX-006 FX3U-L2TX-007");
  const BlockForm& form = block_forms[0];
  for (const std::uint16_t cycle : Words{0, 1, 10, 65535}) {
    BlockScenario s;
    ready(s);
    send_slot(s, 1, 0x123, 0x5FFF, 2, 1, cycle);
    const auto period = std::chrono::milliseconds(cycle == 0 ? 1 : 10 * cycle);
    s.online().no_tx().expect(1103, cycle);
    for (int i = 0; i < 5; ++i)
      s.advance(period - 1us).no_tx().advance(1us).tx(data(form, 0x123, {0})).no_tx();
    s.write(103, 7)
        .advance(period)
        .tx(data(form, 0x123, {0}))
        .no_tx()
        .expect(1103, cycle);  // not yet exchanged
  }
}

// Types 2 and 3 have two conditions, "with a cycle time set by parameter D" and "BFM #20 bit 0 set to ON"; as those of type 4
// each of them sends [9.3.1, 9.4].
TEST(FxLayer2Scenarios, CyclicMessages_AreSentByTheDataExchange_Too) {
  RecordProperty("spec", "FX3U-L2TX-003 FX3U-L2TX-004");
  for (const BlockForm& form : block_forms) {
    BlockScenario s;
    ready(s, form.mode);
    send_slot(s, 5, 0x123, 0x5FFF, 2, 1, 10);
    s.online().advance(30ms).no_tx().exchange().tx(data(form, 0x123, {0})).no_tx();
    s.write(bfm_block(5) + 3, 7).advance(10ms).exchange().tx(data(form, 0x123, {7})).no_tx();
    // The cycle goes on as it was.
    s.advance(57ms).no_tx().advance(1ms).tx(data(form, 0x123, {7})).no_tx().advance(100ms);
    s.tx(data(form, 0x123, {7})).no_tx();
    BlockScenario changed;
    ready(changed, form.mode);
    send_slot(changed, 5, 0x123, 0x5FFF, 3, 1, 10);
    changed.online().advance(30ms).exchange().no_tx().write(bfm_block(5) + 3, 7).exchange();
    changed.tx(data(form, 0x123, {7})).exchange().advance(10s).no_tx();  // nothing new for the cycle
    // What found no room in the controller is still a change: it comes with the cycle.
    changed.controller().accepts = false;
    changed.write(bfm_block(5) + 3, 8).exchange().no_tx();
    changed.controller().accepts = true;
    changed.advance(100ms).tx(data(form, 0x123, {8})).advance(10s).no_tx();
  }
}

TEST(FxLayer2Scenarios, TL2_06_And07_LongIdentifiers_AndRemoteFrames) {
  RecordProperty("spec", "FX3U-L2-019 FX3U-L2TX-010 FX3U-L2RX-016");
  BlockScenario s;
  ready(s, 29);
  s.write(100, {0xF100, 0x18FE, 8}).write(1100, {0xFFFF, 0x5FFF, 0, 0}).online();
  s.write(103, {0x0201, 0x0403, 0x0605, 0x0807}).exchange();
  s.tx(data(block_forms[1], 0x18FE'F100, {1, 2, 3, 4, 5, 6, 7, 8})).no_tx();
  for (const std::uint16_t form_word : Words{0x8000, 0x8003}) {
    BlockScenario asks;
    ready(asks);
    send_slot(asks, 1, 0x123, 0x5FFF, 0, form_word);
    receive_slot(asks, 2, 0x123);
    asks.online()
        .exchange()
        .tx(remote(block_forms[0], 0x123, static_cast<std::uint8_t>(form_word & 0xF)))
        .no_tx();
    asks.rx(0x123, {0xAA, 0xBB}).exchange().ignore_tx().expect(bfm_block(2), {0x123, 0, 0x0302, 0xBBAA});
  }
}

TEST(FxLayer2Scenarios, TL2_09_And10_ConfigurationWhileOnline_AndBadParameters) {
  RecordProperty("spec", "FX3U-L2-008 FX3U-L2-009 FX3U-L2-024 FX3U-L2-025 FX3U-L2TX-008 FX3U-NODE-004");
  BlockScenario s;
  ready(s);
  s.online().write(1100, 0x0181).expect(1100, 0xFFFF).expect(29, 0x0021).expect(40, 1100);
  s.write(24, 500).write(21, 29).expect(24, 250).expect(21, 11).expect(40, 1100).write(29, 0).expect(29, 0);
  s.expect(40, 0).offline();
  s.write(1100, {0xFFFF, 0x5FFF}).write(1102, 5).expect(29, 0x0041).expect(39, 1102);
  s.write(25, 0x0010).write(29, 0).expect_bit(29, 6, true).write(25, 0).write(1102, 0).write(29, 0);
  s.expect(29, 0).expect(39, 0).write(27, 5).expect(29, 0x0041).expect(39, 27).expect(27, 0x007F);
  BlockScenario receives;  // 5 is a mask there
  ready(receives);
  receives.write(1100, {0x0181, 0, 5, 0}).expect(29, 0).expect(1102, 5);
}

// Example 1 of the manual.
TEST(FxLayer2Scenarios, TL2_20_OneIdentifier) {
  RecordProperty("spec", "FX3U-L2RX-001 FX3U-L2RX-003 FX3U-L2RX-005 FX3U-L2RX-007 FX3U-L2RX-009 FX3U-L2-026");
  BlockScenario s;
  ready(s);
  receive_slot(s, 1, 0x181);
  s.online();
  const auto point = [&](std::uint16_t flags, std::uint16_t first_bytes, Where where = Where::current()) {
    s.exchange(1, where).expect(102, static_cast<std::uint16_t>(flags << 8 | (s.read(102) & 0xFF)), where);
    s.expect(103, first_bytes, where).write(102, s.read(102) & 0x00FF);
  };
  point(0x00, 0);
  point(0x00, 0);
  s.rx(0x181, {0xA, 1, 2, 3, 4, 5, 6, 7});
  point(0x03, 0x010A);
  for (const std::uint8_t letter : Bytes{0xB, 0xC, 0xD}) s.rx(0x181, {letter, 1, 2, 3, 4, 5, 6, 7});
  point(0x07, 0x010D);
  point(0x00, 0x010D);
  // An overwritten message is a flag; 2000H is for messages that the module was too slow to take.
  s.expect(401, 0).expect(29, 0);
}

// Example 2, and the table of flags.
TEST(FxLayer2Scenarios, TL2_21_And22_AMask_AndTheFlags) {
  RecordProperty("spec",
                 "FX3U-L2RX-002 FX3U-L2RX-004 FX3U-L2RX-006 FX3U-L2RX-008 FX3U-L2RX-011 FX3U-L2RX-013");
  BlockScenario s;
  ready(s);
  receive_slot(s, 2, 0x180, 0x0006);
  s.online().rx(0x182, {1}).rx(0x186, {2}).rx(0x180, {3}).exchange().expect(107, {0x180, 0, 0x0701, 3});
  s.write(109, 1).rx(0x181, {4}).rx(0x188, {5}).exchange().expect(107, {0x180, 0, 1, 3});
  s.rx(0x180, {3}).exchange().expect(109, 0x0201).write(109, 1);
  s.rx(0x180, {3}).rx(0x180, {3}).exchange().expect(109, 0x0601).write(109, 1);
  s.rx(0x180, {3}).rx(0x180, {9}).exchange().expect(109, 0x0701).write(109, 1);
  s.rx(0x184, {9}).exchange().expect(107, {0x184, 0, 0x0301, 9});  // another identifier is another frame
  s.write(109, 1).rx(0x184, {9, 0}).exchange().expect(109, {0x0302, 9});  // and another length
}

TEST(FxLayer2Scenarios, TL2_23_To25_ShortFrames_LongMasks_AndOffline) {
  RecordProperty("spec", "FX3U-L2RX-010 FX3U-L2RX-002 FX3U-L2RX-013 FX3U-L2-019 FX3U-L2-006");
  BlockScenario s;
  ready(s);
  receive_slot(s, 1, 0x181);
  s.online().rx(0x181, {1, 2, 3, 4, 5, 6, 7, 8}).exchange().write(102, 8);
  s.rx(0x181, {0xAA, 0xBB, 0xCC}).exchange().expect(102, {0x0303, 0xBBAA, 0x00CC, 0, 0}).write(102, 3);
  s.rx(0x181).exchange().expect(102, {0x0300, 0, 0, 0, 0}).write(102, 0).offline();
  s.rx(0x181, {7}).online().exchange().expect(102, {0, 0, 0, 0, 0});
  const BlockForm& form = block_forms[1];
  BlockScenario extended;
  ready(extended, 29);
  receive_slot(extended, 1, 0x18FE'F100, 0xFF);
  extended.online();
  for (const std::uint32_t hit : {0x18FE'F100U, 0x18FE'F1A5U})
    extended.rx(data(form, hit, {1})).exchange().expect(100, {static_cast<std::uint16_t>(hit), 0x18FE});
  for (const std::uint32_t miss : {0x18FE'F200U, 0x18FF'F100U})
    extended.rx(data(form, miss, {2})).exchange().expect(100, {0xF1A5, 0x18FE});
}

TEST(FxLayer2Scenarios, ReceivedData_AreNotForTheProgramToWrite) {
  RecordProperty("spec", "FX3U-L2RX-012 FX3U-L2RX-008");
  BlockScenario s;
  ready(s);
  receive_slot(s, 1, 0x181);
  for (const bool online : {false, true}) {
    if (online) s.online().rx(0x181, {1, 2}).exchange();
    const Words before{s.read(103), s.read(104), s.read(105), s.read(106)};
    s.write(103, {7, 7, 7, 7}).expect(103, before).expect(29, 0).expect(40, 0);
  }
  s.expect(102, 0x0302)
      .write(102, 0x0FFF)
      .expect(102, 0x0302)
      .write(102, 0x0100)
      .expect(102, 0x0102);  // flags go, the DLC stays
}

TEST(FxLayer2Scenarios, AMessageOfTwoSlots_IsInBoth) {
  RecordProperty("spec", "FX3U-L2RX-014");
  for (const BlockForm& form : block_forms) {
    BlockScenario s;
    ready(s, form.mode);
    receive_slot(s, 1, 0x181);
    receive_slot(s, 2, 0x180, 0x0007);
    receive_slot(s, 42, 0x181);
    s.online().rx(data(form, 0x181, {1, 2})).exchange();
    for (const unsigned slot : {1U, 2U, 42U}) s.expect(bfm_block(slot), {0x181, 0, 0x0302, 0x0201});
    s.rx(data(form, 0x183, {5})).exchange();
    s.expect(bfm_block(1), {0x181, 0, 0x0302, 0x0201}).expect(bfm_block(2), {0x183, 0, 0x0701, 5});
  }
}

TEST(FxLayer2Scenarios, TL2_30_To34_RemoteFrames_AndTriggers) {
  RecordProperty("spec",
                 "FX3U-L2RTR-001 FX3U-L2RTR-002 FX3U-L2RTR-003 FX3U-L2RTR-004 FX3U-L2RTR-006 FX3U-L2RTR-007 "
                 "FX3U-L2RTR-008 FX3U-L2RTR-009 FX3U-L2TRG-001 FX3U-L2TRG-002 FX3U-L2TRG-003");
  const BlockForm& form = block_forms[0];
  BlockScenario automatic;
  ready(automatic);
  send_slot(automatic, 1, 0x123, 0x7FFF, 0, 2);
  automatic.online().write(103, 0x2211).exchange().ignore_tx().rx(remote(form, 0x123, 2));
  automatic.tx(0x123, {0x11, 0x22}).expect(1270, 0).no_tx();
  BlockScenario manual;
  ready(manual);
  send_slot(manual, 1, 0x123, 0x6FFF, 0, 2);
  send_slot(manual, 42, 0x124, 0x6FFF, 4, 2);
  manual.online().rx(remote(form, 0x123, 0)).rx(remote(form, 0x124, 0)).no_tx().expect(1270, {1, 0, 1U << 9});
  manual.write(103, 0x4433).exchange().tx(0x123, {0x33, 0x44}).no_tx().expect(1270, {0, 0, 1U << 9});
  manual.write(1282, 1U << 9).tx(0x124, {0, 0}).expect(1270, {0, 0, 0});
  BlockScenario ignored;
  ready(ignored);
  send_slot(ignored, 1, 0x123, 0x5FFF, 0, 2);
  ignored.online().rx(remote(form, 0x123, 2)).no_tx().expect(1270, {0, 0, 0});
  for (const bool strict : {true, false}) {
    BlockScenario s;
    ready(s);
    send_slot(s, 1, 0x123, 0x7FFF, 4, strict ? 0x1002 : 0x0002);
    s.online().rx(remote(form, 0x123, 2)).tx(0x123, {0, 0}).rx(remote(form, 0x123, 3));
    if (!strict) s.tx(0x123, {0, 0});
    s.no_tx();
  }
  BlockScenario triggers;
  ready(triggers);
  for (const unsigned slot : {1U, 17U, 42U}) send_slot(triggers, slot, 0x100 + slot, 0x5FFF, 4, 1);
  receive_slot(triggers, 2, 0x55);
  triggers.online().write(1280, {0x0003, 0x0001, 0x0200}).expect(1280, {0, 0, 0});
  triggers.tx(0x101, {0}).tx(0x111, {0}).tx(0x12A, {0}).no_tx();
}

TEST(FxLayer2Scenarios, TL2_35_And36_StopMessages_OnStopAndByTheWatchdog) {
  RecordProperty("spec",
                 "FX3U-L2STOP-001 FX3U-L2STOP-002 FX3U-L2STOP-003 FX3U-L2-021 FX3U-L2-027 FX3U-L2-028");
  for (const bool by_watchdog : {false, true}) {
    BlockScenario s;
    ready(s);
    s.write(1900, {0x700, 0, 2, 0x0201})
        .write(1907, {0x701, 0, 1, 0x00FF})
        .write(26, by_watchdog ? 10 : 0)
        .online();
    if (by_watchdog) {
      (void)s.read(102);
      s.advance(99ms).no_tx().advance(1ms).expect(29, 0x0081);
    } else {
      s.cpu(module::CpuState::stop);
    }
    s.tx(0x700, {1, 2}).tx(0x701, {0xFF}).no_tx();
    if (by_watchdog) {
      s.write(26, 10).expect(29, 0);
    } else {
      s.expect(25, 0).cpu(module::CpuState::run).expect(25, 0).write(25, 0x0010).expect(25, 0x0011).no_tx();
    }
  }
}

TEST(FxLayer2Scenarios, TL2_37_To39_TheCommandInterface) {
  RecordProperty("spec", "FX3U-L2CIF-001 FX3U-L2CIF-002 FX3U-L2CIF-003 FX3U-L2CIF-004 FX3U-L2CIF-006");
  BlockScenario s;
  ready(s);
  s.online().write(1001, {0x321, 0, 0, 4, 0x0201, 0x0403}).write(1000, 0x000C).expect(1000, 0xFFFF);
  s.advance(1ms).expect(1000, 0x000D).tx(0x321, {1, 2, 3, 4});
  s.cif({0x000C, 0x321, 0, 0, 9}).expect(1000, {0xF00C, 0, 0, 0, 9}).no_tx();
  s.cif({0x000C, 0x321, 0, 1, 0}).expect(1000, 0x000D).tx(remote(block_forms[0], 0x321, 0)).no_tx();
  s.write(1000, 0x000C)
      .expect(1000, 0xFFFF)
      .write(1001, 0)
      .expect(1000, {0x000F, 0xFFFF})
      .advance(1ms)
      .ignore_tx();
  s.write(1000, 0xFFFF).advance(1ms).expect(1000, 0);
  s.cif({0x0004, 0, 0x1000, 0}).expect(1000, {0x000F, 0x0064}).no_tx();
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_layer2_scenarios_test
