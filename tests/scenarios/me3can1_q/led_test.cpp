// LEDs of the ME3CAN1-Q [3.1.1, 8.1.1].

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {
namespace {

using module::LedPattern;

enum Which : std::size_t { run, error, can_run, traffic, can_error };

LedPattern led(Me3Scenario& s, Which which) { return s.plug_in().leds(s.now())[which].pattern; }

TEST(Me3Led, Run_IsOnInOperation_OffWithoutSupply) {
  RecordProperty("spec", "ME3-LED-001");
  Me3Scenario s;
  EXPECT_EQ(led(s, run), LedPattern::off);
  s.power_on();
  EXPECT_EQ(led(s, run), LedPattern::on);
  s.supply_off();
  EXPECT_EQ(led(s, run), LedPattern::off);
}

TEST(Me3Led, CanRun_ShowsTheNmtState) {
  RecordProperty("spec", "ME3-LED-003 ME3-LED-004 ME3-LED-005");
  Me3Scenario s;
  s.supply_on();
  EXPECT_EQ(led(s, can_run), LedPattern::off);
  s.power_on();
  EXPECT_EQ(led(s, can_run), LedPattern::blinking);
  s.nmt(0x01);
  EXPECT_EQ(led(s, can_run), LedPattern::on);
  s.nmt(0x02);
  EXPECT_EQ(led(s, can_run), LedPattern::single_flash);
  s.nmt(0x80);
  EXPECT_EQ(led(s, can_run), LedPattern::blinking);
  s.ignore_tx();
}

TEST(Me3Led, CanError_ShowsTheMostSevereCause) {
  RecordProperty("spec", "ME3-LED-002 ME3-LED-009 ME3-LED-010 ME3-LED-011 ME3-LED-012 ME3-LED-013");
  Me3Scenario s;
  s.power_on_as(1);
  EXPECT_EQ(led(s, can_error), LedPattern::off);
  EXPECT_EQ(led(s, error), LedPattern::off);
  s.write(27, 0);
  EXPECT_EQ(led(s, can_error), LedPattern::blinking);
  EXPECT_EQ(led(s, error), LedPattern::on);
  s.error_counters(95, 95);
  EXPECT_EQ(led(s, can_error), LedPattern::blinking);
  s.error_counters(0, 96);
  EXPECT_EQ(led(s, can_error), LedPattern::single_flash);
  s.set_object(0x1016, 1, 0x00020064, 4);
  s.rx(0x702, {0x05});
  s.advance(200ms);
  EXPECT_EQ(led(s, can_error), LedPattern::double_flash);
  s.error_counters(256, 0);
  EXPECT_EQ(led(s, can_error), LedPattern::on);
  s.ignore_tx();
  s.restart();
  EXPECT_EQ(led(s, can_error), LedPattern::off);
  EXPECT_EQ(led(s, error), LedPattern::off);
}

TEST(Me3Led, TxRx_IsOnWhileFramesGoByTheModule) {
  RecordProperty("spec", "ME3-LED-008");
  Me3Scenario s;
  s.power_on();
  s.advance(1s);
  EXPECT_EQ(led(s, traffic), LedPattern::off);
  s.rx(0x123, {1});
  EXPECT_EQ(led(s, traffic), LedPattern::on);
  s.advance(1s);
  EXPECT_EQ(led(s, traffic), LedPattern::off);
  s.set_object(0x1017, 0, 1000, 2);
  s.wait_tx(0x77F, {0x7F});
  EXPECT_EQ(led(s, traffic), LedPattern::on);
}

// The patterns over time, in steps of 50 ms from the start of the time base.
TEST(Me3Led, Patterns_OverTime) {
  RecordProperty("spec", "ME3-LED-004 ME3-LED-005 ME3-LED-011");
  const auto lit = [](LedPattern pattern, std::size_t steps) {
    std::string text;
    for (std::size_t i = 0; i < steps; ++i) {
      text += module::is_lit(pattern, can::Time{} + 50ms * static_cast<int>(i)) ? '#' : '.';
    }
    return text;
  };
  EXPECT_EQ(lit(LedPattern::off, 8), "........");
  EXPECT_EQ(lit(LedPattern::on, 8), "########");
  EXPECT_EQ(lit(LedPattern::flickering, 8), "#.#.#.#.");
  EXPECT_EQ(lit(LedPattern::blinking, 16), "####....####....");
  EXPECT_EQ(lit(LedPattern::single_flash, 28), "####....................####");
  EXPECT_EQ(lit(LedPattern::double_flash, 36), "####....####....................####");
}

}  // namespace
}  // namespace canopus::scenario
