// The live table as text: every size, every name, trouble first, and what does not fit is counted.

#include "canopus/cli/run/table_layout.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/text/printable.hpp"

#include "cli/table_picture.hpp"

namespace canopus::cli::table_layout_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using namespace std::chrono_literals;

constexpr TableSize sizes[] = {{24, 80}, {10, 40}, {60, 200}, {1, 1},  {3, 20}, {2, 5},
                               {4, 10},  {5, 30},  {6, 27},   {7, 79}, {8, 41}, {19, 120}};

/// A plant whose nodes 1.. are all operational. What a test does not change is as on a good day.
struct Plant130 {
  explicit Plant130(unsigned nodes) {
    names.reserve(nodes);
    state.plant = "first plant";
    state.now = can::Time{12345ms};
    state.lag = 100us;
    state.buses.push_back({"line1", 250'000, {.frames = 2941, .now = 0.042, .peak = 0.08}});
    for (unsigned i = 1; i <= nodes; ++i) {
      names.push_back(fmt::format("device {}", i));
      plant::NodeStatus node;
      node.label = {"line1", names.back(), static_cast<std::uint8_t>(i)};
      node.state = canopen::NmtState::operational;
      node.is_on = true;
      state.nodes.push_back({node, 50});
    }
    state.modules.push_back({.label = state.nodes[0].status.label,
                             .plc = "plc1",
                             .head = 0x30,
                             .is_on = true,
                             .cpu = module::CpuState::run,
                             .inputs = 0x8005,
                             .outputs = 0x2,
                             .words = {{25, 33281}, {10000, 23116}}});
    state.servers = {"MC protocol 127.0.0.1:5007", "socketcand 127.0.0.1:29536"};
    state.has_keys = true;
  }
  plant::NodeStatus& node(unsigned number) { return state.nodes[number - 1].status; }
  void missing(std::uint8_t node_id) {
    manager::BootRecord record{.step = manager::BootStep::presence_pause,
                               .error = manager::BootError::no_answer,
                               .attempts = 2,
                               .since = can::Time{12s}};
    state.boots.push_back({{"line1", {}, node_id}, node(1).label, record});
  }
  void message(can::Time at, std::string text, bool is_error = true) {
    state.messages.push_back({at, std::move(text), is_error});
    ++(is_error ? state.errors : state.warnings);
  }
  [[nodiscard]] std::vector<std::string> lines(TableSize size, TableView view = {}) const {
    return texts(lay_out(state, view, size));
  }

  std::vector<std::string> names;
  TableState state;
};

void expect_no_wrap(const Plant130& plant, TableSize size, TableView view = {}) {
  const auto lines = plant.lines(size, view);
  EXPECT_LE(lines.size(), size.rows);
  for (const std::string& line : lines) {
    EXPECT_LE(text::columns_of(line), size.columns) << size.rows << " rows: " << line;
    EXPECT_EQ(line, text::printable(line));
  }
}

TEST(TableLayout, FourNodesOnA80x24Terminal) {
  Plant130 plant(4);
  plant.state.events = {"     1.503  line1 node 4 (device 4): operational"};
  EXPECT_THAT(
      plant.lines({24, 80}),
      ElementsAre("first plant                  4 of 4 operational       12.3 s   late by 100 us",
                  "line1    250 kbit/s   load   4.2 %   0 error frames   peak   8.0 %   2941 frames",
                  "plc1 U3  X30 X32 X3F  Y31   G25 = 33281 (8201H)  G10000 = 23116 (5A4CH)", "",
                  "Node  Name      NMT state        Last EMCY  CAN       PDO/s",
                  "   1  device 1  operational      -          -            50",
                  "   2  device 2  operational      -          -            50",
                  "   3  device 3  operational      -          -            50",
                  "   4  device 4  operational      -          -            50", "",
                  "     1.503  line1 node 4 (device 4): operational", "", "", "", "", "", "", "", "", "", "",
                  "", "", "q ends   ? help   MC protocol 127.0.0.1:5007   socketcand 127.0.0.1:29536"));
}

TEST(TableLayout, A40x10Terminal_HasTheHeaderTroubleAndTheLatestError) {
  Plant130 plant(130);
  plant.node(7).error_state = can::ErrorState::bus_off;
  plant.node(7).transmit_errors = 256;
  plant.message(can::Time{3s}, "ME3CAN1-Q U0: G24 = 300: not a baud rate");
  plant.message(can::Time{5s}, "ME3CAN1-Q U0: G24 = 301: not a baud rate");
  EXPECT_THAT(
      plant.lines({10, 40}),
      ElementsAre("first plant    129/130 operational", "line1   250 kbit/s  load   4.2 %",
                  "plc1 U3  X30 X32 X3F  Y31 … 2 more", "Node  Name        NMT state",
                  "   7  device 7    bus-off", "      bus-off: TEC 256, REC 0",
                  "   1  device 1    operational", "… 128 more nodes",
                  "2 errors: ME3CAN1-Q U0: G24 = 301: not …", "q ends   ? help   MC protocol 127.0.0.1…"));
}

TEST(TableLayout, NothingWraps_AtAnySize) {
  for (const unsigned nodes : {1U, 130U}) {
    Plant130 plant(nodes);
    plant.missing(99);
    plant.node(1).error_state = can::ErrorState::error_passive;
    for (int i = 0; i < 30; ++i) {
      plant.message(can::Time{std::chrono::seconds(i)}, std::string(300, 'e') + " and so on", i % 3 != 0);
    }
    plant.state.events.assign(8, std::string(200, 'v'));
    for (const TableSize size : sizes) {
      expect_no_wrap(plant, size);
      expect_no_wrap(plant, size, {.first = 50});
      expect_no_wrap(plant, size, {.first = 5000, .help = true});
    }
  }
}

TEST(TableLayout, WideCombiningAndHostileNames_TakeTheirColumns) {
  Plant130 plant(3);
  plant.state.plant = "工場の名前がとても長いプラントです";
  plant.state.buses[0].name = "線路一番の長い名前";
  plant.node(1).label.name = "エンコーダエンコーダエンコーダエンコーダ";
  plant.node(2).label.name = "e\u0301e\u0301e\u0301";
  plant.node(3).label.name = "x\x1b[2J\nforged\xE4";
  for (const TableSize size : sizes) expect_no_wrap(plant, size);
  const auto lines = plant.lines({24, 80});
  EXPECT_THAT(lines,
              Contains("   1  エンコーダエンコーダエンコ…   operational      -          -            50"));
  EXPECT_THAT(lines, Contains("   2  e\u0301e\u0301e\u0301                           operational      -      "
                              "    -            50"));
  EXPECT_THAT(lines, Contains(StartsWith("   3  x\\x1B[2J\\nforged\\xE4 ")));
}

TEST(TableLayout, TroubleComesFirst_WorstFirst) {
  Plant130 plant(130);
  plant.node(10).is_on = false;
  plant.node(20).emergencies = 3;
  plant.node(20).last_emergency = 0x8110;
  plant.node(30).state = canopen::NmtState::pre_operational;
  plant.node(40).error_state = can::ErrorState::error_passive;
  plant.node(40).receive_errors = 130;
  plant.missing(125);
  plant.state.boots.push_back({plant.node(60).label,
                               plant.node(1).label,
                               {.step = manager::BootStep::failed,
                                .failed_step = manager::BootStep::identity,
                                .error = manager::BootError::product,
                                .index = 0x1018,
                                .sub = 2,
                                .expected = 0x1234,
                                .received = 0x406}});
  plant.state.troubles.push_back({plant.node(1).label, "no process data exchange: the CPU is in STOP"});
  plant.node(80).error_state = can::ErrorState::bus_off;
  std::vector<std::string> rows;
  for (const std::string& line : plant.lines({60, 80})) {
    if (line.size() > 6 && line[3] != ' ' && line[0] == ' ')
      rows.push_back(line.substr(0, line.find("  ", 18)));
  }
  rows.resize(9);
  EXPECT_THAT(rows, ElementsAre("  80  device 80   operational", "   1  device 1    operational",
                                "  60  device 60   operational", " 125  device 125  operational",
                                "  40  device 40   operational", "  30  device 30   pre-operational",
                                "  20  device 20   operational", "  10  device 10   off",
                                "   2  device 2    operational"));
  const auto lines = plant.lines({60, 80});
  EXPECT_THAT(lines, Contains("      no process data exchange: the CPU is in STOP"));
  EXPECT_THAT(lines, Contains("      error passive: TEC 0, REC 130"));
  EXPECT_THAT(lines, Contains(HasSubstr("expected 00001234H")));
  EXPECT_THAT(lines, Contains("  20  device 20   operational      8110H x3   -            50"));
}

TEST(TableLayout, AModulesErrorLed_IsTrouble) {
  Plant130 plant(3);
  plant.state.modules[0].label = plant.node(3).label;
  plant.state.modules[0].leds = {{.name = "RUN", .pattern = module::LedPattern::on},
                                 {.name = "ERR.", .pattern = module::LedPattern::on, .error = true}};
  const auto lines = plant.lines({24, 80});
  EXPECT_THAT(lines[5], StartsWith("   3  device 3 "));
  EXPECT_EQ(lines[6], "      LED ERR.: on");
}

TEST(TableLayout, ForcedValues_StandBehindTroubleAndBeforeTheOthers) {
  Plant130 plant(4);
  plant.node(4).is_on = false;
  plant.state.forced.push_back({.device = plant.node(3).label,
                                .object = "6000:01",
                                .name = "Digital inputs 1 to 8",
                                .type = canopen::DataType::unsigned8,
                                .value = 3,
                                .until = can::Time{5200ms}});
  const auto lines = plant.lines({24, 80});
  EXPECT_THAT(lines[5], StartsWith("   4  device 4 ")) << "off";
  EXPECT_THAT(lines[6], StartsWith("   3  device 3 "));
  EXPECT_EQ(lines[7], "      6000:01 (Digital inputs 1 to 8) forced to 3 until 5.200 s");
  EXPECT_THAT(lines[8], StartsWith("   1  device 1 "));
}

TEST(TableLayout, WhatDoesNotFit_IsCountedAndScrolled) {
  const Plant130 plant(130);
  const TableSize size{24, 80};
  const TablePicture top = lay_out(plant.state, {}, size);
  EXPECT_EQ(top.first, 0U);
  const auto lines = texts(top);
  EXPECT_EQ(lines[lines.size() - 2], fmt::format("… {} more nodes", 130 - top.page));
  EXPECT_THAT(lines[5], StartsWith("   1  device 1 "));

  const auto middle = plant.lines(size, {.first = 40});
  EXPECT_EQ(std::vector(middle.begin(), middle.begin() + 5), std::vector(lines.begin(), lines.begin() + 5))
      << "the header stays";
  EXPECT_THAT(middle[5], StartsWith("  41  device 41 "));
  EXPECT_EQ(middle[middle.size() - 2], fmt::format("… 40 above, {} more nodes", 90 - top.page));

  const TablePicture end = lay_out(plant.state, {.first = 9999}, size);
  EXPECT_EQ(end.first, end.last);
  EXPECT_THAT(texts(end), Contains(HasSubstr("  device 130 ")));
  EXPECT_EQ(texts(end)[size.rows - 2], fmt::format("… {} nodes above", 130 - end.page));
}

TEST(TableLayout, ATerminalWithRoomForOneNode_CountsTheOthersBesideIt) {
  Plant130 plant(130);
  plant.node(99).state = canopen::NmtState::stopped;
  EXPECT_THAT(plant.lines({3, 40}),
              ElementsAre("first plant    129/130 operational", "line1   250 kbit/s  load   4.2 %",
                          StartsWith("  99  device 99  ")));
  EXPECT_THAT(plant.lines({3, 40})[2], HasSubstr(" … 129 more nodes"));
  EXPECT_THAT(plant.lines({1, 1}), ElementsAre("…"));
  EXPECT_THAT(plant.lines({3, 20}), ElementsAre(StartsWith("f"), StartsWith("line1"), StartsWith("  99  ")));
}

TEST(TableLayout, SignalsAndBusesWithoutRoomAbove_AreAtTheEnd) {
  Plant130 plant(2);
  for (unsigned i = 0; i < 9; ++i) {
    plant.state.modules.push_back(plant.state.modules[0]);
    plant.state.modules.back().plc = "plc2";
    plant.state.modules.back().head = static_cast<std::uint16_t>(0x40 + 0x20 * i);
    plant.state.buses.push_back({fmt::format("line{}", i + 2), 1'000'000, {}});
  }
  plant.state.buses[7].load.error_frames = 3;
  const auto lines = plant.lines({24, 80});
  EXPECT_THAT(lines[1], StartsWith("line8    1000 kbit/s   load   0.0 %   3 error frames"))
      << "trouble first";
  EXPECT_THAT(lines[4], HasSubstr(" … 6 more"));
  EXPECT_THAT(lines[8], HasSubstr(" … 6 more"));
  const auto end = plant.lines({24, 80}, {.first = 999});
  EXPECT_THAT(end, Contains(StartsWith("plc2 U14  X140 X142 X14F")));
  EXPECT_THAT(end, Contains(StartsWith("line10 ")));
}

TEST(TableLayout, SeveralBuses_HaveAColumn) {
  Plant130 plant(2);
  plant.state.buses.push_back({"line2", 1'000'000, {}});
  plant.node(2).label.bus = "line2";
  const auto lines = plant.lines({24, 80});
  EXPECT_THAT(lines, Contains(StartsWith("Node  Bus    Name      NMT state")));
  EXPECT_THAT(lines, Contains(StartsWith("   2  line2  device 2  operational")));
}

TEST(TableLayout, CpuInStopAndModuleWithoutSupply_AreSaid) {
  Plant130 plant(1);
  plant.state.modules[0].cpu = module::CpuState::stop;
  plant.state.modules[0].inputs = plant.state.modules[0].outputs = 0;
  EXPECT_THAT(plant.lines({24, 80})[2], StartsWith("plc1 U3  CPU in STOP   G25 = 33281"));
  plant.state.modules[0].is_on = false;
  EXPECT_THAT(plant.lines({24, 80})[2], StartsWith("plc1 U3  off   G25 = 33281"));
}

TEST(TableLayout, ErrorsStandUnderTheTable_NewestLastWithTheNumberOfOthers) {
  Plant130 plant(130);
  for (int i = 1; i <= 12; ++i) {
    plant.message(can::Time{std::chrono::seconds(i)}, fmt::format("error number {}", i));
  }
  plant.state.errors = 5000;
  const auto lines = plant.lines({24, 80});
  EXPECT_THAT(std::vector(lines.end() - 6, lines.end() - 1),
              ElementsAre("", "… 4997 more errors, printed when the run ends", "10.000  error number 10",
                          "11.000  error number 11", "12.000  error number 12"));
}

TEST(TableLayout, ALongError_IsWrappedNotCut) {
  Plant130 plant(4);
  plant.message(can::Time{1s},
                "line1 node 9: no answer to 1000H. Check that the device is powered and connected, "
                "has this node-ID and this bit rate.");
  const auto lines = plant.lines({24, 80});
  EXPECT_THAT(lines,
              Contains("1.000  line1 node 9: no answer to 1000H. Check that the device is powered and"));
  EXPECT_THAT(lines, Contains("      connected, has this node-ID and this bit rate."));
}

TEST(TableLayout, Help_NamesTheKeys) {
  const Plant130 plant(4);
  const std::string help = fmt::format("{}", fmt::join(plant.lines({24, 80}, {.help = true}), "\n"));
  for (const char* word :
       {"PageUp", "PageDown", "Home", "End", "Ctrl-C", "Ctrl-Z", "?: close", "5007", "29536"}) {
    EXPECT_THAT(help, HasSubstr(word));
  }
}

TEST(TableLayout, WithoutKeys_OnlyWhatWorksIsNamed) {
  Plant130 plant(4);
  plant.state.has_keys = false;
  EXPECT_THAT(plant.lines({24, 80}).back(), StartsWith("Ctrl-C ends   MC protocol"));
}

TEST(TableLayout, ALatePlant_SaysSoInEveryWidth) {
  Plant130 plant(4);
  plant.state.lag = 300ms;
  EXPECT_THAT(plant.lines({24, 80})[0], HasSubstr("LATE by 300.0 ms"));
  EXPECT_THAT(plant.lines({10, 40})[0], HasSubstr("LATE 300.0 ms"));
}

TEST(TableText, AWideCharacterInOneColumn_IsLeftOut) {
  EXPECT_THAT(wrapped("エ", 1, 0), ElementsAre("…"));
  EXPECT_EQ(fitted("エ", 1), "…");
  EXPECT_EQ(padded("エンコ", 4), "エ… ");
  EXPECT_THAT(wrapped("one two three", 7, 2), ElementsAre("one two", "  three"));
  EXPECT_THAT(wrapped("", 7, 2), ElementsAre());
}

}  // namespace
}  // namespace canopus::cli::table_layout_test
