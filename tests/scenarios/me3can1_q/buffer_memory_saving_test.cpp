// Every row of spec/me3can1-q/bfm.csv: what survives a restart; and its line on the module's page.

#include "scenarios/me3can1_q/buffer_memory_table.hpp"
#include "scenarios/module_page.hpp"

namespace canopus::scenario::me3can1_q_buffer_memory_saving_test {
namespace {

using namespace table_rows;

// --- persistence

// A value that is not the default, for a word that takes writes.
std::optional<std::uint16_t> another_value(Address address, std::uint16_t mode) {
  switch (address) {
    case 20: return 0x0100;
    case 21: return mode;
    case 22: return 1;  // the save itself
    case 24: return 500;
    case 25:
    case 29:
    case 750: return {};  // writes clear
    case 27: return 5;
    case 50: return 2;
    case 70: return 1234;
    default: break;
  }
  if (address >= 401 && address <= 527) return {};
  if (address >= 5001 && address <= 5042) return {};  // only 0
  if (address >= 8450 && address <= 8477 && (address - 8450) % 7 == 1) return 0;
  if (address >= 10000 && address <= 10293 && mode != 405 && (address - 10000) % 7 == 1) return 0;
  if (address >= 10000 && address <= 10293 && mode != 405 && (address - 10000) % 7 == 0) return 0x0123;
  if (address >= 8450 && address <= 8477 && (address - 8450) % 7 == 0) return 0x0123;
  if (address >= 6000 && address <= 6167) {
    // Transmit slots: data words of receive slots are not the program's.
    return std::array<std::uint16_t, 4>{0xFFFF, 0x5FFF, 4, 7}[(address - 6000) % 4];
  }
  return address >= 51 && address <= 71 ? 60 : 3;
}

TEST(Me3BufferTable, EveryRow_SurvivesARestartOrNot_AsItSays) {
  RecordProperty("spec", "ME3-SAVE-005 ME3-SAVE-006 ME3-SAVE-007");
  const auto rows = bfm();
  for (const std::uint16_t mode : Words{405, 11, 29}) {
    IntelligentScenario s;
    start(s, mode);
    std::map<Address, std::uint16_t> defaults;
    std::map<Address, std::uint16_t> written;
    for (const Row& row : rows) {
      for (const Address address : row.addresses) defaults[address] = s.read(address);
    }
    for (const Row& row : rows) {
      const bool takes_writes = row.access() == "R/W" && (mode == 405 || row.addresses.front() != 27);
      if (!row.in(mode) || !takes_writes) continue;
      for (const Address address : row.addresses) {
        const auto value = another_value(address, mode);
        if (value) written[address] = *value;
      }
    }
    for (const auto& [address, value] : written) s.plug_in().write_word(address, value, s.now());
    s.expect(29, 0);
    for (const auto& [address, value] : written) {
      if (address == 20 || address == 22) continue;
      ASSERT_EQ(s.read(address), value) << "G" << address << " mode " << mode;
    }
    s.save();
    s.supply_off();
    s.power_on();
    for (const Row& row : rows) {
      if (!row.in(mode) || row.access() != "R/W" || row["persisted"] == "partly") continue;
      for (const Address address : row.addresses) {
        const auto value = written.find(address);
        if (value == written.end() || address == 25) continue;
        const bool persisted = row["persisted"] == "yes";
        ASSERT_EQ(s.read(address) & row.mask, (persisted ? value->second : defaults[address]) & row.mask)
            << row.place << " G" << address << " mode " << mode;
      }
    }
    s.ignore_tx();
  }
}

// --- the page for the user

TEST(Me3BufferTable, TheModulesPage_HasEveryRow) {
  using namespace module::me3can1_q;
  expect_page_has_rows("me3can1-q.md", buffer_table, [](const module::BufferRow& row) -> std::string {
    if (row.first == 27 && row.modes == layer2) return "";  // said in words
    return row.modes == all_modes ? "all" : row.modes == layer2 ? "Layer 2" : "405";
  });
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_buffer_memory_saving_test
