// The windows of the FX3U-CAN's configuration tool: printed names, ranges, defaults [FX3U-CAN 15.1.2].

#include "canopus/module_settings/module_windows.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/module/models/fx3u_can/configuration_tool.hpp"

namespace canopus::module_settings::module_windows_test {
namespace {

const Window& window(std::string_view word) {
  const auto& all = module::fx3u_can::configuration_tool.windows;
  return *std::ranges::find(all, word, &Window::word);
}

const Field& field(std::string_view in, std::string_view name) {
  const auto& fields = window(in).fields;
  return *std::ranges::find(fields, name, &Field::name);
}

struct Range {
  std::string_view window, name;
  std::uint32_t lowest, highest, factory;
};
void PrintTo(const Range& range, std::ostream* out) { *out << range.window << ' ' << range.name; }

class FieldRange : public testing::TestWithParam<Range> {};

TEST_P(FieldRange, IsTheManuals) {
  RecordProperty("spec", "FX3U-TOOL-001 FX3U-TOOL-002 FX3U-TOOL-004");
  const Range& range = GetParam();
  const Field& tested = field(range.window, range.name);
  EXPECT_EQ(why_not(tested, range.lowest), "");
  EXPECT_EQ(why_not(tested, range.highest), "");
  EXPECT_EQ(factory_value(window(range.window), tested, 0, 0), range.factory);
  if (range.lowest > 0) {
    EXPECT_NE(why_not(tested, range.lowest - 1), "");
  }
  if (range.highest < 0xFFFF'FFFF) {
    EXPECT_NE(why_not(tested, range.highest + 1), "");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Manual, FieldRange,
    testing::Values(
        Range{"basic", "Module number", 0, 16, 0}, Range{"basic", "Node ID", 1, 127, 127},
        Range{"basic", "Baud-Rate", 10, 1000, 250}, Range{"basic", "FROM/TO Watchdog", 0, 65530, 200},
        Range{"basic", "SDO timeout", 50, 32767, 500}, Range{"tpdo", "Transmission type", 0, 255, 0xFE},
        Range{"tpdo", "Inhibit time", 0, 65535, 0}, Range{"tpdo", "Event timer", 0, 65535, 0},
        Range{"rpdo", "Transmission type", 0, 255, 0xFE}, Range{"master", "NMT master", 0, 1, 0},
        Range{"master", "Start all nodes", 0, 1, 0}, Range{"master", "NMT master start", 0, 1, 0},
        Range{"master", "Start node", 0, 1, 0}, Range{"master", "Reset all nodes", 0, 1, 0},
        Range{"master", "Stop all nodes", 0, 1, 0}, Range{"master", "Flying master", 0, 1, 0},
        Range{"master", "SYNC - Communication cycle period", 0, 4294967295, 0},
        Range{"master", "Boot time", 0, 4294967295, 0},
        Range{"master", "Start all nodes delay", 0, 65535, 500}, Range{"master", "Timeout", 0, 65535, 100},
        Range{"master", "NMT master negotiation time delay", 0, 65535, 500},
        Range{"master", "NMT master priority", 0, 2, 1},
        Range{"master", "Priority time slot", 0, 65535, 1500},
        Range{"master", "CANopen device time slot", 0, 65535, 10},
        Range{"master", "Multiple NMT master detect cycle time", 0, 65535, 4000},
        Range{"master", "Guard time", 0, 65535, 0}, Range{"master", "Life time factor", 0, 255, 0},
        Range{"slave", "NMT slave", 0, 1, 0}, Range{"slave", "NMT boot slave", 0, 1, 0},
        Range{"slave", "Mandatory", 0, 1, 0}, Range{"slave", "Reset communication", 0, 1, 0},
        Range{"slave", "Retry factor", 0, 255, 0}, Range{"slave", "Guard time", 0, 65535, 0},
        Range{"slave", "Device type", 0, 4294967295, 0}, Range{"slave", "Vendor-ID", 0, 4294967295, 0},
        Range{"slave", "Product code", 0, 4294967295, 0}, Range{"slave", "Revision number", 0, 4294967295, 0},
        Range{"slave", "Serial number", 0, 4294967295, 0},
        Range{"consumer", "Consumer heartbeat time", 0, 65535, 0},
        Range{"producer", "Producer heartbeat time", 0, 65535, 0}));

TEST(ModuleWindows, ARefusedValueIsToldWithItsRange) {
  RecordProperty("spec", "FX3U-TOOL-001");
  EXPECT_EQ(why_not(field("basic", "Node ID"), 128), "Node ID = 128: expected 1 to 127");
  EXPECT_EQ(why_not(field("basic", "Baud-Rate"), 300),
            "Baud-Rate = 300: expected 10, 20, 50, 100, 125, 250, 500, 800, 1000 kbps");
  EXPECT_EQ(why_not(field("basic", "FROM/TO Watchdog"), 205),
            "FROM/TO Watchdog = 205: expected steps of 10 ms");
  EXPECT_EQ(why_not(field("basic", "FROM/TO Watchdog"), 65540),
            "FROM/TO Watchdog = 65540: expected 0 to 65530 ms");
  EXPECT_EQ(why_not(field("basic", "SDO timeout"), 49), "SDO timeout = 49: expected 50 to 32767 ms");
  EXPECT_EQ(why_not(field("master", "NMT master priority"), 3),
            "NMT master priority = 3: expected High, Medium, Low");
}

TEST(ModuleWindows, ListsHoldSoManyRows) {
  RecordProperty("spec", "FX3U-TOOL-002 FX3U-TOOL-004");
  EXPECT_EQ(window("tpdo").most_rows, 80U);
  EXPECT_EQ(window("rpdo").most_rows, 80U);
  EXPECT_EQ(window("slave").most_rows, 126U);
  EXPECT_EQ(window("consumer").most_rows, 126U);
}

TEST(ModuleWindows, DefaultCobIdsFollowPdoNumberAndNodeId) {
  RecordProperty("spec", "FX3U-TOOL-002 FX3U-TOOL-003");
  const auto tpdo = [](std::uint32_t number) {
    return factory_value(window("tpdo"), field("tpdo", "COB-ID"), number, 5);
  };
  const auto rpdo = [](std::uint32_t number) {
    return factory_value(window("rpdo"), field("rpdo", "COB-ID"), number, 5);
  };
  EXPECT_EQ(tpdo(1), 0x40000185U);
  EXPECT_EQ(tpdo(2), 0x40000285U);
  EXPECT_EQ(tpdo(4), 0x40000485U);
  EXPECT_EQ(tpdo(5), 0xC0000000U);
  EXPECT_EQ(tpdo(80), 0xC0000000U);
  EXPECT_EQ(rpdo(1), 0x00000205U);
  EXPECT_EQ(rpdo(4), 0x00000505U);
  EXPECT_EQ(rpdo(5), 0x80000000U);
  EXPECT_EQ(factory_value(window("master"), field("master", "Multiple NMT master detect cycle time"), 0, 5),
            4050U);
}

TEST(ModuleWindows, MappedObjectsHaveTheNamesOfTheDetailsWindow) {
  RecordProperty("spec", "FX3U-TOOL-003");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA1000110),
            "BFM Area Unsigned16 (PLC write access), BFM#11000 (TO)");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA0000108),
            "BFM Area Integer8 (PLC write access), BFM#11000 LByte (TO)");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA0000208),
            "BFM Area Integer8 (PLC write access), BFM#11000 HByte (TO)");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA042A008),
            "BFM Area Unsigned8 (PLC write access), BFM#11319 HByte (TO)");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA042A108), "");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA1020110),
            "BFM Area Unsigned16 (PLC write access), BFM#11240 (TO)");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA1025010),
            "BFM Area Unsigned16 (PLC write access), BFM#11319 (TO)");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA1C00120),
            "BFM Area Integer32 (PLC write access), BFM#11001, #11000 (TO)");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA240A020),
            "BFM Area Float (PLC write access), BFM#11319, #11318 (TO)");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA4800108),
            "BFM Area Integer8 (PLC read access), BFM#10000 LByte (FROM)");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA5800110),
            "BFM Area Unsigned16 (PLC read access), BFM#10000 (FROM)");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA6C0A020),
            "BFM Area Float (PLC read access), BFM#10319, #10318 (FROM)");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0x00050008), "Dummy Unsigned 8 bit");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0x00070020), "Dummy Unsigned 32 bit");
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0xA1000120), "") << "of another width";
  EXPECT_EQ(module::fx3u_can::configuration_tool.object_name(0x60000108), "");
}

TEST(ModuleWindows, ValuesAreWrittenAndReadAsTheWindowShowsThem) {
  RecordProperty("spec", "FX3U-TOOL-001 FX3U-TOOL-004");
  EXPECT_EQ(shown_value(field("tpdo", "COB-ID"), 0x181), "0x00000181");
  EXPECT_EQ(shown_value(field("tpdo", "Transmission type"), 1), "0x01");
  EXPECT_EQ(shown_value(field("master", "NMT master"), 1), "Selected");
  EXPECT_EQ(shown_value(field("master", "NMT master priority"), 0), "High");
  EXPECT_EQ(parse_value(field("master", "NMT master priority"), "low"), 2U);
  EXPECT_EQ(parse_value(field("master", "NMT master"), "Not selected"), 0U);
  EXPECT_EQ(parse_value(field("tpdo", "COB-ID"), "0x80000181"), 0x80000181U);
  EXPECT_EQ(parse_value(field("tpdo", "COB-ID"), "0x180000181"), std::nullopt);
  EXPECT_EQ(parse_value(field("basic", "Node ID"), "5 "), std::nullopt);
  EXPECT_EQ(parse_value(field("basic", "Node ID"), ""), std::nullopt);
}

}  // namespace
}  // namespace canopus::module_settings::module_windows_test
