// Small programs in which several features of the language are at work together; values worked out by hand from IEC 61131-3.

#include "programs.hpp"

namespace structured_text_mixed_programs_test {
namespace {

using programs::check;

TEST(MixedPrograms, BlocksWithinBlocks) {
  const char* const blocks =
      "FUNCTION_BLOCK Inner VAR_INPUT i : INT := 2; END_VAR VAR_OUTPUT o : INT; END_VAR VAR n : INT := 10; "
      "END_VAR\n"
      "n := n + i; o := n; END_FUNCTION_BLOCK\n"
      "FUNCTION_BLOCK Outer VAR_INPUT i : INT; END_VAR VAR_OUTPUT o : INT; END_VAR VAR a, b : Inner; l : "
      "ARRAY[0..1] OF Inner; END_VAR\n"
      "a(i := i); b(); l[1](i := a.o, o => o); o := o + b.o; END_FUNCTION_BLOCK";
  check({
      // a.n 10+3, b.n 10+2, l[1].n 10+13; then 16, 14, 23+16
      {"x : Outer;", "x(i := 3);",
       "> x.o=35 x.a.o=13 x.b.o=12 x.l[1].o=23 x.l[0].o=0; > x.o=53 x.a.o=16 x.l[1].o=39", blocks},
      {"x, y : Outer; n : INT;", "x(i := 1, o => n); y(i := n);", "> n=33 y.a.o=43 y.o=65", blocks},
      {"l : ARRAY[1..2] OF Outer; i : INT;", "FOR i := 1 TO 2 DO l[i](i := i); END_FOR;",
       "> l[1].o=33 l[2].o=34; > l[1].o=47", blocks},
      {"p : ARRAY[1..2] OF Inner := [(i := 5), (n := 1)];", "p[1](); p[2]();",
       "> p[1].o=15 p[2].o=3; > p[1].o=20 p[2].o=5", blocks},
  });
}

TEST(MixedPrograms, MethodsAndReferences) {
  const char* const counter =
      "TYPE Pair : STRUCT a, b : INT; END_STRUCT; END_TYPE\n"
      "FUNCTION_BLOCK Counter VAR_OUTPUT n : INT; END_VAR VAR step : INT := 1; END_VAR\n"
      "METHOD add : INT VAR_INPUT more : INT := 1; END_VAR VAR k : INT; END_VAR k := k + 1; n := n + more * "
      "step; add := n + k; END_METHOD\n"
      "METHOD twice : INT VAR_INPUT more : INT; END_VAR twice := add(more) + THIS.add(more := more); "
      "END_METHOD\n"
      "METHOD swap VAR_IN_OUT p : Pair; END_VAR VAR t : INT; END_VAR t := p.a; p.a := p.b; p.b := t; n := n "
      "+ 1; END_METHOD\n"
      "n := n + 100; END_FUNCTION_BLOCK\n"
      "FUNCTION_BLOCK User VAR_IN_OUT c : Counter; p : Pair; END_VAR VAR_OUTPUT o : INT; END_VAR o := "
      "c.add(3); c(); c.swap(p); END_FUNCTION_BLOCK";
  check({
      {"c : Counter; x, y : INT;", "x := c.add(); y := c.add(5);", "> x=2 y=7 c.n=6; > x=8 y=13 c.n=12",
       counter},
      {"c : Counter; x : INT;", "x := c.twice(4);", "> x=14 c.n=8; > x=30 c.n=16",
       counter},  // 5 + 9, 13 + 17
      {"c : Counter; p : Pair := (a := 1, b := 2); u : User;", "u(c := c, p := p);",
       "> u.o=4 c.n=104 p.a=2 p.b=1; > u.o=108 c.n=208 p.a=1", counter},
      {"c : ARRAY[0..1] OF Counter; l : ARRAY[0..1] OF Pair := [(a := 1), (b := 4)]; i : INT := 1; u : User;",
       "u(c := c[i], p := l[i]); i := 1 - i;",
       "> u.o=4 c[1].n=104 l[1].a=4 l[1].b=0; > u.o=4 c[0].n=104 l[0].a=0 l[0].b=1; > u.o=108 l[1].a=0",
       counter},
      {"c : Counter; x : INT;", "x := c.add(c.add(2));", "> x=6 c.n=5",
       counter},  // add(2) is 2 + 1, then n 2 + 3
      {"c : Counter; x : INT; b : BOOL;", "x := c.add(EN := b, more := 2);",
       "> x=0 c.n=0; b=TRUE > x=3 c.n=2", counter},
  });
}

TEST(MixedPrograms, ArraysOfStructures) {
  const char* const types =
      "TYPE Axis : STRUCT pos : DINT; name : STRING[5]; limits : ARRAY[1..2] OF INT := [-5, 5]; END_STRUCT; "
      "Axes : ARRAY[1..3] OF Axis; END_TYPE\n"
      "FUNCTION total : DINT VAR_INPUT a : Axes; END_VAR VAR i : INT; END_VAR FOR i := 1 TO 3 DO total := "
      "total + a[i].pos; a[i].pos := 0; END_FOR; END_FUNCTION\n"
      "FUNCTION moved : Axis VAR_INPUT a : Axis; more : DINT; END_VAR moved := a; moved.pos := moved.pos + "
      "more; "
      "END_FUNCTION";
  check({
      {"a : Axes := [(pos := 1, name := 'x'), 2((pos := 5))]; t : DINT;", "t := total(a);",
       "> t=11 a[1].pos=1 a[3].pos=5 a[2].limits[1]=-5 a[1].name='x'", types},
      {"a, b : Axes; i : INT := 2;", "a[i] := moved(a[i], 7); b := a; a[i].pos := 0; b[1] := b[i];",
       "> a[2].pos=0 b[2].pos=7 b[1].pos=7; > b[1].pos=7", types},
      {"a : Axes; i : INT;", "FOR i := 1 TO 3 DO a[i].name := CONCAT('axis', INT_TO_STRING(i + 8)); END_FOR;",
       "> a[1].name='axis9' a[2].name='axis1' a[3].name='axis1'", types},
      {"a : Axes; i, j : INT;",
       "FOR i := 1 TO 3 DO FOR j := 1 TO 2 DO a[i].limits[j] := a[i].limits[j] * i; END_FOR; END_FOR;",
       "> a[3].limits[1]=-15 a[3].limits[2]=15; > a[2].limits[2]=20", types},
      {"m : ARRAY[0..2, -1..1] OF INT; i, j : INT;",
       "FOR i := 0 TO 2 DO FOR j := -1 TO 1 DO m[i, j] := 10 * i + j; END_FOR; END_FOR;",
       "> m[2][-1]=19 m[0][1]=1 m[1][0]=10"},
      {"a : ARRAY[1..3] OF INT := [1, 2, 3]; i : INT := 1;", "a[a[i]] := a[a[2] + 1] * 10; i := a[1];",
       "> a[1]=30; > !array_index_30_is_outside_of_1_to_3"},
  });
}

TEST(MixedPrograms, StringsAtTheirLength) {
  check({
      {"s : STRING[5] := 'abc'; n : INT;", "s := CONCAT(s, 'def'); n := LEN(s);", "> s='abcde' n=5; > n=5"},
      {"s : STRING[5] := 'abcde'; t : STRING[3];", "t := s; s := INSERT(s, 'XY', 1);", "> t='abc' s='aXYbc'"},
      {"s : STRING[4] := 'abcd'; n, m : INT;",
       "n := LEN(CONCAT(s, s, s)); s := REPLACE(s, 'WXYZ', 1, 4); m := FIND(s, 'W');", "> n=12 s='abcW' m=4"},
      {"s : STRING[3] := 'abc'; a, b, c : STRING[3];",
       "a := LEFT(s, 9); b := RIGHT(s, 9); c := MID(s, 9, 2);", "> a='abc' b='abc' c='bc'"},
      {"b : BOOL; l : STRING[200]; s : STRING; n : INT; i : INT;",
       "l := ''; FOR i := 1 TO 20 DO l := CONCAT(l, '0123456789'); END_FOR; n := LEN(LEFT(SEL(b, l, l), "
       "150)); s := l; i := LEN(s);",
       "> n=150 i=80"},
      {"l : STRING[100]; n : INT;", "l := f('0123456789'); n := LEN(l);", "> n=20",
       "FUNCTION f : STRING[20] VAR_INPUT s : STRING[10]; END_VAR f := CONCAT(s, s, s); END_FUNCTION"},
      {"s : STRING[3] := 'abc'; b : BOOL;", "b := s = 'abcd'; IF s < 'abcd' THEN s := 'z'; END_IF;",
       "> b=FALSE s='z'"},
      {"s : STRING[2]; b : BOOL;", "s := 'ab'; b := change(s) = 'xy' AND s = 'xy';", "> b=TRUE s='xy'",
       "FUNCTION change : STRING VAR_IN_OUT s : STRING[2]; END_VAR s := 'xyz'; change := s; END_FUNCTION"},
      {"w : WSTRING[2]; s : STRING[2];", "w := STRING_TO_WSTRING('abc'); s := WSTRING_TO_STRING(\"xyz\");",
       "> w=\"ab\" s='xy'"},
      {"c : CHAR; s : STRING[6] := 'signal'; i, n : INT;",
       "FOR i := 1 TO LEN(s) DO c := STRING_TO_CHAR(MID(s, 1, i)); CASE c OF 'a', 'e', 'i', 'o', 'u': n := n "
       "+ 1; END_CASE; END_FOR;",
       "> n=2 c='l'"},
  });
}

TEST(MixedPrograms, NumbersBeyondTheirRange) {
  check({
      {"t : TIME := T#106751d; u : TIME; b : BOOL;", "u := t + T#2d; b := u < T#0s;",
       "> b=TRUE"},  // 2^63 ns are 106751.99 d
      {"t : TIME; n : DINT;", "t := DINT_TO_TIME(-1500); n := TIME_TO_DINT(t);", "> t=T#-1s500ms n=-1500"},
      {"a, b, c, d : INT;",
       "a := REAL_TO_INT(0.5); b := REAL_TO_INT(1.5); c := REAL_TO_INT(-2.5); d := REAL_TO_INT(2.51);",
       "> a=0 b=2 c=-2 d=3"},
      {"r : REAL := 32767.4; x : INT;", "x := REAL_TO_INT(r); r := r + 1.0;",
       "> x=32767; > !value_32768_is_outside_of_-32768_to_32767"},
      {"a : INT; b : DINT;", "a := TRUNC_INT(-2.9); b := TRUNC(-0.9);", "> a=-2 b=0"},
      {"s : SINT := 100; i : INT; d : DINT;", "i := s * 2; d := INT#30000 + INT#30000;", "> i=-56 d=-5536"},
      {"u : UINT := 40000; i : INT := -1; d : DINT; b : BOOL;", "d := u + i; b := i < u;",
       "> d=39999 b=TRUE"},
      {"a : UDINT := 4000000000; b : DINT := -1; b1 : BOOL; l : LINT;", "b1 := b < a; l := a + b;",
       "> b1=TRUE l=3999999999"},
      {"r : REAL; l : LREAL;", "r := 16777216.0; r := r + 1.0; l := 16777216.0; l := l + 1.0;",
       "> r=16777216.0 l=16777217.0"},
      {"i : INT := 7; r, q : REAL;", "r := i / 2; q := i / 2.0;", "> r=3.0 q=3.5"},
      {"a, b, c, d : INT;", "a := -7 / 2; b := -7 MOD 2; c := 7 MOD -2; d := -7 MOD -2;",
       "> a=-3 b=-1 c=1 d=-1"},
      {"w : WORD := 16#FFFF; i : INT; d : DINT; u : UDINT;",
       "i := WORD_TO_INT(w); d := WORD_TO_DINT(w); u := INT_TO_UDINT(i);", "> i=-1 d=65535 u=4294967295"},
      {"p : INT (0..15); w : WORD;", "p.3 := TRUE; w.0 := TRUE; p.4 := w.0;",
       "> !value_24_is_outside_of_0_to_15"},
  });
}

TEST(MixedPrograms, LoopsWithinLoops) {
  check({
      {"i, j, n : INT;",
       "FOR i := 1 TO 4 DO FOR j := 1 TO 4 DO IF j = i THEN CONTINUE; END_IF; IF j > 3 THEN EXIT; END_IF; n "
       ":= n + 10 * i + j; END_FOR; END_FOR;",
       // 12 13 21 23 31 32 41 42 43
       "> n=258 i=5 j=5"},
      {"i, n : INT;",
       "WHILE TRUE DO i := i + 1; IF i MOD 2 = 0 THEN CONTINUE; END_IF; REPEAT n := n + 1; IF n = 5 THEN "
       "EXIT; END_IF; UNTIL n MOD 3 = 0 END_REPEAT; IF i > 4 THEN EXIT; END_IF; END_WHILE;",
       "> i=5 n=6"},  // i 1: n 3; i 3: n 5; i 5: n 6
      {"i, n : INT;",
       "FOR i := 10 TO 1 BY -3 DO CASE i OF 4: CONTINUE; 1: EXIT; ELSE n := n + i; END_CASE; END_FOR;",
       "> n=17 i=1"},
      {"i, e, n : INT := 3;", "FOR i := 1 TO e DO e := 10; n := n + 1; END_FOR;", "> n=6 i=4 e=10"},
      {"i, n : INT;",
       "REPEAT i := i + 1; IF i < 3 THEN CONTINUE; END_IF; n := n + i; UNTIL i >= 5 END_REPEAT;", "> n=12"},
      {"i : INT; n : INT;", "n := first(3); i := first(99);", "> n=3 i=-1",
       "FUNCTION first : INT VAR_INPUT x : INT; END_VAR VAR i : INT; END_VAR first := -1; FOR i := 0 TO 10 "
       "DO IF i = x THEN first := i; RETURN; END_IF; END_FOR; END_FUNCTION"},
      {"i : ARRAY[0..1] OF INT; n : INT;",
       "FOR i[1] := 1 TO 3 DO FOR i[0] := i[1] TO 3 DO n := n + 1; END_FOR; END_FOR;", "> n=6 i[0]=4 i[1]=4"},
  });
}

TEST(MixedPrograms, RetainedValuesAndStates) {
  const char* const types =
      "TYPE State : (idle, run := 5, stop); Mode : INT (slow := -1, fast := 1) := fast; END_TYPE\n"
      "FUNCTION_BLOCK Keeper VAR RETAIN n : INT := 1; END_VAR VAR m : INT; END_VAR VAR_OUTPUT o : INT; "
      "END_VAR n := n * 2; m := m + 1; o := n; END_FUNCTION_BLOCK\n"
      "VAR_GLOBAL RETAIN total : INT := 3; END_VAR";
  check({
      {"k : Keeper;", "k(); total := total + k.o;",
       "> k.o=2 .total=5; > k.o=4 .total=9; cut > k.o=8 .total=17 k.m=1; cold > k.o=2 .total=5", types},
      {"s : State; n : INT;",
       "CASE s OF idle: s := run; State#run: s := stop; n := n + 1; stop: s := State#idle; END_CASE;",
       "> s=run; > s=stop n=1; > s=idle; > s=run n=1", types},
      {"m : Mode; s : State := stop; n : INT;",
       "CASE m OF slow: n := 1; Mode#fast: n := 2; END_CASE; IF s > run THEN n := n + 10; END_IF;",
       "> m=fast n=12; m=slow > n=11", types},
      {"s : State := run; t : TON;", "t(IN := s = run, PT := T#20ms); IF t.Q THEN s := stop; END_IF;",
       "> s=run; > s=run; > s=stop t.Q=TRUE; > t.Q=FALSE", types},
      {"a : ARRAY[0..2] OF State := [2(run), stop]; i, n : INT;",
       "FOR i := 0 TO 2 DO IF a[i] = run THEN n := n + 1; END_IF; END_FOR; a[0] := SEL(n > 2, a[2], idle);",
       "> n=2 a[0]=stop; > n=3 a[0]=idle", types},
      {"x : INT; y : DINT; z : LREAL; b : BOOL; w : WORD;", "x := 5; y := x; z := y; w := b; b := z = 5.0;",
       "> y=5 z=5.0 w=16#0000 b=TRUE; > w=16#0001"},
  });
}

}  // namespace
}  // namespace structured_text_mixed_programs_test
