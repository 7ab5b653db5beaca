// What the manual of the ME3CAN1-Q says in a sentence or in the corner of a table: boot time, priorities of flying masters,
// EMCY 0000H and 8200H, the example of table 5-7, words that are never saved.

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::me3can1_q_manual_corners_test {
namespace {

using namespace rj71cn91_presets;

CANOPUS_OF_BOTH_MODULES(ManualCorners);

constexpr unsigned start_up_runs = 14;  // bit of G25

// [ME3CAN1-Q 4.8.4, 4.8.6] "From power-on" and "from the start of the boot process": from the reset of the network, which ends
// the initialization, whatever it comes from.
TEST_P(ManualCorners, BootTime_CountsFromTheResetOfTheNetwork_AfterEachStart) {
  spec("ME3-MST-015", "RJ71-STARTUP-017");
  IntelligentScenario s(GetParam());
  start_as(s, 1, {{0x1F80, 0, 1}, {0x1F81, 5, 0x0D}, {0x1F89, 0, 3000}});
  const auto fails_in_time = [&] {
    s.tx(0x000, {0x82, 0x00}).expect_bit(25, start_up_runs, true).expect_bit(405, 4, false);
    s.advance(2999ms).ignore_tx().expect_bit(25, start_up_runs, true).expect_bit(405, 4, false);
    s.advance(1ms).expect_bit(25, start_up_runs, false).expect_bit(405, 4, true).ignore_tx();
  };
  fails_in_time();
  s.supply_off().advance(1min).supply_on().wait_tx(0x701, {0x00});
  fails_in_time();
  s.y(0x02, true).ignore_tx().wait_tx(0x701, {0x00}).y(0x02, false);
  fails_in_time();
  for (const std::uint16_t request : Words{0x06, 0x07}) {
    s.write(1000, {0x0002, 0, 0x1F82, 1, 1, request}).y(0x17, true).advance(1ms).y(0x17, false);
    s.ignore_tx().wait_tx(0x701, {0x00});
    fails_in_time();
  }
  s.set_object(0x1F89, 0, 0, 4).store_objects().supply_off().ignore_tx().supply_on().wait_tx(0x701, {0x00});
  s.advance(10min).ignore_tx().expect_bit(25, start_up_runs, true).expect_bit(405, 4, false);  // 0: no end
}

// [ME3CAN1-Q Tab. 4-33]
TEST_P(ManualCorners, PriorityOfAFlyingMaster_Is0To2) {
  spec("ME3-FLY-002", "RJ71-FLY-002");
  IntelligentScenario s(GetParam());
  s.power_on_as(5);
  for (const std::uint16_t priority : Words{0, 1, 2}) {
    s.set_object(0x1F90, 3, priority, 2).expect_object(0x1F90, 3, priority, 2);
  }
  for (const std::uint16_t reserved : Words{3, 0xFF, 0x100, 0x102, 0xFFFF}) {
    s.cif({0x0002, 0, 0x1F90, 3, 2, reserved});
    s.expect_abort(0x06090030).expect_object(0x1F90, 3, 2, 2);
  }
}

// [ME3CAN1-Q Tab. 5-7]
TEST_P(ManualCorners, WholeNetworkToOperational_AsTheExampleHasIt) {
  spec("ME3-CIF-030", "RJ71-NODECTL-002");
  IntelligentScenario s(GetParam());
  s.power_on_as_master();
  s.write(1000, {0x0002, 0x0000, 0x1F82, 0x0080, 0x0001, 0x0005}).y(0x17, true).wait_x(0x17, true);
  s.tx(0x000, {0x01, 0x00})
      .no_tx()
      .expect(1000, {0x0003, 0x0000, 0x1F82, 0x0080})
      .expect(601, 5)
      .y(0x17, false);
}

// [ME3CAN1-Q 8.2.1] 0000H says that no error of the module's own is left; it comes once.
TEST(Me3ManualCorners, Emergency0000h_ComesWithTheEndOfTheLastError) {
  RecordProperty("spec", "ME3-EMCY-012");
  IntelligentScenario s;
  s.power_on_as(5);
  s.nmt(0x01, 5).rx(0x205, {1}).tx(0x085, {0x10, 0x82, 0x11, 0, 0, 0, 0, 0});
  s.rx(0x305, {1}).tx(0x085, {0x10, 0x82, 0x11, 0, 0, 0, 0, 0});
  s.error_counters(130, 0).tx(0x085, {0x20, 0x81, 0x11, 0, 0, 0, 0, 0}).no_tx();
  const Bytes eight(8, 1);
  s.rx(0x205, eight).no_tx();
  s.expect_object(0x1001, 0, 0x11, 1);
  s.error_counters(0, 0).no_tx();
  s.expect_object(0x1001, 0, 0x11, 1);
  s.rx(0x305, eight).tx(0x085, no_error).no_tx();
  s.expect_object(0x1001, 0, 0x00, 1);
  s.rx(0x305, eight).rx(0x205, eight).error_counters(127, 0).error_counters(0, 0).advance(60s).no_tx();
  s.rx(0x205, {1}).tx(0x085, {0x10, 0x82, 0x11, 0, 0, 0, 0, 0}).rx(0x205, eight).tx(0x085, no_error).no_tx();
  s.expect_object(0x1003, 0, 4, 1);  // 0000H is no entry
}

// [ME3CAN1-Q 8.2.1] The module sends 8200H for a SYNC with data; 8240H is not among its codes.
TEST_P(ManualCorners, Emergency8200h_ComesWithASyncWithData) {
  spec("ME3-EMCY-013", "RJ71-EMCY-001");
  for (const std::uint8_t length : Bytes{1, 8}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(5);
    s.set_object(0x1800, 1, 0xC0000185, 4).set_object(0x1800, 2, 1, 1).set_object(0x1800, 1, 0x40000185, 4);
    s.nmt(0x01, 5).ignore_tx();
    s.rx(0x080, Bytes(length, 1)).tx(0x085, {0x00, 0x82, 0x11, 0, 0, 0, 0, 0}).ignore_tx();
    s.rx(0x080, Bytes(length, 1));
    for (const can::Frame& frame : s.controller().sent) EXPECT_NE(frame.identifier, 0x085U) << text(frame);
    s.ignore_tx();
  }
}

// [ME3CAN1-Q 3.4.1] "RPDO, TPDO data: not saved": all words.
TEST_P(ManualCorners, ProcessDataWords_AllOfThem_BeginWith0) {
  spec("ME3-SAVE-007", "RJ71-PDO-004");
  IntelligentScenario s(GetParam());
  s.power_on_operational();
  for (std::uint16_t word = 0; word < 1024; ++word) {
    s.set_object(static_cast<std::uint16_t>(0xA580 + word / 254), static_cast<std::uint8_t>(word % 254 + 1),
                 word + 1U, 2);
    s.write(13000U + word, static_cast<std::uint16_t>(0x8000 | word));
  }
  s.exchange().ignore_tx();
  for (std::uint16_t word = 0; word < 1024; ++word) {
    ASSERT_EQ(s.read(10000U + word), word + 1);
    ASSERT_EQ(s.read(13000U + word), 0x8000 | word);
  }
  s.save().store_objects().supply_off();
  s.power_on();
  for (std::uint16_t word = 0; word < 1024; ++word) {
    ASSERT_EQ(s.read(10000U + word), 0) << word;
    ASSERT_EQ(s.read(13000U + word), 0) << word;
  }
  s.nmt(0x01, 1).exchange().ignore_tx();
  for (std::uint16_t word = 0; word < 1024; ++word) ASSERT_EQ(s.read(10000U + word), 0) << word;
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_manual_corners_test
