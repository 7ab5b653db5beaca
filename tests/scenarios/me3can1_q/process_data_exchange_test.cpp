// spec/me3can1-q/scenarios.md, section 7: what a data exchange brings to and from the words (S43a to S43d).

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_process_data_exchange_test {
namespace {

CANOPUS_OF_BOTH_MODULES(ProcessDataExchange);

TEST_P(ProcessDataExchange, S43a_DummyMapping_SkipsAByte) {
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

TEST_P(ProcessDataExchange, S43b_OnlyMappedObjectsAreCopied) {
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
TEST_P(ProcessDataExchange, FirstAndLastObject_InOnePdo) {
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
TEST_P(ProcessDataExchange, EachRpdo_ComesToItsOwnWords_AfterAChange) {
  spec("ME3-PBUF-002 ME3-PBUF-005 ME3-DX-008", "RJ71-RPDO-010 RJ71-RPDO-001");
  IntelligentScenario s(GetParam());
  s.power_on_operational();
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

TEST(Me3ProcessDataExchange, S43c_NotOperational_TheProcessDataWait) {
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

TEST_P(ProcessDataExchange, S43d_Selection_OfProcessDataAndEmergencies) {
  spec("ME3-DX-001 ME3-DX-002 ME3-DX-003 ME3-DX-004 ME3-IO-003", "RJ71-IO-002");
  IntelligentScenario s(GetParam());
  s.power_on_operational();
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

TEST(Me3ProcessDataExchange, ExchangeStatus_ReadsInBit8WhileItRuns) {
  RecordProperty("spec", "ME3-DX-005");
  IntelligentScenario s;
  s.power_on_operational();
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

TEST_P(ProcessDataExchange, ReceivedData_StandStillBetweenExchanges_TheLatestFrameWins) {
  spec("ME3-DX-008", "RJ71-RPDO-001");
  IntelligentScenario s(GetParam());
  s.power_on_operational();
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

TEST_P(ProcessDataExchange, WordsWrittenBeforeTheRequest_LeaveTogether_LaterOnesWait) {
  spec("ME3-DX-009", "RJ71-PDO-004");
  IntelligentScenario s(GetParam());
  s.power_on_operational();
  s.write(13000, {1, 2, 3, 4});
  s.y(0x01, true);
  s.write(13002, {30, 40});  // in the middle of the exchange
  s.wait_x(0x01, true);
  s.tx(0x181, {1, 0, 2, 0, 3, 0, 4, 0}).no_tx();
  s.y(0x01, false);
  s.exchange();
  s.tx(0x181, {1, 0, 2, 0, 30, 0, 40, 0}).no_tx();
}

TEST_P(ProcessDataExchange, RemoteRequestOfAPdo_IsNotAnswered) {
  IntelligentScenario s(GetParam());
  s.power_on_operational();
  s.write(13000, 1);
  s.exchange();
  s.ignore_tx();
  s.rx_remote(0x181, 8).rx_remote(0x201, 8);
  s.advance(1s);
  s.no_tx();
}

TEST_P(ProcessDataExchange, RpdoLengthErrors_SendEmergencies) {
  spec("ME3-PDO-019", "");
  IntelligentScenario s(GetParam());
  s.power_on_operational();
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

TEST_P(ProcessDataExchange, MappingIsChecked_LengthAndMappability) {
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

}  // namespace
}  // namespace canopus::scenario::me3can1_q_process_data_exchange_test
