// spec/me3can1-q/scenarios.md, section 9: the module as NMT slave (S56, S63, S67, S68) and heartbeat
// producer.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_nmt_slave_test {
namespace {

CANOPUS_OF_BOTH_MODULES(NmtSlave);

const Bytes read_1000{0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0};
const Bytes is_0195{0x43, 0x00, 0x10, 0x00, 0x95, 0x01, 0x00, 0x00};

// --- S56

TEST_P(NmtSlave, S56_StartStopPreOperational_FromEveryState_ToThisNodeOrAll) {
  spec("ME3-NMT-004 ME3-NMT-005", "RJ71-NMT-008 RJ71-NMT-010");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.expect(25, 0x0100);
  for (const std::uint8_t node : Bytes{1, 0}) {
    s.nmt(0x01, node).expect(25, 0x0201);
    s.nmt(0x02, node).expect(25, 0x0000);
    s.nmt(0x80, node).expect(25, 0x0100);
    s.nmt(0x02, node).expect(25, 0x0000);
    s.nmt(0x01, node).expect(25, 0x0201);
    s.nmt(0x80, node).expect(25, 0x0100);
    s.no_tx();
  }
  s.nmt(0x01, 2).expect(25, 0x0100);  // somebody else
}

TEST_P(NmtSlave, Start_NotWhileTheCpuIsInStop_Unless1029hSaysSo) {
  spec("ME3-NMT-003", "RJ71-NMT-009");
  for (const std::uint8_t behaviour : Bytes{0, 1, 2}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.nmt(0x01, 1).expect(25, 0x0201);
    s.nmt(0x80, 1);
    s.nmt(0x01, 0).expect(25, 0x0201);
    s.nmt(0x80, 0);
    s.nmt(0x02, 1).nmt(0x01, 1).expect(25, 0x0201);
    s.nmt(0x80, 1);
    s.set_object(0x1029, 1, behaviour, 1);
    s.cpu(module::CpuState::stop).ignore_tx();
    const bool allowed = behaviour == 1;
    s.nmt(0x01, 1).expect_bit(25, 0, allowed);
    s.nmt(0x80, 1).nmt(0x01, 0).expect_bit(25, 0, allowed);
    s.nmt(0x02, 1).nmt(0x01, 1).expect_bit(25, 0, allowed);
    s.nmt(0x80, 1).cpu(module::CpuState::run).ignore_tx();
    s.nmt(0x01, 1).expect(25, 0x0201).no_tx();
  }
}

TEST(Me3NmtSlave, S56_Resets_BringTheStoredObjectsBack_AndEndWithTheBootUpFrame) {
  RecordProperty("spec", "ME3-NMT-006 ME3-NMT-007");
  for (const std::uint8_t command : Bytes{0x81, 0x82}) {
    for (const std::uint8_t node : Bytes{1, 0}) {
      IntelligentScenario s;
      s.power_on_as(1);
      s.set_object(0x1017, 0, 5000, 2);
      s.store_objects();
      s.set_object(0x1017, 0, 7000, 2);
      s.set_object(0xA580, 1, 0x1234, 2);  // of the application
      s.ignore_tx();
      s.nmt(0x01, 1).expect(25, 0x0201).write(25, 0xFFBF);
      s.nmt(command, node).expect_bit(25, 7, true).expect_bit(25, 6, false);
      s.wait_bit(25, 7, false).tx(0x701, {0x00}).no_tx();
      s.expect(25, 0x0140);
      s.expect_object(0x1017, 0, 5000, 2);
      s.expect_object(0xA580, 1, command == 0x81 ? 0 : 0x1234, 2);
      s.write(25, 0xFFBF).expect(25, 0x0100);  // writing 0 to bit 6 clears it
    }
  }
}

TEST(Me3NmtSlave, ServicesPerState) {
  RecordProperty("spec", "ME3-NMT-008");
  IntelligentScenario s;
  s.power_on_as(1);
  s.write(11000, 0);
  const auto exchange_sends_tpdo = [&](std::uint16_t value) {
    s.write(13000, value).y(0x01, true).advance(100ms).y(0x01, false);
  };
  const auto sdo_answers = [&] { s.rx(0x601, read_1000).tx(0x581, is_0195).no_tx(); };
  const auto emergency_is_heard = [&](bool heard) {
    s.y(0x11, true).advance(10ms).y(0x11, false).expect_x(0x11, false);
    s.rx(0x085, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0}).expect_x(0x11, heard);
  };
  const auto time_is_heard = [&](bool heard) {
    s.write(25, 0xEFFF).expect_bit(25, 12, false);
    s.rx(0x100, {0, 0, 0, 0, 0x10, 0x27}).expect_bit(25, 12, heard);
  };
  const auto sync_error_is_told = [&](bool told) {  // a SYNC with a byte is one too many
    s.rx(0x080, {0x01});
    if (told) s.tx(0x081, {0x00, 0x82, 0x11, 0, 0, 0, 0, 0});
    s.rx(0x080);
    if (told) s.tx(0x081, {0x00, 0x00, 0x00, 0, 0, 0, 0, 0});
    s.no_tx();
  };
  s.write(50, 1);  // consumes TIME
  // Pre-operational: SDO, SYNC, TIME, EMCY, NMT and error control, no PDO.
  sdo_answers();
  time_is_heard(true);
  sync_error_is_told(true);
  emergency_is_heard(true);
  exchange_sends_tpdo(0x1111);
  s.no_tx();
  s.rx_remote(0x701, 1).tx(0x701, {0x7F});
  // Operational: PDO as well.
  s.nmt(0x01, 1).ignore_tx();
  sdo_answers();
  time_is_heard(true);
  sync_error_is_told(true);
  emergency_is_heard(true);
  exchange_sends_tpdo(0x2222);
  s.tx(0x181, {0x22, 0x22, 0, 0, 0, 0, 0, 0}).no_tx();
  s.rx_remote(0x701, 1).tx(0x701, {0x85});
  // Stopped: NMT and error control only; nothing says that anything was refused.
  s.nmt(0x02, 1);
  s.rx(0x601, read_1000).advance(5s).no_tx();
  time_is_heard(false);
  sync_error_is_told(false);
  emergency_is_heard(false);
  exchange_sends_tpdo(0x3333);
  s.no_tx().expect(29, 0);
  s.rx_remote(0x701, 1).tx(0x701, {0x04});
  s.nmt(0x80, 1).rx_remote(0x701, 1).tx(0x701, {0xFF});
}

// --- S67

TEST_P(NmtSlave, S67_GuardingRequest_IsAnsweredWithToggleBitAndState) {
  spec("ME3-NG-002", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.rx_remote(0x701, 1).tx(0x701, {0x7F}).rx_remote(0x701, 1).tx(0x701, {0xFF});
  s.nmt(0x01, 1).rx_remote(0x701, 1).tx(0x701, {0x05}).rx_remote(0x701, 1).tx(0x701, {0x85});
  s.nmt(0x02, 1).rx_remote(0x701, 1).tx(0x701, {0x04}).rx_remote(0x701, 1).tx(0x701, {0x84});
  s.rx_remote(0x701, 1).tx(0x701, {0x04}).no_tx();
  s.nmt(0x82, 1).wait_bit(25, 7, false).tx(0x701, {0x00});
  s.rx_remote(0x701, 1).tx(0x701, {0x7F}).no_tx();  // begins with 0 again
}

TEST(Me3NmtSlave, S67_LifeGuarding_EventAfterGuardTimeTimesLifeTimeFactor) {
  RecordProperty("spec", "ME3-NG-003 ME3-NEC-009");
  IntelligentScenario s;
  s.power_on_as(1);
  s.set_object(0x100C, 0, 100, 2);
  s.set_object(0x100D, 0, 3, 1);
  s.advance(10s).no_tx().expect(401, 0);  // not before the first remote frame
  s.nmt(0x01, 1).rx_remote(0x701, 1).tx(0x701, {0x05});
  s.advance(299ms).no_tx().expect(401, 0).rx_remote(0x701, 1).tx(0x701, {0x85});
  s.advance(299ms).no_tx().expect(401, 0).expect(25, 0x0201);
  s.advance(1ms).expect(401, 0x0040).expect_x(0x10, true);
  s.tx(0x081, {0x01, 0x8F, 0x11, 0, 0, 0, 0, 0}).no_tx();
  s.expect(25, 0x0100);  // 1029H/01 = 0
  EXPECT_EQ(s.plug_in().leds(s.now())[4].pattern, module::LedPattern::double_flash);
}

TEST_P(NmtSlave, S67_LifeGuardingEvent_ChangesTheStateAs1029hSays) {
  spec("ME3-NG-003", "");
  for (const auto& [behaviour, status] :
       std::map<std::uint8_t, std::uint16_t>{{0, 0x0100}, {1, 0x0201}, {2, 0}}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(126);
    s.set_object(0x1029, 1, behaviour, 1);
    s.set_object(0x100C, 0, 50, 2);
    s.set_object(0x100D, 0, 2, 1);
    s.nmt(0x01).rx_remote(0x77E, 1).tx(0x77E, {0x05});
    s.advance(99ms).no_tx().expect(25, 0x0201).advance(1ms);
    s.expect(25, status)
        .expect(526, either(0x0040, 0x0044))
        .tx(0x0FE, {0x7E, 0x8F, 0x11, 0, 0, 0, 0, 0})
        .no_tx();
  }
}

TEST_P(NmtSlave, LifeGuarding_NeedsBothObjects_InAnyOrder) {
  spec("ME3-NG-001", "RJ71-NG-006");
  for (const int way : {0, 1, 2, 3, 4}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.expect_object(0x100C, 0, 0, 2);
    s.expect_object(0x100D, 0, 0, 1);
    if (way == 1 || way == 3) s.set_object(0x100C, 0, 200, 2);
    if (way == 2 || way == 3 || way == 4) s.set_object(0x100D, 0, 4, 1);
    if (way == 4) s.set_object(0x100C, 0, 200, 2);
    s.rx_remote(0x701, 1).ignore_tx();
    s.advance(799ms).no_tx().expect(401, way >= 3 ? either(0, 0x0005) : 0);
    s.advance(1ms).expect(401, way >= 3 ? either(0x0040, 0x0044) : 0).ignore_tx();
  }
}

// The end of the failure changes no word; what is cleared stays cleared; Y10 for all nodes holds it down.
TEST_P(NmtSlave, LifeGuarding_HeardAgain_AndY10) {
  spec("ME3-NEC-009 ME3-NG-003 ME3-IO-016 ME3-IO-018", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x100C, 0, 100, 2);
  s.set_object(0x100D, 0, 2, 1);
  s.rx_remote(0x701, 1).advance(200ms).ignore_tx().expect(401, either(0x0040, 0x0044)).expect_x(0x10, true);
  s.y(0x10, true).expect(401, 0).expect_x(0x10, false).y(0x10, false);
  s.rx_remote(0x701, 1).ignore_tx().expect(401, either(0, 0x0001)).expect_x(0x10, false);
  s.y(0x10, true).advance(200ms).ignore_tx().expect(401, 0).expect_x(0x10, false);
  s.y(0x10, false).expect(401, 0).expect_x(0x10, false);
  s.rx_remote(0x701, 1).advance(200ms).ignore_tx().expect(401, either(0x0040, 0x0044)).expect_x(0x10, true);
}

// What is not stored is lost by a reset: nobody is watched any more, and no failure is left.
TEST_P(NmtSlave, Resets_EndTheErrorControl) {
  spec("ME3-NMT-006 ME3-NMT-007 ME3-NEC-002", "");
  for (const std::uint8_t command : Bytes{0x81, 0x82}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.set_object(0x1016, 1, 0x00020064, 4);
    s.set_object(0x100C, 0, 100, 2);
    s.set_object(0x100D, 0, 1, 1);
    s.rx(0x702, {0x05}).rx_remote(0x701, 1).advance(200ms).ignore_tx();
    s.expect(401, either(0x0040, 0x0044))
        .expect(402, either(0x0082, 0x0080))
        .expect(602, 5)
        .expect_x(0x10, true);
    s.nmt(command, 1).wait_bit(25, 7, false).tx(0x701, {0x00}).no_tx();
    s.expect(401, {0, 0}).expect_x(0x10, false).expect(602, 0).expect(601, 0x7F);
    s.rx(0x702, {0x05}).expect(402, 0).expect(602, 0).advance(1s).no_tx();
  }
}

// --- S68

struct ErrorBehaviour {
  std::uint8_t value;
  std::uint16_t after_bus_off;  // G25 bits 0, 8, 9
  std::uint16_t after_cpu_stop;
};

TEST_P(NmtSlave, S68_CpuStopWhileOperational_ChangesTheStateAs1029hSays) {
  spec("ME3-EB-001 ME3-EB-002 ME3-EB-003 ME3-EB-006", "RJ71-ERRB-001 RJ71-ERRB-003 RJ71-ERRB-004");
  for (const ErrorBehaviour& row : {ErrorBehaviour{0, 0x0100, 0x0100}, ErrorBehaviour{1, 0x0201, 0x0100},
                                    ErrorBehaviour{2, 0x0000, 0x0000}}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.set_object(0x1029, 1, row.value, 1);
    s.nmt(0x01, 1).expect(25, 0x0201);
    s.cpu(module::CpuState::stop);
    EXPECT_EQ(s.read(25) & 0x0301, row.after_cpu_stop) << unsigned{row.value};
    s.nmt(0x01, 1).expect_bit(25, 0, row.value == 1);
    s.ignore_tx();
  }
}

// Counters that rise, up to error passive, are no communication error: nothing ends.
TEST_P(NmtSlave, CountersBelowBusOff_ChangeNoState_AndEndNoTransfer) {
  spec("ME3-EB-005 ME3-CIF-009 ME3-ERR-007", "RJ71-CIF-006");
  for (const std::uint8_t behaviour : Bytes{0, 1, 2}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.set_object(0x1029, 1, behaviour, 1);
    s.nmt(0x01, 1).write(1000, {0x0004, 2, 0x1000, 0}).y(0x17, true).advance(1ms);
    s.tx(0x602, read_1000).no_tx();
    for (const std::uint16_t counter : Words{1, 96, 127, 128, 255, 127, 0}) {
      s.error_counters(counter, 0).ignore_tx().expect_bit(25, 0, true).expect(1000, 0xFFFF);
      s.error_counters(0, counter).ignore_tx().expect_bit(25, 0, true).expect(1000, 0xFFFF);
    }
    s.rx(0x582, is_0195).expect(1000, {0x0005, 2, 0x1000, 0, 4, 0x0195, 0}).expect_x(0x17, true).no_tx();
    s.expect(25, 0x0201);
  }
}

TEST_P(NmtSlave, S68_BusOffWhileOperational_ChangesTheStateAs1029hSays) {
  spec("ME3-EB-001 ME3-EB-002 ME3-EB-003 ME3-EB-005", "RJ71-ERRB-001 RJ71-ERRB-003");
  for (const ErrorBehaviour& row : {ErrorBehaviour{0, 0x0100, 0x0100}, ErrorBehaviour{1, 0x0201, 0x0100},
                                    ErrorBehaviour{2, 0x0000, 0x0000}}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.set_object(0x1029, 1, row.value, 1);
    s.nmt(0x01, 1).error_counters(256, 0);
    EXPECT_EQ(s.read(25) & 0x0301, row.after_bus_off) << unsigned{row.value};
    s.ignore_tx();
  }
}

// --- heartbeat

TEST_P(NmtSlave, HeartbeatProducer_BootUpFirst_ThenTheStateEveryPeriod) {
  spec("ME3-HB-001", "RJ71-HB-001");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.expect_object(0x1017, 0, 0, 2);
  s.advance(70s).no_tx();
  s.set_object(0x1017, 0, 250, 2);
  s.ignore_tx();
  s.wait_tx(0x701, {0x7F});
  s.advance(249ms).no_tx().advance(1ms).tx(0x701, {0x7F});
  s.nmt(0x01, 1).advance(250ms).tx(0x701, {0x05});
  s.nmt(0x02, 1).advance(250ms).tx(0x701, {0x04});
  s.nmt(0x80, 1).advance(250ms).tx(0x701, {0x7F});
  s.set_object(0x1017, 0, 0, 2);
  s.ignore_tx().advance(70s).no_tx();
  s.set_object(0x1017, 0, 60000, 2);
  s.store_objects();
  s.ignore_tx().supply_off().supply_on();
  s.wait_tx(0x701, {0x00}).advance(59999ms).no_tx().advance(1ms).tx(0x701, {0x7F}).no_tx();
}

TEST_P(NmtSlave, HeartbeatConsumerEntries_NodeIdInBits16To23_TimeBelow_UnusedOnesWatchNobody) {
  spec("ME3-HB-002", "RJ71-HB-002");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.expect_object(0x1016, 0, 127, 1);
  for (const std::uint16_t sub : Words{1, 2, 64, 127})
    s.expect_object(0x1016, static_cast<std::uint8_t>(sub), 0, 4);
  s.set_object(0x1016, 1, 0x00050000, 4);    // time 0
  s.set_object(0x1016, 2, 0x000003E8, 4);    // node 0
  s.set_object(0x1016, 3, 0x008003E8, 4);    // node 128
  s.set_object(0x1016, 127, 0x007E03E8, 4);  // node 126, 1000 ms
  s.rx(0x705, {0x05}).expect(605, 0).expect(405, 0);
  s.rx(0x780, {0x05}).advance(60s).no_tx();
  s.rx(0x77E, {0x05}).expect(726, 5).expect(526, 0x0002);
  s.advance(999ms).expect(526, 0x0002).advance(1ms).expect(526, either(0x0082, 0x0080));
  s.advance(60s).expect(405, 0);
  s.ignore_tx();
}

TEST_P(NmtSlave, HeartbeatProducing_SwitchesGuardingOff) {
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1017, 0, 1000, 2);
  s.ignore_tx().rx_remote(0x701, 1).no_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_nmt_slave_test
