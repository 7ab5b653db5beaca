// spec/me3can1-q/scenarios.md, section 2: start-up procedures - settings, restart (S05 to S08), program (S84).

#include "canopus/canopen/dictionary/stored_values.hpp"
#include "canopus/module/storage/flash_memory.hpp"

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_start_up_test {
namespace {

CANOPUS_OF_BOTH_MODULES(StartUp);

TEST_P(StartUp, S05_MasterNode1_StepByStep) {
  spec("ME3-PRG-002 ME3-NODE-002", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(21, 405);
  s.save();
  s.restart();
  s.write(24, 250);
  s.write(27, 1);
  s.save();
  s.y(0x02, true);
  s.ignore_tx();
  s.wait_x(0x02, true);
  s.y(0x02, false);
  s.tx(0x701, {0x00});
  s.expect(601, 0x007F).expect(727, 0);
  s.set_object(0x1F80, 0, 1, 4);
  s.expect_bit(25, 15, false);  // not before the restart
  s.store_objects();
  s.restart();
  s.expect_bit(25, 15, true);
  s.set_object(0x1017, 0, 1000, 2);
  s.set_object(0x1016, 1, 0x000205DC, 4);
  s.set_object(0x1400, 1, 0x80000201, 4);
  s.set_object(0x1600, 0, 0, 1);
  s.set_object(0x1600, 1, 0xA5800110, 4);
  s.set_object(0x1600, 0, 1, 1);
  s.set_object(0x1400, 1, 0x00000182, 4);
  s.set_object(0x1800, 1, 0xC0000181, 4);
  s.set_object(0x1A00, 0, 0, 1);
  s.set_object(0x1A00, 1, 0xA1000110, 4);
  s.set_object(0x1A00, 0, 1, 1);
  s.set_object(0x1800, 1, 0x40000202, 4);
  s.set_object(0x1F81, 2, 0x0000000D, 4);
  s.set_object(0x1F84, 2, 0x000F0191, 4);
  s.set_object(0x1F89, 0, 10000, 4);
  s.store_objects();
  s.restart();
  s.expect_object(0x1017, 0, 1000, 2);
  s.expect_object(0x1016, 1, 0x000205DC, 4);
  s.expect_object(0x1F81, 2, 0x0000000D, 4);
  s.expect_object(0x1F84, 2, 0x000F0191, 4);
  s.expect_object(0x1F89, 0, 10000, 4);
  s.expect_object(0x1400, 1, 0x00000182, 4);
  s.expect_object(0x1600, 0, 1, 1);
  s.expect_object(0x1800, 1, 0x40000202, 4);
  s.expect_object(0x1A00, 0, 1, 1);
  s.expect_bit(25, 15, true);
  s.ignore_tx();
}

// The order of chapter 7's program; the slave answers by hand. tests/interop runs the same over Ethernet.
TEST_P(StartUp, S84_ProgramExample_InItsOrder) {
  spec("ME3-PRG-001", "");
  IntelligentScenario s(GetParam());
  const Bytes read_ok{0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00};
  // An SDO write to the slave through the CIF, two bytes.
  const auto sdo_write = [&](std::uint16_t index, std::uint8_t sub, std::uint16_t value) {
    const auto low = static_cast<std::uint8_t>(index & 0xFF), high = static_cast<std::uint8_t>(index >> 8);
    s.write(1000, {0x0002, 2, index, sub, 2, value}).y(0x17, true).advance(1ms);
    s.tx(0x602, {0x2B, low, high, sub, static_cast<std::uint8_t>(value & 0xFF),
                 static_cast<std::uint8_t>(value >> 8), 0, 0});
    s.rx(0x582, {0x60, low, high, sub, 0, 0, 0, 0})
        .expect_x(0x17, true)
        .expect(1000, {0x0003, 2, index, sub});
    s.y(0x17, false);
  };
  s.power_on();
  // 1. CANopenInit: mode, node address, baud rate, save, restart.
  s.write(21, 405).write(27, 1).write(24, 250);
  s.save().restart();
  s.expect(601, 0x7F);
  // 2. NMTMasterSettings: master; bit 3: the program starts the slaves. 3. NMTSlaveSettings.
  s.set_object(0x1F80, 0, 0x00000009, 4);
  s.set_object(0x1F81, 2, 0x0000000D, 4);
  s.store_objects().restart();
  s.rx(0x702, {0x00}).tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}).rx(0x582, read_ok).no_tx();
  s.expect(25, 0x8201).expect(402, 0);
  // 4. HeartbeatProducerSetup of the own and the remote node, HeartbeatConsumerSetup.
  s.set_object(0x1017, 0, 500, 2).ignore_tx();
  sdo_write(0x1017, 0, 200);
  s.set_object(0x1016, 1, 0x000203E8, 4);
  s.rx(0x702, {0x7F}).expect(402, 0x0002).expect(602, 0x7F);  // HeartbeatStatus, NMTStatus
  // 5. PDOSetup, four times: CANID, ObjectIndex, ObjectSubindex, ObjectLength, NoOfEntries, TransmissionType.
  struct Pdo {
    std::uint16_t communication, mapping;
    std::uint32_t cob_id, entry;
  };
  for (const Pdo& pdo :
       {Pdo{0x1400, 0x1600, 0x00000182, 0xA5800110}, Pdo{0x1401, 0x1601, 0x00000282, 0xA5800510},
        Pdo{0x1800, 0x1A00, 0x40000202, 0xA1000110}, Pdo{0x1801, 0x1A01, 0x40000302, 0xA1000510}}) {
    s.set_object(pdo.communication, 1, pdo.cob_id | 0x80000000, 4);
    s.set_object(pdo.communication, 2, 0xFE, 1);
    s.set_object(pdo.mapping, 0, 0, 1);
    s.set_object(pdo.mapping, 1, pdo.entry, 4);
    s.set_object(pdo.mapping, 0, 1, 1);
    s.set_object(pdo.communication, 1, pdo.cob_id, 4);
  }
  s.ignore_tx();
  // 6. SDOWrite: ReleaseAnalogInputdata.
  sdo_write(0x6423, 0, 1);
  s.write(1000, {0x0004, 2, 0x1000, 0}).y(0x17, true).advance(1ms);  // SDORead
  s.tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}).rx(0x582, read_ok);
  s.expect(1000, {0x0005, 2, 0x1000, 0, 4, 0x0191, 0x000F}).y(0x17, false);
  // 7. NMTRequestWrite, RequestData 5, to all.
  s.cif({0x0002, 0, 0x1F82, 0x80, 1, 5});
  s.expect(1000, 0x0003).tx(0x000, {0x01, 0x00}).rx(0x702, {0x05}).expect(601, 5).expect(602, 5).ignore_tx();
  // 8. PDOWrite and PDORead with Y01 and X01.
  s.write(13000, 0x1234).write(13004, 0x0056).rx(0x182, {0xAA, 0xBB}).rx(0x282, {0xCC, 0xDD});
  s.exchange();
  s.tx(0x202, {0x34, 0x12}).tx(0x302, {0x56, 0x00}).no_tx().expect(10000, 0xBBAA).expect(10004, 0xDDCC);
  // A lost heartbeat: X10, and ResetHeartbeatError by G400 and Y10. The mandatory slave is reset.
  s.wait_bit(402, 7, true).expect_x(0x10, true).ignore_tx();
  s.write(400, 2).y(0x10, true).expect_bit(402, 7, false).expect_x(0x10, false).y(0x10, false).ignore_tx();
}

TEST_P(StartUp, S07_Restart_TakesSixSeconds_SendsEmergencyAndBootUp) {
  spec("ME3-IO-004 ME3-IO-008 ME3-STAT-001", "RJ71-EMCY-005 RJ71-NMT-001");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.y(0x02, true);
  s.tx(0x0FF, {0x00, 0x62, 0x01, 0x4D, 0x45, 0x30, 0x30, 0x34}).no_tx();
  s.expect_bit(25, 7, true).expect_x(0x02, false);
  s.advance(5999ms);
  s.expect_bit(25, 7, true).expect_x(0x02, false).no_tx();
  s.advance(1ms);
  s.expect_bit(25, 7, false).expect_x(0x02, true);
  s.tx(0x77F, {0x00});
  s.y(0x02, false);
  s.expect_x(0x02, false);
  s.advance(30s);
  s.no_tx();
}

TEST_P(StartUp, S07_RestartRequestLeftOn_RestartsAgainAndAgain) {
  spec("ME3-IO-005", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.y(0x02, true);
  for (int round = 0; round < 3; ++round) {
    s.wait_x(0x02, true);
    s.expect_bit(25, 7, false);
    s.wait_x(0x02, false);
    s.expect_bit(25, 7, true);
  }
  s.y(0x02, false);
  s.wait_bit(25, 7, false);
  s.ignore_tx();
  s.advance(30s);
  s.no_tx();
  s.expect_bit(25, 7, false);
}

TEST_P(StartUp, S08_UnsavedSettings_AreLostAtTheRestart_SavedOnesComeIntoForce) {
  spec("ME3-IO-006 ME3-BAUD-003 ME3-BAUD-004", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(24, 125);
  s.set_object(0x1015, 0, 77, 2);
  s.restart();
  s.expect(24, 250).expect(37, 2500);
  s.expect_object(0x1015, 0, 0, 2);
  s.write(24, 125);
  s.save();
  s.expect(37, 2500);
  EXPECT_EQ(s.controller().rate, 250'000U);
  s.restart();
  s.expect(24, 125).expect(37, 1250);
  EXPECT_EQ(s.controller().rate, 125'000U);
  s.write(24, 1000);
  s.save();
  s.restart();
  s.expect(37, 10000);
}

TEST_P(StartUp, NewSettings_TakeEffectOnlyAfterARestart) {
  spec("ME3-IO-007", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.write(21, 11);
  s.save();
  s.advance(10s);
  s.expect(21, 11).expect_bit(25, 8, true).no_tx();
  s.rx(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.tx(0x581, {0x43, 0x00, 0x10, 0x00, 0x95, 0x01, 0, 0}).no_tx();
  s.write(21, 405);
  s.write(24, 500);
  s.write(27, 2);
  s.save();
  s.set_object(0x1F80, 0, 1, 4);
  s.store_objects();
  s.advance(10s);
  s.expect(37, 2500).expect(601, 0x7F).expect(602, 0).expect_bit(25, 15, false).no_tx();
  EXPECT_EQ(s.controller().rate, 250'000U);
  s.rx(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.tx(0x581, {0x43, 0x00, 0x10, 0x00, 0x95, 0x01, 0, 0}).no_tx();
  s.nmt(0x81, 1);  // Reset node is enough for 1F80H
  s.wait_bit(25, 7, false);
  s.expect_bit(25, 15, true).expect(37, 2500).expect(602, 0);
  s.ignore_tx();
  s.restart();
  s.expect(37, 5000).expect(602, 0x7F).expect_bit(25, 15, true);
  EXPECT_EQ(s.controller().rate, 500'000U);
  s.advance(10s);
  s.ignore_tx();
}

TEST_P(StartUp, UnsavedObjectDictionary_IsLostAtTheRestart) {
  IntelligentScenario s(GetParam());
  s.power_on();
  s.set_object(0x1017, 0, 1000, 2);
  s.restart();
  s.expect_object(0x1017, 0, 0, 2);
}

TEST(Me3StartUp, InvalidBaudRateAndModeAndNode_AreRefused_WithTheirAddress) {
  RecordProperty("spec", "ME3-BAUD-001 ME3-BAUD-002 ME3-MODE-002 ME3-NODE-001 ME3-SYS-011 ME3-ERR-005");
  IntelligentScenario s;
  s.power_on();
  s.expect(21, 405).expect(24, 250).expect(27, 127);
  for (const std::uint16_t rate : Words{10, 20, 50, 100, 125, 250, 500, 800, 1000}) {
    s.write(24, rate);
    s.expect(24, rate).expect(29, 0);
  }
  s.write(24, 300);
  s.expect(29, 0x0040).expect(39, 24).expect(24, 1000).expect_x(0x0F, true);
  s.write(29, 0);
  s.write(21, 100);
  s.expect(29, 0x0040).expect(39, 21).expect(21, 405).expect_x(0x0F, true);
  s.write(29, 0);
  s.write(27, 1);
  s.write(27, 127);
  s.expect(29, 0).expect(27, 127);
  s.write(27, 0);
  s.expect(29, 0x0040).expect(39, 27).expect(27, 127);
  s.write(29, 0);
  s.write(27, 128);
  s.expect(29, 0x0040).expect(39, 27).expect(27, 127);
}

TEST(Me3StartUp, ModeChange_TakesEffectAfterSaveAndRestart_AndDeletesTheObjectDictionarySettings) {
  RecordProperty("spec", "ME3-MODE-004 ME3-MODE-005 ME3-NODE-003");
  IntelligentScenario s;
  s.power_on();
  s.expect(21, 405);
  s.set_object(0x1017, 0, 1000, 2);
  s.store_objects();
  s.write(21, 11);
  s.restart();
  s.expect(21, 405).expect_bit(25, 8, true);  // not saved: still CANopen
  s.expect_object(0x1017, 0, 1000, 2);
  s.write(21, 11);
  s.save();
  s.y(0x02, true);
  s.ignore_tx();
  s.wait_x(0x02, true);
  s.y(0x02, false);
  s.expect(21, 11).expect(25, 0x0000);
  s.no_tx();  // no boot-up
  s.rx(0x67F, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.rx(0x000, {0x01, 0x00});
  s.rx(0x000, {0x82, 0x00});
  s.rx(0x085, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0});
  s.rx_remote(0x77F, 1);
  s.error_counters(130, 0);
  s.error_counters(0, 0);
  s.cpu(module::CpuState::stop);
  s.cpu(module::CpuState::run);
  s.advance(5s);
  s.no_tx();
  s.expect(25, 0x0000).expect_x(0x11, false);
  s.write(27, 5);
  s.expect(29, 0x0040).expect(39, 27);
  s.write(29, 0);
  s.y(0x02, true);  // no emergency message of the restart either
  s.no_tx();
  s.wait_x(0x02, true);
  s.y(0x02, false);
  s.no_tx();
  s.write(21, 29);
  s.expect(29, 0);
  s.write(21, 405);
  s.save();
  s.restart();
  s.expect(21, 405).expect_bit(25, 8, true);
  s.expect_object(0x1017, 0, 0, 2);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_start_up_test
