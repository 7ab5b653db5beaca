// Received emergency messages [FX2N-32CAN 9.1, 4.2.7].

#include "scenarios/fx2n_32can/scenario.hpp"

namespace canopus::scenario::fx2n_32can_emergency_test {
namespace {

void receive(Fx2nScenario& s, std::uint16_t first, std::uint16_t last, std::uint8_t node = 3) {
  for (std::uint16_t code = first; code <= last; ++code)
    s.rx(0x080U + node,
         {static_cast<std::uint8_t>(code & 0xFF), static_cast<std::uint8_t>(code >> 8), 0, 0, 0, 0, 0, 0});
}

/// Records of messages whose code is their number, then zeros.
void expect_records(Fx2nScenario& s, std::uint16_t first, std::uint16_t last,
                    Where where = Where::current()) {
  Words words;
  for (std::uint16_t number = first; number <= last; ++number)
    words.insert(words.end(), {3, std::min<std::uint16_t>(number, 255), number, 0, 0, 0});
  words.resize(66);
  s.expect(1001, words, where);
}

// S-95
TEST(Fx2nEmergency, StackAndRing) {
  RecordProperty("spec", "FX2N-EMCY-001 FX2N-EMCY-002 FX2N-EMCY-003 FX2N-EMCY-007 FX2N-EMCY-008");
  Fx2nScenario s;
  s.start(1).cif({0x8700, 0}).expect(1000, 0x8701).expect(1001, Words(66, 0));
  receive(s, 1, 5);
  s.cif({0x8700, 0}).expect(1000, 0x8701);
  expect_records(s, 1, 5);
  s.cif({0x8700, 1}).expect(1000, 0x8702).expect(1001, Words(66, 0));
  receive(s, 6, 13);
  s.cif({0x8700, 1}).expect(1000, 0x8702);
  expect_records(s, 12, 13);
  receive(s, 14, 25);
  s.cif({0x8700, 0}).expect(1000, 0x8701);
  expect_records(s, 1, 11);
  s.cif({0x8700, 1}).expect(1000, 0x8702);
  expect_records(s, 15, 25);
  s.no_tx();
}

// S-96
TEST(Fx2nEmergency, TheNextUnreadOne) {
  RecordProperty("spec", "FX2N-EMCY-004");
  Fx2nScenario s;
  s.start(1);
  receive(s, 1, 25);
  s.cif({0x8700, 0}).cif({0x8700, 1});
  for (std::uint16_t number = 1; number <= 25; ++number) {
    if (number >= 12 && number <= 14) continue;  // overwritten
    s.cif({0x8700, 2}).expect(1000, 0x8703);
    expect_records(s, number, number);
  }
  s.cif({0x8700, 2}).expect(1000, 0x8703).expect(1001, Words(66, 0));
  receive(s, 26, 26);
  s.cif({0x8700, 2}).expect(1000, {0x8703, 3, 26, 26}).cif({0x8700, 2}).expect(1000, {0x8703, 0, 0, 0});
}

// S-97
TEST(Fx2nEmergency, ReadAndClear) {
  RecordProperty("spec", "FX2N-EMCY-005 FX2N-EMCY-006 FX2N-EMCY-007 FX2N-CIF-005");
  for (const std::uint16_t parameter : Words{0x10, 0x11}) {
    Fx2nScenario s;
    s.start(1);
    receive(s, 1, 13);
    s.cif({0x8700, parameter}).expect(1000, parameter == 0x10 ? 0x8701 : 0x8702);
    parameter == 0x10 ? expect_records(s, 1, 11) : expect_records(s, 12, 13);
    for (const std::uint16_t other : Words{0, 1, 2}) s.cif({0x8700, other}).expect(1001, Words(66, 0));
    s.rx(0x084, {0x34, 0x12, 0x81, 9, 8, 7, 6, 5}).cif({0x8700, 0});
    s.expect(1000, {0x8701, 4, 1, 0x1234, 0x0981, 0x0708, 0x0506, 0, 0});
  }
}

// S-98
TEST(Fx2nEmergency, TheCounterStaysAt255) {
  RecordProperty("spec", "FX2N-EMCY-007");
  Fx2nScenario s;
  s.start(1);
  receive(s, 1, 254);
  s.cif({0x8700, 1}).expect(1062, 254);
  receive(s, 255, 300);
  s.cif({0x8700, 1});
  for (const module::BufferAddress word : {1002U, 1062U}) s.expect(word, 255);
  s.expect(1063, 300);
  s.supply_off().supply_on().wait_bit(25, 0, true).ignore_tx();
  receive(s, 1, 1);
  s.cif({0x8700, 0}).expect(1000, {0x8701, 3, 1, 1});
}

// S-99
TEST(Fx2nEmergency, BytesLieLowByteFirst) {
  RecordProperty("spec", "FX2N-EMCY-008 FX2N-EMCY-002");
  Fx2nScenario s;
  s.start(1).rx(0x083, {0x10, 0x81, 0x11, 1, 2, 3, 4, 5}).cif({0x8700, 0});
  s.expect(1000, {0x8701, 3, 1, 0x8110, 0x0111, 0x0302, 0x0504, 0});
  s.rx(0x0FF, {0x00, 0x10, 1, 0, 0, 0, 0, 0}).cif({0x8700, 0}).expect(1007, {127, 2, 0x1000, 1});
}

TEST(Fx2nEmergency, OtherParameters_AreAnInternalError) {
  RecordProperty("spec", "FX2N-EMCY-009 FX2N-CERR-006");
  Fx2nScenario s;
  s.start(1);
  receive(s, 1, 13);
  for (const std::uint16_t parameter : Words{3, 0x0F, 0x12, 0x0110, 0xFFFF})
    s.cif({0x8700, parameter}).expect(1000, {0x000F, 0x00C8, 1, parameter});
  s.cif({0x8700, 0}).expect(1000, {0x8701, 3, 1, 1});  // and nothing was cleared
}

TEST(Fx2nEmergency, TheErrorBit_IsThereAsLongAsSomebodysError) {
  RecordProperty("spec", "FX2N-EMCY-012 FX2N-ERR-011 FX2N-ERR-016");
  Fx2nScenario s;
  s.start(1).rx(0x083, {0x00, 0x10, 1, 0, 0, 0, 0, 0}).expect(29, 0x2000).write(29, 0).expect(29, 0x2000);
  s.rx(0x084, {0x00, 0x20, 1, 0, 0, 0, 0, 0}).rx(0x083, Bytes(8, 0)).expect(29, 0x2000);
  s.rx(0x084, Bytes(8, 0)).expect(29, 0);
  s.rx(0x084, {0x00, 0x20, 1, 0, 0, 0, 0, 0}).expect(29, 0x2000).cif({0x8700, 0x10}).expect(29, 0);
  // The own one is none that occurred in the network.
  s.cif({0x000A, 0x1000, 1}).expect(29, 0).ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::fx2n_32can_emergency_test
