// spec/me3can1-q/scenarios.md, section 2: start-up procedures - supply, initialization, NMT reset.

#include "canopus/canopen/dictionary/stored_values.hpp"
#include "canopus/module/storage/flash_memory.hpp"

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_initialization_test {
namespace {

TEST(Me3StartUp, S04_PowerOn_InitializesFirst_ThenPreOperationalWithBootUpFrame) {
  RecordProperty("spec", "ME3-STAT-001 ME3-STAT-006 ME3-NMT-001 ME3-NMT-002 ME3-ERR-004 ME3-ERR-012");
  IntelligentScenario s;
  s.supply_on();
  s.expect(25, 0x0080).expect_x(0x00, false).no_tx();
  s.write(24, 125);
  s.expect_bit(29, 5, true).expect(40, 24).expect_x(0x0F, true);
  s.write(27, 5);
  s.expect(40, 24);  // the first one stays
  s.wait_bit(25, 7, false);
  s.expect(25, 0x0100).expect(24, 250).expect(27, 127).expect_x(0x00, true);
  s.tx(0x77F, {0x00}).no_tx();
  s.expect_bit(29, 5, true);  // latched
  s.y(0x0F, true);
  s.expect(29, 0).expect(40, 0).expect_x(0x0F, false);
  s.y(0x0F, false);
}

// Whatever the program does meanwhile: no word takes a write, no request is carried out, before or after.
TEST(Me3StartUp, Initialization_TakesNothing) {
  RecordProperty("spec", "ME3-STAT-005 ME3-STAT-006 ME3-ERR-004 ME3-ERR-012");
  for (const bool by_restart : {false, true}) {
    IntelligentScenario s;
    if (by_restart) {
      s.power_on();
      s.y(0x02, true).ignore_tx();
    } else {
      s.supply_on();
    }
    Words before;
    for (module::BufferAddress address = 0; address < 14100; ++address) before.push_back(s.read(address));
    for (const module::BufferAddress first : {1000U, 20U, 13000U}) {
      s.write(first, 1).expect(29, 0x0020).expect(40, static_cast<std::uint16_t>(first)).expect(39, 0);
      s.expect_x(0x0F, true).y(0x0F, true).expect(29, 0).expect(40, 0).expect_x(0x0F, false).y(0x0F, false);
    }
    for (const module::BufferAddress address :
         {20U, 21U, 22U, 24U, 25U, 27U, 29U, 50U, 59U, 70U, 71U, 400U, 750U, 1000U, 1066U, 13000U, 14023U}) {
      s.write(address, 1);
      if (address != 25 && address != 29) s.expect(address, before[address]);
    }
    s.expect(29, 0x0020).expect(40, 20);
    const std::uint32_t inputs = s.inputs();
    for (const unsigned y : {0x01U, 0x03U, 0x04U, 0x10U, 0x11U, 0x12U, 0x13U, 0x17U, 0x1FU}) s.y(y, true);
    s.advance(500ms).expect(25, 0x0080).no_tx();
    EXPECT_EQ(s.inputs(), inputs);
    s.wait_bit(25, 7, false).ignore_tx().y(0x02, false).advance(1s);
    EXPECT_EQ(s.inputs(), 0x8001U);  // ready, and the error of the writes
    EXPECT_EQ(s.flash().writes, 0U);
    s.expect(29, 0x0020).expect(40, 20).no_tx();
  }
}

TEST(Me3StartUp, NmtReset_IsAnInitializationToo) {
  RecordProperty("spec", "ME3-STAT-005 ME3-STAT-006 ME3-ERR-004");
  for (const std::uint8_t command : Bytes{0x81, 0x82}) {
    IntelligentScenario s;
    s.power_on_as(1);
    s.nmt(command, 1).expect_bit(25, 7, true);
    s.write(1000, 4).write(70, 1000).write(13000, 7).expect(29, 0x0020).expect(40, 1000);
    for (const unsigned y : {0x01U, 0x11U, 0x12U, 0x13U, 0x17U, 0x1FU}) s.y(y, true);
    s.wait_bit(25, 7, false).tx(0x701, {0x00}).advance(1s).no_tx().expect(25, 0x0140);
    EXPECT_EQ(s.inputs(), 0x8001U);
    s.expect(1000, 0).expect(70, 500).expect(13000, 0);
  }
}

// Initialization first: nothing is heard or sent, and its end is the boot-up message [3.5.5, 4.8.1, 4.8.2].
TEST(Me3StartUp, NmtReset_SilentUntilTheBootUpMessageEndsIt) {
  RecordProperty("spec", "ME3-NMT-002 ME3-STAT-005");
  for (const std::uint8_t command : Bytes{0x81, 0x82}) {
    IntelligentScenario s;
    s.power_on_as(1);
    s.nmt(1).expect(25, 0x0201);
    s.nmt(command, 1).expect(25, 0x0080).expect(601, 7).no_tx();
    s.rx(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
    s.nmt(1, 1).advance(9ms).no_tx();
    s.expect(25, 0x0080).expect(601, 7);
    s.advance(1ms).tx(0x701, {0x00}).expect(25, 0x0140).expect(601, 0x7F);
    s.rx(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
    s.tx(0x581, {0x43, 0x00, 0x10, 0x00, 0x95, 0x01, 0x00, 0x00});
  }
}

TEST(Me3StartUp, S04_FactoryState_EveryWordHasItsDefault) {
  RecordProperty("spec", "ME3-BAUD-005 ME3-NST-002");
  IntelligentScenario s;
  s.power_on();
  s.expect(20, {0, 405, 0, 0, 250, 0x0100, 0, 127, 0, 0});
  s.expect(30, {0, 0, 0, 0, 0, 0, 0, 2500, 875, 0, 0});
  s.expect(50, {1, 14, 8, 1, 0, 0, 0, 5, 0, 0});
  s.expect(70, {500, 500});
  for (module::BufferAddress a = 400; a <= 527; ++a) s.expect(a, 0);
  for (module::BufferAddress a = 601; a <= 726; ++a) s.expect(a, 0);
  s.expect(727, 0x007F);
  for (module::BufferAddress a = 750; a <= 859; ++a) s.expect(a, 0);
  for (module::BufferAddress a = 1000; a <= 1066; ++a) s.expect(a, 0);
  for (module::BufferAddress a = 10000; a <= 11023; ++a) s.expect(a, 0);
  for (module::BufferAddress a = 13000; a <= 14023; ++a) s.expect(a, 0);
}

/// Puts one more object into the stored object dictionary, as if an older firmware had stored it.
void store_besides(RamMemory& memory, std::uint16_t index, std::uint8_t sub, const Bytes& value) {
  module::FlashMemory flash(memory, {"object-dictionary"});
  flash.load();
  auto content = flash.read("object-dictionary").bytes;
  canopen::append_stored_value(content, canopen::StoredLength::two_bytes, index, sub, value);
  flash.write("object-dictionary", content);
}

TEST(Me3StartUp, FaultyStoredConfiguration_KeepsInitializing_UntilTheObjectDictionaryIsReset) {
  RecordProperty("spec", "ME3-STAT-013");
  IntelligentScenario s;
  s.power_on();
  s.set_object(0x1017, 0, 1000, 2).store_objects();
  store_besides(s.flash(), 0x1A00, 1, {0x10, 0x01, 0x99, 0x5F});  // maps 5F99H, which does not exist
  store_besides(s.flash(), 0x1A00, 0, {1});
  s.supply_off();
  s.ignore_tx();
  s.supply_on();
  s.advance(60s);
  s.expect(25, 0x0080).expect_x(0x00, false).no_tx();  // no boot-up message, no heartbeat
  s.write(24, 125);
  s.expect_bit(29, 5, true).expect(40, 24);
  for (const unsigned y : {0x01U, 0x03U, 0x04U, 0x11U, 0x12U, 0x13U, 0x1FU}) {
    s.y(y, true).advance(1s);
    EXPECT_EQ(s.inputs(), 0x8000U);  // the refused write; nothing else acts
    s.y(y, false);
  }
  s.set_object(0x1011, 1, 0x64616F6C, 4);  // by CIF, although it initializes
  s.expect(25, 0x0080);                    // and only the restart uses it
  s.restart();
  s.expect(25, 0x0100).expect_x(0x00, true);
  s.expect_object(0x1017, 0, 0, 2).expect_object(0x1A00, 0, 4, 1);
}

TEST(Me3StartUp, FaultyStoredMapping_OfMoreThanEightBytes_KeepsInitializingToo) {
  RecordProperty("spec", "ME3-STAT-013");
  IntelligentScenario s;
  s.power_on();
  s.store_objects();
  for (const std::uint8_t sub : Bytes{1, 2, 3})
    store_besides(s.flash(), 0x1600, sub, {0x20, sub, 0x80, 0xA6});
  store_besides(s.flash(), 0x1600, 0, {3});  // three values of 32 bits
  s.supply_off();
  s.supply_on();
  s.advance(60s);
  s.expect(25, 0x0080).expect_x(0x00, false);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_initialization_test
