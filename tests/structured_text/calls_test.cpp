// EN and ENO, methods, arrays at devices, and standard functions with many inputs.

#include <gtest/gtest.h>

#include "compiled.hpp"

namespace structured_text_calls_test {
namespace {

using compiled::errors_of;
using compiled::Plc;

TEST(Output, BehindNot_IsInverted_OfFunctionsMethodsAndBlocks) {
  Plc plc(
      "FUNCTION is_one : INT VAR_INPUT i : INT; END_VAR VAR_OUTPUT o : BOOL; END_VAR o := i = 1; "
      "END_FUNCTION\n"
      "FUNCTION_BLOCK B VAR_OUTPUT q : BOOL; END_VAR METHOD m VAR_INPUT i : INT; END_VAR VAR_OUTPUT o : "
      "BOOL; "
      "END_VAR o := i = 1; END_METHOD q := TRUE; END_FUNCTION_BLOCK\n"
      "PROGRAM P VAR b : B; a1, a2, a3, a4, a5 : BOOL; n : INT; END_VAR\n"
      "is_one(1, NOT o => a1); n := is_one(2, NOT o => a2); b.m(1, NOT o => a3); b.m(2, NOT o => a4); "
      "b(NOT q => a5); END_PROGRAM");
  EXPECT_EQ(plc.run(1), "");
  for (const char* name : {"P.a1", "P.a3", "P.a5"}) EXPECT_EQ(plc.read(name), "FALSE") << name;
  for (const char* name : {"P.a2", "P.a4"}) EXPECT_EQ(plc.read(name), "TRUE") << name;
  EXPECT_EQ(errors_of("FUNCTION f VAR_OUTPUT o : INT; END_VAR END_FUNCTION PROGRAM P VAR n : INT; END_VAR "
                      "f(NOT o => n); END_PROGRAM"),
            "main.st:1:86: expected a BOOL output behind NOT\n");
}

TEST(Enable, CallWithEnFalse_ChangesNothingAndEnoIsFalse) {
  Plc plc(
      "FUNCTION twice : INT VAR_INPUT a : INT; END_VAR VAR_IN_OUT n : INT; END_VAR twice := 2 * a; n := n + "
      "1; "
      "END_FUNCTION\n"
      "FUNCTION_BLOCK Count VAR_INPUT amount : INT; END_VAR VAR_OUTPUT sum : INT; END_VAR sum := sum + "
      "amount; "
      "END_FUNCTION_BLOCK\n"
      "PROGRAM P VAR go : BOOL; x, y, n, s : INT; c : Count; t : TON; ok, ok2, ok3, ok4 : BOOL := TRUE; "
      "END_VAR\n"
      "x := twice(EN := go, a := 5, n := n, ENO => ok);\n"
      "twice(a := 1, n := n, EN := go);\n"
      "c(EN := go, amount := 3, sum => s, ENO => ok2);\n"
      "t(EN := go, IN := TRUE, PT := T#10ms);\n"
      "y := ADD(EN := go, IN1 := 1, IN2 := 2, ENO => ok3) + 10;\n"
      "SPLIT_DATE(EN := go, IN := D#2024-02-29, DAY => s, ENO => ok4); END_PROGRAM");
  EXPECT_EQ(plc.run(2), "");
  EXPECT_EQ(plc.read("P.x"), "0");
  EXPECT_EQ(plc.read("P.y"), "10");
  EXPECT_EQ(plc.read("P.n"), "0");
  EXPECT_EQ(plc.read("P.c.sum"), "0");
  EXPECT_EQ(plc.read("P.s"), "0");
  EXPECT_EQ(plc.read("P.t.IN"), "FALSE");
  for (const char* name : {"P.ok", "P.ok2", "P.ok3", "P.ok4"}) EXPECT_EQ(plc.read(name), "FALSE") << name;
  plc.write("P.go", "TRUE");
  EXPECT_EQ(plc.run(2), "");
  EXPECT_EQ(plc.read("P.x"), "10");
  EXPECT_EQ(plc.read("P.y"), "13");
  EXPECT_EQ(plc.read("P.n"), "4");
  EXPECT_EQ(plc.read("P.c.sum"), "6");
  EXPECT_EQ(plc.read("P.s"), "29");
  EXPECT_EQ(plc.read("P.t.Q"), "TRUE");
  for (const char* name : {"P.ok", "P.ok2", "P.ok3", "P.ok4"}) EXPECT_EQ(plc.read(name), "TRUE") << name;
}

TEST(EnableOutput, BehindNot_IsInverted) {
  Plc plc(
      "FUNCTION_BLOCK B END_FUNCTION_BLOCK\n"
      "PROGRAM P VAR go : BOOL; x : INT; of_function, of_block : BOOL; b : B; END_VAR\n"
      "x := ADD(EN := go, IN1 := 1, IN2 := 2, NOT ENO => of_function); b(EN := go, NOT ENO => of_block);\n"
      "go := TRUE; END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.of_function") + plc.read("P.of_block"), "TRUETRUE");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.of_function") + plc.read("P.of_block"), "FALSEFALSE");
}

TEST(Enable, ConditionWithItsEffect_IsEvaluatedThoughTheFirstOneIsFalse) {
  Plc plc(
      "PROGRAM P VAR no : BOOL; ok : BOOL; n : INT; END_VAR\n"
      "IF no AND GT(EN := TRUE, IN1 := 2, IN2 := 1, ENO => ok) THEN n := 1; END_IF; END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P"), "(no := FALSE, ok := TRUE, n := 0)");
}

TEST(Enable, StringResult_IsEmptyWithEnFalse) {
  Plc plc(
      "PROGRAM P VAR go : BOOL; s : STRING := 'old'; END_VAR\n"
      "s := CONCAT(EN := go, IN1 := 'a', IN2 := 'b'); END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.s"), "''");
  plc.write("P.go", "TRUE");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.s"), "'ab'");
}

TEST(Enable, UnitWithAVariableOfThatName_HasItAsAnInput) {
  Plc plc(
      "FUNCTION_BLOCK B VAR_INPUT EN : BOOL; END_VAR VAR_OUTPUT ENO : BOOL; n : INT; END_VAR\n"
      "n := n + 1; ENO := EN AND n > 1; END_FUNCTION_BLOCK\n"
      "PROGRAM P VAR b : B; ok : BOOL; END_VAR b(EN := FALSE, ENO => ok); b(EN := TRUE, ENO => ok); "
      "END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.b.n"), "2");
  EXPECT_EQ(plc.read("P.ok"), "TRUE");
}

constexpr const char* motor =
    "FUNCTION_BLOCK Motor\n"
    "VAR_INPUT go : BOOL; END_VAR VAR_OUTPUT speed : INT; END_VAR VAR CONSTANT most : INT := 100; END_VAR\n"
    "VAR starts : INT; END_VAR\n"
    "METHOD PUBLIC start : BOOL VAR_INPUT wanted : INT; END_VAR VAR n : INT; END_VAR\n"
    "  n := n + 1; starts := starts + n; speed := limited(wanted); start := speed = wanted; END_METHOD\n"
    "METHOD stop speed := 0; THIS.count(amount := 10); END_METHOD\n"
    "METHOD PRIVATE limited : INT VAR_INPUT v : INT; END_VAR limited := MIN(v, most); END_METHOD\n"
    "METHOD count VAR_INPUT amount : INT := 1; END_VAR VAR_IN_OUT END_VAR starts := starts + amount; "
    "END_METHOD\n"
    "METHOD started : INT started := THIS.starts; END_METHOD\n"
    "IF go THEN count(); END_IF;\n"
    "END_FUNCTION_BLOCK\n";

TEST(Methods, Call_WorksOnItsInstance) {
  Plc plc(std::string(motor) +
          "PROGRAM P VAR a, b : Motor; list : ARRAY[1..2] OF Motor; i : INT := 2; good, bad : BOOL; n, m, k "
          ": INT; "
          "END_VAR\n"
          "good := a.start(50); bad := b.start(wanted := 200); list[i].start(7); b.stop(); a(go := TRUE);\n"
          "n := a.started(); m := b.started() + list[2].started(); k := list[1].started(); END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.good"), "TRUE");
  EXPECT_EQ(plc.read("P.bad"), "FALSE");
  EXPECT_EQ(plc.read("P.a.speed"), "50");
  EXPECT_EQ(plc.read("P.b.speed"), "0");
  EXPECT_EQ(plc.read("P.list[2].speed"), "7");
  EXPECT_EQ(plc.read("P.n"), "2");   // start() and the body's count()
  EXPECT_EQ(plc.read("P.m"), "12");  // start() and stop()'s 10, and the list's
  EXPECT_EQ(plc.read("P.k"), "0");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.n"), "4");
}

TEST(Methods, Parameters_AreByReferenceAsThoseOfFunctions) {
  Plc plc(
      "FUNCTION_BLOCK B VAR_IN_OUT n : INT; END_VAR VAR x : INT; END_VAR\n"
      "METHOD add VAR_INPUT amount : INT; END_VAR VAR_IN_OUT sum : INT; END_VAR VAR_OUTPUT old : INT; "
      "END_VAR\n"
      "old := sum; sum := sum + amount; x := x + 1; n := x; END_METHOD\n"
      "n := 0; add(5, n);\nEND_FUNCTION_BLOCK\n"
      "PROGRAM P VAR b : B; n, m, o : INT; END_VAR b(n := n); m := 3; b.add(amount := 4, sum := m, old => o, "
      "EN "
      ":= TRUE); "
      "END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.n"), "2");
  EXPECT_EQ(plc.read("P.m"), "7");
  EXPECT_EQ(plc.read("P.o"), "3");
}

TEST(Methods, Mistakes_AreNamed) {
  const auto errors = [](const std::string& body) {
    return errors_of(std::string(motor) + "PROGRAM P VAR a : Motor; n : INT; END_VAR\n" + body +
                     "\nEND_PROGRAM");
  };
  EXPECT_EQ(errors("n := a.limited(5);"),
            "main.st:13:8: expected a method that is PUBLIC: limited is its block's own\n");
  EXPECT_EQ(errors("n := a.stop();"), "main.st:13:8: expected a method with a result: stop has none\n");
  EXPECT_EQ(errors("a.run();"), "main.st:13:3: Motor has no element run\n");
  EXPECT_EQ(errors_of("FUNCTION_BLOCK B METHOD m : INT m := THIS.m(); END_METHOD END_FUNCTION_BLOCK"),
            "main.st:1:43: m is used by itself: a function or function block does not call itself\n");
  EXPECT_EQ(errors_of("FUNCTION_BLOCK B METHOD m END_METHOD METHOD m END_METHOD END_FUNCTION_BLOCK"),
            "main.st:1:45: expected another name: there is a method m\n");
  EXPECT_EQ(errors_of("FUNCTION_BLOCK B METHOD m VAR t : TON; END_VAR END_METHOD END_FUNCTION_BLOCK"),
            "main.st:1:31: expected a data type: a function block needs a variable that keeps its values\n");
}

TEST(DeviceArrays, Elements_AreDevicesInARow) {
  Plc plc(
      "VAR_GLOBAL points AT M10 : ARRAY[1..4] OF BOOL; END_VAR\n"
      "PROGRAM P VAR words AT D20 : ARRAY[0..9] OF INT; reals AT D40 : ARRAY[1..2] OF REAL;\n"
      "table AT D60 : ARRAY[1..2, 1..3] OF DINT; masks AT M100 : ARRAY[0..1] OF WORD; i, k : INT; sum : "
      "DINT; "
      "END_VAR\n"
      "FOR i := 0 TO 9 DO words[i] := 10 * i; END_FOR; words[3] := words[3] + words[i - 1];\n"
      "reals[2] := 1.5; points[4] := TRUE; points[1] := points[4];\n"
      "FOR i := 1 TO 2 DO FOR k := 1 TO 3 DO table[i, k] := 100000 * i + k; END_FOR; END_FOR;\n"
      "sum := table[2, 3] + table[1, 1]; i := 1; masks[i] := 16#8001; words[0].1 := TRUE; END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.devices.word('D', 20), 2);
  EXPECT_EQ(plc.devices.word('D', 23), 30 + 90);
  EXPECT_EQ(plc.devices.word('D', 29), 90);
  EXPECT_EQ(plc.devices.word('D', 43), 0x3FC0);  // 1.5 is 16#3FC0_0000
  EXPECT_EQ(plc.devices.word('D', 70), 200003 & 0xFFFF);
  EXPECT_EQ(plc.devices.word('D', 71), 200003 >> 16);
  EXPECT_EQ(plc.devices.word('M', 10), 1);
  EXPECT_EQ(plc.devices.word('M', 11), 0);
  EXPECT_EQ(plc.devices.word('M', 13), 1);
  EXPECT_EQ(plc.devices.word('M', 116), 1);
  EXPECT_EQ(plc.devices.word('M', 131), 1);
  EXPECT_EQ(plc.read("P.sum"), "300004");
}

TEST(DeviceArrays, WrongIndexOrUse_IsAnError) {
  Plc plc("PROGRAM P VAR a AT D20 : ARRAY[1..3] OF INT; i : INT := 4; END_VAR\na[i] := 1; END_PROGRAM");
  EXPECT_EQ(plc.run(), "main.st:2:1: array index 4 is outside of 1 to 3");
  EXPECT_EQ(plc.devices.word('D', 23), 0);
  Plc last("PROGRAM P VAR a AT D255 : ARRAY[1..3] OF INT; END_VAR\na[2] := 1; END_PROGRAM");
  EXPECT_EQ(last.run(), "main.st:2:1: D255: the CPU or the module has no such device");
  const auto errors = [](const std::string& declarations, const std::string& body) {
    return errors_of("PROGRAM P VAR " + declarations + " END_VAR\n" + body + "\nEND_PROGRAM");
  };
  const std::string whole = "expected an element of it: an array of devices is no value as a whole\n";
  EXPECT_EQ(errors("a AT D20 : ARRAY[1..3] OF INT; b : ARRAY[1..3] OF INT;", "b := a;"),
            "main.st:2:6: " + whole);
  EXPECT_EQ(errors("a AT D20 : ARRAY[1..3] OF INT; b : ARRAY[1..3] OF INT;", "a := b;"),
            "main.st:2:1: " + whole);
  EXPECT_EQ(errors("a AT D20 : ARRAY[1..3] OF INT;", "a[4] := 1;"),
            "main.st:2:3: expected an index from 1 to 3\n");
  EXPECT_EQ(errors("a AT D20.1 : ARRAY[1..3] OF BOOL;", ";"),
            "main.st:1:20: expected a device without a point for an array\n");
  EXPECT_EQ(errors("a AT D20 : ARRAY[1..3] OF STRING;", ";"),
            "main.st:1:15: expected an elementary type, or an array of one: a device is one value\n");
  EXPECT_EQ(errors("a AT D20 : ARRAY[1..3] OF INT := [1];", ";"),
            "main.st:1:48: expected no initial value: a device keeps its own\n");
}

TEST(ManyInputs, Comparisons_HoldForEachPairInARow) {
  Plc plc(
      "PROGRAM P VAR a, b, c, d, e, f : BOOL; n : INT := 2; END_VAR\n"
      "a := GT(3, n, 1); b := GT(3, 1, n); c := LE(1, 2, 2, 3); d := EQ('a', 'a', 'b'); e := LT('a', 'b', "
      "'c');\n"
      "f := GE(IN1 := 2.5, IN2 := 2.0, IN3 := 2.5); END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P"), "(a := TRUE, b := FALSE, c := TRUE, d := FALSE, e := TRUE, f := FALSE, n := 2)");
  EXPECT_EQ(errors_of("PROGRAM P VAR a : BOOL; END_VAR a := NE(1, 2, 3); END_PROGRAM"),
            "main.st:1:38: expected 2 inputs: IN1,IN2\n");
}

TEST(ManyInputs, MaxMinAndLimit_OrderStringsByTheirCharacters) {
  Plc plc(
      "PROGRAM P VAR a, b, c, d : STRING; w : WSTRING; END_VAR\n"
      "a := MAX('b', 'abc', 'B'); b := MIN('b', 'abc', 'B'); c := LIMIT('f', 'a', 'k'); d := LIMIT('f', 'z', "
      "'k');\n"
      "w := MAX(\"x\", \"xy\"); END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P"), "(a := 'b', b := 'B', c := 'f', d := 'k', w := \"xy\")");
}

TEST(LongDates, ConcatAndSplit_WorkAsThoseOfTheShortTypes) {
  Plc plc(
      "PROGRAM P VAR d : LDATE; t : LTOD; x : LDT; y, m, h, ms : INT; END_VAR\n"
      "d := CONCAT_LDATE(2024, 2, 29); t := CONCAT_LTOD(1, 2, 3, 4); x := CONCAT_LDT(1999, 12, 31, 23, 59, "
      "59, 999);\n"
      "SPLIT_LDATE(d, MONTH => m); SPLIT_LTOD(IN := t, MILLISECOND => ms); SPLIT_LDT(IN := x, YEAR => y, "
      "HOUR => h); "
      "END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(
      plc.read("P"),
      "(d := LDATE#2024-02-29, t := LTOD#01:02:03.004, x := LDT#1999-12-31-23:59:59.999, y := 1999, m := 2, "
      "h := 23, ms := 4)");
}

}  // namespace
}  // namespace structured_text_calls_test
