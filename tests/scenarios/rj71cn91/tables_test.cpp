// Every row of spec/rj71cn91/bfm.csv, io.csv, commands.csv and od.csv against the running module, in each function mode
// the row is for, and silence in the others; and the module's page.

#include <set>

#include "canopus/module/engine/signals.hpp"
#include "canopus/module/models/rj71cn91/buffer_table.hpp"
#include "canopus/module/models/rj71cn91/rj71cn91.hpp"

#include "scenarios/me3can1_q/scenario.hpp"
#include "scenarios/module_page.hpp"

namespace canopus::scenario::rj71cn91_tables_test {
namespace {

using Address = module::BufferAddress;

const Words all_modes{405, 11, 29};

/// "405;11;29"
bool is_in(const SpecRow& row, std::uint16_t mode) {
  return (';' + row["modes"] + ';').find(';' + std::to_string(mode) + ';') != std::string::npos;
}

void start(IntelligentScenario& s, std::uint16_t mode) {
  if (mode == 405) {
    s.power_on();
  } else {
    s.power_on_layer2(mode);
  }
}

/// The addresses of a row: whole records, or one field of each.
std::vector<Address> addresses(const SpecRow& row) {
  const unsigned first = row.number("first"), last = row.number("last"), stride = row.number("stride");
  const bool is_record = stride > 1 && last - first + 1 == stride * row.number("count");
  std::vector<Address> result;
  for (unsigned address = first; address <= last; address += is_record ? 1 : stride)
    result.push_back(address);
  return result;
}

/// Words whose value is not their default as soon as the module runs.
bool shows_something_else(Address address, std::uint16_t mode) {
  const bool layer2 = mode != 405;
  return address == 25 || (address == 727 && !layer2) || (address == 21 && layer2) ||
         (address == 37 && layer2);
}

TEST(Rj71Tables, EveryWord_HasItsDefault) {
  unsigned checked = 0;
  for (const std::uint16_t mode : all_modes) {
    IntelligentScenario s(rj71cn91);
    start(s, mode);
    for (const SpecRow& row : spec_rows("rj71cn91", "bfm.csv")) {
      if (!is_in(row, mode) || row["access_plc"] == "none" || !row["bits"].empty()) continue;
      const auto value = spec_number(row["default"]);
      if (!value || row["default"].find(' ') != std::string::npos)
        continue;  // records: below, by their fields
      for (const Address address : addresses(row)) {
        if (shows_something_else(address, mode)) continue;
        EXPECT_EQ(s.read(address), *value) << row.place << " G" << address << " mode " << mode;
        ++checked;
      }
    }
    if (mode == 405) continue;
    for (unsigned slot = 0; slot < 42; ++slot) {
      s.expect(6000 + 4 * slot, {0xFFFF, 0xFFFF, 0, 0})
          .expect(10000 + 7 * slot, {0xFFFF, 0xFFFF, 0, 0, 0, 0, 0});
    }
    for (unsigned message = 0; message < 4; ++message)
      s.expect(8450 + 7 * message, {0xFFFF, 0xFFFF, 0, 0, 0, 0, 0});
  }
  EXPECT_GT(checked, 2000U);
}

// "System area: do not write": reads 0, ignores writes, reports nothing. Likewise what is of the other mode.
TEST(Rj71Tables, SystemAreas_AndWordsOfOtherModes_ReadZero_AndIgnoreWrites) {
  RecordProperty("spec", "RJ71-MODE-007");
  for (const std::uint16_t mode : all_modes) {
    IntelligentScenario s(rj71cn91);
    start(s, mode);
    std::vector<bool> is_the_plcs(32768, false);
    for (const SpecRow& row : spec_rows("rj71cn91", "bfm.csv")) {
      if (!is_in(row, mode) || row["access_plc"] == "none") continue;
      for (const Address address : addresses(row)) is_the_plcs[address] = true;
    }
    EXPECT_EQ(is_the_plcs[10293], true);
    EXPECT_EQ(is_the_plcs[10294], mode == 405);
    EXPECT_EQ(is_the_plcs[13000], mode == 405);
    ASSERT_EQ(s.plug_in().buffer_memory_size(), 32768U);
    for (Address address = 0; address < 32768; ++address) {
      if (is_the_plcs[address]) continue;
      for (const std::uint16_t value : Words{0xFFFF, 0x0000, 0x1234}) {
        s.plug_in().write_word(address, value, s.now());
        ASSERT_EQ(s.read(address), 0) << "G" << address << " mode " << mode;
      }
    }
    s.expect(29, 0).expect(39, 0);
  }
}

TEST(Rj71Tables, EveryReadOnlyWord_IgnoresWrites_AndEveryReservedBitStaysZero) {
  for (const std::uint16_t mode : all_modes) {
    IntelligentScenario s(rj71cn91);
    start(s, mode);
    for (const SpecRow& row : spec_rows("rj71cn91", "bfm.csv")) {
      if (!is_in(row, mode) || row["name"] == "System area") continue;
      const bool reserved = row["field"] == "System area";
      const bool readable = row["access_plc"] == "R" || row["access_plc"] == "R/W0";
      if (!reserved && !readable) continue;
      for (const Address address : addresses(row)) {
        const std::uint16_t before = s.read(address);
        for (const std::uint16_t value : Words{0xFFFF, 0x0000, 0x1234}) {
          if (reserved && !readable && address != 20 && address != 22) continue;
          s.plug_in().write_word(address, value, s.now());
          const std::uint16_t mask = address == 20 ? 0x1100 : address == 22 ? 0x0003 : 0;
          ASSERT_EQ(s.read(address) & ~mask, before & ~mask)
              << row.place << " G" << address << " mode " << mode;
        }
        if (address == 20 || address == 22) s.write(address, 0);
      }
    }
    s.advance(1s).no_tx().expect(29, 0).expect(39, 0);
  }
}

// Every value of 16 bits: what the manual names is taken, all else leaves the word as it was and sets G29.6 and G39.
TEST(Rj71Tables, EveryRange_IsTakenWhole_AndNothingBeyond) {
  RecordProperty("spec", "RJ71-BM-010");
  const std::map<Address, std::set<std::uint16_t>> lists{{21, {405, 11, 29}},
                                                         {24, {10, 20, 50, 100, 125, 250, 500, 800, 1000}}};
  const std::map<Address, std::pair<int, int>> ranges{{27, {1, 127}},   {50, {0, 3}},      {59, {-60, 60}},
                                                      {70, {0, 65535}}, {71, {50, 32767}}, {400, {0, 127}}};
  for (const std::uint16_t mode : all_modes) {
    IntelligentScenario s(rj71cn91);
    start(s, mode);
    const auto check = [&](Address address, auto is_good) {
      std::uint16_t last = s.read(address);
      for (unsigned word = 0; word <= 0xFFFF; ++word) {
        const auto value = static_cast<std::uint16_t>(word);
        s.plug_in().write_word(address, value, s.now());
        if (is_good(value)) last = value;
        ASSERT_EQ(s.read(address), last) << "G" << address << " = " << value;
        ASSERT_EQ(s.read(29), is_good(value) ? 0 : 0x0040) << "G" << address << " = " << value;
        if (is_good(value)) continue;
        ASSERT_EQ(s.read(39), address) << value;
        s.plug_in().write_word(address, last, s.now());  // the cause is removed
        ASSERT_EQ(s.read(29), 0) << value;
      }
      s.clear_errors().ignore_tx();
    };
    for (const auto& [address, values] : lists)
      check(address, [&values](std::uint16_t value) { return values.contains(value); });
    if (mode != 405) continue;
    for (const auto& [address, range] : ranges) {
      check(address, [&range](std::uint16_t value) {
        const int number = range.first < 0 ? static_cast<std::int16_t>(value) : value;
        return number >= range.first && number <= range.second;
      });
    }
  }
}

// --- signals

// Each Y by itself, from ready and idle: only the X of its row's handshake follows, and goes OFF with it.
TEST(Rj71Tables, EveryOutput_DoesWhatItsRowSays_InItsModesOnly) {
  RecordProperty("spec", "RJ71-IO-008");
  const std::set<unsigned> handshakes{0x01, 0x02, 0x03, 0x04, 0x12, 0x13, 0x17, 0x1F};
  const auto rows = spec_rows("rj71cn91", "io.csv");
  for (unsigned number = 0; number < 32; ++number) {
    for (const std::uint16_t mode : all_modes) {
      bool allowed = false;
      unsigned named = 0;
      for (const SpecRow& row : rows) {
        if (row["direction"] != "Y" || !is_in(row, mode)) continue;
        const auto dash = row["number"].find('-');
        const unsigned first = row.number("number", 16);
        const unsigned last =
            dash == std::string::npos
                ? first
                : static_cast<unsigned>(std::stoul(row["number"].substr(dash + 1), nullptr, 16));
        if (number < first || number > last) continue;
        ++named;
        allowed = row["name"] != "Use prohibited";
      }
      EXPECT_EQ(named, 1U) << number << ' ' << mode;
      IntelligentScenario s(rj71cn91);
      start(s, mode);
      if (number == 0x04 && mode != 405) s.online();
      const std::uint32_t before = s.inputs();
      const bool answers = allowed && handshakes.contains(number);
      s.y(number, true).advance(6100ms).ignore_tx();
      EXPECT_EQ(s.inputs(), answers ? before | 1U << number : before) << number << ' ' << mode;
      s.y(number, false);
      EXPECT_EQ(s.inputs(), before) << number << ' ' << mode;
      s.expect(29, 0).advance(10s).ignore_tx();
      EXPECT_EQ(s.inputs(), before) << number << ' ' << mode;
    }
  }
}

// --- commands

TEST(Rj71Tables, OfAllCodes_OnlyThoseOfTheMode_AreCommands) {
  RecordProperty("spec", "RJ71-CIF-003 RJ71-CIF-004");
  for (const std::uint16_t mode : all_modes) {
    std::set<std::uint16_t> commands;
    for (const SpecRow& row : spec_rows("rj71cn91", "commands.csv")) {
      const auto code = row["command_code"] == "any" ? std::nullopt : spec_number(row["command_code"]);
      if (code && is_in(row, mode)) commands.insert(static_cast<std::uint16_t>(*code));
    }
    EXPECT_EQ(commands.size(), mode == 405 ? 7U : 3U);
    IntelligentScenario s(rj71cn91);
    start(s, mode);
    if (mode != 405) s.online();
    for (unsigned number = 0; number <= 0xFFFF; ++number) {
      if (number > 0x100 && number < 0xFF00 && number % 16 != 0) continue;
      const auto code = static_cast<std::uint16_t>(number);
      Words command(67, 0);
      command[0] = code;
      s.write(1000, command).y(0x17, true).advance(1ms);
      ASSERT_TRUE(s.x(0x17)) << std::hex << number;
      s.y(0x17, false);
      const bool unknown = s.read(1000) == 0x000F && s.read(1001) == 0x0064;
      ASSERT_EQ(unknown, !commands.contains(code)) << std::hex << number << " mode " << std::dec << mode;
      if (unknown) s.expect(1002, Words(65, 0));
    }
    s.ignore_tx();
  }
}

// --- objects

std::uint64_t number_of(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
  return value;
}

TEST(Rj71Tables, EveryObject_HasItsAccess_Default_AndPersistence) {
  RecordProperty("spec", "RJ71-OD-006");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  const auto description = module::rj71cn91::object_dictionary();
  const canopen::ObjectDictionary& objects = s.plug_in().node().dictionary();
  std::set<std::uint16_t> named;
  for (const SpecRow& row : spec_rows("rj71cn91", "od.csv")) {
    const unsigned first = row.number("index_first", 16), last = row.number("index_last", 16);
    const unsigned sub_first = row.number("sub_first", 16), sub_last = row.number("sub_last", 16);
    const std::string& access = row["access"];
    const bool there = access == "ro" || access == "rw" || access == "wo";
    for (unsigned index = first; index <= last; ++index) {
      const auto number = static_cast<std::uint16_t>(index);
      if (there) named.insert(number);
      for (unsigned sub = sub_first; sub <= sub_last; ++sub) {
        const canopen::Entry entry = description->find(number, static_cast<std::uint8_t>(sub));
        const bool is_dummy = access == "none (SDO access error)";
        ASSERT_EQ(static_cast<bool>(entry), there || is_dummy)
            << row.place << std::hex << index << ':' << sub;
        if (!there) continue;
        const auto expected = access == "ro"   ? canopen::Access::read_only
                              : access == "wo" ? canopen::Access::write_only
                                               : canopen::Access::read_write;
        // Sub-index 00H of a record is constant: as good as read only.
        if (entry.description->access != canopen::Access::constant || access != "ro") {
          EXPECT_EQ(entry.description->access, expected) << row.place << std::hex << index << ':' << sub;
        }
        EXPECT_EQ(entry.description->stored, row["persisted"].starts_with("yes")) << row.place;
        EXPECT_EQ(entry.description->rpdo_mappable, row["pdo_mappable"] == "RPDO") << row.place;
        EXPECT_EQ(entry.description->tpdo_mappable, row["pdo_mappable"] == "TPDO") << row.place;
        const bool digit = std::isdigit(static_cast<unsigned char>(row["default"][0])) != 0;
        const auto value = digit ? spec_number(row["default"]) : std::nullopt;
        const bool is_number = value && row["default"].find_first_of("+ ") == std::string::npos;
        if (is_number && access != "wo") {
          EXPECT_EQ(number_of(objects.bytes(entry)), static_cast<std::uint64_t>(*value))
              << row.place << std::hex << ' ' << index << ':' << sub;
        }
      }
    }
  }
  for (const canopen::ObjectDescription& object : description->objects()) {
    if (object.index > 0x0008) {
      EXPECT_TRUE(named.contains(object.index)) << std::hex << object.index;
    }
  }
}

// A system area, by SDO as a program meets it.
TEST(Rj71Tables, SystemAreas_AreNoObjects) {
  RecordProperty("spec", "RJ71-OD-006 RJ71-SDO-015");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  for (const std::uint16_t index : Words{0x0000, 0x0009, 0x1002, 0x1007, 0x1013, 0x1019, 0x1200, 0x1280,
                                         0x1F28, 0x2000, 0x5FFF, 0x6000, 0xB000}) {
    s.cif({0x0004, 0, index, 0});
    s.expect_abort(0x06020000);
    s.cif({0x0002, 0, index, 0, 4, 1, 0});
    s.expect_abort(0x06020000);
  }
  s.cif({0x0004, 0, 0x1018, 4});
  s.expect_abort(0x06090011);
  s.cif({0x0004, 0, 0x1000, 1});
  s.expect_abort(0x06090011);
}

TEST(Rj71Tables, Identity_AndStrings) {
  RecordProperty("spec", "RJ71-OD-003 RJ71-SLAVEID-006");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  s.cif({0x0004, 0, 0x1008, 0}).expect(1000, {0x0005, 0, 0x1008, 0, 8, 0x4A52, 0x3137, 0x4E43, 0x3139});
  s.cif({0x0004, 0, 0x1009, 0}).expect(1004, 2);
  s.cif({0x0004, 0, 0x100A, 0}).expect(1004, 2);
  s.expect_object(0x1018, 0, 3, 1);
  s.expect_object(0x1018, 1, 0x01D0, 4);
  s.expect_object(0x1018, 2, 0x0100, 4);
  s.cif({0x0004, 0, 0x1018, 3}).expect(1004, 4).expect(1006, 0x0001);  // major; the minor is the firmware's
  s.cif({0x0004, 0, 0x1018, 4});
  s.expect_abort(0x06090011);
}

// --- the page for the user

TEST(Rj71Tables, TheModulesPage_HasEveryRow) {
  using namespace module::rj71cn91;
  expect_page_has_rows("rj71cn91.md", buffer_table, [](const module::BufferRow& row) -> std::string {
    if (row.modes == module::q_iqr::all_modes) return "all";
    return row.modes == module::q_iqr::layer2 ? "Layer 2" : "405";
  });
}

// Signals, commands and LEDs: those of the model, each once.
TEST(Rj71Tables, TheModulesPage_HasEverySignal_Command_AndLed) {
  const auto& model = module::rj71cn91::model;
  std::set<unsigned> signals;
  std::set<std::uint16_t> commands;
  std::set<std::string> leds;
  for (const auto& cells : page_lines("rj71cn91.md")) {
    if (cells.size() == 5 && cells[0].size() == 2 && cells[0] != "X ") {
      const auto number = static_cast<unsigned>(std::stoul(cells[0], nullptr, 16));
      if (cells[4] == "all" || cells[4] == "405" || cells[4] == "Layer 2") signals.insert(number);
    }
    if (cells.size() == 5 && cells[0].size() == 5 && cells[0].back() == 'H')
      commands.insert(static_cast<std::uint16_t>(*spec_number(cells[0])));
    if (cells.size() == 7 && cells[0] != "LED" &&
        (cells[0] == "RUN" || cells[0] == "ERR" || cells[0] == "CAN ERR"))
      leds.insert(cells[0]);
  }
  std::set<unsigned> of_model;
  for (const module::SignalRow& row : model.signals) of_model.insert(row.number);
  EXPECT_EQ(signals, of_model);
  std::set<std::uint16_t> codes;
  for (const module::CommandRow& row : model.command->commands) codes.insert(row.code);
  EXPECT_EQ(commands, codes);
  std::set<std::string> names;
  for (const module::LedRow& row : model.leds) names.emplace(row.name);
  EXPECT_EQ(leds, names);
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_tables_test
