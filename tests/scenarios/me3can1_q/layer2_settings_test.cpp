// spec/me3can1-q/scenarios.md, section 8: Layer 2 modes - function mode, words, online and offline (S06, S54).

#include "scenarios/me3can1_q/layer2_frames.hpp"

namespace canopus::scenario::me3can1_q_layer2_settings_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Layer2Settings);

using module::LedPattern;
constexpr std::size_t can_run_led = 2;

TEST(Me3Layer2Settings, S06_StartUp_InTheOrderOfTable6_5) {
  RecordProperty("spec", "ME3-L2-001 ME3-PRG-003 ME3-L2-009 ME3-MODE-003");
  IntelligentScenario s;
  s.power_on();
  s.write(21, 11);
  s.save();
  s.expect(37, 2500).expect_bit(25, 8, true);  // still 405: Pre-operational
  s.restart();
  s.expect(21, 11).expect(25, 0);
  s.write(24, 500);
  s.save();
  s.expect(37, 2500);
  s.restart();
  s.expect(37, 5000).expect_x(0x03, false);
  EXPECT_EQ(s.plug_in().leds(s.now())[can_run_led].pattern, LedPattern::off);
  s.write(6000, {0xFFFF, 0x5FFF, 0, 0});
  s.write(6004, {0x0181, 0, 0, 0});
  s.write(10000, {0x0123, 0, 0x0002});
  s.write(8450, {0x0100, 0, 0x0001, 0x0055});
  s.save();
  s.expect(29, 0).no_tx();
  s.online();
  s.expect_x(0x0F, false);
  EXPECT_EQ(s.plug_in().leds(s.now())[can_run_led].pattern, LedPattern::on);
  s.write(10003, 0x2211);
  s.exchange();
  s.tx(0x123, {0x11, 0x22});
  s.offline();
  EXPECT_EQ(s.plug_in().leds(s.now())[can_run_led].pattern, LedPattern::off);
  // All of it is there after the next start.
  s.restart();
  s.expect(6000, {0xFFFF, 0x5FFF, 0, 0, 0x0181, 0, 0, 0}).expect(10000, {0x0123, 0});
  s.expect(8450, {0x0100, 0, 0x0001, 0x0055, 0, 0, 0});
}

TEST_P(Layer2Settings, FunctionMode_TakesEffectWithTheRestart_UnsavedItIsLost) {
  spec("ME3-MODE-001 ME3-MODE-003 ME3-L2-001", "RJ71-MODE-001");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.expect(21, 405);
  s.write(21, 29);
  s.expect(21, 29).expect(29, 0).expect_bit(25, 8, true);
  s.restart();
  s.expect(21, 405).expect_bit(25, 8, true);
  s.write(21, 29);
  s.save();
  s.restart();
  s.expect(21, 29).expect(25, 0);
  s.write(21, 11);
  s.save();
  s.restart();
  s.expect(21, 11).expect(25, 0);
  s.write(21, 12);
  s.expect(21, 11).expect(29, 0x0040).expect(39, 21);
  s.clear_errors();
  s.write(21, 405);
  s.save();
  s.restart();
  s.expect(21, 405).expect_bit(25, 8, true);
}

TEST_P(Layer2Settings, Defaults_DisableEverySlotAndStopMessage) {
  spec("ME3-L2-002 ME3-L2-003 ME3-L2-041 ME3-L2-045", "RJ71-L2-001 RJ71-STOPMSG-001");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  for (module::BufferAddress slot = 0; slot < 42; ++slot) {
    s.expect(6000 + 4 * slot, {0xFFFF, 0xFFFF, 0, 0});
    s.expect(10000 + 7 * slot, {0xFFFF, 0xFFFF, 0, 0, 0, 0, 0});
    s.expect(5001 + slot, 0);
  }
  for (module::BufferAddress message = 0; message < 4; ++message) {
    s.expect(8450 + 7 * message, {0xFFFF, 0xFFFF, 0, 0, 0, 0, 0});
  }
  s.expect(8350, {0, 0, 0}).expect(8400, {0, 0, 0});
  // What follows the 42 slots, and the TPDO words of 405 mode, is system area.
  for (const module::BufferAddress address : {10294U, 11023U, 13000U, 14023U, 6168U, 5043U, 8478U}) {
    s.write(address, 0x1234);
    s.expect(address, 0);
  }
  s.expect(29, 0);
  s.online();
  s.exchange();
  s.rx(0x000).rx(0x7FF, {1}).rx_remote(0x7FF).advance(1s);
  s.cpu(module::CpuState::stop);
  s.no_tx();
}

TEST(Me3Layer2Settings, CanopenIsOff_ItsWordsReadZero) {
  RecordProperty("spec", "ME3-MODE-005 ME3-MODE-007 ME3-SYS-012");
  IntelligentScenario s;
  s.power_on_layer2();
  s.online();
  s.rx(0x081, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0});
  s.rx(0x702, {0x05}).rx(0x000, {0x01, 0x00}).rx(0x67F, {0x40, 0, 0x10, 0, 0, 0, 0, 0}).rx_remote(0x77F, 1);
  s.rx(0x000, {0x81, 0x00}).rx(0x000, {0x82, 0x7F}).expect(25, 0).expect_x(0x03, true);
  s.rx(0x080).rx(0x100, {0, 0, 0, 0, 0xA2, 0x2B}).error_counters(130, 0).error_counters(0, 0);
  s.advance(2s);
  s.exchange();
  s.no_tx().expect_x(0x10, false).expect_x(0x11, false);
  for (module::BufferAddress address = 401; address <= 527; ++address) s.expect(address, 0);
  for (module::BufferAddress address = 601; address <= 727; ++address) s.expect(address, 0);
  for (module::BufferAddress address = 750; address <= 859; ++address) s.expect(address, 0);
  for (const module::BufferAddress address : {50U, 59U, 70U, 71U, 400U, 401U, 750U}) {
    s.write(address, 1);
    s.expect(address, 0);
  }
  s.expect(29, 0);
  s.write(27, 1);  // the one word of these that reports it
  s.expect(29, 0x0040).expect(39, 27);
}

TEST(Me3Layer2Settings, CommonWordsAndTheCommandInterface_KeepTheirFunction) {
  RecordProperty("spec", "ME3-MODE-006 ME3-IO-027");
  IntelligentScenario s;
  s.power_on_layer2();
  s.expect(24, 250).expect(37, 2500).expect(25, 0);
  s.write(24, 123);
  s.expect(24, 250).expect(29, 0x0040).expect(39, 24).expect_x(0x0F, true);
  s.y(0x0F, true).y(0x0F, false);
  s.expect(29, 0).expect_x(0x0F, false);
  s.error_counters(100, 3);
  s.expect(35, 100).expect(36, 3).expect(25, 0x0002);
  s.error_counters(3, 130);
  s.expect(36, 128).expect(29, 0x4000);
  s.error_counters(256, 0);
  s.expect(35, 256).expect(36, 256).expect(29, 0x0008).expect_x(0x0F, true);
  s.error_counters(0, 0);
  s.cif({0x0004, 0x1111, 0x2222, 0});
  s.expect(1000, {0x000F, 0x0064});
  s.cif({0x0000});
  s.expect(1000, {0x0000, 0x1111, 0x2222, 0});
  s.cif({0xFFFF});
  s.expect(1000, 0x0000);
  // Signals of 405 mode do nothing, the common ones work.
  for (const unsigned number : {0x10U, 0x11U, 0x12U, 0x13U}) {
    s.y(number, true).advance(10ms);
    s.expect_x(number, false);
    s.y(number, false);
  }
  s.exchange();
  s.save();
  s.write(20, 0x1000);
  s.expect(20, 0);
  s.restart();
  s.expect(25, 0).expect(29, 0).no_tx();
}

TEST_P(Layer2Settings, SignalsOfLayer2_DoNothingIn405Mode) {
  spec("ME3-IO-027 ME3-IO-009", "RJ71-IO-008");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.y(0x03, true).y(0x04, true).advance(1s);
  s.expect_x(0x03, false).expect_x(0x04, false);
  s.restart();  // with Y03 and Y04 ON
  s.expect_x(0x03, false).expect_x(0x04, false).expect_bit(25, 8, true);
  s.y(0x03, false).y(0x04, false);
  // 405 mode has its own there.
  s.write(13000, 7);
  s.y(0x13, true);
  s.expect_x(0x13, true);
  s.y(0x12, true);
  s.expect_x(0x12, true);
  s.rx(0x085, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0});
  s.expect_x(0x11, true);
  s.y(0x11, true);
  s.expect_x(0x11, false);
}

TEST_P(Layer2Settings, Y03_OnlineAndOffline) {
  spec("ME3-IO-009 ME3-L2-009", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x7FFF, 0, 0}).write(10000, {0x0123, 0, 1, 0x55});
  s.write(6004, {0x0181, 0, 0, 0});
  s.write(6008, {0xFFFF, 0x5FFF, 2, 1}).write(10014, {0x0222, 0, 0});
  s.expect_x(0x03, false);
  const auto nothing_happens = [&] {
    s.exchange();
    s.rx_remote(0x123, 1).rx(0x181, {0xA1}).advance(1s);
    s.write(8400, 1).y(0x04, true).advance(1s);
    s.expect_x(0x04, false).y(0x04, false).write(8400, 0);
    s.cpu(module::CpuState::stop).cpu(module::CpuState::run);
    s.no_tx();
  };
  nothing_happens();
  s.online();
  s.exchange();  // the message of the offline time was ignored
  s.tx(0x123, {0x55}).expect(10009, 0);
  s.rx_remote(0x123, 1).tx(0x123, {0x55});
  s.advance(100ms);
  for (int i = 0; i < 10; ++i) s.tx(0x222);
  s.rx(0x181, {0xB1});
  s.offline();
  nothing_happens();
  s.expect(10009, 0);
  s.online();
  s.exchange();
  s.tx(0x123, {0x55}).expect(10009, 0);  // what was not exchanged before going offline is lost
  s.ignore_tx();
}

// A data exchange that is under way when the module goes offline, or online, neither sends nor stores.
TEST_P(Layer2Settings, Y03_DuringADataExchange) {
  spec("ME3-IO-009 ME3-L2-009", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x5FFF, 0, 0}).write(10000, {0x0123, 0, 1, 0x55});
  s.write(6004, {0x0181, 0, 0, 0});
  s.online();
  s.rx(0x181, {0xA1});
  s.y(0x01, true);
  s.offline();
  s.wait_x(0x01, true).no_tx().expect(10009, 0);
  s.y(0x01, false).y(0x01, true);
  s.online();
  s.wait_x(0x01, true).no_tx().expect(10009, 0);
  s.y(0x01, false);
  s.exchange();
  s.tx(0x123, {0x55}).no_tx();
}

TEST_P(Layer2Settings, Y03_LeftOn_GoesOnlineAgainAfterARestart) {
  spec("ME3-IO-009", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.online();
  s.y(0x02, true);
  s.expect_x(0x03, false);
  s.wait_x(0x02, true);
  s.y(0x02, false);
  s.expect_x(0x03, true);
}

TEST(Me3Layer2Settings, S54_ConfigurationWhileOnline_IsRefused) {
  RecordProperty("spec", "ME3-IO-010 ME3-L2-008 ME3-IO-012 ME3-IO-013 ME3-ERR-009");
  IntelligentScenario s;
  s.power_on_layer2();
  s.write(6000, {0x0181, 0, 0, 0});
  s.online();
  s.write(6000, 0x0200);
  s.expect(6000, 0x0181).expect(29, 0x0020).expect(40, 6000).expect(39, 0).expect_x(0x0F, true);
  // Every word of the configuration; the first address stays.
  for (module::BufferAddress address = 6000; address <= 6167; ++address) {
    const std::uint16_t before = s.read(address);
    s.write(address, 1);
    s.expect(address, before);
  }
  for (module::BufferAddress address = 8450; address <= 8477; ++address) {
    const std::uint16_t before = s.read(address);
    s.write(address, 1);
    s.expect(address, before);
  }
  for (module::BufferAddress slot = 0; slot < 42; ++slot) {
    s.write(10000 + 7 * slot, {1, 1});
    s.expect(10000 + 7 * slot, {0xFFFF, 0xFFFF});
  }
  s.expect(29, 0x0020).expect(40, 6000);
  s.offline();
  s.expect(29, 0x0020).expect_x(0x0F, true);  // latched
  s.online();
  s.y(0x0F, true);
  s.expect(29, 0).expect(40, 0).expect_x(0x0F, false);
  s.y(0x0F, false);
  s.write(8452, 1);
  s.expect(29, 0x0020).expect(40, 8452);
  s.write(29, 0);
  s.expect(29, 0).expect(40, 0);
  s.write(10007, 5);
  s.expect(40, 10007);
  s.write(29, 0);
  s.offline();
  s.write(6000, 0x0200).write(8452, 1).write(10007, 5);
  s.expect(6000, 0x0200).expect(8452, 1).expect(10007, 5).expect(29, 0).expect_x(0x0F, false);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_layer2_settings_test
