// spec/me3can1-q/scenarios.md, section 6: command interface - request NMT (S24).

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_request_nmt_test {
namespace {

CANOPUS_OF_BOTH_MODULES(RequestNmt);

TEST(Me3RequestNmt, S24_RequestNmtToAllNodes_StartsTheNetwork) {
  RecordProperty("spec", "ME3-RQN-002");
  IntelligentScenario s;
  s.power_on_as_master();
  s.write(1000, {0x0002, 0, 0x1F82, 0x0080, 1, 0x0005});
  s.y(0x17, true);
  s.expect(1000, 0xFFFF).expect_x(0x17, false);
  s.wait_x(0x17, true);
  s.tx(0x000, {0x01, 0x00});
  s.expect(1000, {0x0003, 0, 0x1F82, 0x0080});
  s.expect_bit(25, 0, true).expect_bit(25, 8, false).expect_bit(25, 9, true);
  s.y(0x17, false);
  s.expect_x(0x17, false);
  const std::map<std::uint16_t, std::uint8_t> services{{4, 0x02}, {5, 0x01}, {0x7F, 0x80}, {5, 0x01}};
  for (const auto& [value, command] : services) {
    s.cif({0x0002, 0, 0x1F82, 0x0080, 1, value});
    s.expect(1000, 0x0003);
    s.tx(0x000, {command, 0x00});
    s.expect(601, value);
  }
  s.no_tx();
  for (const auto& [value, command] : std::map<std::uint16_t, std::uint8_t>{{6, 0x81}, {7, 0x82}}) {
    s.cif({0x0002, 0, 0x1F82, 0x0080, 1, value});
    s.tx(0x000, {command, 0x00});
    s.wait_bit(25, 7, true);
    s.wait_bit(25, 7, false);
    s.expect_bit(25, 6, true);
    s.advance(5s);
    s.ignore_tx();
  }
}

TEST_P(RequestNmt, RequestNmtToOneNode_SendsOneFrame) {
  spec("ME3-RQN-001 ME3-NST-003",
       "RJ71-NODECTL-001 RJ71-NODECTL-002 RJ71-NODECTL-003 RJ71-NODECTL-004 RJ71-NODECTL-005 "
       "RJ71-NODECTL-011");
  IntelligentScenario s(GetParam());
  s.power_on_as_master();
  s.expect(602, 0);
  const std::vector<std::pair<std::uint16_t, std::uint8_t>> services{
      {4, 0x02}, {5, 0x01}, {6, 0x81}, {7, 0x82}, {0x7F, 0x80}};
  for (const auto& [value, command] : services) {
    s.cif({0x0002, 0, 0x1F82, 2, 1, value});
    s.expect(1000, 0x0003);
    s.tx(0x000, {command, 0x02}).no_tx();
    if (value == 4 || value == 5 || value == 0x7F) s.expect(602, value);
  }
  s.expect_bit(25, 8, true);  // the own state is untouched
}

TEST_P(RequestNmt, RequestNmt_ReservedValues_AreRefused) {
  spec("ME3-RQN-004", "");
  IntelligentScenario s(GetParam());
  s.power_on_as_master();
  const std::vector<std::uint16_t> good{4, 5, 6, 7, 0x7F, 0x84, 0x85, 0x86, 0x87, 0x8F};
  for (std::uint16_t value = 0; value <= 0xFE; ++value) {
    if (std::find(good.begin(), good.end(), value) != good.end()) continue;
    for (const std::uint16_t sub : Words{1, 2, 127, 0x80}) {
      s.cif({0x0002, 0, 0x1F82, sub, 1, value});
      s.expect_abort(0x06090030);
    }
  }
  s.no_tx().expect_bit(25, 8, true);  // nor is the own state changed
}

TEST(Me3RequestNmt, AsSlave_SendsNothing) {
  RecordProperty("spec", "ME3-NMT-010");
  IntelligentScenario s;
  s.power_on();
  s.cif({0x0002, 0, 0x1F82, 2, 1, 5});
  s.expect_abort(0x08000022).no_tx();
  s.cif({0x0002, 0, 0x1F82, 0x80, 1, 5});
  s.expect_abort(0x08000022).no_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_request_nmt_test
