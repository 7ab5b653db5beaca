// Plain CAN with 11- and 29-bit identifiers: 42 message slots [FX3U-CAN 6, 9].

#include "scenarios/fx3u_can/layer2_slots.hpp"

namespace canopus::scenario::fx3u_can_layer2_test {
namespace {

TEST(FxLayer2, StartsOffline_AndNothingOfCanopenIsThere) {
  RecordProperty(
      "spec",
      "FX3U-L2-001 FX3U-L2-002 FX3U-L2-003 FX3U-L2-005 FX3U-L2-006 FX3U-L2-007 FX3U-L2-011 FX3U-L2-029");
  for (const BlockForm& form : block_forms) {
    BlockScenario s;
    s.power_on_layer2(form.mode).expect(25, 0).expect(29, 0).expect(37, 2500).expect(38, 875).expect(35,
                                                                                                     {0, 0});
    for (unsigned slot = 1; slot <= 42; ++slot)
      s.expect(bfm_parameters(slot), {0xFFFF, 0xFFFF, 0, 0})
          .expect(bfm_block(slot), {0xFFFF, 0xFFFF, 0, 0, 0, 0, 0});
    for (unsigned k = 0; k < 4; ++k) s.expect(1900 + 7 * k, {0xFFFF, 0xFFFF, 0, 0, 0, 0, 0});
    for (const bool online : {false, true}) {
      s.write(25, online ? 0x0010 : 0).expect(25, online ? 0x0011 : 0);
      s.rx(0x000, {0x81, 0})
          .rx(0x67F, {0x40, 0, 0x10, 0, 0, 0, 0, 0})
          .rx_remote(0x77F)
          .rx(0x080)
          .advance(10s)
          .no_tx();
    }
    s.offline()
        .expect(25, 0)
        .supply_off()
        .supply_on()
        .wait_bit(25, 7, false)
        .expect(25, 0)
        .expect(21, form.mode)
        .no_tx();
  }
}

TEST(FxLayer2, OnlineTheConfigurationCannotBeChanged) {
  RecordProperty("spec", "FX3U-L2-008 FX3U-L2-009 FX3U-L2STOP-006");
  BlockScenario s;
  s.power_on_layer2();
  send_slot(s, 1, 0x123, 0x5FFF, 0, 2);
  s.online().ignore_tx();
  s.write(1100, 1)
      .expect(1100, 0xFFFF)
      .expect(29, 0x0021)
      .expect(40, 1100)
      .write(1900, 1)
      .expect(1900, 0xFFFF)
      .expect(40, 1100);
  s.write(29, 0).expect(29, 0).expect(40, 0).write(100, 0x124).expect(100, 0x123).expect(40, 100);
  s.write(103, 0x1234)
      .expect(103, 0x1234)
      .offline()
      .write(29, 0)
      .write(1100, 1)
      .expect(1100, 1)
      .expect(29, 0);
}

// "CAN-ID LW, CAN-ID HW and transmitting data byte number (in RTR/new/DLC)" are defined in the configuration mode [9.1].
TEST(FxLayer2, OnlineTheFormOfATransmitMessageCannotBeChanged) {
  RecordProperty("spec", "FX3U-L2-008 FX3U-L2TX-009 FX3U-L2TX-010 FX3U-L2RTR-009");
  for (const BlockForm& form : block_forms) {
    for (const unsigned slot : {1U, 42U}) {
      const module::BufferAddress word = bfm_block(slot) + 2;
      // Another length, a remote frame, a strict check of the length: of a message that takes each of them offline.
      for (const auto& [response, value] : std::vector<std::pair<std::uint16_t, std::uint16_t>>{
               {0x5FFF, 0x0003}, {0x5FFF, 0x0000}, {0x5FFF, 0x8002}, {0x6FFF, 0x1002}, {0x7FFF, 0x1002}}) {
        BlockScenario s;
        s.power_on_layer2(form.mode);
        send_slot(s, slot, 0x123, response, 0, 2);
        s.online().ignore_tx().write(word, value).expect(word, 2).expect(29, 0x0021);
        s.expect(40, static_cast<std::uint16_t>(word));
        s.exchange().tx(data(form, 0x123, {0, 0})).no_tx();
        s.offline().write(29, 0).write(word, value).expect(word, value).expect(29, 0).online().exchange();
        const auto length = static_cast<std::uint8_t>(value & 0xF);
        s.tx((value & 0x8000) != 0 ? remote(form, 0x123, length) : data(form, 0x123, Bytes(length, 0)))
            .no_tx();
      }
    }
  }
}

TEST(FxLayer2, OnlineTheFlagsOfAReceivedMessageCanBeTakenAway) {
  RecordProperty("spec", "FX3U-L2-008 FX3U-L2RX-008");
  BlockScenario s;
  s.power_on_layer2();
  receive_slot(s, 7, 0x181);
  s.online().rx(0x181, {1, 2, 3}).exchange().expect(bfm_block(7) + 2, 0x0303).write(bfm_block(7) + 2, 0x0003);
  s.expect(bfm_block(7) + 2, 0x0003).expect(29, 0).expect(40, 0).no_tx();
}

// "The configuration of the module can only be changed while this bit is OFF" [6.8].
TEST(FxLayer2, OnlineNothingIsSavedOrRestored) {
  RecordProperty("spec", "FX3U-L2-030 FX3U-L2-008 FX3U-L2-016 FX3U-L2-017");
  for (const std::uint16_t bits : Words{1, 2, 3}) {
    BlockScenario s;
    s.power_on_layer2();
    send_slot(s, 1, 0x123, 0x5FFF, 0, 2);
    s.write(26, 0)
        .online()
        .ignore_tx()
        .write(22, bits)
        .expect(22, 0)
        .expect(29, 0x0021)
        .expect(40, 22)
        .advance(10s);
    s.expect(1100, {0xFFFF, 0x5FFF}).expect(100, {0x123, 0, 2}).expect(21, 11);
    s.exchange().tx(0x123, {0, 0}).no_tx();
    s.offline().write(29, 0).restart().expect(1100, {0xFFFF, 0xFFFF}).expect(21, 11);  // it was not saved
  }
}

TEST(FxLayer2, ARestoreThatRuns_IsDoneBeforeGoingOnline) {
  RecordProperty("spec", "FX3U-L2-030 FX3U-L2-017");
  BlockScenario s;
  s.power_on_layer2();
  send_slot(s, 1, 0x123, 0x5FFF, 0, 2);
  s.write(22, 2)
      .online()
      .expect(22, 0)
      .write(26, 0)
      .expect(1100, {0xFFFF, 0xFFFF})
      .expect(100, {0xFFFF, 0xFFFF, 0});
  s.exchange().advance(10s).no_tx().expect(29, 0);
}

TEST(FxLayer2, ASettingError_StaysWhileOnline) {
  RecordProperty("spec", "FX3U-L2-024 FX3U-L2-025 FX3U-L2TX-008 FX3U-L2TX-009");
  BlockScenario s;
  s.power_on_layer2();
  s.write(1100, {0xFFFF, 0x5FFF}).write(1102, 5).expect(29, 0x0041).expect(39, 1102).expect(1102, 0);
  s.online().write(29, 0).expect(29, 0x0041).offline().write(29, 0).expect(29, 0).expect(39, 0);
  s.write(102, 9).expect_bit(29, 6, true).expect(39, 102).expect(102, 0);
}

TEST(FxLayer2, BytesLieLowByteFirst_InAllFortyTwoSlots) {
  RecordProperty("spec", "FX3U-L2-010 FX3U-L2-012 FX3U-L2-014 FX3U-L2-018 FX3U-L2-019 FX3U-L2TX-012");
  for (const BlockForm& form : block_forms) {
    BlockScenario s;
    s.power_on_layer2(form.mode);
    for (unsigned slot = 1; slot <= 42; ++slot) send_slot(s, slot, form.highest - slot, 0x5FFF, 0, 8);
    s.online().ignore_tx();
    for (unsigned slot = 1; slot <= 42; ++slot)
      s.write(bfm_block(slot) + 3, {static_cast<std::uint16_t>(0x0200 + slot), 0x0403, 0x0605, 0x0807});
    s.expect(bfm_block(42) + 3, {0x022A, 0x0403, 0x0605, 0x0807})
        .advance(1s)
        .no_tx()
        .write(20, 1)
        .expect(20, 1)
        .advance(1ms)
        .expect(20, 0);
    for (unsigned slot = 1; slot <= 42; ++slot)
      s.tx(data(form, form.highest - slot, {static_cast<std::uint8_t>(slot), 2, 3, 4, 5, 6, 7, 8}));
    s.no_tx();
  }
  BlockScenario s;
  s.power_on_layer2();
  send_slot(s, 1, 0xABCD'0123, 0x5FFF, 0, 1);  // the high word does not matter
  s.online().ignore_tx().exchange().tx(0x123, {0}).expect(29, 0);
}

TEST(FxLayer2, TransmissionTypes) {
  RecordProperty("spec",
                 "FX3U-L2TX-001 FX3U-L2TX-002 FX3U-L2TX-003 FX3U-L2TX-004 FX3U-L2TX-005 FX3U-L2TX-006 "
                 "FX3U-L2TX-007 FX3U-L2-015");
  for (const BlockForm& form : block_forms) {
    const auto start = [&](BlockScenario& s, std::uint16_t type, std::uint16_t cycle) {
      s.power_on_layer2(form.mode);
      send_slot(s, 3, 0x100, 0x5FFF, type, 2, cycle);
      s.online().advance(1ms).ignore_tx();
    };
    const auto frame = [&](std::uint8_t byte) { return data(form, 0x100, {byte, 0}); };
    {
      BlockScenario s;
      start(s, 0, 1);
      s.advance(1s)
          .no_tx()
          .exchange()
          .tx(frame(0))
          .exchange()
          .tx(frame(0))
          .write(bfm_block(3) + 3, 5)
          .advance(1s)
          .no_tx()
          .exchange()
          .tx(frame(5));
      s.write(20, 1)
          .write(bfm_block(3) + 3, 6)
          .write(20, 1)
          .advance(1ms)
          .tx(frame(5))
          .advance(10ms)
          .no_tx();  // the second is ignored
    }
    {
      BlockScenario s;
      start(s, 1, 1);
      s.write(bfm_block(3) + 3, 5)
          .exchange()
          .tx(frame(5))
          .exchange()
          .no_tx()
          .write(bfm_block(3) + 3, 6)
          .exchange()
          .tx(frame(6))
          .advance(1s)
          .no_tx();
    }
    {
      BlockScenario s;
      start(s, 2, 5);  // 50 ms
      s.write(bfm_block(3) + 3, 5).exchange().ignore_tx().advance(100ms).ignore_tx();
      for (int i = 0; i < 5; ++i) s.advance(50ms).tx(frame(5)).no_tx();
      s.write(bfm_block(3) + 3, 6)
          .exchange()
          .ignore_tx()
          .advance(100ms)
          .ignore_tx()
          .advance(50ms)
          .tx(frame(6))
          .no_tx();
    }
    {
      BlockScenario s;
      start(s, 3, 5);
      s.advance(1s)
          .ignore_tx()
          .advance(1s)
          .no_tx()
          .write(bfm_block(3) + 3, 5)
          .exchange()
          .advance(50ms)
          .tx(frame(5))
          .advance(1s)
          .no_tx();
      s.exchange().advance(1s).no_tx();
    }
    {
      BlockScenario s;
      start(s, 4, 1);
      s.write(bfm_block(3) + 3, 5)
          .exchange()
          .advance(1s)
          .no_tx()
          .write(1280, 1U << 2)
          .expect(1280, 0)
          .tx(frame(5))
          .no_tx();
    }
  }
}

TEST(FxLayer2, LengthsAndRemoteFrames_OfASlot) {
  RecordProperty("spec", "FX3U-L2TX-009 FX3U-L2TX-010 FX3U-L2TX-011 FX3U-L2RX-016 FX3U-L2-013 FX3U-L2TX-014");
  for (const BlockForm& form : block_forms) {
    for (std::uint8_t dlc = 0; dlc <= 8; ++dlc) {
      BlockScenario s;
      s.power_on_layer2(form.mode);
      send_slot(s, 1, form.highest, 0x5FFF, 0, dlc);
      send_slot(s, 2, 0, 0x5FFF, 0, static_cast<std::uint16_t>(0x8000 | dlc));
      receive_slot(s, 3, 0);
      s.online()
          .ignore_tx()
          .exchange()
          .tx(data(form, form.highest, Bytes(dlc, 0)))
          .tx(remote(form, 0, dlc))
          .no_tx();
      s.rx(data(form, 0, Bytes(dlc, 7)))
          .exchange()
          .ignore_tx()
          .expect(bfm_block(3) + 2, static_cast<std::uint16_t>(0x0300 | dlc));
    }
    BlockScenario s;
    s.power_on_layer2(form.mode);
    send_slot(s, 1, 0x10, 0x6FFF, 0, 1);
    s.write(102, 0x9001).expect_bit(29, 6, true).expect(39, 102).expect(102, 1);
    s.rx(data(form, 0x55, {1}))
        .online()
        .ignore_tx()
        .rx(data(form, 0xFF, {1}))
        .exchange()
        .ignore_tx()
        .expect(bfm_block(5), {0xFFFF, 0xFFFF, 0, 0});
  }
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_layer2_test
