// spec/me3can1-q/scenarios.md, section 10: flying master (S72 to S75).

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {
namespace {

void switch_on(Me3Scenario& s, std::uint8_t node, std::uint16_t level = 1) {
  s.plug_in().preset_buffer(27, node);
  s.plug_in().preset_object(0x1F80, 0, canopen::little_endian(0x21, 4));
  s.plug_in().preset_object(0x1F90, 3, canopen::little_endian(level, 2));
  s.supply_on().wait_tx(0x700U + node, {0x00});
}

TEST(Me3FlyingMaster, S72_NobodyThere_AsksResetsNegotiatesAndBecomesActive) {
  RecordProperty("spec", "ME3-FLY-009 ME3-FLY-013 ME3-HB-006");
  Me3Scenario s;
  switch_on(s, 1);
  s.expect_object(0x1017, 0, 1000, 2);
  s.ignore_tx().wait_tx(0x073);
  s.advance(99ms).no_tx().advance(1ms).tx(0x000, {0x82, 0x00}).tx(0x072).no_tx();
  const can::Time asked = s.now();
  s.expect_bit(25, 15, false).wait_tx(0x701, {0x7F});  // its heartbeat, 1 s after the boot-up
  const can::Time heartbeat = s.now();
  s.wait_tx(0x701, {0x7F});
  EXPECT_EQ(s.now() - heartbeat, 1000ms);
  s.wait_tx(0x071, {0x01, 0x01});
  EXPECT_EQ(s.now() - asked, 1510ms);
  s.tx(0x000, {0x82, 0x00}).expect_bit(25, 15, true);
  s.ignore_tx();

  Me3Scenario loser;  // 1016H is set by itself: 1500 + 10 x own node-ID
  switch_on(loser, 2);
  loser.ignore_tx().wait_tx(0x073).rx(0x071, {0x01, 0x01}).no_tx();
  loser.expect_bit(25, 15, false);
  loser.expect_object(0x1016, 1, 0x000105F0, 4);
  loser.ignore_tx();
}

TEST(Me3FlyingMaster, S73_ActiveMasterLost_NegotiatesResetsAndBecomesActive) {
  RecordProperty("spec", "ME3-FLY-007 ME3-FLY-010");
  Me3Scenario s;
  switch_on(s, 2);
  s.ignore_tx().wait_tx(0x073).rx(0x071, {0x01, 0x01});
  s.rx(0x701, {0x05});
  const can::Time heard = s.now();
  s.expect_object(0x1016, 1, 0x000105F0, 4);
  s.ignore_tx().wait_bit(401, 7, true);
  EXPECT_EQ(s.now() - heard, 1520ms);
  s.ignore_tx().wait_bit(25, 15, true);
  s.ignore_tx();
}

TEST(Me3FlyingMaster, S75_WaitingTimes) {
  RecordProperty("spec", "ME3-FLY-004");
  struct Row {
    std::uint16_t level;
    std::uint8_t node;
    can::Duration wait;
  };
  for (const Row& row : {Row{0, 1, 10ms}, Row{1, 1, 1510ms}, Row{1, 127, 2770ms}, Row{2, 127, 4270ms}}) {
    Me3Scenario s;
    switch_on(s, row.node, row.level);
    s.advance(600ms).ignore_tx().rx(0x072);
    const can::Time asked = s.now();
    s.wait_bit(25, 15, true);
    EXPECT_EQ(s.now() - asked, row.wait);
    s.ignore_tx();
  }
}

}  // namespace
}  // namespace canopus::scenario
