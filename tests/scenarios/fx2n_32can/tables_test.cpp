// Every row of spec/fx2n-32can/bfm.csv and od.csv against the running module, and the module's page.

#include <set>

#include "canopus/module/models/fx2n_32can/buffer_table.hpp"
#include "canopus/module/models/fx2n_32can/fx2n_32can.hpp"

#include "scenarios/fx2n_32can/scenario.hpp"
#include "scenarios/module_page.hpp"

namespace canopus::scenario::fx2n_32can_tables_test {
namespace {

using module::BufferAddress;

TEST(Fx2nTables, EveryWord_HasItsDefault_AndReservedOnesDoNothing) {
  RecordProperty("spec", "FX2N-BFM-001 FX2N-BFM-002 FX2N-BFM-003 FX2N-BKP-002");
  Fx2nScenario s;
  s.power_on();
  std::set<BufferAddress> reserved;
  unsigned checked = 0;
  for (const SpecRow& row : spec_rows("fx2n-32can", "bfm.csv")) {
    const unsigned first = row.number("first"), last = row.number("last"), stride = row.number("stride");
    const bool is_reserved = row["name"] == "Reserved";
    const bool is_whole = row["bits"] == "0-15" && row["access_plc"] != "W";
    if (!is_reserved && !is_whole) continue;
    const auto value = is_reserved ? std::optional<long>(0) : spec_number(row["default"]);
    if (!value) continue;
    for (unsigned address = first; address <= last; address += stride) {
      if (is_reserved) reserved.insert(address);
      ASSERT_EQ(s.read(address), static_cast<std::uint16_t>(*value)) << row.place << " #" << address;
      ++checked;
    }
  }
  EXPECT_GT(checked, 32'000U);
  for (const BufferAddress address : reserved) {
    s.plug_in().write_word(address, 0x1234, s.now());
    ASSERT_EQ(s.read(address), 0) << address;
  }
  s.expect(29, 0).no_tx();
  // All numbers there are: used ones and reserved ones.
  for (BufferAddress address = 0; address < 32768; ++address) {
    const bool used = address <= 20 || (address >= 24 && address <= 27) || address == 29 || address == 30 ||
                      (address >= 100 && address <= 199) || (address >= 1000 && address <= 1066);
    ASSERT_NE(used, reserved.contains(address)) << address;
  }
}

TEST(Fx2nTables, EveryObject_HasItsAccess_Default_AndPersistence) {
  RecordProperty("spec", "FX2N-OD-006 FX2N-OD-007 FX2N-OD-003 FX2N-OD-011 FX2N-GEN-004");
  Fx2nScenario s;
  s.start(127);
  const auto description = module::fx2n_32can::object_dictionary();
  std::set<std::uint16_t> named;
  for (const SpecRow& row : spec_rows("fx2n-32can", "od.csv")) {
    const unsigned first = row.number("index_first", 16), last = row.number("index_last", 16);
    const unsigned sub_first = row.number("sub_first", 16), sub_last = row.number("sub_last", 16);
    for (unsigned index = first; index <= last; ++index) {
      const auto number = static_cast<std::uint16_t>(index);
      named.insert(number);
      for (unsigned sub = sub_first; sub <= sub_last; ++sub) {
        const auto place = [&] {
          return row.place + " " + std::to_string(index) + ":" + std::to_string(sub);
        };
        const canopen::Entry entry = description->find(number, static_cast<std::uint8_t>(sub));
        ASSERT_TRUE(entry) << place();
        const bool is_request = number == 0x1F82 || number == 0x1F83;
        if (!is_request && (sub != 0 || sub_last == 0)) {
          EXPECT_EQ(entry.description->access == canopen::Access::read_write, row["access"].starts_with("rw"))
              << place();
        }
        if (!is_request && number != 0x1010 && number != 0x1011 && sub != 0) {
          EXPECT_EQ(entry.description->stored, row["persisted"].starts_with("1010")) << place();
        }
        if (number >= 0xA000 && sub != 0) {
          EXPECT_EQ(entry.description->tpdo_mappable, number < 0xA480) << place();
          EXPECT_EQ(entry.description->rpdo_mappable, number >= 0xA480) << place();
        }
      }
    }
  }
  for (const canopen::ObjectDescription& object : description->objects())
    EXPECT_TRUE(named.contains(object.index)) << std::hex << object.index;
  s.expect_object(0x1000, 0, 0x195, 4)
      .expect_object(0x1001, 0, 0, 1)
      .expect_object(0x1004, 0, 0x001E'001E, 4);
  s.expect_object(0x1005, 0, 0x80, 4).expect_object(0x1006, 0, 0, 4).expect_object(0x1007, 0, 0, 4);
  s.expect_object(0x100B, 0, 127, 4).expect_object(0x100C, 0, 0, 2).expect_object(0x100D, 0, 0, 1);
  s.expect_object(0x1010, 1, 1, 4).expect_object(0x1011, 1, 1, 4);
  s.expect_object(0x1200, 1, 0x67F, 4).expect_object(0x1200, 2, 0x5FF, 4).expect_object(0x1F80, 0, 0, 4);
  for (const std::uint16_t index :
       Words{0x0FFF, 0x1002, 0x13FF, 0x2000, 0x5FFF, 0x6000, 0x9FFF, 0xA001, 0xA481, 0xFFFF})
    s.cif({0x0004, 0, index, 0}).expect_abort(0x0602'0000);
  for (const std::uint16_t index : Words{0x1000, 0x1001, 0x1004, 0x1008, 0x100B})
    s.cif({0x0002, 0, index, 0, 4, 1, 0}).expect_abort(0x0601'0002);
}

TEST(Fx2nTables, TheModulesPage_HasEveryRow) {
  expect_page_has_rows(
      "fx2n-32can.md", module::fx2n_32can::buffer_table,
      [](const module::BufferRow& row) -> std::string {
        return row.access == module::WordAccess::read_write ? "both"
               : row.access == module::WordAccess::read     ? "FROM"
                                                            : "TO";
      },
      "#");
}

}  // namespace
}  // namespace canopus::scenario::fx2n_32can_tables_test
