// The branches of error control that section 9 of spec/me3can1-q/scenarios.md leaves out, SDO connections that the start-up occupies, error behaviour.

#include "scenarios/me3can1_q/master_branches.hpp"

namespace canopus::scenario::me3can1_q_master_error_control_test {
namespace {

using namespace nmt_master_slave;

CANOPUS_OF_BOTH_MODULES(ErrorBehaviour);
CANOPUS_OF_BOTH_MODULES(ErrorControl);
CANOPUS_OF_BOTH_MODULES(SdoChannelInMasterBranches);

// --- SDO connections

TEST_P(SdoChannelInMasterBranches, FirstStart_OccupiesAllNodes_LaterOnlyTheOneThatFailed) {
  spec("ME3-CIF-025", "");
  IntelligentScenario s(GetParam());
  if (s.is_rj71cn91()) s.plug_in().preset_word(70, 0);  // no pause between 126 starts
  s.power_on_as(1);
  s.set_object(0x1F80, 0, 1, 4);
  for (std::uint8_t node = 2; node <= 127; ++node) s.set_object(0x1F81, node, optional, 4);
  s.set_object(0x1016, 1, 0x000205DC, 4);
  s.store_objects();
  s.y(0x02, true).wait_x(0x02, true, 60s).y(0x02, false);
  s.wait_tx(0x081, {0x00, 0x62, 0x01, 0x4D, 0x45, 0x30, 0x30, 0x34});
  s.wait_tx(0x701, {0x00}).tx(0x000, {0x82, 0x00});
  for (std::uint8_t node = 2; node <= 127; ++node) {  // all at one time
    s.rx(0x700U + node, {0x00}).tx(0x600U + node, ask_1000);
  }
  for (const std::uint16_t node : Words{2, 64, 127}) {
    s.cif({0x0004, node, 0x1018, 1});
    s.expect_abort(0x060A0023, node).expect_bit(25, 14, true).no_tx();
  }
  for (std::uint8_t node = 2; node <= 127; ++node) {
    s.rx(0x580U + node, is_0191);
    if (node == 2) s.rx(0x702, {0x7F});
    s.tx(0x000, {0x01, node});
  }
  s.expect_bit(25, 14, false).no_tx();
  const auto reads = [&](std::uint8_t node) {
    s.write(1000, {0x0004, node, 0x1018, 1});
    s.y(0x17, true).advance(1ms).tx(0x600U + node, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0});
    s.rx(0x580U + node, {0x43, 0x18, 0x10, 0x01, 0x71, 0, 0, 0});
    s.expect(1000, {0x0005, node, 0x1018, 1, 4, 0x0071}).y(0x17, false).no_tx();
  };
  reads(2);
  reads(64);
  s.wait_tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x000, {0x82, 0x02});
  s.rx(0x702, {0x00}).ignore_tx();
  s.expect_bit(25, 14, true);
  s.cif({0x0004, 2, 0x1018, 1});
  s.expect_abort(0x060A0023, 2);
  reads(64);
  s.ignore_tx();
}

// --- error control

TEST_P(ErrorControl, NodesWord_IsThatOfItsNumber_HeartbeatAndGuarding) {
  spec("ME3-NEC-002 ME3-NEC-003 ME3-NEC-004 ME3-NEC-011", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1F80, 0, 1, 4);
  for (std::uint8_t node = 2; node <= 127; ++node) {
    if (node % 2 == 0) {
      s.set_object(0x1016, node, std::uint32_t{node} << 16 | 60'000U, 4);
    } else {
      s.set_object(0x1F81, node, 0xFFFF0301, 4);
    }
  }
  s.store_objects();
  s.restart();
  s.ignore_tx();
  const auto others_are_quiet = [&](unsigned node) {
    for (unsigned n = node + 1; n <= 127; ++n) s.expect(static_cast<std::uint16_t>(400 + n), 0);
  };
  for (std::uint8_t node = 2; node <= 127; ++node) {
    others_are_quiet(node - 1U);
    s.rx(0x700U + node, {0x00}).rx(0x700U + node, {0x7F});
    s.expect(static_cast<std::uint16_t>(400 + node), node % 2 == 0 ? 0x0002 : 0x0001);
  }
  s.expect(401, 0).expect_x(0x10, false);
  s.ignore_tx();
  // Not in the layer 2 modes.
  s.write(21, 11);
  s.save();
  s.restart();
  s.rx(0x702, {0x05});
  for (std::uint16_t address = 401; address <= 527; ++address) s.expect(address, 0);
}

TEST_P(ErrorControl, HeartbeatWinsOverGuarding_AtTheMasterAndAtTheSlave) {
  spec("ME3-NG-008", "RJ71-NG-007 RJ71-NG-008");
  IntelligentScenario s(GetParam());  // 1016H watches node 2: no remote frame, not even on request
  s.power_on_as(1);
  start_with(s, {{0x1F80, 0, 1}, {0x1F81, 2, 0x00640301}, {0x1016, 1, 0x000205DC}});
  s.ignore_tx();
  s.rx(0x702, {0x00}).rx(0x702, {0x7F}).advance(1s).no_tx();
  s.set_object(0x1F83, 2, 1, 1);
  s.no_tx().advance(400ms).no_tx();
  s.expect_object(0x1F83, 2, 0, 1).expect(402, 0x0002);
  s.wait_bit(402, 7, true)
      .expect(402, either(0x0082, 0x0080))
      .ignore_tx();  // the heartbeat's bit, none of guarding

  IntelligentScenario slave(GetParam());  // 1017H: neither answered nor watched
  slave.power_on_as(2);
  slave.set_object(0x100C, 0, 100, 2);
  slave.set_object(0x100D, 0, 3, 1);
  slave.nmt(0x01, 2).rx_remote(0x702, 1).tx(0x702, {0x05});
  slave.set_object(0x1017, 0, 10'000, 2);
  slave.ignore_tx().rx_remote(0x702, 1).no_tx();
  slave.advance(5s).no_tx().expect(402, 0).expect(25, 0x0201);
}

TEST_P(ErrorControl, ConsumerTimeShorterThanTheProducers_IsTakenAndLosesEveryHeartbeat) {
  spec("ME3-HB-005", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x1016, 1, 0x00020064, 4);  // 100 ms, and node 2 sends one every second
  s.expect_object(0x1016, 1, 0x00020064, 4).expect(29, 0);
  for (int again = 0; again < 3; ++again) {
    s.rx(0x702, {0x05}).ignore_tx().expect_bit(402, 1, true);
    s.y(0x10, true).advance(1ms).y(0x10, false).expect_bit(402, 7, false);
    s.advance(98ms).no_tx().expect_bit(402, 7, false);
    s.advance(1ms).tx(0x081, {0x02, 0x8F, 0x11, 0, 0, 0, 0, 0}).expect_bit(402, 7, true);
    s.advance(900ms).no_tx();
  }
  s.set_object(0x1016, 1, 0x000205DC, 4);  // longer: nothing is missed
  s.ignore_tx();
  for (int again = 0; again < 10; ++again) s.rx(0x702, {0x05}).ignore_tx().advance(1000ms).no_tx();
}

TEST_P(ErrorBehaviour, Causes_AsSlaveHeartbeatAndLifeGuarding_AsMasterNeitherHeartbeatNorGuardingOfSlaves) {
  spec("ME3-EB-005", "");
  {
    IntelligentScenario s(GetParam());  // slave: heartbeat of node 2 missing
    s.power_on_as(1);
    s.set_object(0x1016, 1, 0x000205DC, 4);
    s.nmt(0x01, 1).rx(0x702, {0x05}).expect(25, 0x0201);
    s.advance(1499ms).expect(25, 0x0201).advance(1ms).expect(25, 0x0100).ignore_tx();
  }
  {
    IntelligentScenario s(GetParam());  // slave: life guarding
    s.power_on_as(1);
    s.set_object(0x100C, 0, 100, 2);
    s.set_object(0x100D, 0, 3, 1);
    s.nmt(0x01, 1).rx_remote(0x701, 1).advance(299ms).expect(25, 0x0201).advance(1ms).expect(25, 0x0100);
    s.ignore_tx();
  }
  {
    IntelligentScenario s(GetParam());  // bus-off, in either role
    s.power_on_as(1);
    s.nmt(0x01, 1).expect(25, 0x0201).error_counters(256, 0).expect_bit(25, 0, false).ignore_tx();
    s.supply_off();
  }
  {
    IntelligentScenario s(GetParam());  // CPU in STOP
    s.power_on_as(1);
    s.nmt(0x01, 1).cpu(module::CpuState::stop).expect(25, 0x0100).ignore_tx();
  }
  {
    IntelligentScenario s(GetParam());  // master: both kinds of losses, and Operational all the same
    s.power_on_as(1);
    start_with(s, {{0x1F80, 0, 1}, {0x1016, 1, 0x000205DC}, {0x1F81, 3, 0x00640301}});
    s.ignore_tx().advance(1s).ignore_tx();
    s.rx(0x702, {0x05}).rx(0x703, {0x00}).rx(0x703, {0x7F}).ignore_tx().expect_bit(25, 0, true);
    s.wait_bit(403, 3, true).expect_bit(25, 0, true).wait_bit(402, 7, true).expect_bit(25, 0, true);
    s.error_counters(256, 0).expect_bit(25, 0, false);  // but bus-off it is
    s.ignore_tx();
  }
}

TEST(Me3Emergency, CodesTheModuleSendsByItself) {
  RecordProperty("spec", "ME3-EMCY-006");
  IntelligentScenario s;
  s.power_on_as(1);
  s.set_object(0x1016, 1, 0x007F03E8, 4);
  s.set_object(0x1400, 1, 0x00000201, 4);
  s.nmt(0x01, 1).ignore_tx();
  const auto code = [&](std::uint16_t expected, Where where = Where::current()) {
    bool found = false;
    while (!s.controller().sent.empty()) {
      const can::Frame frame = s.controller().sent.front();
      s.controller().sent.pop_front();
      if (frame.identifier != 0x081) continue;
      const auto sent = static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8);
      found = found || sent == expected;
      // 8.2.1, what is ticked.
      const bool allowed = sent == 0x0000 || sent == 0x6200 || sent == 0x8110 || sent == 0x8120 ||
                           sent == 0x8200 || sent == 0x8210 || sent == 0x8220 || sent == 0x8250 ||
                           (sent >= 0x8F01 && sent <= 0x8F7F) || sent == 0xFF00;
      EXPECT_TRUE(allowed) << std::hex << sent << " at line " << std::dec << where.line();
    }
    EXPECT_TRUE(found) << std::hex << expected << " at line " << std::dec << where.line();
  };
  s.rx(0x201, {1, 2, 3});
  code(0x8210);
  s.rx(0x201, {1, 2, 3, 4, 5, 6, 7, 8});
  code(0x0000);
  s.set_object(0x1400, 1, 0x80000201, 4);
  s.set_object(0x1600, 0, 0, 1);
  s.set_object(0x1600, 1, 0xA5800110, 4);
  s.set_object(0x1600, 0, 1, 1);
  s.set_object(0x1400, 1, 0x00000201, 4);
  s.ignore_tx();
  s.rx(0x201, {1, 2, 3, 4, 5, 6, 7, 8});
  code(0x8220);
  s.rx(0x080, {0x01});  // 1019H does not exist: a SYNC has no byte
  code(0x8200);
  s.error_counters(130, 0);
  code(0x8120);
  s.error_counters(0, 0);
  s.controller().overflows = 1;
  s.write(20, 0);
  code(0x8110);
  s.rx(0x77F, {0x05}).advance(1s);
  code(0x8F7F);
  s.nmt(0x01, 1).cpu(module::CpuState::stop);
  code(0xFF00);
  s.cpu(module::CpuState::run).y(0x02, true).advance(1ms);
  code(0x6200);
  s.y(0x02, false).advance(10s).ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_master_error_control_test
