// The engine with tables that are not the ME3CAN1-Q's: whatever it does, it does where and as the model says.

#include "scenarios/engine/other_models.hpp"

namespace canopus::scenario::engine_other_models_test {
namespace {

using Elsewhere = OtherScenario<ElsewhereModule>;

constexpr unsigned ready = 0x1C;
constexpr unsigned exchange = 0x1B;
constexpr unsigned restart = 0x1A;
constexpr unsigned error = 0x19;
constexpr unsigned clock = 0x16;
constexpr unsigned command = 0x14;
constexpr unsigned save = 0x13;
constexpr unsigned online = 0x12;

void start(ModuleScenario& s) {
  s.supply_on().expect_bit(125, 13, true).advance(1s).expect_bit(125, 13, false);
  s.tx(0x703, {0x00});
}

TEST(OtherModel, StartsWithItsOwnSettings_AndShowsItsOwnBits) {
  Elsewhere s;
  EXPECT_EQ(s.plug_in().model(), "ELSEWHERE");
  EXPECT_EQ(s.plug_in().buffer_memory_size(), 5000U);
  s.expect_x(ready, false);
  start(s);
  EXPECT_EQ(s.controller().rate, 500'000U);
  s.expect_x(ready, true).expect(125, 1U << 12).expect(137, 5000).expect(803, 0x7F);
  s.rx(0x000, {0x01, 0x00}).expect(125, 1U << 15 | 1U << 11).expect(803, 5);
  s.rx(0x000, {0x81, 0x03}).wait_tx(0x703, {0x00}).advance(20ms);
  s.expect(125, 1U << 12);  // no bit for a seen NMT reset
  s.error_counters(100, 0).expect_bit(125, 14, true).expect(135, 100);
}

TEST(OtherModel, ExchangesItsEightWords) {
  Elsewhere s;
  start(s);
  s.rx(0x000, {0x01, 0x00});
  s.rx(0x203, {0x34, 0x12});
  s.write(4001, 0x5678).y(exchange, true).expect(120, 0x0101).advance(1ms);
  s.expect_x(exchange, true).expect(120, 0).expect(3001, 0x1234);
  s.tx(0x183, {0x78, 0x56});
  s.y(exchange, false).expect_x(exchange, false);
  s.write(120, 1U << 2).y(exchange, true).expect(120, 0).advance(1ms);  // emergencies only
  s.expect_x(exchange, true);
}

TEST(OtherModel, ErrorsHaveTheirOwnBits_AndOnlySomeMakeTheSignal) {
  Elsewhere s;
  start(s);
  s.write(127, 200).expect(129, 1U << 11).expect(139, 127).expect_x(error, true);
  s.y(error, true).expect(129, 0).expect(139, 0).expect_x(error, false).y(error, false);
  s.error_counters(130, 0).expect(129, 1U << 0).expect_x(error, false);
  s.tx(0x083, {0x21, 0x81, 0x13, 0, 0, 0, 0, 0});
  s.error_counters(0, 0).expect(129, 0);
  s.controller().lost = 1;
  s.advance(1ms).error_counters(0, 0).expect(129, 1U << 9).expect_x(error, true);
  s.tx(0x083, {0x11, 0x81, 0x13, 0, 0, 0, 0, 0});
  s.plug_in().inject(module::ModuleFault::hardware_error, s.now());
  s.expect(129, 1U << 9 | 1U << 12).expect_x(ready, false);
}

// The error register collects what is there; any error sets its bit 0 [CiA 301 1001H].
TEST(OtherModel, SendsItsOwnEmergencies) {
  Elsewhere s;
  start(s);
  s.cpu(module::CpuState::stop).tx(0x083, {0x02, 0xFF, 0x83, 'X', '2', 0, 0, 0});
  s.y(restart, true).tx(0x083, {0x01, 0x62, 0x87, 'X', '4', 0, 0, 0}).expect_x(ready, true);
  s.wait_x(restart, true, 6s).tx(0x703, {0x00}).y(restart, false).expect_x(restart, false);
}

TEST(OtherModel, SavesWhatItStores_AndWearsOutAsItSays) {
  struct Listener final : module::ModuleObserver {
    void error_raised(std::string_view what, can::Time) override { told.emplace_back(what); }
    std::vector<std::string> told;
  } listener;
  Elsewhere s;
  s.plug_in().set_observer(&listener);
  start(s);
  s.write(124, 2000);
  ASSERT_EQ(listener.told.size(), 1U);
  EXPECT_EQ(listener.told[0], "W124 = 2000: not a value this word accepts");
  s.write(124, 125).write(127, 5);
  for (int i = 0; i < 4; ++i) {
    s.write(122, 1).y(save, true).advance(100ms).expect_x(save, true).expect(122, 0);
    s.y(save, false).expect_x(save, false);
  }
  ASSERT_EQ(listener.told.size(), 2U);
  EXPECT_EQ(listener.told[1],
            "the flash memory has been written more often than the real one lasts for (3 times)");
  s.supply_off().supply_on().advance(1s).tx(0x705, {0x00}).expect(137, 1250).expect(127, 5);
  EXPECT_EQ(s.controller().rate, 125'000U);
  s.plug_in().set_observer(nullptr);
}

TEST(OtherModel, HasItsOwnCommands_ClockAndLeds) {
  Elsewhere s;
  start(s);
  s.write(1100, {0x4001, 0, 0x1014, 0}).y(command, true).wait_x(command, true);
  s.expect(1100, {0x4002, 0, 0x1014, 0, 4, 0x0083, 0}).y(command, false);
  s.write(150, 2).write(151, {2026, 11, 21, 19, 0, 0}).y(clock, true).expect_x(clock, true).y(clock, false);
  s.expect(129, 0).expect(157, 6);  // a Saturday
  const auto leds = s.plug_in().leds(s.now());
  ASSERT_EQ(leds.size(), 2U);
  EXPECT_EQ(leds[0].name, "FAULT");
  EXPECT_EQ(leds[0].pattern, module::LedPattern::off);
  EXPECT_EQ(leds[1].name, "NET");
  EXPECT_EQ(leds[1].pattern, module::LedPattern::blinking);
}

TEST(OtherModel, BuffersAsManyEmergenciesAsItSays) {
  Elsewhere s;
  start(s);
  for (std::uint8_t n = 1; n <= 6; ++n) s.rx(0x080U + 10, {n, 0x10, 0, 0, 0, 0, 0, 0});
  s.y(exchange, true).advance(1ms).y(exchange, false);
  s.expect(951, 0x1001).expect(956, 0x1002).expect(961, 0x1003).expect(966, 0x1006);
}

TEST(OtherModel, ChangesItsFunctionMode) {
  Elsewhere s;
  start(s);
  s.y(online, true).expect_x(online, false).y(online, false);  // not in this mode
  s.write(121, 8).expect(139, 121).y(error, true).y(error, false);
  s.write(121, 7).write(122, 1).y(save, true).advance(100ms).y(save, false);
  s.y(restart, true).ignore_tx().wait_x(restart, true).y(restart, false).ignore_tx();
  EXPECT_EQ(s.plug_in().layer2_state(), module::Layer2State::offline);
  // Slot 1: 29-bit identifier, no remote frames, by data exchange, two bytes.
  s.write(2400, {0xFFFF, 0x5FFF, 0, 0}).write(2000, {0x5678, 0x1234, 2, 0xBBAA, 0, 0, 0});
  s.y(online, true).expect_x(online, true).ignore_tx().y(exchange, true).advance(1ms);
  can::Frame frame;
  frame.identifier = 0x12345678;
  frame.extended = true;
  frame.dlc = 2;
  frame.data = {0xAA, 0xBB};
  s.tx(frame).y(exchange, false);
}

// Clear requests are Y signals; a module that starts with all of them OFF holds nothing clear.
TEST(OtherModel, PowerOff_EndsWhatTheProgramHeldClear) {
  Elsewhere s;
  start(s);
  s.y(error, true).write(127, 200).expect(129, 0);
  s.supply_off().supply_on().advance(1s).tx(0x703, {0x00});
  s.write(127, 200).expect(129, 1U << 11).expect_x(error, true);
}

TEST(OtherModel, ASaveThatIsTakenBack_IsDone_AndNotAnswered) {
  Elsewhere s;
  start(s);
  s.write(127, 9).write(122, 1).y(save, true).advance(50ms).y(save, false).advance(60ms);
  s.expect(122, 0).expect_x(save, false);
  s.supply_off().supply_on().advance(1s).tx(0x709, {0x00});
}

}  // namespace
}  // namespace canopus::scenario::engine_other_models_test
