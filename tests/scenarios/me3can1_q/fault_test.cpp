// What the supply, the CPU and the hardware do to a module: faults, what was under way at a restart.

#include <algorithm>

#include <gtest/gtest.h>

#include "scenarios/me3can1_q/rack_bench.hpp"

namespace canopus::scenario::me3can1_q_fault_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Fault);

using module::LedPattern;
using module::ModuleFault;

TEST(Me3Fault, HardwareError_IsShown_AndOnlyTheSupplyClearsIt) {
  RecordProperty("spec", "ME3-ERR-001 ME3-IO-001");
  IntelligentScenario s;
  s.power_on();
  s.expect_x(0x00, true).expect_bit(29, 1, false);
  s.plug_in().inject(ModuleFault::hardware_error, s.now());
  s.expect(29, 0x0002).expect_x(0x0F, true).expect_x(0x00, false);
  EXPECT_EQ(led(s, "ERR."), LedPattern::on);
  EXPECT_EQ(led(s, "CAN ERR"), LedPattern::blinking);
  s.y(0x0F, true);
  s.y(0x0F, false);
  s.write(29, 0);
  s.expect(29, 0x0002).expect_x(0x0F, true);
  s.y(0x02, true);  // a restart does not help either
  s.ignore_tx();
  s.wait_x(0x02, true);
  s.y(0x02, false);
  s.expect(29, 0x0002).expect_x(0x00, false).expect_x(0x0F, true);
  s.ignore_tx();
  s.supply_off();
  s.power_on();
  s.expect(29, 0).expect_x(0x00, true).expect_x(0x0F, false);
}

TEST_P(Fault, WatchdogError_StopsTheModule) {
  spec("ME3-IO-001 ME3-LED-001", "RJ71-IO-001");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.set_object(0x1017, 0, 100, 2);
  s.wait_tx(0x77F, {0x7F});
  EXPECT_EQ(led(s, "RUN"), LedPattern::on);
  s.plug_in().inject(ModuleFault::watchdog_error, s.now());
  s.ignore_tx();
  s.expect_x(0x00, false);
  EXPECT_EQ(led(s, "RUN"), LedPattern::off);
  s.advance(10s);
  s.no_tx();
  s.supply_off();
  s.power_on();
  s.expect_x(0x00, true).expect(29, 0);
  EXPECT_EQ(led(s, "RUN"), LedPattern::on);
}

TEST_P(Fault, Ready_DoesNotFollowNmtState_BusOff_OrTheMode) {
  spec("ME3-IO-001", "RJ71-IO-001");
  IntelligentScenario s(GetParam());
  s.supply_on();
  s.expect_x(0x00, false);
  s.wait_bit(25, 7, false);
  s.ignore_tx();
  s.expect_x(0x00, true);
  for (const std::uint8_t command : Bytes{0x01, 0x02, 0x80}) {
    s.nmt(command);
    s.expect_x(0x00, true);
  }
  s.error_counters(256, 0);
  s.expect_x(0x00, true).expect_bit(29, 3, true);
  s.ignore_tx();
  s.write(21, 11);
  s.save();
  s.restart();
  s.expect_x(0x00, true).expect_x(0x03, false);
}

TEST(Me3Fault, CpuError_IsTold_InsteadOfRunToStop) {
  RecordProperty("spec", "ME3-EMCY-007");
  IntelligentScenario s;
  s.power_on();
  s.nmt(0x01);
  s.ignore_tx();
  s.plug_in().cpu_failed(s.now());
  s.cpu(module::CpuState::stop);
  s.tx(0x0FF, {0x00, 0xFF, 0x81, 0x4D, 0x45, 0x30, 0x30, 0x31}).no_tx();
  s.expect_bit(25, 0, false);  // as any RUN to STOP [4.7]
  s.cpu(module::CpuState::run);
  s.cpu(module::CpuState::stop);
  s.tx(0x0FF, {0x00, 0xFF, 0x81, 0x4D, 0x45, 0x30, 0x30, 0x32}).no_tx();
  s.plug_in().cpu_failed(s.now());  // in STOP
  s.advance(0ms);
  s.tx(0x0FF, {0x00, 0xFF, 0x81, 0x4D, 0x45, 0x30, 0x30, 0x31}).no_tx();
  s.cpu(module::CpuState::run);
  s.no_tx();
}

// --- what was under way

struct Told final : module::ModuleObserver {
  void error_raised(std::string_view what, can::Time) override { lines.emplace_back(what); }
  std::vector<std::string> lines;
};

TEST_P(Fault, BusOff_IsToldOnce) {
  Told told;
  IntelligentScenario s(GetParam());
  s.plug_in().set_observer(&told);
  s.power_on();
  for (int i = 0; i < 3; ++i) s.error_counters(256, 0);
  EXPECT_EQ(told.lines, std::vector<std::string>{"the CAN controller is bus-off"});
  s.plug_in().set_observer(nullptr);
}

// Off is off: no signal does anything, and a restart that was to come again does not come.
TEST_P(Fault, SupplyOff_NothingAnswers) {
  spec("ME3-IO-005 ME3-IO-001", "RJ71-IO-001");
  for (const std::uint16_t mode : Words{405, 11}) {
    IntelligentScenario s(GetParam());
    if (mode == 405) {
      s.power_on();
    } else {
      s.power_on_layer2(mode);
    }
    s.y(0x02, true).wait_x(0x02, true).ignore_tx();  // left ON: again in 0.5 s
    s.supply_off();
    for (unsigned number = 0; number < 32; ++number) s.y(number, true);
    s.advance(20s).no_tx();
    EXPECT_EQ(s.inputs(), 0U);
    s.expect(25, 0).expect(21, 0);
    s.supply_on();  // all Y are OFF again
    s.advance(20s).ignore_tx();
    EXPECT_EQ(s.inputs(), 1U);
    s.expect(25, mode == 405 ? 0x0100 : 0).expect(29, 0);
  }
}

TEST_P(Fault, SupplyOff_EndsEverything_AlsoCyclicMessages) {
  spec("ME3-L2-009", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x5FFF, 2, 1}).write(10000, {0x0123, 0, 1, 0x0055});
  s.online();
  s.advance(10ms).tx(0x123, {0x55});
  s.write(8400, 1).y(0x04, true).tx(0x123, {0x55}).y(0x01, true).supply_off();
  EXPECT_EQ(s.inputs(), 0U);
  EXPECT_EQ(s.plug_in().layer2_state(), module::Layer2State::offline);
  s.advance(60s).no_tx();
  EXPECT_EQ(s.inputs(), 0U);
  EXPECT_EQ(s.plug_in().deadline(), can::never);
  s.rx(0x123, {1}).cpu(module::CpuState::stop).cpu(module::CpuState::run).no_tx();
}

// Requests that were not completed when the restart came are not completed after it; a save is done before.
TEST_P(Fault, Restart_DropsWhatWasUnderWay) {
  spec("ME3-IO-004", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.nmt(0x82, 1);  // a reset by NMT, not finished
  s.advance(5ms).y(0x02, true).ignore_tx();
  s.advance(5999ms).expect_bit(25, 7, true).expect_bit(25, 6, false).no_tx();
  s.wait_x(0x02, true).tx(0x701, {0x00}).expect_bit(25, 6, false).y(0x02, false);
  s.advance(1s).expect_bit(25, 6, false);
  // Save, data exchange and command.
  s.write(70, 1234).write(22, 1).write(1000, {0x0004, 2, 0x1000, 0});
  s.y(0x1F, true).y(0x01, true).y(0x17, true).y(0x02, true).ignore_tx();
  s.advance(5999ms).no_tx();
  EXPECT_EQ(s.inputs(), 1U);  // ready
  s.wait_x(0x02, true).advance(400ms);
  EXPECT_EQ(s.inputs() & ~0x8000U, 1U | 1U << 2);
  s.expect(22, 0).expect(70, 1234).expect(1000, 0).expect(29, 0);
  s.y(0x02, false).y(0x1F, false).y(0x01, false).y(0x17, false).advance(1s).ignore_tx();
  // A second restart within the first one's repetition time.
  s.y(0x02, true).wait_x(0x02, true).y(0x02, false).ignore_tx().advance(400ms);
  s.y(0x02, true).ignore_tx().advance(5999ms).expect_bit(25, 7, true).no_tx();
  s.advance(1ms).expect_bit(25, 7, false).y(0x02, false).ignore_tx().advance(10s).no_tx();
}

// As an SDO was under way, with every signal ON, and with data that no data exchange has brought to the
// words.
TEST(Me3Fault, Restart_BringsSignalsStatusAndData_ToTheirDefaults) {
  RecordProperty("spec", "ME3-IO-004 ME3-STAT-001 ME3-SYS-018 ME3-SAVE-007");
  for (const bool by_supply : {false, true}) {
    IntelligentScenario s;
    s.power_on_as(1);
    s.nmt(0x82, 1).wait_bit(25, 7, false).ignore_tx();
    s.nmt(0x01, 1);
    s.rx(0x100, {0, 0, 0, 0, 0xA2, 0x2B}).expect(25, 0x1241);
    s.rx(0x201, {0x34, 0x12, 0, 0, 0, 0, 0, 0});
    s.set_object(0x1016, 1, 0x00020064, 4);
    s.rx(0x702, {0x05}).advance(200ms).expect(402, 0x0082);
    s.rx(0x085, {0x30, 0x81, 0x11, 1, 2, 3, 4, 5});
    s.write(24, 300).write(50, 2);
    s.y(0x12, true).y(0x13, true).ignore_tx();
    s.write(1000, {0x0004, 3, 0x1000, 0}).y(0x17, true).advance(1ms);
    s.tx(0x603, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}).expect(1000, 0xFFFF);
    EXPECT_EQ(s.inputs(), 1U | 0x8000U | 0xFU << 16);  // X00 X0F X10 X11 X12 X13
    if (by_supply) {
      s.supply_off().ignore_tx();
      s.advance(10s).no_tx();  // off is off
      EXPECT_EQ(s.inputs(), 0U);
      s.supply_on();
    } else {
      s.y(0x02, true).ignore_tx();
    }
    EXPECT_EQ(s.inputs(), by_supply ? 0U : 1U);
    s.expect(25, 0x0080).expect(29, 0).expect(39, {0, 0}).expect(402, 0).expect(602, 0).expect(1000, 0);
    s.advance(by_supply ? 999ms : 5999ms).no_tx();
    s.rx(0x583, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00}).advance(1ms);
    s.tx(0x701, {0x00}).no_tx();
    s.expect(25, 0x0100).expect(29, 0).expect(402, 0).expect(602, 0).expect(1000, {0, 0, 0, 0});
    EXPECT_EQ(s.inputs(), by_supply ? 1U : 5U);
    s.y(0x02, false);
    s.nmt(0x01, 1).y(0x01, true).wait_x(0x01, true).y(0x01, false);
    s.expect(750, {0, 0}).expect(10000, {0, 0}).no_tx();
    s.advance(10s).no_tx();
  }
}

// What a master does on the bus, and what waits to be sent, ends with the restart, and with the supply.
TEST_P(Fault, Restart_AndSupplyOff_EndTheMastersFrames) {
  spec("ME3-IO-004 ME3-EMCY-011", "");
  for (const bool by_supply : {false, true}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.set_object(0x1F80, 0, 1, 4);
    s.set_object(0x1F81, 2, 0x05, 4);
    s.set_object(0x1F81, 3, 0x00640301, 4);
    s.set_object(0x1015, 0, 60000, 2);  // 6 s
    s.store_objects();
    s.restart();
    s.rx(0x703, {0x00}).rx(0x703, {0x7F}).advance(1s).ignore_tx();  // it has told that node 3 is lost
    s.error_counters(130, 0).error_counters(0, 0).ignore_tx();      // an emergency that has to wait
    if (by_supply) {
      s.supply_off().ignore_tx().advance(60s).no_tx();
      s.supply_on();
    } else {
      s.y(0x02, true).ignore_tx();
      s.advance(5999ms).no_tx();
    }
    s.wait_tx(0x701, {0x00}).y(0x02, false).tx(0x000, {0x82, 0x00}).advance(20s);
    for (const can::Frame& frame : s.controller().sent)
      EXPECT_FALSE(frame.identifier == 0x081 && frame.data[0] == 0x20) << text(frame);  // 8120H
    s.ignore_tx();
  }
}

// An initialization, or a save, that the supply cuts short does not end without it.
TEST_P(Fault, SupplyOff_InTheMiddle_NothingIsFinished) {
  spec("ME3-STAT-001 ME3-SAVE-009", "RJ71-NMT-001");
  IntelligentScenario s(GetParam());
  s.supply_on().advance(500ms).supply_off();
  s.advance(60s).no_tx().expect(25, 0);
  EXPECT_EQ(s.inputs(), 0U);
  s.power_on();
  s.write(70, 1000).write(22, 1).y(0x01, true).y(0x1F, true).supply_off();
  s.advance(60s).no_tx();
  EXPECT_EQ(s.inputs(), 0U);
  s.power_on();
  s.expect(70, 500).expect(29, 0x0010).no_tx();
}

// A restart that the supply cut short is over: the next Y02 is a request of its own.
TEST_P(Fault, RestartCutByTheSupply_IsNotReportedAfterwards) {
  spec("ME3-IO-004", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.y(0x02, true).advance(3s).ignore_tx();
  s.supply_off().supply_on();
  s.y(0x02, true).advance(1s).ignore_tx();  // while it initializes
  s.expect_x(0x02, false).expect_bit(25, 7, true);
  s.advance(5999ms).expect_x(0x02, false).expect_bit(25, 7, true).no_tx();
  s.advance(1ms).expect_x(0x02, true).expect(25, 0x0100).tx(0x701, {0x00}).y(0x02, false).no_tx();
}

TEST(Me3Fault, WornFlash_IsToldOnce_WithTheFirstWriteTooMany) {
  RecordProperty("spec", "ME3-SYS-014");
  IntelligentScenario s;
  Told told;
  s.power_on();
  s.plug_in().set_observer(&told);
  s.store_objects();
  while (s.plug_in().flash_writes() < 10'000) s.save(1);  // of a few words, which is quicker
  EXPECT_EQ(told.lines, std::vector<std::string>{});
  s.store_objects();
  EXPECT_EQ(s.plug_in().flash_writes(), 10'001U);
  ASSERT_EQ(told.lines.size(), 1U);
  EXPECT_NE(told.lines[0].find("10000 times"), std::string::npos) << told.lines[0];
  s.store_objects();
  s.restart();
  s.supply_off();
  s.power_on();
  s.store_objects();
  EXPECT_EQ(told.lines.size(), 1U);  // no error of the module, and told once
  s.expect(29, 0);
  // Nor by the next run of the program.
  FreeBus other_bus;
  module::me3can1_q::Me3can1Q next_run(other_bus, s.flash());
  next_run.set_observer(&told);
  next_run.power_on({});
  next_run.tick(can::Time{} + 1s);
  EXPECT_EQ(next_run.flash_writes(), s.plug_in().flash_writes());
  EXPECT_EQ(told.lines.size(), 1U);
  s.plug_in().set_observer(nullptr);
}

// The emergency of a restart is one like any other: within the inhibit time 1015H it is not sent, and the
// restart does not wait for it.
TEST_P(Fault, RestartWithinTheInhibitTime_SendsNoEmergency_AndDoesNotWait) {
  spec("ME3-IO-008 ME3-EMCY-004", "RJ71-EMCY-005 RJ71-EMCY-014");
  for (const bool within : {true, false}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(1);
    s.set_object(0x1015, 0, 10000, 2);  // 1 s
    s.cif({0x000A, 0x1000, 1, 0, 0});
    s.tx(0x081, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0});
    s.advance(within ? 990ms : 1000ms);
    s.y(0x02, true).expect_bit(25, 7, true);
    if (!within) s.tx(0x081, {0x00, 0x62, 0x01, 0x4D, 0x45, 0x30, 0x30, 0x34});
    s.advance(5999ms).no_tx().expect_bit(25, 7, true);
    s.advance(1ms).tx(0x701, {0x00}).no_tx().expect_x(0x02, true).y(0x02, false);
  }
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_fault_test
