// A plant whose PLC runs a program in Structured Text or an instruction list: the program's files in the plant file, and a network that the program sets up.

#include <array>

#include <fmt/format.h>

#include "canopus/plant/event.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/serve/device_control.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::plant::program_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

class PlantProgram : public support::PlantFolder, public PlantObserver {
 protected:
  static constexpr std::string_view head =
      "[[bus]]\nname = \"line1\"\nbit_rate = 250000\n[[plc]]\nname = \"plc1\"\nlisten = \"off\"\n";

  void on(const Event& event) override {
    if (const auto* failure = std::get_if<Failure>(&event.what))
      failures.push_back(
          fmt::format("{}ms {}: {}", event.time.time_since_epoch() / 1ms, failure->source, failure->message));
  }

  std::vector<std::string> failures;
};

TEST_F(PlantProgram, Example_BootsTheNetworkAndExchangesProcessData) {
  text::TextOutput err;
  const auto plant = load_plant(CANOPUS_SOURCE_DIR "/examples/structured-text/plant.toml", *this, err, {});
  ASSERT_NE(plant, nullptr) << err.text();
  plant->power_on();
  plant->timeline().run_until(can::Time{20s});
  const program::Machine& machine = plant->program(0)->machine();
  EXPECT_EQ(machine.read("Main.stage"), "4");
  EXPECT_EQ(machine.read("Main.number"), "25");
  for (const NodeStatus& node : plant->nodes())
    EXPECT_EQ(node.state, canopen::NmtState::operational) << node.label.name;
  EXPECT_GT(std::stoi(machine.read("echoes").value()), 50);
  EXPECT_THAT(failures, ElementsAre());
}

TEST_F(PlantProgram, ExampleOfInstructionLists_BootsBothStationsAndExchangesWords) {
  text::TextOutput err;
  const auto plant = load_plant(CANOPUS_SOURCE_DIR "/examples/instruction-list/plant.toml", *this, err, {});
  ASSERT_NE(plant, nullptr) << err.text();
  plant->power_on();
  const can::Time end{20s};
  plant->timeline().run_until(end);
  for (const NodeStatus& node : plant->nodes())
    EXPECT_EQ(node.state, canopen::NmtState::operational) << node.label.name;
  const auto word = [&](std::size_t rack, std::uint32_t number) {
    std::array<std::uint16_t, 1> words{};
    EXPECT_TRUE(plant->rack(rack).read_words(plc::Device::d, number, words, end));
    return words[0];
  };
  EXPECT_EQ(word(0, 0), 10) << "step of station 1";
  EXPECT_EQ(word(1, 0), 5) << "step of station 2";
  for (const std::size_t rack : {0U, 1U}) {
    const std::uint16_t counted = word(1 - rack, 200);
    EXPECT_GT(counted, 100);
    EXPECT_NEAR(word(rack, 300), counted, 3) << "station " << rack + 1 << " has the other one's counter";
  }
  EXPECT_THAT(failures, ElementsAre());
}

TEST_F(PlantProgram, FilesOfBothLanguages_AreOneProgramInTheirOrder) {
  write("first.st", "PROGRAM First D0 := 1; D1 := 0; END_PROGRAM");
  write("SECOND.CSV", "0,,LD,SM400\n1,,MOV,D0\n,,,D1\n2,,+,K5\n,,,D0\n3,,END\n");
  write("third.st", "PROGRAM Third D2 := D0 + D1; END_PROGRAM");
  const auto plant = load(
      std::string(head) + "program = [\"first.st\", \"SECOND.CSV\", \"third.st\"]\nscan = \"2ms\"\n", *this);
  ASSERT_NE(plant, nullptr);
  plant->power_on();
  std::array<std::uint16_t, 3> words{};
  EXPECT_TRUE(plant->rack(0).read_words(plc::Device::d, 0, words, can::Time{}));
  EXPECT_THAT(words, ElementsAre(6, 1, 7));
}

TEST_F(PlantProgram, MistakesInAnInstructionList_AreMistakesOfThePlant) {
  write("MAIN.csv", "0,,LD,M0\n1,,XYZ,D0\n2,,END\n");
  EXPECT_THAT(
      check(std::string(head) + "program = [\"MAIN.csv\"]\n"),
      ElementsAre(
          "plant.toml:7:12: program = \"MAIN.csv\": MAIN.csv:2:1: 'XYZ' is not available for iQ-R; see "
          "docs/instruction-list.md"));
  EXPECT_THAT(
      check(std::string(head) + "family = \"AS300\"\nprogram = [\"MAIN.csv\"]\n"),
      ElementsAre("plant.toml:8:12: program = \"MAIN.csv\": MAIN.csv:1:1: instruction lists are for CPUs of "
                  "MELSEC; expected Structured Text for the AS300"));
}

TEST_F(PlantProgram, MistakesInTheProgram_AreMistakesOfThePlant) {
  write("main.st", "PROGRAM P\nx := 1;\ny := 2;\nEND_PROGRAM\n");
  EXPECT_THAT(check(std::string(head) + "program = [\"main.st\", \"other.st\"]\n"),
              ElementsAre("plant.toml:7:23: program = \"other.st\": No such file or directory"));
  EXPECT_THAT(check(std::string(head) + "program = [\"main.st\"]\n"),
              ElementsAre("plant.toml:7:12: program = \"main.st\": main.st:2:1: there is no variable x",
                          "plant.toml:7:12: program = \"main.st\": main.st:3:1: there is no variable y"));
  const std::string expected =
      "expected files of Structured Text or instruction lists, such as [\"main.st\", \"MAIN.csv\"]";
  EXPECT_THAT(check(std::string(head) + "program = [\"main.txt\"]\n"),
              ElementsAre("plant.toml:7:12: program = \"main.txt\": " + expected));
  EXPECT_THAT(check(std::string(head) + "program = 5\n"),
              ElementsAre("plant.toml:7:11: program = 5: " + expected));
  EXPECT_THAT(check(std::string(head) + "program = []\n"),
              ElementsAre("plant.toml:7:11: program = an array: " + expected));
}

TEST_F(PlantProgram, Fault_StopsTheCpuAndIsAnError) {
  write("main.st", "PROGRAM P\nVAR n : INT := 3; END_VAR\nn := n - 1;\nD0 := 1 / n;\nEND_PROGRAM\n");
  const auto plant = load(std::string(head) + "program = \"main.st\"\nscan = \"2ms\"\n", *this);
  ASSERT_NE(plant, nullptr);
  plant->power_on();
  plant->timeline().run_until(can::Time{1s});
  plant->parts_met(can::Time{1s});
  EXPECT_THAT(failures, ElementsAre("4ms PLC plc1: " + folder_.string() +
                                    "/main.st:4:9: division by zero; the CPU is in STOP"));
  EXPECT_EQ(plant->rack(0).cpu_state(), module::CpuState::stop);
}

TEST_F(PlantProgram, ControlServer_ReadsWritesForcesAndChangesTheProgram) {
  write("main.st",
        "VAR_GLOBAL n : INT; END_VAR PROGRAM P VAR step : INT := 1; t : TIME; END_VAR n := n + step; "
        "END_PROGRAM");
  const auto plant = load(std::string(head) + "program = [\"main.st\"]\nscan = \"10ms\"\n", *this);
  ASSERT_NE(plant, nullptr);
  serve::DeviceControl control(*plant);
  EXPECT_EQ(control.answer(R"({"request": "variables"})"),
            "{\"ok\":true,\"t\":0.0,\"variables\":[{\"name\":\"n\",\"type\":\"INT\",\"value\":\"0\"},"
            "{\"name\":\"P\",\"type\":\"P\",\"value\":\"(step := 1, t := T#0s)\"}]}\n");
  plant->power_on();
  EXPECT_EQ(
      control.answer(R"({"request": "write variable", "name": "P.step", "value": 5})"),
      "{\"ok\":true,\"t\":0.0,\"name\":\"P.step\",\"type\":\"INT\",\"value\":\"5\",\"forced\":false}\n");
  plant->timeline().run_until(can::Time{10ms});
  EXPECT_THAT(control.answer(R"({"request": "read variable", "name": "n"})"), HasSubstr("\"value\":\"6\""));
  EXPECT_THAT(control.answer(R"({"request": "force variable", "name": "n", "value": 100})"),
              HasSubstr("\"forced\":true"));
  plant->timeline().run_until(can::Time{50ms});
  EXPECT_THAT(control.answer(R"({"request": "read variable", "name": "n"})"), HasSubstr("\"value\":\"100\""));
  EXPECT_THAT(control.answer(R"({"request": "release variable", "name": "n"})"),
              HasSubstr("\"forced\":false"));
  EXPECT_THAT(control.answer(R"({"request": "write variable", "name": "P.step", "value": 40000})"),
              HasSubstr("value: expected INT"));
  EXPECT_THAT(control.answer(R"({"request": "read variable", "name": "none"})"),
              HasSubstr("name: 'none': expected the name of a global variable or of a program"));

  write("main.st",
        "VAR_GLOBAL n : INT; END_VAR PROGRAM P VAR step : INT := 1; END_VAR n := n - step; END_PROGRAM");
  EXPECT_THAT(control.answer(R"({"request": "change program"})"),
              HasSubstr("{\"name\":\"n\",\"type\":\"INT\",\"value\":\"100\"}"));
  plant->timeline().run_until(can::Time{60ms});
  EXPECT_THAT(control.answer(R"({"request": "read variable", "name": "n"})"), HasSubstr("\"value\":\"95\""));
  write("main.st", "PROGRAM P x := 1; END_PROGRAM");
  EXPECT_THAT(control.answer(R"({"request": "change program"})"),
              HasSubstr("main.st:1:11: there is no variable x"));
  plant->timeline().run_until(can::Time{70ms});
  EXPECT_THAT(control.answer(R"({"request": "read variable", "name": "n"})"), HasSubstr("\"value\":\"90\""));
}

TEST_F(PlantProgram, Tasks_MistakesNameTheirLineAndField) {
  write("main.st", "PROGRAM Main D0 := 1; END_PROGRAM PROGRAM Fast D1 := 1; END_PROGRAM");
  const std::string plc = std::string(head) + "program = [\"main.st\"]\n[[plc.task]]\nname = \"t\"\n";
  EXPECT_THAT(check(plc + "kind = \"fixed scan\"\nevery = \"2ms\"\nprograms = [\"fast\"]\n"), ElementsAre());
  EXPECT_THAT(
      check(plc + "kind = \"cyclic\"\nprograms = [\"Fast\"]\n"),
      ElementsAre("plant.toml:10:8: kind = \"cyclic\": expected \"scan\", \"initial\", \"fixed scan\", "
                  "\"event\" or \"standby\""));
  EXPECT_THAT(check(plc + "kind = \"fixed scan\"\nprograms = [\"Fast\"]\n"),
              ElementsAre("plant.toml:8:1: plc.task: every is missing; expected text in quotes"));
  EXPECT_THAT(check(plc + "kind = \"fixed scan\"\nevery = \"10us\"\nprograms = [\"Fast\"]\n"),
              ElementsAre("plant.toml:11:9: every = \"10us\": a fixed scan is every 100us to 60s"));
  EXPECT_THAT(
      check(plc + "kind = \"scan\"\nevery = \"10ms\"\nprograms = [\"Fast\"]\n"),
      ElementsAre("plant.toml:11:9: every = \"10ms\": only a task with kind = \"fixed scan\" has it"));
  EXPECT_THAT(check(plc + "kind = \"event\"\non = \"D5\"\nprograms = [\"Fast\"]\n"),
              ElementsAre("plant.toml:11:6: on = \"D5\": expected a bit device, such as \"X10\""));
  EXPECT_THAT(
      check(plc + "kind = \"initial\"\nprograms = [\"Main\", \"Fst\"]\n"),
      ElementsAre(
          "plant.toml:11:21: programs: \"Fst\": the program has no such PROGRAM; did you mean \"Fast\"?"));
  EXPECT_THAT(check(plc + "kind = \"initial\"\nprograms = [\"Main\", 5]\npriority = 0\n"),
              ElementsAre("plant.toml:11:21: programs = 5: expected names of PROGRAMs, such as [\"Main\"]",
                          "plant.toml:12:12: priority = 0: expected 1 (the first) to 32"));
  EXPECT_THAT(check(plc + "kind = \"initial\"\nprograms = [\"Main\"]\n[[plc.task]]\nname = \"t\"\nkind = "
                          "\"scan\"\nprograms = [\"MAIN\"]\n"),
              ElementsAre("plant.toml:13:8: name = \"t\": another task is \"t\" already, in line 9",
                          "plant.toml:15:13: programs: \"MAIN\" belongs to a task already, in line 11"));
  EXPECT_THAT(check(std::string(head) + "program = [\"main.st\"]\nwatchdog = \"3s\"\n"),
              ElementsAre("plant.toml:8:12: watchdog = \"3s\": the watchdog timer is 1ms to 2s"));
}

TEST_F(PlantProgram, Watchdog_StopsTheCpuWhenTheScanTakesLonger) {
  write("main.st", "PROGRAM P VAR n : DINT; END_VAR FOR n := 1 TO 1000000 DO D0 := 1; END_FOR; END_PROGRAM");
  for (const auto& [limit, is_late] : {std::pair("200ms", false), std::pair("1ms", true)}) {
    failures.clear();
    const auto plant =
        load(std::string(head) + "program = \"main.st\"\nwatchdog = \"" + limit + "\"\n", *this);
    ASSERT_NE(plant, nullptr);
    plant->power_on();
    plant->timeline().run_until(can::Time{1ms});
    plant->parts_met(can::Time{1ms});
    EXPECT_EQ(!failures.empty(), is_late) << limit;
    EXPECT_EQ(plant->rack(0).cpu_error().has_value(), is_late) << limit;
  }
}

TEST_F(PlantProgram, RetainedVariables_AreInTheStore) {
  write("main.st", "PROGRAM P VAR RETAIN n : INT; END_VAR n := n + 1; END_PROGRAM");
  const std::string file =
      std::string(head) + "program = [\"main.st\"]\nscan = \"10ms\"\nstore = \"state\"\n";
  EXPECT_THAT(check(file), ElementsAre());
  const auto run = [&](can::Duration time) {
    const auto plant = load(file, *this);
    EXPECT_THAT(plant->open_stores(), ElementsAre());
    plant->power_on();
    plant->timeline().run_until(can::Time{time});
    return plant->program(0)->machine().read("P.n").value();
  };
  EXPECT_EQ(run(50ms), "6");
  EXPECT_EQ(run(10ms), "8");
  {
    const auto plant = load(file, *this);
    EXPECT_EQ(plant->program(0)->machine().read("P.n"), "8") << "without a run nothing changes";
  }
  write("main.st", "PROGRAM P VAR RETAIN n : DINT := 100; END_VAR n := n + 1; END_PROGRAM");
  EXPECT_THAT(check(file),
              ElementsAre("plant.toml:9:9: warning: store = \"state\": RETAIN variable P.n was INT, and is "
                          "DINT now; it has its initial value"));
  EXPECT_EQ(run(10ms), "102");
  write("main.st", "PROGRAM P VAR n : INT; END_VAR n := n + 1; END_PROGRAM");
  EXPECT_THAT(check(file), ElementsAre(HasSubstr("the PLC has no module that could store anything")));
}

TEST_F(PlantProgram, ControlServer_HaltsStepsAndBreaksTheProgram) {
  write("main.st", "PROGRAM P\nVAR n : INT; END_VAR\nn := n + 1;\nD5 := n;\nEND_PROGRAM\n");
  const auto plant = load(std::string(head) + "program = [\"main.st\"]\nscan = \"10ms\"\n", *this);
  ASSERT_NE(plant, nullptr);
  serve::DeviceControl control(*plant);
  EXPECT_EQ(control.answer(R"({"request": "halt program"})"),
            "{\"ok\":false,\"t\":0.0,\"error\":\"the CPU is not in RUN, but has no supply\"}\n");
  plant->power_on();
  EXPECT_EQ(control.answer(R"({"request": "halt program"})"),
            "{\"ok\":true,\"t\":0.0,\"state\":\"halted\"}\n");
  plant->timeline().run_until(can::Time{20ms});
  EXPECT_THAT(control.answer(R"({"request": "single scan"})"), HasSubstr("\"state\":\"run\""));
  plant->timeline().run_until(can::Time{40ms});
  EXPECT_THAT(control.answer(R"({"request": "read variable", "name": "P.n"})"), HasSubstr("\"value\":\"2\""));
  EXPECT_EQ(control.answer(R"({"request": "set break", "file": "main.st", "line": 4})"),
            "{\"ok\":true,\"t\":0.04,\"file\":\"main.st\",\"line\":4}\n");
  EXPECT_THAT(control.answer(R"({"request": "continue program"})"), HasSubstr("\"state\":\"run\""));
  plant->timeline().run_until(can::Time{60ms});
  EXPECT_EQ(
      control.answer(R"({"request": "program", "file": "main.st", "from": 3, "count": 2})"),
      "{\"ok\":true,\"t\":0.06,\"plc\":\"plc1\",\"cpu\":\"R04CPU\",\"state\":\"halted\",\"halted_at\":{"
      "\"file\":0,"
      "\"line\":4},\"scan\":{\"count\":6,\"period\":0.01,\"now\":3e-08,\"least\":3e-08,\"most\":3e-08},"
      "\"breaks\":[{\"file\":0,\"line\":4}],\"forced\":[],\"tasks\":[{\"name\":\"all other programs\","
      "\"kind\":\"scan\",\"priority\":0,\"programs\":[\"P\"],\"runs\":3}],\"files\":[\"main.st\"],\"file\":0,"
      "\"from\":3,\"of\":6,\"blocks\":[],\"lines\":[{\"text\":\"n := n + 1;\",\"code\":true,\"values\":[{"
      "\"column\":1,\"length\":1,\"name\":\"P.n\",\"type\":\"INT\",\"value\":\"3\",\"forced\":false,"
      "\"writable\":true},{\"column\":6,\"length\":1,\"name\":\"P.n\",\"type\":\"INT\",\"value\":\"3\","
      "\"forced\":false,\"writable\":true}]},{\"text\":\"D5 := n;\",\"code\":true,\"values\":[{\"column\":1,"
      "\"length\":2,\"name\":\"D5\",\"type\":\"WORD\",\"value\":\"2\",\"device\":true,\"forced\":false,"
      "\"writable\":false},{\"column\":7,\"length\":1,\"name\":\"P.n\",\"type\":\"INT\",\"value\":\"3\","
      "\"forced\":false,\"writable\":true}]}]}\n");
  EXPECT_THAT(control.answer(R"({"request": "set break", "file": "man.st", "line": 4})"),
              HasSubstr("file: the program has no file \\\"man.st\\\"; did you mean \\\"main.st\\\"?"));
  EXPECT_THAT(control.answer(R"({"request": "set break", "file": "main.st", "line": 0})"),
              HasSubstr("line: expected a number from 1 to 10000000"));
  EXPECT_THAT(control.answer(R"({"request": "clear break", "file": "main.st", "line": 3})"),
              HasSubstr("line: there is no break in line 3 of main.st"));
  EXPECT_THAT(control.answer(R"({"request": "clear breaks"})"), HasSubstr("\"breaks\":0"));
  EXPECT_THAT(control.answer(R"({"request": "force variable", "name": "P.n", "value": 7})"),
              HasSubstr("\"forced\":true"));
  EXPECT_THAT(control.answer(R"({"request": "program"})"),
              HasSubstr("\"forced\":[{\"name\":\"P.n\",\"type\":\"INT\",\"value\":\"7\"}]"));
  EXPECT_THAT(control.answer(R"({"request": "release all"})"), HasSubstr("\"released\":1"));
}

TEST_F(PlantProgram, Breaks_AreAtMost100) {
  std::string text = "PROGRAM P\n";
  for (int line = 2; line <= 102; ++line) text += "D5 := 1;\n";
  write("main.st", text + "END_PROGRAM\n");
  const auto plant = load(std::string(head) + "program = [\"main.st\"]\nscan = \"10ms\"\n", *this);
  ASSERT_NE(plant, nullptr);
  serve::DeviceControl control(*plant);
  const auto set_break = [&](int line) {
    return control.answer(R"({"request": "set break", "file": "main.st", "line": )" + std::to_string(line) +
                          "}");
  };
  for (int line = 2; line <= 101; ++line) EXPECT_THAT(set_break(line), HasSubstr("\"ok\":true"));
  EXPECT_THAT(set_break(102), HasSubstr("\"error\":\"line: expected at most 100 breaks; clear some first\""));
}

TEST_F(PlantProgram, NativeCode_IsLoadedOnlyWithPermission) {
  if (std::system("gcc --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "gcc is not installed";
  const std::string so = (folder_ / "main.so").string();
  ASSERT_EQ(std::system(("gcc -shared -fPIC -I " CANOPUS_SOURCE_DIR "/canopus/program -o " + so +
                         " " CANOPUS_SOURCE_DIR "/examples/c-program/main.c")
                            .c_str()),
            0);
  const std::string text =
      std::string(head) + "program = [\"main.so\"]\nscan = \"10ms\"\ncpu_model = \"R04CPU\"\n";
  EXPECT_THAT(check(text),
              ElementsAre("plant.toml:7:12: program = \"main.so\" is native code, which can do here "
                          "whatever you can; if you trust it, run the plant by canopus run "
                          "--allow-native"));
  write("more.st", "PROGRAM P END_PROGRAM");
  EXPECT_THAT(
      check(std::string(head) + "program = [\"more.st\", \"main.so\"]\n"),
      ElementsAre("plant.toml:7:23: program = \"main.so\": expected a shared object alone, without other "
                  "files"));

  text::TextOutput err;
  write("plant.toml", text + "labels = [\"labels.csv\"]\n");
  EXPECT_EQ(load_plant(path(), *this, err, {.allows_native_code = true}), nullptr);
  EXPECT_THAT(err.text(), HasSubstr("plant.toml:10:11: labels = \"labels.csv\": expected none beside a "
                                    "shared object, which has its variables' devices itself"));
  write("plant.toml", text + "[[plc.task]]\nname = \"t\"\nkind = \"initial\"\nprograms = [\"mian\"]\n");
  EXPECT_EQ(load_plant(path(), *this, err, {.allows_native_code = true}), nullptr);
  EXPECT_THAT(err.text(),
              HasSubstr("plant.toml:13:13: programs: \"mian\": the program has no such PROGRAM; did "
                        "you mean \"main\"?"));
  err.clear();

  write("plant.toml", text);
  const auto plant = load_plant(path(), *this, err, {.allows_native_code = true});
  ASSERT_NE(plant, nullptr) << err.text();
  ASSERT_EQ(plant->warnings().size(), 1U);
  EXPECT_EQ(plant->warnings()[0].message,
            "program = \"main.so\" is native code: it runs with all your rights");
  serve::DeviceControl control(*plant);
  plant->power_on();
  EXPECT_THAT(control.answer(R"({"request": "write variable", "name": "pump", "value": true})"),
              HasSubstr("\"value\":\"TRUE\""));
  plant->timeline().run_until(can::Time{1s});
  EXPECT_THAT(
      control.answer(R"({"request": "read variable", "name": "running_time"})"),
      HasSubstr("{\"ok\":true,\"t\":1.0,\"name\":\"running_time\",\"type\":\"TIME\",\"value\":\"T#1s\""));
  EXPECT_THAT(control.answer(R"({"request": "write variable", "name": "limit", "value": 0})"),
              HasSubstr("\"ok\":true"));
  plant->timeline().run_until(can::Time{2s});
  plant->parts_met(can::Time{2s});
  EXPECT_THAT(failures, ElementsAre("1010ms PLC plc1: " + so +
                                    ": the limit of the level is not above 0; the CPU is in STOP"));
}

TEST_F(PlantProgram, WithoutScan_TheScanIsEstimated) {
  write("main.st", "PROGRAM P D0 := D0 + 1; END_PROGRAM");
  const auto plant = load(std::string(head) + "program = [\"main.st\"]\n", *this);
  ASSERT_NE(plant, nullptr);
  EXPECT_TRUE(plant->rack(0).has_own_scan());
  EXPECT_EQ(plant->rack(0).scan().period(), 400us);
}

}  // namespace
}  // namespace canopus::plant::program_test
