// The library "lib:canopen": which files a module gets, the examples that use it from end to end, and received emergency messages.

#include "canopus/plant/program_library.hpp"

#include <array>
#include <fstream>

#include <fmt/format.h>

#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/plc/execution/program_execution.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::plant::program_library_test {
namespace {

using ::testing::ElementsAre;
using namespace std::chrono_literals;

/// A plant of the folder examples/, run for some time.
class Example : public PlantObserver {
 public:
  explicit Example(const std::string& file, can::Duration duration = 0s)
      : plant(load_plant(CANOPUS_SOURCE_DIR "/examples/" + file, *this, err, {})) {
    if (plant == nullptr) return;
    plant->power_on();
    run(duration);
  }
  void run(can::Duration duration) {
    const can::Time end = plant->timeline().now() + duration;
    plant->timeline().run_until(end);
    plant->parts_met(end);
  }
  std::string read(std::string_view name, std::size_t plc = 0) const {
    return plant->program(plc)->machine().read(name).value_or("none");
  }
  int word(std::uint32_t number, std::size_t rack) const {
    std::array<std::uint16_t, 1> words{};
    EXPECT_TRUE(plant->rack(rack).read_words(plc::Device::d, number, words, plant->timeline().now()));
    return words[0];
  }
  void on(const Event& event) override {
    if (const auto* failure = std::get_if<Failure>(&event.what))
      failures.push_back(failure->source + ": " + failure->message);
  }

  text::TextOutput err;
  std::vector<std::string> failures;
  std::unique_ptr<Plant> plant;
};

class ProgramForAnyModule : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Models, ProgramForAnyModule,
                         ::testing::Values("me3can1-q", "rj71cn91", "fx3u-can", "fx2n-32can", "as-fcopm"));

TEST_P(ProgramForAnyModule, ReadsAndWritesObjectsStopsAndStartsANodeAndExchangesProcessData) {
  const std::string model = GetParam();
  const bool is_card = model == "as-fcopm";
  Example run("any-module/" + model + ".toml", 4s);
  ASSERT_NE(run.plant, nullptr) << run.err.text();
  EXPECT_EQ(run.read("Main.step"), "run");
  EXPECT_EQ(run.read("own_node"), is_card ? "0" : "1");
  EXPECT_EQ(run.read("kernel"), "NO_ERROR");
  EXPECT_EQ(run.read("device_type"), "16#000F0191");
  EXPECT_EQ(run.read("refusal"), std::to_string(0x06020000));
  EXPECT_EQ(run.read("was_stopped"), is_card ? "FALSE" : "TRUE");  // no register of the card shows it
  EXPECT_EQ(run.read("emergencies"), "0");
  EXPECT_GT(std::stoi(run.read("echoes")), 30);
  EXPECT_THAT(run.failures, ElementsAre());
  // The card boots the node after the program has written to it: its download has 200 ms.
  EXPECT_EQ(run.plant->device(0).device().node().dictionary().get<std::uint16_t>(0x1017, 0),
            is_card ? 200 : 100);
}

TEST_P(ProgramForAnyModule, EmergencyMessages_AreReceivedOnceEach) {
  Example run("any-module/" + std::string(GetParam()) + ".toml", 3s);
  ASSERT_NE(run.plant, nullptr) << run.err.text();
  ASSERT_EQ(run.read("Main.step"), "run");
  sim::Device& device = run.plant->device(0).device();
  ASSERT_TRUE(device.emergency(0x2310, 0x02, std::array<std::uint8_t, 5>{1, 2, 3, 4, 5},
                               run.plant->timeline().now()));
  run.run(500ms);
  EXPECT_EQ(run.read("emergencies"), "1");
  EXPECT_EQ(run.read("last_emergency"), "16#2310");
  EXPECT_EQ(run.read("Main.emergency.ERROR"), "NO_ERROR");
  EXPECT_EQ(run.read("canopen_emcy_of[2]"),
            "(EMCY_ERROR_CODE := 16#2310, ERROR_REGISTER := 16#03, ERROR_FIELD := [16#01, 16#02, 16#03, "
            "16#04, 16#05])");
  for (int i = 0; i < 14; ++i) {
    ASSERT_TRUE(device.emergency(0x5000, 0x01, std::array<std::uint8_t, 5>{}, run.plant->timeline().now()));
    run.run(100ms);
  }
  EXPECT_EQ(run.read("emergencies"), "15");
  EXPECT_EQ(run.read("last_emergency"), "16#5000");
}

/// The plant of examples/any-module with a program of the test's own, whose variable `go` says which of its blocks work.
class BlocksOfAnyModule : public support::PlantFolder,
                          public ::testing::WithParamInterface<const char*>,
                          public PlantObserver {
 protected:
  void SetUp() override {
    write("main.st", R"(
      VAR_GLOBAL go : INT; END_VAR
      PROGRAM Main
      VAR
        first, second, missing, short : CIA405_SDO_READ4;
        long : CIA405_SDO_READ124;
        refused, too_long : CIA405_SDO_WRITE4;
        emergency : CIA405_RECV_EMCY_DEV;
        nmt : CIA405_NMT;
        exchange : CANOPEN_EXCHANGE;
      END_VAR
      exchange(ENABLE := NOT exchange.CONFIRM);
      first(ENABLE := go = 1, DEVICE := 2, INDEX := 16#1000);
      second(ENABLE := go = 1, DEVICE := 2, INDEX := 16#1018, SUBINDEX := 3);
      missing(ENABLE := go = 2, DEVICE := 9, INDEX := 16#1000);
      long(ENABLE := go = 3, DEVICE := 2, INDEX := 16#1008);
      short(ENABLE := go = 3, DEVICE := 2, INDEX := 16#1008);
      refused(ENABLE := go = 4, DEVICE := 2, INDEX := 16#1000, DATALENGTH := 4);
      too_long(ENABLE := go = 4, DEVICE := 2, INDEX := 16#1017, DATALENGTH := 5);
      emergency(ENABLE := go = 5 AND NOT emergency.CONFIRM, DEVICE := 2);
      nmt(ENABLE := go = 6, DEVICE := 0, STATE := CIA405_TRANSITION_STATE#ENTER_PRE_OPERATIONAL);
      END_PROGRAM
    )");
    std::ifstream file(CANOPUS_SOURCE_DIR "/examples/any-module/" + std::string(GetParam()) + ".toml");
    std::string text((std::istreambuf_iterator<char>(file)), {});
    text.replace(text.find("../devices"), 10, CANOPUS_SOURCE_DIR "/examples/devices");
    text.replace(text.find("\"2ms\""), 5, "\"5ms\"");
    plant_ = load(text, *this);
    ASSERT_NE(plant_, nullptr);
    plant_->power_on();
    run(3s);
  }
  void on(const Event&) override {}
  void run(can::Duration duration) { plant_->timeline().run_until(plant_->timeline().now() + duration); }
  /// The blocks of this number work for a second.
  void go(int number, can::Duration duration = 1s) {
    ASSERT_TRUE(plant_->program(0)->machine().write("go", std::to_string(number)));
    run(duration);
  }
  [[nodiscard]] std::string read(std::string_view name) const {
    return plant_->program(0)->machine().read("Main." + std::string(name)).value_or("none");
  }
  [[nodiscard]] bool is_card() const { return std::string_view(GetParam()) == "as-fcopm"; }
  sim::Device& device() { return plant_->device(0).device(); }

  std::unique_ptr<Plant> plant_;
};

INSTANTIATE_TEST_SUITE_P(Models, BlocksOfAnyModule,
                         ::testing::Values("me3can1-q", "rj71cn91", "fx3u-can", "fx2n-32can", "as-fcopm"));

TEST_P(BlocksOfAnyModule, TwoRequestsAtOnce_AreCarriedOutOneAfterTheOther) {
  go(1);
  EXPECT_EQ(read("first.CONFIRM"), "TRUE");
  EXPECT_EQ(read("first.DATA"), "[16#91, 16#01, 16#0F, 16#00]");
  EXPECT_EQ(read("first.DATALENGTH"), "4");
  EXPECT_EQ(read("second.CONFIRM"), "TRUE");
  EXPECT_EQ(read("second.DATA"), "[16#00, 16#00, 16#01, 16#00]");
  go(0, 10ms);
  EXPECT_EQ(read("first.CONFIRM"), "FALSE");
}

TEST_P(BlocksOfAnyModule, EnableTakenBack_DropsTheResultOfWhatHasBegun) {
  go(2, 20ms);
  EXPECT_EQ(plant_->program(0)->machine().read("canopen_busy"), "TRUE");
  go(1, 2s);
  EXPECT_EQ(read("missing.ERROR"), "NO_ERROR");
  EXPECT_EQ(read("first.DATA"), "[16#91, 16#01, 16#0F, 16#00]");
}

TEST_P(BlocksOfAnyModule, NodeThatIsNotThere_IsNoAnswer) {
  go(2, 2s);
  EXPECT_EQ(read("missing.CONFIRM"), "FALSE");
  EXPECT_EQ(read("missing.ERROR"), "NO_ANSWER");
  EXPECT_EQ(plant_->program(0)->machine().read("canopen_busy"), "FALSE");
}

TEST_P(BlocksOfAnyModule, LongObject_IsReadByTheBlockForLongOnesAlone) {
  go(3, 2s);
  EXPECT_EQ(read("short.CONFIRM"), "FALSE");
  EXPECT_EQ(read("short.ERROR"), "DATA_OVERFLOW");
  EXPECT_EQ(read("long.ERROR"), is_card() ? "DATA_OVERFLOW" : "NO_ERROR");
  if (is_card()) return;
  EXPECT_EQ(read("long.DATALENGTH"), "17");
  EXPECT_EQ(read("long.DATA[1]"), "16#43");   // C
  EXPECT_EQ(read("long.DATA[17]"), "16#6B");  // k
}

TEST_P(BlocksOfAnyModule, RefusedWrite_HasTheAbortCode_AndAWrongLengthIsNotSent) {
  go(4);
  EXPECT_EQ(read("refused.ERROR"), "SDO_ERROR");
  EXPECT_EQ(read("refused.ERRORINFO"), std::to_string(0x06010002));
  EXPECT_EQ(read("too_long.ERROR"), "DATA_OVERFLOW");
  EXPECT_EQ(read("too_long.ERRORINFO"), "0");
}

TEST_P(BlocksOfAnyModule, EmergencyOfANode_IsTheFirstOneUntilItIsReset) {
  const std::array<std::uint8_t, 5> bytes{9, 8, 7, 6, 5};
  for (const std::uint16_t code : std::array<std::uint16_t, 2>{0x4210, 0x2310}) {
    ASSERT_TRUE(device().emergency(code, 0x01, bytes, plant_->timeline().now()));
    go(5, 300ms);
    EXPECT_EQ(read("emergency.ERRORINFO"),
              "(EMCY_ERROR_CODE := 16#4210, ERROR_REGISTER := 16#01, ERROR_FIELD := [16#09, 16#08, 16#07, "
              "16#06, 16#05])");
  }
  ASSERT_TRUE(device().emergency_reset(plant_->timeline().now()));
  go(5, 300ms);
  EXPECT_EQ(read("emergency.ERRORINFO.EMCY_ERROR_CODE"), "16#0000");
}

TEST_P(BlocksOfAnyModule, NmtToAllNodes_ReachesTheDevice) {
  ASSERT_EQ(device().node().state(), canopen::NmtState::operational);
  go(6, 100ms);
  EXPECT_EQ(read("nmt.CONFIRM"), "TRUE");
  EXPECT_EQ(read("nmt.ERROR"), "NO_ERROR");
  EXPECT_EQ(device().node().state(), canopen::NmtState::pre_operational);
}

class ManualProgram : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Models, ManualProgram, ::testing::Values("me3can1-q", "rj71cn91", "fx3u-can"));

TEST_P(ManualProgram, FactorySettings_EndAsANetworkThatExchangesProcessData) {
  Example run("manual-programs/" + std::string(GetParam()) + ".toml", 8s);
  ASSERT_NE(run.plant, nullptr) << run.err.text();
  EXPECT_EQ(run.read("Main.step"), "run");
  EXPECT_EQ(run.read("refused"), "0");
  EXPECT_GT(std::stoi(run.read("echoes")), 60);
  EXPECT_NE(run.read("analogue_input"), "0");
  for (const NodeStatus& node : run.plant->nodes())
    EXPECT_EQ(node.state, canopen::NmtState::operational) << node.label.name;
  EXPECT_THAT(run.failures, ElementsAre());
}

TEST_P(ManualProgram, Layer2_EachStationReceivesMessagesAndAnswersRemoteFrames) {
  Example run("manual-programs/layer2-" + std::string(GetParam()) + ".toml", 7s);
  ASSERT_NE(run.plant, nullptr) << run.err.text();
  for (std::size_t plc = 0; plc < 2; ++plc) {
    SCOPED_TRACE(plc);
    EXPECT_GT(std::stoi(run.read("received", plc)), 15);
    EXPECT_GT(std::stoi(run.read("answered", plc)), 15);
    EXPECT_GT(std::stoi(run.read("answers", plc)), 15);
    EXPECT_EQ(run.read("wrong", plc), "0");
  }
  EXPECT_THAT(run.failures, ElementsAre());
}

TEST(ManualPrograms, Layer2AsInstructionLists_DoesWhatTheStructuredTextDoes) {
  Example structured("manual-programs/layer2-rj71cn91.toml", 7s);
  Example list("manual-programs/layer2-rj71cn91-list.toml", 7s);
  ASSERT_NE(structured.plant, nullptr) << structured.err.text();
  ASSERT_NE(list.plant, nullptr) << list.err.text();
  for (std::size_t plc = 0; plc < 2; ++plc) {
    SCOPED_TRACE(plc);
    EXPECT_NEAR(list.word(110, plc), std::stoi(structured.read("received", plc)), 3);
    EXPECT_NEAR(list.word(111, plc), std::stoi(structured.read("answered", plc)), 3);
    EXPECT_NEAR(list.word(112, plc), std::stoi(structured.read("answers", plc)), 3);
    EXPECT_GT(list.word(110, plc), 15);
    EXPECT_EQ(list.word(113, plc), 0) << "wrong";
    const int received = plc == 0 ? 0x581 : 0x501;
    const int answer = plc == 0 ? 0x681 : 0x601;
    EXPECT_THAT((std::array{list.word(20, plc), list.word(21, plc), list.word(22, plc), list.word(23, plc),
                            list.word(24, plc), list.word(25, plc), list.word(26, plc)}),
                ElementsAre(received, 0, 8, 0x2211, 0x4433, 0x6655, 0x8877));
    EXPECT_THAT((std::array{list.word(40, plc), list.word(41, plc), list.word(42, plc), list.word(43, plc),
                            list.word(44, plc), list.word(45, plc), list.word(46, plc)}),
                ElementsAre(answer, 0, 8, 0xDDEE, 0xBBCC, 0x99AA, 0x7788));
  }
  EXPECT_THAT(list.failures, ElementsAre());
}

TEST(ManualPrograms, Fx2n32can_ModeAShowsTheWordsOfEachNodeAtTheSameNumbers) {
  Example run("manual-programs/fx2n-32can.toml", 8s);
  ASSERT_NE(run.plant, nullptr) << run.err.text();
  EXPECT_EQ(run.read("mapped"), "16#8201");
  for (std::size_t plc = 0; plc < 3; ++plc) {
    for (std::size_t node = 1; node <= 3; ++node) {
      SCOPED_TRACE(fmt::format("node {} in node {}", node, plc + 1));
      const std::string word = run.read(fmt::format("words_of[{}]", node), plc);
      const long value = std::stol(word.substr(3), nullptr, 16);
      EXPECT_EQ(value / 1000, node == plc + 1 ? 0 : static_cast<long>(node));
    }
  }
  EXPECT_THAT(run.failures, ElementsAre());
}

TEST(ManualPrograms, AsFcopm_TheServoIsHomedAndMoves) {
  Example run("manual-programs/as-fcopm.toml", 20s);
  ASSERT_NE(run.plant, nullptr) << run.err.text();
  EXPECT_GT(std::stoi(run.read("moves")), 2);
  EXPECT_EQ(run.read("refusal"), std::to_string(0x06010002));
  EXPECT_EQ(run.plant->device(0).device().node().dictionary().get<std::uint8_t>(0x6098, 0), 17);
  EXPECT_THAT(run.failures, ElementsAre());
}

TEST(TwoModules, OneProgram_DrivesBothByTheirOwnBlocks) {
  Example run("any-module/two-modules.toml", 4s);
  ASSERT_NE(run.plant, nullptr) << run.err.text();
  EXPECT_EQ(run.read("heartbeat_line1"), "200");
  EXPECT_EQ(run.read("heartbeat_line2"), "300");
  EXPECT_EQ(run.read("refused_line2"), std::to_string(0x06020000));
  EXPECT_EQ(run.read("canopen_busy"), "FALSE");
  EXPECT_EQ(run.read("canopen_busy_U4"), "FALSE");
  EXPECT_THAT(run.failures, ElementsAre());
}

class ProgramLibrary : public support::PlantFolder {};

TEST_F(ProgramLibrary, NameOrUnitThatIsNotThere_IsAMistake) {
  const std::string head =
      "[[bus]]\nname = \"line1\"\nbit_rate = 250000\n[[plc]]\nname = \"plc1\"\nlisten = \"off\"\n";
  const std::string two =
      "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0x20\nnode = 1\n"
      "[[plc.module]]\nmodel = \"RJ71CN91\"\nhead = 0x40\nnode = 2\n";
  EXPECT_THAT(check(head + "program = [\"lib:other\"]\n" + two),
              ElementsAre("plant.toml:7:12: program = \"lib:other\": expected \"lib:canopen\""));
  EXPECT_THAT(check(head + "program = [\"lib:canopen\"]\n"),
              ElementsAre("plant.toml:7:12: program = \"lib:canopen\": expected a module in the PLC's rack"));
  EXPECT_THAT(
      check(head + "program = [\"lib:canopen\"]\n" + two),
      ElementsAre("plant.toml:7:12: program = \"lib:canopen\": expected @ and the unit of a module, such as "
                  "\"lib:canopen@U2\": the rack has several"));
  EXPECT_THAT(check(head + "program = [\"lib:canopen@U2\", \"lib:canopen@U2\"]\n" + two),
              ElementsAre("plant.toml:7:30: program = \"lib:canopen@U2\": it is in the list twice"));
  EXPECT_THAT(check(head + "program = [\"lib:canopen@U7\"]\n" + two),
              ElementsAre("plant.toml:7:12: program = \"lib:canopen@U7\": the rack has no module at U7"));
}

TEST_F(ProgramLibrary, Devices_AreMovedToTheModule) {
  PlcSection plc;
  plc.modules.resize(2);
  plc.modules[0].model = "ME3CAN1-Q";
  plc.modules[1].model = "RJ71CN91";
  plc.modules[1].head = 0x120;
  const auto sources = library_sources("lib:canopen@U12", plc);
  ASSERT_TRUE(sources.has_value()) << sources.error();
  std::string all;
  for (const structured_text::Source& source : *sources) all += source.text;
  EXPECT_NE(all.find("Y121 := handshake.REQUEST"), std::string::npos);
  EXPECT_NE(all.find("ANSWER := X137"), std::string::npos);
  EXPECT_NE(all.find("U12\\G25.7"), std::string::npos);
  EXPECT_EQ(all.find("U0\\"), std::string::npos);
  EXPECT_EQ(all.find("LIFT_INPUT"), std::string::npos);  // of the FX3U-CAN
  const auto further = library_sources("lib:canopen@U12", plc, *library_sources("lib:canopen@U0", plc));
  ASSERT_TRUE(further.has_value());
  all.clear();
  for (const structured_text::Source& source : *further) all += source.text;
  EXPECT_NE(all.find("FUNCTION_BLOCK CIA405_NMT_U12"), std::string::npos);
  EXPECT_NE(all.find("canopen_busy_U12 : BOOL"), std::string::npos);
  EXPECT_EQ(all.find("\nTYPE"), std::string::npos);
  EXPECT_EQ(all.find("CIA405_STATE_U12"), std::string::npos);
  const auto first = library_sources("lib:canopen@U0", plc);
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->size(), sources->size());
}

}  // namespace
}  // namespace canopus::plant::program_library_test
