// The rows of spec/as-fcopm/bfm.csv, od.csv, errors.csv and commands.csv against the module, and its page.

#include <set>

#include "canopus/module/models/as_fcopm/data_sheet.hpp"
#include "canopus/module/models/as_fcopm/object_table.hpp"

#include "scenarios/as_fcopm/card.hpp"
#include "scenarios/module_page.hpp"

namespace canopus::scenario::as_fcopm_tables_test {
namespace {

using module::BufferAddress;

std::set<BufferAddress> addresses_of(module::Modes mode) {
  std::set<BufferAddress> found;
  for (const module::BufferRow& row : fcopm::register_table)
    for (BufferAddress address = row.first; (row.modes & mode) != 0 && address <= row.last; ++address)
      found.insert(address);
  return found;
}

TEST(FcopmTables, RegistersOfEachRole) {
  RecordProperty("spec", "ASF-GEN-007 ASF-REQ-001 ASF-REQ-002 ASF-SLV-001 ASF-SLV-002");
  std::set<BufferAddress> master, slave;
  for (const SpecRow& row : spec_rows("as-fcopm", "bfm.csv")) {
    const unsigned first = row.number("first"), last = row.number("last");
    if (row["name"].find("rest") != std::string::npos || row["name"].find("(table)") != std::string::npos)
      continue;
    for (unsigned address = first; address <= last; ++address) {
      if (row["modes"].find("master") != std::string::npos) master.insert(address);
      if (row["modes"].find("slave") != std::string::npos) slave.insert(address);
    }
    const auto* const of_row = std::ranges::find_if(
        fcopm::register_table,
        [&](const module::BufferRow& known) { return known.covers(first) && known.covers(last); });
    ASSERT_NE(of_row, fcopm::register_table.end()) << row.place;
    if (row["access_plc"] == "-") continue;
    EXPECT_EQ(of_row->access == module::WordAccess::read, row["access_plc"] == "R") << row.place;
  }
  EXPECT_EQ(addresses_of(fcopm::as_master), master);
  EXPECT_EQ(addresses_of(fcopm::as_slave), slave);
  EXPECT_EQ(master.size(), 2 * (947 + 32) + 3 + 4 + 64U);
  FcopmCard card;
  card.list(3);
  card.start();
  for (const module::RegisterRange& range : card.card.registers()->registers())
    for (BufferAddress address = range.first; address <= range.last; ++address)
      EXPECT_TRUE(master.contains(address) || slave.contains(address)) << address;
  for (const BufferAddress address : master) {  // the program's words keep what is written, and are 0 before
    if (address < 25000) continue;
    ASSERT_EQ(card.d(address), 0U);
    card.set_d(address, static_cast<std::uint16_t>(address));
    ASSERT_EQ(card.d(address), static_cast<std::uint16_t>(address));
  }
  EXPECT_EQ(card.d(24979), 0U);
  EXPECT_EQ(card.d(25979), 0U);
}

TEST(FcopmTables, EveryObject_HasItsAccessAndDefault) {
  RecordProperty(
      "spec",
      "ASF-OD-001 ASF-OD-002 ASF-OD-003 ASF-OD-004 ASF-OD-005 ASF-OD-006 ASF-OD-007 ASF-HB-005 ASF-HB-006 "
      "ASF-SYNC-003 ASF-SLV-003");
  const auto description = fcopm::object_dictionary();
  const canopen::ObjectDictionary objects(description, 9);
  std::set<std::uint16_t> named;
  unsigned checked = 0;
  for (const SpecRow& row : spec_rows("as-fcopm", "od.csv")) {
    const unsigned sub_last = row.number("sub_last", 16);
    for (unsigned index = row.number("index_first", 16); index <= row.number("index_last", 16); ++index) {
      named.insert(static_cast<std::uint16_t>(index));
      for (unsigned sub = row.number("sub_first", 16); sub <= sub_last; ++sub) {
        const canopen::Entry entry =
            description->find(static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub));
        ASSERT_TRUE(entry) << row.place << ' ' << std::hex << index << ':' << sub;
        if (index == 0x1200) continue;  // one row for three
        EXPECT_EQ(canopen::is_writable(entry.description->access), row["access"] == "rw") << row.place;
        ++checked;
        if (index == 0x1008) continue;
        const bool first = (index & 0xFF) == 0;
        std::uint32_t expected = 0;
        switch (index & 0xFF00) {
          case 0x1400:
            expected = sub == 0 ? 3 : sub == 1 ? first ? 0x209 : 0x80000000 : sub == 2 ? 0xFF : 0;
            break;
          case 0x1800:
            expected = sub == 0   ? 5
                       : sub == 1 ? first ? 0x189 : 0x80000000
                       : sub == 2 ? 0xFF
                       : sub == 3 ? 50
                                  : 100;
            break;
          case 0x1600: expected = !first ? 0 : sub == 0 ? 4 : 0x20000010 + sub * 0x100; break;
          case 0x1A00: expected = !first ? 0 : sub == 0 ? 4 : 0x20010010 + sub * 0x100; break;
          default: {
            const std::map<unsigned, std::uint32_t> values{
                {0x100500, 0x80}, {0x101400, 0x89},       {0x101600, 1},  {0x101800, 3}, {0x101801, 0x1DD},
                {0x101802, 0x55}, {0x101803, 0x00010002}, {0x200000, 32}, {0x200100, 32}};
            const auto known = values.find(index << 8 | sub);
            expected = known == values.end() ? 0 : known->second;
          }
        }
        EXPECT_EQ(objects.get<std::uint32_t>(entry), expected)
            << row.place << ' ' << std::hex << index << ':' << sub;
      }
    }
  }
  EXPECT_EQ(checked, 228U);
  for (const canopen::ObjectDescription& object : description->objects())
    EXPECT_TRUE(named.contains(object.index)) << std::hex << object.index;
  EXPECT_FALSE(description->find(0x1800, 4));
}

TEST(FcopmTables, EveryCodeOfTheTables) {
  RecordProperty("spec", "ASF-SR-003 ASF-SR-006 ASF-REQ-020");
  const std::set<std::string> expected{"00",  "01",  "02",  "03",  "04",  "05",  "06",  "07",  "08",
                                       "09",  "0A",  "E0h", "E1h", "E2h", "E3h", "E4h", "E5h", "E6h",
                                       "E7h", "E8h", "F1h", "F2h", "F3h", "F4h", "F5h", "F8h", "FBh",
                                       "FCh", "A0h", "A1h", "A3h", "B0h", "B1h"};
  std::set<std::string> found;
  for (const SpecRow& row : spec_rows("as-fcopm", "errors.csv")) {
    const bool is_code = row["kind"].starts_with("response") || row["kind"].starts_with("SR");
    if (is_code && row["code"] != "0B-FF") found.insert(row["code"]);
  }
  EXPECT_EQ(found, expected) << "each has a test of its own";
}

TEST(FcopmTables, ThePageHasEveryRegister) {
  RecordProperty("spec", "ASF-GEN-010");
  expect_page_has_rows(
      "as-fcopm.md", fcopm::register_table,
      [](const module::BufferRow& row) {
        if (row.first < 1000) return std::string{};
        return std::string(row.modes == fcopm::as_slave ? "slave" : "master");
      },
      "D");
  EXPECT_EQ(fcopm::data_sheet.properties[0].value, "function card slot 2 of an AS300 PLC");
}

}  // namespace
}  // namespace canopus::scenario::as_fcopm_tables_test
