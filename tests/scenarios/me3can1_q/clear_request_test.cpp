// Requests that clear, and completed signals, over power cycles and beside each other [3.3.2].

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_clear_request_test {
namespace {

CANOPUS_OF_BOTH_MODULES(ClearRequests);

TEST(Me3ClearRequests, EndWithTheSupply) {
  RecordProperty("spec", "ME3-IO-013 ME3-IO-014 ME3-IO-020 ME3-IO-021 ME3-SYS-018");
  IntelligentScenario s;
  s.power_on();
  s.y(0x0F, true).y(0x10, true).y(0x11, true);
  s.supply_off();
  s.power_on();
  s.set_object(0x1016, 1, 0x00020064, 4);
  s.rx(0x702, {0x05}).advance(100ms).ignore_tx().expect(402, 0x0082).expect_x(0x10, true);
  s.write(24, 300).expect(29, 0x0040).expect(39, 24).expect_x(0x0F, true);
  s.rx(0x085, {0x30, 0x81, 0x11, 1, 2, 3, 4, 5}).expect_x(0x11, true);
  s.exchange();
  s.expect(750, {5, 0x8130});
}

TEST_P(ClearRequests, X1F_DoesNotComeOnceY1FIsOff) {
  spec("ME3-IO-025", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(70, 1000).write(22, 1);
  s.y(0x1F, true).advance(50ms).y(0x1F, false).advance(10s);
  s.expect(22, 0).expect_x(0x1F, false);
  s.restart();
  s.expect(70, 1000);
}

TEST_P(ClearRequests, LifeGuarding_IsHeldDownByY10OfItsNodeAlone) {
  spec("ME3-IO-016 ME3-IO-017 ME3-NEC-009", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.set_object(0x100C, 0, 100, 2);
  s.set_object(0x100D, 0, 2, 1);
  s.write(400, 5).y(0x10, true);
  s.rx_remote(0x701, 1).advance(200ms).ignore_tx();
  s.expect_bit(401, 6, true).expect_x(0x10, true);
  s.y(0x10, false).write(400, 1).y(0x10, true).expect_bit(401, 6, false).expect_x(0x10, false);
  s.rx_remote(0x701, 1).advance(200ms).ignore_tx();
  s.expect_bit(401, 6, false).expect_x(0x10, false);
}

// It holds what comes once the module works.
TEST_P(ClearRequests, Y10_MayBeOnBeforeTheInitializationEnds) {
  spec("ME3-IO-016 ME3-IO-017", "");
  for (const bool held : {true, false}) {
    IntelligentScenario s(GetParam());
    s.plug_in().preset_node_id(1);
    s.plug_in().preset_object(0x100C, 0, Bytes{100, 0});
    s.plug_in().preset_object(0x100D, 0, Bytes{2});
    s.supply_on().y(0x10, held).advance(1s).tx(0x701, {0x00});
    s.rx_remote(0x701, 1).advance(200ms).ignore_tx();
    s.expect_bit(401, 6, !held).expect_x(0x10, !held);
  }
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_clear_request_test
