// A PLC program in a rack: when in a scan it runs, and which X, Y and buffer memory it sees.

#include "canopus/plc/execution/program_execution.hpp"

#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/plc/execution/instruction_time.hpp"
#include "canopus/plc/execution/program_text.hpp"
#include "canopus/structured_text/compiler.hpp"

#include "plc/fake_module.hpp"

namespace canopus::plc::program_execution_test {
namespace {

using module::CpuState;
using ::testing::ElementsAre;
using testing::FakeModule;
using ::testing::IsEmpty;
using ::testing::Pair;
using namespace std::chrono_literals;

std::shared_ptr<const program::Program> compiled(const std::string& text, const CpuModel& model = r04cpu()) {
  const CpuDeviceNames devices(model);
  const std::vector<structured_text::Source> sources = {{"main.st", text}};
  auto made = structured_text::compile(sources, &devices);
  EXPECT_EQ(made.errors.size(), 0U) << (made.errors.empty() ? "" : made.errors.front().message);
  return std::move(made.program);
}

/// What a battery keeps.
class Battery final : public module::NonVolatileMemory {
 public:
  Content read(std::string_view name) override {
    const auto found = contents.find(std::string(name));
    return found == contents.end() ? Content{} : Content{Content::State::good, found->second};
  }
  bool write(std::string_view name, std::span<const std::uint8_t> bytes) override {
    contents[std::string(name)].assign(bytes.begin(), bytes.end());
    return true;
  }
  bool erase(std::string_view name) override { return contents.erase(std::string(name)) != 0; }

  std::map<std::string, std::vector<std::uint8_t>> contents;
};

/// A rack whose scan takes 5 ms, with a module at 20H and a program, switched on at 1 s.
struct ProgrammedRack {
  explicit ProgrammedRack(const std::string& text, CpuState state = CpuState::run,
                          std::vector<ProgramTask> tasks = {}, module::NonVolatileMemory* memory = nullptr)
      : rack(timeline, r04cpu(), 5ms),
        execution(timeline, rack, {.program = compiled(text), .tasks = std::move(tasks), .memory = memory},
                  [this](const std::string& fault, can::Time now) { faults.emplace_back(fault, now); }) {
    timeline.add(module);
    rack.insert(0x20, module);
    timeline.run_until(can::Time{1s});
    rack.power_on(can::Time{1s}, state);
  }
  void run(can::Duration duration) { timeline.run_until(timeline.now() + duration); }
  std::string read(std::string_view path) { return execution.machine().read(path).value_or("none"); }

  can::Timeline timeline;
  FakeModule module;
  Rack rack;
  std::vector<std::pair<std::string, can::Time>> faults;
  ProgramExecution execution;
};

constexpr const char* counting = "PROGRAM P VAR n : INT; END_VAR n := n + 1; END_PROGRAM";

TEST(ProgramExecution, Run_ExecutesTheProgramOnceAScanFromPowerOn) {
  ProgrammedRack plc(counting);
  EXPECT_EQ(plc.read("P.n"), "1");
  plc.run(4999us);
  EXPECT_EQ(plc.read("P.n"), "1");
  plc.run(1us);
  EXPECT_EQ(plc.read("P.n"), "2");
  plc.run(50ms);
  EXPECT_EQ(plc.read("P.n"), "12");
}

TEST(ProgramExecution, StopAndPause_HaltIt) {
  ProgrammedRack plc(counting, CpuState::stop);
  plc.run(20ms);
  EXPECT_EQ(plc.read("P.n"), "0");
  plc.rack.set_cpu_state(CpuState::run, plc.timeline.now());
  plc.run(10ms);
  EXPECT_EQ(plc.read("P.n"), "3");
  plc.rack.pause(plc.timeline.now());
  plc.run(20ms);
  EXPECT_EQ(plc.read("P.n"), "3");
  plc.rack.set_cpu_state(CpuState::run, plc.timeline.now());
  plc.run(4ms);
  EXPECT_EQ(plc.read("P.n"), "3");
  plc.run(1ms);
  EXPECT_EQ(plc.read("P.n"), "4");
  plc.rack.set_cpu_state(CpuState::stop, plc.timeline.now());
  plc.rack.set_cpu_state(CpuState::run, plc.timeline.now());
  plc.run(5ms);
  EXPECT_EQ(plc.read("P.n"), "1") << "RUN gives the variables their initial values";
}

TEST(ProgramExecution, X_IsThatOfTheScansRefreshAndYGoesOutAtTheNextOne) {
  ProgrammedRack plc("PROGRAM P Y21 := X20; END_PROGRAM");
  plc.run(7ms);
  plc.module.x = 1;
  plc.run(2999us);
  EXPECT_THAT(plc.module.edges, IsEmpty());
  plc.run(1us);  // 1.010 s: X is refreshed, and the program sets Y
  EXPECT_THAT(plc.module.edges, IsEmpty());
  plc.run(5ms);
  EXPECT_THAT(plc.module.edges, ElementsAre(Pair(1, true)));
  EXPECT_EQ(plc.module.last_time, can::Time{1015ms});
}

TEST(ProgramExecution, BufferMemory_IsReadAndWrittenAtTheMomentOfTheProgram) {
  ProgrammedRack plc(
      "PROGRAM P VAR n : UINT; END_VAR n := n + 1; IF n = 3 THEN U2\\G10 := n; D5 := U2\\G11; END_IF; "
      "END_PROGRAM");
  plc.module.words[11] = 77;
  plc.run(9999us);
  EXPECT_THAT(plc.module.writes, IsEmpty());
  plc.run(1us);
  EXPECT_THAT(plc.module.writes, ElementsAre(Pair(10, 3)));
  EXPECT_EQ(plc.module.last_time, can::Time{1010ms});
  std::uint16_t word = 0;
  ASSERT_TRUE(plc.rack.read_words(Device::d, 5, {&word, 1}, plc.timeline.now()));
  EXPECT_EQ(word, 77);
}

TEST(ProgramExecution, FirstScanRelay_IsOnForOneRunOfTheProgram) {
  ProgrammedRack plc(
      "PROGRAM P VAR first, all : INT; END_VAR all := all + 1; IF SM402 THEN first := first + 1; END_IF; "
      "END_PROGRAM");
  plc.run(50ms);
  EXPECT_EQ(plc.read("P.first"), "1");
  EXPECT_EQ(plc.read("P.all"), "11");
}

TEST(ProgramExecution, Timer_MeasuresPlantTimeFromScanToScan) {
  ProgrammedRack plc("PROGRAM P VAR t : TON; END_VAR t(IN := TRUE, PT := T#12ms); END_PROGRAM");
  plc.run(10ms);
  EXPECT_EQ(plc.read("P.t.ET"), "T#10ms");
  EXPECT_EQ(plc.read("P.t.Q"), "FALSE");
  plc.run(5ms);
  EXPECT_EQ(plc.read("P.t.ET"), "T#12ms");
  EXPECT_EQ(plc.read("P.t.Q"), "TRUE");
}

TEST(ProgramExecution, Fault_StopsTheCpuAndNamesTheLine) {
  ProgrammedRack plc(
      "PROGRAM P\nVAR n : INT := 3; x : INT; END_VAR\nY20 := TRUE;\nn := n - 1;\nx := 6 / n;\nEND_PROGRAM");
  plc.run(100ms);
  EXPECT_THAT(plc.faults, ElementsAre(Pair("main.st:5:8: division by zero", can::Time{1010ms})));
  EXPECT_EQ(plc.rack.cpu_state(), CpuState::stop);
  EXPECT_EQ(plc.module.y, 0U) << "Y go off";
  EXPECT_EQ(plc.read("P.x"), "6");
  plc.rack.set_cpu_state(CpuState::run, plc.timeline.now());
  EXPECT_EQ(plc.read("P.x"), "3");
}

TEST(ProgramExecution, PowerCut_KeepsRetainedVariablesAlone) {
  ProgrammedRack plc(
      "PROGRAM P VAR RETAIN n : INT; END_VAR VAR m : INT; END_VAR n := n + 1; m := m + 1; END_PROGRAM");
  plc.run(10ms);
  plc.rack.power_off(plc.timeline.now());
  plc.run(10ms);
  plc.rack.power_on(plc.timeline.now());
  EXPECT_EQ(plc.read("P.n"), "4");
  EXPECT_EQ(plc.read("P.m"), "1");
}

TEST(ProgramExecution, Devices_HaveTheNamesAndNumbersOfTheFamily) {
  const CpuDeviceNames r04(r04cpu());
  EXPECT_EQ(r04.point("X1F")->number, 0x1FU);
  EXPECT_EQ(r04.point("U3E0\\HG7")->device, static_cast<std::uint16_t>(Device::hg));
  EXPECT_TRUE(r04.point("U4\\G25")->is_buffer);
  EXPECT_EQ(r04.point("D20000").error(), "the R04CPU has no such device");
  EXPECT_TRUE(r04.looks_like_device("XA0"));
  EXPECT_FALSE(r04.looks_like_device("BAD"));
  EXPECT_FALSE(r04.looks_like_device("MOTOR1"));
  const CpuDeviceNames fx(fx3u());
  EXPECT_EQ(fx.point("X17")->number, 15U);
  EXPECT_FALSE(fx.looks_like_device("X18"));
}

TEST(ProgramExecution, EstimatedScan_GrowsWithTheProgram) {
  const auto small = compiled(counting);
  std::string text = "PROGRAM P VAR n : INT; END_VAR ";
  for (int i = 0; i < 20'000; ++i) text += "n := n + 1; ";
  const auto large = compiled(text + "END_PROGRAM");
  EXPECT_EQ(estimated_scan(*small, CpuFamily::iqr), 400us);
  EXPECT_EQ(estimated_scan(*large, CpuFamily::iqr), 600us);
}

ProgramTask task(std::string name, TaskKind kind, std::string program, unsigned priority = 32) {
  return {.name = std::move(name), .kind = kind, .programs = {std::move(program)}, .priority = priority};
}

constexpr const char* two_programs =
    "VAR_GLOBAL order : STRING; END_VAR "
    "PROGRAM A VAR n : INT; END_VAR n := n + 1; order := CONCAT(order, 'A'); END_PROGRAM "
    "PROGRAM B VAR n : INT; END_VAR n := n + 1; order := CONCAT(order, 'B'); END_PROGRAM";

TEST(ProgramExecution, InitialTask_IsExecutedAloneInTheFirstScanAfterRun) {
  ProgrammedRack plc(two_programs, CpuState::run, {task("start", TaskKind::initial, "B")});
  EXPECT_EQ(plc.read("order"), "'B'");
  plc.run(10ms);
  EXPECT_EQ(plc.read("order"), "'BAA'");
  plc.rack.set_cpu_state(CpuState::stop, plc.timeline.now());
  plc.run(5ms);
  plc.rack.set_cpu_state(CpuState::run, plc.timeline.now());
  plc.run(5ms);
  EXPECT_EQ(plc.read("order"), "'BA'");
}

TEST(ProgramExecution, FixedScanTask_IsExecutedAtItsOwnIntervalFromRunOn) {
  ProgramTask fixed = task("fast", TaskKind::fixed_scan, "B");
  fixed.every = 2ms;
  ProgrammedRack plc(two_programs, CpuState::run, {fixed});
  EXPECT_EQ(plc.read("order"), "'A'");
  plc.run(1999us);
  EXPECT_EQ(plc.read("B.n"), "0");
  plc.run(1us);
  EXPECT_EQ(plc.read("B.n"), "1");
  plc.run(8ms);
  EXPECT_EQ(plc.read("order"), "'ABBABBBA'") << "at one moment the fixed scan is first";
  plc.rack.set_cpu_state(CpuState::stop, plc.timeline.now());
  plc.run(10ms);
  EXPECT_EQ(plc.read("B.n"), "5");
}

TEST(ProgramExecution, EventTask_IsExecutedOnceWhenTheDeviceGoesOn) {
  ProgramTask event = task("event", TaskKind::event, "B");
  event.on = "X20";
  event.on_point = CpuDeviceNames(r04cpu()).point("X20").value();
  ProgrammedRack plc(two_programs, CpuState::run, {event});
  plc.run(6ms);
  EXPECT_EQ(plc.read("order"), "'AA'");
  plc.module.x = 1;
  plc.run(3ms);
  EXPECT_EQ(plc.read("B.n"), "0") << "X is that of the refresh";
  plc.run(1ms);
  EXPECT_EQ(plc.read("order"), "'AABA'") << "the event is before the scan's programs";
  plc.run(20ms);
  EXPECT_EQ(plc.read("B.n"), "1");
  plc.module.x = 0;
  plc.run(5ms);
  plc.module.x = 1;
  plc.run(5ms);
  EXPECT_EQ(plc.read("B.n"), "2");
}

TEST(ProgramExecution, StandbyTask_IsNotExecuted) {
  ProgrammedRack plc(two_programs, CpuState::run, {task("library", TaskKind::standby, "A")});
  plc.run(20ms);
  EXPECT_EQ(plc.read("order"), "'BBBBB'");
}

TEST(ProgramExecution, TaskWithTheNameOfTheOthers_IsATaskLikeAnyOther) {
  ProgrammedRack plc(two_programs, CpuState::run, {task("all other programs", TaskKind::standby, "A")});
  plc.run(20ms);
  EXPECT_EQ(plc.read("order"), "'BBBBB'");
  EXPECT_EQ(plc.execution.tasks().rows().size(), 2U);
}

TEST(ProgramExecution, Priority_OrdersTasksThatAreDueTogether) {
  ProgrammedRack plc(two_programs, CpuState::run,
                     {task("second", TaskKind::scan, "A", 2), task("first", TaskKind::scan, "B", 1)});
  EXPECT_EQ(plc.read("order"), "'BA'");
}

TEST(ProgramExecution, HaltAndSingleScan_ExecuteScanByScanWhileTimeGoesOn) {
  ProgrammedRack plc(counting);
  plc.execution.halt();
  plc.run(50ms);
  EXPECT_EQ(plc.read("P.n"), "1");
  plc.execution.single_scan();
  EXPECT_FALSE(plc.execution.is_halted());
  plc.run(50ms);
  EXPECT_EQ(plc.read("P.n"), "2");
  EXPECT_TRUE(plc.execution.is_halted());
  plc.execution.resume();
  plc.run(10ms);
  EXPECT_EQ(plc.read("P.n"), "4");
}

constexpr const char* with_block =
    "FUNCTION_BLOCK Step\nVAR_INPUT amount : INT; END_VAR\nVAR sum : INT; END_VAR\nsum := sum + amount;\n"
    "END_FUNCTION_BLOCK\nPROGRAM P\nVAR a, b : Step; n : INT; END_VAR\na(amount := 1);\nn := n + 1;\n"
    "b(amount := 10);\nD7 := n;\nEND_PROGRAM\n";

TEST(ProgramExecution, Break_HaltsBeforeTheLineInACalledBlockAndGoesOnBehindIt) {
  ProgrammedRack plc(with_block);
  program::Machine& machine = plc.execution.machine();
  ASSERT_EQ(machine.set_break("main.st", 4), 4U);
  plc.run(5ms);
  EXPECT_TRUE(plc.execution.is_halted());
  EXPECT_EQ(machine.halted_at().line, 4U);
  EXPECT_EQ(plc.read("P.a.sum"), "1") << "of the scan before";
  plc.run(20ms);
  EXPECT_EQ(plc.read("P.a.sum"), "1");
  plc.execution.resume();
  plc.run(5ms);
  EXPECT_EQ(plc.read("P.a.sum"), "2");
  EXPECT_EQ(plc.read("P.n"), "2");
  EXPECT_EQ(plc.read("P.b.sum"), "10") << "halted again, in the other instance";
  EXPECT_TRUE(machine.clear_break("main.st", 4));
  plc.execution.resume();
  plc.run(5ms);
  EXPECT_EQ(plc.read("P.b.sum"), "20") << "the rest of that scan";
  EXPECT_EQ(plc.read("P.n"), "2");
  plc.run(5ms);
  EXPECT_EQ(plc.read("P.n"), "3");
}

TEST(ProgramExecution, Break_StandsAtTheNextLineWithAStatement) {
  ProgrammedRack plc(with_block);
  program::Machine& machine = plc.execution.machine();
  EXPECT_EQ(machine.set_break("main.st", 7), 8U);
  EXPECT_EQ(machine.set_break("main.st", 99).error(),
            "line 99: no statement of 'main.st' stands there or behind it");
  EXPECT_EQ(machine.set_break("other.st", 1).error(), "'other.st': expected a file of the program");
  EXPECT_FALSE(machine.clear_break("main.st", 7));
  EXPECT_EQ(machine.breaks().size(), 1U);
}

TEST(ProgramExecution, OnlineChangeAtABreak_LeavesTheRestOfTheScanOut) {
  ProgrammedRack plc(with_block);
  ASSERT_TRUE(plc.execution.machine().set_break("main.st", 11).has_value());
  plc.run(5ms);
  ASSERT_EQ(plc.execution.machine().halted_at().line, 11U);
  plc.execution.change(compiled(std::string("// one line more\n") + with_block), {});
  EXPECT_FALSE(plc.execution.machine().is_halted());
  EXPECT_TRUE(plc.execution.is_halted());
  EXPECT_EQ(plc.read("P.n"), "2");
  plc.execution.resume();
  plc.run(5ms);
  EXPECT_EQ(plc.read("P.n"), "3");
  EXPECT_EQ(plc.execution.machine().halted_at().line, 11U) << "the break stays in its line";
}

std::uint16_t word_of(ProgrammedRack& plc, Device device, std::uint32_t number) {
  std::uint16_t word = 0;
  EXPECT_TRUE(plc.rack.read_words(device, number, {&word, 1}, plc.timeline.now()));
  return word;
}
bool bit_of(ProgrammedRack& plc, Device device, std::uint32_t number) {
  std::uint8_t bit = 0;
  EXPECT_TRUE(plc.rack.read_bits(device, number, {&bit, 1}, plc.timeline.now()));
  return bit != 0;
}

TEST(ProgramExecution, Error_StoresItsCodeAndItsTimeUntilRun) {
  ProgrammedRack plc("PROGRAM P VAR n : INT := 2; x : INT; END_VAR n := n - 1; x := 6 / n; END_PROGRAM");
  EXPECT_FALSE(bit_of(plc, Device::sm, 0));
  EXPECT_EQ(word_of(plc, Device::sd, 0), 0);
  plc.run(65s);
  EXPECT_TRUE(bit_of(plc, Device::sm, 0));
  EXPECT_TRUE(bit_of(plc, Device::sm, 1));
  EXPECT_EQ(word_of(plc, Device::sd, 0), 0x3400);
  EXPECT_EQ(word_of(plc, Device::sd, 1), 2000);
  EXPECT_EQ(word_of(plc, Device::sd, 6), 1) << "the second of the error, not of now";
  EXPECT_EQ(plc.execution.error()->code, 0x3400);
  EXPECT_EQ(plc.execution.error()->position.line, 1U);
  plc.rack.set_cpu_state(CpuState::run, plc.timeline.now());
  EXPECT_FALSE(bit_of(plc, Device::sm, 0));
  EXPECT_EQ(word_of(plc, Device::sd, 0), 0);
  EXPECT_FALSE(plc.execution.error().has_value());
}

TEST(ProgramExecution, EndlessLoop_IsAWatchdogError) {
  ProgrammedRack plc("PROGRAM P VAR n : DINT; END_VAR WHILE TRUE DO n := n + 1; END_WHILE; END_PROGRAM");
  ASSERT_EQ(plc.faults.size(), 1U);
  EXPECT_EQ(plc.faults.front().first, "main.st:1:33: the scan takes too long: a loop may not end");
  EXPECT_TRUE(plc.rack.cpu_error()->is_watchdog);
}

TEST(ProgramExecution, RetainedVariables_OutliveTheProcess) {
  Battery battery;
  const std::string text =
      "TYPE Colour : (red, green); END_TYPE PROGRAM P VAR RETAIN n : INT; t : TIME := T#5s; s : STRING[10]; "
      "list : ARRAY[1..3] OF REAL; c : Colour; END_VAR VAR m : INT; END_VAR n := n - 1; m := m + 1; s := "
      "'a$27b'; "
      "list[2] := 1.5; c := green; END_PROGRAM";
  {
    ProgrammedRack plc(text, CpuState::run, {}, &battery);
    plc.run(20ms);
    plc.execution.save_retained();
  }
  ProgrammedRack plc(text, CpuState::stop, {}, &battery);
  EXPECT_EQ(plc.read("P.n"), "-5");
  EXPECT_EQ(plc.read("P.t"), "T#5s");
  EXPECT_EQ(plc.read("P.s"), "'a$'b'");
  EXPECT_EQ(plc.read("P.list[2]"), "1.5");
  EXPECT_EQ(plc.read("P.c"), "green");
  EXPECT_EQ(plc.read("P.m"), "0");
  EXPECT_THAT(plc.execution.not_restored(), IsEmpty());
}

TEST(ProgramExecution, RetainedVariableOfAnotherType_HasItsInitialValue) {
  Battery battery;
  {
    ProgrammedRack plc("PROGRAM P VAR RETAIN a, b, c : INT := 3; END_VAR a := 7; b := 8; END_PROGRAM",
                       CpuState::run, {}, &battery);
    plc.execution.save_retained();
  }
  ProgrammedRack plc("PROGRAM P VAR RETAIN a : DINT := 1; b : INT := 2; END_VAR D0 := 0; END_PROGRAM",
                     CpuState::run, {}, &battery);
  EXPECT_EQ(plc.read("P.a"), "1");
  EXPECT_EQ(plc.read("P.b"), "8");
  EXPECT_THAT(plc.execution.not_restored(), ElementsAre("P.a was INT, and is DINT now", "P.c is no more"));
}

TEST(ProgramExecution, RetainedBytesOfAStranger_AreNoValues) {
  Battery battery;
  const std::string text =
      "P.a\tINT\t0000000000008000\nP.b\tINT\tx\nP.s\tSTRING[4]\t0000000400000005 0\nP.a\tINT\n\tINT\t1\n\n"
      "P.k\tINT\t1\nP.b\tINT\t1 2\nP.b\tINT\t4";
  battery.contents["retain"].assign(text.begin(), text.end());
  ProgrammedRack plc(
      "PROGRAM P VAR RETAIN a, b : INT := 2; s : STRING[4] := 'x'; END_VAR VAR CONSTANT k : INT := 9; "
      "END_VAR "
      "D0 := k; END_PROGRAM",
      CpuState::run, {}, &battery);
  EXPECT_EQ(plc.read("P.a"), "2");
  EXPECT_EQ(plc.read("P.b"), "4") << "the last line is right";
  EXPECT_EQ(plc.read("P.s"), "'x'");
  EXPECT_EQ(plc.read("P.k"), "9");
  EXPECT_EQ(plc.execution.not_restored().size(), 8U);
}

TEST(ProgramExecution, RetainedVariables_AreSavedEveryTenSecondsAndWithoutSupply) {
  Battery battery;
  ProgrammedRack plc("PROGRAM P VAR RETAIN n : INT; END_VAR n := n + 1; END_PROGRAM", CpuState::run, {},
                     &battery);
  plc.run(8s);
  const auto first = battery.contents["retain"];
  plc.run(2s);
  const auto second = battery.contents["retain"];
  EXPECT_NE(first, second);
  plc.run(1s);
  EXPECT_EQ(battery.contents["retain"], second);
  plc.rack.power_off(plc.timeline.now());
  EXPECT_NE(battery.contents["retain"], second);
}

TEST(ProgramExecution, SourceView_ShowsValuesOfVariablesAndDevicesInTheirLines) {
  const std::string text =
      "PROGRAM P\nVAR t : TON; n : INT; END_VAR\n(* n D1\n n *) n := D7; // n\nt(IN := X20, PT := T#1s); n "
      ":= 'n';\n"
      "IF t.Q AND U2\\G10 = 3 THEN n := 16#F; END_IF;\nEND_PROGRAM";
  can::Timeline timeline;
  Rack rack(timeline, r04cpu(), 5ms);
  const std::string good = "PROGRAM P\nVAR t : TON; n : INT; END_VAR\nn := 1;\nEND_PROGRAM";
  ProgramExecution execution(timeline, rack, {.program = compiled(good), .sources = {{"main.st", text}}},
                             [](const std::string&, can::Time) {});
  const SourceView view = source_view(execution, r04cpu(), 0, 3, 4, "");
  EXPECT_EQ(view.lines, 7U);
  ASSERT_EQ(view.shown.size(), 4U);
  EXPECT_EQ(view.shown[0].text, "(* n D1");
  EXPECT_TRUE(view.shown[0].has_code);
  EXPECT_FALSE(view.shown[2].has_code);
  const auto names = [](const SourceLine& line) {
    std::vector<std::string> all;
    for (const NamedValue& value : line.values)
      all.push_back(std::to_string(value.column) + '+' + std::to_string(value.length) + ' ' + value.name +
                    (value.is_device ? "!" : ""));
    return all;
  };
  EXPECT_THAT(names(view.shown[0]), IsEmpty());
  EXPECT_THAT(names(view.shown[1]), ElementsAre("7+1 P.n", "12+2 D7!"));
  EXPECT_THAT(names(view.shown[2]), ElementsAre("9+3 X20!", "27+1 P.n"));
  EXPECT_THAT(names(view.shown[3]), ElementsAre("4+3 P.t.Q", "12+6 U2\\G10!", "28+1 P.n"));
}

TEST(ProgramExecution, SourceView_OfABlockShowsOneOfItsInstances) {
  can::Timeline timeline;
  Rack rack(timeline, r04cpu(), 5ms);
  ProgramExecution execution(timeline, rack,
                             {.program = compiled(with_block), .sources = {{"main.st", with_block}}},
                             [](const std::string&, can::Time) {});
  SourceView view = source_view(execution, r04cpu(), 0, 4, 1, "P.b");
  EXPECT_THAT(view.blocks, ElementsAre("P.a", "P.b"));
  EXPECT_EQ(view.block, "P.b");
  ASSERT_EQ(view.shown.size(), 1U);
  ASSERT_EQ(view.shown[0].values.size(), 3U);
  EXPECT_EQ(view.shown[0].values[2].name, "P.b.amount");
  view = source_view(execution, r04cpu(), 0, 4, 1, "none");
  EXPECT_EQ(view.block, "P.a");
  view = source_view(execution, r04cpu(), 0, 8, 4, "");
  EXPECT_EQ(view.block, "") << "no line of a block is shown";
  EXPECT_EQ(source_view(execution, r04cpu(), 1, 1, 4, "").lines, 0U);
}

// The table of its devices is that of the clients, who do not reach them.
TEST(ProgramExecution, IndexRegistersOfAnFx3_AreThePrograms) {
  can::Timeline timeline;
  FakeModule module;
  Rack rack(timeline, fx3u(), 5ms);
  std::vector<std::string> faults;
  ProgramExecution execution(
      timeline, rack,
      {.program =
           compiled("PROGRAM P VAR n : INT; END_VAR n := Z0; Z0 := Z0 + 1; Z7 := 10; D0Z7 := Z0; END_PROGRAM",
                    fx3u())},
      [&faults](const std::string& fault, can::Time) { faults.push_back(fault); });
  timeline.add(module);
  rack.insert(0, module);
  rack.power_on(can::Time{}, CpuState::run);
  timeline.run_until(can::Time{10ms});
  EXPECT_THAT(faults, IsEmpty());
  EXPECT_EQ(execution.machine().read("P.n"), "2");
  std::array<std::uint16_t, 1> word{};
  ASSERT_TRUE(rack.read_words(Device::d, 10, word, timeline.now()));
  EXPECT_EQ(word[0], 3);
  EXPECT_FALSE(rack.read_words(Device::z, 0, word, timeline.now()));
  const CpuDeviceNames names(rack.model());
  EXPECT_FALSE(names.point("Z8"));
  EXPECT_FALSE(names.point("Z10"));
}

}  // namespace
}  // namespace canopus::plc::program_execution_test
