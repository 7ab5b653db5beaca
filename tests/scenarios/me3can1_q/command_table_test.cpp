// Every row of spec/me3can1-q/commands.csv against the running module: which codes are commands in which
// function mode, what each word shows when the command has succeeded, and every result code and error class.

#include <functional>
#include <set>

#include "scenarios/me3can1_q/scenario.hpp"
#include "support/spec_table.hpp"

namespace canopus::scenario::me3can1_q_command_table_test {
namespace {

constexpr std::uint16_t error = 0x000F;

bool is_in(const SpecRow& row, std::uint16_t mode) {
  return row["modes"].find(mode == 405 ? "405" : "L2") != std::string::npos;
}

/// Codes of the table that are commands in this mode.
std::set<std::uint16_t> commands_of(std::uint16_t mode) {
  std::set<std::uint16_t> codes;
  for (const SpecRow& row : spec_rows("me3can1-q", "commands.csv")) {
    const auto code = spec_number(row["command_code"]);
    if (code && is_in(row, mode)) codes.insert(static_cast<std::uint16_t>(*code));
  }
  return codes;
}

void start(IntelligentScenario& s, std::uint16_t mode) {
  if (mode == 405) {
    s.power_on_as(1);
  } else {
    s.power_on_layer2(mode);
    s.online();
  }
}

TEST(Me3CommandTable, OfAllCodes_OnlyThoseOfTheMode_AreCommands) {
  RecordProperty("spec", "ME3-CIF-006 ME3-CIF-026");
  for (const std::uint16_t mode : Words{405, 11, 29}) {
    const auto commands = commands_of(mode);
    EXPECT_EQ(commands.size(), mode == 405 ? 7U : 3U);
    IntelligentScenario s;
    start(s, mode);
    for (unsigned number = 0; number <= 0xFFFF; ++number) {
      if (mode != 405 && number > 0x100 && number < 0xFF00 && number % 16 != 0) continue;
      const auto code = static_cast<std::uint16_t>(number);
      s.write(1000, code).y(0x17, true).advance(1ms);
      ASSERT_TRUE(s.x(0x17)) << std::hex << number;
      s.y(0x17, false);
      const bool unknown = s.read(1000) == error && s.read(1001) == 0x0064;
      ASSERT_EQ(unknown, !commands.contains(code)) << std::hex << number << " mode " << std::dec << mode;
      if (unknown) {
        ASSERT_EQ(s.read(1002), 0);
      }
    }
    s.ignore_tx();
  }
}

// --- words after success

/// Addresses of "1000", "1003 low byte", "1001-1066", "1001+8k (k=0-7)", "1005+8k - 1008+8k".
std::vector<module::BufferAddress> addresses(const std::string& text) {
  std::vector<unsigned> numbers;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (std::isdigit(static_cast<unsigned char>(text[at])) == 0) continue;
    std::size_t used = 0;
    const auto number = std::stoul(text.substr(at), &used);
    if (number >= 1000) numbers.push_back(static_cast<unsigned>(number));
    at += used;
  }
  EXPECT_FALSE(numbers.empty()) << text;
  const unsigned copies = text.find("8k") == std::string::npos ? 1 : 8;
  std::vector<module::BufferAddress> result;
  for (unsigned copy = 0; copy < copies && !numbers.empty(); ++copy) {
    for (unsigned address = numbers.front(); address <= numbers.back(); ++address)
      result.push_back(address + 8 * copy);
  }
  return result;
}

struct Example {
  Words request;
  Words result;                                     ///< from G1000 on; further words are 0
  std::function<void(IntelligentScenario&)> first;  ///< what goes before
};

Words times_eight(std::uint16_t code, const Words& record) {
  Words words{code};
  for (int i = 0; i < 8; ++i) words.insert(words.end(), record.begin(), record.end());
  return words;
}

// Literal examples; the objects are the module's own.
const std::map<std::uint16_t, Example> examples{
    {0x0000,
     {{0x0000},
      {0x0000, 0x4321, 2, 3, 4, 5},
      [](IntelligentScenario& s) {
        s.cif({0x1234, 0x4321, 2, 3, 4, 5});
      }}},
    {0x0002, {{0x0002, 0, 0x1015, 0, 2, 0x0005}, {0x0003, 0, 0x1015, 0}, {}}},
    {0x0004, {{0x0004, 0, 0x1018, 2}, {0x0005, 0, 0x1018, 2, 4, 0xED63, 0x0000}, {}}},
    {0x0006,
     {times_eight(0x0006, {0, 0x1015, 0, 2, 7, 0, 0, 0}),
      times_eight(0x0007, {0, 0x1015, 0, 0, 0, 0, 0, 0}),
      {}}},
    {0x0008,
     {times_eight(0x0008, {0, 0x1018, 2, 0, 0, 0, 0, 0}),
      times_eight(0x0009, {0, 0x1018, 2, 4, 0xED63, 0, 0, 0}),
      {}}},
    {0x000A, {{0x000A, 0x1000, 0xAA81, 0xCCBB, 0xEEDD}, {0x000B}, {}}},
    {0x000C, {{0x000C, 0x0321, 0, 0, 3, 0x0201, 0x0003}, {0x000D}, {}}},
    {0xFFFF, {{0xFFFF}, {0x0000}, {}}},
};

TEST(Me3CommandTable, EveryRow_ShowsItsWord_AfterSuccess) {
  RecordProperty("spec",
                 "ME3-CIF-007 ME3-CIF-011 ME3-CIF-013 ME3-CIF-017 ME3-CIF-019 ME3-CIF-021 ME3-CIF-027");
  unsigned compared = 0;
  for (const SpecRow& row : spec_rows("me3can1-q", "commands.csv")) {
    const auto code = spec_number(row["command_code"]);
    if (!code) continue;  // the errors: below
    const auto example = examples.find(static_cast<std::uint16_t>(*code));
    ASSERT_NE(example, examples.end()) << row.place;
    for (const std::uint16_t mode : Words{405, 11, 29}) {
      if (!is_in(row, mode)) continue;
      IntelligentScenario s;
      start(s, mode);
      if (example->second.first) example->second.first(s);
      s.write(1000, example->second.request);
      s.y(0x17, true)
          .expect(1000, 0xFFFF)
          .expect_x(0x17, false)
          .wait_x(0x17, true)
          .y(0x17, false)
          .ignore_tx();
      if (row["read_field"] == "unused") continue;
      for (const module::BufferAddress address : addresses(row["read_address"])) {
        ++compared;
        const std::size_t word = address - 1000;
        const Words& result = example->second.result;
        ASSERT_EQ(s.read(address), word < result.size() ? result[word] : 0) << row.place << " G" << address;
      }
      // "0003H success; 000FH error; FFFFH busy": the first is what success shows.
      ASSERT_EQ(s.read(1000), *spec_number(row["result_codes"].substr(0, 5))) << row.place;
    }
  }
  EXPECT_GT(compared, 150U);
}

// --- error classes

TEST(Me3CommandTable, EveryErrorClass_OfEveryCommandThatCanHaveIt) {
  RecordProperty("spec", "ME3-CIF-004 ME3-CIF-005 ME3-CIF-006 ME3-CIF-008 ME3-CIF-009 ME3-CIF-010");
  std::set<std::string> classes;
  for (const SpecRow& row : spec_rows("me3can1-q", "commands.csv")) {
    if (row["command_code"] == "(error)" && row["read_field"].starts_with("class ")) {
      classes.insert(row["read_field"].substr(6, 5));
    }
  }
  EXPECT_EQ(classes, (std::set<std::string>{"0064H", "FFFFH", "0003H", "B0FFH", "0F0FH"}));
  for (const auto& [code, example] : examples) {
    for (const std::uint16_t mode : Words{405, 11}) {
      if (!commands_of(mode).contains(code)) {
        IntelligentScenario s;
        start(s, mode);
        s.cif(example.request);
        s.expect(1000, {error, 0x0064, 0, 0, 0});
        continue;
      }
      {  // any write while busy; only FFFFH brings it back
        IntelligentScenario s;
        start(s, mode);
        s.write(1000, example.request).y(0x17, true).write(1066, 1).expect(1000, {error, 0xFFFF, 0, 0});
        s.wait_x(0x17, true).y(0x17, false).expect(1000, {error, 0xFFFF, 0, 0}).ignore_tx();
        s.cif(example.request);
        s.no_tx();
        if (code != 0xFFFF) s.expect(1000, {error, 0xFFFF, 0, 0});
        s.cif({0xFFFF});
        s.expect(1000, {0, 0}).no_tx();
        s.cif({0x1234});
        s.expect(1000, {error, 0x0064});
      }
    }
  }
  // Commands that use the bus: bus-off, and a state without them.
  const std::map<std::uint16_t, Words> remote{{0x0002, {0x0002, 2, 0x1017, 0, 2, 1000}},
                                              {0x0004, {0x0004, 2, 0x1000, 0}},
                                              {0x0006, {0x0006, 2, 0x1017, 0, 2, 1000, 0, 0, 0, 0xFFFF}},
                                              {0x0008, {0x0008, 2, 0x1000, 0, 0, 0, 0, 0, 0, 0xFFFF}},
                                              {0x000A, {0x000A, 0x1000, 1, 0, 0}},
                                              {0x000C, {0x000C, 0x0321, 0, 0, 3, 0x0201, 0x0003}}};
  for (const auto& [code, words] : remote) {
    const std::uint16_t mode = code == 0x000C ? 11 : 405;
    {
      IntelligentScenario s;
      start(s, mode);
      s.error_counters(256, 0).ignore_tx();
      s.cif(words);
      s.expect(1000, {error, 0xB0FF, 0, 0, 0}).no_tx();
    }
    {
      IntelligentScenario s;
      start(s, mode);
      if (mode == 405) {
        s.nmt(0x02, 1);
      } else {
        s.offline();
      }
      s.cif(words);
      if (code == 0x000A) {
        s.expect(1000, {0x000C, 0x0002, 0, 0, 0});  // has an answer of its own for that
      } else {
        s.expect(1000, {error, 0x0F0F, 0, 0, 0});
      }
      s.no_tx();
    }
    if (mode != 405 || code == 0x000A) continue;
    {  // the other node aborts: class 0003H, or the record's own place
      IntelligentScenario s;
      start(s, mode);
      s.write(1000, words).y(0x17, true).advance(1ms).ignore_tx();
      const auto low = static_cast<std::uint8_t>(words[2] & 0xFF);
      s.rx(0x582, {0x80, low, 0x10, 0x00, 0x11, 0x00, 0x09, 0x06}).wait_x(0x17, true);
      if (code == 0x0002 || code == 0x0004) {
        s.expect(1000, {error, 0x0003, 2, 0x0011, 0x0609, 0});
      } else {
        s.expect(1000,
                 {static_cast<std::uint16_t>(code + 0x00F1), 0x0F02, words[2], 0, 0, 0x0011, 0x0609, 0});
      }
    }
    {  // bus-off, and Stopped, in the middle of it: it ends at once, and nothing more is sent
      for (const bool bus_off : {true, false}) {
        IntelligentScenario s;
        start(s, mode);
        s.write(1000, words)
            .y(0x17, true)
            .advance(10ms)
            .expect(1000, 0xFFFF)
            .expect_x(0x17, false)
            .ignore_tx();
        if (bus_off) {
          s.error_counters(256, 0);
        } else {
          s.nmt(0x02, 1);
        }
        s.expect_x(0x17, true)
            .expect(1000, {error, static_cast<std::uint16_t>(bus_off ? 0xB0FF : 0x0F0F), 0, 0, 0});
        s.advance(2s).no_tx();
      }
    }
  }
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_command_table_test
