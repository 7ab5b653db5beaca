// Every row of spec/me3can1-q/bfm.csv against the running module: default, access, range, persistence, in
// each function mode the row is for, and silence in the others.

#include <functional>
#include <set>

#include "canopus/module/me3can1_q/buffer_table.hpp"

#include "scenarios/me3can1_q/scenario.hpp"
#include "scenarios/spec_table.hpp"

namespace canopus::scenario {
namespace {

using Address = module::BufferAddress;

struct Row : SpecRow {
  std::vector<Address> addresses;  ///< of the field, in each record
  bool is_record = false;  ///< a row that only says where records lie; its fields have rows of their own
  unsigned shift = 0;
  std::uint16_t mask = 0xFFFF;
  std::vector<std::uint16_t> modes;

  [[nodiscard]] bool in(std::uint16_t mode) const {
    return std::find(modes.begin(), modes.end(), mode) != modes.end();
  }
  [[nodiscard]] bool whole_word() const { return mask == 0xFFFF; }
  /// The field in a word.
  [[nodiscard]] std::uint16_t of(std::uint16_t word) const {
    return static_cast<std::uint16_t>((word & mask) >> shift);
  }
  [[nodiscard]] std::string access() const { return (*this)["access_plc"]; }
};

std::vector<Row> bfm() {
  std::vector<Row> rows;
  for (const SpecRow& spec : spec_rows("me3can1-q", "bfm.csv")) {
    Row row{spec, {}, false, 0, 0xFFFF, {}};
    const unsigned first = spec.number("first"), last = spec.number("last");
    const unsigned stride = spec.number("stride"), count = spec.number("count");
    row.is_record = stride > 1 && last - first + 1 == stride * count;
    const unsigned step = row.is_record ? 1 : stride;
    for (unsigned address = first; address <= last; address += step) row.addresses.push_back(address);
    EXPECT_EQ(row.addresses.size(), row.is_record ? stride * count : count) << row.place;
    if (const std::string& bits = spec["bits"]; !bits.empty()) {
      const auto dash = bits.find('-');
      row.shift = static_cast<unsigned>(std::stoul(bits));
      const auto high = dash == std::string::npos ? row.shift : std::stoul(bits.substr(dash + 1));
      row.mask = static_cast<std::uint16_t>(((2U << (high - row.shift)) - 1U) << row.shift);
    }
    const std::string& modes = spec["modes"];
    if (modes == "all" || modes == "405") row.modes.push_back(405);
    if (modes == "all" || modes == "L2") row.modes.insert(row.modes.end(), {11, 29});
    EXPECT_FALSE(row.modes.empty()) << row.place;
    rows.push_back(std::move(row));
  }
  return rows;
}

void start(IntelligentScenario& s, std::uint16_t mode) {
  if (mode == 405) {
    s.power_on();
  } else {
    s.power_on_layer2(mode);
  }
}

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

// --- ranges

bool within(const std::string& range, std::uint16_t value) {
  // "10 | 20", "0-127 | FFFFH", "-60..60", "0000H 0100H": alternatives, each a number or two with what lies
  // between.
  std::string text = range.substr(0, range.find(" ("));
  for (std::size_t at = text.find(" | "); at != std::string::npos; at = text.find(" | "))
    text.replace(at, 3, " ");
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t dots = part.find("..");
    const std::size_t dash = part.find('-', 1);
    if (dots != std::string::npos) {
      const auto number = static_cast<std::int16_t>(value);
      if (number >= *spec_number(part.substr(0, dots)) && number <= *spec_number(part.substr(dots + 2)))
        return true;
    } else if (dash != std::string::npos) {
      if (value >= *spec_number(part.substr(0, dash)) && value <= *spec_number(part.substr(dash + 1)))
        return true;
    } else if (value == *spec_number(part)) {
      return true;
    }
  }
  return false;
}

/// Where a row's range is checked.
enum class Check { at_the_write, at_y12, shown, bits, everything, by_the_command };

const std::map<std::pair<Address, std::string>, Check> checks{
    {{20, ""}, Check::bits},
    {{20, "8"}, Check::bits},
    {{20, "12"}, Check::bits},
    {{20, "0-7"}, Check::bits},  // reserved
    {{20, "9-11"}, Check::bits},
    {{20, "13-15"}, Check::bits},
    {{21, ""}, Check::at_the_write},
    {{22, ""}, Check::bits},
    {{22, "0"}, Check::bits},
    {{22, "1"}, Check::bits},
    {{22, "2-15"}, Check::bits},
    {{24, ""}, Check::at_the_write},
    {{27, ""}, Check::at_the_write},
    {{35, ""}, Check::shown},
    {{36, ""}, Check::shown},
    {{50, ""}, Check::at_the_write},
    {{51, ""}, Check::at_y12},
    {{52, ""}, Check::at_y12},
    {{53, ""}, Check::at_y12},
    {{54, ""}, Check::at_y12},
    {{55, ""}, Check::at_y12},
    {{56, ""}, Check::at_y12},
    {{57, ""}, Check::shown},
    {{58, ""}, Check::at_y12},
    {{59, ""}, Check::at_the_write},
    {{70, ""}, Check::everything},
    {{71, ""}, Check::at_the_write},
    {{400, ""}, Check::at_the_write},
    {{601, ""}, Check::shown},
    {{750, ""}, Check::shown},
    {{805, ""}, Check::shown},
    {{1001, ""}, Check::by_the_command},
    {{1004, ""}, Check::by_the_command},
    {{6000, ""}, Check::everything},  // with B = FFFFH; with an identifier see layer2_settings_test.cpp
    {{6002, ""}, Check::at_the_write},
    {{6003, ""}, Check::everything},
    {{8452, "0-7"}, Check::at_the_write},
    {{8452, "8-15"}, Check::at_the_write},
    {{10002, "0-7"}, Check::at_the_write},
    {{10002, "8"}, Check::bits},
    {{10002, "9"}, Check::bits},
    {{10002, "10"}, Check::bits},
    {{10002, "11"}, Check::bits},
    {{10002, "12"}, Check::bits},
    {{10002, "13-14"}, Check::bits},
    {{10002, "15"}, Check::bits},
};

// Every value of 16 bits: what the range names is taken, all else leaves the word as it was, sets G29.6 and
// shows the address in G39.
void check_at_the_write(IntelligentScenario& s, const Row& row, Address address) {
  std::uint16_t last = s.read(address);
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    const auto value = static_cast<std::uint16_t>(word);
    if ((value & ~row.mask) != 0) continue;  // another field's business
    s.plug_in().write_word(address, value, s.now());
    const auto field = static_cast<std::uint16_t>(value >> row.shift);
    const bool good = within(row["range"], field);
    if (good) last = value;
    ASSERT_EQ(s.read(address), last) << row.place << " G" << address << " = " << value;
    ASSERT_EQ(s.read(29), good ? 0 : 0x0040) << row.place << " G" << address << " = " << value;
    ASSERT_EQ(s.read(39), good ? 0 : address) << row.place << " G" << address << " = " << value;
    if (!good) s.plug_in().write_word(29, 0, s.now());
  }
}

// The year is two digits, or four [docs/modules/me3can1-q.md, reading 25].
bool good_time_word(const Row& row, std::uint16_t value) {
  return within(row["range"], value) || (row.addresses.front() == 51 && value <= 99);
}

void check_at_y12(IntelligentScenario& s, const Row& row) {
  const Address address = row.addresses.front();
  for (unsigned word = 0; word <= 0xFFFF; word += word < 2200 ? 1 : 97) {
    const auto value = static_cast<std::uint16_t>(word);
    s.write(50, {2, 14, 8, 1, 0, 0, 0}).write(58, 0);
    s.write(address, value).expect(address, value).expect(29, 0);
    s.y(0x12, true).expect_x(0x12, true).y(0x12, false);
    const bool good = good_time_word(row, value);
    ASSERT_EQ(s.read(29), good ? 0 : 0x0040) << row.place << " = " << value;
    ASSERT_EQ(s.read(39), good ? 0 : address) << row.place << " = " << value;
    s.write(29, 0);
  }
}

TEST(Me3BufferTable, EveryRange_IsTakenWhole_AndNothingBeyond) {
  RecordProperty("spec", "ME3-ERR-005 ME3-TIME-003 ME3-TIME-010 ME3-TIME-011 ME3-NEC-001 ME3-DLY-001");
  unsigned checked = 0;
  for (const Row& row : bfm()) {
    if (row["range"].empty()) continue;
    const auto how = checks.find({row.addresses.front(), row["bits"]});
    ASSERT_NE(how, checks.end()) << row.place << ": no check for its range";
    ++checked;
    for (const std::uint16_t mode : row.modes) {
      IntelligentScenario s;
      start(s, mode);
      const std::set<Address> ends{row.addresses.front(), row.addresses.back()};
      switch (how->second) {
        case Check::at_the_write:
          for (const Address address : ends) {
            // A transmit slot: its type has a range, a receive slot's mask has none.
            if (row.addresses.front() == 6002) s.write(address - 2, {0xFFFF, 0x5FFF});
            check_at_the_write(s, row, address);
          }
          break;
        case Check::at_y12: check_at_y12(s, row); break;
        case Check::shown:
          for (const Address address : row.addresses) {
            ASSERT_TRUE(within(row["range"], row.of(s.read(address)))) << row.place;
          }
          break;
        case Check::everything:
          for (const Address address : ends) {
            for (const std::uint16_t value : Words{0x0000, 0x0001, 0x7FFF, 0x8000, 0xFFFF}) {
              if (row.addresses.front() == 6000 && mode == 11 && value > 0x7FF && value != 0xFFFF) continue;
              s.write(address, value).expect(address, value).expect(29, 0);
            }
          }
          break;
        case Check::bits:  // every value of the field is one; what it does is in its area's tests
          for (const Address address : ends) s.write(address, 0).expect(29, 0);
          break;
        case Check::by_the_command:
          for (const Address address : row.addresses) {
            s.write(address, 0xFFFF).expect(address, 0xFFFF).expect(29, 0);
          }
          break;
      }
    }
  }
  EXPECT_GT(checked, 40U);
}

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
