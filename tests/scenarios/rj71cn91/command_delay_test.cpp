// G70: what lies between the NMT commands of the start-up [RJ71CN91 1.2 NMT start-up, App. 2 G70].

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_command_delay_test {
namespace {

using namespace rj71cn91_presets;

constexpr std::uint32_t optional = 0x05;  // 1F81H: NMT slave and boot slave
constexpr std::uint32_t kept = 0x15;      // and not to be reset while it is Operational

TEST(Rj71CommandDelay, G70_LiesBeforeEveryReset_AndEveryStart) {
  RecordProperty("spec", "RJ71-STARTUP-006 RJ71-STARTUP-010 RJ71-STARTUP-013");
  for (const std::uint16_t delay : Words{0, 1, 500, 3000, 65535}) {
    const can::Duration pause = std::chrono::milliseconds(delay);
    IntelligentScenario s(rj71cn91);
    start_with_delay(s, delay, 1,
                     {{0x1F80, 0, 1}, {0x1F81, 5, optional}, {0x1F81, 6, optional}, {0x1F81, 127, optional}});
    s.expect(70, delay).tx(0x000, {0x82, 0x00});
    can::Time last = s.now();
    const auto expect_start = [&](std::uint8_t node) {
      if (pause > 1ms) s.advance(last + pause - 1ms - s.now()).no_tx().expect(600U + node, 0x7F);
      s.expect_bit(25, 14, pause > 0ms || node != 127);
      s.wait_tx(0x000, {0x01, node}, 70s);
      EXPECT_EQ(s.now() - last, pause);
      last = s.now();
      s.expect(600U + node, 0x05);
    };
    boots(s, 5);
    if (delay == 0) expect_start(5);
    boots(s, 6);
    if (delay == 0) expect_start(6);
    boots(s, 127);
    for (const std::uint8_t node : delay == 0 ? Bytes{127} : Bytes{5, 6, 127}) expect_start(node);
    s.expect_bit(25, 14, false).expect(601, 0x05).advance(100s).no_tx();
  }
}

TEST(Rj71CommandDelay, SlavesOfOneByOneResets_AreBootedWhenAllWereReset) {
  RecordProperty("spec", "RJ71-STARTUP-006 RJ71-STARTUP-005");
  IntelligentScenario s(rj71cn91);
  start_with_delay(s, 500, 2,
                   {{0x1F80, 0, 1},
                    {0x1F81, 1, optional},
                    {0x1F81, 6, kept},
                    {0x1F81, 7, optional | 0x08},
                    {0x1F81, 9, 0x14},  // not assigned
                    {0x1F81, 127, optional},
                    {0x1F89, 0, 2500}});
  s.tx(0x000, {0x82, 0x01}).expect_bit(25, 14, true).expect_bit(25, 15, true);
  s.rx(0x701, {0x00}).advance(499ms).no_tx().advance(1ms).tx(0x000, {0x82, 0x07}).no_tx();
  s.advance(499ms).no_tx().advance(1ms).tx(0x000, {0x82, 0x7F});  // no other node: 6 is kept, 9 is no slave
  // Now the boots: of 1, whose boot-up message came, and of 6; 7 and 127 have a second for theirs.
  s.tx(0x601, ask_1000).tx(0x606, ask_1000).no_tx();
  s.rx(0x77F, {0x00}).tx(0x67F, ask_1000).no_tx();
  s.rx(0x586, is_0191).tx_remote(0x706).rx(0x706, {0x05}).rx(0x581, is_0191).rx(0x5FF, is_0191).no_tx();
  s.advance(499ms).no_tx().advance(1ms).tx(0x000, {0x01, 0x01}).no_tx();
  s.advance(499ms).no_tx();  // 7 is asked after its second, 127 is started G70 after 1
  s.advance(1ms);
  std::vector<std::uint32_t> identifiers;
  for (const can::Frame& frame : s.controller().sent) identifiers.push_back(frame.identifier);
  std::ranges::sort(identifiers);
  EXPECT_EQ(identifiers, (std::vector<std::uint32_t>{0x000, 0x607}));
  s.ignore_tx().expect(601, 0x05).expect(606, 0x05).expect(727, 0x05);
  // 1F89H counts from the start of the boots: 2.5 s after the last reset.
  s.advance(1499ms).ignore_tx().expect_bit(25, 11, false).advance(1ms).ignore_tx().expect_bit(25, 11, true);
}

TEST(Rj71CommandDelay, AFoundOrLostSlave_IsStartedG70AfterTheLastCommand) {
  RecordProperty("spec", "RJ71-STARTUP-006 RJ71-ERREV-006");
  IntelligentScenario s(rj71cn91);
  start_with_delay(s, 400, 1, {{0x1F80, 0, 1}, {0x1F81, 5, optional}, {0x1016, 1, 0x000501F4}});
  s.tx(0x000, {0x82, 0x00}).advance(9700ms).ignore_tx();  // between two questions for 1000H
  s.rx(0x705, {0x00}).tx(0x605, ask_1000).rx(0x585, is_0191).rx(0x705, {0x7F});
  s.tx(0x000, {0x01, 0x05}).no_tx();  // the reset is long ago
  s.rx(0x705, {0x05}).advance(500ms);
  expect_node_lost(s, 1, 5);
  s.tx(0x000, {0x82, 0x05}).no_tx();  // at once
  s.rx(0x705, {0x00}).tx(0x605, ask_1000).rx(0x585, is_0191).rx(0x705, {0x7F});
  s.advance(399ms).no_tx().expect(605, 0x7F).expect_bit(25, 14, true);
  s.advance(1ms).tx(0x000, {0x01, 0x05}).no_tx().expect_bit(25, 14, false);
}

TEST(Rj71CommandDelay, AProgramsCommand_GoesAtOnce_AndTakesTheStartsPlace) {
  RecordProperty("spec", "RJ71-STARTUP-006 RJ71-NODECTL-002 RJ71-NODECTL-003");
  const auto request = [](IntelligentScenario& s, std::uint16_t node, std::uint16_t value) {
    s.cif({0x0002, 0, 0x1F82, node, 1, value}).expect(1000, 0x0003);
  };
  IntelligentScenario s(rj71cn91);
  start_with_delay(s, 1000, 1,
                   {{0x1F80, 0, 1}, {0x1F81, 5, optional}, {0x1F81, 6, optional}, {0x1F81, 7, optional}});
  s.tx(0x000, {0x82, 0x00});
  for (const std::uint8_t node : Bytes{5, 6, 7}) boots(s, node);
  s.advance(100ms).no_tx();
  request(s, 5, 0x7F);
  s.tx(0x000, {0x80, 0x05}).no_tx().expect(605, 0x7F);
  const can::Time last = s.now();
  request(s, 7, 0x05);
  s.tx(0x000, {0x01, 0x07}).no_tx().expect(607, 0x05).expect(606, 0x7F);
  s.wait_tx(0x000, {0x01, 0x06});  // 5 is the program's now, 7 is started
  EXPECT_GE(s.now() - last, 1s);
  s.expect_bit(25, 14, false).advance(100s).no_tx();
  s.expect(605, 0x7F).expect(606, 0x05).expect(607, 0x05);
}

TEST(Rj71CommandDelay, G70_CountsAsItIsWritten) {
  RecordProperty("spec", "RJ71-BM-022 RJ71-STARTUP-006");
  IntelligentScenario s(rj71cn91);
  start_with_delay(s, 60000, 1, {{0x1F80, 0, 1}, {0x1F81, 5, optional}});
  s.tx(0x000, {0x82, 0x00});
  const can::Time reset = s.now();
  boots(s, 5);
  s.advance(1s).no_tx().write(70, 2000).no_tx().wait_tx(0x000, {0x01, 0x05}, 60s).no_tx();
  EXPECT_EQ(s.now() - reset, 2s);
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_command_delay_test
