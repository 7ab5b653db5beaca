// Every range of spec/me3can1-q/bfm.csv against the running module.

#include "scenarios/me3can1_q/buffer_memory_table.hpp"

namespace canopus::scenario::me3can1_q_buffer_memory_ranges_test {
namespace {

using namespace table_rows;

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

}  // namespace
}  // namespace canopus::scenario::me3can1_q_buffer_memory_ranges_test
