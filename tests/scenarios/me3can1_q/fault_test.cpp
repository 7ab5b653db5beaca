// What the supply, the CPU and the hardware do to an ME3CAN1-Q: faults, CPU errors, CPU reset, several CPUs;
// where a user looks for the cause (8.1).

#include <algorithm>

#include <gtest/gtest.h>

#include "canopus/module/me3can1_q/buffer_table.hpp"
#include "canopus/plc/melsec/session.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/sim/bus/bus.hpp"

#include "scenarios/me3can1_q/scenario.hpp"
#include "sim/bus_station.hpp"

namespace canopus::scenario {
namespace {

CANOPUS_OF_BOTH_MODULES(Fault);

using module::LedPattern;
using module::ModuleFault;

LedPattern led(IntelligentScenario& s, std::string_view name) {
  for (const module::Led& led : s.plug_in().leds(s.now())) {
    if (led.name == name) return led.pattern;
  }
  ADD_FAILURE() << "no LED " << name;
  return LedPattern::off;
}

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
  while (s.plug_in().flash_writes() < 10'000) s.store_objects();
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

// --- in a rack

struct RackBench {
  can::Timeline timeline;
  sim::Bus bus{"line", 250'000, timeline};
  sim::Station other{bus, timeline, "other"};  // acknowledges
  sim::Port& port = bus.add_port("module");
  RamMemory memory;
  module::me3can1_q::Me3can1Q module{port, memory};
  plc::Rack rack{timeline};

  RackBench() {
    const auto handle = timeline.add(module);
    port.connect(module, handle);
    EXPECT_TRUE(rack.insert(0x00, module, handle));
    rack.power_on(timeline.now());
    timeline.run_until(timeline.now() + 2s);
  }
  std::uint16_t g(module::BufferAddress address) { return module.read_word(address, timeline.now()); }
  void g(module::BufferAddress address, std::uint16_t value) {
    EXPECT_TRUE(rack.write_buffer(0, address, {&value, 1}, timeline.now()));
  }
  void y(std::uint32_t number, bool on) {
    const std::uint8_t bit = on ? 1 : 0;
    EXPECT_TRUE(rack.write_bits(plc::Device::y, number, {&bit, 1}, timeline.now()));
  }
  void run(can::Duration duration) { timeline.run_until(timeline.now() + duration); }
};

TEST(Me3Fault, CpuErrorInARack_StopsTheCpu_AndIsToldByTheModule) {
  RecordProperty("spec", "ME3-EMCY-007");
  RackBench plc;
  plc.rack.fail_cpu(plc.timeline.now());
  EXPECT_EQ(plc.rack.cpu_state(), module::CpuState::stop);
  const auto& objects = plc.module.node().dictionary();
  EXPECT_EQ(objects.get<std::uint32_t>(0x1003, 1) & 0xFFFF, 0xFF00U);
  EXPECT_EQ(objects.get<std::uint8_t>(0x1003, 0), 1);
}

// Words that a program can write get other values; G70 is saved. A CPU reset brings every word back to its
// default, or to what is saved.
TEST(Me3Fault, CpuReset_BringsEveryWordToItsDefault_OrItsSavedValue) {
  RecordProperty("spec", "ME3-SYS-018");
  RackBench plc;
  std::map<module::BufferAddress, std::uint16_t> before;
  for (const auto& row : module::me3can1_q::buffer_table) {
    if ((row.modes & module::me3can1_q::canopen_405) == 0) continue;
    for (auto address = row.first; address <= row.last; address += row.stride)
      before[address] = plc.g(address);
  }
  plc.g(70, 1234);
  plc.g(22, 1);
  plc.y(0x1F, true);
  plc.run(1s);
  plc.y(0x1F, false);
  for (const auto& [address, value] : before) {
    if (address == 22 || address == 29) continue;
    plc.g(address, address == 21 ? 29 : address == 24 ? 500 : address == 27 ? 5 : 60);
  }
  EXPECT_EQ(plc.g(13000), 60);
  EXPECT_EQ(plc.g(71), 60);
  plc.g(27, 200);  // G29.6, G39
  EXPECT_NE(plc.g(29), 0);
  plc.rack.reset_cpu(plc.timeline.now());
  plc.run(2s);
  before[70] = 1234;
  for (const auto& [address, value] : before) EXPECT_EQ(plc.g(address), value) << "G" << address;
}

// MC protocol requests name the CPU they are for: 03FFH and 03E0H are the control CPU, 03E1H to 03E3H CPUs 2
// to 4.
TEST(Me3Fault, OnlyTheControlCpu_WritesTheModule) {
  RecordProperty("spec", "ME3-SYS-008");
  RackBench plc;
  // 1401/0080: G70 = `value` of the module in slot 0, through the CPU with this module I/O number.
  const auto write_g70 = [&](std::uint16_t cpu, std::uint8_t value) {
    const Bytes request{0x50,
                        0x00,
                        0x00,
                        0xFF,
                        static_cast<std::uint8_t>(cpu & 0xFF),
                        static_cast<std::uint8_t>(cpu >> 8),
                        0x00,
                        0x15,
                        0x00,
                        0x10,
                        0x00,
                        0x01,
                        0x14,
                        0x80,
                        0x00,
                        0x00,
                        0x00,
                        0x46,
                        0x00,
                        0x00,
                        0xAB,
                        0x00,
                        0x00,
                        0x00,
                        0x00,
                        0xF8,
                        0x01,
                        0x00,
                        value,
                        0x00};
    plc::melsec::Session session(plc.rack);
    std::ranges::copy(request, session.space().begin());
    session.received(request.size());
    EXPECT_EQ(session.process(plc.timeline.now()), 1U);
    return session.output()[9] | session.output()[10] << 8;  // end code
  };
  EXPECT_EQ(write_g70(0x03FF, 11), 0);
  EXPECT_EQ(plc.g(70), 11);
  EXPECT_EQ(write_g70(0x03E0, 12), 0);
  EXPECT_EQ(plc.g(70), 12);
  for (const std::uint16_t other : Words{0x03E1, 0x03E2, 0x03E3}) {
    EXPECT_EQ(write_g70(other, 13), 0xC05F);
    EXPECT_EQ(plc.g(70), 12);
  }
}

// No way in or out while the rack has supply.
TEST(Me3Fault, NoModuleChange_WhileTheRackIsOn) {
  RecordProperty("spec", "ME3-SYS-007");
  RackBench plc;
  RamMemory memory;
  FreeBus controller;
  module::me3can1_q::Me3can1Q other(controller, memory);
  EXPECT_FALSE(plc.rack.insert(0x40, other, plc.timeline.add(other)));
  EXPECT_EQ(plc.rack.module_at(0x40), nullptr);
  plc.rack.power_off(plc.timeline.now());
  EXPECT_TRUE(plc.rack.insert(0x40, other, plc.timeline.add(other)));
}

// --- error counters on a real bus, and where they are shown

TEST_P(Fault, S81_CountersAndTheirIndications) {
  spec("ME3-CNT-003", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.error_counters(95, 0);
  s.expect(35, 95).expect_bit(25, 1, false);
  EXPECT_EQ(led(s, "CAN ERR"), LedPattern::off);
  for (const auto& [transmit, receive] : {std::pair{96, 0}, std::pair{0, 96}, std::pair{127, 127}}) {
    s.error_counters(static_cast<std::uint16_t>(transmit), static_cast<std::uint16_t>(receive));
    s.expect_bit(25, 1, true).expect_bit(29, 14, false);
    EXPECT_EQ(led(s, "CAN ERR"), LedPattern::single_flash);
  }
  s.no_tx();
  s.error_counters(128, 0);
  s.expect(35, 128).expect_bit(25, 1, false).expect(29, 0x4000).expect_x(0x0F, false);
  s.tx(0x0FF, {0x20, 0x81, 0x11, 0, 0, 0, 0, 0});
  s.error_counters(256, 0);
  s.expect(35, 256)
      .expect(36, 256)
      .expect_bit(29, 3, true)
      .expect_bit(29, 14, false)
      .expect_bit(25, 1, false);
  EXPECT_EQ(led(s, "CAN ERR"), LedPattern::on);
  s.cif({0x0004, 2, 0x1000, 0});
  s.expect(1000, {0x000F, 0xB0FF});
  s.ignore_tx();
  s.error_counters(127, 0);
  s.expect_bit(29, 14, false);
  s.ignore_tx();
}

// One receiver with a fault on its line: the module, among a sender and another receiver.
struct FaultyReceiver {
  RackBench plc;
  sim::Station sender{plc.bus, plc.timeline, "sender"};
  const can::Frame frame = can::data_frame(0x123, {0x55});

  // The module reads bit 22, a data bit, wrongly in the next `count` frames.
  void disturb(std::uint64_t count) {
    ASSERT_TRUE(plc.bus.set_faults({{{.kind = sim::FaultKind::corrupt,
                                      .sender = "sender",
                                      .count = count,
                                      .receiver = "module",
                                      .bit = 22}}},
                                   1));
  }
  void send() {
    sender.port.send(frame);
    plc.run(20ms);
  }
  // How often the other receiver has heard the frame.
  [[nodiscard]] std::size_t heard() const {
    return static_cast<std::size_t>(std::ranges::count(plc.other.frames(), frame));
  }
};

TEST_P(Fault, ReceiveErrorCounter_GoesUpByEight_DownByOne_AndShowsAtMost128) {
  spec("ME3-CNT-002", "");
  FaultyReceiver bench;
  EXPECT_EQ(bench.plc.g(36), 0);
  bench.disturb(1);
  bench.send();
  // 1 for the error it saw, 8 for the answer to its error flag; then the frame came again, and well.
  EXPECT_EQ(bench.plc.g(36), 8);
  for (std::uint16_t good = 1; good <= 8; ++good) {
    bench.send();
    EXPECT_EQ(bench.plc.g(36), 8 - good);
  }
  bench.send();
  EXPECT_EQ(bench.plc.g(36), 0);
  bench.disturb(14);
  bench.send();
  EXPECT_EQ(bench.plc.g(36), 14 * 9 - 1);
  EXPECT_EQ(bench.plc.g(25) & 2, 2);
  bench.disturb(100);
  for (int frame = 0; frame < 5; ++frame) bench.send();
  EXPECT_GT(bench.plc.port.receive_error_counter(), 128);
  EXPECT_EQ(bench.plc.g(36), 128);
  EXPECT_EQ(bench.plc.g(29), 0x4000);
}

// Every frame of the module is disturbed until it is bus-off. The disturbance ends and the bus is free, but
// only a restart brings the module back; the error counter and the bit go with it.
TEST(Me3Fault, BusOffOnTheBus_IsLeftByARestartAlone) {
  RecordProperty("spec", "ME3-ERR-002 ME3-CNT-001 ME3-EMCY-009");
  RackBench plc;
  const Words heartbeat{0x0002, 0, 0x1017, 0, 2, 100};  // 1017H = 100 ms, by the CIF
  EXPECT_TRUE(plc.rack.write_buffer(0, 1000, heartbeat, plc.timeline.now()));
  plc.y(0x17, true);
  plc.run(1s);
  EXPECT_EQ(plc.g(1000), 0x0003);
  const auto heard = [&] { return plc.other.frames().size(); };
  EXPECT_GT(heard(), 5U);
  ASSERT_TRUE(plc.bus.set_faults(
      {{{.kind = sim::FaultKind::corrupt, .sender = "module", .count = 32, .bit = 22}}}, 1));
  plc.run(3s);
  EXPECT_EQ(plc.g(29), 0x0008);
  EXPECT_EQ(plc.g(35), 256);
  EXPECT_EQ(plc.g(36), 256);
  const std::size_t before = heard();
  plc.run(10s);  // 128 times 11 bits are 6 ms
  EXPECT_EQ(heard(), before);
  EXPECT_EQ(plc.g(29) & 0x4008, 0x0008);  // its queue may be full by now: bit 8
  EXPECT_EQ(plc.g(35), 256);
  plc.y(0x0F, true);
  EXPECT_EQ(plc.g(29), 0x0008);
  plc.y(0x0F, false);
  plc.y(0x02, true);
  plc.run(6100ms);
  plc.y(0x02, false);
  EXPECT_EQ(plc.g(29), 0);
  EXPECT_EQ(plc.g(35), 0);
  EXPECT_EQ(heard(), before + 1);  // the boot-up message
}

TEST_P(Fault, ErrorActiveModule_DestroysAFaultyFrame_ErrorPassiveOneDoesNot) {
  spec("ME3-CNT-004", "");
  FaultyReceiver bench;
  bench.disturb(1);
  bench.sender.port.send(bench.frame);
  bench.plc.run(300us);  // 53 bits of 4 us: the frame would be over
  EXPECT_EQ(bench.heard(), 0U);
  EXPECT_EQ(bench.sender.port.transmit_error_counter(), 8);
  bench.plc.run(20ms);
  EXPECT_EQ(bench.heard(), 1U);  // sent again
  bench.disturb(100);
  bench.send();  // destroyed until the module is error passive
  EXPECT_EQ(bench.plc.g(29), 0x4000);
  EXPECT_EQ(bench.heard(), 2U);
  const std::uint16_t before = bench.sender.port.transmit_error_counter();
  bench.sender.port.send(bench.frame);
  bench.plc.run(300us);
  EXPECT_EQ(bench.heard(), 3U);  // at once, though the module read it wrongly
  EXPECT_EQ(bench.sender.port.transmit_error_counter(), before - 1);
}

// --- troubleshooting

TEST(Me3Fault, ErrorSearch_LedsThenG29ThenAddressesThenNodes) {
  RecordProperty("spec", "ME3-DIAG-001");
  IntelligentScenario s;
  s.power_on_as(1);
  EXPECT_EQ(led(s, "ERR."), LedPattern::off);
  s.write(27, 0);  // an invalid value
  EXPECT_EQ(led(s, "ERR."), LedPattern::on);
  EXPECT_EQ(led(s, "CAN ERR"), LedPattern::blinking);
  s.expect(29, 0x0040).expect(39, 27).expect(40, 0);
  s.write(29, 0);
  EXPECT_EQ(led(s, "ERR."), LedPattern::off);
  s.set_object(0x1016, 1, 0x00020064, 4);  // a node that falls silent
  s.rx(0x702, {0x05});
  s.advance(200ms);
  EXPECT_EQ(led(s, "CAN ERR"), LedPattern::double_flash);
  s.expect(29, 0).expect_bit(402, 7, true).expect_bit(403, 7, false).expect_x(0x10, true);
  s.ignore_tx();
  s.supply_off();  // a write during initialization
  s.supply_on();
  s.write(24, 500);
  EXPECT_EQ(led(s, "ERR."), LedPattern::on);
  s.expect(29, 0x0020).expect(39, 0).expect(40, 24);
  s.wait_bit(25, 7, false);
  s.ignore_tx();
}

// Every code of table 8-5 that a slave sends arrives in G1003/G1004, and so does one that is in no table.
TEST(Me3Fault, EverySdoAbortCode_IsShownUnchanged) {
  RecordProperty("spec", "ME3-DIAG-002");
  const std::vector<std::uint32_t> codes{
      0x05030000, 0x05040000, 0x05040001, 0x05040002, 0x05040003, 0x05040004, 0x05040005,
      0x06010000, 0x06010001, 0x06010002, 0x06020000, 0x06040041, 0x06040042, 0x06040043,
      0x06040047, 0x06060000, 0x06070010, 0x06070012, 0x06070013, 0x06090011, 0x06090030,
      0x06090031, 0x06090032, 0x06090036, 0x060A0023, 0x08000000, 0x08000020, 0x08000021,
      0x08000022, 0x08000023, 0x08000024, 0x12345678, 0xFFFFFFFF};
  IntelligentScenario s;
  s.power_on_as(1);
  for (const std::uint32_t code : codes) {
    s.write(1000, {0x0004, 2, 0x1000, 0});
    s.y(0x17, true);
    s.wait_tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
    s.rx(0x582, {0x80, 0x00, 0x10, 0x00, static_cast<std::uint8_t>(code & 0xFF),
                 static_cast<std::uint8_t>(code >> 8 & 0xFF), static_cast<std::uint8_t>(code >> 16 & 0xFF),
                 static_cast<std::uint8_t>(code >> 24)});
    s.wait_x(0x17, true);
    s.y(0x17, false);
    s.expect(1000, {0x000F, 0x0003, 2, static_cast<std::uint16_t>(code & 0xFFFF),
                    static_cast<std::uint16_t>(code >> 16)});
  }
  // The two codes of its own: an object too long for the command interface, and a node that cannot be.
  s.cif({0x0004, 200, 0x1000, 0});
  s.expect(1003, {0x0000, 0x5000});
  s.cif({0x0002, 0, 0x1F22, 2, 124, 1, 2, 3});
  s.expect(1000, 0x0003);
}

}  // namespace
}  // namespace canopus::scenario
