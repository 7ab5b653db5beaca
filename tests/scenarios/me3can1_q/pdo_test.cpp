// spec/me3can1-q/scenarios.md, section 7: PDOs and data exchange; and S30, S31 of section 6.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {
namespace {

CANOPUS_OF_BOTH_MODULES(Pdo);
CANOPUS_OF_BOTH_MODULES(ProcessData);

// Node 1, Operational.
void operational(IntelligentScenario& s) {
  s.power_on_as(1);
  s.nmt(0x01);
  s.expect_bit(25, 0, true);
  s.ignore_tx();
}

TEST_P(Pdo, S30_RpdoMappingExample) {
  spec("ME3-PDO-004", "RJ71-PDO-005 RJ71-PDO-006");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  // Out of order it is refused: the PDO is valid, or entries are mapped.
  s.cif({0x0002, 0, 0x1600, 0, 1, 0});
  s.expect_abort(0x08000022);
  s.cif({0x0002, 0, 0x1600, 1, 4, 0x0110, 0xA580});
  s.expect_abort(0x08000022);
  s.set_object(0x1400, 1, 0x80000201, 4);
  s.cif({0x0002, 0, 0x1600, 1, 4, 0x0110, 0xA580});
  s.expect_abort(0x06010000);
  s.expect_object(0x1600, 0, 4, 1);
  s.expect_object(0x1600, 1, 0xA5800110, 4);
  s.set_object(0x1600, 0, 0, 1);
  s.set_object(0x1600, 1, 0xA5800110, 4);
  s.set_object(0x1600, 0, 1, 1);
  s.set_object(0x1400, 1, 0x00000201, 4);
  s.nmt(0x01);
  s.rx(0x201, {0x34, 0x12});
  s.exchange();
  s.expect(10000, {0x1234, 0});
  s.no_tx();
}

TEST_P(Pdo, S31_TpdoMappingExample) {
  spec("ME3-PDO-004 ME3-PDO-007", "RJ71-PDO-005 RJ71-PDO-006 RJ71-TPDO-009");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.cif({0x0002, 0, 0x1A00, 0, 1, 0});
  s.expect_abort(0x08000022);
  s.set_object(0x1800, 1, 0xC0000181, 4);
  s.set_object(0x1A00, 0, 0, 1);
  s.set_object(0x1A00, 1, 0xA1000110, 4);
  s.set_object(0x1A00, 0, 1, 1);
  s.set_object(0x1800, 1, 0x40000181, 4);
  s.nmt(0x01);
  s.write(13000, 0x1234);
  s.exchange();
  s.tx(0x181, {0x34, 0x12}).no_tx();
  s.set_object(0x1800, 1, 0x80000181, 4);
  s.expect_object(0x1800, 1, 0xC0000181, 4);  // bit 30 always reads 1
  s.set_object(0x1800, 1, 0x00000181, 4);
  s.expect_object(0x1800, 1, 0x40000181, 4);
  s.rx_remote(0x181, 2).advance(1s).no_tx();

  IntelligentScenario preset(GetParam());  // configured without the bit before the first power-on
  EXPECT_EQ(preset.plug_in().preset_object(0x1800, 1, Bytes{0xFF, 0x01, 0x00, 0x00}),
            canopen::AbortCode::none);
  preset.power_on();
  preset.expect_object(0x1800, 1, 0x400001FF, 4);
  preset.nmt(0x01);
  preset.rx_remote(0x1FF, 8).advance(1s).no_tx();
}

TEST_P(Pdo, Defaults_CommunicationParameters) {
  spec("ME3-PDO-001 ME3-PDO-002", "RJ71-PDO-002");
  IntelligentScenario s(GetParam());
  s.power_on_as(5);
  const canopen::ObjectDictionary& objects = s.plug_in().node().dictionary();
  for (unsigned n = 0; n < 256; ++n) {
    const auto rpdo = static_cast<std::uint16_t>(0x1400 + n);
    const auto tpdo = static_cast<std::uint16_t>(0x1800 + n);
    const std::uint32_t offset = n * 0x100;
    EXPECT_EQ(objects.get<std::uint8_t>(rpdo, 0), 2);
    EXPECT_EQ(objects.get<std::uint32_t>(rpdo, 1), n < 4 ? 0x205 + offset : 0x80000000U);
    EXPECT_EQ(objects.get<std::uint8_t>(rpdo, 2), 0xFE);
    EXPECT_EQ(objects.get<std::uint8_t>(tpdo, 0), 5);
    EXPECT_EQ(objects.get<std::uint32_t>(tpdo, 1), n < 4 ? 0x40000185 + offset : 0xC0000000U);
    EXPECT_EQ(objects.get<std::uint8_t>(tpdo, 2), 0xFE);
    EXPECT_EQ(objects.get<std::uint16_t>(tpdo, 3), 0);
    EXPECT_EQ(objects.get<std::uint16_t>(tpdo, 5), 0);
  }
  EXPECT_FALSE(objects.find(0x1500, 0));
  EXPECT_FALSE(objects.find(0x1900, 0));
}

TEST_P(Pdo, Defaults_Mapping) {
  spec("ME3-PDO-003 ME3-SYS-010", "RJ71-TPDO-010 RJ71-RPDO-009");
  IntelligentScenario s(GetParam());
  s.power_on();
  const canopen::ObjectDictionary& objects = s.plug_in().node().dictionary();
  const auto entry = [&](unsigned index, unsigned sub) {
    return objects.get<std::uint32_t>(static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub));
  };
  for (unsigned n = 0; n < 256; ++n) {
    EXPECT_EQ(entry(0x1600 + n, 0), 4U);
    EXPECT_EQ(entry(0x1A00 + n, 0), 4U);
    for (unsigned sub = 5; sub <= 8; ++sub) {
      EXPECT_EQ(entry(0x1600 + n, sub), 0U);
      EXPECT_EQ(entry(0x1A00 + n, sub), 0U);
    }
  }
  // Rows of tables 4-8 and 4-10.
  const std::map<unsigned, std::array<std::uint32_t, 4>> printed{
      {0x1600, {0xA5800110, 0xA5800210, 0xA5800310, 0xA5800410}},
      {0x1601, {0xA5800510, 0xA5800610, 0xA5800710, 0xA5800810}},
      {0x163F, {0xA580FD10, 0xA580FE10, 0xA5810110, 0xA5810210}},
      {0x16FF, {0xA5840510, 0xA5840610, 0xA5840710, 0xA5840810}},
      {0x1A00, {0xA1000110, 0xA1000210, 0xA1000310, 0xA1000410}},
      {0x1A3F, {0xA100FD10, 0xA100FE10, 0xA1010110, 0xA1010210}},
      {0x1AFF, {0xA1040510, 0xA1040610, 0xA1040710, 0xA1040810}},
  };
  for (const auto& [index, values] : printed) {
    for (unsigned i = 0; i < 4; ++i)
      EXPECT_EQ(entry(index, i + 1), values[i]) << std::hex << index << ":" << i + 1;
  }
  EXPECT_EQ(entry(0x1A80, 1), 0xA1020510U);  // word 512 = 2 * 254 + 4
  // And the rule all rows of the tables follow.
  for (unsigned n = 0; n < 256; ++n) {
    for (unsigned k = 1; k <= 4; ++k) {
      const unsigned word = 4 * n + k - 1;
      const std::uint32_t rest = (word / 254) << 16 | (word % 254 + 1) << 8 | 0x10;
      EXPECT_EQ(entry(0x1600 + n, k), 0xA580'0000U + rest) << n << ":" << k;
      EXPECT_EQ(entry(0x1A00 + n, k), 0xA100'0000U + rest) << n << ":" << k;
    }
  }
}

TEST_P(Pdo, S38_Case1_NoTimers) {
  spec("ME3-PDO-013 ME3-DX-006 ME3-IO-002", "RJ71-IO-002");
  IntelligentScenario s(GetParam());
  operational(s);
  s.write(13000, 0x1111);
  s.advance(1s);
  s.no_tx();
  s.expect_object(0xA100, 1, 0, 2);
  s.y(0x01, true);
  s.wait_x(0x01, true);
  s.tx(0x181, {0x11, 0x11, 0, 0, 0, 0, 0, 0}).no_tx();
  s.y(0x01, false);
  s.expect_x(0x01, false);
  s.expect_object(0xA100, 1, 0x1111, 2);
  s.exchange();
  s.no_tx();
  s.write(13000, 0x2222);
  s.advance(1s);
  s.no_tx();
  s.exchange();
  s.tx(0x181, {0x22, 0x22, 0, 0, 0, 0, 0, 0}).no_tx();
  // The event is a change of what the PDO maps.
  s.write(13004, 0x3333);
  s.exchange();
  s.tx(0x281, {0x33, 0x33, 0, 0, 0, 0, 0, 0}).no_tx();
  s.write(13016, 0x4444);  // of no valid PDO
  s.exchange();
  s.no_tx();
  s.expect_object(0xA100, 17, 0x4444, 2);
}

TEST_P(Pdo, S39_Case2_InhibitTime_DismissesTheRequest) {
  spec("ME3-PDO-014", "RJ71-TPDO-005");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1800, 1, 0xC0000181, 4);
  s.set_object(0x1800, 3, 1000, 2);
  s.set_object(0x1800, 1, 0x40000181, 4);
  s.nmt(0x01);
  s.write(13000, 0x1111);
  s.exchange();
  s.tx(0x181, {0x11, 0x11, 0, 0, 0, 0, 0, 0});
  s.advance(50ms);
  s.write(13000, 0x2222);
  s.exchange();
  s.advance(47500us);
  s.exchange();  // 99.5 ms after the frame
  s.no_tx();
  s.advance(20ms);
  s.no_tx();  // dismissed, not put off
  s.exchange();
  s.tx(0x181, {0x22, 0x22, 0, 0, 0, 0, 0, 0}).no_tx();
  // 100.9 ms count as 100 ms, and the synchronous types know no inhibit time.
  s.set_object(0x1800, 1, 0xC0000181, 4);
  s.set_object(0x1800, 3, 1009, 2);
  s.set_object(0x1800, 1, 0x40000181, 4);
  s.write(13000, 0x3333);
  s.exchange();
  s.tx(0x181, {0x33, 0x33, 0, 0, 0, 0, 0, 0});
  s.write(13000, 0x4444);
  s.advance(99300us);
  s.exchange();
  s.tx(0x181, {0x44, 0x44, 0, 0, 0, 0, 0, 0}).no_tx();
  s.set_object(0x1800, 2, 1, 1);
  s.rx(0x080).rx(0x080);
  s.tx(0x181, {0x44, 0x44, 0, 0, 0, 0, 0, 0}).tx(0x181, {0x44, 0x44, 0, 0, 0, 0, 0, 0}).no_tx();
}

TEST_P(Pdo, S41_Case4_InhibitTimeShorterThanTheEventTimer) {
  spec("ME3-PDO-016", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1800, 1, 0xC0000181, 4);
  s.set_object(0x1800, 3, 1000, 2);
  s.set_object(0x1800, 5, 200, 2);
  s.set_object(0x1800, 1, 0x40000181, 4);
  s.nmt(0x01);
  s.write(13000, 0x1111);
  s.exchange();
  s.tx(0x181, {0x11, 0x11, 0, 0, 0, 0, 0, 0});
  s.advance(49ms);
  s.write(13000, 0x2222);
  s.exchange();
  s.no_tx();
  s.advance(150ms);
  ASSERT_EQ(s.controller().sent.size(), 1U);  // the event timer; whether with the new value is not printed
  s.ignore_tx();
  s.advance(49ms);
  s.write(13000, 0x3333);
  s.exchange();
  s.no_tx();  // the timer's frame started the inhibit time anew
  s.advance(59ms);
  s.exchange();
  s.tx(0x181, {0x33, 0x33, 0, 0, 0, 0, 0, 0}).no_tx();
  s.advance(199ms);
  s.no_tx();  // and this frame the event timer
  s.advance(1ms);
  s.tx(0x181, {0x33, 0x33, 0, 0, 0, 0, 0, 0}).no_tx();
}

TEST_P(Pdo, S40_Case3_EventTimer_SendsUnchangedData_AndStartsAgainWithEachFrame) {
  spec("ME3-PDO-015", "RJ71-TPDO-006");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1800, 1, 0xC0000181, 4);
  s.set_object(0x1800, 5, 200, 2);
  s.set_object(0x1800, 1, 0x40000181, 4);
  s.nmt(0x01);
  s.write(13000, 0x1111);
  s.exchange();
  s.tx(0x181, {0x11, 0x11, 0, 0, 0, 0, 0, 0});
  s.advance(199ms);
  s.no_tx();
  s.advance(1ms);
  s.tx(0x181, {0x11, 0x11, 0, 0, 0, 0, 0, 0});
  s.advance(200ms);
  s.tx(0x181, {0x11, 0x11, 0, 0, 0, 0, 0, 0}).no_tx();
  s.advance(50ms);
  s.write(13000, 0x2222);
  s.exchange();
  s.tx(0x181, {0x22, 0x22, 0, 0, 0, 0, 0, 0});
  s.advance(199ms);
  s.no_tx();
  s.advance(1ms);
  s.tx(0x181, {0x22, 0x22, 0, 0, 0, 0, 0, 0}).no_tx();
}

TEST_P(Pdo, S42_Case5_EventTimerWithinTheInhibitTime_SendsNothing) {
  spec("ME3-PDO-017", "RJ71-TPDO-008");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1800, 1, 0xC0000181, 4);
  s.set_object(0x1800, 3, 3000, 2);
  s.set_object(0x1800, 5, 200, 2);
  s.set_object(0x1800, 1, 0x40000181, 4);
  s.nmt(0x01);
  s.write(13000, 0x1111);
  s.exchange();
  s.tx(0x181, {0x11, 0x11, 0, 0, 0, 0, 0, 0});
  s.advance(299ms);
  s.no_tx();
  s.advance(10ms);
  s.ignore_tx();  // when the timer's next frame comes is not printed
  s.advance(5s);
  s.ignore_tx();
}

TEST(Me3Pdo, S43_SynchronousTypes) {
  RecordProperty("spec", "ME3-PDO-008 ME3-PDO-009 ME3-PDO-010 ME3-PDO-011 ME3-PDO-012");
  IntelligentScenario s;
  s.power_on_as(1);
  const auto types = [&](std::uint8_t tpdo, std::uint8_t rpdo) {
    s.set_object(0x1800, 1, 0xC0000181, 4);
    s.set_object(0x1800, 2, tpdo, 1);
    s.set_object(0x1800, 1, 0x40000181, 4);
    s.set_object(0x1400, 1, 0x80000201, 4);
    s.set_object(0x1400, 2, rpdo, 1);
    s.set_object(0x1400, 1, 0x00000201, 4);
  };
  types(3, 0);
  s.nmt(0x01);
  s.rx(0x080).rx(0x080).no_tx();
  s.rx(0x080).tx(0x181, {0, 0, 0, 0, 0, 0, 0, 0}).no_tx();
  s.rx(0x080).rx(0x080).no_tx();
  s.rx(0x080).tx(0x181, {0, 0, 0, 0, 0, 0, 0, 0}).no_tx();

  types(0, 0);
  s.rx(0x080).no_tx();
  s.write(13000, 0x0102);
  s.exchange();
  s.no_tx();
  s.rx(0x080).tx(0x181, {0x02, 0x01, 0, 0, 0, 0, 0, 0}).no_tx();
  s.rx(0x080).no_tx();

  for (const std::uint8_t type : Bytes{0x00, 0x01, 0xF0}) {
    types(0, type);
    s.rx(0x201, {type, 0x12, 0, 0, 0, 0, 0, 0});
    const std::uint16_t before = s.read(10000);
    s.exchange();
    s.expect(10000, before);
    s.rx(0x080);
    s.exchange();
    s.expect(10000, static_cast<std::uint16_t>(0x1200 | type));
  }
  types(0, 0xFE);
  s.rx(0x201, {0x34, 0x12, 0, 0, 0, 0, 0, 0});
  s.exchange();
  s.expect(10000, 0x1234);
  for (std::uint16_t reserved = 0xF1; reserved <= 0xFF; ++reserved) {
    if (reserved == 0xFE) continue;
    for (const std::uint16_t index : Words{0x1804, 0x1404}) {  // not valid, as they come
      s.cif({0x0002, 0, index, 2, 1, reserved});
      s.expect_abort(0x06090030);
      s.expect_object(index, 2, 0xFE, 1);
    }
  }
  s.ignore_tx();
}

TEST_P(Pdo, SynchronousTypes_EveryNthSync_OrAfterAnEvent) {
  spec("ME3-PDO-010 ME3-PDO-011", "RJ71-TPDO-002 RJ71-TPDO-003");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  const auto type = [&](std::uint8_t value) {
    s.set_object(0x1800, 1, 0xC0000181, 4);
    s.set_object(0x1800, 2, value, 1);
    s.set_object(0x1800, 1, 0x40000181, 4);
  };
  type(1);
  s.nmt(0x01);
  for (std::uint16_t i = 1; i <= 3; ++i) {
    s.rx(0x080).tx(0x181, {0, 0, 0, 0, 0, 0, 0, 0}).no_tx();
  }
  s.write(13000, 0x0102);  // changed data do not send before the SYNC
  s.exchange();
  s.no_tx().rx(0x080).tx(0x181, {0x02, 0x01, 0, 0, 0, 0, 0, 0}).no_tx();
  type(240);
  for (int round = 0; round < 2; ++round) {
    for (int i = 1; i <= 239; ++i) s.rx(0x080);
    s.no_tx().rx(0x080).tx(0x181, {0x02, 0x01, 0, 0, 0, 0, 0, 0}).no_tx();
  }
  type(0);
  s.exchange();  // nothing has changed: no event
  s.rx(0x080).no_tx();
  s.write(13001, 0x0304);
  s.exchange();
  s.rx(0x080).tx(0x181, {0x02, 0x01, 0x04, 0x03, 0, 0, 0, 0}).no_tx();
  s.exchange();
  s.rx(0x080).no_tx();
}

TEST_P(Pdo, S43a_DummyMapping_SkipsAByte) {
  spec("ME3-PDO-006", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1400, 1, 0x80000201, 4);
  s.set_object(0x1600, 0, 0, 1);
  s.set_object(0x1600, 1, 0x00050008, 4);
  s.set_object(0x1600, 2, 0xA4C00108, 4);
  s.set_object(0x1600, 0, 2, 1);
  s.set_object(0x1400, 1, 0x00000201, 4);
  s.nmt(0x01);
  s.rx(0x201, {0xAA, 0xBB});
  s.exchange();
  s.expect(10000, 0x00BB).no_tx();
  s.supply_off();

  // Every dummy of table 4-5, with its own length.
  for (const auto& [dummy, bits] :
       std::map<std::uint32_t, unsigned>{{2, 8}, {3, 16}, {4, 32}, {5, 8}, {6, 16}, {7, 32}, {8, 32}}) {
    IntelligentScenario t(GetParam());
    t.power_on_as(1);
    t.set_object(0x1400, 1, 0x80000201, 4);
    t.set_object(0x1600, 0, 0, 1);
    t.set_object(0x1600, 1, dummy << 16 | bits, 4);
    t.set_object(0x1600, 2, 0xA4C00108, 4);
    t.set_object(0x1600, 0, 2, 1);
    t.set_object(0x1400, 1, 0x00000201, 4);
    t.nmt(0x01);
    Bytes frame(bits / 8, 0xAA);
    frame.push_back(0xBB);
    t.rx(0x201, frame);
    t.exchange();
    t.expect(10000, 0x00BB).no_tx();
    t.set_object(0x1404, 1, 0x80000000, 4);
    t.set_object(0x1604, 0, 0, 1);
    t.cif({0x0002, 0, 0x1604, 1, 4, static_cast<std::uint16_t>(bits + 8), static_cast<std::uint16_t>(dummy)});
    t.expect_abort(0x06040041);  // not its length
    for (const std::uint16_t reserved : Words{1, 9}) {
      t.cif({0x0002, 0, 0x1604, 1, 4, 1, reserved});
      t.expect_abort(0x06020000);
    }
  }
}

TEST_P(Pdo, S43b_OnlyMappedObjectsAreCopied) {
  spec("ME3-PBUF-006", "RJ71-TPDO-001");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1800, 1, 0xC0000181, 4);
  s.set_object(0x1A00, 0, 0, 1);
  s.nmt(0x01);
  s.write(13000, {5, 6, 7, 8, 9});
  s.exchange();
  s.expect_object(0xA100, 1, 0, 2);
  s.expect_object(0xA0C0, 1, 0, 2);
  s.expect_object(0xA040, 1, 0, 1);
  s.expect_object(0xA100, 5, 9, 2);  // TPDO 2 still maps the fifth word
  s.ignore_tx();
  // Nor what has been mapped before.
  s.set_object(0x1801, 1, 0xC0000281, 4);
  s.set_object(0x1A01, 0, 0, 1);
  s.write(13004, 10);
  s.exchange();
  s.expect_object(0xA100, 5, 9, 2).no_tx();
}

// Neighbours in the dictionary that are none in the words: the last byte, then the first word.
TEST_P(ProcessData, FirstAndLastObject_InOnePdo) {
  spec("ME3-PBUF-001 ME3-PBUF-004", "RJ71-RPDO-010 RJ71-TPDO-011");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1400, 1, 0x80000201, 4);
  s.set_object(0x1600, 0, 0, 1);
  s.set_object(0x1600, 1, 0xA4881008, 4);
  s.set_object(0x1600, 2, 0xA4C00108, 4);
  s.set_object(0x1600, 0, 2, 1);
  s.set_object(0x1400, 1, 0x00000201, 4);
  s.set_object(0x1800, 1, 0xC0000181, 4);
  s.set_object(0x1A00, 0, 0, 1);
  s.set_object(0x1A00, 1, 0xA0481008, 4);
  s.set_object(0x1A00, 2, 0xA0C00110, 4);
  s.set_object(0x1A00, 0, 2, 1);
  s.set_object(0x1800, 1, 0x40000181, 4);
  s.nmt(0x01, 1);
  s.write(13000, 0x2211).write(14023, 0x4433).rx(0x201, {0xAA, 0xBB});
  s.exchange();
  s.tx(0x181, {0x44, 0x11, 0x22}).expect(10000, {0x00BB, 0}).expect(11022, {0, 0xAA00}).ignore_tx();
}

// After a change of one RPDO's mapping each RPDO is still brought to its own words, and to no others.
TEST_P(ProcessData, EachRpdo_ComesToItsOwnWords_AfterAChange) {
  spec("ME3-PBUF-002 ME3-PBUF-005 ME3-DX-008", "RJ71-RPDO-010 RJ71-RPDO-001");
  IntelligentScenario s(GetParam());
  operational(s);
  s.rx(0x201, {1, 0, 2, 0, 3, 0, 4, 0}).rx(0x301, {5, 0, 6, 0, 7, 0, 8, 0});
  s.exchange();
  s.expect(10000, {1, 2, 3, 4, 5, 6, 7, 8});
  s.set_object(0x1400, 1, 0x80000201, 4);
  s.set_object(0x1600, 0, 0, 1);
  s.set_object(0x1600, 1, 0xA5800910, 4);  // G10008, G10010, G10012: three pieces
  s.set_object(0x1600, 2, 0xA5800B10, 4);
  s.set_object(0x1600, 3, 0xA5800D10, 4);
  s.set_object(0x1600, 0, 3, 1);
  s.set_object(0x1400, 1, 0x00000201, 4);
  s.set_object(0xA4C0, 9, 0x99, 1);  // low byte of G10004, over RPDO 2's object
  s.rx(0x201, {9, 0, 11, 0, 13, 0});
  s.exchange();
  s.expect(10000, {1, 2, 3, 4, 0x0099, 6, 7, 8, 9, 0, 11, 0, 13, 0});
  s.rx(0x301, {15, 0, 16, 0, 17, 0, 18, 0});
  s.exchange();
  s.expect(10000, {1, 2, 3, 4, 15, 16, 17, 18, 9, 0, 11, 0, 13, 0}).no_tx();
}

TEST(Me3Pdo, S43c_NotOperational_TheProcessDataWait) {
  RecordProperty("spec", "ME3-DX-007 ME3-PBUF-007 ME3-PDO-018");
  IntelligentScenario s;
  s.power_on_as(1);
  s.rx(0x201, {0x34, 0x12, 0, 0, 0, 0, 0, 0});
  s.write(13000, 7);
  s.y(0x01, true);
  s.wait_x(0x01, true);
  s.y(0x01, false);
  s.advance(1s);
  s.no_tx().expect(10000, 0);
  s.expect_object(0xA100, 1, 0, 2);
  s.nmt(0x01, 1);
  s.tx(0x181, {0x07, 0, 0, 0, 0, 0, 0, 0}).no_tx();
  s.expect_object(0xA100, 1, 7, 2);
  s.expect(10000, 0);  // the RPDO came outside of Operational
  s.nmt(0x02, 1);
  s.write(13000, 8);
  s.exchange();
  s.rx(0x201, {0x34, 0x12, 0, 0, 0, 0, 0, 0});
  s.no_tx();
  s.nmt(0x01, 1);
  s.tx(0x181, {0x08, 0, 0, 0, 0, 0, 0, 0}).no_tx();
  s.expect(10000, 0).expect(29, 0);
  // Neither the event timer nor a SYNC sends outside of Operational.
  s.set_object(0x1800, 1, 0xC0000181, 4);
  s.set_object(0x1800, 5, 100, 2);
  s.set_object(0x1800, 1, 0x40000181, 4);
  s.set_object(0x1801, 1, 0xC0000281, 4);
  s.set_object(0x1801, 2, 1, 1);
  s.set_object(0x1801, 1, 0x40000281, 4);
  s.advance(100ms).tx(0x181, {0x08, 0, 0, 0, 0, 0, 0, 0}).no_tx();
  s.rx(0x080).tx(0x281, {0, 0, 0, 0, 0, 0, 0, 0}).no_tx();
  for (const std::uint8_t command : Bytes{0x80, 0x02}) {
    s.nmt(command, 1);
    s.advance(10s).rx(0x080).rx(0x201, {0x34, 0x12, 0, 0, 0, 0, 0, 0}).no_tx();
    s.expect(29, 0);
  }
  s.nmt(0x01, 1).ignore_tx();
  s.exchange();
  s.expect(10000, 0).ignore_tx();
}

TEST_P(Pdo, S43d_Selection_OfProcessDataAndEmergencies) {
  spec("ME3-DX-001 ME3-DX-002 ME3-DX-003 ME3-DX-004 ME3-IO-003", "RJ71-IO-002");
  IntelligentScenario s(GetParam());
  operational(s);
  std::uint8_t n = 0;
  const auto change = [&] {
    ++n;
    s.write(13000, n);
    s.rx(0x201, {n, 0, 0, 0, 0, 0, 0, 0});
    s.write(750, 0);
    s.rx(0x085, {n, 0x10, 0x01, 0, 0, 0, 0, 0});
  };
  change();
  s.write(20, 0x1000);
  s.exchange();
  s.expect(751, 0x1001).expect(10000, 0).no_tx();

  change();
  s.write(20, 0x0100);
  s.exchange();
  s.tx(0x181, {2, 0, 0, 0, 0, 0, 0, 0}).no_tx();
  s.expect(751, 0).expect(10000, 2);

  for (const std::uint16_t both : Words{0x0000, 0x1100}) {
    change();
    s.write(20, both);
    s.exchange();
    s.tx(0x181, {n, 0, 0, 0, 0, 0, 0, 0}).no_tx();
    s.expect(751, static_cast<std::uint16_t>(0x1000 | n)).expect(10000, n);
  }
}

TEST(Me3Pdo, ExchangeStatus_ReadsInBit8WhileItRuns) {
  RecordProperty("spec", "ME3-DX-005");
  IntelligentScenario s;
  operational(s);
  s.write(20, 0x1100);
  s.expect(20, 0);
  s.y(0x01, true);
  s.expect(20, 0x0100).expect_x(0x01, false);
  s.wait_x(0x01, true);
  s.expect(20, 0);
  s.y(0x01, false);
  s.nmt(0x80);
  s.y(0x01, true);
  s.wait_x(0x01, true);
  s.expect(20, 0x0100);  // waits for Operational
  s.nmt(0x01);
  s.expect(20, 0);
}

TEST_P(Pdo, ReceivedData_StandStillBetweenExchanges_TheLatestFrameWins) {
  spec("ME3-DX-008", "RJ71-RPDO-001");
  IntelligentScenario s(GetParam());
  operational(s);
  s.rx(0x201, {1, 0, 2, 0, 3, 0, 4, 0});
  s.expect(10000, {0, 0, 0, 0});
  s.exchange();
  s.expect(10000, {1, 2, 3, 4});
  s.rx(0x201, {5, 0, 6, 0, 7, 0, 8, 0});
  s.rx(0x201, {9, 0, 10, 0, 11, 0, 12, 0});
  s.advance(1s);
  s.expect(10000, {1, 2, 3, 4});
  s.exchange();
  s.expect(10000, {9, 10, 11, 12});
}

TEST_P(Pdo, WordsWrittenBeforeTheRequest_LeaveTogether_LaterOnesWait) {
  spec("ME3-DX-009", "RJ71-PDO-004");
  IntelligentScenario s(GetParam());
  operational(s);
  s.write(13000, {1, 2, 3, 4});
  s.y(0x01, true);
  s.write(13002, {30, 40});  // in the middle of the exchange
  s.wait_x(0x01, true);
  s.tx(0x181, {1, 0, 2, 0, 3, 0, 4, 0}).no_tx();
  s.y(0x01, false);
  s.exchange();
  s.tx(0x181, {1, 0, 2, 0, 30, 0, 40, 0}).no_tx();
}

TEST_P(Pdo, RemoteRequestOfAPdo_IsNotAnswered) {
  IntelligentScenario s(GetParam());
  operational(s);
  s.write(13000, 1);
  s.exchange();
  s.ignore_tx();
  s.rx_remote(0x181, 8).rx_remote(0x201, 8);
  s.advance(1s);
  s.no_tx();
}

TEST_P(Pdo, RpdoLengthErrors_SendEmergencies) {
  spec("ME3-PDO-019", "");
  IntelligentScenario s(GetParam());
  operational(s);
  s.rx(0x201, {0x11, 0x22, 0x33});
  s.tx(0x081, {0x10, 0x82, 0x11, 0, 0, 0, 0, 0}).no_tx();
  s.exchange();
  s.expect(10000, 0);
  s.set_object(0x1400, 1, 0x80000201, 4);
  s.set_object(0x1600, 0, 0, 1);
  s.set_object(0x1600, 0, 1, 1);
  s.set_object(0x1400, 1, 0x00000201, 4);
  s.ignore_tx();
  s.rx(0x201, {0x11, 0x22, 0x33});
  s.tx(0x081, {0x20, 0x82, 0x11, 0, 0, 0, 0, 0}).no_tx();
  s.exchange();
  s.expect(10000, {0x2211, 0});
}

TEST_P(Pdo, MappingIsChecked_LengthAndMappability) {
  spec("ME3-PDO-005", "RJ71-PDO-001");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1400, 1, 0x80000201, 4);
  s.set_object(0x1600, 0, 0, 1);
  for (std::uint8_t i = 1; i <= 8; ++i)
    s.set_object(0x1600, i, 0xA4C00008U | static_cast<std::uint32_t>(i) << 8, 4);
  s.set_object(0x1600, 0, 8, 1);  // 64 bits
  s.set_object(0x1600, 0, 0, 1);
  s.set_object(0x1600, 8, 0xA5800110, 4);
  s.cif({0x0002, 0, 0x1600, 0, 1, 8});  // 72 bits
  s.expect_abort(0x06040042);
  for (const std::uint32_t entry : {0x10000020U, 0xA1000110U, 0x10170010U}) {
    s.cif({0x0002, 0, 0x1600, 1, 4, static_cast<std::uint16_t>(entry & 0xFFFF),
           static_cast<std::uint16_t>(entry >> 16)});
    s.expect_abort(0x06040041);
  }
  s.set_object(0x1800, 1, 0xC0000181, 4);
  s.set_object(0x1A00, 0, 0, 1);
  for (const std::uint32_t entry : {0xA5800110U, 0x00050008U, 0x10170010U}) {  // an output, a dummy, others
    s.cif({0x0002, 0, 0x1A00, 1, 4, static_cast<std::uint16_t>(entry & 0xFFFF),
           static_cast<std::uint16_t>(entry >> 16)});
    s.expect_abort(0x06040041);
  }
  for (std::uint8_t i = 1; i <= 8; ++i)
    s.set_object(0x1A00, i, (i == 8 ? 0xA1000010U : 0xA0400008U) | static_cast<std::uint32_t>(i) << 8, 4);
  s.cif({0x0002, 0, 0x1A00, 0, 1, 8});  // 72 bits
  s.expect_abort(0x06040042);
  s.set_object(0x1A00, 8, 0xA0400808, 4);
  s.set_object(0x1A00, 0, 8, 1);
  s.set_object(0x1A00, 0, 0, 1);
  for (const std::uint16_t mapping : Words{0x1600, 0x1A00}) {
    s.cif({0x0002, 0, mapping, 0, 1, 9});
    s.expect_abort(0x06040042);
    s.cif({0x0002, 0, mapping, 9, 4, 0x0110, 0xA580});
    s.expect_abort(0x06090011);
  }
}

// --- what lies where [3.5.19]

TEST_P(ProcessData, RpdoWords_ToNetworkVariables) {
  spec("ME3-PBUF-001 ME3-PBUF-002 ME3-PBUF-003", "RJ71-RPDO-010");
  IntelligentScenario s(GetParam());
  operational(s);
  struct Row {
    std::uint16_t index;
    std::uint8_t sub;
    std::uint32_t value;
    unsigned length;
    module::BufferAddress word;
    Words expected;
  };
  // Rows of tables 3-21, 3-22 and 3-23.
  const std::vector<Row> rows{
      {0xA4C0, 0x01, 0x11, 1, 10000, {0x0011}},
      {0xA480, 0x02, 0x22, 1, 10000, {0x2211}},
      {0xA4C0, 0xFD, 0x33, 1, 10126, {0x0033}},
      {0xA4C0, 0xFE, 0x44, 1, 10126, {0x4433}},
      {0xA4C1, 0x01, 0x55, 1, 10127, {0x0055}},
      {0xA481, 0x02, 0x66, 1, 10127, {0x6655}},
      {0xA4C7, 0xFE, 0x77, 1, 11015, {0x7700}},
      {0xA4C8, 0x01, 0x12, 1, 11016, {0x0012}},
      {0xA4C8, 0x0F, 0x13, 1, 11023, {0x0013}},
      {0xA488, 0x10, 0x14, 1, 11023, {0x1413}},
      {0xA580, 0xFE, 0x1234, 2, 10253, {0x1234}},
      {0xA581, 0x01, 0x2345, 2, 10254, {0x2345}},
      {0xA541, 0xFE, 0x3456, 2, 10507, {0x3456}},
      {0xA584, 0x08, 0x4567, 2, 11023, {0x4567}},
      {0xA680, 0x01, 0x89ABCDEF, 4, 10000, {0xCDEF, 0x89AB}},
      {0xA640, 0xFE, 0x01234567, 4, 10506, {0x4567, 0x0123}},
      {0xA6C1, 0x01, 0x3F800000, 4, 10508, {0x0000, 0x3F80}},
      {0xA682, 0x04, 0xDEADBEEF, 4, 11022, {0xBEEF, 0xDEAD}},
  };
  for (const Row& row : rows) {
    s.set_object(row.index, row.sub, row.value, row.length);
    s.exchange();
    s.expect(row.word, row.expected);
  }
  s.no_tx();
}

// The rule of the tables, for every object there is.
struct Area {
  std::uint16_t index;
  unsigned bytes;
};

std::uint32_t pattern(unsigned number, unsigned bytes) {
  const std::uint32_t value = (number + 1) * 0x9E3779B1U;
  return bytes == 4 ? value : value >> 7 & ((1U << 8 * bytes) - 1);
}

std::uint16_t object_index(const Area& area, unsigned k) {
  return static_cast<std::uint16_t>(area.index + k / 254);
}
std::uint8_t object_sub(unsigned k) { return static_cast<std::uint8_t>(k % 254 + 1); }

// What 1024 words hold when object k of the area has the value pattern(k).
Words words_of(const Area& area) {
  Words words(1024);
  for (unsigned k = 0; k < 2048 / area.bytes; ++k) {
    const std::uint32_t value = pattern(k, area.bytes);
    if (area.bytes == 4) words[2 * k + 1] = static_cast<std::uint16_t>(value >> 16);
    std::uint16_t& word = words[k * area.bytes / 2];
    word = static_cast<std::uint16_t>(area.bytes == 1 && k % 2 == 1 ? word | value << 8 : value & 0xFFFF);
  }
  return words;
}

TEST_P(ProcessData, EveryRpdoObject_LiesWhereTheRuleSays) {
  spec("ME3-PBUF-001 ME3-PBUF-002 ME3-PBUF-003", "RJ71-RPDO-010");
  for (const Area& area : {Area{0xA480, 1}, Area{0xA4C0, 1}, Area{0xA540, 2}, Area{0xA580, 2},
                           Area{0xA640, 4}, Area{0xA680, 4}, Area{0xA6C0, 4}}) {
    IntelligentScenario s(GetParam());
    operational(s);
    for (unsigned k = 0; k < 2048 / area.bytes; ++k)
      s.set_object(object_index(area, k), object_sub(k), pattern(k, area.bytes), area.bytes);
    s.exchange();
    s.expect(10000, words_of(area)).no_tx();
  }
}

TEST_P(ProcessData, EveryTpdoObject_LiesWhereTheRuleSays) {
  spec("ME3-PBUF-004", "RJ71-TPDO-011");
  for (const Area& area : {Area{0xA000, 1}, Area{0xA040, 1}, Area{0xA0C0, 2}, Area{0xA100, 2},
                           Area{0xA1C0, 4}, Area{0xA200, 4}, Area{0xA240, 4}}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    for (std::uint16_t n = 0; n < 4; ++n)
      s.set_object(static_cast<std::uint16_t>(0x1800 + n), 1, 0xC0000000, 4);
    const unsigned in_a_pdo = 8 / area.bytes;
    for (unsigned n = 0; n < 256; ++n) {
      const auto mapping = static_cast<std::uint16_t>(0x1A00 + n);
      s.set_object(mapping, 0, 0, 1);
      for (unsigned i = 0; i < in_a_pdo; ++i) {
        const unsigned k = n * in_a_pdo + i;
        const std::uint32_t entry = static_cast<std::uint32_t>(object_index(area, k)) << 16 |
                                    static_cast<std::uint32_t>(object_sub(k)) << 8 | 8 * area.bytes;
        s.set_object(mapping, static_cast<std::uint8_t>(i + 1), entry, 4);
      }
      s.set_object(mapping, 0, in_a_pdo, 1);
    }
    s.nmt(0x01);
    s.write(13000, words_of(area));
    s.exchange();
    for (unsigned k = 0; k < 2048 / area.bytes; ++k)
      s.expect_object(object_index(area, k), object_sub(k), pattern(k, area.bytes), area.bytes);
    s.no_tx();
  }
}

TEST(Me3ProcessData, OutputVariable_WrittenByAnotherNode) {
  RecordProperty("spec", "ME3-PRO-003");
  IntelligentScenario s;
  s.power_on_as(1);
  const Bytes write{0x2B, 0x80, 0xA5, 0x01, 0x34, 0x12, 0, 0};
  const Bytes written{0x60, 0x80, 0xA5, 0x01, 0, 0, 0, 0};
  s.rx(0x601, write).tx(0x581, written);
  s.exchange();
  s.expect(10000, 0);  // Pre-operational
  s.nmt(0x01);
  s.ignore_tx();
  s.expect(10000, 0x1234);  // the exchange has waited
  s.rx(0x601, {0x2B, 0x80, 0xA5, 0x01, 0x78, 0x56, 0, 0}).tx(0x581, written);
  s.advance(1s);
  s.expect(10000, 0x1234);
  s.exchange();
  s.expect(10000, {0x5678, 0}).no_tx();
  // An input variable is not for the network to write.
  s.rx(0x601, {0x2B, 0x00, 0xA1, 0x01, 0x34, 0x12, 0, 0});
  s.tx(0x581, {0x80, 0x00, 0xA1, 0x01, 0x02, 0x00, 0x01, 0x06}).no_tx();
}

TEST_P(ProcessData, TpdoWords_ToNetworkVariables) {
  spec("ME3-PBUF-004", "RJ71-TPDO-011");
  struct Row {
    std::uint32_t mapping;
    module::BufferAddress word;
    Words written;
    std::uint32_t value;
    unsigned length;
  };
  // Rows of tables 3-24 to 3-26; the last row of 3-26 is misprinted and stands for 14022/14023.
  const std::vector<Row> rows{
      {0xA0400108, 13000, {0x2211}, 0x11, 1},
      {0xA0000208, 13000, {0x2211}, 0x22, 1},
      {0xA040FE08, 13126, {0x4433}, 0x44, 1},
      {0xA0410108, 13127, {0x6655}, 0x55, 1},
      {0xA0481008, 14023, {0x1413}, 0x14, 1},
      {0xA100FE10, 13253, {0x1234}, 0x1234, 2},
      {0xA1010110, 13254, {0x2345}, 0x2345, 2},
      {0xA0C40810, 14023, {0x4567}, 0x4567, 2},
      {0xA2000120, 13000, {0xCDEF, 0x89AB}, 0x89ABCDEF, 4},
      {0xA1C0FE20, 13506, {0x4567, 0x0123}, 0x01234567, 4},
      {0xA2410120, 13508, {0x0000, 0x3F80}, 0x3F800000, 4},
      {0xA2020420, 14022, {0xBEEF, 0xDEAD}, 0xDEADBEEF, 4},
  };
  for (const Row& row : rows) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.set_object(0x1800, 1, 0xC0000181, 4);
    s.set_object(0x1A00, 0, 0, 1);
    s.set_object(0x1A00, 1, row.mapping, 4);
    s.set_object(0x1A00, 0, 1, 1);
    s.set_object(0x1800, 1, 0x40000181, 4);
    s.nmt(0x01);
    s.write(row.word, row.written);
    s.exchange();
    Bytes frame;
    for (unsigned i = 0; i < row.length; ++i)
      frame.push_back(static_cast<std::uint8_t>(row.value >> (8 * i)));
    s.tx(0x181, frame);
    s.expect_object(static_cast<std::uint16_t>(row.mapping >> 16),
                    static_cast<std::uint8_t>(row.mapping >> 8), row.value, row.length);
    s.ignore_tx();
  }
}

TEST_P(ProcessData, OverlappingObjects_AreNotKeptEqual) {
  spec("ME3-PBUF-005", "");
  IntelligentScenario s(GetParam());
  operational(s);
  s.set_object(0xA580, 1, 0x1234, 2);
  s.set_object(0xA4C0, 1, 0x99, 1);
  s.exchange();
  s.expect(10000, 0x1299);
  s.expect_object(0xA580, 1, 0x1234, 2);
  s.expect_object(0xA4C0, 1, 0x99, 1);
  s.expect_object(0xA4C0, 2, 0, 1);
}

TEST_P(ProcessData, NetworkVariables_Exist_AsTheProfileSays) {
  spec("ME3-PRO-001 ME3-PRO-002 ME3-PRO-004", "RJ71-OD-005");
  IntelligentScenario s(GetParam());
  s.power_on();
  // First index, last index, sub-indexes of the last one.
  const std::vector<std::array<std::uint16_t, 3>> inputs{
      {0xA000, 0xA008, 0x10}, {0xA040, 0xA048, 0x10}, {0xA0C0, 0xA0C4, 0x08}, {0xA100, 0xA104, 0x08},
      {0xA1C0, 0xA1C2, 0x04}, {0xA200, 0xA202, 0x04}, {0xA240, 0xA242, 0x04}};
  const std::vector<std::array<std::uint16_t, 3>> outputs{
      {0xA480, 0xA488, 0x10}, {0xA4C0, 0xA4C8, 0x10}, {0xA540, 0xA544, 0x08}, {0xA580, 0xA584, 0x08},
      {0xA640, 0xA642, 0x04}, {0xA680, 0xA682, 0x04}, {0xA6C0, 0xA6C2, 0x04}};
  const auto check = [&](const auto& areas, bool writable) {
    for (const auto& [first, last, count] : areas) {
      const unsigned length = last - first == 8 ? 1 : last - first == 4 ? 2 : 4;
      s.expect_object(first, 0, 0xFE, 1);
      s.expect_object(last, 0, count, 1);
      s.expect_object(first, 0xFE, 0, length);
      s.expect_object(last, static_cast<std::uint8_t>(count), 0, length);
      s.cif({0x0004, 0, last, static_cast<std::uint16_t>(count + 1)});
      s.expect_abort(0x06090011);
      s.cif({0x0004, 0, static_cast<std::uint16_t>(last + 1), 0});
      s.expect_abort(0x06020000);
      s.cif({0x0002, 0, first, 1, static_cast<std::uint16_t>(length), 1});
      if (writable) {
        s.expect(1000, 0x0003);
      } else {
        s.expect_abort(0x06010002);
      }
    }
  };
  check(inputs, false);
  check(outputs, true);
  for (const std::uint16_t missing :
       Words{0xA080, 0xA140, 0xA180, 0xA280, 0xA400, 0xA500, 0xA5C0, 0xA600, 0xA700}) {
    s.cif({0x0004, 0, missing, 0});
    s.expect_abort(0x06020000);
  }
}

}  // namespace
}  // namespace canopus::scenario
