// The FROM/TO watchdog [FX2N-32CAN 4.2.5, 4.2.7, 6.4.7].

#include "scenarios/fx2n_32can/scenario.hpp"

namespace canopus::scenario::fx2n_32can_watchdog_test {
namespace {

const Bytes expired{0x00, 0x62, 0x01, '3', '0', '0', 'X', 'F'};

// S-10
TEST(Fx2nWatchdog, Expires200msAfterTheLastAccess_WithOneEmergencyMessage) {
  RecordProperty("spec", "FX2N-WDT-001 FX2N-WDT-002 FX2N-WDT-003 FX2N-WDT-004 FX2N-ERR-005");
  Fx2nScenario s;
  s.power_on().nmt(1).write(26, 20);
  s.advance(190ms).expect(29, 0).no_tx().advance(199ms).no_tx();
  s.advance(1ms).tx(0x0FF, expired).advance(10s).no_tx().expect(29, 0x0080).expect(25, 0x0201);
}

// S-11
TEST(Fx2nWatchdog, OutsideOfOperational_ItSendsNothing) {
  RecordProperty("spec", "FX2N-WDT-003 FX2N-WDT-004");
  for (const std::uint8_t command : Bytes{0x80, 0x02}) {
    Fx2nScenario s;
    s.power_on().nmt(command).write(26, 20).advance(210ms).expect(29, 0x0080).no_tx();
  }
  // It runs from the start of the module on.
  Fx2nScenario s;
  s.power_on().advance(200ms).expect(29, 0x0080).no_tx();
}

// S-12
TEST(Fx2nWatchdog, AnyWord_KeepsItFromExpiring) {
  RecordProperty("spec", "FX2N-WDT-002");
  Fx2nScenario s;
  s.power_on().nmt(1);
  for (const module::BufferAddress word : {0U, 19U, 20U, 30U, 31U, 50U, 199U, 999U, 1066U, 32767U}) {
    (void)s.advance(199ms).read(word);
    s.advance(199ms).write(word, 0);
  }
  s.expect(29, 0).ignore_tx();
  // Somebody who looks on is no program.
  for (int i = 0; i < 3; ++i) {
    s.advance(100ms);
    (void)s.plug_in().peek(30, s.now());
  }
  s.expect(29, 0x0080).ignore_tx();
}

// S-13
TEST(Fx2nWatchdog, WritingItsTime_EndsTheError) {
  RecordProperty("spec", "FX2N-WDT-005 FX2N-ERR-005 FX2N-WDT-006 FX2N-WDT-007");
  Fx2nScenario s;
  s.power_on().nmt(1).advance(300ms).ignore_tx();
  for (int i = 0; i < 10; ++i) s.advance(50ms).expect(29, 0x0080);
  s.write(29, 0).expect(29, 0x0080).write(26, 20).expect(29, 0).expect(26, 20);
  s.advance(199ms).no_tx().advance(1ms).tx(0x0FF, expired).expect(29, 0x0080);
  s.write(26, 0).expect(29, 0).expect(26, 0).advance(10s).expect(29, 0).no_tx();
  s.write(26, 1).advance(10ms).tx(0x0FF, expired);
  s.write(26, 65535).advance(655'349ms).no_tx().advance(1ms).tx(0x0FF, expired);
}

// S-14
TEST(Fx2nWatchdog, Zero_SwitchesItOff) {
  RecordProperty("spec", "FX2N-WDT-006");
  Fx2nScenario s;
  s.power_on().nmt(1).write(26, 0).advance(5s).expect(29, 0).no_tx();
  s.restart().nmt(1).advance(5s).expect(29, 0).no_tx();
}

// S-15
TEST(Fx2nWatchdog, CommandsWait_UntilTheErrorIsReset) {
  RecordProperty("spec", "FX2N-WDT-009");
  Fx2nScenario s;
  s.power_on().advance(300ms).expect(29, 0x0080);
  s.cif({0x0004, 0, 0x1000, 0}).expect(1000, 0xFFFF).advance(10s).expect(1000, 0xFFFF);
  s.write(29, 0).expect(1000, 0xFFFF);
  s.write(26, 20).expect(1000, {0x0005, 0, 0x1000, 0, 4, 405, 0}).no_tx();
  // One that runs already goes on.
  s.write(26, 0);
  s.cif({0x0004, 9, 0x1000, 0}).write(26, 1).advance(20ms).expect(29, 0x0080);
  s.says(9, 0x1000, 0, 0x191).expect(1000, {0x0005, 9, 0x1000, 0, 4, 0x191, 0});
}

}  // namespace
}  // namespace canopus::scenario::fx2n_32can_watchdog_test
