// Overflow, shadowing, initial and retained values, statements, devices and the programs of everyday PLC work, scan by scan; values
// worked out by hand.

#include "programs.hpp"

namespace structured_text_language_programs_test {
namespace {

using programs::check;

TEST(LanguagePrograms, Overflow) {
  check({
      {"x : SINT := 126;", "x := x + 1;", "> x=127; > x=-128; > x=-127"},
      {"x : USINT := 1;", "x := x - 1;", "> x=0; > x=255"},
      {"x : INT := 16384;", "x := x * 2;", "> x=-32768; > x=0"},
      {"x : UINT := 65534;", "x := x + 1;", "> x=65535; > x=0"},
      {"x : DINT := 2147483646;", "x := x + 1;", "> x=2147483647; > x=-2147483648"},
      {"x : UDINT := 1;", "x := x - 2;", "> x=4294967295; > x=4294967293"},
      {"x : ULINT := 18446744073709551614;", "x := x + 1;", "> x=18446744073709551615; > x=0"},
      {"x : LINT := -9223372036854775807;", "x := x - 1;",
       "> x=-9223372036854775808; > x=9223372036854775807"},
      {"s : DINT; a : INT := 32767;", "s := s + a;", "> s=32767; > s=65534; > s=98301"},
      {"s : INT; a : INT := 20000;", "s := a + a - a;", "> s=20000"},
      {"s : DINT; a, b : INT := 20000;", "s := a + b;", "> s=-25536"},
      {"s : REAL; a, b : INT := 20000;", "s := a + b;", "> s=-25536.0"},
      {"x : INT := -32768;", "x := ABS(x);", "> x=-32768"},
      {"x : SINT := -128; y : SINT;", "y := -x;", "> y=-128"},
      {"x : BYTE := 16#80;", "x := SHL(x, 1);", "> x=16#00"},
      {"x : BYTE := 16#81;", "x := ROL(x, 1);", "> x=16#03; > x=16#06"},
      {"x : WORD := 16#8001;", "x := SHR(x, 1);", "> x=16#4000; > x=16#2000"},
      {"x : WORD := 1;", "x := SHL(x, 16);", "> x=16#0000"},
      {"n : INT; i : USINT;", "FOR i := 250 TO 255 DO n := n + 1; END_FOR;", "> n=6; > n=12"},
      {"n : INT; i : SINT;", "FOR i := -128 TO 127 DO n := n + 1; END_FOR;", "> n=256"},
      {"n : INT; i : USINT;", "FOR i := 3 TO 0 BY -1 DO n := n + 1; END_FOR;", "> n=4"},
      {"n : INT; i : INT;", "FOR i := 32760 TO 32767 BY 5 DO n := n + 1; END_FOR;", "> n=2"},
      {"x : INT (0..9) := 8;", "x := x + 1;", "> x=9; > !value_10_is_outside_of_0_to_9"},
      {"x : UINT (1..3) := 1;", "x := x - 1;", "> !value_0_is_outside_of_1_to_3"},
      {"x, n : INT := 2;", "n := n - 1; x := 10 / n;", "> x=10; > !division_by_zero"},
      {"x, n : INT := 2;", "n := n - 1; x := 10 MOD n;", "> x=0; > !division_by_zero"},
      {"x, r : REAL := 1.0;", "r := r - 1.0; x := 1.0 / r;", "> !division_by_zero"},
      {"a : ARRAY[1..3] OF INT; i : INT := 1;", "i := i + 1; a[i] := 5;",
       "> a[2]=5; > a[3]=5; > !array_index_4_is_outside_of_1_to_3"},
      {"a : ARRAY[-1..1] OF INT; i : INT := 1; x : INT;", "i := i - 1; x := a[i];",
       "> x=0; > x=0; > !array_index_-2_is_outside_of_-1_to_1"},
      {"r : REAL := 32766.6; x : INT;", "x := REAL_TO_INT(r); r := r + 1.0;",
       "> x=32767; > !value_32768_is_outside_of_-32768_to_32767"},
      {"x : UINT; d : DINT := 65535;", "x := DINT_TO_UINT(d); d := d + 1;", "> x=65535; > x=0"},
      {"x : SINT; i : INT := 127;", "x := INT_TO_SINT(i); i := i + 1;", "> x=127; > x=-128"},
      {"t : TIME := T#23h59m59s999ms;", "t := t + T#1ms;", "> t=T#1d"},
      {"w : WORD := 16#FFFF; d : DWORD;", "d := w; d := d OR 16#10000;", "> d=16#0001FFFF"},
      {"w : WORD; i : INT := -1;", "w := INT_TO_WORD(i); i := i - 1;", "> w=16#FFFF; > w=16#FFFE"},
      {"a : INT := -7; q, m : INT;", "q := a / 2; m := a MOD 2;", "> q=-3 m=-1"},
      {"a : INT := -32768; b : INT := -1; q, m : INT;", "q := a / b; m := a MOD b;", "> q=-32768 m=0"},
      {"x : REAL := 16777216.0;", "x := x + 1.0;", "> x=16777216.0"},
      {"x : LREAL := 16777216.0;", "x := x + 1.0;", "> x=16777217.0; > x=16777218.0"},
      {"x : BOOL; a : USINT := 200; b : SINT := -56;", "x := USINT_TO_SINT(a) = b;", "> x=TRUE"},
  });
}

TEST(LanguagePrograms, Shadowing) {
  check({
      {"x : INT := 1;", "x := x + 1;", "> x=2 .x=5; > x=3 .x=5", "VAR_GLOBAL x : INT := 5; END_VAR"},
      {"y : INT;", "y := x; x := x + 1;", "> y=5 .x=6; > y=6 .x=7", "VAR_GLOBAL x : INT := 5; END_VAR"},
      {"c : C;", "c(); x := x + 10;", "> c.x=1 .x=15; > c.x=2 .x=25",
       "VAR_GLOBAL x : INT := 5; END_VAR FUNCTION_BLOCK C VAR_OUTPUT x : INT; END_VAR x := x + 1; "
       "END_FUNCTION_BLOCK"},
      {"y : INT;", "y := f(3);", "> y=6 .a=100",
       "VAR_GLOBAL a : INT := 100; END_VAR FUNCTION f : INT VAR_INPUT a : INT; END_VAR f := 2 * a; a := 7; "
       "END_FUNCTION"},
      {"y : INT;", "y := f();", "> y=101 .a=100",
       "VAR_GLOBAL a : INT := 100; END_VAR FUNCTION f : INT VAR b : INT; END_VAR b := a + 1; f := b; "
       "END_FUNCTION"},
      {"D0 : INT;", "D0 := D0 + 5;", "> D0=5 #D0=0"},
      {"M1 : BOOL := TRUE; y : BOOL;", "y := M1; M2 := y;", "#M1=0 > y=TRUE #M2=1"},
      {"X : INT; y : INT;", "x := 3; Y := X;", "> X=3 y=3"},
      {"red : INT := 9; c : Color;", "c := Color#red; red := red + 1;", "> c=red red=10",
       "TYPE Color : (green, red); END_TYPE"},
      {"a : A; b : B;", "a := A#on; b := B#on;", "> a=on b=on",
       "TYPE A : (off, on); B : (on, fault); END_TYPE"},
      {"x : INT := 1; s : STRUCT x : INT; END_STRUCT;", "s.x := x + 1; x := 5;", "> s.x=2 x=5; > s.x=6"},
      {"i, n : INT := 7;", "FOR i := 1 TO 2 DO n := n + i; END_FOR;", "> n=10 i=3 .i=50",
       "VAR_GLOBAL i : INT := 50; END_VAR"},
      {"y : INT;", "y := x;", "> y=4 .x=4", "VAR_GLOBAL CONSTANT x : INT := 4; END_VAR"},
      {"y : INT;", "y := inner() + outer();", "> y=12",
       "FUNCTION inner : INT VAR n : INT := 1; END_VAR inner := n; END_FUNCTION "
       "FUNCTION outer : INT VAR n : INT := 10; END_VAR outer := n + inner(); END_FUNCTION"},
      {"b : B; y, z : INT;", "y := b.m(); z := b.k();", "> y=2 z=1",
       "FUNCTION_BLOCK B VAR n : INT := 1; END_VAR METHOD m : INT VAR n : INT := 2; END_VAR m := n; "
       "END_METHOD "
       "METHOD k : INT k := n; END_METHOD END_FUNCTION_BLOCK"},
      {"b : B; y : INT;", "y := b.m();", "> y=21",
       "VAR_GLOBAL n : INT := 1; END_VAR FUNCTION_BLOCK B VAR n : INT := 20; END_VAR METHOD m : INT n := n + "
       "1; m := n; "
       "END_METHOD END_FUNCTION_BLOCK"},
      {"max : INT := 3;", "max := max + 1;", "> max=4"},
      {"P : INT := 3;", "p := p + 1;", "> P=4"},
      {"t : INT := 3; T1 : TIME;", "t := t + 1; T1 := T#5ms;", "> t=4 T1=T#5ms"},
      {"Count : Count;", "Count(); Count();", "> Count.n=2",
       "FUNCTION_BLOCK Counter VAR_OUTPUT n : INT; END_VAR n := n + 1; END_FUNCTION_BLOCK TYPE x : INT; "
       "END_TYPE "
       "FUNCTION_BLOCK Count VAR_OUTPUT n : INT; END_VAR n := n + 1; END_FUNCTION_BLOCK"},
      {"", "g := g + 1;", "> .g=1; > .g=2",
       "VAR_GLOBAL g : INT; END_VAR PROGRAM Q VAR g : INT; END_VAR g := 50; END_PROGRAM"},
  });
}

TEST(LanguagePrograms, InitialValues) {
  check({
      {"x : INT := 3; y : INT;", "y := y + x;", "> y=3; > y=6; cold > y=3"},
      {"y : INT;", "y := f() + f();", "> y=12",
       "FUNCTION f : INT VAR n : INT := 5; END_VAR n := n + 1; f := n; END_FUNCTION"},
      {"b : B;", "b();", "> b.y=4; > b.y=4",
       "FUNCTION_BLOCK B VAR_TEMP t : INT := 3; END_VAR VAR_OUTPUT y : INT; END_VAR t := t + 1; y := t; "
       "END_FUNCTION_BLOCK"},
      {"b : B;", "b();", "> b.y=4; > b.y=5",
       "FUNCTION_BLOCK B VAR t : INT := 3; END_VAR VAR_OUTPUT y : INT; END_VAR t := t + 1; y := t; "
       "END_FUNCTION_BLOCK"},
      {"a : B := (step := 5); b : B;", "a(); b();", "> a.n=5 b.n=1; > a.n=10 b.n=2",
       "FUNCTION_BLOCK B VAR_INPUT step : INT := 1; END_VAR VAR_OUTPUT n : INT; END_VAR n := n + step; "
       "END_FUNCTION_BLOCK"},
      {"b : B; go : BOOL := TRUE;", "IF go THEN b(step := 5); ELSE b(); END_IF; go := FALSE;",
       "> b.n=5; > b.n=10",
       "FUNCTION_BLOCK B VAR_INPUT step : INT := 1; END_VAR VAR_OUTPUT n : INT; END_VAR n := n + step; "
       "END_FUNCTION_BLOCK"},
      {"y : INT; go : BOOL := TRUE;", "IF go THEN y := f(5); ELSE y := f(); END_IF; go := FALSE;",
       "> y=5; > y=1", "FUNCTION f : INT VAR_INPUT a : INT := 1; END_VAR f := a; END_FUNCTION"},
      {"p, q : Point := (y := 9);", "p.x := p.x + 1;", "> p.x=8 p.y=9 q.x=7; cold > p.x=8",
       "TYPE Point : STRUCT x : INT := 7; y : INT := 8; END_STRUCT END_TYPE"},
      {"a : ARRAY[1..4] OF INT := [1, 2]; s : INT; i : INT;",
       "s := 0; FOR i := 1 TO 4 DO s := s + a[i]; END_FOR;", "> s=3"},
      {"a : ARRAY[1..6] OF INT := [2(1), 2(3, 4)]; x : INT;",
       "x := a[1] + 10 * a[2] + 100 * a[3] + 1000 * a[6];", "> x=4311"},
      {"a : ARRAY[1..2] OF Point := [(x := 1), (x := 2, y := 3)]; s : INT;", "s := a[1].y + a[2].y;",
       "> s=11", "TYPE Point : STRUCT x : INT; y : INT := 8; END_STRUCT END_TYPE"},
      {"x : Speed; y : Speed := 5;", ";", "> x=7 y=5", "TYPE Speed : INT := 7; END_TYPE"},
      {"c : Color; d : Color := blue;", ";", "> c=green d=blue",
       "TYPE Color : (red, green, blue) := green; END_TYPE"},
      {"x : Level;", ";", "> x=10", "TYPE Level : INT (10..20); END_TYPE"},
      {"END_VAR VAR CONSTANT n : INT := 4; END_VAR VAR a : ARRAY[1..n] OF INT := [4(2)]; x : INT;",
       "x := a[n];", "> x=2"},
      {"x : INT := k * 2 + 1;", ";", "> x=21", "VAR_GLOBAL CONSTANT k : INT := 10; END_VAR"},
      {"s : STRING[3] := 'abcdef';", ";", "> s='abc'"},
      {"t : TIME := T#1s; u : TIME;", "u := t * 3;", "> u=T#3s"},
      {"w : WORD := 2#1010; b : BOOL;", "b := w.1; w.0 := b;", "> b=TRUE w=16#000B"},
      {"d : DATE := D#2023-12-31; e : DT := DT#2023-12-31-23:59:59;", "e := e + T#1s;",
       "> e=DT#2024-01-01-00:00:00 d=DATE#2023-12-31"},
  });
}

TEST(LanguagePrograms, PowerCuts) {
  check({
      {"n : INT; END_VAR VAR RETAIN r : INT;", "n := n + 1; r := r + 1;",
       "> n=1 r=1; > n=2 r=2; cut > n=1 r=3; cut > n=1 r=4"},
      {"n : INT; END_VAR VAR RETAIN r : INT := 10;", "r := r + 1;", "> r=11; cut > r=12; cold > r=11"},
      {"n : INT; END_VAR VAR RETAIN a : ARRAY[1..3] OF INT;", "n := n + 1; a[n] := n;",
       "; ; cut > a[1]=1 a[2]=2 a[3]=0"},
      {"n : INT; END_VAR VAR RETAIN s : STRING;", "n := n + 1; s := CONCAT(s, 'x');",
       "; > s='xx'; cut > s='xxx' n=1"},
      {"END_VAR VAR RETAIN p : STRUCT x, y : INT := 5; END_STRUCT;", "p.x := p.x + 1;",
       "> p.x=6; cut > p.x=7 p.y=5"},
      {"", "g := g + 1; h := h + 1;", "> .g=1 .h=1; cut > .g=2 .h=1",
       "VAR_GLOBAL RETAIN g : INT; END_VAR VAR_GLOBAL h : INT; END_VAR"},
      {"b : B;", "b();", "; > b.n=2 b.k=2; cut > b.n=3 b.k=1",
       "FUNCTION_BLOCK B VAR_OUTPUT RETAIN n : INT; END_VAR VAR_OUTPUT k : INT; END_VAR n := n + 1; k := k + "
       "1; END_FUNCTION_BLOCK"},
      {"END_VAR VAR RETAIN b : B;", "b();", "; > b.n=2; cut > b.n=3",
       "FUNCTION_BLOCK B VAR_OUTPUT n : INT; END_VAR n := n + 1; END_FUNCTION_BLOCK"},
      {"END_VAR VAR NON_RETAIN n : INT; END_VAR VAR PERSISTENT p : INT;", "n := n + 1; p := p + 1;",
       "; cut > n=1 p=2"},
      {"END_VAR VAR RETAIN state : (idle, running, done);",
       "IF state = idle THEN state := running; ELSE state := done; END_IF;",
       "> state=running; cut > state=done; cold > state=running"},
      {"END_VAR VAR RETAIN list : ARRAY[1..2] OF CTU;", "list[2](CU := TRUE, PV := 5); list[2](CU := FALSE);",
       "; cut > list[2].CV=2 list[1].CV=0"},
      {"list : ARRAY[1..2] OF B;", "list[1](); list[1]();", "> list[1].n=2; cut > list[1].n=4 list[2].n=0",
       "FUNCTION_BLOCK B VAR RETAIN END_VAR VAR_OUTPUT RETAIN n : INT; END_VAR n := n + 1; "
       "END_FUNCTION_BLOCK"},
      {"", "D5 := D5 + 1;", "> #D5=1; cut > #D5=2"},  // a device is the CPU's business
      {"END_VAR VAR RETAIN t : TIME := T#1s; l : LREAL := 0.5;", "t := t + T#1s; l := l * 2.0;",
       "> t=T#2s l=1.0; cut > t=T#3s l=2.0"},
      {"first : BOOL := TRUE; n : INT; END_VAR VAR RETAIN starts : INT;",
       "IF first THEN starts := starts + 1; first := FALSE; END_IF;",
       "> starts=1; > starts=1; cut > starts=2; > starts=2; cut > starts=3"},
  });
}

TEST(LanguagePrograms, Statements) {
  check({
      {"i, k, n : INT;", "n := 0; FOR i := 1 TO 3 DO FOR k := i TO 3 DO n := n + 1; END_FOR; END_FOR;",
       "> n=6 i=4 k=4; > n=6"},
      {"i, n : INT; lim : INT := 3;", "n := 0; FOR i := 1 TO lim DO lim := 10; n := n + 1; END_FOR;",
       "> n=3; > n=10"},
      {"i, n : INT; st : INT := 1;", "n := 0; FOR i := 1 TO 6 BY st DO st := 3; n := n + 1; END_FOR;",
       "> n=6; > n=2"},
      {"i, n : INT;", "FOR i := 3 TO 1 DO n := n + 1; END_FOR;", "> n=0 i=3"},
      {"i, n : INT;", "FOR i := 10 TO 1 BY -3 DO n := n + i; END_FOR;", "> n=22 i=-2"},
      {"i, n : INT;",
       "FOR i := 1 TO 10 DO IF i = 3 THEN CONTINUE; END_IF; IF i = 6 THEN EXIT; END_IF; n := n + i; END_FOR;",
       "> n=12 i=6"},
      {"x, n : INT := 20;",
       "n := 0; WHILE x > 1 DO IF x MOD 2 = 0 THEN x := x / 2; ELSE x := 3 * x + 1; END_IF; n := n + 1; "
       "END_WHILE;",
       "> n=7; > n=0"},
      {"n : INT;", "REPEAT n := n + 1; UNTIL TRUE END_REPEAT;", "> n=1; > n=2"},
      {"n : INT;", "n := n + 1; IF n > 2 THEN RETURN; END_IF; n := n + 10;", "> n=11; > n=12"},
      {"x, y : INT;",
       "x := x + 1; CASE x OF 1: y := 10; 2, 3: y := 20; 4..6: y := 30; ELSE y := 99; END_CASE;",
       "> y=10; > y=20; > y=20; > y=30; > y=30; > y=30; > y=99"},
      {"x : INT := -3; y : INT;", "x := x + 1; CASE x OF -2: y := 1; -1..0: y := 2; END_CASE;",
       "> y=1; > y=2; > y=2; > y=2"},
      {"c : (a, b, c1); n : INT;", "CASE c OF a: c := b; b: c := c1; c1: n := n + 1; c := a; END_CASE;",
       "> c=b; > c=c1; > c=a n=1"},
      {"x : INT;",
       "IF x = 0 THEN x := 1; ELSIF x = 1 THEN x := 2; ELSIF x = 2 THEN x := 3; ELSE x := 0; END_IF;",
       "> x=1; > x=2; > x=3; > x=0"},
      {"a : ARRAY[1..3] OF INT; i, x : INT;",
       "i := 1; a[i] := 5; i := 2; a[i] := a[i - 1] * 2; x := a[a[1] - 3];", "> x=10 a[2]=10"},
      {"a, b : ARRAY[1..2] OF INT;", "a[1] := a[1] + 1; b := a; a[2] := 7;",
       "> b[1]=1 b[2]=0; > b[1]=2 b[2]=7"},
      {"p, q : STRUCT x : INT; l : ARRAY[0..1] OF INT; END_STRUCT; n : INT;",
       "p.l[1] := p.l[1] + 2; n := p.l[1];", "> n=2; > n=4"},
      {"x : DINT; i : INT;", "x := 0; FOR i := 1 TO 100 DO x := x + i * i; END_FOR;", "> x=338350"},
      {"x, y : INT := 1;", "x := x + y; y := x - y;", "> x=2 y=1; > x=3 y=2; > x=5 y=3; > x=8 y=5"},
      {"a, b, q : BOOL;", "q := a XOR b;", "> q=FALSE; a=1 > q=TRUE; b=1 > q=FALSE; a=0 > q=TRUE"},
      {"a, b, c, q : BOOL;", "q := (a AND b) OR (b AND c) OR (a AND c);",
       "a=1 > q=FALSE; c=1 > q=TRUE; a=0 > q=FALSE; b=1 > q=TRUE"},
      {"x : INT; q : BOOL;", "q := NOT (x > 1 AND x < 4); x := x + 1;",
       "> q=TRUE; > q=TRUE; > q=FALSE; > q=FALSE; > q=TRUE"},
      {"n : INT;", "n := SEL(n > 2, n + 1, 0);", "> n=1; > n=2; > n=3; > n=0"},
      {"k : INT; x : INT;", "x := MUX(k, 10, 20, 30); k := k + 1;",
       "> x=10; > x=20; > x=30; > !value_3_is_outside_of_0_to_2"},
      {"x : INT := -3; y : INT;", "y := LIMIT(-1, x, 1); x := x + 2;", "> y=-1; > y=-1; > y=1; > y=1"},
      {"x : REAL;", "x := MAX(1.5, 2, 1.25) - MIN(3, 0.5);", "> x=1.5"},
      {"n : INT;", "WHILE TRUE DO n := n + 1; IF n MOD 5 = 0 THEN EXIT; END_IF; END_WHILE;", "> n=5; > n=10"},
      {"n : DINT;", "WHILE TRUE DO n := n + 1; END_WHILE;", "> !the_scan_takes_too_long:_a_loop_may_not_end"},
  });
}

TEST(LanguagePrograms, Strings) {
  check({
      {"s : STRING[5];", "s := CONCAT(s, 'ab');", "> s='ab'; > s='abab'; > s='ababa'; > s='ababa'"},
      {"s : STRING := 'ASTR'; a, b, c : STRING;", "a := LEFT(s, 3); b := RIGHT(s, 3); c := MID(s, 2, 2);",
       "> a='AST' b='STR' c='ST'"},
      {"a, b, c, d : STRING;",
       "a := INSERT('ABC', 'XY', 2); b := DELETE('ABXYC', 2, 3); c := REPLACE('ABCDE', 'X', 2, 3); d := "
       "CONCAT('AB', 'CD', 'E');",
       "> a='ABXYC' b='ABC' c='ABXE' d='ABCDE'"},
      {"n, m : INT;", "n := FIND('ABCBC', 'BC'); m := FIND('ABC', 'D');", "> n=2 m=0"},
      {"n : INT; s : STRING;", "n := n + 1; s := INT_TO_STRING(n * 111);", "> s='111'; > s='222'"},
      {"s : STRING := '41'; n : INT;", "n := STRING_TO_INT(s) + 1; s := INT_TO_STRING(n);", "> n=42; > n=43"},
      {"s : STRING := '12x'; n : INT := 5;", "n := STRING_TO_INT(s);",
       "> !the_text_is_no_value_of_the_type_that_it_is_converted_to"},
      {"s : STRING; i : INT;", "s := ''; FOR i := 1 TO 3 DO s := CONCAT(INT_TO_STRING(i), s); END_FOR;",
       "> s='321'"},
      {"a, b : STRING[3];", "a := 'abcd'; b := a;", "> a='abc' b='abc'"},
      {"s : STRING := 'level'; t : STRING; i : INT; q : BOOL;",
       "t := ''; FOR i := LEN(s) TO 1 BY -1 DO t := CONCAT(t, MID(s, 1, i)); END_FOR; q := s = t;",
       "> q=TRUE"},
      {"q : BOOL;", "q := 'Z' < 'a' AND 'a' < 'aa' AND NOT ('b' < 'aa');", "> q=TRUE"},
      {"w : WSTRING := \"x\"; n : INT;", "w := CONCAT(w, \"yz\"); n := LEN(w);", "> n=3; > n=5"},
  });
}

TEST(LanguagePrograms, Devices) {
  check({
      {"", "Y0 := X0 AND NOT X1;", "#X0=1 > #Y0=1; #X1=1 > #Y0=0; #X0=0 > #Y0=0"},
      {"", "Y10 := X10 OR Y10 AND NOT X11;",
       "#X10=1 > #Y10=1; #X10=0 > #Y10=1; #X11=1 > #Y10=0; #X11=0 > #Y10=0"},
      {"", "D0 := D0 + 1; D1 := D0 * 2;", "> #D0=1 #D1=2; > #D0=2 #D1=4"},
      {"", "D0 := D0 + 1;", "#D0=0x7FFF > #D0=32768"},
      {"n : DINT;", "D2:DINT := D2:DINT + 70000; n := D2:DINT;", "> #D2=4464 #D3=1; > n=140000"},
      {"", "K1M0 := K1M0 + 1;", "> #M0=1 #M1=0; > #M0=0 #M1=1; > #M0=1 #M1=1"},
      {"", "D0.0 := X0; D0.F := NOT X0;", "> #D0=32768; #X0=1 > #D0=1"},
      {"", "Z0 := 5; D0Z0 := 9; D10 := D1Z0 + D0Z0;", "> #D5=9 #D10=9"},
      {"", "Z0 := Z0 + 100; D0Z0 := 1;",
       "> #D100=1; > #D200=1; > !D0Z0:_the_CPU_or_the_module_has_no_such_device"},
      {"b AT M5 : BOOL; n AT D7 : UINT;", "b := NOT b; n := n - 1;", "> #M5=1 #D7=65535; > #M5=0 #D7=65534"},
      {"a AT D10 : ARRAY[0..2] OF INT; i : INT;", "a[i] := i + 1; i := i + 1;",
       "> #D10=1; > #D11=2; > #D12=3; > !array_index_3_is_outside_of_0_to_2"},
      {"r AT D20 : REAL;", "r := r + 0.5;",
       "> #D20=0 #D21=16128; > #D21=16256"},  // 0.5 is 16#3F00_0000, 1.0 16#3F80_0000
      {"", "MOV := D0; D1 := MOV;", "#D0=7 > #D1=7", "VAR_GLOBAL MOV : INT; END_VAR"},
  });
}

TEST(LanguagePrograms, EverydayWork) {
  check({
      // Start and stop with a latch; stop is stronger.
      {"start, stop, motor : BOOL;", "motor := (start OR motor) AND NOT stop;",
       "start=1 > motor=TRUE; start=0 > motor=TRUE; stop=1 start=1 > motor=FALSE; stop=0 > motor=TRUE"},
      // A push button that switches a lamp.
      {"b, lamp : BOOL; r : R_TRIG;", "r(CLK := b); lamp := lamp XOR r.Q;",
       "b=1 > lamp=TRUE; > lamp=TRUE; b=0; b=1 > lamp=FALSE"},
      // A debounced input: both edges after two scans of 10 ms.
      {"in, q : BOOL; a, b : TON;",
       "a(IN := in, PT := T#20ms); b(IN := NOT in, PT := T#20ms); IF a.Q THEN q := TRUE; ELSIF b.Q THEN q := "
       "FALSE; END_IF;",
       "in=1; in=0 > q=FALSE; in=1; ; > q=TRUE; in=0; in=1 > q=TRUE; in=0; ; > q=FALSE"},
      // A blinker of 20 ms ON and 20 ms OFF.
      {"a, b : TON; q : BOOL;", "a(IN := NOT b.Q, PT := T#20ms); b(IN := a.Q, PT := T#20ms); q := a.Q;",
       "> q=FALSE; > q=FALSE; > q=TRUE; > q=TRUE; > q=TRUE; > q=FALSE; > q=FALSE; > q=FALSE; > q=TRUE"},
      // Traffic lights: 2 scans red, 1 yellow, 2 green.
      {"s : (red, yellow, green); n : INT;",
       "n := n + 1; CASE s OF red: IF n = 2 THEN s := yellow; n := 0; END_IF; yellow: s := green; n := 0; "
       "green: IF n = 2 THEN s := red; n := 0; END_IF; END_CASE;",
       "> s=red; > s=yellow; > s=green; > s=green; > s=red; > s=red; > s=yellow"},
      // A FIFO of three.
      {"f : ARRAY[0..2] OF INT; n, x, i : INT; push, pop : BOOL;",
       "IF push AND n < 3 THEN f[n] := x; n := n + 1; END_IF; IF pop AND n > 0 THEN x := f[0]; FOR i := 1 TO "
       "2 DO f[i - 1] := f[i]; END_FOR; n := n - 1; END_IF;",
       "push=1 x=5; x=6; x=7 > n=3; x=8 > n=3 f[2]=7; push=0 pop=1 > x=5; > x=6; > x=7 n=0; > x=7"},
      // The mean of the last four.
      {"b : ARRAY[0..3] OF INT; i, x, mean : INT;",
       "b[i] := x; i := (i + 1) MOD 4; mean := (b[0] + b[1] + b[2] + b[3]) / 4;",
       "x=4 > mean=1; x=8 > mean=3; > mean=5; > mean=7; > mean=8"},
      {"a, b, t : INT;", "WHILE b <> 0 DO t := a MOD b; a := b; b := t; END_WHILE;",
       "a=48 b=36 > a=12; a=17 b=5 > a=1"},
      {"n, i, k : INT; prime : BOOL;",
       "n := 0; FOR i := 2 TO 30 DO prime := TRUE; FOR k := 2 TO i - 1 DO IF i MOD k = 0 THEN prime := "
       "FALSE; EXIT; END_IF; END_FOR; IF prime THEN n := n + 1; END_IF; END_FOR;",
       "> n=10"},
      {"b, g : BYTE; n : USINT;", "b := USINT_TO_BYTE(n); g := b XOR SHR(b, 1); n := n + 1;",
       "> g=16#00; > g=16#01; > g=16#03; > g=16#02; > g=16#06"},
      // CRC-8 with polynomial 07H of one byte 01H is 07H, of 80H 89H.
      {"crc, in : BYTE; i : INT;",
       "crc := in; FOR i := 1 TO 8 DO IF crc.7 THEN crc := SHL(crc, 1) XOR 16#07; ELSE crc := SHL(crc, 1); "
       "END_IF; END_FOR;",
       "in=16#01 > crc=16#07; in=16#80 > crc=16#89"},
      {"w, r : WORD; i : INT;", "r := 0; FOR i := 0 TO 15 DO r := SHL(r, 1) OR (SHR(w, i) AND 1); END_FOR;",
       "w=16#0001 > r=16#8000; w=16#1234 > r=16#2C48"},
      {"x : UINT; d : WORD;", "x := 1234; d := UINT_TO_BCD_WORD(x); x := BCD_TO_UINT(d) + 1;",
       "> d=16#1234 x=1235"},
      {"w : WORD; n, i : INT;",
       "n := 0; FOR i := 0 TO 15 DO IF (SHR(w, i) AND 1) = 1 THEN n := n + 1; END_IF; END_FOR;",
       "w=16#F0F1 > n=9"},
      // Hysteresis: ON from 80, OFF below 60.
      {"v : INT; q : BOOL;", "IF v >= 80 THEN q := TRUE; ELSIF v < 60 THEN q := FALSE; END_IF;",
       "v=79 > q=FALSE; v=80 > q=TRUE; v=60 > q=TRUE; v=59 > q=FALSE; v=79 > q=FALSE"},
      // A ramp of 10 a scan.
      {"v, t : INT;", "IF v < t THEN v := MIN(v + 10, t); ELSE v := MAX(v - 10, t); END_IF;",
       "t=25 > v=10; > v=20; > v=25; > v=25; t=-3 > v=15; > v=5; > v=-3"},
      // Two hands within 20 ms, else not.
      {"l, r, q : BOOL; t : TON;",
       "t(IN := l OR r, PT := T#20ms); IF NOT (l AND r) THEN q := FALSE; ELSIF NOT t.Q THEN q := TRUE; "
       "END_IF;",
       "l=1; r=1 > q=TRUE; > q=TRUE; l=0 > q=FALSE; r=0; l=1; ; r=1 > q=FALSE"},
      // 4 to 20 mA as 0 to 1000.
      {"raw : INT; v : REAL;", "v := INT_TO_REAL(LIMIT(4000, raw, 20000) - 4000) * 1000.0 / 16000.0;",
       "raw=12000 > v=500.0; raw=20000 > v=1000.0; raw=3000 > v=0.0"},
      {"a : ARRAY[1..5] OF INT := [5, 3, 9, 1, 7]; i, k, t : INT;",
       "FOR i := 1 TO 4 DO FOR k := 1 TO 5 - i DO IF a[k] > a[k + 1] THEN t := a[k]; a[k] := a[k + 1]; a[k + "
       "1] := t; END_IF; END_FOR; END_FOR;",
       "> a[1]=1 a[2]=3 a[3]=5 a[4]=7 a[5]=9"},
      {"shift : WORD := 1;", "shift := ROL(shift, 1);", "> shift=16#0002; > shift=16#0004"},
      // Running hours in seconds, kept over a power cut.
      {"on : BOOL; t : TON; END_VAR VAR RETAIN s : UDINT;",
       "t(IN := on AND NOT t.Q, PT := T#20ms); IF t.Q THEN s := s + 1; END_IF;",
       "on=1; ; > s=1; ; ; ; > s=2; cut > s=2; on=1; ; > s=3"},
      {"seed : UDINT := 1; x : UDINT;", "seed := seed * 1103515245 + 12345; x := seed / 65536 MOD 32768;",
       "> x=16838; > x=5758; > x=10113"},
      {"a, b, c : LREAL; d : LREAL;", "a := 3.0; b := 4.0; c := SQRT(a * a + b * b); d := EXPT(2.0, 10);",
       "> c=5.0 d=1024.0"},
      {"j : ULINT := 1; n : ULINT := 1;", "j := j * n; n := n + 1;", "> j=1; > j=2; > j=6; > j=24; > j=120"},
  });
}

}  // namespace
}  // namespace structured_text_language_programs_test
