// Programs in Structured Text at random in a rack's CPU: what a machine does to variables and devices, with its code linked to their memory,
// and what the same program does by the functions of the devices alone.

#include "canopus/program/linked_code.hpp"

#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/plc/execution/cpu_devices.hpp"
#include "canopus/program/machine.hpp"
#include "canopus/structured_text/compiler.hpp"

#include "plc/fake_module.hpp"
#include "support/random_cases.hpp"
#include "support/reference_machine.hpp"

namespace canopus::plc::linked_code_test {
namespace {

constexpr int variables = 4;

std::string number(int below) { return std::to_string(*rc::gen::inRange(0, below)); }

/// A variable or device of BOOL; `is_block`: of the function block, which has its own.
std::string bit(bool is_block) {
  switch (*rc::gen::inRange(0, 10)) {
    case 8: return "t.Q";
    case 9: return is_block ? "q" : "many[" + number(3) + "].q";
    case 0: return "D" + number(3) + "." + number(10);
    case 1: return "X" + number(10);
    case 2: return is_block ? "own" : "f.q";
    case 3:
    case 4: return is_block ? "in" : "v" + number(variables);
    case 5: return "g";
    default: return "M" + number(6);
  }
}

std::string expression(int depth, bool is_block) {
  const auto operand = [&] { return expression(depth - 1, is_block); };
  switch (depth == 0 ? 9 : *rc::gen::inRange(0, 10)) {
    case 0: return "NOT " + operand();
    case 1: return "(" + operand() + ")";
    case 2: return "(D" + number(4) + (*rc::gen::arbitrary<bool>() ? " = " : " > ") + number(9) + ")";
    case 3: return "NOT (" + operand() + " OR " + operand() + ")";
    case 4: return "(" + operand() + " XOR " + operand() + ")";
    case 5: return operand() + " OR NOT " + operand();
    case 6:
    case 7:
    case 8: return operand() + " AND " + operand();
    default: return bit(is_block);
  }
}

std::string statement(bool is_block, int depth = 2) {
  const auto inner = [&] {
    return depth == 0 ? std::string("g := NOT g;\n") : statement(is_block, depth - 1);
  };
  switch (*rc::gen::inRange(0, 14)) {
    case 8: return "t(IN := " + expression(2, is_block) + ", PT := T#" + number(4) + "0ms);\n";
    case 9: return "t(IN := FALSE);\n" + inner();
    case 10:
      return "IF " + bit(is_block) + " THEN " + inner() + "END_IF;\nIF " + bit(is_block) + " THEN " +
             inner() + "ELSE " + inner() + "END_IF;\n";
    case 11: return "IF " + expression(2, is_block) + " THEN " + inner() + "RETURN; END_IF;\n";
    case 12:
      return "CASE D" + number(4) + " OF 0: " + inner() + "1..3: " + inner() + "5, 7: " + inner() + "ELSE " +
             inner() + "END_CASE;\n";
    case 13:
      return is_block ? inner()
                      : "FOR i := 0 TO 2 DO many[i](in := " + expression(2, false) +
                            " OR i MOD 2 = " + number(2) + "); END_FOR;\n";
    case 0: return "IF " + expression(2, is_block) + " THEN M2 := " + expression(2, is_block) + "; END_IF;\n";
    case 1: return "D" + number(4) + " := D" + number(4) + " + " + number(5) + ";\n";
    case 2: return "D2:DINT := D0:DINT - " + number(9) + ";\n";
    case 3:
      return is_block ? "own := " + expression(3, true) + ";\n" : "f(in := " + expression(2, false) + ");\n";
    case 4: return "g := " + expression(3, is_block) + ";\n";
    case 5: return "D" + number(3) + "." + number(10) + " := " + expression(2, is_block) + ";\n";
    case 6:
      return is_block ? "q := " + expression(3, true) + ";\n"
                      : "v" + number(variables) + " := " + expression(3, false) + ";\n";
    default: return "M" + number(6) + " := " + expression(3, is_block) + ";\n";
  }
}

std::string any_program() {
  std::string text =
      "VAR_GLOBAL g : BOOL; END_VAR\nFUNCTION_BLOCK F VAR_INPUT in : BOOL; END_VAR VAR_OUTPUT q : BOOL; "
      "END_VAR VAR own : BOOL; t : TON; END_VAR\n";
  for (int i = *rc::gen::inRange(1, 6); i > 0; --i) text += statement(true);
  text +=
      "END_FUNCTION_BLOCK\nPROGRAM P VAR v0, v1, v2, v3 : BOOL; f : F; t : TON; i : INT; many : ARRAY[0..2] "
      "OF F; END_VAR\n";
  for (int i = *rc::gen::inRange(1, 20); i > 0; --i) text += statement(false);
  return text + "END_PROGRAM\n";
}

/// With a module, whose X are from X0 on.
struct Cpu {
  can::Timeline timeline;
  testing::FakeModule module;
  Rack rack{timeline, r04cpu(), std::chrono::milliseconds(10)};
  CpuDevices devices{rack};

  Cpu() {
    rack.insert(0, module);
    rack.power_on(can::Time{});
  }
};

void compare(const std::string& text) {
  const CpuDeviceNames names(r04cpu());
  const std::vector<structured_text::Source> sources = {{"main.st", text}};
  auto made = structured_text::compile(sources, &names);
  if (!made.program) RC_FAIL(made.errors.front().message + "\n" + text);
  const std::shared_ptr<const program::Program> program = std::move(made.program);

  Cpu linked;
  Cpu reference;
  program::Machine machine(program);
  testing_support::ReferenceMachine by_functions(program);
  for (int scan = 0; scan < 5; ++scan) {
    const std::int64_t now = 10'000'000LL * scan;
    RC_ASSERT(!machine.scan(now, &linked.devices));
    RC_ASSERT(!by_functions.scan(now, reference.devices));
    for (const Device device : {Device::m, Device::d}) {
      std::array<std::uint16_t, 8> a{};
      std::array<std::uint16_t, 8> b{};
      RC_ASSERT(linked.rack.read_words(device, 0, a, can::Time{}).has_value());
      RC_ASSERT(reference.rack.read_words(device, 0, b, can::Time{}).has_value());
      RC_ASSERT(a == b);
    }
    for (const char* const path :
         {"g", "P.v0", "P.v1", "P.v2", "P.v3", "P.f.in", "P.f.q", "P.f.own", "P.f.t.Q", "P.f.t.ET", "P.t.IN",
          "P.t.Q", "P.t.ET", "P.i", "P.many[0].q", "P.many[1].own", "P.many[2].q", "P.many[2].t.ET"}) {
      const auto variable = machine.find(path);
      RC_ASSERT(variable.has_value());
      RC_ASSERT(*machine.value_at(variable->place) == by_functions.at(variable->place));
    }
  }
}

TEST(LinkedPrograms, LeaveTheSameVariablesAndDevices_AsByTheFunctionsOfTheDevices) {
  support::expect_property([] { compare(any_program()); }, 500, 5000);
}

}  // namespace
}  // namespace canopus::plc::linked_code_test
