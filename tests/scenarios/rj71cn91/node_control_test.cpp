// Who may control whom, and what keeps a node from Operational [RJ71CN91 1.2 Node control, 5.4, App. 3 1F82H].

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_node_control_test {
namespace {

using namespace rj71cn91_presets;

TEST(Rj71NodeControl, ActiveMaster_ControlsEverybody_AndObeysNobody) {
  RecordProperty("spec", "RJ71-NODECTL-007");
  for (const std::uint32_t start_up : {0x01U, 0x21U}) {  // a master, an active flying master
    IntelligentScenario s(rj71cn91);
    start_as(s, 2, {{0x1F80, 0, start_up}});
    s.wait_bit(25, 15, true, 20s).advance(2s).ignore_tx().expect(602, 5);
    for (const std::uint8_t to : Bytes{0, 2}) {
      for (const std::uint8_t command : Bytes{0x01, 0x02, 0x80, 0x81, 0x82}) {
        s.nmt(command, to).advance(100ms).expect(602, 5).expect_bit(25, 15, true).expect_bit(25, 7, false);
        for (const can::Frame& frame : s.controller().sent)
          EXPECT_NE(frame.identifier, 0x000U) << text(frame);
        s.ignore_tx();
      }
    }
    // Slaves and masters that stand by alike; itself by its own 1F82H only.
    for (const auto& [request, command] : std::map<std::uint16_t, std::uint8_t>{
             {0x04, 0x02}, {0x05, 0x01}, {0x7F, 0x80}, {0x06, 0x81}, {0x07, 0x82}}) {
      for (const std::uint8_t node : Bytes{1, 3, 127}) {
        s.cif({0x0002, 0, 0x1F82, node, 1, request})
            .expect(1000, 0x0003)
            .tx(0x000, {command, node})
            .ignore_tx();
      }
    }
    for (const auto& [request, state] :
         std::map<std::uint16_t, std::uint16_t>{{0x04, 0x04}, {0x7F, 0x7F}, {0x05, 0x05}}) {
      s.cif({0x0002, 0, 0x1F82, 2, 1, request}).expect(602, state);
      for (const can::Frame& frame : s.controller().sent) EXPECT_NE(frame.identifier, 0x000U) << text(frame);
      s.ignore_tx();
    }
  }
}

TEST(Rj71NodeControl, OtherNodes_AskForOthersToo_By1F82H) {
  RecordProperty("spec", "RJ71-NODECTL-008");
  for (const bool stands_by : {false, true}) {
    IntelligentScenario s(rj71cn91);
    start_as(s, 2, {{0x1F80, 0, stands_by ? 0x21U : 0U}, {0x1F81, 9, 0x05}});
    if (stands_by) s.wait_tx(0x073).rx(0x071, {0x01, 0x01}).rx(0x701, {0x05}).ignore_tx();
    s.ignore_tx();
    for (const auto& [request, command] : std::map<std::uint16_t, std::uint8_t>{{0x04, 0x02},
                                                                                {0x05, 0x01},
                                                                                {0x7F, 0x80},
                                                                                {0x06, 0x81},
                                                                                {0x07, 0x82},
                                                                                {0x84, 0x02},
                                                                                {0x85, 0x01}}) {
      s.cif({0x0002, 0, 0x1F82, 9, 1, request}).expect(1000, 0x0003).tx(0x000, {command, 0x09}).ignore_tx();
    }
    s.expect(609, 0);  // nothing is known of it: the active master's slaves are not its own
    s.cif({0x0002, 0, 0x1F82, 2, 1, 0x05}).expect(1000, 0x0003).no_tx().expect(602, 5);
    s.cif({0x0002, 0, 0x1F82, 0x80, 1, 0x04}).expect(1000, 0x0003).tx(0x000, {0x02, 0x00}).expect(602, 4);
    s.cif({0x0002, 0, 0x1F82, 9, 1, 0x03});
    s.expect_abort(0x06090030).no_tx();
    s.cif({0x0002, 0, 0x1F83, 9, 1, 1});  // guarding is the active master's
    s.expect_abort(0x08000022).no_tx().ignore_tx();
  }
}

// What the configuration tool's menu does, as an SDO of any node.
TEST(Rj71NodeControl, ResetOfTheMaster_ByItsOwn1F82H_StartsTheNetworkAnew) {
  RecordProperty("spec", "RJ71-TOOL-008");
  for (const std::uint8_t request : Bytes{0x06, 0x07}) {
    IntelligentScenario s(rj71cn91);
    start_as(s, 2, {{0x1F80, 0, 1}, {0x1F81, 5, 0x05}});
    s.tx(0x000, {0x82, 0x00});
    boots(s, 5);
    s.tx(0x000, {0x01, 0x05}).expect(602, 5).no_tx();
    s.rx(0x602, {0x2F, 0x82, 0x1F, 0x02, request, 0, 0, 0}).expect_bit(25, 7, true);
    s.wait_bit(25, 7, false).ignore_tx().expect_bit(25, 15, true).expect_bit(25, 14, true);
    boots(s, 5);
    s.tx(0x000, {0x01, 0x05}).expect(602, 5).ignore_tx();
  }
}

TEST(Rj71Restore, Defaults_RunAfterTheReset_AndTheConciseDcfsGo) {
  RecordProperty("spec", "RJ71-TOOL-011");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(2);
  s.set_object(0x1017, 0, 500, 2).store_objects();
  EXPECT_EQ(write_concise_dcf(s, 5, write_of_1017(100)), 0U);
  s.advance(5s).ignore_tx();
  s.rx(0x602, {0x23, 0x11, 0x10, 0x01, 'l', 'o', 'a', 'd'}).tx(0x582, {0x60, 0x11, 0x10, 0x01, 0, 0, 0, 0});
  s.expect_object(0x1017, 0, 500, 2);  // until then it works as before
  s.cif({0x0004, 0, 0x1F22, 5}).expect(1004, 13).ignore_tx();
  s.restart();
  s.expect_object(0x1017, 0, 0, 2);
  s.cif({0x0004, 0, 0x1F22, 5}).ignore_tx();
  EXPECT_NE(s.read(1004), 13);
}

TEST(Rj71Nmt, A126SlavesAndTheirHeartbeats) {
  RecordProperty("spec", "RJ71-TOOL-004 RJ71-TOOL-005");
  std::vector<PresetObject> objects{{0x1F80, 0, 1}};
  for (std::uint8_t node = 2; node <= 127; ++node) {
    objects.push_back({0x1F81, node, 0x01});
    objects.push_back({0x1016, static_cast<std::uint8_t>(node - 1), std::uint32_t{node} << 16 | 1000});
  }
  IntelligentScenario s(rj71cn91);
  start_as(s, 1, objects);
  s.tx(0x000, {0x82, 0x00});
  for (std::uint32_t node = 2; node <= 127; ++node) s.rx(0x700 + node, {0x00}).rx(0x700 + node, {0x7F});
  for (std::uint32_t node = 2; node <= 127; ++node) s.expect(400 + node, 0x0002).expect(600 + node, 0x7F);
  s.advance(1s).ignore_tx();
  for (std::uint32_t node = 2; node <= 127; ++node) s.expect_bit(400 + node, 7, true);
  s.expect(401, 0).ignore_tx();
  // PDOs 1 to 256.
  for (const std::uint16_t index : Words{0x1400, 0x14FF, 0x1600, 0x16FF, 0x1800, 0x18FF, 0x1A00, 0x1AFF}) {
    s.cif({0x0004, 0, index, 0}).expect(1000, 0x0005);
  }
  for (const std::uint16_t index : Words{0x1500, 0x1700, 0x1900, 0x1B00}) {
    s.cif({0x0004, 0, index, 0});
    s.expect_abort(0x06020000);
  }
  s.ignore_tx();
}

TEST(Rj71Nmt, WhatKeepsANodeFromOperational) {
  RecordProperty("spec", "RJ71-NMT-016");
  constexpr std::uint32_t mandatory = 0x0D;
  {  // the CPU is in STOP
    IntelligentScenario s(rj71cn91);
    start_as(s, 1, {{0x1F80, 0, 1}});
    s.advance(1s).expect(601, 5).cpu(module::CpuState::stop).expect(601, 0x7F);
    s.nmt(0x01, 1).expect(601, 0x7F).cpu(module::CpuState::run).advance(1s).expect(601, 5).ignore_tx();
  }
  {  // the start-up has failed; remote node start of the own node is the way out
    IntelligentScenario s(rj71cn91);
    start_as(s, 1, {{0x1F80, 0, 1}, {0x1F81, 5, mandatory}, {0x1F89, 0, 500}});
    s.advance(5s).expect(601, 0x7F).expect_bit(25, 11, true).ignore_tx();
    s.cif({0x0002, 0, 0x1F82, 1, 1, 0x05}).expect(1000, 0x0003).expect(601, 5).ignore_tx();
  }
  for (const std::uint32_t assignment : {0x00U, 0x01U, 0x05U}) {  // not assigned, not a boot slave, both
    IntelligentScenario s(rj71cn91);
    start_as(s, 1, {{0x1F80, 0, 1}, {0x1F81, 5, assignment}});
    s.tx(0x000, {0x82, 0x00}).rx(0x705, {0x00}).advance(100ms);
    if (assignment == 0x05) s.rx(0x585, is_0191);
    bool started = false;
    s.advance(1s);
    for (const can::Frame& frame : s.controller().sent)
      started = started || (frame.identifier == 0 && frame.data[0] == 0x01 && frame.data[1] == 5);
    EXPECT_EQ(started, assignment == 0x05) << assignment;
    s.ignore_tx();
  }
  {  // NMT master start disabled (1F80H bit 2)
    IntelligentScenario s(rj71cn91);
    start_as(s, 1, {{0x1F80, 0, 5}});
    s.advance(60s).expect(601, 0x7F).expect_bit(25, 14, true).ignore_tx();
  }
  {  // a concise DCF that is not wanted any more writes settings until it is deleted
    IntelligentScenario s(rj71cn91);
    start_as(s, 1, {{0x1F80, 0, 1}, {0x1F81, 5, mandatory}});
    EXPECT_EQ(write_concise_dcf(s, 5, write_of_1017(100)), 0U);
    s.ignore_tx();
    s.restart();
    boots(s, 5);
    s.tx(0x605, {0x2B, 0x17, 0x10, 0x00, 0x64, 0x00, 0, 0}).rx(0x585, {0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0});
    s.ignore_tx();
    EXPECT_EQ(write_concise_dcf(s, 5, {0}), 0U);
    s.advance(5s).ignore_tx();
    s.restart();
    boots(s, 5);
    s.tx(0x000, {0x01, 0x05}).no_tx().expect(601, 5);
  }
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_node_control_test
