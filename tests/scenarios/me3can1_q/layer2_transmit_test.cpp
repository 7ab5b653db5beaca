// spec/me3can1-q/scenarios.md, section 8: Layer 2 modes - transmit slots, triggers, cycles (S44 to S46).

#include "scenarios/me3can1_q/layer2_frames.hpp"

namespace canopus::scenario::me3can1_q_layer2_transmit_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Layer2Transmit);

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

}  // namespace
}  // namespace canopus::scenario::me3can1_q_layer2_transmit_test
