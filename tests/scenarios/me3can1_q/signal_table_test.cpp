// Every row of spec/me3can1-q/io.csv against the running module: which signals do something, in which
// function mode, and that a completed signal comes after its request and goes with it.

#include <set>

#include "scenarios/me3can1_q/scenario.hpp"
#include "support/spec_table.hpp"

namespace canopus::scenario::me3can1_q_signal_table_test {
namespace {

bool is_in(const SpecRow& row, std::uint16_t mode) {
  const std::string& modes = row["modes"];
  EXPECT_TRUE(modes == "all" || modes == "405" || modes == "L2") << row.place;
  return modes == "all" || (modes == "405") == (mode == 405);
}

void start(IntelligentScenario& s, std::uint16_t mode) {
  if (mode == 405) {
    s.power_on_as(1);
  } else {
    s.power_on_layer2(mode);
  }
}

/// Requests that are answered by the X of the same number.
const std::set<unsigned> handshakes{0x01, 0x02, 0x03, 0x04, 0x12, 0x13, 0x17, 0x1F};
/// Requests that clear while they are ON.
const std::set<unsigned> clears{0x0F, 0x10, 0x11};

// Each Y by itself, from ready and idle: only the X of its row's handshake follows, and goes OFF with it.
TEST(Me3SignalTable, EveryOutput_DoesWhatItsRowSays_InItsModesOnly) {
  RecordProperty("spec", "ME3-IO-026 ME3-IO-027 ME3-IO-002 ME3-SYS-002");
  unsigned outputs = 0;
  for (const SpecRow& row : spec_rows("me3can1-q", "io.csv")) {
    if (row["direction"] != "Y") continue;
    const unsigned number = row.number("number", 16);
    const bool prohibited = row["name"] == "Use prohibited";
    EXPECT_EQ(prohibited, !handshakes.contains(number) && !clears.contains(number)) << row.place;
    ++outputs;
    for (const std::uint16_t mode : Words{405, 11, 29}) {
      IntelligentScenario s;
      start(s, mode);
      if (number == 0x04 && mode != 405) s.online();
      const std::uint32_t before = s.inputs();
      const bool answers = !prohibited && handshakes.contains(number) && is_in(row, mode);
      s.y(number, true).advance(6100ms).ignore_tx();
      EXPECT_EQ(s.inputs(), answers ? before | 1U << number : before) << row.place << ' ' << mode;
      s.y(number, false);
      EXPECT_EQ(s.inputs(), before) << row.place << ' ' << mode;
      s.expect(29, 0).advance(10s).ignore_tx();
      EXPECT_EQ(s.inputs(), before) << row.place << ' ' << mode;
    }
  }
  EXPECT_EQ(outputs, 32U);
}

// Each X: what sets it (the column set_when), in its modes; and never in the others.
TEST(Me3SignalTable, EveryInput_ComesInItsModes_AndProhibitedOnesNever) {
  RecordProperty("spec", "ME3-IO-026 ME3-IO-027");
  const auto cause = [](IntelligentScenario& s, unsigned number, std::uint16_t mode) {
    switch (number) {
      case 0x00: break;  // ready: from the end of the initialization on
      case 0x04:
        if (mode != 405) s.online();
        s.y(0x04, true);
        break;
      case 0x0F: s.write(24, 300); break;
      case 0x10:
        s.set_object(0x1016, 1, 0x00020064, 4);
        s.rx(0x702, {0x05}).advance(200ms);
        break;
      case 0x11: s.rx(0x085, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0}); break;
      default: s.y(number, true).advance(6100ms);
    }
    s.ignore_tx();
  };
  unsigned inputs = 0;
  for (const SpecRow& row : spec_rows("me3can1-q", "io.csv")) {
    if (row["direction"] != "X") continue;
    const unsigned number = row.number("number", 16);
    const bool prohibited = row["name"] == "Use prohibited";
    ++inputs;
    for (const std::uint16_t mode : Words{405, 11, 29}) {
      if (number == 0x10 && mode != 405) continue;  // no command makes it there: next test
      IntelligentScenario s;
      start(s, mode);
      cause(s, number, mode);
      EXPECT_EQ(s.x(number), !prohibited && is_in(row, mode)) << row.place << ' ' << mode;
      s.ignore_tx();
    }
  }
  EXPECT_EQ(inputs, 32U);
}

// Everything at once in a Layer 2 mode: the signals of the CANopen mode stay OFF.
TEST(Me3SignalTable, SignalsOfTheOtherMode_StayOff) {
  RecordProperty("spec", "ME3-IO-027");
  for (const std::uint16_t mode : Words{11, 29}) {
    IntelligentScenario s;
    start(s, mode);
    s.online();
    for (unsigned node = 1; node < 128; ++node)
      s.rx(0x700 + node, {0x05}).rx(0x080 + node, {0, 0x10, 1, 0, 0, 0, 0, 0});
    s.rx(0x100, {0, 0, 0, 0, 0x10, 0x27});
    for (const unsigned number : {0x10U, 0x11U, 0x12U, 0x13U}) s.y(number, true);
    s.advance(100s);
    for (const SpecRow& row : spec_rows("me3can1-q", "io.csv")) {
      if (row["direction"] == "X" && row["modes"] == "405") s.expect_x(row.number("number", 16), false);
    }
    s.expect(29, 0).expect(25, 0).no_tx();
  }
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_signal_table_test
