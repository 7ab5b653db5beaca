// Step ladders, interrupt programs, labels.

#include <chrono>

#include <gmock/gmock.h>

#include "canopus/plc/execution/program_execution.hpp"

#include "list_plc.hpp"

namespace canopus::list_structure_test {
namespace {

using list_plc::errors_of;
using list_plc::Family;
using list_plc::ListPlc;
using namespace std::chrono_literals;

std::string states(ListPlc& plc) {
  std::string on;
  for (const char* const name : {"S0", "S20", "S21", "S22", "S23"})
    if (plc.get(name) != 0) on += std::string(on.empty() ? "" : " ") + name;
  return on;
}

TEST(StepLadder, StateGoesOnByItsContact_AndItsOutputsGoOffWithTheNextExecution) {
  ListPlc plc(Family::fx3, {"LD M0", "SET S0", "STL S0", "OUT Y0", "LD M1", "SET S20", "STL S20", "OUT Y1",
                            "OUT T0 K2", "LD T0", "SET S0", "RET", "LD M8000", "OUT Y2"});
  plc.set("M8000", 1);
  plc.run();
  EXPECT_EQ(states(plc), "");
  EXPECT_EQ(plc.get("Y0"), 0);
  plc.set("M0", 1);
  plc.run();
  plc.set("M0", 0);
  EXPECT_EQ(states(plc), "S0");
  EXPECT_EQ(plc.get("Y0"), 1);
  plc.set("M1", 1);
  plc.run();
  plc.set("M1", 0);
  EXPECT_EQ(states(plc), "S20");
  EXPECT_EQ(plc.get("Y0"), 1) << "both outputs for one scan";
  EXPECT_EQ(plc.get("Y1"), 1);
  plc.run();
  EXPECT_EQ(plc.get("Y0"), 0);
  EXPECT_EQ(plc.get("Y1"), 1);
  plc.run(22);  // 200 ms
  EXPECT_EQ(states(plc), "S0");
  EXPECT_EQ(plc.get("Y0"), 1);
  EXPECT_EQ(plc.get("Y1"), 0);
  EXPECT_EQ(plc.get("TN0"), 0) << "a timer of a state that is OFF is reset";
  EXPECT_EQ(plc.get("Y2"), 1) << "behind RET";
}

TEST(StepLadder, ParallelStates_AreJoinedByStlInARow) {
  ListPlc plc(Family::fx3,
              {"LD M0", "SET S20", "STL S20", "LD M1", "SET S21", "SET S22", "STL S21", "OUT Y1", "STL S22",
               "OUT Y2", "STL S21", "STL S22", "LD M2", "SET S23", "STL S23", "OUT Y3", "RET"});
  plc.set("M0", 1);
  plc.run();
  plc.set("M0", 0);
  plc.set("M1", 1);
  plc.run();
  EXPECT_EQ(states(plc), "S21 S22");
  plc.set("M1", 0);
  plc.set("S22", 0);
  plc.set("M2", 1);
  plc.run();
  EXPECT_EQ(states(plc), "S21") << "the join waits for both";
  plc.set("S22", 1);
  plc.run();
  EXPECT_EQ(states(plc), "S23");
}

TEST(StepLadder, OutOfAState_IsAJumpToIt) {
  ListPlc plc(Family::fx5,
              {"LD M0", "SET S0", "STL S0", "LD M1", "OUT S23", "RETSTL", "STL S23", "OUT Y1", "RETSTL"});
  plc.set("M0", 1);
  plc.run();
  plc.set("M0", 0);
  plc.set("M1", 1);
  plc.run();
  plc.set("M1", 0);
  EXPECT_EQ(states(plc), "S23");
  plc.run();
  EXPECT_EQ(states(plc), "S23") << "it stays ON without its condition";
}

TEST(StepLadder, Zrst_EndsAllStates) {
  ListPlc plc(Family::fx3, {"LD M0", "SET S20", "LD M1", "ZRST S0 S127", "STL S20", "OUT Y1", "RET"});
  plc.set("M0", 1);
  plc.run();
  EXPECT_EQ(plc.get("Y1"), 1);
  plc.set("M0", 0);
  plc.set("M1", 1);
  plc.run();
  EXPECT_EQ(states(plc), "");
  EXPECT_EQ(plc.get("Y1"), 0);
}

TEST(StepLadder, Mistakes_NameTheLine) {
  EXPECT_EQ(errors_of(Family::fx3, {"STL M0", "RET", "END"}),
            "MAIN.csv:4: STL: 'M0': expected a state such as S20\n"
            "MAIN.csv:5: RET without STL; expected one above\n");
  EXPECT_EQ(errors_of(Family::fx3, {"STL S0", "OUT Y0", "END"}),
            "MAIN.csv:4: STL without an end; expected RET behind the last state\n");
  EXPECT_EQ(errors_of(Family::fx3, {"FEND", "P0", "STL S0", "OUT Y0", "RET", "SRET", "END"}),
            "MAIN.csv:6: STL in a subroutine or interrupt program; expected it in the main program\n"
            "MAIN.csv:7: OUT without contacts; expected LD or another contact before it\n"
            "MAIN.csv:8: RET without STL; expected one above\n");
  EXPECT_EQ(errors_of(Family::q, {"STL S0", "END"}),
            "MAIN.csv:4: 'STL' is not available for Q but for FX3, FX5; see docs/instruction-list.md\n");
}

/// A rack with a scan of 10 ms that runs a list.
struct ListRack {
  ListRack(Family family, std::vector<std::string> lines)
      : names(list_plc::model_of(family)),
        rack(timeline, list_plc::model_of(family), 10ms),
        execution(timeline, rack, {.program = compiled(family, std::move(lines))},
                  [this](const std::string& fault, can::Time) { faults.push_back(fault); }) {
    rack.power_on(can::Time{});
  }
  std::shared_ptr<const program::Program> compiled(Family family, std::vector<std::string> lines) const {
    const std::vector<instruction_list::Source> sources = {{"MAIN.csv", list_plc::csv(lines)}};
    auto made = instruction_list::compile(sources, family, names);
    EXPECT_EQ(list_plc::text(made.errors), "");
    return std::move(made.program);
  }
  void run(can::Duration duration) { timeline.run_until(timeline.now() + duration); }
  int get(std::string_view name) {
    const auto point = names.point(name);
    std::uint16_t word = 0;
    EXPECT_TRUE(point && rack.read_words(static_cast<plc::Device>(point->device), point->number, {&word, 1},
                                         timeline.now()))
        << name;
    return word;
  }
  void set_bit(std::string_view name, bool on) {
    const auto point = names.point(name);
    const std::uint8_t bit = on ? 1 : 0;
    EXPECT_TRUE(point && rack.write_bits(static_cast<plc::Device>(point->device), point->number, {&bit, 1},
                                         timeline.now()))
        << name;
  }

  can::Timeline timeline;
  plc::CpuDeviceNames names;
  plc::Rack rack;
  std::vector<std::string> faults;
  plc::ProgramExecution execution;
};

TEST(InterruptProgram, OfATimer_IsExecutedBetweenScansWhileTheyAreEnabled) {
  ListRack plc(Family::fx3, {"LD M0", "INCP D9", "EI", "FEND", "I625", "LD M8000", "INC D0", "IRET", "END"});
  plc.run(99ms);  // 25, 50, 75
  EXPECT_EQ(plc.get("D0"), 3);
  plc.run(2ms);
  EXPECT_EQ(plc.get("D0"), 4);
  EXPECT_TRUE(plc.faults.empty());
}

TEST(InterruptProgram, UnderDi_WaitsForTheNextEiAndIsExecutedOnce) {
  ListRack plc(Family::q, {"DI", "LD M0", "CJ P1", "JMP P2", "P1", "EI", "P2", "FEND", "I31", "LD SM400",
                           "INC D0", "IRET", "END"});
  plc.run(95ms);
  EXPECT_EQ(plc.get("D0"), 0);
  plc.set_bit("M0", true);
  plc.run(10ms);
  EXPECT_EQ(plc.get("D0"), 1) << "what was due nine times";
}

TEST(InterruptProgram, OfAnInput_IsExecutedWithItsEdge) {
  ListRack plc(Family::fx3, {"EI", "LD M8000", "MOV D0 D2", "FEND", "I001", "LD M8000", "INC D0", "IRET",
                             "I100", "LD M8000", "INC D1", "IRET", "END"});
  plc.run(15ms);
  plc.set_bit("X0", true);
  plc.set_bit("X1", true);
  plc.run(10ms);
  EXPECT_EQ(plc.get("D0"), 1);
  EXPECT_EQ(plc.get("D2"), 1) << "before the program of the scan";
  EXPECT_EQ(plc.get("D1"), 0);
  plc.set_bit("X0", false);
  plc.set_bit("X1", false);
  plc.run(20ms);
  EXPECT_EQ(plc.get("D0"), 1);
  EXPECT_EQ(plc.get("D1"), 1);
}

TEST(InterruptProgram, OfAnFx3_IsMaskedByItsRelay) {
  ListRack plc(Family::fx3, {"EI", "FEND", "I610", "LD M8000", "INC D0", "IRET", "END"});
  plc.set_bit("M8056", true);
  plc.run(55ms);
  EXPECT_EQ(plc.get("D0"), 0);
  plc.set_bit("M8056", false);
  plc.run(20ms);
  EXPECT_EQ(plc.get("D0"), 2);
}

TEST(InterruptProgram, RunAgain_BeginsWithDi) {
  ListRack plc(Family::q, {"LD M0", "CJ P1", "EI", "P1", "FEND", "I31", "LD SM400", "INC D0", "IRET", "END"});
  plc.run(25ms);
  EXPECT_EQ(plc.get("D0"), 2);
  plc.set_bit("M0", true);
  plc.rack.set_cpu_state(module::CpuState::stop, plc.timeline.now());
  plc.rack.set_cpu_state(module::CpuState::run, plc.timeline.now());
  plc.run(50ms);
  EXPECT_EQ(plc.get("D0"), 2);
}

TEST(InterruptProgram, Mistakes_NameTheLine) {
  EXPECT_EQ(errors_of(Family::fx3, {"FEND", "I600", "IRET", "END"}),
            "MAIN.csv:5: I600: expected I000 to I501 (inputs X0 to X5; last digit 1 rising, 0 falling) or "
            "I610 to I899 "
            "(every 10 to 99 ms)\n");
  EXPECT_EQ(
      errors_of(Family::q, {"FEND", "I0", "IRET", "END"}),
      "MAIN.csv:5: I0: expected I28 to I31 (every 100, 40, 20, 10 ms): there are no interrupts of modules\n");
  EXPECT_EQ(errors_of(Family::q, {"FEND", "I31", "RET", "I30", "IRET", "I30", "IRET", "END"}),
            "MAIN.csv:5: I31 is an interrupt program, but its end is no IRET\n"
            "MAIN.csv:9: I30: there is another one of this number above\n");
  EXPECT_EQ(errors_of(Family::q, {"I31", "END"}),
            "MAIN.csv:4: I31 is an interrupt program; expected it behind FEND\n");
}

const std::vector<instruction_list::Label> labels = {
    {"", "start", "BOOL", "X10"},      {"", "count", "INT", "D100"},   {"", "delay", "Timer", "T3"},
    {"MAIN", "count", "DINT", "D200"}, {"MAIN", "limit", "INT", "K7"}, {"MAIN", "flag", "BOOL", ""},
    {"MAIN", "sum", "DINT", ""},       {"MAIN", "level", "REAL", ""},  {"SUB", "other", "INT", "D1"}};

TEST(ListLabels, StandForDevicesOfTheFilesLabels_LocalOnesFirst) {
  ListPlc plc(
      Family::q,
      {"LD start", "OUT flag", "LD flag", "DMOV K65537 COUNT", "MOV limit D0", "OUT delay K50", "LD count.0",
       "OUT M5", "D+ count K1 sum", "DMOV sum D10", "EMOV E1.5 level", "E+ level E1 D12"},
      true, labels);
  plc.set("X10", 1);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.double_word("D", 200), 65537);
  EXPECT_EQ(plc.get("D100"), 0);
  EXPECT_EQ(plc.get("D0"), 7);
  EXPECT_EQ(plc.get("TC3"), 1);
  EXPECT_EQ(plc.get("M5"), 1);
  EXPECT_EQ(plc.double_word("D", 10), 65538);
  EXPECT_EQ(plc.get("D13"), 0x4020) << "2.5";
  EXPECT_EQ(plc.machine->read("MAIN.sum").value_or(""), "65538");
  EXPECT_EQ(plc.machine->read("MAIN.flag").value_or(""), "TRUE");
}

TEST(ListLabels, Mistakes_NameTheLabel) {
  const auto of = [](const std::string& line) {
    return errors_of(Family::q, {"LD M0", line, "END"}, labels);
  };
  EXPECT_EQ(of("MOV K1 sum"), "MAIN.csv:5: MOV: 'sum': it is DINT; expected INT\n");
  EXPECT_EQ(of("BMOV D0 sum K1"),
            "MAIN.csv:5: BMOV: 'sum': it is a variable; expected a device, or a label that has one\n");
  EXPECT_EQ(of("MOV K1 other"), "MAIN.csv:5: MOV: 'other': expected a device of the Q03UDVCPU\n");
  EXPECT_EQ(of("OUT sum.3"),
            "MAIN.csv:5: OUT: 'sum.3': it is a variable; expected a label with a device for a bit\n");
}

}  // namespace
}  // namespace canopus::list_structure_test
