// A machine's variables by name: watched, written, forced, retained, and kept over an online change.

#include <gtest/gtest.h>

#include "compiled.hpp"

namespace structured_text_machine_test {
namespace {

using compiled::Plc;

TEST(Machine, Write_ChangesOneVariableOrSaysWhatWasExpected) {
  Plc plc(
      "VAR_GLOBAL g : INT; END_VAR VAR_GLOBAL CONSTANT k : INT := 1; END_VAR\n"
      "PROGRAM P VAR s : STRING[3]; c : (red, green); r : INT (1..5); a : ARRAY[1..2, 0..1] OF REAL; w : "
      "WORD; t : TIME; END_VAR ; END_PROGRAM");
  plc.write("G", "12");
  EXPECT_EQ(plc.read("g"), "12");
  plc.write("p.S", "'ab'");
  EXPECT_EQ(plc.read("P.s"), "'ab'");
  plc.write("P.c", "Green");
  EXPECT_EQ(plc.read("P.c"), "green");
  plc.write("P.a[2, 1]", "1.5");
  EXPECT_EQ(plc.read("P.a"), "[[0.0, 0.0], [0.0, 1.5]]");
  EXPECT_EQ(plc.read("P.a[2][1]"), "1.5");
  plc.write("P.w", "16#FF");
  EXPECT_EQ(plc.read("P.w"), "16#00FF");
  plc.write("P.t", "T#1s");
  EXPECT_EQ(plc.read("P.t"), "T#1s");

  const auto error = [&](std::string_view path, std::string_view value) {
    const auto done = plc.machine->write(path, value);
    return done ? std::string("done") : done.error();
  };
  EXPECT_EQ(error("g", "40000"), "expected INT");
  EXPECT_EQ(error("P.r", "6"), "expected INT from 1 to 5");
  EXPECT_EQ(error("P.c", "blue"), "expected red, green");
  EXPECT_EQ(error("P.s", "'abcd'"), "expected at most 3 characters");
  EXPECT_EQ(error("P.a", "1"), "expected the name of one value, not of an array or a structure");
  EXPECT_EQ(error("P.a[3, 0]", "1"), "'P.a[3, 0]': expected an index from 1 to 2");
  EXPECT_EQ(error("P.none", "1"), "'P.none': there is no 'none' in it");
  EXPECT_EQ(error("none", "1"), "'none': expected the name of a global variable or of a program");
  EXPECT_EQ(error("k", "1"), "'k' is a constant");
  EXPECT_EQ(plc.read("g"), "12");
}

TEST(Machine, Force_HoldsAValueWhateverTheProgramWrites) {
  Plc plc("VAR_GLOBAL g, seen : INT; END_VAR PROGRAM P seen := g; g := g + 1; END_PROGRAM");
  ASSERT_TRUE(plc.machine->force("g", "100"));
  EXPECT_EQ(plc.run(3), "");
  EXPECT_EQ(plc.read("seen"), "100");
  EXPECT_EQ(plc.read("g"), "100");
  ASSERT_TRUE(plc.machine->release("g"));
  EXPECT_EQ(plc.run(2), "");
  EXPECT_EQ(plc.read("g"), "102");
  EXPECT_EQ(plc.machine->release("g").error(), "'g' is not forced");
}

TEST(Machine, WarmStart_KeepsRetainedVariablesAlone) {
  Plc plc(
      "VAR_GLOBAL RETAIN kept : INT := 1; END_VAR VAR_GLOBAL lost : INT := 1; END_VAR\n"
      "FUNCTION_BLOCK B VAR RETAIN n : INT; END_VAR VAR m : INT; END_VAR n := n + 1; m := m + 1; "
      "END_FUNCTION_BLOCK\n"
      "PROGRAM P VAR RETAIN x : STRING := 'a'; u : CTU; END_VAR VAR y : INT; b : B; END_VAR\n"
      "kept := kept + 1; lost := lost + 1; x := CONCAT(x, 'b'); y := 5; b(); u(CU := TRUE, PV := 9); "
      "END_PROGRAM");
  EXPECT_EQ(plc.run(2), "");
  plc.machine->warm_start();
  EXPECT_EQ(plc.read("kept"), "3");
  EXPECT_EQ(plc.read("lost"), "1");
  EXPECT_EQ(plc.read("P.x"), "'abb'");
  EXPECT_EQ(plc.read("P.y"), "0");
  EXPECT_EQ(plc.read("P.b.n"), "2");
  EXPECT_EQ(plc.read("P.b.m"), "0");
  EXPECT_EQ(plc.read("P.u.CV"), "1");
  plc.machine->cold_start();
  EXPECT_EQ(plc.read("kept"), "1");
  EXPECT_EQ(plc.read("P.x"), "'a'");
}

TEST(Machine, OnlineChange_KeepsVariablesOfTheSameNameAndType) {
  Plc plc(
      "TYPE S : STRUCT a, b : INT; END_STRUCT END_TYPE VAR_GLOBAL g : INT; changed : INT; END_VAR\n"
      "PROGRAM P VAR t : TON; s : S; l : ARRAY[1..3] OF INT := [1, 2, 3]; n : STRING[5] := 'hello'; END_VAR\n"
      "t(IN := TRUE, PT := T#1s); g := g + 1; changed := 7; s.b := 4; END_PROGRAM");
  EXPECT_EQ(plc.run(5), "");
  const std::vector<compiled::st::Source> sources = {
      {"main.st",
       "TYPE S : STRUCT b, c, a : INT := 9; END_STRUCT END_TYPE VAR_GLOBAL fresh : INT := 3; changed : REAL "
       ":= 0.5; g : INT; END_VAR\n"
       "PROGRAM P VAR x : INT := 2; n : STRING[3]; l : ARRAY[2..5] OF INT; s : S; t : TON; END_VAR\n"
       "t(IN := TRUE, PT := T#1s); g := g + 10; END_PROGRAM"}};
  auto made = compiled::st::compile(sources, &plc.devices);
  ASSERT_EQ(compiled::text(made.errors), "");
  plc.machine->change(std::move(made.program));
  EXPECT_EQ(plc.read("g"), "5");
  EXPECT_EQ(plc.read("fresh"), "3");
  EXPECT_EQ(plc.read("changed"), "0.5");
  EXPECT_EQ(plc.read("P.x"), "2");
  EXPECT_EQ(plc.read("P.s"), "(b := 4, c := 9, a := 0)");
  EXPECT_EQ(plc.read("P.l"), "[2, 3, 0, 0]");
  EXPECT_EQ(plc.read("P.n"), "'hel'");
  EXPECT_EQ(plc.read("P.t.ET"), "T#40ms");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("g"), "15");
  EXPECT_EQ(plc.read("P.t.ET"), "T#50ms");  // the timer goes on
}

}  // namespace
}  // namespace structured_text_machine_test
