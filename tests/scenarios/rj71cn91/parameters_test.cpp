// Parameters of the engineering tools that the CPU gives the module when the supply comes, and refresh [RJ71CN91 2.1 to 2.4,
// 3.1, App. 2 G22, App. 3 1F22H, App. 5].

#include "canopus/manager/boot/concise_dcf.hpp"

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_parameters_test {
namespace {

using namespace rj71cn91_presets;

void give(IntelligentScenario& s, std::uint16_t index, std::uint8_t sub, std::uint32_t value,
          unsigned length = 4) {
  EXPECT_EQ(s.plug_in().parameter_object(index, sub, canopen::little_endian(value, length)),
            canopen::AbortCode::none);
}

std::vector<std::uint8_t> file(std::uint16_t heartbeat) {
  return manager::ConciseDcfWriter().add(0x1017, 0, heartbeat, 2).file();
}

TEST(Rj71Parameters, WinOverWhatIsSaved_AtEveryStart) {
  RecordProperty("spec", "RJ71-BM-005");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(9);
  s.write(70, 700).write(71, 800).write(59, 5);
  s.save();
  s.set_object(0x1017, 0, 500, 2).set_object(0x1F80, 0, 0, 4).set_object(0x1015, 0, 70, 2);
  s.store_objects();
  s.ignore_tx().supply_off();
  ASSERT_TRUE(s.plug_in().parameter_word(70, 1000));
  ASSERT_TRUE(s.plug_in().parameter_word(24, 500));
  give(s, 0x1017, 0, 300, 2);
  give(s, 0x1800, 2, 1, 1);
  for (const bool by_supply : {true, false}) {
    if (by_supply) {
      s.power_on();
    } else {
      s.restart();
    }
    s.expect(27, 9).expect(70, 1000).expect(71, 800).expect(59, 5).expect(24, 500).expect(37, 5000);
    s.expect_object(0x1017, 0, 300, 2).expect_object(0x1800, 2, 1, 1).expect_object(0x1015, 0, 70, 2);
    // What the program saves besides does not count the next time.
    s.write(70, 100);
    s.save();
    s.set_object(0x1017, 0, 900, 2).store_objects();
    s.ignore_tx();
  }
  s.restart();
  s.expect(70, 1000);
  s.expect_object(0x1017, 0, 300, 2);
  s.nmt(0x81, 9).advance(1s).ignore_tx();
  s.expect_object(0x1017, 0, 300, 2).ignore_tx();
  // Words that no tool sets, and bad values.
  EXPECT_FALSE(s.plug_in().parameter_word(21, 11));
  EXPECT_FALSE(s.plug_in().parameter_word(71, 49));
  EXPECT_FALSE(s.plug_in().parameter_word(25, 0));
  EXPECT_NE(s.plug_in().parameter_object(0x1000, 0, canopen::little_endian(1, 4)), canopen::AbortCode::none);
  IntelligentScenario other(me3can1_q);
  EXPECT_FALSE(other.plug_in().takes_parameters());
  EXPECT_FALSE(other.plug_in().parameter_word(70, 1));
}

TEST(Rj71Parameters, ConciseDcfs_GoTo1F22H_WhenTheSupplyComes) {
  RecordProperty("spec", "RJ71-CM-009 RJ71-TOOL-002");
  const auto holds = [](IntelligentScenario& s, std::uint8_t node, std::uint16_t heartbeat) {
    s.cif({0x0004, 0, 0x1F22, node});
    if (heartbeat == 0) {
      EXPECT_NE(s.read(1004), 13) << unsigned{node};
      return;
    }
    // 1 entry: 1017:00, 2 bytes.
    s.expect(1000, {0x0005, 0, 0x1F22, node, 13, 1, 0, 0x1017, 0x0200, 0,
                    static_cast<std::uint16_t>(heartbeat << 8)});
  };
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  EXPECT_EQ(write_concise_dcf(s, 5, write_of_1017(7)), 0U);
  s.advance(5s);
  EXPECT_EQ(write_concise_dcf(s, 6, write_of_1017(8)), 0U);
  s.advance(5s).ignore_tx();
  s.supply_off();
  EXPECT_TRUE(s.plug_in().parameter_concise_dcf(5, file(9)));
  EXPECT_TRUE(s.plug_in().parameter_concise_dcf(127, file(10)));
  std::size_t seen = s.plug_in().event_history().size();
  s.power_on();
  EXPECT_EQ(event_codes(s, seen), (std::vector<std::uint16_t>{0x040C, 0x0415, 0x0400}));  // obtained: stored
  holds(s, 5, 9);     // the same node: written over
  holds(s, 6, 8);     // another one stays
  holds(s, 127, 10);  // a new one
  const std::uint32_t writes = s.plug_in().flash_writes();
  s.supply_off();
  seen = s.plug_in().event_history().size();
  s.power_on();  // nothing new: nothing is written
  EXPECT_EQ(event_codes(s, seen), (std::vector<std::uint16_t>{0x0415, 0x0400}));
  EXPECT_EQ(s.plug_in().flash_writes(), writes);
  // What a program deletes is back with the supply, not with a restart.
  EXPECT_EQ(write_concise_dcf(s, 127, {0}), 0U);
  s.advance(5s).ignore_tx();
  s.restart();
  holds(s, 127, 0);
  s.supply_off();
  s.power_on();
  holds(s, 127, 10);
  // A slave gets its settings by the configuration manager.
  s.set_object(0x1F80, 0, 1, 4).set_object(0x1F81, 127, 0x0D, 4).store_objects();
  s.restart();
  boots(s, 127);
  s.tx(0x67F, {0x2B, 0x17, 0x10, 0x00, 0x0A, 0x00, 0, 0}).rx(0x5FF, {0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0});
  s.wait_tx(0x000, {0x01, 0x7F}).ignore_tx();
}

TEST(Rj71Parameters, Wrong_Is2250H) {
  RecordProperty("spec", "RJ71-PARAM-009");
  IntelligentScenario s(rj71cn91);
  for (std::uint8_t node = 2; node <= 61; ++node)
    EXPECT_TRUE(s.plug_in().parameter_concise_dcf(node, file(1)));
  EXPECT_FALSE(s.plug_in().parameter_concise_dcf(62, file(1)));  // 60 nodes
  IntelligentScenario full(rj71cn91);
  full.power_on_as(1);
  EXPECT_EQ(write_concise_dcf(full, 100, write_of_1017(7)), 0U);
  full.advance(5s).ignore_tx();
  full.supply_off();
  for (std::uint8_t node = 2; node <= 61; ++node)
    EXPECT_TRUE(full.plug_in().parameter_concise_dcf(node, file(1)));
  full.power_on();
  ASSERT_EQ(error_codes(full), (std::vector<std::uint16_t>{0x2250}));
  EXPECT_EQ(full.plug_in().module_errors()[0].error_class, module::ErrorClass::moderate);
  EXPECT_EQ(full.plug_in().module_errors()[0].details[0].name, "Parameter type");
  full.cif({0x0004, 0, 0x1F22, 100}).expect(1004, 13);  // what is stored stays as it was
  full.cif({0x0004, 0, 0x1F22, 2}).ignore_tx();
  EXPECT_NE(full.read(1004), 13);
  EXPECT_FALSE(full.plug_in().parameter_concise_dcf(3, std::vector<std::uint8_t>(65532)));
}

TEST(Rj71Parameters, OfTheConfigurationTool_AreFor405ModeOnly) {
  RecordProperty("spec", "RJ71-TOOL-001");
  for (const std::uint16_t mode : Words{11, 29}) {
    IntelligentScenario s(rj71cn91);
    s.power_on();
    s.write(21, mode);
    s.save();
    s.supply_off();
    ASSERT_TRUE(s.plug_in().parameter_word(24, 500));
    s.power_on();
    EXPECT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x2250}));
    s.expect(21, mode).expect(24, 250);
  }
}

// What App. 5 leaves without the tool: words and objects, the program's way.
TEST(Rj71Parameters, WithoutTheTool_WordsAndObjects_SavedAndStored) {
  RecordProperty("spec", "RJ71-PARAM-008");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  s.write(24, 500).write(27, 5).write(59, static_cast<std::uint16_t>(-7)).write(70, 600).write(71, 900);
  s.save();
  s.set_object(0x1F80, 0, 1, 4).set_object(0x1800, 5, 100, 2).store_objects();
  s.set_object(0x1800, 5, 200, 2);
  s.restart();
  s.expect(24, 500).expect(27, 5).expect(59, static_cast<std::uint16_t>(-7)).expect(70, 600).expect(71, 900);
  s.expect(37, 5000).expect_bit(25, 15, true);
  s.expect_object(0x1800, 5, 100, 2).ignore_tx();
}

// The tool sets 1006H alone: without bit 30 of 1005H nothing is produced.
TEST(Rj71Parameters, SyncByTheTool_NeedsBit30Of1005H) {
  RecordProperty("spec", "RJ71-SYNC-005");
  for (const bool by_object : {false, true}) {
    IntelligentScenario s(rj71cn91);
    s.plug_in().preset_node_id(1);
    give(s, 0x1F80, 0, 1);
    give(s, 0x1006, 0, 20'000);
    s.power_on();
    s.advance(2s).ignore_tx();
    if (by_object) s.set_object(0x1005, 0, 0x40000080, 4);
    s.ignore_tx().advance(100ms);
    EXPECT_EQ(s.controller().sent.size(), by_object ? 5U : 0U);
    s.ignore_tx();
  }
}

TEST(Rj71Configuration, WhileTheFlashIsWritten_1F22HIsRefused) {
  RecordProperty("spec", "RJ71-CM-007");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  s.write(22, 1).y(0x1F, true).expect_x(0x1F, false);
  EXPECT_EQ(write_concise_dcf(s, 5, write_of_1017(7)), 0x06060000U);
  s.rx(0x601, {0x2F, 0x22, 0x1F, 0x05, 0x00, 0, 0, 0}).ignore_tx();
  s.wait_x(0x1F, true).y(0x1F, false);
  EXPECT_EQ(write_concise_dcf(s, 5, write_of_1017(7)), 0U);
}

TEST(Rj71Refresh, ExchangesProcessData_Y1DoesNot) {
  RecordProperty("spec", "RJ71-PARAM-001 RJ71-PDO-003");
  IntelligentScenario s(rj71cn91);
  s.plug_in().use_refresh();
  s.power_on_as(1);
  const auto refresh = [&s] { s.plug_in().refresh(s.now()); };
  s.write(13000, 1);
  refresh();
  s.advance(1ms).no_tx();  // not Operational
  s.nmt(0x01, 1).rx(0x201, {7, 0, 0, 0, 0, 0, 0, 0}).rx(0x085, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0});
  s.exchange().no_tx().expect(10000, 0).expect(750, 5);  // Y1: EMCY alone
  refresh();
  s.advance(1ms).tx(0x181, {1, 0, 0, 0, 0, 0, 0, 0}).expect(10000, 7);
  refresh();
  s.advance(1ms).no_tx();
  IntelligentScenario by_request(rj71cn91);  // the default
  by_request.power_on_as(1);
  by_request.nmt(0x01, 1).write(13000, 1);
  by_request.plug_in().refresh(by_request.now());
  by_request.advance(1ms).no_tx();
  by_request.exchange().tx(0x181, {1, 0, 0, 0, 0, 0, 0, 0});
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_parameters_test
