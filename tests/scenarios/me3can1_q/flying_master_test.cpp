// spec/me3can1-q/scenarios.md, section 10: flying master (S72 to S75).

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_flying_master_test {
namespace {

CANOPUS_OF_BOTH_MODULES(FlyingMaster);

void switch_on(IntelligentScenario& s, std::uint8_t node, std::uint16_t level = 1) {
  s.plug_in().preset_word(27, node);
  s.plug_in().preset_object(0x1F80, 0, canopen::little_endian(0x21, 4));
  s.plug_in().preset_object(0x1F90, 3, canopen::little_endian(level, 2));
  s.supply_on().wait_tx(0x700U + node, {0x00});
}

TEST_P(FlyingMaster, S72_NobodyThere_AsksResetsNegotiatesAndBecomesActive) {
  spec("ME3-FLY-009 ME3-FLY-013 ME3-HB-006", "RJ71-FLY-005");
  IntelligentScenario s(GetParam());
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

  IntelligentScenario loser(GetParam());  // 1016H is set by itself: 1500 + 10 x own node-ID
  switch_on(loser, 2);
  loser.ignore_tx().wait_tx(0x073).rx(0x071, {0x01, 0x01}).no_tx();
  loser.expect_bit(25, 15, false);
  loser.expect_object(0x1016, 1, 0x000105F0, 4);
  loser.ignore_tx();
}

TEST_P(FlyingMaster, S73_ActiveMasterLost_NegotiatesResetsAndBecomesActive) {
  spec("ME3-FLY-007 ME3-FLY-010", "RJ71-FLY-003 RJ71-FLY-006");
  IntelligentScenario s(GetParam());
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

// What the program has set stays: 1017H other than 0, a 1016H entry for the active master.
TEST_P(FlyingMaster, AutomaticTimes_OnlyWhereNothingIsSet) {
  spec("ME3-FLY-009 ME3-FLY-010 ME3-HB-006", "RJ71-FLY-005 RJ71-FLY-006");
  IntelligentScenario s(GetParam());
  s.plug_in().preset_object(0x1017, 0, canopen::little_endian(300, 2));
  s.plug_in().preset_object(0x1016, 7, canopen::little_endian(0x00010BB8, 4));
  switch_on(s, 2);
  s.expect_object(0x1017, 0, 300, 2);
  s.advance(490ms).ignore_tx().wait_tx(0x073).rx(0x071, {0x01, 0x01}).wait_tx(0x702, {0x7F});
  const can::Time heartbeat = s.now();
  s.wait_tx(0x702, {0x7F});
  EXPECT_EQ(s.now() - heartbeat, 300ms);
  s.rx(0x701, {0x05});
  const can::Time heard = s.now();
  s.expect_object(0x1016, 1, 0, 4).expect_object(0x1016, 7, 0x00010BB8, 4);
  s.ignore_tx().wait_bit(401, 7, true);
  EXPECT_EQ(s.now() - heard, 3000ms);
  s.ignore_tx();
  // Not a flying master: neither.
  IntelligentScenario plain(GetParam());
  plain.power_on_as(2);
  plain.rx(0x071, {0x01, 0x01}).rx(0x701, {0x05}).advance(60s).no_tx().expect(401, 0);
  plain.expect_object(0x1017, 0, 0, 2).expect_object(0x1016, 1, 0, 4);
}

TEST_P(FlyingMaster, S75_WaitingTimes) {
  spec("ME3-FLY-004", "RJ71-FLY-004");
  struct Row {
    std::uint16_t level;
    std::uint8_t node;
    can::Duration wait;
  };
  for (const Row& row : {Row{0, 1, 10ms}, Row{1, 1, 1510ms}, Row{1, 127, 2770ms}, Row{2, 127, 4270ms}}) {
    IntelligentScenario s(GetParam());
    switch_on(s, row.node, row.level);
    s.advance(600ms).ignore_tx().rx(0x072);
    const can::Time asked = s.now();
    s.wait_bit(25, 15, true);
    EXPECT_EQ(s.now() - asked, row.wait);
    s.ignore_tx();
  }
}

TEST_P(FlyingMaster, Bit5_TakesPart_AndTheLoserIsASlave) {
  spec("ME3-MST-006", "RJ71-STARTUP-003");
  IntelligentScenario s(GetParam());
  switch_on(s, 2);
  s.advance(499ms).no_tx().advance(1ms).tx(0x073).no_tx();  // no start-up before the negotiation
  s.rx(0x071, {0x01, 0x01}).no_tx().expect_bit(25, 15, false);
  s.rx(0x000, {0x01, 0x00}).expect_bit(25, 0, true);  // a slave obeys commands to all nodes
  s.rx(0x000, {0x80, 0x02}).expect_bit(25, 0, false);
  s.ignore_tx();

  IntelligentScenario plain(GetParam());  // bit 5 clear: master at once, and deaf to what flying masters say
  plain.plug_in().preset_word(27, 2);
  plain.plug_in().preset_object(0x1F80, 0, canopen::little_endian(0x01, 4));
  plain.supply_on().wait_tx(0x702, {0x00}).tx(0x000, {0x82, 0x00}).expect_bit(25, 15, true);
  plain.rx(0x071, {0x00, 0x01}).rx(0x076).rx(0x073).advance(1s).no_tx().expect_bit(25, 15, true);
}

TEST_P(FlyingMaster, PriorityLevels_0To2_ReservedOnesAreRefused) {
  spec("ME3-FLY-002", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.expect_object(0x1F90, 3, 1, 2);
  for (const std::uint16_t level : Words{0, 1, 2}) {
    s.set_object(0x1F90, 3, level, 2);
    s.expect_object(0x1F90, 3, level, 2);
  }
  for (const std::uint16_t level : Words{3, 4, 0x7F, 0xFF}) {
    s.cif({0x0002, 0, 0x1F90, 3, 2, level});
    s.expect_abort(0x06090030);
    s.expect_object(0x1F90, 3, 2, 2);
  }
  for (const std::uint16_t level : Words{0, 1, 2}) {  // 0 is the first to claim, 2 the last
    IntelligentScenario t(GetParam());
    switch_on(t, 1, level);
    t.advance(600ms).ignore_tx().rx(0x072);
    const can::Time asked = t.now();
    t.wait_bit(25, 15, true);
    EXPECT_EQ(t.now() - asked, 1500ms * level + 10ms);
    while (t.controller().sent.front().identifier == 0x701) t.controller().sent.pop_front();  // heartbeats
    t.tx(0x071, {static_cast<std::uint8_t>(level), 0x01});
    t.ignore_tx();
  }
}

TEST_P(FlyingMaster, HigherLevelWins_ThenTheLowerNodeId) {
  spec("ME3-FLY-003", "RJ71-FLY-002");
  struct Row {
    std::uint16_t level;
    std::uint8_t node;
    std::uint8_t other_level, other_node;
    bool stands_by;
  };
  for (const Row& row :
       {Row{1, 5, 0, 127, true}, Row{1, 5, 2, 1, false}, Row{1, 5, 1, 4, true}, Row{1, 5, 1, 6, false},
        Row{0, 127, 1, 1, false}, Row{2, 1, 1, 127, true}, Row{0, 2, 0, 1, true}, Row{0, 1, 0, 2, false}}) {
    IntelligentScenario s(GetParam());
    switch_on(s, row.node, row.level);
    s.ignore_tx().wait_tx(0x073).rx(0x071, {row.other_level, row.other_node});
    if (row.stands_by) {
      s.no_tx().advance(1s).expect_bit(25, 15, false).ignore_tx();
    } else {
      s.tx(0x076).tx(0x072).no_tx().wait_bit(25, 15, true).ignore_tx();
    }
  }
}

TEST_P(FlyingMaster, PrioritySlot_IsLongerThanAllDeviceSlotsTogether) {
  spec("ME3-FLY-005", "RJ71-FLY-004");
  IntelligentScenario s(GetParam());
  s.power_on_as(127);
  s.expect_object(0x1F90, 4, 1500, 2).expect_object(0x1F90, 5, 10, 2);
  s.ignore_tx();
  const auto waits = [](std::uint8_t node, std::uint16_t level, std::uint16_t slot) {
    IntelligentScenario t(GetParam());
    t.plug_in().preset_object(0x1F90, 4, canopen::little_endian(slot, 2));
    switch_on(t, node, level);
    t.advance(600ms).ignore_tx().rx(0x072);
    const can::Time asked = t.now();
    t.wait_bit(25, 15, true).ignore_tx();
    return t.now() - asked;
  };
  // The last node of a level before the first of the next one.
  EXPECT_EQ(waits(127, 0, 1500), 1270ms);
  EXPECT_EQ(waits(1, 1, 1500), 1510ms);
  // Against the rule, which the module leaves to the user, the lower level would claim first.
  EXPECT_EQ(waits(1, 1, 1000), 1010ms);
}

TEST_P(FlyingMaster, Negotiation_ResetsAllNodes_AlsoThoseThatAreToBeKeptAlive) {
  spec("ME3-FLY-006", "");
  IntelligentScenario s(GetParam());
  s.plug_in().preset_object(0x1F81, 2, canopen::little_endian(0x1D, 4));
  switch_on(s, 1);
  s.ignore_tx().wait_tx(0x073).advance(100ms).tx(0x000, {0x82, 0x00}).tx(0x072).no_tx();
  s.advance(990ms).ignore_tx().rx(0x702, {0x05}).advance(520ms);
  s.ignore_tx().expect_bit(25, 15, true);
  s.advance(1s).ignore_tx();
  s.rx(0x702, {0x05}).ignore_tx();
  s.rx(0x076).tx(0x602, {0x80, 0x00, 0x10, 0x00, 0x00, 0x00, 0x00, 0x08});  // forced: its boot is given up
  s.tx(0x072).no_tx();
  const can::Time asked = s.now();
  s.expect_bit(25, 15, false).wait_bit(25, 15, true);
  EXPECT_EQ(s.now() - asked, 1510ms);
  unsigned resets = 0;
  for (const can::Frame& frame : s.controller().sent) {
    if (frame.identifier == 0) {
      EXPECT_EQ(text(frame), "000 [82 00]");  // none singly
      ++resets;
    }
  }
  EXPECT_EQ(resets, 1U);
  s.ignore_tx();
}

TEST_P(FlyingMaster, S74_BetterMasterJoins_NegotiatesAndWins) {
  spec("ME3-FLY-008", "");
  IntelligentScenario joining(GetParam());  // node 3, high
  switch_on(joining, 3, 0);
  joining.advance(500ms).tx(0x073).rx(0x071, {0x01, 0x01}).tx(0x076).tx(0x072).no_tx();
  const can::Time asked = joining.now();
  joining.rx(0x072);  // the active master's
  joining.wait_tx(0x071, {0x00, 0x03});
  EXPECT_EQ(joining.now() - asked, 30ms);
  joining.tx(0x000, {0x82, 0x00}).expect_bit(25, 15, true).ignore_tx();

  IntelligentScenario active(GetParam());  // node 1, medium, its opponent
  switch_on(active, 1);
  active.wait_bit(25, 15, true).advance(1s).ignore_tx();
  active.rx(0x073).tx(0x071, {0x01, 0x01}).no_tx();
  active.rx(0x076).tx(0x072).no_tx().expect_bit(25, 15, false);
  active.rx(0x072).advance(30ms).no_tx();
  active.rx(0x071, {0x00, 0x03}).no_tx();
  active.rx(0x000, {0x82, 0x00}).wait_tx(0x701, {0x00});  // and is reset as a slave
  active.wait_tx(0x073).rx(0x071, {0x00, 0x03}).expect_bit(25, 15, false);
  active.advance(1s).expect_bit(25, 15, false).ignore_tx();
  active.expect_object(0x1016, 1, 0x000305E6, 4);
  active.ignore_tx();

  IntelligentScenario worse(GetParam());  // a low one that joins leaves the active master alone
  switch_on(worse, 9, 2);
  worse.advance(500ms).tx(0x073).rx(0x071, {0x01, 0x01}).no_tx().advance(1s).expect_bit(25, 15, false);
  worse.ignore_tx();
}

TEST_P(FlyingMaster, DifferentConsumerTimes_TheFirstResetsTheNetwork_TheSecondDoesNot) {
  spec("ME3-FLY-011", "");
  for (const std::uint8_t reset_by_other : Bytes{0x82, 0x81, 0}) {
    IntelligentScenario s(GetParam());  // node 3, consumer time 1530 ms; node 2's is 1520 ms
    switch_on(s, 3);
    s.ignore_tx().wait_tx(0x073).rx(0x071, {0x01, 0x01}).rx(0x701, {0x05});
    const can::Time heard = s.now();
    s.advance(1520ms).ignore_tx();
    if (reset_by_other != 0) s.rx(0x000, {reset_by_other, 0x00});
    s.advance(9ms).ignore_tx();
    s.advance(1ms);
    unsigned resets = 0;
    for (const can::Frame& frame : s.controller().sent) resets += frame.identifier == 0 ? 1U : 0U;
    EXPECT_EQ(s.now() - heard, 1530ms);
    EXPECT_EQ(resets, reset_by_other != 0 ? 0U : 1U);
    s.ignore_tx().advance(600ms).ignore_tx();
  }
}

TEST_P(FlyingMaster, ForeignMasterWithoutHeartbeat_LeadsToEndlessResets) {
  spec("ME3-FLY-012", "RJ71-FLY-007");
  IntelligentScenario s(GetParam());
  switch_on(s, 2);
  s.ignore_tx().wait_tx(0x073);
  for (int again = 0; again < 20; ++again) {
    s.rx(0x071, {0x00, 0x05});
    const can::Time answered = s.now();
    for (;;) {  // its own heartbeats apart
      s.ignore_tx().advance(1ms);
      if (!s.controller().sent.empty() && s.controller().sent.back().identifier == 0) break;
      ASSERT_LT(s.now() - answered, 3s);
    }
    EXPECT_EQ(s.now() - answered, 1520ms);
    EXPECT_EQ(text(s.controller().sent.back()), "000 [82 00]");
    s.ignore_tx().advance(499ms).ignore_tx().advance(1ms).tx(0x073);
  }
  s.ignore_tx();
}

TEST(Me3FlyingMaster, Standby_LeavesTheMastersServicesAlone_UntilItWins) {
  RecordProperty("spec", "ME3-FLY-014");
  IntelligentScenario s;
  s.plug_in().preset_object(0x1F81, 9, canopen::little_endian(0x00640301, 4));
  s.plug_in().preset_object(0x1005, 0, canopen::little_endian(0x40000080, 4));
  s.plug_in().preset_object(0x1006, 0, canopen::little_endian(10'000, 4));
  switch_on(s, 2);
  s.ignore_tx().wait_tx(0x073).rx(0x071, {0x01, 0x01}).rx(0x701, {0x05}).ignore_tx();
  s.rx(0x000, {0x01, 0x02}).expect_bit(25, 0, true);
  s.write(50, {2, 14, 10, 15, 12, 30, 0}).write(58, 1).y(0x12, true);  // time producer
  s.y(0x12, false).no_tx();
  s.cif({0x0002, 0, 0x1F82, 9, 1, 5});
  s.expect_abort(0x08000022);
  s.cif({0x0002, 0, 0x1F83, 9, 1, 1});
  s.expect_abort(0x08000022);
  s.rx(0x709, {0x00});
  for (int second = 0; second < 10; ++second) {
    s.rx(0x701, {0x05}).advance(1s);
    for (const can::Frame& frame : s.controller().sent)
      EXPECT_EQ(frame.identifier, 0x702U);  // heartbeats alone
    s.ignore_tx();
  }
  s.wait_bit(25, 15, true).advance(1s).ignore_tx();  // it wins
  s.wait_tx(0x080);
  s.write(51, {14, 8, 1, 0, 0, 0}).ignore_tx();
  s.y(0x12, true).y(0x12, false).tx(0x100, {0x00, 0x00, 0x00, 0x00, 0xA2, 0x2B});
  s.ignore_tx().rx(0x709, {0x00}).tx_remote(0x709);
  s.cif({0x0002, 0, 0x1F82, 9, 1, 5});
  s.expect(1000, 0x0003).ignore_tx();
  // A better one forces a negotiation, and wins: no SYNC, no remote frame any more.
  s.rx(0x076).rx(0x072).rx(0x071, {0x00, 0x01}).expect_bit(25, 15, false).ignore_tx();
  s.advance(100ms).no_tx().rx(0x000, {0x82, 0x00}).ignore_tx().advance(700ms).ignore_tx();
  s.rx(0x071, {0x00, 0x01}).rx(0x701, {0x05}).ignore_tx();
  for (int second = 0; second < 5; ++second) {
    s.rx(0x701, {0x05}).advance(1s);
    for (const can::Frame& frame : s.controller().sent) {
      EXPECT_TRUE(frame.identifier == 0x702U || frame.identifier == 0x073U) << text(frame);
    }
    s.ignore_tx();
  }
  s.expect_bit(25, 15, false);
}

TEST_P(FlyingMaster, ActiveMaster_LooksForASecondOne_EveryDetectCycle) {
  spec("ME3-FLY-015", "");
  IntelligentScenario s(GetParam());
  switch_on(s, 7);
  s.wait_bit(25, 15, true, 60s).ignore_tx();
  const can::Time won = s.now();
  s.expect_object(0x1F90, 6, 4070, 2);
  for (int cycle = 1; cycle <= 3; ++cycle) {
    for (;;) {
      s.ignore_tx().advance(1ms);
      if (!s.controller().sent.empty() && s.controller().sent.front().identifier == 0x076) break;
      ASSERT_LT(s.now() - won, 60s);
    }
    EXPECT_EQ(s.now() - won, 4070ms * cycle);
  }
  s.ignore_tx().expect_bit(25, 15, true);           // nobody: nothing happens
  s.rx(0x076).tx(0x072).expect_bit(25, 15, false);  // it is the second one itself
  s.wait_bit(25, 15, true).ignore_tx();
}

TEST_P(FlyingMaster, ApplicationData_AreNotMirrored) {
  spec("ME3-FLY-016", "");
  IntelligentScenario s(GetParam());
  switch_on(s, 2);
  s.ignore_tx().wait_tx(0x073).rx(0x071, {0x01, 0x01}).rx(0x701, {0x05}).ignore_tx();
  s.rx(0x000, {0x01, 0x02}).write(13000, 0x2222);
  s.y(0x01, true).advance(100ms).y(0x01, false);
  s.rx(0x181, {0x11, 0x11, 0, 0, 0, 0, 0, 0}).rx(0x701, {0x05});  // the active master's outputs
  s.y(0x01, true).advance(100ms).y(0x01, false);
  s.expect(13000, 0x2222).expect(10000, 0);
  s.ignore_tx().wait_bit(25, 15, true).advance(1s).ignore_tx();
  s.y(0x01, true).advance(100ms).y(0x01, false);
  s.expect(13000, 0x2222).expect(10000, 0).ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_flying_master_test
