// Every row of spec/fx3u-can/bfm.csv and od.csv of the modes there are against the running module, and the module's page.

#include <set>

#include "canopus/module/models/fx3u_can/buffer_table.hpp"
#include "canopus/module/models/fx3u_can/object_table.hpp"

#include "scenarios/fx3u_can/scenario.hpp"
#include "scenarios/module_page.hpp"

namespace canopus::scenario::fx3u_can_tables_test {
namespace {

using module::BufferAddress;

bool is_of_405(const SpecRow& row) { return (';' + row["modes"] + ';').find(";405;") != std::string::npos; }

TEST(FxTables, EveryWordOf405Mode_HasItsDefault_AndItsAccess) {
  RecordProperty("spec", "FX3U-BFM-006 FX3U-BFM-001");
  BlockScenario s;
  s.power_on();
  unsigned checked = 0;
  for (const SpecRow& row : spec_rows("fx3u-can", "bfm.csv")) {
    if (!is_of_405(row) || !row["bits"].empty() || row["last"].empty()) continue;
    const unsigned first = row.number("first"), last = row.number("last"), stride = row.number("stride");
    const auto value = row["access_plc"] == "none" ? std::optional<long>(0) : spec_number(row["default"]);
    if (!value) continue;
    for (unsigned address = first; address <= last; address += stride) {
      if (address == 727) continue;  // the own state
      EXPECT_EQ(s.read(address), static_cast<std::uint16_t>(*value)) << row.place << " #" << address;
      ++checked;
      if (row["access_plc"] != "none" && row["access_plc"] != "R") continue;
      if (row["access_plc"] == "R" && s.plug_in().buffer_memory() == nullptr) continue;
      const bool is_window = address < 20 || (address >= 100 && address < 400);  // TO is another word
      if (is_window) continue;
      s.write(address, 0x1234).expect(address, static_cast<std::uint16_t>(*value));
    }
  }
  EXPECT_GT(checked, 10'000U);
  s.expect(29, 0).expect(39, 0);
}

// Every value of 16 bits: what the manual names is taken, all else leaves the word as it was.
TEST(FxTables, EveryRange_IsTakenWhole_AndNothingBeyond) {
  RecordProperty("spec", "FX3U-BFM-004 FX3U-BAUD-003 FX3U-NODE-003");
  const std::vector<std::tuple<BufferAddress, int, int>> ranges{
      {26, 0, 6553}, {27, 1, 127}, {50, 0, 3}, {58, 0, 1440}, {59, -60, 60}, {70, 0, 65535}, {71, 50, 32767}};
  BlockScenario s;
  s.power_on().write(50, 2);
  for (const auto& [address, low, high] : ranges) {
    std::uint16_t last = s.read(address);
    for (unsigned word = 0; word <= 0xFFFF; ++word) {
      const auto value = static_cast<std::uint16_t>(word);
      const int number = low < 0 ? static_cast<std::int16_t>(value) : value;
      if (address == 50 && number < 2) continue;  // a consumer's words are fixed
      s.plug_in().write_word(address, value, s.now());
      const bool is_good = number >= low && number <= high;
      if (is_good) last = value;
      ASSERT_EQ(s.read(address), last) << '#' << address << " = " << value;
      ASSERT_EQ((s.read(29) & 0x0040) != 0, !is_good) << '#' << address << " = " << value;
      if (is_good) continue;
      ASSERT_EQ(s.read(39), address);
      s.plug_in().write_word(29, 0, s.now());
    }
    if (address == 27) s.write(27, 127);
  }
  const std::set<std::uint16_t> rates{10, 20, 50, 100, 125, 250, 500, 800, 1000}, modes{405, 11, 29, 417};
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    const auto value = static_cast<std::uint16_t>(word);
    s.plug_in().write_word(24, value, s.now());
    ASSERT_EQ((s.read(29) & 0x0800) == 0, rates.contains(value)) << value;
    s.plug_in().write_word(21, value, s.now());
    ASSERT_EQ((s.read(29) & 0x0040) == 0, modes.contains(value)) << value;
    s.plug_in().write_word(29, 0, s.now());
  }
  s.ignore_tx();
}

TEST(FxTables, EveryObjectOf405Mode_HasItsAccess_Default_AndPersistence) {
  RecordProperty("spec",
                 "FX3U-OD-001 FX3U-OD-003 FX3U-OD-004 FX3U-SPEC-002 FX3U-NV-001 FX3U-NV-002 FX3U-NV-003");
  BlockScenario s;
  s.power_on();
  const auto description = module::fx3u_can::object_dictionary();
  const canopen::ObjectDictionary& objects = s.plug_in().node().dictionary();
  std::set<std::uint16_t> named;
  for (const SpecRow& row : spec_rows("fx3u-can", "od.csv")) {
    if (row["name"].starts_with("417") || row["name"].starts_with("CiA 417") || row["sub_first"].empty())
      continue;
    const unsigned first = row.number("index_first", 16), last = row.number("index_last", 16);
    const unsigned sub_first = row.number("sub_first", 16), sub_last = row.number("sub_last", 16);
    const std::string& access = row["access"];
    const bool there = access == "R" || access == "RW" || access == "W";
    for (unsigned index = first; index <= last; ++index) {
      const auto number = static_cast<std::uint16_t>(index);
      if (there) named.insert(number);
      for (unsigned sub = sub_first; sub <= sub_last; ++sub) {
        const canopen::Entry entry = description->find(number, static_cast<std::uint8_t>(sub));
        const auto place = [&] {
          return row.place + " " + std::to_string(index) + ":" + std::to_string(sub);
        };
        ASSERT_EQ(static_cast<bool>(entry), there || access == "none") << place();
        if (!there) continue;
        const bool reads = entry.description->access != canopen::Access::write_only;
        const bool writes = entry.description->access == canopen::Access::write_only ||
                            entry.description->access == canopen::Access::read_write;
        EXPECT_EQ(reads, access != "W") << place();
        EXPECT_EQ(writes, access != "R") << place();
        if (number != 0x102A && number != 0x1F22) {
          EXPECT_EQ(entry.description->stored, row["persisted"].starts_with("yes")) << place();
        }
        EXPECT_EQ(entry.description->rpdo_mappable, row["pdo_mappable"] == "RPDO") << place();
        EXPECT_EQ(entry.description->tpdo_mappable, row["pdo_mappable"] == "TPDO") << place();
        const bool is_number = !row["default"].empty() &&
                               row["default"].find_first_not_of("0123456789ABCDEFh") == std::string::npos;
        const auto value = is_number ? spec_number(row["default"]) : std::nullopt;
        if (!value || number == 0x1000) continue;
        std::uint64_t actual = 0;
        const auto bytes = objects.bytes(entry);
        for (std::size_t i = bytes.size(); i-- > 0;) actual = actual << 8 | bytes[i];
        EXPECT_EQ(actual, static_cast<std::uint64_t>(*value)) << place();
      }
    }
  }
  for (const canopen::ObjectDescription& object : description->objects()) {
    if (object.index > 0x0008) {
      EXPECT_TRUE(named.contains(object.index)) << std::hex << object.index;
    }
  }
}

TEST(FxTables, TheModulesPage_HasEveryRow) {
  using namespace module::fx3u_can;
  expect_page_has_rows(
      "fx3u-can.md", buffer_table,
      [](const module::BufferRow& row) -> std::string {
        if (row.first == 27 && row.modes == layer2) return "";  // said in words
        if (row.modes == all_modes) return "all";
        if (row.modes == layer2) return "Layer 2";
        return row.modes == canopen_modes ? "405, 417" : row.modes == mode_417 ? "417" : "405";
      },
      "#");
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_tables_test
