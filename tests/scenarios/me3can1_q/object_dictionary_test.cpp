// Object dictionary, SDO server and EMCY of the ME3CAN1-Q, as other nodes and the PLC see them [4.3 to 4.6].

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_object_dictionary_test {
namespace {

CANOPUS_OF_BOTH_MODULES(EmergencyInObjectDictionary);
CANOPUS_OF_BOTH_MODULES(Objects);

void expect_abort(IntelligentScenario& s, const Words& command, std::uint32_t code,
                  Where where = Where::current()) {
  s.cif(command, where).expect_abort(code, 0, where);
}

TEST(Me3Objects, Identity) {
  RecordProperty("spec", "ME3-OD-006");
  IntelligentScenario s;
  s.power_on();
  s.expect_object(0x1018, 0, 3, 1);
  s.expect_object(0x1018, 1, 0x00000071, 4);
  s.expect_object(0x1018, 2, 0x0000ED63, 4);
  s.expect_object(0x1018, 3, 0x00010000, 4);
  expect_abort(s, {0x0004, 0, 0x1018, 4}, 0x06090011);
}

TEST_P(Objects, ReservedIndexes_DoNotExist) {
  spec("ME3-OD-001 ME3-OD-002", "RJ71-OD-006");
  IntelligentScenario s(GetParam());
  s.power_on();
  for (const std::uint16_t index : Words{
           0x0001, 0x0002, 0x0003, 0x0004, 0x0005, 0x0006, 0x0007, 0x0008, 0x0009, 0x009F, 0x1002, 0x1004,
           0x1007, 0x100B, 0x100E, 0x100F, 0x1013, 0x1019, 0x101F, 0x1021, 0x1027, 0x102B, 0x1200, 0x1280,
           0x13FF, 0x1500, 0x15FF, 0x1700, 0x17FF, 0x1900, 0x19FF, 0x1B00, 0x1BFF, 0x1C00, 0x1F21, 0x1F23,
           0x1F28, 0x1F7F, 0x1F8A, 0x1F8F, 0x1F91, 0x1FFF, 0x2000, 0x5FFF, 0x6000, 0x9FFF, 0xB000, 0xFFFF}) {
    expect_abort(s, {0x0004, 0, index, 0}, 0x06020000);
    expect_abort(s, {0x0002, 0, index, 0, 1, 0}, 0x06020000);
  }
}

TEST_P(Objects, Length_MustFit) {
  spec("ME3-OD-005", "RJ71-SDO-016");
  IntelligentScenario s(GetParam());
  s.power_on();
  expect_abort(s, {0x0002, 0, 0x1017, 0, 4, 1, 0}, 0x06070012);
  expect_abort(s, {0x0002, 0, 0x1017, 0, 1, 1}, 0x06070013);
  expect_abort(s, {0x0002, 0, 0x1F80, 0, 5, 1, 0, 0}, 0x06070012);
  expect_abort(s, {0x0002, 0, 0x1F80, 0, 3, 1, 0}, 0x06070013);
  expect_abort(s, {0x0002, 0, 0x1017, 0, 0}, 0x06070010);
  s.expect_object(0x1017, 0, 0, 2);
  s.expect_object(0x1F80, 0, 0, 4);
  // The same on the bus.
  s.rx(0x67F, {0x23, 0x17, 0x10, 0x00, 1, 0, 0, 0}).tx(0x5FF, {0x80, 0x17, 0x10, 0x00, 0x12, 0, 0x07, 0x06});
  s.rx(0x67F, {0x2F, 0x17, 0x10, 0x00, 1, 0, 0, 0}).tx(0x5FF, {0x80, 0x17, 0x10, 0x00, 0x13, 0, 0x07, 0x06});
  s.no_tx();
}

TEST_P(Objects, Defaults_OfTheCommunicationArea) {
  spec("ME3-FLY-001 ME3-MST-014", "RJ71-FLY-009");
  IntelligentScenario s(GetParam());
  s.power_on_as(9);
  s.expect_object(0x1005, 0, 0x80, 4);
  s.expect_object(0x1006, 0, 0, 4);
  s.expect_object(0x1012, 0, 0x80000100, 4);
  s.expect_object(0x1014, 0, 0x89, 4);
  s.expect_object(0x1016, 0, 0x7F, 1);
  s.expect_object(0x1028, 0, 0x7F, 1);
  for (std::uint8_t n = 1; n <= 127; ++n) s.expect_object(0x1028, n, 0x80U + n, 4);
  s.expect_object(0x1029, 0, 1, 1);
  s.expect_object(0x1029, 1, 0, 1);
  s.expect_object(0x102A, 0, 0, 2);
  expect_abort(s, {0x0002, 0, 0x102A, 0, 2, 1}, 0x06010002);
  s.expect_object(0x1F80, 0, 0, 4);
  s.expect_object(0x1F81, 0, 0x7F, 1);
  s.expect_object(0x1F82, 0, 0x80, 1);
  s.expect_object(0x1F83, 0, 0x80, 1);
  s.expect_object(0x1F90, 0, 6, 1);
  s.expect_object(0x1F90, 1, 100, 2);
  s.expect_object(0x1F90, 2, 500, 2);
  s.expect_object(0x1F90, 3, 1, 2);
  s.expect_object(0x1F90, 4, 1500, 2);
  s.expect_object(0x1F90, 5, 10, 2);
  s.expect_object(0x1F90, 6, 4090, 2);
}

TEST_P(Objects, DefaultCobIds_FollowTheNodeId) {
  spec("ME3-OD-012 ME3-EMCY-003", "RJ71-CANID-002 RJ71-OD-007");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.expect_object(0x1014, 0, 0xFF, 4);
  s.expect_object(0x1400, 1, 0x27F, 4);
  s.write(27, 5);
  s.save();
  s.restart();
  s.expect_object(0x1014, 0, 0x85, 4);
  expect_abort(s, {0x0002, 0, 0x1014, 0, 4, 0x86, 0}, 0x06010002);
  s.expect_object(0x1400, 1, 0x205, 4);
  s.expect_object(0x1401, 1, 0x305, 4);
  s.expect_object(0x1402, 1, 0x405, 4);
  s.expect_object(0x1403, 1, 0x505, 4);
  s.expect_object(0x1800, 1, 0x40000185, 4);
  s.expect_object(0x1801, 1, 0x40000285, 4);
  s.expect_object(0x1802, 1, 0x40000385, 4);
  s.expect_object(0x1803, 1, 0x40000485, 4);
  s.expect_object(0x1005, 0, 0x080, 4);
  s.expect_object(0x1012, 0, 0x80000100, 4);
  s.nmt(0x01, 5).expect_bit(25, 0, true);  // NMT: 0
  s.nmt(0x80, 5).expect_bit(25, 8, true);
  s.rx(0x605, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.tx(0x585, {0x43, 0x00, 0x10, 0x00, 0x95, 0x01, 0, 0});
  s.cif({0x000A, 0x1000, 1, 0, 0});
  s.tx(0x085, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0});
  s.set_object(0x1017, 0, 10, 2);
  s.ignore_tx();
  s.advance(10ms);
  s.tx(0x705, {0x7F}).no_tx();
}

TEST_P(Objects, RestrictedIdentifiers_AreRefused) {
  spec("ME3-OD-011", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  const std::vector<std::uint16_t> restricted{0x000, 0x001, 0x07F, 0x101, 0x180, 0x581, 0x5FF, 0x601,
                                              0x67F, 0x6E0, 0x6FF, 0x701, 0x77F, 0x780, 0x7FF};
  for (const std::uint16_t id : restricted) {
    expect_abort(s, {0x0002, 0, 0x1404, 1, 4, id, 0}, 0x06090030);
    expect_abort(s, {0x0002, 0, 0x1804, 1, 4, id, 0x4000}, 0x06090030);
    expect_abort(s, {0x0002, 0, 0x1005, 0, 4, id, 0}, 0x06090030);
    expect_abort(s, {0x0002, 0, 0x1028, 5, 4, id, 0}, 0x06090030);
  }
  // Only 11-bit CAN-IDs: bit 29 is none of theirs.
  expect_abort(s, {0x0002, 0, 0x1404, 1, 4, 0x0190, 0x2000}, 0x06090030);
  expect_abort(s, {0x0002, 0, 0x1804, 1, 4, 0x0190, 0x6000}, 0x06090030);
  expect_abort(s, {0x0002, 0, 0x1028, 5, 4, 0x0190, 0x2000}, 0x06090030);
  s.set_object(0x1012, 0, 0x100, 4);
  for (const std::uint16_t id : restricted)
    expect_abort(s, {0x0002, 0, 0x1012, 0, 4, id, 0x8000}, 0x06090030);
  for (const std::uint16_t id : Words{0x080, 0x100, 0x181, 0x580, 0x600, 0x680, 0x6DF, 0x700}) {
    s.set_object(0x1804, 1, 0x40000000U | id, 4);
    s.set_object(0x1804, 1, 0xC0000000U | id, 4);
  }
}

TEST(Me3Objects, SdoServer_AnswersInPreOperationalAndOperational_NotInStopped) {
  RecordProperty("spec", "ME3-SDO-001 ME3-SDO-006 ME3-NMT-004 ME3-STAT-007 ME3-STAT-002");
  IntelligentScenario s;
  s.power_on_as(1);
  const Bytes request{0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0};
  const Bytes answer{0x43, 0x18, 0x10, 0x01, 0x71, 0, 0, 0};
  s.expect(25, 0x0100);
  s.rx(0x601, request).tx(0x581, answer).no_tx();
  s.nmt(0x01, 1);
  s.expect(25, 0x0201);
  s.rx(0x601, request).tx(0x581, answer).no_tx();
  s.nmt(0x02, 1);
  s.expect(25, 0x0000);
  s.rx(0x601, request).no_tx();
  s.rx(0x601, {0x2B, 0x15, 0x10, 0x00, 77, 0, 0, 0}).no_tx();
  s.cif({0x0004, 2, 0x1000, 0});
  s.no_tx();
  s.nmt(0x80, 1);
  s.expect(25, 0x0100);
  s.expect_object(0x1015, 0, 0, 2);            // it was not processed either
  for (const std::uint8_t high : Bytes{0x12})  // no channel to configure
    for (const std::uint8_t low : Bytes{0x00, 0x80})
      s.rx(0x601, {0x40, low, high, 0, 0, 0, 0, 0}).tx(0x581, {0x80, low, high, 0, 0, 0, 0x02, 0x06});
  s.nmt(0x02, 1);
  s.expect(25, 0x0000);
  s.nmt(0x01, 1);
  s.expect(25, 0x0201);
}

// A transfer that runs when the module is stopped ends there, without another frame.
TEST_P(Objects, SdoClient_StoppedInTheMiddle_SendsAndTakesNothingMore) {
  spec("ME3-SDO-006 ME3-CIF-010", "RJ71-CIF-005");
  for (const bool answered : {true, false}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.write(1000, {0x0004, 2, 0x2000, 1});
    s.y(0x17, true);
    s.advance(1ms);
    s.tx(0x602, {0x40, 0x00, 0x20, 0x01, 0, 0, 0, 0}).rx(0x582, {0x41, 0x00, 0x20, 0x01, 8, 0, 0, 0});
    s.tx(0x602, {0x60, 0, 0, 0, 0, 0, 0, 0});
    s.nmt(0x02, 1);
    if (answered) s.rx(0x582, {0x00, 1, 2, 3, 4, 5, 6, 7}).no_tx();
    s.advance(10s).no_tx();
    s.expect_x(0x17, true).expect(1000, {0x000F, 0x0F0F});
    // "The area will not be cleared after command execution" [RJ71CN91 App. 2].
    s.expect(1002, s.is_rj71cn91() ? Words{0x2000, 1, 0} : Words{0, 0, 0});
    s.y(0x17, false);
    s.nmt(0x80, 1);
    s.write(1000, {0x0004, 2, 0x1000, 0});  // the channel is free again
    s.y(0x17, true);
    s.advance(1ms);
    s.tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
    s.rx(0x582, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00});
    s.expect_x(0x17, true).expect(1000, {0x0005, 2, 0x1000, 0, 4, 0x0191, 0x000F}).no_tx();
  }
}

TEST_P(Objects, SdoClient_UsesTheDefaultChannelOfEachNode) {
  spec("ME3-SDO-002", "RJ71-SDO-009");
  IntelligentScenario s(GetParam());
  s.power_on_as(9);
  for (const std::uint16_t node : Words{1, 8, 10, 127}) {
    s.write(1000, {0x0004, node, 0x1000, 0});
    s.y(0x17, true);
    s.advance(1ms);
    s.tx(0x600U + node, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
    const Bytes answer{0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00};
    s.rx(0x580U + node - 1, answer).rx(0x580U + (node + 1) % 128, answer).expect(1000, 0xFFFF);
    s.rx(0x580U + node, answer).expect(1000, {0x0005, node, 0x1000, 0, 4, 0x0191, 0x000F}).no_tx();
    s.y(0x17, false);
  }
}

TEST(Me3Objects, SdoServer_LongObjects_GoSegmented) {
  RecordProperty("spec", "ME3-SDO-003 ME3-OD-007");
  IntelligentScenario s;
  s.power_on_as(1);
  s.rx(0x601, {0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  s.tx(0x581, {0x41, 0x08, 0x10, 0x00, 9, 0, 0, 0});
  s.rx(0x601, {0x60, 0, 0, 0, 0, 0, 0, 0});
  s.tx(0x581, {0x00, 'M', 'E', '3', 'C', 'A', 'N', '1'});
  s.rx(0x601, {0x70, 0, 0, 0, 0, 0, 0, 0});
  s.tx(0x581, {0x1B, '-', 'Q', 0, 0, 0, 0, 0}).no_tx();
  s.rx(0x601, {0x40, 0x09, 0x10, 0x00, 0, 0, 0, 0});
  s.tx(0x581, {0x43, 0x09, 0x10, 0x00, '1', '.', '0', '0'}).no_tx();
}

TEST(Me3Objects, S71_ErrorHistory_KeepsTheFifteenNewest) {
  RecordProperty("spec", "ME3-OD-009 ME3-OD-010");
  IntelligentScenario s;
  s.power_on_as(1);
  s.expect_object(0x1003, 0, 0, 1);
  for (std::uint16_t i = 1; i <= 16; ++i) {
    s.cif({0x000A, static_cast<std::uint16_t>(0x1000 + i), 0x0001, 0, 0});
    s.expect(1000, 0x000B);
  }
  s.ignore_tx();
  s.expect_object(0x1003, 0, 15, 1);
  for (std::uint8_t sub = 1; sub <= 15; ++sub) {
    s.cif({0x0004, 0, 0x1003, sub});
    s.expect(1000, 0x0005).expect(1005, static_cast<std::uint16_t>(0x1011 - sub));
  }
  expect_abort(s, {0x0002, 0, 0x1003, 0, 1, 1}, 0x06090030);
  s.expect_object(0x1001, 0, 0x01, 1);
  expect_abort(s, {0x0002, 0, 0x1003, 0, 1, 0xFF}, 0x06090030);
  s.set_object(0x1003, 0, 0, 1);
  s.expect_object(0x1003, 0, 0, 1);
  for (std::uint8_t sub = 1; sub <= 15; ++sub) s.expect_object(0x1003, sub, 0, 4);
  expect_abort(s, {0x0004, 0, 0x1003, 16}, 0x06090011);
  s.expect_object(0x1001, 0, 0, 1);
  s.ignore_tx();
}

TEST_P(Objects, VerifyConfiguration_IsZeroAfterAnyChange) {
  spec("ME3-CFG-010", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  for (const auto& [index, sub, value, length] : std::vector<std::array<std::uint32_t, 4>>{
           {0x1015, 0, 5, 2}, {0x1F81, 2, 1, 4}, {0x1028, 3, 0x80000083, 4}}) {
    s.set_object(0x1020, 1, 5, 4);
    s.set_object(0x1020, 2, 6, 4);
    s.expect_object(0x1020, 1, 5, 4);
    s.expect_object(0x1020, 2, 6, 4);
    s.set_object(static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub), value, length);
    s.expect_object(0x1020, 1, 0, 4);
    s.expect_object(0x1020, 2, 0, 4);
  }
  // By another node, too; what is no configuration leaves it alone, and so does a value that is refused.
  s.set_object(0x1020, 1, 5, 4);
  s.set_object(0x1020, 2, 6, 4);
  s.set_object(0xA580, 1, 0x1234, 2);
  s.set_object(0x1003, 0, 0, 1);
  expect_abort(s, {0x0002, 0, 0x1029, 1, 1, 3}, 0x06090030);
  s.ignore_tx();
  s.expect_object(0x1020, 1, 5, 4);
  s.expect_object(0x1020, 2, 6, 4);
  s.rx(0x67F, {0x2B, 0x15, 0x10, 0x00, 7, 0, 0, 0}).tx(0x5FF, {0x60, 0x15, 0x10, 0x00, 0, 0, 0, 0});
  s.expect_object(0x1020, 1, 0, 4);
  s.expect_object(0x1020, 2, 0, 4).no_tx();
}

TEST_P(Objects, AssignmentBitsThatDoNotExist_AreRefused) {
  spec("ME3-SLV-006", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  for (const std::uint16_t bit : Words{0x02, 0x20, 0x40, 0x80}) {
    expect_abort(s, {0x0002, 0, 0x1F81, 2, 4, static_cast<std::uint16_t>(0x01 | bit), 0}, 0x06090030);
  }
  s.set_object(0x1F81, 2, 0xFFFFFF1D, 4);
}

// --- emergencies

TEST(Me3Emergency, CpuRunToStop_SendsMe002) {
  RecordProperty("spec", "ME3-EMCY-008 ME3-EMCY-002");
  IntelligentScenario s;
  s.power_on_as(1);
  s.cpu(module::CpuState::stop);
  s.tx(0x081, {0x00, 0xFF, 0x81, 0x4D, 0x45, 0x30, 0x30, 0x32}).no_tx();
  s.advance(10s);
  s.cpu(module::CpuState::stop);
  s.no_tx();
  s.cpu(module::CpuState::run).cpu(module::CpuState::run);
  s.no_tx();
  s.cpu(module::CpuState::stop);
  s.tx(0x081, {0x00, 0xFF, 0x81, 0x4D, 0x45, 0x30, 0x30, 0x32}).no_tx();
}

// Nor is what happens during the initialization told after it.
TEST(Me3Emergency, NotInInitialization) {
  RecordProperty("spec", "ME3-EMCY-011");
  IntelligentScenario s;
  s.supply_on();
  s.plug_in().cpu_failed(s.now());
  s.cpu(module::CpuState::stop);
  s.plug_in().cpu_failed(s.now());
  s.error_counters(130, 0).error_counters(0, 0).advance(10ms);
  s.wait_tx(0x77F, {0x00}).advance(10s).no_tx();
  s.expect_object(0x1003, 0, 0, 1).expect_object(0x1001, 0, 0, 1);
}

TEST_P(EmergencyInObjectDictionary, ErrorPassive_SendsOneMessagePerEvent) {
  spec("ME3-EMCY-002 ME3-EMCY-009", "RJ71-EMCY-001");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.error_counters(130, 0);
  s.tx(0x081, {0x20, 0x81, 0x11, 0, 0, 0, 0, 0}).no_tx();
  s.error_counters(135, 0);
  s.no_tx();
  s.error_counters(0, 0);
  s.ignore_tx();
  s.error_counters(0, 128);
  s.tx(0x081, {0x20, 0x81, 0x11, 0, 0, 0, 0, 0}).no_tx();
}

TEST_P(EmergencyInObjectDictionary, NotInStopped_NeitherSentNorReceived) {
  spec("ME3-EMCY-011 ME3-IO-008", "RJ71-EMCY-005");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.nmt(0x02, 1);
  s.error_counters(130, 0);
  s.rx(0x085, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0});
  s.no_tx().expect_x(0x11, false);
  s.error_counters(0, 0);
  s.cpu(module::CpuState::stop).cpu(module::CpuState::run);
  ++s.controller().overflows;
  s.write(20, 0).rx(0x080, {1}).no_tx().write(29, 0);
  for (const std::uint8_t command : Bytes{0x80, 0x01}) {
    s.nmt(command, 1);
    s.ignore_tx();
    s.error_counters(130, 0);
    s.tx(0x081, {0x20, 0x81, 0x11, 0, 0, 0, 0, 0}).no_tx();
    s.error_counters(0, 0);
    s.ignore_tx();
    s.rx(0x085, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0});
    s.expect_x(0x11, true);
    s.write(750, 0);
    s.expect_x(0x11, false);
  }
  s.nmt(0x02, 1).y(0x02, true).no_tx();  // nor that of a restart
  s.wait_x(0x02, true).y(0x02, false).tx(0x701, {0x00}).advance(1s).no_tx();
}

TEST(Me3Emergency, LostHeartbeat_NamesTheNode) {
  RecordProperty("spec", "ME3-HB-002 ME3-HB-003 ME3-HB-004 ME3-NEC-004 ME3-NST-004 ME3-NST-006");
  IntelligentScenario s;
  s.power_on_as(1);
  s.set_object(0x1016, 0x7F, 0x000205DC, 4);
  s.set_object(0x1016, 1, 0x00800064, 4);  // node 128: unused
  s.set_object(0x1016, 2, 0x00000064, 4);  // node 0: unused
  s.set_object(0x1016, 3, 0x00030000, 4);  // time 0: unused
  s.advance(10s);
  s.expect(402, 0).expect_x(0x10, false).no_tx();
  s.rx(0x703, {0x05});
  s.rx(0x702, {0x05});
  s.expect(402, 0x0002).expect(602, 5);
  s.advance(1400ms);
  s.rx(0x702, {0x7F});
  s.expect(602, 0x7F);
  s.advance(1499ms);
  s.no_tx().expect_bit(402, 7, false);
  s.advance(2ms);
  ASSERT_EQ(s.controller().sent.size(), 1U);
  EXPECT_EQ(text(s.controller().sent.front()).substr(0, 13), "081 [02 8F 11");
  s.ignore_tx();
  s.expect_bit(402, 7, true).expect_x(0x10, true);
  EXPECT_EQ(s.plug_in().leds(s.now())[4].pattern, module::LedPattern::double_flash);
  s.rx(0x702, {0x00});
  s.expect(602, 0x7F);
  s.ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_object_dictionary_test
