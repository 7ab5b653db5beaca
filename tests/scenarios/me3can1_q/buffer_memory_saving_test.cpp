// Every row of spec/me3can1-q/bfm.csv: what survives a restart; and its line on the module's page.

#include "paths.hpp"
#include "scenarios/me3can1_q/buffer_memory_table.hpp"

namespace canopus::scenario {
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

// docs/modules/me3can1-q.md has a line for every row of the module's own table, and none besides: range,
// access, default, whether it is saved, modes.
TEST(Me3BufferTable, TheModulesPage_HasEveryRow) {
  using namespace module::me3can1_q;
  std::ifstream in(CANOPUS_SOURCE_DIR "/docs/modules/me3can1-q.md");
  std::multimap<std::string, std::vector<std::string>> lines;  // by "first-last modes"
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("| G") || line.starts_with("| G25 bit") || line.starts_with("| G29 bit")) continue;
    std::vector<std::string> cells;
    for (std::size_t at = 1; at < line.size();) {
      const std::size_t end = line.find(" |", at);
      if (end == std::string::npos) break;
      cells.push_back(line.substr(at + 1, end > at ? end - at - 1 : 0));
      at = end + 2;
    }
    if (cells.size() != 7) continue;  // another table
    lines.emplace(cells[0] + ' ' + cells[6], cells);
  }
  for (const module::BufferRow& row : buffer_table) {
    if (row.first == 27 && row.modes == layer2) continue;  // said in words
    std::string key = 'G' + std::to_string(row.first);
    if (row.first != row.last) key += "-G" + std::to_string(row.last);
    key += row.modes == all_modes ? " all" : row.modes == layer2 ? " Layer 2" : " 405";
    const auto line = lines.find(key);
    ASSERT_NE(line, lines.end()) << key;
    const std::vector<std::string>& cells = line->second;
    const bool writes = row.access != module::WordAccess::read;
    EXPECT_EQ(cells[2], writes ? row.offline_only ? "R/W offline" : "R/W" : "R") << key;
    EXPECT_EQ(spec_number(cells[3]), row.initial) << key;
    EXPECT_EQ(cells[5], row.stored == module::Stored::yes ? "yes" : "no") << key;
    using Kind = module::ValueRange::Kind;
    if (row.range.kind == Kind::between || row.range.kind == Kind::between_signed) {
      EXPECT_EQ(cells[4], row.range.low == row.range.high
                              ? std::to_string(row.range.low)
                              : std::to_string(row.range.low) + (row.range.low < 0 ? " to " : "-") +
                                    std::to_string(row.range.high))
          << key;
    }
    lines.erase(line);
  }
  for (const auto& [key, cells] : lines) ADD_FAILURE() << "no such row: " << key;
}

}  // namespace
}  // namespace canopus::scenario
