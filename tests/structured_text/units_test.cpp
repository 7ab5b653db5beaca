// Functions, function blocks, global variables, timers and counters scan by scan.

#include <gtest/gtest.h>

#include "compiled.hpp"

namespace structured_text_units_test {
namespace {

using compiled::Plc;

TEST(Functions, Call_WithInputsByNameOrOrderReturnsTheResult) {
  Plc plc(
      "FUNCTION twice : INT VAR_INPUT a : INT; b : INT := 10; END_VAR twice := 2 * a + b; END_FUNCTION\n"
      "PROGRAM P VAR x, y, z, n : INT; END_VAR\n"
      "x := twice(3, 1); y := twice(b := 2, a := 4); z := twice(1); n := twice(twice(1, 0), twice(2, 0));\n"
      "END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.x"), "7");
  EXPECT_EQ(plc.read("P.y"), "10");
  EXPECT_EQ(plc.read("P.z"), "12");
  EXPECT_EQ(plc.read("P.n"), "8");
}

TEST(Functions, LocalVariables_BeginAnewAtEachCall) {
  Plc plc(
      "FUNCTION f : INT VAR_INPUT a : INT; END_VAR VAR n : INT := 5; END_VAR n := n + a; f := n; "
      "END_FUNCTION\n"
      "PROGRAM P VAR x, y : INT; END_VAR x := f(1); y := f(1); END_PROGRAM");
  EXPECT_EQ(plc.run(2), "");
  EXPECT_EQ(plc.read("P.x"), "6");
  EXPECT_EQ(plc.read("P.y"), "6");
}

TEST(Functions, OutputsAndInOuts_ReachTheCallersVariables) {
  Plc plc(
      "FUNCTION divide : BOOL VAR_INPUT a, b : INT; END_VAR VAR_OUTPUT q, r : INT; END_VAR VAR_IN_OUT calls "
      ": INT; END_VAR\n"
      "calls := calls + 1; q := a / b; r := a MOD b; divide := r = 0; END_FUNCTION\n"
      "PROGRAM P VAR q, r, n : INT; exact : BOOL; list : ARRAY[1..2] OF INT; i : INT := 2; END_VAR\n"
      "exact := divide(a := 7, b := 2, calls := n, q => q, r => list[i]); END_PROGRAM");
  EXPECT_EQ(plc.run(3), "");
  EXPECT_EQ(plc.read("P.q"), "3");
  EXPECT_EQ(plc.read("P.list"), "[0, 1]");
  EXPECT_EQ(plc.read("P.n"), "3");
  EXPECT_EQ(plc.read("P.exact"), "FALSE");
}

TEST(Functions, StringsArraysAndStructures_GoInAndOutByValue) {
  Plc plc(
      "TYPE Point : STRUCT x, y : INT; END_STRUCT END_TYPE\n"
      "FUNCTION greet : STRING[20] VAR_INPUT n : STRING[10]; END_VAR greet := CONCAT('hi ', n); n := 'gone'; "
      "END_FUNCTION\n"
      "FUNCTION moved : Point VAR_INPUT p : Point; END_VAR p.x := p.x + 1; moved := p; END_FUNCTION\n"
      "FUNCTION sum : INT VAR_INPUT a : ARRAY[1..3] OF INT; END_VAR VAR i : INT; END_VAR\n"
      "FOR i := 1 TO 3 DO sum := sum + a[i]; END_FOR; END_FUNCTION\n"
      "PROGRAM P VAR s, n : STRING := 'bob'; a : Point := (x := 1, y := 2); b : Point; l : ARRAY[1..3] OF "
      "INT := [1, 2, 3]; t : INT; e : BOOL; END_VAR\n"
      "s := greet(n); b := moved(a); t := sum(l); e := greet('a') = greet('b'); END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.s"), "'hi bob'");
  EXPECT_EQ(plc.read("P.n"), "'bob'");
  EXPECT_EQ(plc.read("P.b"), "(x := 2, y := 2)");
  EXPECT_EQ(plc.read("P.a.x"), "1");
  EXPECT_EQ(plc.read("P.t"), "6");
  EXPECT_EQ(plc.read("P.e"), "FALSE");
}

TEST(FunctionBlocks, Instances_KeepTheirVariablesApart) {
  Plc plc(
      "FUNCTION_BLOCK Counter VAR_INPUT step : INT := 1; END_VAR VAR_OUTPUT n : INT; END_VAR VAR calls : "
      "INT; END_VAR\n"
      "VAR_TEMP t : INT := 3; END_VAR t := t + 1; calls := calls + t; n := n + step; END_FUNCTION_BLOCK\n"
      "PROGRAM P VAR a, b : Counter; list : ARRAY[1..3] OF Counter; i : INT; x : INT; END_VAR\n"
      "a(); b(step := 5, n => x); FOR i := 1 TO 3 DO list[i](step := i); END_FOR; END_PROGRAM");
  EXPECT_EQ(plc.run(2), "");
  EXPECT_EQ(plc.read("P.a.n"), "2");
  EXPECT_EQ(plc.read("P.b.n"), "10");
  EXPECT_EQ(plc.read("P.x"), "10");
  EXPECT_EQ(plc.read("P.list[3].n"), "6");
  EXPECT_EQ(plc.read("P.a.calls"), "8");
}

TEST(FunctionBlocks, InOutsOfNestedInstances_ReachTheOutermostVariable) {
  Plc plc(
      "FUNCTION_BLOCK Inner VAR_IN_OUT v : INT; END_VAR v := v + 1; END_FUNCTION_BLOCK\n"
      "FUNCTION_BLOCK Outer VAR_IN_OUT w : INT; END_VAR VAR f : Inner; END_VAR f(v := w); w := w * 2; "
      "END_FUNCTION_BLOCK\n"
      "VAR_GLOBAL g : INT := 1; END_VAR\n"
      "PROGRAM P VAR o : Outer; x : INT := 3; s : STRUCT a, b : INT; END_STRUCT; END_VAR\n"
      "o(w := x); o(w := g); o(w := s.b); END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.x"), "8");
  EXPECT_EQ(plc.read("g"), "4");
  EXPECT_EQ(plc.read("P.s.b"), "2");
}

TEST(FunctionBlocks, EdgeInputs_AreTrueForOneCall) {
  Plc plc(
      "FUNCTION_BLOCK E VAR_INPUT r : BOOL R_EDGE; f : BOOL F_EDGE; END_VAR VAR_OUTPUT up, down : INT; "
      "END_VAR\n"
      "IF r THEN up := up + 1; END_IF; IF f THEN down := down + 1; END_IF; END_FUNCTION_BLOCK\n"
      "PROGRAM P VAR e : E; b : BOOL := TRUE; END_VAR e(r := b, f := b); END_PROGRAM");
  EXPECT_EQ(plc.run(3), "");
  EXPECT_EQ(plc.read("P.e.up"), "1");
  plc.write("P.b", "FALSE");
  EXPECT_EQ(plc.run(3), "");
  EXPECT_EQ(plc.read("P.e.down"), "1");
}

TEST(Variables, LocalNames_ShadowGlobalOnesAndDevices) {
  Plc plc(
      "VAR_GLOBAL x : INT := 1; g : INT; END_VAR VAR_GLOBAL CONSTANT limit : INT := 3; size : INT := limit + "
      "1; END_VAR\n"
      "PROGRAM P VAR_EXTERNAL g : INT; END_VAR VAR x, D0 : INT := 5; a : ARRAY[0..size] OF INT; END_VAR\n"
      "x := x + limit; g := size; D0 := 7; a[size] := 1; END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("x"), "1");
  EXPECT_EQ(plc.read("P.x"), "8");
  EXPECT_EQ(plc.read("g"), "4");
  EXPECT_EQ(plc.devices.word('D', 0), 0);
}

TEST(Variables, NamesThatBeginAsAKeyword_AreNames) {
  Plc plc(
      "FUNCTION_BLOCK End_Stop VAR_INPUT variable : INT; END_VAR VAR_OUTPUT untilDone : INT; END_VAR "
      "untilDone := variable; END_FUNCTION_BLOCK\n"
      "PROGRAM P VAR variable, vars, elsewhere : INT; end_of_travel : End_Stop; END_VAR\n"
      "variable := 3; vars := 4; IF variable = 3 THEN end_of_travel(variable := 5); elsewhere := 6; END_IF; "
      "variable := variable + end_of_travel.untilDone; END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.variable"), "8");
  EXPECT_EQ(plc.read("P.vars"), "4");
  EXPECT_EQ(plc.read("P.elsewhere"), "6");
}

TEST(Variables, Constants_AreValuesOfLaterConstantsAndBounds) {
  Plc plc(
      "PROGRAM P VAR CONSTANT k : INT := 2; m : INT := k * 3; names : ARRAY[1..k] OF STRING[3] := ['a', "
      "'b']; END_VAR\n"
      "VAR a : ARRAY[k..m] OF INT; s : STRING[m]; x, i : INT := m; END_VAR\n"
      "a[m] := k; i := 2; s := names[i]; END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.a"), "[0, 0, 0, 0, 2]");
  EXPECT_EQ(plc.read("P.x"), "6");
  EXPECT_EQ(plc.read("P.s"), "'b'");
}

TEST(Variables, Programs_RunInTheirOrderAndShareGlobals) {
  Plc plc(
      "VAR_GLOBAL g : INT; END_VAR PROGRAM A g := g + 1; END_PROGRAM PROGRAM B VAR x : INT; END_VAR x := g * "
      "10; END_PROGRAM");
  EXPECT_EQ(plc.run(2), "");
  EXPECT_EQ(plc.read("B.x"), "20");
}

// The example of a TON's timing in IEC 61131-3 table 46: Q follows IN after PT, and ET stands at PT.
TEST(Timers, Ton_IsOnFromTheScanInWhichTheTimeHasPassed) {
  Plc plc("PROGRAM P VAR t : TON; b : BOOL := TRUE; END_VAR t(IN := b, PT := T#30ms); END_PROGRAM");
  EXPECT_EQ(plc.run(3), "");  // scans at 0, 10, 20 ms
  EXPECT_EQ(plc.read("P.t"), "(IN := TRUE, PT := T#30ms, Q := FALSE, ET := T#20ms)");
  EXPECT_EQ(plc.run(), "");  // 30 ms
  EXPECT_EQ(plc.read("P.t"), "(IN := TRUE, PT := T#30ms, Q := TRUE, ET := T#30ms)");
  EXPECT_EQ(plc.run(5), "");
  EXPECT_EQ(plc.read("P.t.ET"), "T#30ms");
  plc.write("P.b", "FALSE");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.t"), "(IN := FALSE, PT := T#30ms, Q := FALSE, ET := T#0s)");
}

TEST(Timers, Tof_IsOnForTheTimeAfterItsInput) {
  Plc plc("PROGRAM P VAR t : TOF; b : BOOL; END_VAR t(IN := b, PT := T#20ms); END_PROGRAM");
  EXPECT_EQ(plc.run(5), "");
  EXPECT_EQ(plc.read("P.t.Q"), "FALSE");
  plc.write("P.b", "TRUE");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.t.Q"), "TRUE");
  plc.write("P.b", "FALSE");
  EXPECT_EQ(plc.run(2), "");  // 0 and 10 ms after the edge
  EXPECT_EQ(plc.read("P.t"), "(IN := FALSE, PT := T#20ms, Q := TRUE, ET := T#10ms)");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.t"), "(IN := FALSE, PT := T#20ms, Q := FALSE, ET := T#20ms)");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.t.ET"), "T#20ms");
}

TEST(Timers, Tp_GivesOnePulseWhateverItsInputDoes) {
  Plc plc("PROGRAM P VAR t : TP; b : BOOL := TRUE; END_VAR t(IN := b, PT := T#20ms); END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.t.Q"), "TRUE");
  plc.write("P.b", "FALSE");
  EXPECT_EQ(plc.run(), "");  // 10 ms
  EXPECT_EQ(plc.read("P.t.Q"), "TRUE");
  plc.write("P.b", "TRUE");  // no second pulse begins in the first one
  EXPECT_EQ(plc.run(), "");  // 20 ms
  EXPECT_EQ(plc.read("P.t"), "(IN := TRUE, PT := T#20ms, Q := FALSE, ET := T#20ms)");
  EXPECT_EQ(plc.run(3), "");
  EXPECT_EQ(plc.read("P.t"), "(IN := TRUE, PT := T#20ms, Q := FALSE, ET := T#20ms)");
  plc.write("P.b", "FALSE");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.t.ET"), "T#0s");
}

TEST(Counters, CtuCtdCtud_CountEdgesWithinTheirRange) {
  Plc plc(
      "PROGRAM P VAR u : CTU; d : CTD; b : CTUD; i : INT; x : BOOL; END_VAR\n"
      "d(LD := TRUE, PV := 2); d(LD := FALSE, CD := FALSE);\n"
      "FOR i := 1 TO 3 DO u(CU := TRUE, PV := 3); u(CU := TRUE); u(CU := FALSE);\n"
      "d(CD := TRUE); d(CD := FALSE); b(CU := TRUE, CD := FALSE, PV := 2); b(CU := FALSE); END_FOR;\n"
      "b(CD := TRUE); b(CD := FALSE); END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.u.CV"), "3");
  EXPECT_EQ(plc.read("P.u.Q"), "TRUE");
  EXPECT_EQ(plc.read("P.d.CV"), "-1");
  EXPECT_EQ(plc.read("P.d.Q"), "TRUE");
  EXPECT_EQ(plc.read("P.b.CV"), "2");
  EXPECT_EQ(plc.read("P.b.QU"), "TRUE");
  EXPECT_EQ(plc.read("P.b.QD"), "FALSE");
}

TEST(Counters, Ctu_StopsAtTheEndOfItsType) {
  Plc plc(
      "PROGRAM P VAR u : CTU; i : DINT; END_VAR FOR i := 1 TO 40000 DO u(CU := TRUE, PV := 32767); u(CU := "
      "FALSE); END_FOR; END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.u.CV"), "32767");
}

TEST(Edges, TriggersAndBistables_FollowTheStandardsCode) {
  Plc plc(
      "PROGRAM P VAR r : R_TRIG; f : F_TRIG; sr : SR; rs : RS; b : BOOL; END_VAR\n"
      "r(CLK := b); f(CLK := b); sr(S1 := b, R := TRUE); rs(S := b, R1 := TRUE); END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.r.Q"), "FALSE");
  EXPECT_EQ(plc.read("P.f.Q"), "TRUE");  // M begins with FALSE
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.f.Q"), "FALSE");
  plc.write("P.b", "TRUE");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.r.Q"), "TRUE");
  EXPECT_EQ(plc.read("P.sr.Q1"), "TRUE");   // set is stronger
  EXPECT_EQ(plc.read("P.rs.Q1"), "FALSE");  // reset is stronger
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.r.Q"), "FALSE");
  plc.write("P.b", "FALSE");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.f.Q"), "TRUE");
}

TEST(Devices, Names_ReadAndWriteTheImage) {
  Plc plc(
      "VAR_GLOBAL start AT X10 : BOOL; level AT %MW0.30 : INT; END_VAR\n"
      "PROGRAM P VAR i : INT; r : REAL := 1.0; u : UINT := 65535; w : WORD := 16#8001; END_VAR\n"
      "Y0 := start; D0 := level + 1; D1.3 := TRUE; D2:REAL := r; D4:D := 100000; M0 := NOT M1;\n"
      "K2M16 := 16#A5; D6 := K4X0; Z1 := 2; D10Z1 := 77; U0\\G25 := 5; D7 := U0\\G25; i := D0; D8 := "
      "16#FFFF;\n"
      "IF D8.F THEN D9 := D0 + D7; END_IF; D20 := u; D21 := w; END_PROGRAM");
  plc.devices.word('X', 8) = 1;  // X10 in octal
  plc.devices.word('D', 30) = 0xFFFE;
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.devices.word('Y', 0), 1);
  EXPECT_EQ(plc.devices.word('D', 0), 0xFFFF);
  EXPECT_EQ(plc.devices.word('D', 1), 8);
  EXPECT_EQ(plc.devices.word('D', 2), 0x0000);
  EXPECT_EQ(plc.devices.word('D', 3), 0x3F80);
  EXPECT_EQ(plc.devices.word('D', 4), 100000 & 0xFFFF);
  EXPECT_EQ(plc.devices.word('D', 5), 100000 >> 16);
  EXPECT_EQ(plc.devices.word('M', 0), 1);
  EXPECT_EQ(plc.devices.word('M', 16), 1);
  EXPECT_EQ(plc.devices.word('M', 17), 0);
  EXPECT_EQ(plc.devices.word('M', 23), 1);
  EXPECT_EQ(plc.devices.word('D', 6), 0x0100);
  EXPECT_EQ(plc.devices.word('D', 12), 77);
  EXPECT_EQ(plc.devices.buffer[25], 5);
  EXPECT_EQ(plc.devices.word('D', 7), 5);
  EXPECT_EQ(plc.devices.word('D', 8), 0xFFFF);
  EXPECT_EQ(plc.devices.word('D', 9), 4);
  EXPECT_EQ(plc.devices.word('D', 20), 0xFFFF);
  EXPECT_EQ(plc.devices.word('D', 21), 0x8001);
  EXPECT_EQ(plc.read("P.i"), "-1");
}

TEST(Devices, OutOfRange_EndsTheScan) {
  Plc plc("PROGRAM P\nZ0 := 1000;\nD0Z0 := 1;\nEND_PROGRAM");
  EXPECT_EQ(plc.run(), "main.st:3:1: D0Z0: the CPU or the module has no such device");
  Plc module("PROGRAM P\nD0 := U3\\G0;\nEND_PROGRAM");
  EXPECT_EQ(module.run(), "main.st:2:7: U3\\G0: there is no module");
}

}  // namespace
}  // namespace structured_text_units_test
