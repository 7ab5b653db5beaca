// spec/me3can1-q/scenarios.md, section 7: PDOs and their timers (S38 to S43); and S30, S31 of section 6.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_pdo_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Pdo);

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

// A display of the module is renewed after a change alone.
TEST_P(Pdo, ProcessData_AndHeartbeatsOfANodeThatIsAlive_AreNoChangeOfTheModule) {
  IntelligentScenario s(GetParam());
  s.power_on_as(1).set_object(0x1016, 1, 0x000903E8, 4).nmt(0x01);
  const auto changes_by = [&s](std::uint32_t identifier, const Bytes& bytes) {
    const std::uint64_t before = s.plug_in().change_count();
    s.rx(identifier, bytes).ignore_tx();
    return s.plug_in().change_count() != before;
  };
  EXPECT_FALSE(changes_by(0x201, {1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_TRUE(changes_by(0x709, {0x05})) << "the first one";
  EXPECT_FALSE(changes_by(0x709, {0x05}));
  EXPECT_TRUE(changes_by(0x709, {0x04})) << "another state";
  EXPECT_TRUE(changes_by(0x709, {0x00})) << "boot-up";
  EXPECT_TRUE(changes_by(0x201, {1, 2})) << "too short";
  EXPECT_TRUE(changes_by(0x000, {0x80, 0x01}));
  EXPECT_FALSE(changes_by(0x301, {1, 2, 3}));
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

// "b11 to b30: fixed to 0" [RJ71CN91 App. 3 1400H, 1028H]; the ME3CAN1-Q's tables have bit 31 and the CAN-ID alone.
TEST_P(Pdo, Bit30_OfRpdosAndOfEmergencyConsumers_IsFixed) {
  spec("ME3-PDO-020", "RJ71-RPDO-011 RJ71-EMCY-021");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  for (const std::uint16_t high : Words{0x4000, 0xC000, 0x0001, 0x2000}) {
    for (const std::uint16_t index : Words{0x1400, 0x14FF})
      s.cif({0x0002, 0, index, 1, 4, 0x0345, high}).expect_abort(0x06090030);
    for (const std::uint16_t node : Words{2, 127})
      s.cif({0x0002, 0, 0x1028, node, 4, 0x0085, high}).expect_abort(0x06090030);
  }
  s.expect_object(0x1400, 1, 0x00000201, 4);
  s.expect_object(0x14FF, 1, 0x80000000, 4);
  s.expect_object(0x1028, 127, 0x000000FF, 4);
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
  s.power_on_operational();
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

}  // namespace
}  // namespace canopus::scenario::me3can1_q_pdo_test
