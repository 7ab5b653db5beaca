// Every row of spec/me3can1-q/bfm.csv against the running module: default, access, reserved bits.

#include "scenarios/me3can1_q/buffer_memory_table.hpp"

namespace canopus::scenario::me3can1_q_buffer_memory_table_test {
namespace {

using namespace table_rows;

// --- defaults

// What a word shows is not its default: the own node's state, and the status, which is another one once the
// initialization has ended.
bool shows_something_else(Address address, std::uint16_t mode) {
  return address == 25 || (address == 727 && mode == 405) || (address == 21 && mode != 405);
}

TEST(Me3BufferTable, EveryRow_HasItsDefault) {
  RecordProperty("spec", "ME3-SYS-018");
  const auto rows = bfm();
  std::set<std::string> compared;
  for (const std::uint16_t mode : Words{405, 11, 29}) {
    IntelligentScenario s;
    start(s, mode);
    for (const Row& row : rows) {
      const auto value = row.access() == "none" ? 0 : spec_number(row["default"]);
      if (!row.in(mode) || row.is_record || !value) continue;
      compared.insert(row.place);
      for (const Address address : row.addresses) {
        if (shows_something_else(address, mode)) continue;
        ASSERT_EQ((s.read(address) & row.mask) >> row.shift, *value)
            << row.place << " G" << address << " mode " << mode;
      }
    }
    // G25 as from power-on.
    s.supply_off();
    s.supply_on();
    for (const Row& row : rows) {
      if (row.addresses.front() != 25 || !row.in(mode)) continue;
      ASSERT_EQ((s.read(25) & row.mask) >> row.shift, *spec_number(row["default"])) << row.place;
    }
    s.wait_bit(25, 7, false).ignore_tx();
  }
  for (const Row& row : rows) EXPECT_TRUE(row.is_record || compared.contains(row.place)) << row.place;
}

// --- access

TEST(Me3BufferTable, SystemAreas_AndWordsOfOtherModes_ReadZero_AndIgnoreWrites) {
  RecordProperty("spec", "ME3-SYS-006 ME3-MODE-007");
  const auto rows = bfm();
  for (const std::uint16_t mode : Words{405, 11, 29}) {
    IntelligentScenario s;
    start(s, mode);
    std::vector<bool> is_the_plcs(65536, false);
    for (const Row& row : rows) {
      if (!row.in(mode) || row.access() == "none") continue;
      for (const Address address : row.addresses) is_the_plcs[address] = true;
    }
    for (Address address = 0; address <= 65535; ++address) {
      if (is_the_plcs[address]) continue;
      if (address == 27) continue;  // in the layer 2 modes every write is an error, see below
      for (const std::uint16_t value : Words{0xFFFF, 0x0000, 0x1234}) {
        s.plug_in().write_word(address, value, s.now());
        ASSERT_EQ(s.read(address), 0) << "G" << address << " mode " << mode;
      }
    }
    s.expect(29, 0).expect(39, 0).expect(40, 0);
    if (mode == 405) continue;
    for (const std::uint16_t value : Words{0, 1, 127, 128}) {
      s.write(27, value).expect(29, 0x0040).expect(39, 27).write(29, 0);
    }
  }
}

TEST(Me3BufferTable, EveryReadOnlyWord_IgnoresWrites) {
  RecordProperty("spec", "ME3-PBUF-008");
  const auto rows = bfm();
  for (const std::uint16_t mode : Words{405, 11, 29}) {
    IntelligentScenario s;
    start(s, mode);
    for (const Row& row : rows) {
      const bool read_only = row.access() == "R" && !row.is_record;
      if (!row.in(mode) || !read_only) continue;
      for (const Address address : row.addresses) {
        const unsigned before = s.read(address) & row.mask;
        for (const std::uint16_t value : Words{0xFFFF, 0x0000, 0x1234}) {
          s.plug_in().write_word(address, value, s.now());
          ASSERT_EQ(s.read(address) & row.mask, before) << row.place << " G" << address << " mode " << mode;
        }
      }
    }
    s.advance(1s).no_tx().expect(29, 0).expect(39, 0).expect(40, 0);
  }
}

// Bits that the table calls reserved, or not used: whatever is written, they read 0, and it is no error.
TEST(Me3BufferTable, EveryReservedBit_StaysZero) {
  RecordProperty("spec", "ME3-SYS-006");
  const auto rows = bfm();
  unsigned seen = 0;
  for (const std::uint16_t mode : Words{405, 11, 29}) {
    IntelligentScenario s;
    start(s, mode);
    for (const Row& row : rows) {
      if (!row.in(mode) || (row["field"] != "reserved" && row["field"] != "not used")) continue;
      ++seen;
      for (const Address address : row.addresses) {
        s.write(address, row.mask);
        ASSERT_EQ(s.read(address) & row.mask, 0) << row.place << " G" << address << " mode " << mode;
        if (address == 20 || address == 22) s.write(address, 0);
      }
    }
    s.expect(29, 0);
  }
  EXPECT_GT(seen, 20U);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_buffer_memory_table_test
