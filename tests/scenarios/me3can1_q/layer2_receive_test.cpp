// spec/me3can1-q/scenarios.md, section 8: Layer 2 modes - receive slots.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_layer2_receive_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Layer2Receive);

// High byte of RTR/new/DLC of slot 1.
void expect_flags(IntelligentScenario& s, unsigned flags, Where where = Where::current()) {
  const auto high = static_cast<unsigned>(s.read(10002) >> 8);
  EXPECT_EQ(high, flags) << "line " << where.line();
}

// Slot 1 receives, with this identifier and mask; online.
void one_slot(IntelligentScenario& s, std::uint16_t identifier, std::uint16_t mask = 0) {
  s.power_on_layer2();
  s.write(6000, {identifier, 0, mask, 0});
  s.online();
}

TEST_P(Layer2Receive, S49_FilterExample1) {
  spec("ME3-L2-006 ME3-L2-027 ME3-L2-029 ME3-L2-030 ME3-L2-032 ME3-L2-033", "RJ71-L2RX-001");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x0181);
  s.rx(0x181, {0x99});
  s.exchange();  // (1)
  s.expect(10000, {0x0181, 0, 0x0301, 0x0099});
  s.write(10002, 0x0001);
  s.exchange();  // (2)
  expect_flags(s, 0x00);
  s.advance(1ms);
  s.rx(0x181, {0xA1});
  expect_flags(s, 0x00);  // the words change with Y01
  s.exchange();           // (3)
  s.expect(10000, {0x0181, 0, 0x0301, 0x00A1, 0, 0, 0});
  s.write(10002, 0x0000);
  for (const std::uint8_t data : Bytes{0xB1, 0xC1, 0xD1}) s.rx(0x181, {data}).advance(1ms);
  s.exchange();  // (4)
  s.expect(10000, {0x0181, 0, 0x0701, 0x00D1, 0, 0, 0});
  s.write(10002, 0x0000);
  s.rx(0x182, {0xE1}).rx(0x180, {0xE1}).rx(0x081, {0xE1}).rx(0x581, {0xE1});
  s.exchange();
  s.expect(10000, {0x0181, 0, 0x0001, 0x00D1}).expect(29, 0);
}

// A first message of nothing but zeros is new data; the other frame format is another message.
TEST(Me3Layer2Receive, FirstMessage_IsNewData_WhateverItHolds) {
  RecordProperty("spec", "ME3-L2-029 ME3-L2-031 ME3-L2-044");
  IntelligentScenario s;
  one_slot(s, 0x0000);
  s.rx(can::Frame{.identifier = 0x000, .extended = true, .dlc = 1, .data = {1}});
  s.exchange();
  s.expect(10000, {0xFFFF, 0xFFFF, 0x0000, 0});
  s.rx(0x000);
  s.exchange();
  s.expect(10000, {0x0000, 0x0000, 0x0300, 0});
  s.write(10002, 0).rx(0x000);
  s.exchange();
  s.expect(10002, 0x0200);
  // Going online begins anew: the same message is a new one again.
  s.write(10002, 0);
  s.offline().online().rx(0x000);
  s.exchange();
  s.expect(10002, 0x0300);
}

TEST_P(Layer2Receive, S50_FilterExample2) {
  spec("ME3-L2-028 ME3-L2-030", "RJ71-L2RX-002 RJ71-L2RX-006");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(6004, {0x0180, 0, 0x0006, 0});
  s.online();
  for (std::uint32_t identifier = 0x100; identifier < 0x200; ++identifier) {
    const bool passes =
        identifier == 0x180 || identifier == 0x182 || identifier == 0x184 || identifier == 0x186;
    s.write(10009, 0);
    s.rx(identifier, {static_cast<std::uint8_t>(identifier & 0xFF)});
    s.exchange();
    EXPECT_EQ(s.read(10009) >> 8 != 0, passes) << std::hex << identifier;
    if (passes)
      s.expect(10007, {static_cast<std::uint16_t>(identifier), 0})
          .expect(10010, static_cast<std::uint16_t>(identifier & 0xFF));
  }
  s.write(10009, 0);
  s.rx(0x182, {0xB1}).advance(1ms).rx(0x186, {0xC1}).advance(1ms).rx(0x180, {0xD1});
  s.exchange();
  s.expect(10007, {0x0180, 0, 0x0701, 0x00D1});
  s.expect(10000, {0xFFFF, 0xFFFF, 0, 0});  // no other slot
}

TEST_P(Layer2Receive, Mask_CoversAll29Bits) {
  spec("ME3-L2-028 ME3-L2-006", "RJ71-L2RX-002 RJ71-L2RX-006");
  IntelligentScenario s(GetParam());
  s.power_on_layer2(29);
  s.write(6000, {0x5678, 0x1234, 0x00FF, 0x0100});
  s.online();
  const auto passes = [&](std::uint32_t identifier) {
    s.write(10002, 0);
    s.rx(can::Frame{.identifier = identifier, .extended = true, .dlc = 1, .data = {9}});
    s.exchange();
    return (s.read(10002) >> 8) != 0;
  };
  EXPECT_TRUE(passes(0x12345678));
  EXPECT_TRUE(passes(0x13345600));
  s.expect(10000, {0x5600, 0x1334});
  EXPECT_FALSE(passes(0x12345778));
  EXPECT_FALSE(passes(0x10345678));
  EXPECT_FALSE(passes(0x678));
}

TEST_P(Layer2Receive, S51_SameDataAgain) {
  spec("ME3-L2-031", "");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x0180, 0x0006);
  const auto next = [&](std::uint32_t identifier, const Bytes& data) {
    s.write(10002, 0);
    s.advance(1ms);
    s.rx(identifier, data);
    s.exchange();
    return s.read(10002) >> 8;
  };
  EXPECT_EQ(next(0x180, {0xA1}), 3);
  EXPECT_EQ(next(0x180, {0xA1}), 2);
  s.expect(10002, 0x0201).expect(10003, 0x00A1);
  EXPECT_EQ(next(0x180, {0xA1, 0x00}), 3);  // another DLC
  EXPECT_EQ(next(0x182, {0xA1, 0x00}), 3);  // another identifier
  EXPECT_EQ(next(0x182, {0xA1, 0x01}), 3);  // other data
  EXPECT_EQ(next(0x182, {0xA1, 0x01}), 2);
}

TEST(Me3Layer2Receive, FlagTable_Table3_38) {
  RecordProperty("spec", "ME3-L2-029 ME3-L2-030 ME3-L2-031 ME3-L2-032");
  IntelligentScenario s;
  one_slot(s, 0x0181);
  const auto flags_after = [&](const std::vector<std::uint8_t>& messages) {
    s.write(10002, 0);
    for (const std::uint8_t message : messages) s.rx(0x181, {message}).advance(1ms);
    s.exchange();
    return s.read(10002) >> 8;
  };
  EXPECT_EQ(flags_after({}), 0);
  EXPECT_EQ(flags_after({1}), 3);
  EXPECT_EQ(flags_after({1}), 2);
  EXPECT_EQ(flags_after({1, 1}), 6);
  EXPECT_EQ(flags_after({1, 2}), 7);
  EXPECT_EQ(flags_after({2, 2, 2}), 6);
  EXPECT_EQ(flags_after({}), 0);
  EXPECT_EQ(flags_after({3}), 3);
}

TEST_P(Layer2Receive, FlagsAreTheProgramsToClear) {
  spec("ME3-L2-032 ME3-L2-033 ME3-L2-030", "");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x0181);
  s.rx(0x181, {1});
  s.exchange();
  s.exchange();
  s.advance(1s);
  s.exchange();
  expect_flags(s, 3);  // the module does not take them away
  s.rx(0x181, {1});
  s.exchange();
  expect_flags(s, 7);  // not cleared since: overflow
  s.write(10002, 0x0001);
  s.exchange();
  expect_flags(s, 0);
  s.rx(0x181, {2});
  s.exchange();
  expect_flags(s, 3);
}

TEST_P(Layer2Receive, ShortFrames_LeaveZeros) {
  spec("ME3-L2-034 ME3-L2-029", "RJ71-L2RX-007");
  IntelligentScenario s(GetParam());
  one_slot(s, 0x0181);
  const Bytes all{1, 2, 3, 4, 5, 6, 7, 8};
  const std::vector<unsigned> words{0x0201, 0x0403, 0x0605, 0x0807};
  for (std::size_t dlc = 8; dlc <= 8; --dlc) {
    s.rx(0x181, Bytes(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(dlc))).advance(1ms);
    s.write(10002, 0);
    s.exchange();
    s.expect(10007, {0xFFFF, 0xFFFF, 0});  // the next slot's words are not touched
    s.expect(10002, static_cast<std::uint16_t>(0x0300 | dlc));
    for (std::size_t word = 0; word < 4; ++word) {
      unsigned wanted = 0;
      if (2 * word < dlc) wanted = words[word] & 0x00FF;
      if (2 * word + 1 < dlc) wanted = words[word];
      s.expect(10003 + static_cast<module::BufferAddress>(word), static_cast<std::uint16_t>(wanted));
    }
  }
}

TEST(Me3Layer2Receive, RemoteFrames_AreNotStored) {
  RecordProperty("spec", "ME3-L2-035");
  IntelligentScenario s;
  one_slot(s, 0x0181);
  s.rx_remote(0x181, 4);
  s.exchange();
  s.expect(10000, {0xFFFF, 0xFFFF, 0, 0}).expect(8350, {0, 0, 0});
  s.rx(0x181, {1});
  s.exchange();
  s.expect_bit(10002, 15, false).expect_bit(10002, 12, false).no_tx();
}

// Each slot has an error code of its own.
TEST(Me3Layer2Receive, EverySlotsOverflow_IsShownAtItsErrorCode) {
  RecordProperty("spec", "ME3-L2-002 ME3-L2-004 ME3-L2-039");
  IntelligentScenario s;
  s.power_on_layer2();
  for (module::BufferAddress slot = 0; slot < 42; ++slot)
    s.write(6000 + 4 * slot, {static_cast<std::uint16_t>(0x100 + slot), 0, 0, 0});
  s.online();
  for (module::BufferAddress slot = 0; slot < 42; ++slot) {
    for (int i = 0; i < 20; ++i) s.rx(0x100 + slot, {});
    for (module::BufferAddress other = 0; other < 42; ++other)
      s.expect(5001 + other, other == slot ? 0x2000 : 0);
    s.expect(29, 0x8000).write(5001 + slot, 0).write(29, 0).expect(29, 0).advance(1s);
  }
  for (int i = 0; i < 100; ++i) s.rx(0x000, {}).rx(0x7FF, {});  // nobody's
  s.expect(29, 0).expect(5001, Words(42, 0));
  // Slots that are not used do not receive, 000H for one.
  s.offline();
  for (module::BufferAddress slot = 0; slot < 42; ++slot) s.write(6000 + 4 * slot, {0xFFFF, 0xFFFF});
  s.write(6000, {0x0000, 0x0000}).write(6164, {0xFFFF, 0x5FFF, 4, 0}).write(10287, {0x0123, 0});
  s.online();
  for (int i = 0; i < 20; ++i) s.rx(0x000, {});
  s.expect(5001, 0x2000).expect(5002, Words(41, 0)).expect(29, 0x8000);
}

TEST_P(Layer2Receive, OneMessage_InEverySlotThatLetsItPass) {
  spec("ME3-L2-006 ME3-L2-002", "RJ71-L2-001");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  for (module::BufferAddress slot = 0; slot < 42; ++slot) s.write(6000 + 4 * slot, {0x0181, 0, 0, 0});
  s.online();
  s.rx(0x181, {0x5A});
  s.exchange();
  for (module::BufferAddress slot = 0; slot < 42; ++slot) {
    s.expect(10000 + 7 * slot, {0x0181, 0, 0x0301, 0x005A, 0, 0, 0});
  }
  s.expect(29, 0);
}

TEST(Me3Layer2Receive, S55_ReceiveOverflow) {
  RecordProperty("spec", "ME3-L2-039 ME3-ERR-008 ME3-ERR-009 ME3-IO-012 ME3-IO-013");
  IntelligentScenario s;
  s.power_on_layer2();
  s.write(6000, {0x0181, 0, 0, 0}).write(6164, {0x0182, 0, 0, 0});
  s.online();
  // At the pace of a bus of 1 Mbit/s full of frames of 8 bytes nothing is lost.
  for (int i = 0; i < 1000; ++i) s.rx(0x181, {1}).advance(111us);
  s.expect(5001, 0).expect(29, 0);
  // Frames without data come twice as fast.
  for (int i = 0; i < 100; ++i) s.rx(0x181, {}).advance(50us);
  s.expect(5001, 0x2000).expect(5042, 0).expect(29, 0x8000).expect_x(0x0F, true);
  s.advance(1s);
  // Latched, and shown as long as the code stands.
  s.y(0x0F, true);
  s.expect(29, 0).expect_x(0x0F, false).expect(5001, 0x2000);
  s.y(0x0F, false);
  s.expect(29, 0x8000).expect_x(0x0F, true);
  s.write(5001, 0);
  s.expect(5001, 0).expect(29, 0x8000).expect_x(0x0F, true);
  s.y(0x0F, true).y(0x0F, false);
  s.expect(29, 0).expect_x(0x0F, false);
  for (int i = 0; i < 20; ++i) s.rx(0x182, {});
  s.expect(5001, 0).expect(5042, 0x2000).expect(29, 0x8000);
  s.write(5042, 0).write(29, 0);
  s.expect(29, 0).no_tx();
  // A code is only taken away by the program.
  s.write(5001, 1);
  s.expect(5001, 0).expect(29, 0x0040).expect(39, 5001);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_layer2_receive_test
