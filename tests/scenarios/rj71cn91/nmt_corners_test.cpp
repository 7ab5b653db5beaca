// Corners of NMT that both manuals print: every way into Pre-operational, requests to all nodes and to the master itself,
// boot-ups of strangers, times of flying masters, node guarding.

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_nmt_corners_test {
namespace {

using namespace rj71cn91_presets;

CANOPUS_OF_BOTH_MODULES(NmtCorners);

constexpr unsigned start_up_runs = 14;  // bit of G25

/// Of the NMT commands to all or one that went by.
std::vector<std::string> commands_sent(IntelligentScenario& s) {
  std::vector<std::string> commands;
  for (const can::Frame& frame : s.controller().sent) {
    if (frame.identifier == 0) commands.push_back(text(frame));
  }
  return commands;
}

TEST_P(NmtCorners, EveryWayIntoPreOperational_EndsWithOneBootUpMessage) {
  spec("ME3-STAT-001", "RJ71-NMT-001");
  const auto arrives = [](IntelligentScenario& s) {
    s.expect_bit(25, 7, true).wait_tx(0x705, {0x00}).no_tx().y(0x02, false);  // left ON it starts again
    s.expect_bit(25, 7, false).expect_bit(25, 8, true).expect_bit(25, 9, false).expect_bit(25, 0, false);
    s.expect(605, 0x7F).advance(10s).no_tx();
  };
  IntelligentScenario s(GetParam());
  s.power_on_as(5);
  s.supply_off().advance(1s).supply_on();
  arrives(s);
  s.y(0x02, true).tx(0x085, {0x00, 0x62, 0x01, 0x4D, 0x45, 0x30, 0x30, 0x34});
  arrives(s);
  for (const std::uint8_t to : Bytes{5, 0}) {
    for (const std::uint8_t command : Bytes{0x81, 0x82}) {
      for (const std::uint8_t from : Bytes{0x80, 0x01, 0x02}) {
        s.nmt(from, to).nmt(command, to);
        arrives(s);
      }
    }
  }
}

TEST_P(NmtCorners, RequestNmtToAllNodes_MeansTheMasterToo) {
  spec("ME3-RQN-001",
       "RJ71-NODECTL-001 RJ71-NODECTL-002 RJ71-NODECTL-003 RJ71-NODECTL-004 RJ71-NODECTL-005 "
       "RJ71-NODECTL-010");
  IntelligentScenario s(GetParam());
  s.power_on_as_master();
  const std::map<std::uint16_t, Bytes> stays{
      {0x05, {0x01, 0x00}}, {0x04, {0x02, 0x00}}, {0x7F, {0x80, 0x00}}};
  for (const auto& [request, command] : stays) {
    s.set_object(0x1F82, 0x80, request, 1);
    s.tx(0x000, command).no_tx().expect(601, request).expect_bit(25, 15, true);
  }
  for (const auto& [request, command] :
       std::map<std::uint16_t, Bytes>{{0x06, {0x81, 0x00}}, {0x07, {0x82, 0x00}}}) {
    s.write(1000, {0x0002, 0, 0x1F82, 0x80, 1, request}).y(0x17, true).advance(1ms).tx(0x000, command);
    s.expect_bit(25, 7, true)
        .y(0x17, false)
        .wait_tx(0x701, {0x00})
        .tx(0x000, {0x82, 0x00})
        .advance(2s)
        .ignore_tx();
  }
}

TEST_P(NmtCorners, NodeReset_BringsThePowerOnValuesBack_CommunicationResetThoseOfTheCommunicationArea) {
  spec("ME3-RQN-001", "RJ71-NODECTL-004 RJ71-NODECTL-005");
  for (const std::uint8_t request : Bytes{0x06, 0x07}) {
    IntelligentScenario s(GetParam());
    s.power_on_as_master();
    s.set_object(0x1017, 0, 700, 2).store_objects();
    s.set_object(0x1017, 0, 300, 2);
    s.set_object(0x1015, 0, 50, 2);
    s.set_object(0xA580, 1, 0x1234, 2);
    s.ignore_tx();
    s.write(1000, {0x0002, 0, 0x1F82, 1, 1, request}).y(0x17, true).advance(1ms).y(0x17, false);
    s.wait_bit(25, 7, false).advance(100ms).ignore_tx();
    s.expect_object(0x1017, 0, 700, 2).expect_object(0x1015, 0, 0, 2);
    s.expect_object(0xA580, 1, request == 0x06 ? 0 : 0x1234, 2);
    s.ignore_tx();
  }
}

TEST_P(NmtCorners, RequestExcludingTheMaster_ToTheMasterItself_ChangesNothing) {
  spec("ME3-RQN-003", "RJ71-NODECTL-006");
  IntelligentScenario s(GetParam());
  s.power_on_as_master();
  for (const std::uint16_t state : Words{0x05, 0x7F}) {
    s.set_object(0x1F82, 1, state, 1).ignore_tx().expect(601, state);
    for (const std::uint16_t request : Words{0x84, 0x85, 0x86, 0x87, 0x8F}) {
      s.cif({0x0002, 0, 0x1F82, 1, 1, request}).expect(1000, 0x0003).no_tx();
      s.expect(601, state).expect_bit(25, 7, false).expect_bit(25, 15, true);
    }
  }
}

TEST(Rj71NmtCorners, StateOfACommandedNode_IsUnknownToWhoIsNotTheMaster) {
  RecordProperty("spec", "RJ71-NODECTL-009 RJ71-NODECTL-011");
  IntelligentScenario s(rj71cn91);
  start_as(s, 2, {});
  for (const std::uint16_t request : Words{0x04, 0x05, 0x7F, 0x06, 0x07}) {
    s.set_object(0x1F82, 9, request, 1).ignore_tx();
    s.expect_object(0x1F82, 9, 0x00, 1).expect(609, 0);
  }
  // Of one that it hears it is known.
  s.set_object(0x1016, 1, 0x000905DC, 4).rx(0x709, {0x04});
  s.expect_object(0x1F82, 9, 0x04, 1);
}

TEST_P(NmtCorners, StartUpBit_AlsoWhileASlaveIsRestartedAfterAnError) {
  spec("ME3-STAT-010", "RJ71-STARTUP-013");
  IntelligentScenario s(GetParam());
  start_as(s, 1, {{0x1F80, 0, 1}, {0x1F81, 2, 0x05}, {0x1016, 1, 0x000203E8}});
  s.tx(0x000, {0x82, 0x00}).expect_bit(25, start_up_runs, true);
  boots(s, 2);
  s.rx(0x702, {0x05}).ignore_tx().expect_bit(25, start_up_runs, false).expect(602, 5);
  s.rx(0x702, {0x05}).advance(999ms).no_tx().expect_bit(25, start_up_runs, false);
  s.advance(1ms).ignore_tx();  // lost: reset communication
  s.rx(0x702, {0x00});
  if (!is_rj71cn91()) s.tx(0x081, no_error);
  s.tx(0x602, ask_1000).no_tx().expect_bit(25, start_up_runs, true);
  s.rx(0x582, is_0191).ignore_tx().rx(0x702, {0x05}).ignore_tx();
  s.expect_bit(25, start_up_runs, false).expect(602, 5);
}

TEST_P(NmtCorners, BootUpOfANodeThatIsNotAssigned_IsNotFollowed) {
  spec("ME3-SLV-014", "RJ71-BOOTUP-002");
  for (const std::uint32_t assignment : {0x00U, 0x04U, 0x0CU}) {  // whatever the other bits say
    IntelligentScenario s(GetParam());
    start_as(s, 1, {{0x1F80, 0, 1}, {0x1F81, 9, assignment}});
    s.tx(0x000, {0x82, 0x00}).advance(1s).no_tx().expect_bit(25, start_up_runs, false);
    s.rx(0x709, {0x00}).advance(60s).no_tx().expect_bit(25, start_up_runs, false).expect(409, 0);
  }
}

TEST_P(NmtCorners, ConsumerHeartbeatOfAStandbyMaster_FollowsItsOwnNodeId) {
  spec("ME3-FLY-010", "RJ71-FLY-006");
  for (const std::uint8_t node : Bytes{3, 100, 127}) {
    IntelligentScenario s(GetParam());
    start_as(s, node, {{0x1F80, 0, 0x21}});
    s.wait_tx(0x073).rx(0x071, {0x01, 0x01}).rx(0x701, {0x05});
    const can::Time heard = s.now();
    const std::uint32_t time = 1500U + 10U * node;
    s.expect_object(0x1016, 1, 0x00010000U | time, 4).ignore_tx().wait_bit(401, 7, true);
    EXPECT_EQ(s.now() - heard, std::chrono::milliseconds(time));
    s.ignore_tx();
  }
}

TEST_P(NmtCorners, FlyingMasterTimes_TakeWritesOfTwoBytes_AndAreStored) {
  spec("ME3-FLY-001", "RJ71-FLY-009");
  for (const std::uint8_t node : Bytes{1, 127}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(node);
    const Words defaults{100, 500, 1, 1500, 10, static_cast<std::uint16_t>(4000 + 10 * node)};
    for (std::uint8_t sub = 1; sub <= 6; ++sub) {
      s.expect_object(0x1F90, sub, defaults[sub - 1U], 2);
      const auto value = static_cast<std::uint16_t>(sub == 3 ? 2 : 1500 + sub);
      s.set_object(0x1F90, sub, value, 2);
      s.cif({0x0002, 0, 0x1F90, sub, 4, 1, 0});
      s.expect_abort(0x06070012);
    }
    s.store_objects().restart();
    for (std::uint8_t sub = 1; sub <= 6; ++sub) s.expect_object(0x1F90, sub, sub == 3 ? 2U : 1500U + sub, 2);
    s.ignore_tx();
  }
}

// [ME3CAN1-Q 4.8.10; RJ71CN91 1.2] The response waits have to follow the priorities; else the higher priority claims after
// the lower one, denies it, and the negotiation never ends.
TEST_P(NmtCorners, ResponseWaitsInTheWrongOrder_TheNegotiationIsEndless) {
  spec("ME3-FLY-017", "RJ71-FLY-004");
  IntelligentScenario s(GetParam());  // priority 0, but it waits longer than the other one, of priority 1
  start_as(s, 2, {{0x1F80, 0, 0x21}, {0x1F90, 3, 0, 2}, {0x1F90, 5, 2000, 2}});
  s.ignore_tx();
  unsigned claims = 0;
  for (int round = 0; round < 5; ++round) {
    s.rx(0x072).advance(1510ms).rx(0x071, {0x01, 0x01});  // the other one comes first
    s.ignore_tx().advance(100ms);
    for (const std::string& command : commands_sent(s)) claims += command == "000 [82 00]" ? 1U : 0U;
    s.ignore_tx().expect_bit(25, 15, false);
  }
  EXPECT_LE(claims, 5U);
  s.ignore_tx();
}

// [RJ71CN91 1.8 note 1]
TEST(Rj71NmtCorners, GuardedNode_ThatNobodyHasCommanded_IsExpectedInItsFirstState) {
  RecordProperty("spec", "RJ71-NG-003");
  for (const bool boots_up : {false, true}) {
    for (const std::uint8_t first : Bytes{0x7F, 0x05, 0x04}) {
      IntelligentScenario s(rj71cn91);
      start_as(s, 1, {{0x1F80, 0, 9}});
      s.tx(0x000, {0x82, 0x00}).advance(5s).no_tx();
      if (boots_up) s.rx(0x702, {0x00});
      s.set_object(0x1F81, 2, 0x00640301, 4);
      if (s.controller().sent.empty()) s.set_object(0x1F83, 2, 1, 1);
      s.tx_remote(0x702).rx(0x702, {first}).expect(402, 0x0001);
      s.advance(100ms).tx_remote(0x702).rx(0x702, {static_cast<std::uint8_t>(0x80 | first)}).no_tx();
      s.expect(402, 0x0001).expect(602, first);
      s.advance(100ms).tx_remote(0x702).rx(0x702, {static_cast<std::uint8_t>(first == 0x05 ? 0x7F : 0x05)});
      s.expect_bit(402, 5, true).expect_x(0x10, true).ignore_tx();
    }
  }
}

TEST(Rj71NmtCorners, GuardedNode_CommandedBefore_IsExpectedInTheCommandedState) {
  RecordProperty("spec", "RJ71-NG-003");
  IntelligentScenario s(rj71cn91);
  start_as(s, 1, {{0x1F80, 0, 9}});
  s.tx(0x000, {0x82, 0x00}).rx(0x702, {0x00}).advance(1s).no_tx();
  s.set_object(0x1F82, 2, 0x04, 1).tx(0x000, {0x02, 0x02}).advance(1s).no_tx();
  s.set_object(0x1F81, 2, 0x00640301, 4);
  s.tx_remote(0x702).rx(0x702, {0x05}).expect_bit(402, 5, true).expect_x(0x10, true).ignore_tx();
}

TEST_P(NmtCorners, GuardingOfANodeWithoutASetUp_IsNotStarted) {
  spec("ME3-NG-009", "RJ71-NG-004");
  for (const std::uint32_t assignment : {0x00000001U, 0x00640001U, 0x00000301U, 0x00640300U}) {
    IntelligentScenario s(GetParam());
    start_as(s, 1, {{0x1F80, 0, 1}, {0x1F81, 4, assignment}});
    s.tx(0x000, {0x82, 0x00}).rx(0x704, {0x00}).rx(0x704, {0x7F}).ignore_tx();
    s.cif({0x0002, 0, 0x1F83, 4, 1, 1}).expect(1000, 0x0003).advance(1s);
    for (const can::Frame& frame : s.controller().sent) EXPECT_FALSE(frame.remote) << std::hex << assignment;
    s.expect_object(0x1F83, 4, 0, 1).expect_bit(404, 0, false).ignore_tx();
  }
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_nmt_corners_test
