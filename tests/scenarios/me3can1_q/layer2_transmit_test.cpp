// spec/me3can1-q/scenarios.md, section 8: Layer 2 modes - transmit slots, remote frames, triggers, RUN to
// STOP, command interface.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {
namespace {

CANOPUS_OF_BOTH_MODULES(Layer2Transmit);

can::Frame extended(std::uint32_t identifier, const Bytes& bytes) {
  can::Frame frame = can::data_frame(0, bytes);
  frame.identifier = identifier;
  frame.extended = true;
  return frame;
}

can::Frame remote(std::uint32_t identifier, std::uint8_t dlc, bool is_extended = false) {
  return {.identifier = identifier, .extended = is_extended, .remote = true, .dlc = dlc};
}

// Slot 1 sends 123H, as G6001 and G6002 (and D) say; online.
void one_slot(IntelligentScenario& s, std::uint16_t b, std::uint16_t type, std::uint16_t dlc_word,
              std::uint16_t cycle = 0) {
  s.power_on_layer2();
  s.write(6000, {0xFFFF, b, type, cycle}).write(10000, {0x0123, 0, dlc_word});
  s.online();
}

TEST_P(Layer2Transmit, S17_S44_TriggerFlags) {
  spec("ME3-IO-011 ME3-L2-018 ME3-L2-020 ME3-L2-022", "RJ71-L2TX-012 RJ71-L2TX-006");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x5FFF, 4, 0x0002);
  s.write(10003, 0xBBAA);
  s.exchange();
  s.no_tx();  // type 4: Y01 only refreshes
  s.write(8400, 1).advance(1s);
  s.no_tx().expect(8400, 1).expect_x(0x04, false);
  s.y(0x04, true);
  s.tx(0x123, {0xAA, 0xBB}).expect(8400, 0).expect_x(0x04, true);
  s.write(8400, 1).advance(1s);
  s.no_tx().expect(8400, 1);  // only with the next Y04
  s.y(0x04, false);
  s.expect_x(0x04, false);
  s.y(0x04, true);
  s.tx(0x123, {0xAA, 0xBB}).expect(8400, 0).expect_x(0x04, true);
  s.y(0x04, false);
  s.y(0x04, true);  // nothing flagged: done at once
  s.no_tx().expect_x(0x04, true);
  s.y(0x04, false);
  // New words without Y01 are not what is sent.
  s.write(10003, 0x2211).write(8400, 1).y(0x04, true);
  s.tx(0x123, {0xAA, 0xBB});
}

// Once X04 has come, Y04 has done its work, whatever else the module sends while it stays ON.
TEST_P(Layer2Transmit, Trigger_FlagsSetAfterX04_WaitForTheNextY04) {
  spec("ME3-IO-011 ME3-L2-020", "RJ71-L2TX-012");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x5FFF, 4, 0}).write(10000, {0x0123, 0, 1, 0x11});
  s.write(6004, {0xFFFF, 0x5FFF, 0, 0}).write(10007, {0x0124, 0, 1, 0x22});
  s.online();
  s.write(8400, 1).y(0x04, true);
  s.tx(0x123, {0x11}).expect_x(0x04, true);
  s.write(8400, 1);
  s.exchange();
  s.tx(0x124, {0x22}).no_tx().expect(8400, 1).expect_x(0x04, true);
  s.y(0x04, false).y(0x04, true);
  s.tx(0x123, {0x11}).no_tx().expect(8400, 0);
  // A restart takes X03 and X04 away, although Y03 and Y04 stay ON.
  s.y(0x02, true).expect_x(0x03, false).expect_x(0x04, false);
  s.advance(5999ms).expect_x(0x03, false).expect_x(0x04, false).no_tx();
  s.wait_x(0x02, true).y(0x02, false).no_tx();
}

TEST_P(Layer2Transmit, Trigger_SendsASlotOfAnyType) {
  spec("ME3-L2-020 ME3-IO-011", "RJ71-L2TX-012");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  for (std::uint16_t type = 0; type <= 4; ++type) {
    s.write(6000 + 4U * type,
            {0xFFFF, static_cast<std::uint16_t>(type % 2 == 0 ? 0x5FFF : 0x7FFF), type, 1000});
    s.write(10000 + 7U * type, {static_cast<std::uint16_t>(0x200 + type), 0, 1, type});
  }
  s.online();
  s.write(8400, 0x001F).y(0x04, true);
  for (std::uint8_t type = 0; type <= 4; ++type) s.tx(0x200U + type, {type});
  s.no_tx().expect(8400, 0).expect_x(0x04, true);
}

// A request that is ON before the module is online is carried out when it is.
TEST(Me3Layer2Transmit, Trigger_RequestedOffline_IsCarriedOutOnline) {
  RecordProperty("spec", "ME3-IO-011 ME3-L2-009");
  IntelligentScenario s;
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x5FFF, 4, 0}).write(10000, {0x0123, 0, 1, 0x11});
  s.write(8400, 1).y(0x04, true).advance(1s).no_tx().expect(8400, 1).expect_x(0x04, false);
  s.online();
  s.tx(0x123, {0x11}).no_tx().expect(8400, 0).expect_x(0x04, true);
}

TEST_P(Layer2Transmit, Trigger_OfReceiveAndDisabledSlots_IsDiscarded) {
  spec("ME3-L2-021 ME3-IO-011", "RJ71-L2TX-012");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(6000, {0x0181, 0, 0, 0});
  s.online();
  s.write(8400, {0x0003, 0x8000, 0xFE00})
      .expect(8400, {0x0003, 0x8000, 0x0200});  // bits 10-15 of G8402: none
  s.y(0x04, true);
  s.no_tx().expect(8400, {0, 0, 0}).expect_x(0x04, true).expect(29, 0);
}

TEST_P(Layer2Transmit, Trigger_WaitsForATransmitBuffer) {
  spec("ME3-IO-011", "RJ71-L2TX-012");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x5FFF, 4, 0}).write(10000, {0x0123, 0, 1, 1});
  s.write(6004, {0xFFFF, 0x5FFF, 4, 0}).write(10007, {0x0124, 0, 1, 2});
  s.online();
  s.write(8400, 3);
  s.controller().accepts = false;
  s.y(0x04, true).advance(1s);
  s.no_tx().expect(8400, 3).expect_x(0x04, false).expect(29, 0);
  s.y(0x04, false);
  s.controller().accepts = true;
  s.advance(1s);
  s.no_tx().expect(8400, 3);  // no request any more
  s.controller().accepts = false;
  s.y(0x04, true);
  s.controller().accepts = true;
  s.plug_in().transmitted(can::data_frame(0x555), s.now());  // a frame of another origin has left
  s.tx(0x123, {1}).tx(0x124, {2}).expect(8400, 0).expect_x(0x04, true);
}

TEST_P(Layer2Transmit, TriggerAndRtrFlags_OneBitPerSlot) {
  spec("ME3-L2-022 ME3-L2-023", "");
  for (const std::uint16_t slot : Words{1, 2, 16, 17, 28, 32, 33, 41, 42}) {
    IntelligentScenario s(GetParam());
    s.power_on_layer2();
    const auto index = static_cast<module::BufferAddress>(slot - 1);
    s.write(6000 + 4 * index, {0xFFFF, 0x6FFF, 4, 0}).write(10000 + 7 * index, {0x0123, 0, 1, slot});
    s.online();
    s.rx_remote(0x123, 1);
    Words flags(3, 0);
    flags[index / 16] = static_cast<std::uint16_t>(1U << (index % 16));
    s.expect(8350, flags);
    s.write(8400, flags).y(0x04, true);
    s.tx(0x123, {static_cast<std::uint8_t>(slot)}).no_tx();
    s.expect(8350, {0, 0, 0}).expect(8400, {0, 0, 0});
  }
}

TEST_P(Layer2Transmit, S45_Type0_SendsWithEveryY01) {
  spec("ME3-L2-014", "RJ71-L2TX-002");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x5FFF, 0, 0x0003);
  s.write(10003, {0x2211, 0x9933});
  s.advance(1s);
  s.no_tx();
  s.exchange();
  s.tx(0x123, {0x11, 0x22, 0x33});
  s.exchange();
  s.tx(0x123, {0x11, 0x22, 0x33});
  s.write(10004, 0x0044);
  s.exchange();
  s.tx(0x123, {0x11, 0x22, 0x44}).no_tx();
}

TEST(Me3Layer2Transmit, S45_Type1_SendsWithY01IfTheDataChanged) {
  RecordProperty("spec", "ME3-L2-015");
  IntelligentScenario s;
  one_slot(s, 0x5FFF, 1, 0x0002);
  s.exchange();
  s.no_tx();  // nothing has changed since going online
  s.write(10003, 0x2211);
  s.advance(1s);
  s.no_tx();
  s.exchange();
  s.tx(0x123, {0x11, 0x22});
  s.exchange();
  s.exchange();
  s.no_tx();
  s.write(10004, 0x3333);  // beyond the DLC: the message is the same
  s.exchange();
  s.no_tx();
  s.write(10003, 0x2212);
  s.exchange();
  s.tx(0x123, {0x12, 0x22});
  s.write(10003, 0x0000).write(10003, 0x2212);  // back again before Y01
  s.exchange();
  s.no_tx();
  s.write(10003, 0x5555);
  s.controller().accepts = false;
  s.exchange();  // lost: still to be sent
  s.expect(29, 0x0100);
  s.controller().accepts = true;
  s.exchange();
  s.tx(0x123, {0x55, 0x55});
  s.exchange();
  s.no_tx();
  // What was sent by a trigger was sent.
  s.write(10003, 0x6666);
  s.controller().accepts = false;
  s.exchange();
  s.controller().accepts = true;
  s.write(8400, 1).y(0x04, true).tx(0x123, {0x66, 0x66}).y(0x04, false);
  s.exchange();
  s.no_tx();
  s.write(10002, 0x0001);  // another length is another message
  s.exchange();
  s.tx(0x123, {0x66});
  s.exchange();
  s.no_tx();
}

TEST_P(Layer2Transmit, S46_Type2_SendsEveryCycle_WithTheDataOfTheLastY01) {
  spec("ME3-L2-016 ME3-L2-019", "RJ71-L2TX-004");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x5FFF, 2, 0x0001, 10);  // 10 times 10 ms
  const can::Time start = s.now();
  s.advance(99ms);
  s.no_tx();
  s.advance(1ms);
  s.tx(0x123, {0x00});
  s.write(10003, 0x0011);
  s.advance(100ms);
  s.tx(0x123, {0x00});  // not yet exchanged
  s.exchange();
  s.no_tx();
  s.advance(start + 299ms - s.now());
  s.no_tx();
  s.advance(1ms);
  s.tx(0x123, {0x11});
  s.advance(1s);
  for (int i = 0; i < 10; ++i) s.tx(0x123, {0x11});
  s.no_tx();
}

TEST_P(Layer2Transmit, S46_Type3_SendsInTheCycleAfterAChange) {
  spec("ME3-L2-017 ME3-L2-019", "RJ71-L2TX-005");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x5FFF, 3, 0x0001, 10);
  const can::Time start = s.now();
  s.advance(250ms);
  s.no_tx();
  s.write(10003, 0x0011);
  s.advance(100ms);
  s.no_tx();  // not yet exchanged
  s.exchange();
  s.advance(start + 399ms - s.now());
  s.no_tx();
  s.advance(1ms);
  s.tx(0x123, {0x11});
  s.advance(1s);
  s.no_tx();
  s.write(10003, 0x0012);
  s.exchange();
  s.write(10003, 0x0013);
  s.exchange();
  s.advance(100ms);
  s.tx(0x123, {0x13}).no_tx();  // once, with the last of them
  // Sent by a trigger, or back as it was, is not changed since the last transmission.
  s.write(10003, 0x0014);
  s.exchange();
  s.write(8400, 1).y(0x04, true).tx(0x123, {0x14}).y(0x04, false);
  s.advance(1s);
  s.no_tx();
  s.write(10003, 0x0015);
  s.exchange();
  s.write(10003, 0x0014);
  s.exchange();
  s.advance(1s);
  s.no_tx();
}

// An answer to a remote frame is a transmission, too, and so is one that takes the RTR flag away.
TEST_P(Layer2Transmit, Type3_AnswersCountAsSent_AndCyclesClearTheRtrFlag) {
  spec("ME3-L2-017 ME3-L2-016 ME3-L2-025 ME3-L2-010",
       "RJ71-L2TX-005 RJ71-L2TX-004 RJ71-L2RTR-004 RJ71-L2RTR-003");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x7FFF, 3, 10}).write(10000, {0x0123, 0, 1, 0x11});
  s.write(6004, {0xFFFF, 0x6FFF, 2, 10}).write(10007, {0x0124, 0, 1, 0x22});
  s.online();
  s.write(10003, 0x0012);
  s.exchange();
  s.rx_remote(0x123, 1).tx(0x123, {0x12}).expect(8350, 0);
  s.rx_remote(0x124, 1).no_tx().expect(8350, 0x0002);
  s.advance(98ms).no_tx().expect(8350, 0x0002);
  s.advance(1ms);
  s.tx(0x124, {0x22}).no_tx().expect(8350, 0);
}

TEST_P(Layer2Transmit, CycleTime0_IsForcedTo1_ForTypes2And3) {
  spec("ME3-L2-019", "");
  for (const std::uint16_t type : Words{2, 3}) {
    IntelligentScenario s(GetParam());
    one_slot(s, 0x5FFF, type, 0x0001, 0);
    s.expect(6003, 1);
    s.write(10003, 0x0011);
    s.exchange();  // 1 ms
    s.advance(8ms);
    s.no_tx();
    s.advance(1ms);
    s.tx(0x123, {0x11});
    s.advance(10ms);
    if (type == 2) s.tx(0x123, {0x11});
    s.no_tx();
  }
  for (const std::uint16_t type : Words{0, 1, 4}) {
    IntelligentScenario s(GetParam());
    one_slot(s, 0x5FFF, type, 0x0001, 0);
    s.expect(6003, 0).advance(1s);
    s.no_tx();
  }
  for (const std::uint16_t type : Words{0, 1, 4}) {  // a cycle time means nothing to them
    IntelligentScenario s(GetParam());
    one_slot(s, 0x5FFF, type, 0x0001, 1);
    s.advance(1s);
    s.no_tx();
  }
}

TEST(Me3Layer2Transmit, CycleTimeInMilliseconds_IsAChoice) {
  RecordProperty("spec", "ME3-L2-019");
  RamMemory memory;
  FreeBus bus;
  module::me3can1_q::Me3can1Q module(bus, memory, {.layer2_cycle_unit = 1ms});
  ASSERT_TRUE(module.preset_word(21, 11));
  ModuleScenario s(module, bus);
  s.supply_on().wait_bit(25, 7, false);
  s.write(6000, {0xFFFF, 0x5FFF, 2, 5}).write(10000, {0x0123, 0, 0}).y(0x03, true);
  s.advance(4ms);
  s.no_tx();
  s.advance(1ms);
  s.tx(0x123).no_tx();
}

TEST_P(Layer2Transmit, S47_AutomaticRtrResponse) {
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

TEST_P(Layer2Transmit, S47_ManualRtrResponse) {
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

TEST_P(Layer2Transmit, S47_RtrHandlingDisabled) {
  spec("ME3-L2-012", "RJ71-L2RTR-005");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x5FFF, 0, 0x0002);
  s.rx_remote(0x123, 2).advance(1s);
  s.no_tx().expect(8350, {0, 0, 0}).expect(10002, 2).expect(29, 0);
}

TEST(Me3Layer2Transmit, S47_StrictDlcCheck) {
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

TEST(Me3Layer2Transmit, S48_28SlotLimit) {
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

TEST_P(Layer2Transmit, S48_AsPrinted_30Slots) {
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

TEST(Me3Layer2Transmit, SendRtrFrame) {
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
TEST(Me3Layer2Transmit, SendRtrFrame_ByCycleAndTrigger_WithTheDlcOfTheLastY01) {
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

TEST_P(Layer2Transmit, RemoteFrames_In405Mode_AreForNodeGuardingAlone) {
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

TEST(Me3Layer2Transmit, Dlc_0To8) {
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

TEST_P(Layer2Transmit, IdentifierWidth_FollowsTheMode) {
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

TEST_P(Layer2Transmit, S52_RunToStopMessages) {
  spec("ME3-L2-040 ME3-L2-041 ME3-L2-042", "RJ71-STOPMSG-001");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(8450, {0x0100, 0, 0x0001, 0x0055});
  s.online();
  s.cpu(module::CpuState::stop);
  s.tx(0x100, {0x55}).no_tx();
  s.cpu(module::CpuState::stop).cpu(module::CpuState::run).advance(1s);
  s.no_tx();  // only the edge from RUN to STOP
  s.cpu(module::CpuState::stop);
  s.tx(0x100, {0x55}).no_tx();
  s.cpu(module::CpuState::run);
  s.offline();
  s.cpu(module::CpuState::stop).cpu(module::CpuState::run);
  s.no_tx();
  s.write(8452, 0x8001);
  s.expect(8452, 1).expect(29, 0x0040).expect(39, 8452);
  s.clear_errors();
  s.write(8450, {0x0400, 0, 8, 0x0201, 0x0403, 0x0605, 0x0807});
  s.write(8457, {0x0300, 0, 0});
  s.write(8471, {0x0001, 0, 2, 0x2211});
  s.online();
  s.cpu(module::CpuState::stop);
  s.tx(0x400, {1, 2, 3, 4, 5, 6, 7, 8}).tx(0x300).tx(0x001, {0x11, 0x22}).no_tx();
}

// One that waits for room when the module is restarted is gone.
TEST_P(Layer2Transmit, RunToStopMessages_AreEndedByARestart) {
  spec("ME3-L2-040 ME3-IO-004", "RJ71-STOPMSG-001");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(8450, {0x0100, 0, 0x0001, 0x0055, 0, 0, 0, 0x0200, 0, 0x0001, 0x0066});
  s.save();
  s.online();
  s.controller().accepts = false;
  s.cpu(module::CpuState::stop).cpu(module::CpuState::run);
  s.restart();
  s.controller().accepts = true;
  s.expect_x(0x03, true).advance(1s).no_tx();
  s.cpu(module::CpuState::stop);
  s.tx(0x100, {0x55}).tx(0x200, {0x66}).no_tx();
}

TEST(Me3Layer2Transmit, S53_CifLayer2Send) {
  RecordProperty("spec", "ME3-CIF-027");
  IntelligentScenario s;
  s.power_on_layer2();
  s.online();
  s.cif({0x000C, 0x0321, 0, 0, 3, 0x0201, 0x0003});
  s.tx(0x321, {1, 2, 3}).expect(1000, {0x000D, 0, 0, 0, 0});
  s.cif({0x000C, 0x0321, 0, 1, 3});
  s.tx(remote(0x321, 3)).expect(1000, {0x000D, 0, 0, 0, 0});
  s.cif({0x000C, 0x07FF, 0, 0, 8, 0x0201, 0x0403, 0x0605, 0x0807});
  s.tx(0x7FF, {1, 2, 3, 4, 5, 6, 7, 8}).expect(1000, {0x000D, 0, 0, 0, 0});
  s.cif({0x000C, 0, 0, 0, 0, 0x1111});
  s.tx(0x000).no_tx();
  // Offline, bus-off and with a full buffer there is no sending.
  s.offline();
  s.cif({0x000C, 0x0321, 0, 0, 0});
  s.expect(1000, {0x000F, 0x0F0F}).no_tx();
  s.online();
  s.error_counters(256, 0);
  s.cif({0x000C, 0x0321, 0, 0, 0});
  s.expect(1000, {0x000F, 0xB0FF}).no_tx();
  s.error_counters(0, 0);
  s.controller().accepts = false;
  s.cif({0x000C, 0x0321, 0, 0, 0});
  s.expect(1000, {0x000F, 0x8FFF}).expect(29, 0x0100);
}

TEST_P(Layer2Transmit, S34_LayerTwoSendIn405Mode_IsUnknown) {
  spec("ME3-CIF-027", "RJ71-L2CIF-001");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.cif({0x000C, 0x0321, 0, 0, 0});
  s.expect(1000, {0x000F, 0x0064}).no_tx();
}

TEST_P(Layer2Transmit, S53_CifSettingError) {
  spec("ME3-CIF-028", "RJ71-L2CIF-002");
  const auto wrong = [](std::uint16_t mode, const Words& parameters, const std::vector<bool>& faults) {
    IntelligentScenario s(GetParam());
    s.power_on_layer2(mode);
    s.online();
    Words command{0x000C};
    command.insert(command.end(), parameters.begin(), parameters.end());
    s.cif(command);
    s.no_tx().expect(1000, 0xF00C).expect(29, 0);
    for (std::size_t i = 0; i < faults.size(); ++i) {
      EXPECT_EQ(s.read(1001 + static_cast<module::BufferAddress>(i)) != 0, faults[i]) << i;
    }
  };
  wrong(11, {0x0321, 0, 0, 9}, {false, false, false, true});
  wrong(11, {0x0321, 0, 2, 8}, {false, false, true, false});
  wrong(11, {0x0800, 0, 1, 8}, {true, false, false, false});
  wrong(11, {0x0321, 1, 0, 0}, {false, true, false, false});
  wrong(29, {0xFFFF, 0x2000, 0, 0}, {false, true, false, false});
  wrong(29, {0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF}, {false, true, true, true});
  wrong(11, {0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF}, {true, true, true, true});
  IntelligentScenario s(GetParam());
  s.power_on_layer2(29);
  s.online();
  s.cif({0x000C, 0xFFFF, 0x1FFF, 0, 0});
  s.tx(extended(0x1FFFFFFF, {})).expect(1000, 0x000D);
}

TEST_P(Layer2Transmit, TransmitQueueOverflow_SetsG29Bit8) {
  spec("ME3-L2-014 ME3-IO-012", "RJ71-L2TX-002");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x5FFF, 0, 0x0000);
  s.controller().accepts = false;
  s.exchange();
  s.expect(29, 0x0100).expect_x(0x0F, true);
  s.controller().accepts = true;
  s.exchange();
  s.tx(0x123).no_tx();  // no emergency message in a Layer 2 mode
}

TEST(Me3Layer2Transmit, DataExchange_WithAnyG20) {
  RecordProperty("spec", "ME3-DX-010");
  IntelligentScenario s;
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x5FFF, 0, 0}).write(10000, {0x0123, 0, 2});
  s.write(6164, {0x0181, 0, 0, 0});
  s.online();
  for (const std::uint16_t g20 : Words{0x0000, 0x0100, 0x1000, 0x1100}) {
    s.write(20, g20);
    s.write(10003, static_cast<std::uint16_t>(g20 | 1U)).write(10289, 0);
    s.rx(0x181, {0xA1, static_cast<std::uint8_t>(g20 >> 8)});
    s.advance(1s);
    s.no_tx().expect_bit(10289, 9, false);
    s.y(0x01, true);
    s.write(10003, 0x7777);  // after the request: for the next one
    s.wait_x(0x01, true);
    s.tx(0x123, {0x01, static_cast<std::uint8_t>(g20 >> 8)}).no_tx();
    s.expect(10287, {0x0181, 0, 0x0302}).expect(20, 0);
    s.y(0x01, false);
    s.expect_x(0x01, false);
  }
}

}  // namespace
}  // namespace canopus::scenario
