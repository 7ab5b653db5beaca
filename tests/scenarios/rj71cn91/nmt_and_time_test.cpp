// NMT states and the clock of the RJ71CN91 [RJ71CN91 1.2, 1.6, App. 2 G25, G50 to G59].

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::rj71cn91_nmt_and_time_test {
namespace {

constexpr auto stop = module::CpuState::stop;

TEST(Rj71Nmt, EveryPath_IsShown_InG25AndTheOwnWord) {
  RecordProperty("spec", "RJ71-NMT-006 RJ71-NMT-014");
  for (const std::uint8_t node : Bytes{3, 127}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(node);
    const auto expect_state = [&](std::uint16_t g25, std::uint16_t state) {
      s.expect(25, g25).expect(600U + node, state);
    };
    expect_state(0x0100, 0x7F);
    s.nmt(0x01, node);
    expect_state(0x0201, 0x05);
    s.nmt(0x80, node);
    expect_state(0x0100, 0x7F);
    s.nmt(0x02);
    expect_state(0x0000, 0x04);
    s.nmt(0x01);
    expect_state(0x0201, 0x05);
    s.nmt(0x02, node);
    expect_state(0x0000, 0x04);
    s.nmt(0x80);
    expect_state(0x0100, 0x7F);
    s.nmt(0x01, static_cast<std::uint8_t>(node - 1));  // another node's
    expect_state(0x0100, 0x7F);
    s.cpu(stop).ignore_tx();
    s.nmt(0x01, node);
    expect_state(0x0100, 0x7F);
    s.ignore_tx();
  }
}

TEST(Rj71Nmt, Reset_TakesObjectsBackToWhatIsStored) {
  RecordProperty("spec", "RJ71-NMT-015");
  for (const std::uint8_t reset : Bytes{0x81, 0x82}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(3);
    s.write(50, 3).y(0x12, true).y(0x12, false);
    s.set_object(0x1017, 0, 700, 2).store_objects();
    s.ignore_tx();
    s.write(50, 2).y(0x12, true).y(0x12, false);
    s.set_object(0x1017, 0, 800, 2).ignore_tx();
    s.nmt(reset, 3).advance(20ms).ignore_tx();
    s.expect_object(0x1012, 0, 0xC0000100, 4).expect_object(0x1017, 0, 700, 2).expect(50, 3);
    s.write(50, 2).y(0x12, true).expect_x(0x12, true).y(0x12, false);  // the program's way out
    s.expect_object(0x1012, 0, 0x40000100, 4).ignore_tx();
  }
}

TEST(Rj71Time, Clock_StandsAtItsDefault_IsRead_AndCountsSeconds) {
  RecordProperty("spec", "RJ71-TIME-005 RJ71-TIME-007 RJ71-TIME-009 RJ71-TIME-011");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  s.advance(1h).y(0x13, true).expect_x(0x13, true).expect(50, {1, 2014, 8, 1, 0, 0, 0, 5, 0, 0});
  s.y(0x13, false).expect_x(0x13, false);
  const auto set = [&s](const Words& words) {
    s.write(50, words).y(0x12, true).expect_x(0x12, true).y(0x12, false);
  };
  const auto expect_clock = [&s](const Words& words) {
    s.y(0x13, true).expect(51, words).y(0x13, false).expect(29, 0);
  };
  set({2, 2024, 2, 28, 23, 59, 59});
  s.advance(999ms);
  expect_clock({2024, 2, 28, 23, 59, 59, 3});
  s.advance(1ms);
  expect_clock({2024, 2, 29, 0, 0, 0, 4});
  set({2, 2023, 2, 28, 23, 59, 59});
  s.advance(1s);
  expect_clock({2023, 3, 1, 0, 0, 0, 3});
  set({2, 2024, 3, 31, 1, 59, 59});  // no daylight saving
  s.advance(1h);
  expect_clock({2024, 3, 31, 2, 59, 59, 0});
  s.write(51, 2030).expect(51, 2030).y(0x13, true).expect(51, 2024).y(0x13, false);
  s.ignore_tx().supply_off();
  s.power_on();
  s.expect(50, {1, 2014, 8, 1, 0, 0, 0, 5, 0, 0}).advance(100s).ignore_tx();
  expect_clock({2014, 8, 1, 0, 0, 0, 5});
}

TEST(Rj71Time, DailyCorrection_ActsAtOnce_AndIsSaved) {
  RecordProperty("spec", "RJ71-TIME-008");
  for (const int correction : {-60, 60, 7}) {
    IntelligentScenario s(rj71cn91);
    s.power_on();
    s.write(50, {2, 2024, 1, 1, 0, 0, 0}).y(0x12, true).y(0x12, false);
    s.advance(24h).write(59, static_cast<std::uint16_t>(correction)).advance(24h);
    const auto second = static_cast<std::uint16_t>((60 + correction) % 60);
    const bool is_early = correction < 0;
    s.y(0x13, true).expect(53, is_early ? 2 : 3).expect(56, second).y(0x13, false).ignore_tx();
    s.save().supply_off();
    s.power_on();
    s.expect(59, static_cast<std::uint16_t>(correction)).expect(29, 0);
  }
}

TEST(Rj71Layer2, Dlc_0To8_AndOnlyTheseBytes) {
  RecordProperty("spec", "RJ71-L2TX-010");
  for (std::uint16_t dlc = 0; dlc <= 8; ++dlc) {
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(11);
    s.write(6164, {0xFFFF, 0x5FFF, 4, 0}).write(10287, {0x123, 0, dlc, 0x0201, 0x0403, 0x0605, 0x0807});
    Bytes bytes{1, 2, 3, 4, 5, 6, 7, 8};
    bytes.resize(dlc);
    s.y(0x03, true).tx(0x123, bytes).no_tx().y(0x03, false);
    s.write(10289, 9).expect(29, 0x0040).expect(39, 10289).expect(10289, dlc);
  }
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_nmt_and_time_test
