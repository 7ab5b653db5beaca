// LEDs of the ME3CAN1-Q [3.1.1, 8.1.1].

#include <algorithm>

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_led_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Led);

using module::LedPattern;

enum Which : std::size_t { run, error, can_run, traffic, can_error };

LedPattern led(IntelligentScenario& s, Which which) { return s.plug_in().leds(s.now())[which].pattern; }

/// What an eye sees of an LED from now on, in milliseconds: "200 dark, 200 lit, ...", each piece between two
/// changes, as long as `duration` goes. The first and the last piece are cut off: the eye came and went in
/// the middle of them. "dark" or "lit" when nothing changes.
std::string seen(IntelligentScenario& s, Which which, can::Duration duration = 5s) {
  std::vector<std::pair<bool, int>> pieces;
  for (can::Duration passed{}; passed < duration; passed += 10ms) {
    const bool lit = module::is_lit(s.plug_in().leds(s.now())[which], s.now());
    if (pieces.empty() || pieces.back().first != lit) pieces.emplace_back(lit, 0);
    pieces.back().second += 10;
    s.advance(10ms);
  }
  if (pieces.size() == 1) return pieces.front().first ? "lit" : "dark";
  std::string text;
  // From the first piece that begins a period (the one after the longest darkness) on, one period.
  const auto longest_dark = std::max_element(
      pieces.begin() + 1, pieces.end() - 1,
      [](const auto& a, const auto& b) { return (a.first ? 0 : a.second) < (b.first ? 0 : b.second); });
  for (auto piece = longest_dark + 1; piece < pieces.end() - 1; ++piece) {
    text += (text.empty() ? "" : ", ") + std::to_string(piece->second) + (piece->first ? " lit" : " dark");
    if (!piece->first && piece->second == longest_dark->second) break;
  }
  return text;
}

constexpr auto flickers = "50 lit, 50 dark";
constexpr auto blinks = "200 lit, 200 dark";
constexpr auto flashes_once = "200 lit, 1000 dark";
constexpr auto flashes_twice = "200 lit, 200 dark, 200 lit, 1000 dark";

TEST_P(Led, Run_IsOnInOperation_OffWithoutSupply) {
  spec("ME3-LED-001", "");
  IntelligentScenario s(GetParam());
  EXPECT_EQ(led(s, run), LedPattern::off);
  s.power_on();
  EXPECT_EQ(led(s, run), LedPattern::on);
  s.supply_off();
  EXPECT_EQ(led(s, run), LedPattern::off);
}

TEST(Me3Led, CanRun_ShowsTheNmtState) {
  RecordProperty("spec", "ME3-LED-003 ME3-LED-004 ME3-LED-005");
  IntelligentScenario s;
  s.supply_on();
  EXPECT_EQ(seen(s, can_run, 900ms), "dark");  // initialization: 1 s
  s.power_on();
  EXPECT_EQ(seen(s, can_run), blinks);
  s.nmt(0x01);
  EXPECT_EQ(seen(s, can_run), "lit");
  s.nmt(0x02);
  EXPECT_EQ(seen(s, can_run), flashes_once);
  s.nmt(0x80);
  EXPECT_EQ(seen(s, can_run), blinks);
  s.ignore_tx();
}

TEST(Me3Led, CanRun_OfTheActiveMaster) {
  RecordProperty("spec", "ME3-LED-003 ME3-LED-004 ME3-LED-005");
  IntelligentScenario s;
  s.power_on_as_master();
  s.expect_bit(25, 15, true);
  EXPECT_EQ(seen(s, can_run), blinks);
  for (const auto& [request, pattern] : {std::pair{0x05, "lit"}, std::pair{0x7F, blinks},
                                         std::pair{0x04, flashes_once}, std::pair{0x05, "lit"}}) {
    s.set_object(0x1F82, 1, static_cast<std::uint32_t>(request), 1).ignore_tx();
    EXPECT_EQ(seen(s, can_run), pattern) << request;
  }
}

TEST(Me3Led, CanRun_InTheLayer2Modes_IsDarkWhileX03IsOff) {
  RecordProperty("spec", "ME3-LED-006 ME3-LED-003");
  for (const std::uint16_t mode : Words{11, 29}) {
    IntelligentScenario s;
    s.power_on_layer2(mode);
    s.expect_x(0x03, false);
    EXPECT_EQ(seen(s, can_run), "dark");
    EXPECT_EQ(seen(s, run), "lit");
    s.rx(0x123, {1});  // traffic of others makes no difference
    EXPECT_EQ(seen(s, can_run, 200ms), "dark");
    s.online();
    EXPECT_EQ(led(s, can_run), LedPattern::on);  // at once, and steadily
    EXPECT_EQ(seen(s, can_run), "lit");
    s.offline();
    EXPECT_EQ(led(s, can_run), LedPattern::off);
    EXPECT_EQ(seen(s, can_run), "dark");
    // Y03 alone does not do: with settings that are no good X03 stays OFF.
    s.write(6000, {0xFFFF, 0x5FFF});  // a transmit slot without a CAN-ID
    s.y(0x03, true).expect_x(0x03, false);
    EXPECT_EQ(seen(s, can_run), "dark");
    s.y(0x03, false);
    // A restart with Y03 ON: dark until the end of the initialization, 6 s later.
    s.write(6000, {0xFFFF, 0xFFFF});
    s.online();
    s.y(0x02, true).expect_x(0x03, false);
    EXPECT_EQ(seen(s, can_run, 5990ms), "dark");
    s.wait_x(0x03, true);
    EXPECT_EQ(seen(s, can_run, 400ms), "lit");
    s.y(0x02, false);
    s.no_tx();
  }
}

TEST(Me3Led, CanError_ShowsTheMostSevereCause) {
  RecordProperty("spec", "ME3-LED-002 ME3-LED-009 ME3-LED-010 ME3-LED-011 ME3-LED-012 ME3-LED-013");
  IntelligentScenario s;
  s.power_on_as(1);
  EXPECT_EQ(seen(s, can_error), "dark");
  EXPECT_EQ(seen(s, error), "dark");
  s.write(27, 0);
  EXPECT_EQ(seen(s, can_error), blinks);
  EXPECT_EQ(seen(s, error), "lit");
  s.error_counters(95, 95);
  EXPECT_EQ(seen(s, can_error), blinks);
  s.error_counters(0, 96);
  EXPECT_EQ(seen(s, can_error), flashes_once);
  s.error_counters(96, 0);
  EXPECT_EQ(seen(s, can_error), flashes_once);
  s.set_object(0x1016, 1, 0x00020064, 4);
  s.rx(0x702, {0x05});
  s.advance(200ms);
  EXPECT_EQ(seen(s, can_error), flashes_twice);
  s.error_counters(256, 0);
  EXPECT_EQ(seen(s, can_error), "lit");
  s.ignore_tx();
  s.restart();
  EXPECT_EQ(seen(s, can_error), "dark");
  EXPECT_EQ(seen(s, error), "dark");
}

// Each cause by itself; when it ends, or is cleared, the LED is dark again.
TEST(Me3Led, CanError_OneCauseAtATime) {
  RecordProperty("spec", "ME3-LED-002 ME3-LED-010 ME3-LED-011 ME3-LED-012 ME3-LED-013");
  IntelligentScenario s;
  s.power_on_as(1);
  s.error_counters(96, 0);
  EXPECT_EQ(seen(s, can_error), flashes_once);
  EXPECT_EQ(seen(s, error), "dark");  // no error of the module
  s.error_counters(95, 0);
  EXPECT_EQ(seen(s, can_error), "dark");
  s.error_counters(130, 0);  // error passive is above the warning limit, too
  EXPECT_EQ(seen(s, can_error), flashes_once);
  EXPECT_EQ(seen(s, error), "dark");
  s.error_counters(0, 0).ignore_tx();
  EXPECT_EQ(seen(s, can_error), "dark");
  s.write(27, 0);
  EXPECT_EQ(seen(s, can_error), blinks);
  s.y(0x0F, true).y(0x0F, false);
  EXPECT_EQ(seen(s, can_error), "dark");
  EXPECT_EQ(seen(s, error), "dark");
  // Heartbeat, as consumer.
  s.set_object(0x1016, 1, 0x00020064, 4);
  s.rx(0x702, {0x05}).advance(99ms);
  EXPECT_EQ(led(s, can_error), LedPattern::off);
  s.advance(1ms);
  EXPECT_EQ(seen(s, can_error), flashes_twice);
  EXPECT_EQ(seen(s, error), "dark");
  s.y(0x10, true).y(0x10, false);
  EXPECT_EQ(seen(s, can_error), "dark");
  // Life guarding, as slave.
  s.set_object(0x100C, 0, 100, 2);
  s.set_object(0x100D, 0, 2, 1);
  s.rx_remote(0x701, 1).advance(199ms);
  EXPECT_EQ(led(s, can_error), LedPattern::off);
  s.advance(1ms);
  EXPECT_EQ(seen(s, can_error), flashes_twice);
  s.y(0x10, true).y(0x10, false);
  EXPECT_EQ(seen(s, can_error), "dark");
  // Node guarding, as master.
  s.set_object(0x100C, 0, 0, 2);
  s.set_object(0x1F80, 0, 1, 4);
  s.set_object(0x1F81, 3, 0x00640201, 4);
  s.store_objects().restart().advance(1s);
  EXPECT_EQ(led(s, can_error), LedPattern::off);
  s.rx(0x703, {0x00}).rx(0x703, {0x7F}).ignore_tx();
  s.wait_bit(403, 2, true);  // one missed answer
  EXPECT_EQ(seen(s, can_error), flashes_twice);
  s.ignore_tx();
}

// The bits of G29 that are no error of the bus or of another node.
TEST(Me3Led, CanError_BlinksForEachGeneralError) {
  RecordProperty("spec", "ME3-LED-010 ME3-LED-013 ME3-LED-002");
  struct Cause {
    std::uint16_t bits;
    std::uint16_t mode;
    void (*occurs)(IntelligentScenario&);
  };
  const std::vector<Cause> causes{
      {0x0002, 405,
       [](IntelligentScenario& s) { s.plug_in().inject(module::ModuleFault::hardware_error, s.now()); }},
      {0x0010, 405,
       [](IntelligentScenario& s) {
         s.write(70, 1000).write(22, 1).y(0x1F, true).supply_off();
         s.power_on();
       }},
      {0x0020, 405,
       [](IntelligentScenario& s) {
         s.y(0x02, true).advance(1s).write(70, 1).wait_x(0x02, true).y(0x02, false);
       }},
      {0x0040, 405, [](IntelligentScenario& s) { s.write(71, 1); }},
      {0x0040, 11, [](IntelligentScenario& s) { s.write(24, 1); }},
      {0x0100, 405,
       [](IntelligentScenario& s) {
         s.controller().overflows = 1;
         s.write(20, 0);
       }},
      {0x8000, 11,
       [](IntelligentScenario& s) {
         s.write(6000, {0x0181, 0, 0, 0});
         s.online();
         for (int i = 0; i < 20; ++i) s.rx(0x181, {1});
       }},
  };
  for (const Cause& cause : causes) {
    SCOPED_TRACE(cause.bits);
    IntelligentScenario s;
    if (cause.mode == 405) {
      s.power_on();
    } else {
      s.power_on_layer2(cause.mode);
    }
    EXPECT_EQ(seen(s, can_error), "dark");
    cause.occurs(s);
    s.ignore_tx().expect(29, cause.bits);
    EXPECT_EQ(seen(s, can_error), blinks);
    if (cause.bits == 0x0002) continue;  // until the supply goes off
    if (cause.bits == 0x8000) s.write(5001, 0);
    if (cause.bits == 0x0010) s.save().restart();  // until good data are found
    s.y(0x0F, true).y(0x0F, false).ignore_tx();
    s.expect(29, 0);
    EXPECT_EQ(seen(s, can_error), "dark");
    EXPECT_EQ(seen(s, error), "dark");
  }
}

TEST(Me3Led, TxRx_IsOnWhileFramesGoByTheModule) {
  RecordProperty("spec", "ME3-LED-008");
  IntelligentScenario s;
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
  s.advance(49ms);
  EXPECT_EQ(led(s, traffic), LedPattern::on);
  s.advance(1ms);
  EXPECT_EQ(led(s, traffic), LedPattern::off);
  // In the Layer 2 modes offline frames are not received.
  s.write(21, 11);
  s.save().restart().advance(1s);
  s.rx(0x123, {1});
  EXPECT_EQ(led(s, traffic), LedPattern::off);
  s.online().rx(0x123, {1});
  EXPECT_EQ(led(s, traffic), LedPattern::on);
}

// The patterns over time, in steps of 50 ms from the start of the time base.
TEST_P(Led, Patterns_OverTime) {
  spec("ME3-LED-004 ME3-LED-005 ME3-LED-011", "");
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
}  // namespace canopus::scenario::me3can1_q_led_test
