// spec/me3can1-q/scenarios.md, section 3: save and restore.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_save_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Save);

TEST_P(Save, S09_Save_SurvivesRestartAndPowerCycle) {
  spec("ME3-SAVE-001 ME3-IO-025", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(70, 1000);
  s.write(22, 1);
  s.expect_x(0x1F, false);
  s.y(0x1F, true);
  s.wait_x(0x1F, true);
  s.expect(22, 0);
  s.y(0x1F, false);
  s.expect_x(0x1F, false);
  s.restart();
  s.expect(70, 1000);
  s.supply_off();
  s.power_on();
  s.expect(70, 1000);
}

TEST_P(Save, S10_RestoreAlone_ChangesTheMemory_NotTheFlash) {
  spec("ME3-SAVE-002", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(24, 500);
  s.write(27, 5);
  s.write(59, 7);
  s.write(70, 1000);
  s.write(71, 600);
  s.save();
  const unsigned writes = s.flash().writes;
  s.write(22, 2);
  s.y(0x1F, true);
  s.wait_x(0x1F, true);
  s.expect(22, 0).expect(21, 405).expect(24, 250).expect(27, 127).expect(59, 0).expect(70, {500, 500});
  s.y(0x1F, false);
  EXPECT_EQ(s.flash().writes, writes);
  s.restart();
  s.expect(21, 405).expect(24, 500).expect(27, 5).expect(59, 7).expect(70, {1000, 600});
}

TEST_P(Save, S11_BothBits_ResetMemoryAndFlash) {
  spec("ME3-SAVE-003", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(70, 1000);
  s.write(71, 600);
  s.write(59, 7);
  s.write(27, 5);
  s.write(24, 500);
  s.save();
  s.save(3);
  s.expect(70, {500, 500}).expect(27, 127).expect(24, 250).expect(59, 0);
  s.restart();
  s.expect(70, {500, 500}).expect(27, 127).expect(21, 405).expect(24, 250).expect(37, 2500).expect(59, 0);
}

TEST_P(Save, BothBits_ResetWhatTheOtherModesHaveStored_ASaveKeepsIt) {
  spec("ME3-SAVE-003", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2(11);
  s.write(6000, {0xFFFF, 0x5FFF, 4, 1}).write(10000, {0x0123, 0}).write(21, 405);
  s.save();
  s.restart();
  s.write(70, 700);
  s.save();  // keeps what the Layer 2 mode has stored
  s.write(21, 11);
  s.save();
  s.restart();
  s.expect(6000, {0xFFFF, 0x5FFF, 4, 1}).expect(10000, {0x0123, 0}).write(21, 405);
  s.save();
  s.restart();
  s.expect(70, 700);
  s.save(3);
  s.write(21, 11);
  s.save();
  s.restart();
  s.expect(6000, {0xFFFF, 0xFFFF, 0, 0}).expect(10000, {0xFFFF, 0xFFFF});
}

TEST_P(Save, RequestWithoutABit_CompletesAndChangesNothing) {
  spec("ME3-SAVE-004", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(70, 1000);
  s.save(0);
  s.expect(70, 1000);
  EXPECT_EQ(s.flash().writes, 0U);
  s.restart();
  s.expect(70, 500);
}

TEST(Me3Save, CanopenMode_SavesExactlyTheSixWords) {
  RecordProperty("spec", "ME3-SAVE-005");
  IntelligentScenario s;
  s.power_on();
  s.write(20, 0x0100);
  s.write(24, 500);
  s.write(27, 5);
  s.write(50, 2);
  s.write(51, {20, 3, 4, 5, 6, 7});
  s.write(58, 9);
  s.write(59, 0xFFC4);  // -60
  s.write(70, 1000);
  s.write(71, 50);
  s.write(400, 7);
  s.write(13000, 0x1234);
  s.save();
  s.restart();
  s.expect(21, 405).expect(24, 500).expect(27, 5).expect(59, 0xFFC4).expect(70, 1000).expect(71, 50);
  s.expect(50, {1, 14, 8, 1, 0, 0, 0, 5, 0}).expect(400, 0).expect(13000, 0);
}

TEST_P(Save, S12_ObjectDictionary_StoreAndRestore) {
  spec("ME3-STO-001 ME3-STO-002 ME3-STO-004 ME3-STO-007", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.expect_object(0x1010, 1, 1, 4);
  s.expect_object(0x1011, 1, 1, 4);
  s.set_object(0x1017, 0, 1000, 2);
  s.ignore_tx();
  s.cif({0x0002, 0, 0x1010, 1, 4, 0x6173, 0x6577});  // not "save"
  s.expect_abort(0x08000020);
  for (const std::uint16_t length : Words{1, 2, 3}) {
    s.cif({0x0002, 0, 0x1010, 1, length, 0x6173, 0x6576});
    s.expect_abort(0x06070013);
  }
  for (const std::uint16_t object : Words{0x1010, 0x1011}) {
    for (const auto& [low, high] : std::vector<std::pair<std::uint16_t, std::uint16_t>>{
             {object == 0x1011 ? 0x6173 : 0x6F6C, object == 0x1011 ? 0x6576 : 0x6461}, {0, 0}, {1, 0}}) {
      s.cif({0x0002, 0, object, 1, 4, low, high});
      s.expect_abort(0x08000020);
    }
  }
  EXPECT_EQ(s.flash().writes, 0U);
  s.store_objects();
  s.y(0x02, true);
  s.wait_x(0x02, true);
  s.y(0x02, false);
  s.ignore_tx();
  s.advance(1s);
  s.tx(0x77F, {0x7F}).no_tx();
  s.supply_off();
  s.power_on();
  s.advance(1s);
  s.tx(0x77F, {0x7F}).no_tx();
  s.set_object(0x1011, 1, 0x64616F6C, 4);
  s.expect_object(0x1017, 0, 1000, 2);
  s.expect_object(0x1010, 1, 1, 4);
  s.expect_object(0x1011, 1, 1, 4);
  s.ignore_tx();
  s.restart();
  s.expect_object(0x1017, 0, 0, 2);
  s.advance(5s);
  s.no_tx();
}

TEST_P(Save, S12_StoreAfterRestore_PutsTheOldValuesBack) {
  spec("ME3-STO-005", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.set_object(0x1015, 0, 77, 2);
  s.store_objects();
  s.set_object(0x1011, 1, 0x64616F6C, 4);
  s.store_objects();
  s.restart();
  s.expect_object(0x1015, 0, 77, 2);
}

TEST_P(Save, S13_BufferMemorySave_DoesNotCoverTheObjectDictionary) {
  spec("ME3-SAVE-008", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.set_object(0x1017, 0, 1000, 2);
  s.save();
  s.restart();
  s.expect_object(0x1017, 0, 0, 2);
}

// One value of each object that 1010H stores [Tab. 4-6].
TEST_P(Save, Store_KeepsEveryStorableObject) {
  spec("ME3-STO-008", "");
  struct Value {
    std::uint16_t index;
    std::uint8_t sub;
    std::uint32_t value;
    unsigned length;
  };
  const std::vector<Value> values{
      {0x1005, 0, 0x00000081, 4}, {0x1006, 0, 5000, 4},
      {0x100C, 0, 0, 2},          {0x100D, 0, 3, 1},
      {0x1012, 0, 0x00000100, 4}, {0x1015, 0, 50, 2},
      {0x1016, 1, 0x000205DC, 4}, {0x1016, 0x7F, 0x00030BB8, 4},
      {0x1017, 0, 2000, 2},       {0x1028, 5, 0x80000085, 4},
      {0x1029, 1, 1, 1},          {0x1F26, 2, 11245, 4},
      {0x1F27, 2, 45000000, 4},   {0x1F81, 2, 0x0064030D, 4},
      {0x1F84, 2, 0x000F0191, 4}, {0x1F85, 2, 0x71, 4},
      {0x1F86, 2, 2, 4},          {0x1F87, 2, 3, 4},
      {0x1F88, 2, 4, 4},          {0x1F89, 0, 10000, 4},
      {0x1F90, 1, 101, 2},        {0x1F90, 2, 501, 2},
      {0x1F90, 3, 2, 2},          {0x1F90, 4, 1600, 2},
      {0x1F90, 5, 11, 2},         {0x1F90, 6, 5555, 2},
      {0x1402, 2, 1, 1},          {0x1802, 2, 3, 1},
      {0x1805, 3, 100, 2},        {0x1805, 5, 200, 2},
      {0x1401, 1, 0x80000301, 4}, {0x1801, 1, 0xC0000281, 4},
      {0x1020, 1, 5, 4},          {0x1020, 2, 6, 4},
  };
  IntelligentScenario s(GetParam());
  s.power_on();
  for (const Value& v : values) s.set_object(v.index, v.sub, v.value, v.length);
  // A mapping of its own.
  s.set_object(0x1404, 1, 0x80000000, 4);
  s.set_object(0x1604, 0, 0, 1);
  s.set_object(0x1604, 1, 0xA4C00108, 4);
  s.set_object(0x1604, 0, 1, 1);
  s.set_object(0x1A04, 0, 0, 1);
  s.set_object(0x1A04, 1, 0xA0400108, 4);
  s.set_object(0x1A04, 0, 1, 1);
  s.set_object(0xA580, 1, 0x1234, 2);  // process data are not stored
  s.set_object(0x1020, 1, 5, 4);
  s.set_object(0x1020, 2, 6, 4);
  s.store_objects();
  s.ignore_tx();
  s.restart();
  s.expect_object(0xA580, 1, 0, 2);
  for (const Value& v : values) s.expect_object(v.index, v.sub, v.value, v.length);
  s.expect_object(0x1604, 0, 1, 1);
  s.expect_object(0x1604, 1, 0xA4C00108, 4);
  s.expect_object(0x1A04, 0, 1, 1);
  s.expect_object(0x1A04, 1, 0xA0400108, 4);
  s.ignore_tx();
  // 1F80H alone: it would change the module's role.
  s.set_object(0x1F80, 0, 0x40, 4);
  s.store_objects();
  s.restart();
  s.expect_object(0x1F80, 0, 0x40, 4);
  s.ignore_tx();
}

TEST(Me3Save, SupplyCutDuringASave_IsReportedOnce_AndTheOldSettingsAreThere) {
  RecordProperty("spec", "ME3-SAVE-009 ME3-ERR-003");
  IntelligentScenario s;
  s.power_on();
  s.write(70, 1000);
  s.save();
  s.write(70, 2000);
  s.write(22, 1);
  s.y(0x1F, true);
  s.advance(50ms);
  s.supply_off();
  s.power_on();
  s.expect(29, 0x0010).expect_x(0x0F, true).expect(70, 1000);
  s.y(0x0F, true);
  s.expect(29, 0x0010).expect_x(0x0F, true);  // its cause is not the program's to clear
  s.y(0x0F, false);
  s.restart();
  s.expect(29, 0).expect_x(0x0F, false);
}

TEST_P(Save, FlashThatCannotBeWritten_IsReported_AndTheOldSettingsAreThere) {
  spec("ME3-ERR-003 ME3-IO-025", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(70, 1000);
  s.save();
  s.flash().writable = false;
  s.write(70, 2000);
  s.save();  // G22 -> 0, X1F
  s.expect(29, 0x0010).expect_x(0x0F, true).expect(70, 2000);
  s.y(0x0F, true).y(0x0F, false).expect(29, 0x0010);
  s.flash().writable = true;
  s.restart();
  s.expect(29, 0).expect(70, 1000).expect_x(0x0F, false);
}

TEST_P(Save, DamagedFlash_IsReported_AndAnsweredWithDefaults) {
  spec("ME3-ERR-003", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(70, 1000);
  s.save();
  s.flash().blobs["buffer-memory"].state = module::NonVolatileMemory::Content::State::damaged;
  s.restart();
  s.expect(29, 0x0010).expect(70, 500).expect_x(0x0F, true);
  s.save();
  s.restart();
  s.expect(29, 0);
}

TEST_P(Save, PresetSettings_HoldUntilTheModuleSavesItsOwn) {
  IntelligentScenario s(GetParam());
  EXPECT_TRUE(s.plug_in().preset_word(27, 1));
  EXPECT_FALSE(s.plug_in().preset_word(27, 128));
  EXPECT_FALSE(s.plug_in().preset_word(25, 0));
  EXPECT_FALSE(s.plug_in().preset_word(13000, 1));
  EXPECT_EQ(s.plug_in().preset_object(0x1017, 0, Bytes{0xE8, 0x03}), canopen::AbortCode::none);
  EXPECT_EQ(s.plug_in().preset_object(0x1017, 0, Bytes{0xE8}), canopen::AbortCode::length_too_low);
  EXPECT_EQ(s.plug_in().preset_object(0x1018, 1, Bytes{1, 0, 0, 0}), canopen::AbortCode::write_of_read_only);
  EXPECT_EQ(s.plug_in().preset_object(0x1018, 9, Bytes{1, 0, 0, 0}), canopen::AbortCode::no_sub_index);
  EXPECT_EQ(s.plug_in().preset_object(0x1F82, 1, Bytes{5}), canopen::AbortCode::cannot_store);
  EXPECT_EQ(s.plug_in().preset_object(0x1F81, 2, Bytes{2, 0, 0, 0}), canopen::AbortCode::invalid_value);
  s.supply_on();
  s.wait_tx(0x701, {0x00});
  s.expect_object(0x1017, 0, 1000, 2);
  s.ignore_tx();
  s.set_object(0x1011, 1, 0x64616F6C, 4);
  s.save(3);
  s.ignore_tx();
  s.restart();
  s.expect(27, 127);
  s.expect_object(0x1017, 0, 0, 2);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_save_test
