// spec/me3can1-q/scenarios.md, section 5: time stamp.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_time_stamp_test {
namespace {

CANOPUS_OF_BOTH_MODULES(TimeStamp);

void become_master(IntelligentScenario& s) {
  s.power_on_as(1);
  s.set_object(0x1F80, 0, 0x0000000D, 4);  // stays Pre-operational
  s.store_objects();
  s.restart();
  s.advance(5s);
  s.ignore_tx();
  s.expect_bit(25, 15, true).expect_bit(25, 8, true);
}

// Sets the clock: year, month, day, hour, minute, second.
void set_clock(IntelligentScenario& s, const Words& words, Where where = Where::current()) {
  s.write(51, words);
  s.y(0x12, true);
  s.wait_x(0x12, true, 1s, where);
  s.y(0x12, false);
  s.expect_x(0x12, false, where);
}

void expect_clock(IntelligentScenario& s, const Words& words, Where where = Where::current()) {
  s.y(0x13, true);
  s.wait_x(0x13, true, 1s, where);
  s.expect(51, words, where);
  s.y(0x13, false);
  s.expect_x(0x13, false, where);
}

TEST(Me3TimeStamp, S18_Producer_SendsAtOnceAndThenEveryInterval) {
  RecordProperty("spec", "ME3-TIME-006 ME3-TIME-007 ME3-TIME-012 ME3-TIME-013 ME3-TIME-016 ME3-IO-022");
  IntelligentScenario s;
  become_master(s);
  s.write(50, 2);
  s.write(58, 1);
  s.no_tx();
  set_clock(s, {14, 10, 15, 12, 30, 0});
  s.tx(0x100, {0x40, 0xA5, 0xAE, 0x02, 0xED, 0x2B}).no_tx();
  expect_clock(s, {14, 10, 15, 12, 30, 0, 3, 1});
  s.advance(59999ms);
  s.no_tx();
  s.advance(1ms);
  s.tx(0x100, {0xA0, 0x8F, 0xAF, 0x02, 0xED, 0x2B}).no_tx();
  s.cif({0x0002, 0, 0x1F82, 0x80, 1, 5});  // Operational: still sent
  s.ignore_tx();
  s.advance(60s);
  s.tx(0x100, {0x00, 0x7A, 0xB0, 0x02, 0xED, 0x2B}).no_tx();
  s.cif({0x0002, 0, 0x1F82, 0x80, 1, 4});  // Stopped: not
  s.ignore_tx();
  s.advance(10min);
  s.no_tx();
}

TEST(Me3TimeStamp, Producer_AsSlave_RunsTheClock_SendsNothing) {
  RecordProperty("spec", "ME3-TIME-006");
  IntelligentScenario s;
  s.power_on_as(1);
  s.write(50, 2);
  s.write(58, 1);
  set_clock(s, {14, 10, 15, 12, 30, 0});
  s.advance(10min);
  s.no_tx();
  expect_clock(s, {14, 10, 15, 12, 40, 0, 3});
}

// A producer by its stored 1012H: after a restart the clock stands, and nothing is sent, until Y12.
TEST(Me3TimeStamp, Producer_AfterARestart_WaitsForY12) {
  RecordProperty("spec", "ME3-TIME-001 ME3-TIME-006 ME3-TIME-007");
  IntelligentScenario s;
  become_master(s);
  s.write(50, 2).write(58, 1);
  s.store_objects();
  set_clock(s, {14, 10, 15, 12, 30, 0});
  s.tx(0x100, {0x40, 0xA5, 0xAE, 0x02, 0xED, 0x2B});
  s.restart();
  s.advance(5s).ignore_tx();
  s.expect(50, {2, 14, 8, 1, 0, 0, 0, 5, 0}).expect_bit(25, 15, true);
  s.advance(10min).no_tx();
  expect_clock(s, {14, 8, 1, 0, 0, 0, 5});
  s.write(58, 1).advance(10min).no_tx();
  set_clock(s, {14, 8, 1, 0, 0, 0});
  s.tx(0x100, {0x00, 0x00, 0x00, 0x00, 0xA2, 0x2B}).no_tx();
}

TEST(Me3TimeStamp, Interval_ZeroSendsNothing_1440IsTheLongest) {
  RecordProperty("spec", "ME3-TIME-008");
  IntelligentScenario s;
  become_master(s);
  s.write(50, 2);
  s.write(58, 0);
  set_clock(s, {14, 10, 15, 12, 30, 0});
  s.advance(25h);
  s.no_tx();
  s.write(58, 1440);
  set_clock(s, {14, 10, 15, 12, 30, 0});
  s.tx(0x100, {0x40, 0xA5, 0xAE, 0x02, 0xED, 0x2B});
  s.advance(24h - 1ms);
  s.no_tx();
  s.advance(1ms);
  s.tx(0x100, {0x40, 0xA5, 0xAE, 0x02, 0xEE, 0x2B}).no_tx();
  s.expect(29, 0);
  s.write(58, 1441);
  set_clock(s, {14, 10, 15, 12, 30, 0});
  s.expect(29, 0x0040).expect(39, 58).no_tx();
}

TEST(Me3TimeStamp, S19_InvalidValues_AreRefused_TheClockGoesOn) {
  RecordProperty("spec", "ME3-TIME-009 ME3-TIME-010 ME3-TIME-011 ME3-TIME-012");
  IntelligentScenario s;
  s.power_on();
  s.write(50, 2);
  set_clock(s, {14, 2, 28, 1, 2, 3});
  struct Bad {
    Words words;
    std::uint16_t address;
  };
  const std::vector<Bad> cases{
      {{14, 2, 30, 0, 0, 0}, 53}, {{14, 4, 31, 0, 0, 0}, 53},  {{15, 2, 29, 0, 0, 0}, 53},
      {{14, 0, 1, 0, 0, 0}, 52},  {{14, 13, 1, 0, 0, 0}, 52},  {{14, 1, 0, 0, 0, 0}, 53},
      {{14, 1, 32, 0, 0, 0}, 53}, {{14, 1, 1, 24, 0, 0}, 54},  {{14, 1, 1, 0, 60, 0}, 55},
      {{14, 1, 1, 0, 0, 60}, 56}, {{1979, 1, 1, 0, 0, 0}, 51}, {{2080, 1, 1, 0, 0, 0}, 51},
      {{100, 1, 1, 0, 0, 0}, 51}, {{14, 257, 1, 0, 0, 0}, 52}, {{14, 1, 257, 0, 0, 0}, 53},
  };
  for (const Bad& bad : cases) {
    set_clock(s, bad.words);
    s.expect(29, 0x0040).expect(39, bad.address).expect_x(0x0F, true);
    s.write(29, 0);
  }
  expect_clock(s, {14, 2, 28, 1, 2, 3, 5});
  const std::vector<std::pair<Words, Words>> good{
      {{16, 2, 29, 23, 59, 59}, {16, 2, 29, 23, 59, 59, 1}},
      {{2014, 12, 31, 0, 0, 0}, {14, 12, 31, 0, 0, 0, 3}},
      {{0, 1, 1, 0, 0, 0}, {0, 1, 1, 0, 0, 0, 6}},
      {{79, 12, 31, 0, 0, 0}, {79, 12, 31, 0, 0, 0, 0}},
      {{2079, 1, 1, 0, 0, 0}, {79, 1, 1, 0, 0, 0, 0}},
      {{99, 12, 31, 0, 0, 0}, {99, 12, 31, 0, 0, 0, 5}},
      {{99, 12, 31, 23, 59, 59}, {99, 12, 31, 23, 59, 59, 5}},
      {{80, 1, 1, 0, 0, 0}, {80, 1, 1, 0, 0, 0, 2}},
      {{1980, 1, 1, 12, 0, 0}, {80, 1, 1, 12, 0, 0, 2}},
  };
  for (const auto& [written, shown] : good) {
    set_clock(s, written);
    s.expect(29, 0).expect(57, shown[6]);  // the day of the week is there with Y12
    expect_clock(s, shown);
  }
}

TEST(Me3TimeStamp, S20_ReadsTheClock_OnRequestOnly) {
  RecordProperty("spec", "ME3-IO-023 ME3-TIME-001");
  IntelligentScenario s;
  s.power_on();
  s.expect(50, {1, 14, 8, 1, 0, 0, 0, 5});
  s.advance(100s);
  expect_clock(s, {14, 8, 1, 0, 0, 0, 5});  // stands
  s.write(50, 2);
  set_clock(s, {20, 1, 2, 3, 4, 5});
  s.advance(100s);
  s.expect(51, {20, 1, 2, 3, 4, 5});
  expect_clock(s, {20, 1, 2, 3, 5, 45, 4});
  s.restart();
  s.expect(50, {1, 14, 8, 1, 0, 0, 0, 5});
  s.advance(100s);
  expect_clock(s, {14, 8, 1, 0, 0, 0, 5});
}

TEST(Me3TimeStamp, S21_Consumer) {
  RecordProperty("spec", "ME3-TIME-004 ME3-TIME-005 ME3-TIME-018 ME3-STAT-009 ME3-STAT-012");
  IntelligentScenario s;
  s.power_on();
  s.expect_bit(25, 12, false);
  s.rx(0x100, {0, 0, 0, 0, 0xA2, 0x2B});
  s.expect_bit(25, 12, true);
  s.advance(5s);
  expect_clock(s, {14, 8, 1, 0, 0, 5, 5});
  s.write(25, 0xFFFF);
  s.expect_bit(25, 12, true);
  s.write(25, 0xEFFF);
  s.expect_bit(25, 12, false).expect(25, 0x0100);
  set_clock(s, {20, 1, 2, 3, 4, 5});  // a consumer's own settings are ignored
  expect_clock(s, {14, 8, 1, 0, 0, 5, 5});
  s.rx(0x100, {0, 0, 0, 0, 0x01, 0x00});
  expect_clock(s, {0, 1, 1, 0, 0, 0, 6});
  s.write(25, 0);
  s.write(50, 0);
  s.rx(0x100, {0, 0, 0, 0, 0xA2, 0x2B});
  s.expect_bit(25, 12, false);
  s.write(50, 2);
  s.rx(0x100, {0, 0, 0, 0, 0xA2, 0x2B});
  s.expect_bit(25, 12, false);
  s.write(50, 3);
  s.rx(0x100, {0, 0, 0, 0, 0xA2, 0x2B});
  s.expect_bit(25, 12, true);
}

TEST_P(TimeStamp, Stopped_NothingIsEvaluated) {
  spec("ME3-TIME-020", "");
  IntelligentScenario s(GetParam());
  become_master(s);
  s.write(50, 3);
  s.write(58, 1);
  s.cif({0x0002, 0, 0x1F82, 0x80, 1, 4});
  s.ignore_tx();
  s.rx(0x100, {0, 0, 0, 0, 0xA2, 0x2B});
  s.expect_bit(25, 12, false);
  set_clock(s, {14, 10, 15, 12, 30, 0});
  s.advance(5min);
  s.no_tx();
}

TEST(Me3TimeStamp, Role_IsBits31And30Of1012H) {
  RecordProperty("spec", "ME3-TIME-002 ME3-TIME-003 ME3-TIME-019");
  IntelligentScenario s;
  s.power_on();
  s.expect_object(0x1012, 0, 0x80000100, 4);
  const std::vector<std::pair<std::uint16_t, std::uint32_t>> roles{
      {0, 0x00000100}, {1, 0x80000100}, {2, 0x40000100}, {3, 0xC0000100}};
  for (const auto& [word, object] : roles) {
    s.write(50, word);
    s.expect(50, word);
    s.expect_object(0x1012, 0, object, 4);
  }
  for (const auto& [word, object] : roles) {
    s.set_object(0x1012, 0, object, 4);
    s.expect(50, word);
  }
  s.write(50, 4);
  s.expect(29, 0x0040).expect(39, 50).expect(50, 3);
  s.store_objects();
  s.restart();
  s.expect(50, 3);
}

// Production and consumption begin and end with the word, without a restart.
TEST(Me3TimeStamp, Role_TakesEffectDirectly) {
  RecordProperty("spec", "ME3-TIME-002");
  IntelligentScenario s;
  become_master(s);
  s.write(50, 3);
  s.write(58, 1);
  set_clock(s, {14, 8, 1, 0, 0, 0});
  s.tx(0x100, {0x00, 0x00, 0x00, 0x00, 0xA2, 0x2B}).no_tx();
  for (const std::uint16_t silent : Words{0, 1}) {
    s.write(50, silent);
    s.advance(10min);
    s.no_tx();
  }
  for (const std::uint16_t role : Words{2, 3}) {
    s.write(50, role);
    s.advance(1min);
    ASSERT_EQ(s.controller().sent.size(), 1U);
    s.ignore_tx();
  }
  for (const std::uint16_t role : Words{0, 1, 2, 3}) {
    s.write(50, role);
    s.write(25, 0);
    s.rx(0x100, {0, 0, 0, 0, 0xA2, 0x2B});
    s.expect_bit(25, 12, role == 1 || role == 3);
  }
  s.write(50, 0xFFFF);
  s.expect(29, 0x0040).expect(39, 50).expect(50, 3);
}

// 1012H bits 0 to 10.
TEST(Me3TimeStamp, Identifier_IsThatOf1012H) {
  RecordProperty("spec", "ME3-TIME-019");
  IntelligentScenario s;
  become_master(s);
  s.set_object(0x1012, 0, 0x00000690, 4);
  s.set_object(0x1012, 0, 0xC0000690, 4);
  s.rx(0x100, {0, 0, 0, 0, 0xA2, 0x2B}).expect_bit(25, 12, false);
  s.rx(0x690, {0, 0, 0, 0, 0xA2, 0x2B}).expect_bit(25, 12, true);
  s.write(58, 1);
  set_clock(s, {14, 8, 1, 0, 0, 0});
  s.tx(0x690, {0x00, 0x00, 0x00, 0x00, 0xA2, 0x2B}).no_tx();
  s.write(50, 2);  // keeps the identifier
  s.expect_object(0x1012, 0, 0x40000690, 4);
  s.store_objects();
  s.restart();
  s.expect_object(0x1012, 0, 0x40000690, 4);
  s.expect(50, 2);
  s.advance(5s).ignore_tx();
}

// The fraction of a second is neither counted up from what comes in nor told.
TEST(Me3TimeStamp, WholeSeconds) {
  RecordProperty("spec", "ME3-TIME-013 ME3-TIME-012");
  IntelligentScenario s;
  become_master(s);
  s.write(50, 3);
  s.rx(0x100, {0xCF, 0x07, 0, 0, 0xA2, 0x2B});  // 1.999 s
  expect_clock(s, {14, 8, 1, 0, 0, 1, 5});
  s.advance(999ms);
  expect_clock(s, {14, 8, 1, 0, 0, 1, 5});
  s.advance(1ms);
  expect_clock(s, {14, 8, 1, 0, 0, 2, 5});
  s.write(57, 0);  // read only
  s.expect(57, 5).expect(29, 0);
  s.write(59, 0xFFC4);  // -60 s a day: one minute later the clock stands at 59.958 s
  s.write(58, 1);
  set_clock(s, {14, 8, 1, 0, 0, 0});
  s.tx(0x100, {0x00, 0x00, 0x00, 0x00, 0xA2, 0x2B}).no_tx();
  s.advance(1min);
  s.tx(0x100, {0x78, 0xE6, 0x00, 0x00, 0xA2, 0x2B}).no_tx();
}

TEST(Me3TimeStamp, Consumer_TheYear2000IsTheFirst) {
  RecordProperty("spec", "ME3-TIME-018");
  IntelligentScenario s;
  s.power_on();
  s.rx(0x100, {0x18, 0x58, 0x26, 0x05, 0xD3, 0x16});  // 1999-12-31 23:59:59
  expect_clock(s, {0, 1, 1, 0, 0, 0, 6});
  s.rx(0x100, {0xE8, 0x03, 0x00, 0x00, 0xD4, 0x16});  // 2000-01-01 00:00:01
  expect_clock(s, {0, 1, 1, 0, 0, 1, 6});
}

// A stored 1012H whose CAN-ID the module would not take by SDO: G50 cannot change it, and shows what holds.
TEST(Me3TimeStamp, RoleThat1012hRefuses_IsNotShown) {
  RecordProperty("spec", "ME3-TIME-002 ME3-TIME-019");
  IntelligentScenario s;
  ASSERT_EQ(s.plug_in().preset_object(0x1012, 0, canopen::little_endian(0x80000601, 4)),
            canopen::AbortCode::none);
  s.power_on();
  s.expect(50, 1).write(50, 2).expect(50, 1);
  s.expect_object(0x1012, 0, 0x80000601, 4);
}

TEST(Me3TimeStamp, S22_Overflow) {
  RecordProperty("spec", "ME3-TIME-017");
  IntelligentScenario s;
  s.power_on();
  s.write(50, 2);
  set_clock(s, {79, 12, 31, 23, 59, 59});
  s.advance(999ms);
  expect_clock(s, {79, 12, 31, 23, 59, 59, 0});
  s.advance(1ms);
  expect_clock(s, {0, 1, 1, 0, 0, 0, 6});
}

TEST(Me3TimeStamp, S23_LeapYears) {
  RecordProperty("spec", "ME3-TIME-014");
  IntelligentScenario s;
  s.power_on();
  s.write(50, 2);
  set_clock(s, {16, 2, 28, 23, 59, 59});
  s.advance(1s);
  expect_clock(s, {16, 2, 29, 0, 0, 0, 1});
  set_clock(s, {15, 2, 28, 23, 59, 59});
  s.advance(1s);
  expect_clock(s, {15, 3, 1, 0, 0, 0, 0});
}

TEST(Me3TimeStamp, DailyCorrection_AddsItsSecondsToEachDay) {
  RecordProperty("spec", "ME3-TIME-015");
  IntelligentScenario s;
  s.power_on();
  s.write(59, 61);
  s.expect(29, 0x0040).expect(39, 59).expect(59, 0);
  s.write(29, 0);
  s.write(59, 0xFFC3);  // -61
  s.expect(29, 0x0040).expect(39, 59).expect(59, 0);
  s.write(29, 0);
  s.write(50, 2);
  s.write(59, 60);
  set_clock(s, {14, 1, 1, 0, 0, 0});
  s.advance(24h);
  expect_clock(s, {14, 1, 2, 0, 1, 0, 4});
  s.write(59, 0xFFC4);  // -60
  s.advance(24h);
  expect_clock(s, {14, 1, 3, 0, 0, 0, 5});
  s.save();
  s.restart();
  s.expect(59, 0xFFC4);
  s.write(50, 2);
  set_clock(s, {14, 1, 1, 0, 0, 0});  // the saved one is in force
  s.advance(24h);
  expect_clock(s, {14, 1, 1, 23, 59, 0, 3});
  s.write(59, 60);
  s.restart();  // not saved
  s.expect(59, 0xFFC4).write(50, 2);
  set_clock(s, {14, 1, 1, 0, 0, 0});
  s.advance(24h);
  expect_clock(s, {14, 1, 1, 23, 59, 0, 3});
  s.save(2);  // the factory's: 0
  s.expect(59, 0);
  set_clock(s, {14, 1, 1, 0, 0, 0});
  s.advance(24h);
  expect_clock(s, {14, 1, 2, 0, 0, 0, 4});
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_time_stamp_test
