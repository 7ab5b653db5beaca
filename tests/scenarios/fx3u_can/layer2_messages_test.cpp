// What comes over the bus in the Layer 2 modes, and what the program asks to be sent [FX3U-CAN 9].

#include "scenarios/fx3u_can/layer2_slots.hpp"

namespace canopus::scenario::fx3u_can_layer2_messages_test {
namespace {

TEST(FxLayer2, RemoteFrames_AreAnswered_Noted_OrIgnored) {
  RecordProperty("spec",
                 "FX3U-L2RTR-001 FX3U-L2RTR-002 FX3U-L2RTR-003 FX3U-L2RTR-004 FX3U-L2RTR-005 FX3U-L2RTR-006 "
                 "FX3U-L2RTR-007 FX3U-L2RTR-008 "
                 "FX3U-L2RTR-009 FX3U-L2RTR-010");
  for (const BlockForm& form : block_forms) {
    BlockScenario s;
    s.power_on_layer2(form.mode);
    send_slot(s, 1, 0x101, 0x7FFF, 4, 2);
    send_slot(s, 17, 0x111, 0x6FFF, 4, 2);
    send_slot(s, 42, 0x12A, 0x6FFF, 0, 2);
    send_slot(s, 5, 0x105, 0x5FFF, 4, 2);
    send_slot(s, 6, 0x106, 0x7FFF, 4, 0x1002);
    send_slot(s, 7, 0x107, 0x6FFF, 4, 0x1002);
    s.online().ignore_tx().write(bfm_block(1) + 3, 0xBBAA).exchange().ignore_tx();
    for (const std::uint8_t dlc : Bytes{2, 0, 8})
      s.rx(remote(form, 0x101, dlc)).tx(data(form, 0x101, {0xAA, 0xBB})).expect(1270, {0, 0, 0});
    s.rx(remote(form, 0x111, 1))
        .no_tx()
        .expect(1270, {0, 1, 0})
        .rx(remote(form, 0x12A, 2))
        .no_tx()
        .expect(1270, {0, 1, 1U << 9});
    s.rx(remote(form, 0x105, 2))
        .no_tx()
        .expect(1270, {0, 1, 1U << 9})
        .write(1270, {0, 0, 0})
        .expect(1270, {0, 1, 1U << 9});
    s.rx(remote(form, 0x106, 1)).no_tx().rx(remote(form, 0x106, 2)).tx(data(form, 0x106, {0, 0}));
    s.rx(remote(form, 0x107, 1)).expect(1270, 0).rx(remote(form, 0x107, 2)).expect(1270, 1U << 6);
    s.write(bfm_block(17) + 3, 0x0021)
        .write(1281, 1)
        .tx(data(form, 0x111, {0, 0}))
        .expect(1271, 0);  // the words were not exchanged
    s.rx(remote(form, 0x111, 2)).exchange().tx(data(form, 0x12A, {0, 0})).expect(1272, 0).expect(1271, 1);
    s.write(1281, 1).tx(data(form, 0x111, {0x21, 0})).expect(1271, 0).no_tx();
  }
}

TEST(FxLayer2, TwentyEightSlots_AnswerRemoteFrames) {
  RecordProperty("spec", "FX3U-L2TX-013");
  BlockScenario s;
  s.power_on_layer2(29);
  for (unsigned slot = 1; slot <= 30; ++slot) send_slot(s, slot, 0x1000 + slot, 0x7FFF, 4, 1);
  s.online().ignore_tx();
  for (unsigned slot = 1; slot <= 30; ++slot) {
    s.expect(bfm_parameters(slot) + 1, slot <= 28 ? 0x7FFF : 0x5FFF)
        .rx(remote(block_forms[1], 0x1000 + slot, 1));
    if (slot <= 28) s.tx(data(block_forms[1], 0x1000 + slot, {0}));
    s.no_tx();
  }
}

TEST(FxLayer2, TriggerFlags) {
  RecordProperty("spec",
                 "FX3U-L2TRG-001 FX3U-L2TRG-002 FX3U-L2TRG-003 FX3U-L2TRG-004 FX3U-L2TRG-005 FX3U-L2TRG-006 "
                 "FX3U-L2TRG-007");
  for (const BlockForm& form : block_forms) {
    BlockScenario s;
    s.power_on_layer2(form.mode);
    for (std::uint16_t type = 0; type <= 4; ++type)
      send_slot(s, type + 1U, 0x105U - type, 0x5FFF, type, 1, 6000);
    send_slot(s, 16, 0x116, 0x5FFF, 4, 1);
    send_slot(s, 17, 0x117, 0x5FFF, 4, 1);
    send_slot(s, 42, 0x142, 0x5FFF, 4, 1);
    receive_slot(s, 10, 0x222);
    s.online().advance(10ms).ignore_tx().write(bfm_block(16) + 3, 9);
    s.write(1280, {0xFFFF, 1}).write(1282, 0xFFFF).expect(1280, {0, 0, 0});
    for (std::uint16_t type = 0; type <= 4; ++type) s.tx(data(form, 0x105U - type, {0}));
    s.tx(data(form, 0x116, {0}))
        .tx(data(form, 0x117, {0}))
        .tx(data(form, 0x142, {0}))
        .no_tx()
        .advance(1s)
        .no_tx();
    s.exchange().ignore_tx().write(1280, 1U << 15).tx(data(form, 0x116, {9})).no_tx();
  }
}

TEST(FxLayer2, ReceivesByFilterAndMask_AndShowsWhatIsNew) {
  RecordProperty("spec",
                 "FX3U-L2RX-001 FX3U-L2RX-002 FX3U-L2RX-003 FX3U-L2RX-004 FX3U-L2RX-005 FX3U-L2RX-006 "
                 "FX3U-L2RX-007 FX3U-L2RX-008 FX3U-L2RX-009 "
                 "FX3U-L2RX-010 FX3U-L2RX-011 FX3U-L2RX-013 FX3U-L2RX-015 FX3U-L2-020");
  for (const BlockForm& form : block_forms) {
    BlockScenario s;
    s.power_on_layer2(form.mode);
    receive_slot(s, 1, 0x181);
    receive_slot(s, 2, 0x280, 6);
    s.online().ignore_tx();
    s.rx(data(form, 0x181, {1, 2, 3}))
        .expect(bfm_block(1), {0xFFFF, 0xFFFF, 0, 0})
        .exchange()
        .expect(bfm_block(1), {0x181, 0, 0x0303, 0x0201, 0x0003, 0, 0});
    s.exchange().expect(bfm_block(1) + 2, 0x0303);  // the module takes no flag away
    s.write(bfm_block(1) + 2, 0x0003).exchange().expect(bfm_block(1) + 2, 0x0003);
    s.rx(data(form, 0x181, {1, 2, 3})).exchange().expect(bfm_block(1) + 2, 0x0203).write(bfm_block(1) + 2, 3);
    s.rx(data(form, 0x181, {1, 2, 3}))
        .rx(data(form, 0x181, {1, 2, 3}))
        .exchange()
        .expect(bfm_block(1) + 2, 0x0603)
        .write(bfm_block(1) + 2, 3);
    s.rx(data(form, 0x181, {1, 2, 3}))
        .rx(data(form, 0x181, {9}))
        .exchange()
        .expect(bfm_block(1) + 2, {0x0701, 0x0009, 0, 0, 0})
        .write(bfm_block(1) + 2, 1);
    for (const std::uint32_t other : {0x180U, 0x182U, 0x581U})
      s.rx(data(form, other, {5})).exchange().expect(bfm_block(1) + 2, 1);
    s.rx(remote(form, 0x181, 1)).exchange().expect(bfm_block(1) + 2, 1);
    can::Frame of_other_form = data(form, 0x181, {5});
    of_other_form.extended = !of_other_form.extended;
    s.rx(of_other_form).exchange().expect(bfm_block(1) + 2, 1);
    for (const std::uint32_t hit : {0x280U, 0x282U, 0x284U, 0x286U})
      s.rx(data(form, hit, {1})).exchange().expect(bfm_block(2), {static_cast<std::uint16_t>(hit), 0});
    s.rx(data(form, 0x281, {1}))
        .rx(data(form, 0x288, {1}))
        .exchange()
        .expect(bfm_block(2), 0x286)
        .ignore_tx();
  }
}

TEST(FxLayer2, LostMessages_AreAnErrorOfTheirSlot) {
  RecordProperty("spec", "FX3U-L2-026");
  BlockScenario s;
  s.power_on_layer2();
  receive_slot(s, 7, 0x123);
  s.online().ignore_tx();
  for (std::uint8_t i = 0; i < 100; ++i) s.rx(0x123, {i});
  s.expect(407, 0x2000).expect(29, 0x8001).write(407, 0).write(29, 0).expect(29, 0).expect(407, 0);
}

TEST(FxLayer2, SavesItsSettings_ButNoData) {
  RecordProperty("spec", "FX3U-SAVE-002 FX3U-L2-016 FX3U-L2-017 FX3U-L2-022 FX3U-L2STOP-005");
  BlockScenario s;
  s.power_on_layer2(29).write(26, 30).write(24, 125);
  send_slot(s, 1, 0x1234'5678, 0x7FFF, 2, 0x1004, 77);
  s.write(103, {1, 2, 3, 4}).write(1900, {0x1111, 0x0222, 3, 4, 5, 6, 7}).save().restart();
  s.expect(24, 125)
      .expect(26, 30)
      .expect(1100, {0xFFFF, 0x7FFF, 2, 77})
      .expect(100, {0x5678, 0x1234, 0x1004, 0, 0, 0, 0});
  s.expect(1900, {0x1111, 0x0222, 3, 4, 5, 6, 7}).write(1103, 5).restart().expect(1103, 77);
  s.save(2).expect(1100, {0xFFFF, 0xFFFF, 0, 0}).expect(1900, 0xFFFF).restart().expect(1103, 77);
  s.save(3).restart().expect(21, 405).expect(24, 250).expect(26, 20);
}

TEST(FxLayer2, ADlcWithAFrameType_IsNoStopMessage) {
  RecordProperty("spec", "FX3U-L2STOP-004");
  BlockScenario s;
  s.power_on_layer2().write(1902, 0x0108).expect_bit(29, 6, true).expect(39, 1902).expect(1902, 0);
}

TEST(FxLayer2, ACommandSendsAnyFrame) {
  RecordProperty("spec", "FX3U-L2CIF-001 FX3U-L2CIF-002 FX3U-L2CIF-003 FX3U-L2CIF-009 FX3U-L2CIF-010");
  for (const BlockForm& form : block_forms) {
    const auto low = static_cast<std::uint16_t>(form.highest),
               high = static_cast<std::uint16_t>(form.highest >> 16);
    BlockScenario s;
    s.power_on_layer2(form.mode).cif({0x000C, 1, 0, 0, 0}).expect(1000, {0x000F, 0x0F0F}).no_tx();
    s.online()
        .ignore_tx()
        .cif({0x000C, low, high, 0, 8, 0x0201, 0x0403, 0x0605, 0x0807})
        .expect(1000, 0x000D);
    s.tx(data(form, form.highest, {1, 2, 3, 4, 5, 6, 7, 8}))
        .cif({0x000C, low, high, 1, 3})
        .expect(1000, 0x000D)
        .tx(remote(form, form.highest, 3));
    s.cif({0x000C, low, high, 2, 9}).expect(1000, 0xF00C).no_tx();
    EXPECT_NE(s.read(1003), 0);
    EXPECT_NE(s.read(1004), 0);
    EXPECT_EQ(s.read(1001), 0);
    s.controller().accepts = false;
    s.cif({0x000C, 1, 0, 0, 0}).expect(1000, {0x000F, 0x8FFF}).ignore_tx();
  }
}

TEST(FxLayer2, BusOff_IsLeftByARestart) {
  RecordProperty("spec", "FX3U-L2-023 FX3U-ERR-005 FX3U-ERR-006");
  for (const std::uint16_t mode : Words{405, 11}) {
    BlockScenario s;
    mode == 405 ? s.power_on() : s.power_on_layer2(mode).online();
    s.ignore_tx()
        .error_counters(256, 0)
        .expect(29, 0x0009)
        .expect(35, {256, 256})
        .advance(10s)
        .expect(29, 0x0009)
        .write(29, 0)
        .expect(29, 0x0009);
    s.write(25, 1);
    s.error_counters(0, 0).wait_bit(25, 7, false).expect(29, 0).expect(35, {0, 0}).ignore_tx();
  }
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_layer2_messages_test
