// Network manager and guarding [FX2N-32CAN 7.2, 8].

#include "scenarios/fx2n_32can/scenario.hpp"

namespace canopus::scenario::fx2n_32can_guarding_test {
namespace {

/// Records of 8400H, then FFFFh.
Words assign(std::initializer_list<Words> records) {
  Words command{0x8400};
  for (const Words& record : records) command.insert(command.end(), record.begin(), record.end());
  if (records.size() < 16) command.push_back(0xFFFF);
  return command;
}

/// The slave takes guard time and life time factor.
void take_guarding(Fx2nScenario& s, std::uint8_t node, std::uint8_t time, std::uint8_t factor,
                   Where where = Where::current()) {
  // Slaves before it may be guarded already.
  std::erase_if(s.controller().sent, [](const can::Frame& frame) { return frame.remote; });
  s.accepts(node, {0x2B, 0x0C, 0x10, 0, time, 0, 0, 0}, where);
  s.accepts(node, {0x2F, 0x0D, 0x10, 0, factor, 0, 0, 0}, where);
}

/// A manager that guards node 5 every 100 ms, with 3 retries; the slave is Operational, its next answer is 05H. 1 ms after its
/// last one.
void start_guarding(Fx2nScenario& s, std::uint16_t services = 1, std::uint8_t retries = 3,
                    Where where = Where::current()) {
  s.start_as_manager(where).cif(assign({{5, services, 100, retries}}));
  take_guarding(s, 5, 100, retries, where);
  s.expect(1000, {0x8401, 0, 0, 0, 0}, where);
  s.expect_object(0x1F81, 5, 0x0064'0000U + 0x100U * retries + services, 4, where);
  s.advance(9ms);  // the manager takes the slave's SDO channel when the command has left it
  if ((services & 4) != 0) s.says(5, 0x1000, 0, 0x191, where);
  s.tx_remote(0x705, where).rx(0x705, {0x7F}).tx(0x000, {1, 5}, where).no_tx(where);
  s.advance(100ms).tx_remote(0x705, where).rx(0x705, {0x85}).no_tx(where);
  s.cif({0x8500, 5}).expect(1000, {0x8501, 5, 0x0001}, where).expect(29, 0, where);
}

/// One guarding request, answered with this.
void answer(Fx2nScenario& s, std::uint8_t state, Where where = Where::current()) {
  s.advance(100ms).tx_remote(0x705, where).rx(0x705, {state});
}

// S-80
TEST(Fx2nGuarding, AssignsSlaves_AndGuardsThem) {
  RecordProperty("spec",
                 "FX2N-GRD-001 FX2N-GRD-003 FX2N-GRD-004 FX2N-GRD-005 FX2N-GRD-007 FX2N-GRD-013 FX2N-OD-011 "
                 "FX2N-NMT-001 FX2N-NMT-002 FX2N-GRD-006");
  for (const std::uint16_t services : Words{1, 5}) {
    Fx2nScenario s;
    start_guarding(s, services);
    for (int i = 0; i < 20; ++i) answer(s, static_cast<std::uint8_t>(i % 2 * 0x80 + 5));
    s.no_tx().cif({0x8500, 5}).expect(1000, {0x8501, 5, 0x0001}).expect(29, 0);
  }
  // Services that do not exist are left out.
  Fx2nScenario s;
  s.start_as_manager().cif(assign({{5, 0xFFFA, 0, 0}}));
  take_guarding(s, 5, 0, 0);
  s.expect(1000, 0x8401).expect_object(0x1F81, 5, 0, 4).advance(1s).no_tx();
}

// S-81
TEST(Fx2nGuarding, ALostSlave) {
  RecordProperty("spec", "FX2N-GRD-008 FX2N-GRD-016 FX2N-GRD-021 FX2N-ERR-008 FX2N-GRD-006 FX2N-CIF-005");
  Fx2nScenario s;
  start_guarding(s);
  s.advance(100ms).tx_remote(0x705).cif({0x8500, 5}).expect(1002, 0x0001);
  for (int retry = 1; retry <= 3; ++retry)
    s.advance(99ms).tx_remote(0x705).cif({0x8500, 5}).expect(1002, 0x0005).expect(29, 0);
  s.advance(97ms).no_tx().expect(29, 0).advance(1ms).tx_remote(0x705).expect(29, 0x0400);
  s.cif({0x8500, 5}).expect(1000, {0x8501, 5, 0x000D}).expect(29, 0x0400);
  // Heard again: what was wrong stays in the latch. Nothing is done for it without bit 2.
  s.rx(0x705, {0x05}).cif({0x8500, 5}).expect(1002, 0x000D).expect(29, 0x0400).no_tx();
  s.write(29, 0).expect(29, 0x0400);
  s.cif({0x8600, 5}).expect(1000, 0x8601).expect(29, 0).cif({0x8500, 5}).expect(1002, 0x0001).no_tx();
  s.rx(0x705, {0x00}).advance(50ms).no_tx();
}

// "If no response is received from the slave station, the request is repeated after the next 'n x 1ms' has elapsed until the
// specified number of retries has been submitted. If no response is received, a Guarding error will occur" [8.2.3].
TEST(Fx2nGuarding, ARequestIsRepeatedAsOftenAsThereAreRetries) {
  RecordProperty("spec", "FX2N-GRD-008 FX2N-GRD-007");
  for (const std::uint8_t retries : Bytes{1, 2, 7, 255}) {
    for (const bool answers_the_last : {false, true}) {
      Fx2nScenario s;
      start_guarding(s, 1, retries);
      s.advance(99ms).tx_remote(0x705).no_tx().expect(29, 0);
      for (unsigned retry = 1; retry <= retries; ++retry)
        s.advance(99ms).no_tx().advance(1ms).tx_remote(0x705).no_tx().expect(29, 0);
      s.advance(99ms).no_tx().expect(29, 0);
      if (answers_the_last) s.rx(0x705, {0x05});
      s.advance(1ms).tx_remote(0x705).no_tx().expect(29, answers_the_last ? 0 : 0x0400);
      // Guarding goes on.
      s.advance(100ms).tx_remote(0x705).no_tx();
    }
  }
}

TEST(Fx2nGuarding, WithBit2_ASlaveIsBroughtBack) {
  RecordProperty("spec", "FX2N-GRD-006 FX2N-NMT-003 FX2N-NMT-002");
  Fx2nScenario s;
  start_guarding(s, 5);
  // A boot-up message.
  s.rx(0x705, {0x00}).advance(1ms).says(5, 0x1000, 0, 0x191);
  s.tx_remote(0x705).rx(0x705, {0x7F}).tx(0x000, {1, 5}).no_tx();
  answer(s, 0x85);
  s.no_tx();
  // A guarding error.
  s.advance(500ms);
  for (int request = 0; request < 5; ++request) s.tx_remote(0x705);
  s.tx(0x000, {0x82, 5});
  s.expect(29, 0x0400).rx(0x705, {0x00}).advance(1ms).says(5, 0x1000, 0, 0x191);
  s.tx_remote(0x705).rx(0x705, {0x7F}).tx(0x000, {1, 5}).no_tx();
}

// S-82, S-83
TEST(Fx2nGuarding, ToggleBitAndState_AreWatched) {
  RecordProperty("spec", "FX2N-GRD-017 FX2N-GRD-018 FX2N-GRD-016 FX2N-GRD-021");
  Fx2nScenario s;
  start_guarding(s);
  answer(s, 0x05);
  answer(s, 0x05);
  s.cif({0x8500, 5}).expect(1000, {0x8501, 5, 0x0011}).expect(29, 0x0400);
  s.cif({0x8600, 5}).expect(29, 0);
  s.advance(99ms).tx_remote(0x705).rx(0x705, {0x85}).advance(97ms).cif({0x8600, 0});
  s.advance(2ms)
      .tx_remote(0x705)
      .rx(0x705, {0x7F})
      .cif({0x8500, 5})
      .expect(1002, 0x0021)
      .expect(29, 0x0400)
      .no_tx();
}

// S-84, S-85, S-86, S-87
TEST(Fx2nGuarding, StatusOfAll_OfTheNext_OfOne) {
  RecordProperty(
      "spec", "FX2N-GRD-013 FX2N-GRD-014 FX2N-GRD-015 FX2N-GRD-016 FX2N-GRD-019 FX2N-GRD-020 FX2N-ERR-008");
  Fx2nScenario s;
  s.start_as_manager().cif(assign({{5, 1, 10, 2}, {9, 1, 10, 2}, {127, 1, 10, 2}}));
  for (const std::uint8_t node : Bytes{5, 9, 127}) take_guarding(s, node, 10, 2);
  s.expect(1000, 0x8401).cif({0x8500, 128}).expect(1000, {0x8502, 0, 0}).advance(1s).ignore_tx();
  s.cif({0x8500, 0}).expect(1000, {0x8503, 0, 0, 0x000D, 0, 0x000D, 0});
  s.expect(1063, {0, 0x000D, 0, 0}).expect(29, 0x0400);
  const auto next = [&](std::uint16_t parameter, std::uint16_t node, Where where = Where::current()) {
    s.cif({0x8500, parameter})
        .expect(1000, {0x8502, node, static_cast<std::uint16_t>(node == 0 ? 0 : 0x000D)}, where);
  };
  for (const std::uint16_t parameter : Words{128, 255, 0x12FF}) {
    next(parameter, 5);
    next(parameter, 9);
    next(parameter, 127);
  }
  s.cif({0x8500, 0x1205}).expect(1000, {0x8501, 5, 0x000D}).cif({0x8500, 6}).expect(1000, {0x8501, 6, 0});
  s.cif({0x8600, 0x1205}).expect(1000, 0x8601).cif({0x8500, 5}).expect(1002, 0x0001).expect(29, 0x0400);
  for (const std::uint16_t node : Words{9, 127, 9}) next(200, node);
  for (const std::uint16_t parameter : Words{0, 128, 200, 255}) {
    s.advance(1s).ignore_tx();
    s.cif({0x8600, parameter}).expect(1000, 0x8601).expect(29, 0);
    next(128, 0);
    s.cif({0x8500, 0}).expect(1000, {0x8503, 0, 0, 0x0001}).ignore_tx();
    // They fail again when they were heard and are lost.
    for (const std::uint8_t node : Bytes{5, 9, 127}) s.rx(0x700U + node, {0x05});
  }
}

// S-88
TEST(Fx2nGuarding, WrongParameters_AreNamed) {
  RecordProperty("spec", "FX2N-GRD-010 FX2N-GRD-011 FX2N-GRD-012 FX2N-GRD-002 FX2N-GRD-009");
  Fx2nScenario s;
  s.start_as_manager().cif(
      assign({{200, 1, 100, 3}, {0, 1, 100, 3}, {4, 1, 100, 300}, {6, 1, 100, 3}, {7, 1, 100, 3}}));
  s.aborts(6, {0x2B, 0x0C, 0x10, 0, 100, 0, 0, 0}, 0x0602'0000);
  take_guarding(s, 7, 100, 3);
  s.expect(1000,
           {0x84FF, 200, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0, 0xFFFF, 0xFFFF, 300});
  s.expect(1013, {6, 1, 100, 3, 0, 0, 0, 0, 0, 0}).expect_object(0x1F81, 4, 0, 4);
  s.expect_object(0x1F81, 6, 0x0064'0301, 4).expect_object(0x1F81, 7, 0x0064'0301, 4).ignore_tx();
  // Without the network manager no number is a slave's.
  Fx2nScenario slave;
  slave.start(1).cif(assign({{5, 1, 100, 3}, {6, 1, 100, 3}}));
  slave.expect(1000, {0x84FF, 5, 0xFFFF, 0xFFFF, 0xFFFF, 6, 0xFFFF, 0xFFFF, 0xFFFF, 0, 0, 0, 0}).no_tx();
  slave.expect_object(0x1F81, 5, 0, 4);
}

// S-89
TEST(Fx2nGuarding, TakesSixteenRecords) {
  RecordProperty("spec", "FX2N-GRD-001 FX2N-GRD-009");
  Fx2nScenario s;
  s.start_as_manager();
  Words command{0x8400};
  for (std::uint16_t i = 0; i < 16; ++i)
    command.insert(command.end(), {static_cast<std::uint16_t>(20 + i), 0, 0, 1});
  command.insert(command.end(), {99, 1});  // unused words
  s.cif(command);
  for (std::uint8_t i = 0; i < 16; ++i) take_guarding(s, static_cast<std::uint8_t>(20 + i), 0, 1);
  s.expect(1000, 0x8401).expect(1001, Words(66, 0)).expect_object(0x1F81, 35, 0x0000'0100, 4).no_tx();
}

// S-90
TEST(Fx2nGuarding, AGuardedNode_MissesItsManager) {
  RecordProperty("spec", "FX2N-GRD-022 FX2N-OD-009 FX2N-GRD-016 FX2N-GRD-021 FX2N-ERR-008");
  Fx2nScenario s;
  s.start_operational(7).set_object(0x100C, 0, 100, 2).set_object(0x100D, 0, 3, 1).advance(10s).expect(29, 0);
  s.rx_remote(0x707, 1).tx(0x707, {0x05}).rx_remote(0x707, 1).tx(0x707, {0x85});
  s.advance(299ms)
      .no_tx()
      .expect(29, 0)
      .advance(1ms)
      .expect(29, 0x0400)
      .tx(0x087, {0x30, 0x81, 0x11, 7, 0, 0, 0, 0});
  s.cif({0x8500, 7}).expect(1000, {0x8501, 7, 0x0040}).expect(25, 0x0201);
  s.cif({0x8500, 128}).expect(1000, {0x8502, 7, 0x0040});
  s.cif({0x8600, 7}).expect(1000, 0x8601).expect(29, 0).cif({0x8500, 7}).expect(1002, 0).ignore_tx();
}

// "By writing to the Object Dictionary using the CIF SDO write command" [7.2], and what 7.2 does not say.
TEST(Fx2nManager, DefinedBySdoWrite_IsItFromTheNextStartOn_IfThatIsStored) {
  RecordProperty("spec", "FX2N-NMT-001 FX2N-NMT-006");
  for (const bool is_stored : {false, true}) {
    Fx2nScenario s;
    s.start(1).set_object(0x1F80, 0, 1, 4).set_object(0x1F81, 5, 1, 4);
    if (is_stored) s.set_object(0x1010, 1, 0x6576'6173, 4);
    s.advance(10s).no_tx().expect(25, 0x0101).write(25, 1).advance(6s).tx(0x701, {0x00});
    if (is_stored) s.tx(0x000, {0x82, 0});
    s.advance(3s);
    if (is_stored) s.tx(0x000, {1, 5});
    s.no_tx().expect_object(0x1F80, 0, is_stored ? 1 : 0, 4);
  }
}

TEST(Fx2nManager, ItsReset_UndoesModeA_UnlessThatIsStored) {
  RecordProperty("spec", "FX2N-MAPA-008 FX2N-BKP-004");
  for (const bool is_stored : {false, true}) {
    Fx2nScenario s;
    s.start(2).cif({0x8200}).expect(1000, 0x8201).expect_object(0x1400, 1, 0x181, 4);
    if (is_stored) s.set_object(0x1010, 1, 0x6576'6173, 4);
    s.nmt(0x82).wait_tx(0x702, {0x00});
    s.expect_object(0x1400, 1, is_stored ? 0x181 : 0x202, 4);
    s.expect_object(0x141D, 1, is_stored ? 0x288 : 0x8000'0000, 4);
  }
}

TEST(Fx2nManager, StartsItsNetwork) {
  RecordProperty("spec", "FX2N-NMT-001 FX2N-NMT-002 FX2N-CIF-006 FX2N-GEN-002 FX2N-GEN-009 FX2N-NMT-005");
  Fx2nScenario s;
  s.start(1).set_object(0x1F80, 0, 1, 4).set_object(0x1F81, 5, 1, 4).set_object(0x1010, 1, 0x6576'6173, 4);
  s.restart().wait_bit(25, 9, true, 5s).advance(2s);
  // Reset, the own start, the slave's start: in this order, whatever else.
  s.ignore_tx().expect(25, 0x0201);
  Fx2nScenario fresh;
  fresh.start(1)
      .set_object(0x1F80, 0, 1, 4)
      .set_object(0x1F81, 5, 1, 4)
      .set_object(0x1010, 1, 0x6576'6173, 4);
  fresh.write(25, 1).advance(6s).tx(0x701, {0x00}).tx(0x000, {0x82, 0}).advance(3s).tx(0x000, {1, 5}).no_tx();
  // NMT by the dictionary, and by a plain frame.
  fresh.cif({0x0002, 0, 0x1F82, 5, 1, 4}).expect(1000, 0x0003).tx(0x000, {2, 5});
  fresh.cif({0x000C, 0, 0, 0, 2, 0x0580}).expect(1000, 0x000D).tx(0x000, {0x80, 5}).no_tx();
}

}  // namespace
}  // namespace canopus::scenario::fx2n_32can_guarding_test
