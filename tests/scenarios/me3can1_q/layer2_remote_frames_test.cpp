// spec/me3can1-q/scenarios.md, section 8: Layer 2 modes - remote frames, data lengths, identifiers (S47, S48).

#include "scenarios/me3can1_q/layer2_frames.hpp"

namespace canopus::scenario::me3can1_q_layer2_remote_frames_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Layer2RemoteFrames);

TEST_P(Layer2RemoteFrames, S47_AutomaticRtrResponse) {
  spec("ME3-L2-010 ME3-SYS-012 ME3-L2-018", "RJ71-L2RTR-003 RJ71-L2TX-006");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x7FFF, 4, 0x0002);
  s.write(10003, 0x2211);
  s.exchange();
  s.no_tx();
  s.rx_remote(0x123, 2);
  s.tx(0x123, {0x11, 0x22}).expect(8350, {0, 0, 0});
  s.rx_remote(0x123, 8);  // the DLC of the request does not matter
  s.tx(0x123, {0x11, 0x22});
  s.write(10003, 0x4433);
  s.rx_remote(0x123, 2);
  s.tx(0x123, {0x11, 0x22});  // as of the last Y01
  s.exchange();
  s.rx_remote(0x123, 2);
  s.tx(0x123, {0x33, 0x44});
  s.rx_remote(0x122, 2).rx(remote(0x123, 2, true)).rx(0x123, {});  // another identifier, format, kind
  s.no_tx().expect(8350, {0, 0, 0});
}

TEST_P(Layer2RemoteFrames, S47_ManualRtrResponse) {
  spec("ME3-L2-011 ME3-L2-024 ME3-L2-025 ME3-L2-026", "RJ71-L2RTR-004");
  for (const std::uint16_t type : Words{0, 1}) {
    IntelligentScenario s(GetParam());
    one_slot(s, 0x6FFF, type, 0x0002);
    s.rx_remote(0x123, 2);
    s.no_tx().expect(8350, {0x0001, 0, 0});  // without Y01
    s.advance(1s);
    s.write(8350, 0);  // read only
    s.no_tx().expect(8350, 0x0001);
    s.write(10003, 0x2211);
    s.expect(8350, 0x0001);
    s.exchange();
    s.tx(0x123, {0x11, 0x22}).no_tx().expect(8350, 0);
    s.rx_remote(0x123, 2).rx_remote(0x123, 7);  // once more, and with another DLC: it does not matter
    s.expect(8350, 0x0001).no_tx();
    s.write(8400, 1).y(0x04, true);
    s.tx(0x123, {0x11, 0x22}).expect(8350, 0).no_tx();
    s.rx_remote(0x123, 8).expect(8350, 0x0001);
    s.controller().accepts = false;  // not transmitted: the flag stays
    s.write(10003, 0x3333);
    s.exchange();
    s.expect(8350, 0x0001);
    s.offline();
    s.expect(8350, 0x0001);
  }
}

TEST_P(Layer2RemoteFrames, S47_RtrHandlingDisabled) {
  spec("ME3-L2-012", "RJ71-L2RTR-005");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x5FFF, 0, 0x0002);
  s.rx_remote(0x123, 2).advance(1s);
  s.no_tx().expect(8350, {0, 0, 0}).expect(10002, 2).expect(29, 0);
}

TEST(Me3Layer2RemoteFrames, S47_StrictDlcCheck) {
  RecordProperty("spec", "ME3-L2-037");
  for (const std::uint16_t b : Words{0x7FFF, 0x6FFF}) {
    IntelligentScenario s;
    one_slot(s, b, 4, 0x1002);
    s.rx_remote(0x123, 1).rx_remote(0x123, 3).rx_remote(0x123, 0);
    s.no_tx().expect(8350, 0);
    s.rx_remote(0x123, 2);
    if (b == 0x7FFF) s.tx(0x123, {0, 0}).expect(8350, 0);
    if (b == 0x6FFF) s.no_tx().expect(8350, 1);
    s.rx_remote(0x122, 2).no_tx();  // the CAN-ID must match as well
    // Bit 12 and the DLC are in force with the next Y01.
    s.write(8400, 1).y(0x04, true).y(0x04, false).ignore_tx();
    s.write(10002, 0x1003).rx_remote(0x123, 3).no_tx().expect(8350, 0);
    s.exchange();
    s.rx_remote(0x123, 2).no_tx().expect(8350, 0);
    s.rx_remote(0x123, 3);
    if (b == 0x7FFF) s.tx(0x123, {0, 0, 0}).expect(8350, 0);
    if (b == 0x6FFF) s.no_tx().expect(8350, 1);
    s.write(8400, 1).y(0x04, true).y(0x04, false).ignore_tx();
    s.write(10002, 0x0003);
    s.exchange();
    s.rx_remote(0x123, 1);
    if (b == 0x7FFF) s.tx(0x123, {0, 0, 0}).expect(8350, 0);
    if (b == 0x6FFF) s.no_tx().expect(8350, 1);
  }
}

TEST(Me3Layer2RemoteFrames, S48_28SlotLimit) {
  RecordProperty("spec", "ME3-L2-013 ME3-L2-018");
  IntelligentScenario s;
  s.power_on_layer2();
  // Slot 1 without RTR does not count; slots 2 to 42 do, automatic and manual.
  s.write(6000, {0xFFFF, 0x5FFF, 4, 0}).write(10000, {0x0200, 0, 1});
  for (std::uint16_t slot = 1; slot < 42; ++slot) {
    const std::uint16_t b = slot % 2 == 0 ? 0x7FFF : 0x6FFF;
    s.write(6000 + 4U * slot, {0xFFFF, b, 4, 0});
    s.write(10000 + 7U * slot, {static_cast<std::uint16_t>(0x200 + slot), 0, 0x1001, slot});
  }
  s.expect(6001 + 4 * 29, 0x6FFF).expect(29, 0);
  s.online();
  s.expect(29, 0);
  for (std::uint16_t slot = 1; slot < 42; ++slot) {
    const std::uint16_t b = slot % 2 == 0 ? 0x7FFF : 0x6FFF;
    s.expect(6001 + 4U * slot, slot <= 28 ? b : 0x5FFF);
    s.rx_remote(0x200U + slot, 1);
    if (slot <= 28 && b == 0x7FFF) s.tx(0x200U + slot, {static_cast<std::uint8_t>(slot)});
    s.no_tx();
    s.expect_bit(8350 + slot / 16U, slot % 16U, slot <= 28 && b == 0x6FFF);
  }
  s.write(8402, 0x0200).y(0x04, true);
  s.tx(0x229, {41}).y(0x04, false);
  s.offline();
  s.online();  // and once more, with what has been forced
  s.expect(29, 0);
}

TEST_P(Layer2RemoteFrames, S48_AsPrinted_30Slots) {
  spec("ME3-L2-013", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  for (std::uint16_t slot = 0; slot < 30; ++slot) {
    s.write(6000 + 4U * slot, {0xFFFF, 0x7FFF, 0, 0});
    s.write(10000 + 7U * slot, {static_cast<std::uint16_t>(0x200 + slot), 0, 1});
  }
  s.online();
  for (std::uint16_t slot = 0; slot < 28; ++slot) s.expect(6001 + 4U * slot, 0x7FFF);
  s.expect(6113, 0x5FFF).expect(6117, 0x5FFF);
}

TEST(Me3Layer2RemoteFrames, SendRtrFrame) {
  RecordProperty("spec", "ME3-L2-036 ME3-SYS-012");
  IntelligentScenario s;
  one_slot(s, 0x5FFF, 0, 0x8005);
  s.write(10003, 0x2211);
  s.exchange();
  s.tx(remote(0x123, 5)).no_tx();
  s.write(10002, 0x0001);
  s.exchange();
  s.tx(0x123, {0x11});
  s.write(10002, 0x9000);  // bits 15 and 12 exclude each other
  s.expect(10002, 0x0001).expect(29, 0x0040).expect(39, 10002);
}

// By every way a slot is sent, and with the format of the mode.
TEST(Me3Layer2RemoteFrames, SendRtrFrame_ByCycleAndTrigger_WithTheDlcOfTheLastY01) {
  RecordProperty("spec", "ME3-L2-036 ME3-L2-044");
  for (const std::uint16_t mode : Words{11, 29}) {
    IntelligentScenario s;
    s.power_on_layer2(mode);
    s.write(6000, {0xFFFF, 0x5FFF, 2, 1}).write(10000, {0x0123, 0, 0x8000});
    s.write(6004, {0xFFFF, 0x5FFF, 4, 0}).write(10007, {0x0124, 0, 0x8008});
    s.online();
    s.advance(10ms);
    s.tx(remote(0x123, 0, mode == 29)).no_tx();
    s.write(8400, 2).y(0x04, true);
    s.tx(remote(0x124, 8, mode == 29)).no_tx().expect(8400, 0).expect_x(0x04, true);
    s.write(10002, 0x8003).advance(10ms);
    s.tx(remote(0x123, 0, mode == 29)).no_tx();
    s.exchange();
    s.advance(9ms);
    s.tx(remote(0x123, 3, mode == 29)).no_tx();
    s.cif({0x000C, 0x0321, 0, 1, 5});
    s.tx(remote(0x321, 5, mode == 29)).ignore_tx();
  }
}

TEST_P(Layer2RemoteFrames, RemoteFrames_In405Mode_AreForNodeGuardingAlone) {
  spec("ME3-SYS-012", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.nmt(0x01);
  s.write(13000, 0x1234);
  s.exchange();
  s.tx(0x181, {0x34, 0x12, 0, 0, 0, 0, 0, 0});
  s.rx_remote(0x181, 8).advance(1s);
  s.no_tx();
  s.rx_remote(0x701, 1);
  s.tx(0x701, {0x05});
  s.rx_remote(0x701, 1);
  s.tx(0x701, {0x85}).no_tx();
  // Bit 30 of the COB-ID, "no RTR", is always 1.
  for (const std::uint16_t number : Words{1, 2, 128, 256}) {
    const auto index = static_cast<std::uint16_t>(0x1800 + number - 1);
    s.cif({0x0004, 0, index, 1});
    s.expect_bit(1006, 14, true);
    s.cif({0x0002, 0, index, 1, 4, 0x0182, 0x8000});
    s.cif({0x0004, 0, index, 1});
    s.expect_bit(1006, 14, true);
  }
  s.no_tx();
}

TEST(Me3Layer2RemoteFrames, Dlc_0To8) {
  RecordProperty("spec", "ME3-L2-038");
  IntelligentScenario s;
  one_slot(s, 0x5FFF, 0, 0);
  const Bytes all{1, 2, 3, 4, 5, 6, 7, 8};
  s.write(10003, {0x0201, 0x0403, 0x0605, 0x0807});
  for (std::uint16_t dlc = 0; dlc <= 8; ++dlc) {
    s.write(10002, dlc);
    s.exchange();
    s.tx(0x123, Bytes(all.begin(), all.begin() + dlc)).no_tx();
  }
  s.write(10002, 9);
  s.expect(10002, 8).expect(29, 0x0040).expect(39, 10002);
}

TEST_P(Layer2RemoteFrames, IdentifierWidth_FollowsTheMode) {
  spec("ME3-L2-044 ME3-L2-005", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2(29);
  s.write(6000, {0xFFFF, 0x7FFF, 0, 0}).write(10000, {0xF100, 0x18FE, 1, 0x44});
  s.write(6004, {0x0123, 0, 0, 0});
  s.write(8450, {0x0001, 0x1000, 0});
  s.online();
  s.exchange();
  s.tx(extended(0x18FEF100, {0x44}));
  s.rx(remote(0x18FEF100, 1, true));
  s.tx(extended(0x18FEF100, {0x44}));
  s.rx(remote(0x100, 1));
  s.rx(0x123, {1});
  s.exchange();
  s.tx(extended(0x18FEF100, {0x44})).expect(10009, 0);
  s.rx(extended(0x123, {1}));
  s.exchange();
  s.tx(extended(0x18FEF100, {0x44})).expect(10009, 0x0301);
  s.cif({0x000C, 0x0123, 0x0000, 0, 1, 0x55});
  s.tx(extended(0x123, {0x55}));
  s.cpu(module::CpuState::stop);
  s.tx(extended(0x10000001, {})).no_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_layer2_remote_frames_test
