// FROM/TO watchdog, RUN and STOP of the CPU, error behaviour, LEDs [FX3U-CAN 1.2.2, 5.7, 6.9, 11, 14].

#include "scenarios/fx3u_can/scenario.hpp"

namespace canopus::scenario::fx3u_can_watchdog_and_cpu_test {
namespace {

using module::LedPattern;

LedPattern led(BlockScenario& s, std::string_view name) {
  for (const module::Led& led : s.plug_in().leds(s.now()))
    if (led.name == name) return led.pattern;
  ADD_FAILURE() << name;
  return LedPattern::off;
}

const Bytes cpu_error{0x00, 0xFF, 0x81, '1', '0', '0', 'X', 'F'};
const Bytes cpu_stopped{0x00, 0xFF, 0x81, '2', '0', '0', 'X', 'F'};
const Bytes watchdog{0x00, 0x62, 0x01, '3', '0', '0', 'X', 'F'};

// S012
TEST(FxWatchdog, ExpiresWithoutAccess_AndItsWordStartsItAnew) {
  RecordProperty(
      "spec", "FX3U-WDT-002 FX3U-WDT-003 FX3U-WDT-005 FX3U-WDT-006 FX3U-EMCY-012 FX3U-EB-004 FX3U-ERR-003");
  BlockScenario s;
  s.power_on_operational().advance(10s).expect(29, 0);  // not before the first access
  s.write(0, 1).advance(199ms).expect(29, 0).advance(1ms).expect(29, 1U << 7 | 1U);
  s.tx(0x0FF, watchdog).no_tx().expect(25, 0x0100);
  EXPECT_EQ(led(s, "ERROR"), LedPattern::on);
  s.nmt(1).expect(25, 0x0100).write(29, 0).expect(29, 1U << 7 | 1U).write(0, 2).expect_bit(29, 7, true);
  s.write(26, 20).expect(29, 0).nmt(1).expect_bit(25, 0, true).ignore_tx();
  s.advance(200ms).expect_bit(29, 7, true).ignore_tx();  // it was started anew
}

TEST(FxWatchdog, EveryAccessToADataWord_FromOrTo_StartsItAnew) {
  RecordProperty("spec", "FX3U-WDT-002 FX3U-WDT-004");
  for (const module::BufferAddress address : {0U, 19U, 100U, 399U, 10000U, 10319U, 11000U, 11319U}) {
    BlockScenario s;
    s.power_on_operational().write(26, 5);
    for (int i = 0; i < 10; ++i) s.write(address, 1).advance(49ms);
    for (int i = 0; i < 10; ++i) {
      (void)s.read(address);
      s.advance(49ms);
    }
    s.expect(29, 0).advance(1ms).expect_bit(29, 7, true).ignore_tx();
  }
  for (const module::BufferAddress address : {20U, 25U, 29U, 70U, 601U, 1001U}) {
    BlockScenario s;
    s.power_on_operational()
        .write(address, s.read(address))
        .advance(10s)
        .expect_bit(29, 7, false)
        .ignore_tx();
  }
  BlockScenario looked_at;
  looked_at.power_on_operational();
  EXPECT_EQ(looked_at.plug_in().peek(10000, looked_at.now()), 0);
  looked_at.advance(10s).expect_bit(29, 7, false);
  BlockScenario s;
  s.power_on_operational().write(26, 0).write(0, 1).advance(1h).expect(29, 0).ignore_tx();
  s.write(26, 6553)
      .write(0, 1)
      .advance(65529ms)
      .expect(29, 0)
      .advance(1ms)
      .expect_bit(29, 7, true)
      .ignore_tx();
  s.write(26, 6554).expect_bit(29, 6, true).expect(39, 26).expect(26, 6553);
}

// S012.4
TEST(FxWatchdog, ErrorBehaviour1_LetsItBeOperationalAgain_And2StopsIt) {
  RecordProperty("spec", "FX3U-WDT-007 FX3U-WDT-006 FX3U-EB-002 FX3U-EB-003");
  BlockScenario s;
  s.power_on().set_object(0x1029, 1, 1, 1).nmt(1).write(0, 1).advance(200ms).ignore_tx().expect(25, 0x0100);
  s.nmt(1).expect(25, 0x0201).expect_bit(29, 7, true);
  BlockScenario stops;
  stops.power_on()
      .set_object(0x1029, 1, 2, 1)
      .nmt(1)
      .write(0, 1)
      .advance(200ms)
      .tx(0x0FF, watchdog)
      .expect(25, 0);
  stops.nmt(1).expect(25, 0).write(26, 0).nmt(1).expect(25, 0x0201).ignore_tx();
}

TEST(FxWatchdog, InLayer2_ItsExpirySendsTheStopMessages) {
  RecordProperty("spec", "FX3U-L2-021 FX3U-L2STOP-003");
  BlockScenario s;
  s.power_on_layer2().write(1900, {0x123, 0, 2, 0xBBAA}).write(100, 1).advance(10s).expect(29, 0);  // offline
  s.write(29, 0).online().ignore_tx().advance(10s).expect(29, 0).write(393, 1).advance(199ms).no_tx();
  s.advance(1ms).tx(0x123, {0xAA, 0xBB}).expect_bit(29, 7, true).no_tx();
}

TEST(FxCpu, StopOfASlave_ReportsAndLeavesOperational) {
  RecordProperty("spec", "FX3U-RS-001 FX3U-RS-002 FX3U-EMCY-011 FX3U-EB-001 FX3U-EB-004 FX3U-EMCY-001");
  for (const std::uint32_t behaviour : {0U, 1U, 2U}) {
    BlockScenario s;
    s.power_on().set_object(0x1029, 1, behaviour, 1).nmt(1).ignore_tx();
    s.cpu(module::CpuState::stop)
        .tx(0x0FF, cpu_stopped)
        .expect(25, behaviour == 2 ? 0 : 0x0100)
        .advance(10s)
        .no_tx();
    s.nmt(1).expect(25, behaviour == 0 ? 0x0100 : behaviour == 1 ? 0x0201 : 0).nmt(0x80).ignore_tx();
    s.cpu(module::CpuState::run).expect(25, 0x0100).no_tx().nmt(1).expect(25, 0x0201).ignore_tx();
  }
}

// S002
TEST(FxCpu, PowerOnInStop) {
  RecordProperty("spec", "FX3U-RS-007 FX3U-EMCY-011");
  BlockScenario s;
  s.cpu(module::CpuState::stop)
      .supply_on()
      .wait_bit(25, 7, false)
      .tx(0x77F, {0x00})
      .tx(0x0FF, cpu_stopped)
      .no_tx();
  s.nmt(1, 127).expect(25, 0x0100).cpu(module::CpuState::run).nmt(1, 127).expect(25, 0x0201);
}

TEST(FxCpu, AnErrorOfTheCpu_IsReported_AndLit) {
  RecordProperty("spec", "FX3U-EMCY-010 FX3U-LED-002");
  BlockScenario s;
  s.power_on_operational();
  s.plug_in().cpu_failed(s.now());
  s.cpu(module::CpuState::stop).tx(0x0FF, cpu_error).no_tx().expect(25, 0x0100);
  EXPECT_EQ(led(s, "ERROR"), LedPattern::on);
  s.cpu(module::CpuState::run);
  EXPECT_EQ(led(s, "ERROR"), LedPattern::off);
}

TEST(FxCpu, StopOfAMaster_EndsItsServices_UntilRun) {
  RecordProperty("spec", "FX3U-RS-003 FX3U-RS-004");
  BlockScenario s;
  s.power_on_as(1).set_object(0x1F80, 0, 1, 4).set_object(0x1017, 0, 100, 2).store_objects().restart();
  s.advance(2s).ignore_tx().expect_bit(25, 15, true).expect_bit(25, 0, true);
  s.cpu(module::CpuState::stop)
      .tx(0x081, cpu_stopped)
      .expect_bit(25, 15, false)
      .advance(2s)
      .no_tx()
      .expect(25, 0x0100);
  s.cpu(module::CpuState::run)
      .expect_bit(25, 15, true)
      .wait_tx(0x000, {0x82, 0x00})
      .advance(2s)
      .expect_bit(25, 0, true)
      .ignore_tx();
  s.expect(601, 5);
}

TEST(FxCpu, Layer2_SendsStopMessages_AndGoesOffline) {
  RecordProperty("spec",
                 "FX3U-RS-006 FX3U-L2-027 FX3U-L2-028 FX3U-L2STOP-001 FX3U-L2STOP-002 FX3U-L2STOP-008");
  BlockScenario s;
  s.power_on_layer2()
      .write(1900, {0x700, 0, 8, 0x0201, 0x0403, 0x0605, 0x0807})
      .write(1914, {0x001, 0, 0})
      .write(1921, {0x100, 0, 1, 0x00EE});
  s.cpu(module::CpuState::stop).no_tx().cpu(module::CpuState::run).online();
  s.cpu(module::CpuState::stop)
      .tx(0x700, {1, 2, 3, 4, 5, 6, 7, 8})
      .tx(0x001)
      .tx(0x100, {0xEE})
      .no_tx()
      .expect_bit(25, 0, false);
  s.cpu(module::CpuState::run).expect_bit(25, 0, false).write(25, 1U << 4).expect_bit(25, 0, true);
}

TEST(FxLeds, ShowTheNetworkState_TheTraffic_AndTheProgramsAccesses) {
  RecordProperty("spec", "FX3U-LED-001 FX3U-LED-003 FX3U-LED-004 FX3U-LED-005");
  BlockScenario s;
  EXPECT_EQ(led(s, "POWER"), LedPattern::off);
  s.power_on();
  EXPECT_EQ(led(s, "POWER"), LedPattern::on);
  EXPECT_EQ(led(s, "RUN"), LedPattern::blinking);
  EXPECT_EQ(led(s, "Tx/Rx"), LedPattern::on);
  EXPECT_EQ(led(s, "FROM/TO"), LedPattern::on);
  s.advance(100ms);
  EXPECT_EQ(led(s, "Tx/Rx"), LedPattern::off);
  EXPECT_EQ(led(s, "FROM/TO"), LedPattern::off);
  s.rx(0x7FF);
  EXPECT_EQ(led(s, "Tx/Rx"), LedPattern::on);
  (void)s.read(30);
  EXPECT_EQ(led(s, "FROM/TO"), LedPattern::on);
  s.nmt(1);
  EXPECT_EQ(led(s, "RUN"), LedPattern::on);
  s.nmt(2);
  EXPECT_EQ(led(s, "RUN"), LedPattern::single_flash);
  BlockScenario layer2;
  layer2.power_on_layer2();
  EXPECT_EQ(led(layer2, "RUN"), LedPattern::off);
  layer2.online();
  EXPECT_EQ(led(layer2, "RUN"), LedPattern::on);
}

TEST(FxLeds, TheErrorLed_ShowsTheWorst) {
  RecordProperty("spec", "FX3U-LED-002 FX3U-ERR-001 FX3U-ERR-007");
  BlockScenario s;
  s.power_on_operational();
  EXPECT_EQ(led(s, "ERROR"), LedPattern::off);
  s.write(21, 1);
  EXPECT_EQ(led(s, "ERROR"), LedPattern::blinking);
  s.error_counters(0, 128).expect(29, 0x4041).ignore_tx();
  EXPECT_EQ(led(s, "ERROR"), LedPattern::single_flash);
  s.write(29, 0).expect(29, 0x4000);
  s.set_object(0x1016, 1, 0x0005'0064, 4).rx(0x705, {5}).advance(100ms).expect(29, 0x4401).ignore_tx();
  EXPECT_EQ(led(s, "ERROR"), LedPattern::double_flash);
  s.error_counters(256, 0);
  EXPECT_EQ(led(s, "ERROR"), LedPattern::on);
}

// EMCY belongs to Pre-operational and Operational, which the boot-up message begins [FX3U-CAN 5.8.1, 6.23].
TEST(FxCpu, MessageOfStop_WaitsForTheBootUpMessage) {
  RecordProperty("spec", "FX3U-EMCY-015 FX3U-EMCY-011");
  const can::Frame boot_up = can::data_frame(0x77F, Bytes{0x00});
  for (const std::uint8_t behaviour : Bytes{0, 1, 2}) {
    for (const Bytes& reset : {Bytes{}, Bytes{0x82, 0x7F}, Bytes{0x81, 0x00}}) {
      BlockScenario s;
      ASSERT_EQ(s.plug_in().preset_object(0x1029, 1, Bytes{behaviour}), canopen::AbortCode::none);
      s.cpu(module::CpuState::stop).supply_on();
      if (!reset.empty()) s.advance(5s).ignore_tx().rx(0x000, reset);
      s.controller().completes = false;
      s.advance(5s).tx(boot_up).no_tx().expect(727, 0x7F);
      s.controller().completes = true;
      s.controller().completing.push_back(boot_up);
      s.advance(0s).tx(0x0FF, cpu_stopped).no_tx().expect(727, behaviour == 2 ? 0x04 : 0x7F);
    }
  }
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_watchdog_and_cpu_test
