// spec/me3can1-q/scenarios.md, section 4: signals.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_signals_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Signals);

TEST(Me3Signals, S14_ErrorClear_ClearsLatchedErrors_AndHoldsThemDownWhileOn) {
  RecordProperty("spec", "ME3-IO-014 ME3-ERR-010 ME3-ERR-011");
  IntelligentScenario s;
  s.power_on();
  s.write(21, 100);
  s.expect(29, 0x0040).expect(39, 21).expect_x(0x0F, true);
  s.y(0x0F, true);
  s.expect(29, 0).expect(39, 0).expect_x(0x0F, false);
  s.write(27, 200);
  s.expect(29, 0).expect(39, 0).expect_x(0x0F, false);
  s.y(0x0F, false);
  s.expect_x(0x0F, false);
  s.write(27, 200);
  s.expect(29, 0x0040).expect(39, 27).expect_x(0x0F, true);
  s.write(21, 5);
  s.expect(39, 27);
  s.write(29, 0);
  s.expect(29, 0).expect(39, 0).expect_x(0x0F, false);
  s.write(27, 200);
  s.write(29, 0xFFBF);  // bit 6 alone
  s.expect(29, 0).expect(39, 0);
  s.write(27, 200);
  s.controller().overflows = 1;
  s.write(27, 5);  // a good value does not take the error back
  s.tx(0x0FF, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0});
  s.expect(29, 0x0140).expect(39, 27);
  s.write(29, 0xFEFF);
  s.expect(29, 0x0040).expect(39, 27).expect_x(0x0F, true);
  s.write(29, 0xFFFF);
  s.expect(29, 0x0040).expect(39, 27);
  s.write(29, 0xFFBF);
  s.expect(29, 0).expect(39, 0).expect_x(0x0F, false);
  s.y(0x0F, true);
  s.controller().overflows = 2;
  s.write(20, 0);
  s.expect(29, 0).expect_x(0x0F, false);
  s.y(0x0F, false);
  s.expect(29, 0).expect_x(0x0F, false);
  s.controller().overflows = 3;
  s.write(20, 0);
  s.expect(29, 0x0100).expect_x(0x0F, true);
  s.ignore_tx();
  // Refused writes have an address of their own, and it goes the same way.
  s.write(22, 0);
  s.supply_off();
  s.supply_on();
  s.write(70, 1);
  s.wait_bit(25, 7, false);
  s.ignore_tx();
  s.expect(29, 0x0020).expect(40, 70).expect_x(0x0F, true);
  s.y(0x0F, true);
  s.expect(29, 0).expect(40, 0).expect_x(0x0F, false);
}

TEST_P(Signals, LatchedErrors_StayAfterTheirCause_OthersFollowIt) {
  spec("ME3-ERR-006 ME3-ERR-007 ME3-STAT-003", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.error_counters(95, 0);
  s.expect(35, 95).expect_bit(25, 1, false);
  s.error_counters(96, 0);
  s.expect(35, 96).expect_bit(25, 1, true).expect_bit(29, 14, false);
  s.error_counters(0, 127);
  s.expect(36, 127).expect_bit(25, 1, true).expect_bit(29, 14, false).no_tx();
  s.error_counters(128, 0);
  s.expect(35, 128).expect_bit(25, 1, false).expect(29, 0x4000).expect_x(0x0F, false);
  s.tx(0x0FF, {0x20, 0x81, 0x11, 0, 0, 0, 0, 0}).no_tx();
  s.error_counters(0, 255);
  s.expect(36, 128).expect(29, 0x4000).no_tx();  // still passive: no second message
  s.error_counters(127, 0);
  s.expect(29, 0).expect_bit(25, 1, true);
  s.controller().overflows = 1;
  s.write(20, 0);
  s.expect(29, 0x0100).expect_x(0x0F, true);
  s.ignore_tx();
  s.advance(1s);
  // "All the bits ... automatically turn off when the error cause is removed" [RJ71CN91 App. 1 XF].
  s.expect(29, s.is_rj71cn91() ? 0 : 0x0100);
  s.y(0x0F, true);
  s.expect(29, 0).expect_x(0x0F, false);
  s.y(0x0F, false);
  s.controller().lost = 1;
  s.write(20, 0);
  s.expect(29, 0x0100).expect_x(0x0F, true);
  s.tx(0x0FF, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0}).no_tx();
  s.y(0x0F, true);
  s.expect(29, 0);
  s.error_counters(256, 0);
  s.expect_bit(25, 1, false);
  s.ignore_tx();
}

TEST(Me3Signals, BusOff_ShowsInStatusAndCounters_AndEndsWithARestart) {
  RecordProperty("spec", "ME3-ERR-002");
  IntelligentScenario s;
  s.power_on();
  s.error_counters(256, 0);
  s.expect(35, 256).expect(36, 256).expect_bit(25, 1, false).expect(29, 0x0008).expect_x(0x0F, true);
  s.y(0x0F, true);
  s.expect(29, 0x0008).expect_x(0x0F, true);  // follows its cause
  s.y(0x0F, false);
  s.advance(60s);
  s.expect(29, 0x0008);
  s.ignore_tx();
  s.restart();
  s.expect(29, 0).expect(35, 0).expect(36, 0).expect_x(0x0F, false);
  s.error_counters(256, 0);
  s.expect(29, 0x0008).expect_x(0x0F, true);
  s.error_counters(0, 0);  // a controller that was brought back: the bit is not latched
  s.expect(29, 0).expect_x(0x0F, false).ignore_tx();
}

TEST_P(Signals, QueueOverflow_SendsEmergency8110) {
  spec("ME3-EMCY-010", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.controller().overflows = 1;
  s.advance(0ms);
  s.write(20, 0);
  s.tx(0x0FF, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0}).no_tx();
  s.controller().overflows = 2;
  s.write(20, 0);
  s.no_tx();  // not again before the bit was cleared
}

TEST_P(Signals, S15_NmtErrorClear_OneNodeThenAll) {
  spec("ME3-IO-015 ME3-IO-016 ME3-IO-017 ME3-IO-018 ME3-NEC-010 ME3-NEC-012", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1016, 1, 0x000205DC, 4);
  s.set_object(0x1016, 2, 0x000305DC, 4);
  s.rx(0x702, {0x05});
  s.rx(0x703, {0x05});
  s.expect(402, 0x0002).expect(403, 0x0002).expect_x(0x10, false);
  s.advance(1499ms);
  s.expect_x(0x10, false);
  s.advance(10ms);
  s.expect_bit(402, 7, true).expect_bit(403, 7, true).expect_x(0x10, true);
  s.ignore_tx();
  s.y(0x10, true);  // all nodes
  s.expect(402, either(0x0002, 0)).expect(403, either(0x0002, 0)).expect_x(0x10, false);
  s.y(0x10, false);
  s.rx(0x702, {0x05});
  s.rx(0x703, {0x05});
  s.advance(1501ms);
  s.expect(402, either(0x0082, 0x0080)).expect(403, either(0x0082, 0x0080)).expect_x(0x10, true);
  s.ignore_tx();
  s.write(400, 2);
  s.y(0x10, true);
  s.expect_bit(402, 7, false).expect_bit(403, 7, true).expect_x(0x10, true);
  s.y(0x10, false);
  s.write(400, 0);
  s.y(0x10, true);
  s.expect_bit(403, 7, false).expect_x(0x10, false);
  // A failure that arises now is cleared at once; what runs is shown all the same.
  s.rx(0x702, {0x05});
  s.expect(402, 0x0002);
  s.y(0x10, false);
  s.y(0x10, true);
  s.expect(402, 0x0002);
  s.advance(2s);
  s.expect_bit(402, 7, false).expect_x(0x10, false);
  s.y(0x10, false);
  s.rx(0x702, {0x05});
  s.advance(2s);
  s.expect_bit(402, 7, true).expect_x(0x10, true);
  s.ignore_tx();
}

// Y10 held for one node holds that node's failures down, and no other's.
TEST_P(Signals, NmtErrorClear_HeldForOneNode) {
  spec("ME3-IO-016 ME3-IO-017 ME3-IO-018", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1016, 1, 0x00020064, 4);
  s.set_object(0x1016, 2, 0x000300C8, 4);
  s.write(400, 2).y(0x10, true);
  s.rx(0x702, {0x05}).rx(0x703, {0x05}).advance(199ms).ignore_tx();
  s.expect(402, either(0x0002, 0)).expect(403, 0x0002).expect_x(0x10, false);
  s.advance(1ms)
      .ignore_tx()
      .expect(402, either(0x0002, 0))
      .expect(403, either(0x0082, 0x0080))
      .expect_x(0x10, true);
  s.y(0x10, false).expect(402, either(0x0002, 0)).expect(403, either(0x0082, 0x0080)).expect_x(0x10, true);
  // The edge to ON clears, and what G400 says then; the one to OFF clears nothing.
  s.y(0x10, true).write(400, 0).expect(403, either(0x0082, 0x0080)).expect_x(0x10, true);
  s.y(0x10, false).expect(403, either(0x0082, 0x0080)).expect_x(0x10, true);
}

TEST_P(Signals, NmtErrorClearNode_Above127_IsASettingError) {
  spec("ME3-NEC-001", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.expect(400, 0);
  s.write(400, 127);
  s.expect(400, 127).expect(29, 0);
  s.write(400, 128);
  s.expect(400, 127).expect(29, 0x0040).expect(39, 400);
}

TEST_P(Signals, S16_EmergencyClear_EmptiesTheArea_AndDropsWhatComesMeanwhile) {
  spec("ME3-IO-019 ME3-IO-020 ME3-IO-021 ME3-EBUF-002 ME3-EBUF-005 ME3-EBUF-006",
       "RJ71-EMCY-019 RJ71-EMCY-016");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.expect_x(0x11, false);
  s.rx(0x085, {0x30, 0x81, 0x11, 0x01, 0x02, 0x03, 0x04, 0x05});
  s.expect_x(0x11, true).expect(750, 0);
  s.exchange();
  s.expect(750, {5, 0x8130, 0x0111, 0x0302, 0x0504, 0});
  s.y(0x11, true);
  for (module::BufferAddress a = 750; a <= 859; ++a) s.expect(a, 0);
  s.expect_x(0x11, false);
  s.rx(0x085, {0x30, 0x81, 0x11, 0x01, 0x02, 0x03, 0x04, 0x05});
  s.expect_x(0x11, false);
  s.y(0x11, false);
  s.expect_x(0x11, false);
  s.exchange();
  s.expect(750, 0);
  s.rx(0x086, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0});
  s.expect_x(0x11, true);
  s.exchange();
  s.expect(750, {6, 0x1000, 0x0001});
  s.write(750, 1);
  s.write(751, 0);
  s.expect(750, {6, 0x1000}).expect_x(0x11, true);
  s.write(750, 0);
  s.expect(750, {0, 0, 0}).expect_x(0x11, false);
}

TEST_P(Signals, EmergencyOfANodeThatIsNotConsumed_IsNotStored) {
  spec("ME3-EBUF-007 ME3-EMCY-005", "RJ71-EMCY-021");
  IntelligentScenario s(GetParam());
  s.power_on();
  for (std::uint8_t n = 1; n <= 127; ++n) s.expect_object(0x1028, n, 0x80U + n, 4);
  s.set_object(0x1028, 5, 0x80000085, 4);
  s.store_objects();
  s.restart();
  s.expect_object(0x1028, 5, 0x80000085, 4);
  s.rx(0x085, {0x30, 0x81, 0x11, 0x01, 0x02, 0x03, 0x04, 0x05});
  s.expect_x(0x11, false);
  s.exchange();
  s.expect(750, 0);
  s.rx(0x086, {0x30, 0x81, 0x11, 0x01, 0x02, 0x03, 0x04, 0x05});
  s.expect_x(0x11, true);
  // Another CAN-ID for node 5 (bits 0-10): that one is node 5's, 085H nobody's.
  s.write(750, 0);
  s.set_object(0x1028, 5, 0x00000685, 4);
  s.rx(0x085, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0}).expect_x(0x11, false);
  s.rx(0x685, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0}).expect_x(0x11, true);
  s.exchange();
  s.expect(750, {5, 0x8130, 0x0011});
}

TEST_P(Signals, S70_TwentyThreeEmergencies_StackKeepsTheFirstEleven_RingTheLastEleven) {
  spec("ME3-EBUF-001 ME3-EBUF-003 ME3-EBUF-004 ME3-EBUF-005 ME3-EBUF-006",
       "RJ71-EMCY-017 RJ71-EMCY-018 RJ71-EMCY-016");
  IntelligentScenario s(GetParam());
  s.power_on();
  for (std::uint8_t i = 1; i <= 11; ++i) s.rx(0x085, {i, 0x10, 0x01, 0, 0, 0, 0, 0});
  s.exchange();
  for (std::uint16_t i = 0; i < 11; ++i) {
    s.expect(750U + 5U * i, {5, static_cast<std::uint16_t>(0x1001 + i)});
    s.expect(805U + 5U * i, {0, 0});
  }
  for (std::uint8_t i = 12; i <= 22; ++i) s.rx(0x085, {i, 0x10, 0x01, 0, 0, 0, 0, 0});
  s.exchange();
  for (std::uint16_t i = 0; i < 11; ++i) {
    s.expect(750U + 5U * i, {5, static_cast<std::uint16_t>(0x1001 + i)});
    s.expect(805U + 5U * i, {5, static_cast<std::uint16_t>(0x100C + i)});
  }
  s.rx(0x085, {23, 0x10, 0x01, 0, 0, 0, 0, 0});
  s.expect(806, 0x100C);
  s.write(20, 0x0100);
  s.exchange();
  s.expect(806, 0x100C);  // process data only
  s.write(20, 0);
  s.exchange();
  for (std::uint16_t i = 0; i < 11; ++i) {
    s.expect(750U + 5U * i, {5, static_cast<std::uint16_t>(0x1001 + i)});
    s.expect(805U + 5U * i, {5, static_cast<std::uint16_t>(0x100D + i)});
  }
  for (std::uint8_t i = 24; i <= 40; ++i) s.rx(0x085, {i, 0x10, 0x01, 0, 0, 0, 0, 0});
  s.exchange();
  for (std::uint16_t i = 0; i < 11; ++i) {
    s.expect(750U + 5U * i, {5, static_cast<std::uint16_t>(0x1001 + i)});
    s.expect(805U + 5U * i, {5, static_cast<std::uint16_t>(0x101E + i)});
  }
  for (module::BufferAddress a = 751; a <= 859; ++a) {
    const std::uint16_t before = s.read(a);
    s.write(a, 0);
    s.expect(a, before);
  }
  s.expect_x(0x11, true);
  s.write(750, 0);
  s.expect(750, Words(110, 0)).expect_x(0x11, false);
  s.rx(0x086, {0x77, 0x10, 0x01, 0, 0, 0, 0, 0});
  s.exchange();
  s.expect(750, {6, 0x1077, 0x0001}).expect(755, Words(105, 0));  // the stack's turn again
}

TEST_P(Signals, ProhibitedSignals_HaveNoEffect) {
  spec("ME3-IO-026", "RJ71-IO-008");
  IntelligentScenario s(GetParam());
  s.power_on();
  const std::uint32_t before = s.inputs();
  for (const unsigned number : {0x00U, 0x05U, 0x06U, 0x07U, 0x08U, 0x09U, 0x0AU, 0x0BU, 0x0CU, 0x0DU, 0x0EU,
                                0x14U, 0x15U, 0x16U, 0x18U, 0x19U, 0x1AU, 0x1BU, 0x1CU, 0x1DU, 0x1EU}) {
    s.y(number, true);
    s.advance(10s);
    s.y(number, false);
    EXPECT_EQ(s.inputs(), before) << "Y" << std::hex << number;
  }
  s.expect(25, 0x0100).expect(29, 0).no_tx();
}

TEST_P(Signals, SystemAreas_IgnoreWrites) {
  spec("ME3-SYS-006", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  for (const module::BufferAddress a :
       {0U,   19U,  23U,  26U,  28U,  30U,  34U,   41U,   49U,    60U,    69U,    72U,   399U,
        528U, 600U, 728U, 749U, 860U, 999U, 1067U, 9999U, 11024U, 12999U, 14024U, 65535U}) {
    s.write(a, 0x1234);
    s.expect(a, 0);
  }
  s.expect(29, 0);
}

TEST_P(Signals, ReadOnlyWords_IgnoreWrites) {
  spec("ME3-PBUF-008", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  for (const module::BufferAddress a : {10000U, 11023U}) {
    s.write(a, 7);
    s.expect(a, 0);
  }
  s.write(37, 1);
  s.expect(37, 2500);
  s.write(727, 5);
  s.expect(727, 0x007F);
  s.write(25, 0xFFFF);
  s.expect(25, 0x0100);
  s.write(25, 0x0000);
  s.expect(25, 0x0100).expect(29, 0);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_signals_test
