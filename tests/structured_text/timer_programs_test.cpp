// Timers, edges, bistables and counters at the borders of scans, worked out by hand from the standard's diagrams
// [IEC 61131-3 6.6.3.5].

#include "programs.hpp"

namespace structured_text_timer_programs_test {
namespace {

using programs::check;

TEST(TimerPrograms, Ton) {
  const char* const plain = "t(IN := in, PT := T#30ms);";
  check({
      {"in : BOOL; t : TON;", "t(IN := in, PT := T#25ms);",
       "in=1 > t.Q=FALSE t.ET=T#0s; > t.ET=T#10ms; > t.ET=T#20ms t.Q=FALSE; > t.Q=TRUE t.ET=T#25ms; > "
       "t.Q=TRUE "
       "t.ET=T#25ms"},
      {"in : BOOL; t : TON;", plain, "in=1; ; > t.Q=FALSE t.ET=T#20ms; > t.Q=TRUE t.ET=T#30ms"},
      {"in : BOOL; t : TON;", "t(IN := in, PT := T#0s);", "in=1 > t.Q=TRUE t.ET=T#0s; in=0 > t.Q=FALSE"},
      {"in : BOOL; t : TON;", "t(IN := in, PT := T#-5ms);", "in=1 > t.Q=TRUE t.ET=T#0s"},
      {"in : BOOL; t : TON;", plain,
       "in=1; ; in=0 > t.ET=T#0s; in=1 > t.ET=T#0s; ; > t.ET=T#20ms t.Q=FALSE; > t.Q=TRUE"},
      {"in : BOOL; t : TON;", plain,
       "in=1; @7ms > t.ET=T#7ms; @29999us > t.Q=FALSE t.ET=T#29ms999us; @30000us > t.Q=TRUE t.ET=T#30ms"},
      {"in : BOOL; t : TON;", plain, "in=1; @10000ms > t.Q=TRUE t.ET=T#30ms; in=0 > t.Q=FALSE t.ET=T#0s"},
      {"in, c : BOOL; t : TON;", "IF c THEN t(IN := in, PT := T#30ms); END_IF;",
       "in=1 c=1; c=0 > t.ET=T#0s; > t.ET=T#0s; > t.Q=FALSE; c=1 > t.ET=T#30ms t.Q=TRUE"},
      {"in, c : BOOL; t : TON;", "IF c THEN t(IN := in, PT := T#30ms); END_IF;",
       "in=1 c=1; c=0; in=0; in=1; c=1 > t.Q=TRUE"},
      {"in : BOOL; t : TON;", "t(IN := in, PT := T#20ms); t(IN := in);", "in=1; > t.Q=FALSE; > t.Q=TRUE"},
      {"t : TON;", "t(IN := FALSE); t(IN := TRUE, PT := T#10ms);",
       "> t.Q=FALSE; > t.Q=FALSE; > t.Q=FALSE t.ET=T#0s"},
      {"t : TON; n : INT;", "t(IN := NOT t.Q, PT := T#20ms); IF t.Q THEN n := n + 1; END_IF;",
       "> n=0; > n=0; > n=1; > n=1; > n=1; > n=1; > n=2"},
      {"in : BOOL; pt : TIME := T#20ms; t : TON;", "t(IN := in, PT := pt);",
       "in=1; pt=T#50ms; ; ; > t.Q=FALSE t.ET=T#40ms; > t.Q=TRUE"},
      {"in : BOOL; pt : TIME := T#50ms; t : TON;", "t(IN := in, PT := pt);",
       "in=1; ; pt=T#20ms > t.Q=TRUE t.ET=T#20ms"},
      {"in : BOOL; t : TON_LTIME;", "t(IN := in, PT := LT#1500ns);",
       "in=1; @1us > t.Q=FALSE t.ET=LT#1us; @2us > t.Q=TRUE t.ET=LT#1us500ns"},
      {"in : BOOL; a, b : TON;", "a(IN := in, PT := T#20ms); b(IN := a.Q, PT := T#20ms);",
       "in=1; ; > a.Q=TRUE b.Q=FALSE; > b.ET=T#10ms; > b.Q=TRUE"},
      {"in : BOOL; a, b : TON;", "b(IN := a.Q, PT := T#20ms); a(IN := in, PT := T#20ms);",
       "in=1; ; > a.Q=TRUE; > b.ET=T#0s; > b.ET=T#10ms; > b.Q=TRUE"},
      {"in : BOOL; t : ARRAY[1..2] OF TON;", "t[2](IN := in, PT := T#10ms);",
       "in=1; > t[2].Q=TRUE t[1].Q=FALSE"},
      {"in : BOOL; t : TON; x : INT;", "t(IN := in, PT := T#1s); x := TIME_TO_INT(t.ET);",
       "in=1 > x=0; > x=10; > x=20"},
      {"in, q : BOOL; t : TON;", "t(IN := in, PT := T#10ms, NOT Q => q);",
       "in=1 > q=TRUE; > q=FALSE; in=0 > q=TRUE"},
      {"in : BOOL; t : TON := (PT := T#20ms);", "t(IN := in);", "in=1; > t.Q=FALSE; > t.Q=TRUE"},
      {"in : BOOL; t : TON;", plain, "in=1; ; ; cut in=1 > t.Q=FALSE t.ET=T#0s; ; ; > t.Q=TRUE"},
      {"in : BOOL; END_VAR VAR RETAIN t : TON;", plain, "in=1; ; cut in=1 > t.ET=T#20ms; > t.Q=TRUE"},
      {"in : BOOL; END_VAR VAR RETAIN t : TON;", plain, "in=1; ; ; > t.Q=TRUE; cut > t.Q=FALSE t.ET=T#0s"},
      {"in : BOOL; t : TON;", "t(PT := T#20ms, IN := in); t.PT := T#40ms;",
       "in=1; > t.Q=FALSE; > t.Q=TRUE t.ET=T#20ms t.PT=T#40ms"},
  });
}

TEST(TimerPrograms, Tof) {
  check({
      {"in : BOOL; t : TOF;", "t(IN := in, PT := T#25ms);",
       "in=1 > t.Q=TRUE t.ET=T#0s; in=0 > t.Q=TRUE t.ET=T#0s; > t.ET=T#10ms; > t.Q=TRUE t.ET=T#20ms; > "
       "t.Q=FALSE "
       "t.ET=T#25ms; > t.Q=FALSE t.ET=T#25ms; in=1 > t.Q=TRUE t.ET=T#0s"},
      {"in : BOOL; t : TOF;", "t(IN := in, PT := T#20ms);",
       "in=1; in=0; > t.Q=TRUE; in=1 > t.ET=T#0s; in=0; > t.ET=T#10ms t.Q=TRUE; > t.Q=FALSE"},
      {"in : BOOL; t : TOF;", "t(IN := in, PT := T#0s);", "in=1 > t.Q=TRUE; in=0 > t.Q=FALSE"},
      {"in : BOOL; t : TOF;", "t(IN := in, PT := T#20ms);",
       "> t.Q=FALSE t.ET=T#0s; > t.Q=FALSE; > t.Q=FALSE"},
      {"in : BOOL; t : TOF;", "t(IN := in, PT := T#20ms);",
       "in=1; @1ms in=0; @20999us > t.Q=TRUE; @21ms > t.Q=FALSE"},
      {"in : BOOL; t : TOF;", "t(IN := in, PT := T#20ms);",
       "in=1; @1ms in=0; @1000ms > t.Q=FALSE t.ET=T#20ms"},
      {"in : BOOL; t : TOF;", "t(IN := in, PT := T#20ms);",
       "in=1; > t.Q=TRUE; > t.Q=TRUE; > t.Q=TRUE t.ET=T#0s"},
      {"in : BOOL; t : TOF_LTIME;", "t(IN := in, PT := LT#10us);",
       "in=1; @5us in=0; @14us > t.Q=TRUE; @15us > t.Q=FALSE"},
      {"in : BOOL; t : TOF;", "t(IN := in, PT := T#20ms);", "in=1; in=0; cut > t.Q=FALSE t.ET=T#0s"},
      {"in : BOOL; END_VAR VAR RETAIN t : TOF;", "t(IN := in, PT := T#20ms);",
       "in=1; in=0; cut > t.Q=TRUE t.ET=T#10ms; > t.Q=FALSE"},
      {"in : BOOL; a : TON; b : TOF;", "a(IN := in, PT := T#10ms); b(IN := a.Q, PT := T#10ms);",
       "in=1 > b.Q=FALSE; > b.Q=TRUE; in=0 > b.Q=TRUE; > b.Q=FALSE"},
  });
}

TEST(TimerPrograms, Tp) {
  check({
      {"in : BOOL; t : TP;", "t(IN := in, PT := T#20ms);",
       "in=1 > t.Q=TRUE t.ET=T#0s; > t.Q=TRUE t.ET=T#10ms; > t.Q=FALSE t.ET=T#20ms; > t.ET=T#20ms; in=0 > "
       "t.ET=T#0s"},
      {"in : BOOL; t : TP;", "t(IN := in, PT := T#20ms);",
       "in=1; in=0 > t.Q=TRUE t.ET=T#10ms; > t.Q=FALSE t.ET=T#0s"},
      {"in : BOOL; t : TP;", "t(IN := in, PT := T#20ms);",
       "in=1; in=0; in=1 > t.Q=FALSE; > t.Q=FALSE; in=0; in=1 > t.Q=TRUE"},
      {"in : BOOL; t : TP;", "t(IN := in, PT := T#0s);", "in=1 > t.Q=FALSE; > t.Q=FALSE"},
      {"t : TP;", "t(IN := NOT t.Q, PT := T#10ms);", "> t.Q=TRUE; > t.Q=FALSE; > t.Q=TRUE; > t.Q=FALSE"},
      {"in : BOOL; t : TP;", "t(IN := in, PT := T#20ms);", "in=1; @19999us > t.Q=TRUE; @20ms > t.Q=FALSE"},
      {"in : BOOL; t : TP;", "t(IN := in, PT := T#20ms);", "in=1; @5000ms > t.Q=FALSE t.ET=T#20ms"},
      {"in : BOOL; t : TP; n : INT;", "t(IN := in, PT := T#50ms); IF t.Q THEN n := n + 1; END_IF;",
       "in=1; in=0; in=1; in=0; in=1; in=0 > n=5; > n=5"},
      {"in : BOOL; t : TP;", "t(IN := in, PT := T#30ms);", "in=1; cut in=1 > t.Q=TRUE t.ET=T#0s"},
      {"in : BOOL; END_VAR VAR RETAIN t : TP;", "t(IN := in, PT := T#30ms);",
       "in=1; cut in=1 > t.Q=TRUE t.ET=T#10ms"},
  });
}

TEST(TimerPrograms, Edges) {
  check({
      {"in : BOOL; r : R_TRIG;", "r(CLK := in);",
       "> r.Q=FALSE; in=1 > r.Q=TRUE; > r.Q=FALSE; in=0 > r.Q=FALSE; in=1 > r.Q=TRUE"},
      {"in : BOOL; r : R_TRIG;", "r(CLK := in);", "in=1 > r.Q=TRUE; > r.Q=FALSE"},
      {"in : BOOL; f : F_TRIG;", "f(CLK := in);",
       "in=1 > f.Q=FALSE; in=0 > f.Q=TRUE; > f.Q=FALSE; in=1 > f.Q=FALSE"},
      {"in : BOOL; f : F_TRIG;", "f(CLK := in);", "> f.Q=TRUE; > f.Q=FALSE"},
      {"in : BOOL; r : R_TRIG; n : INT;",
       "r(CLK := in); n := n + BOOL_TO_INT(r.Q); r(CLK := in); n := n + BOOL_TO_INT(r.Q);",
       "in=1 > n=1; > n=1; in=0; in=1 > n=2"},
      {"in, c : BOOL; r : R_TRIG;", "IF c THEN r(CLK := in); END_IF;",
       "c=1; c=0 in=1; in=0; c=1 > r.Q=FALSE"},
      {"in, c : BOOL; r : R_TRIG;", "IF c THEN r(CLK := in); END_IF;",
       "c=1 in=1 > r.Q=TRUE; c=0 in=0 > r.Q=TRUE; in=1 c=1 > r.Q=FALSE"},
      {"in : BOOL; r : R_TRIG;", "r(CLK := in);", "in=1; cut in=1 > r.Q=TRUE"},
      {"in : BOOL; END_VAR VAR RETAIN r : R_TRIG;", "r(CLK := in);",
       "in=1; cut in=1 > r.Q=FALSE; cut in=0; in=1 > r.Q=TRUE"},
      {"in, old, q : BOOL;", "q := in AND NOT old; old := in;",
       "in=1 > q=TRUE; > q=FALSE; in=0 > q=FALSE; in=1 > q=TRUE"},
      {"in, t : BOOL; r : R_TRIG;", "r(CLK := in); IF r.Q THEN t := NOT t; END_IF;",
       "in=1 > t=TRUE; > t=TRUE; in=0 > t=TRUE; in=1 > t=FALSE; in=0; in=1 > t=TRUE"},
      {"in : BOOL; r : R_TRIG; f : F_TRIG; n : INT;",
       "r(CLK := in); f(CLK := in); IF r.Q OR f.Q THEN n := n + 1; END_IF;",
       "in=1 > n=1; in=0 > n=2; in=1 > n=3; > n=3"},
      {"in : BOOL; e : E;", "e(b := in);", "in=1 > e.n=1; > e.n=1; in=0 > e.n=1; in=1 > e.n=2",
       "FUNCTION_BLOCK E VAR_INPUT b : BOOL R_EDGE; END_VAR VAR_OUTPUT n : INT; END_VAR IF b THEN n := n + "
       "1; END_IF; "
       "END_FUNCTION_BLOCK"},
      {"in : BOOL; e : E;", "e(b := in);", "in=1 > e.n=0; in=0 > e.n=1; > e.n=1; in=1 > e.n=1; in=0 > e.n=2",
       "FUNCTION_BLOCK E VAR_INPUT b : BOOL F_EDGE; END_VAR VAR_OUTPUT n : INT; first : BOOL; END_VAR\n"
       "IF b AND first THEN n := n + 1; END_IF; first := TRUE; END_FUNCTION_BLOCK"},
      {"r : R_TRIG; n : INT;", "r(CLK := X1); IF r.Q THEN n := n + 1; END_IF;",
       "#X1=1 > n=1; > n=1; #X1=0; #X1=1 > n=2"},
  });
}

TEST(TimerPrograms, Bistables) {
  check({
      {"s, r : BOOL; b : SR;", "b(S1 := s, R := r);",
       "> b.Q1=FALSE; s=1 > b.Q1=TRUE; s=0 > b.Q1=TRUE; r=1 > b.Q1=FALSE; s=1 > b.Q1=TRUE; s=0 > b.Q1=FALSE; "
       "r=0 > b.Q1=FALSE"},
      {"s, r : BOOL; b : RS;", "b(S := s, R1 := r);",
       "> b.Q1=FALSE; s=1 > b.Q1=TRUE; s=0 > b.Q1=TRUE; r=1 > b.Q1=FALSE; s=1 > b.Q1=FALSE; r=0 > b.Q1=TRUE; "
       "s=0 > b.Q1=TRUE"},
      {"s, r, q : BOOL;", "q := s OR (q AND NOT r);",
       "s=1 > q=TRUE; s=0 > q=TRUE; r=1 > q=FALSE; r=0 > q=FALSE"},
      {"s, r : BOOL; END_VAR VAR RETAIN b : SR;", "b(S1 := s, R := r);",
       "s=1; cut > b.Q1=TRUE; r=1 > b.Q1=FALSE; cut > b.Q1=FALSE"},
      {"s, r : BOOL; b : SR;", "b(S1 := s, R := r);", "s=1 > b.Q1=TRUE; cut > b.Q1=FALSE"},
      {"a, b : SR; x : BOOL;", "a(S1 := x, R := b.Q1); b(S1 := a.Q1, R := FALSE);",
       "x=1 > a.Q1=TRUE b.Q1=TRUE; x=0 > a.Q1=FALSE b.Q1=TRUE"},
  });
}

TEST(TimerPrograms, Counters) {
  check({
      {"in, r : BOOL; c : CTU;", "c(CU := in, R := r, PV := 2);",
       "in=1 > c.CV=1 c.Q=FALSE; > c.CV=1; in=0; in=1 > c.CV=2 c.Q=TRUE; in=0; in=1 > c.CV=3 c.Q=TRUE; in=0 "
       "r=1 > c.CV=0 c.Q=FALSE"},
      {"in, r : BOOL; c : CTU;", "c(CU := in, R := r, PV := 2);",
       "r=1 in=1 > c.CV=0; r=0 > c.CV=0; in=0; in=1 > c.CV=1"},
      {"in : BOOL; c : CTU;", "c(CU := in, PV := 0);", "> c.Q=TRUE c.CV=0"},
      {"in : BOOL; c : CTU;", "c(CU := in, PV := -1);", "> c.Q=TRUE; in=1 > c.CV=1"},
      {"in : BOOL; pv : INT := 1; c : CTU;", "c(CU := in, PV := pv);",
       "in=1 > c.Q=TRUE; pv=5 > c.Q=FALSE c.CV=1"},
      {"in : BOOL; c : CTU_USINT_LIKE;", "c(CU := in);", "in=1 > c.n=255; in=0; in=1 > c.n=0",
       "FUNCTION_BLOCK CTU_USINT_LIKE VAR_INPUT CU : BOOL R_EDGE; END_VAR VAR_OUTPUT n : USINT := 254; "
       "END_VAR\n"
       "IF CU THEN n := n + 1; END_IF; END_FUNCTION_BLOCK"},
      {"in, ld : BOOL; c : CTD;", "c(CD := in, LD := ld, PV := 2);",
       "> c.Q=TRUE c.CV=0; ld=1 > c.CV=2 c.Q=FALSE; ld=0 in=1 > c.CV=1; in=0; in=1 > c.CV=0 c.Q=TRUE; in=0; "
       "in=1 > c.CV=-1 c.Q=TRUE"},
      {"in, ld : BOOL; c : CTD;", "c(CD := in, LD := ld, PV := 2);",
       "ld=1 in=1 > c.CV=2; ld=0 > c.CV=2; in=0; in=1 > c.CV=1"},
      {"u, d, r, l : BOOL; c : CTUD;", "c(CU := u, CD := d, R := r, LD := l, PV := 3);",
       "> c.QD=TRUE c.QU=FALSE; u=1 > c.CV=1 c.QD=FALSE; d=1 u=1 > c.CV=0; u=0 d=0; u=1 d=1 > c.CV=0; l=1 > "
       "c.CV=3 c.QU=TRUE; r=1 > c.CV=0"},
      {"u, d : BOOL; c : CTUD;", "c(CU := u, CD := d, PV := 1);",
       "d=1 > c.CV=-1 c.QD=TRUE; u=1 > c.CV=0; d=0 u=0; u=1 > c.CV=1 c.QU=TRUE"},
      {"in : BOOL; c : CTU_DINT; i : DINT;",
       "FOR i := 1 TO 40000 DO c(CU := FALSE); c(CU := TRUE, PV := 40000); END_FOR;",
       "> c.CV=40000 c.Q=TRUE"},
      {"c : CTU_UDINT; i : INT;",
       "FOR i := 1 TO 3 DO c(CU := TRUE, PV := 4294967295); c(CU := FALSE); END_FOR;",
       "> c.CV=3 c.Q=FALSE; > c.CV=6"},
      {"in : BOOL; END_VAR VAR RETAIN c : CTU;", "c(CU := in, PV := 9);",
       "in=1 > c.CV=1; cut in=1 > c.CV=1; cut in=0; in=1 > c.CV=2"},
      {"in : BOOL; c : CTU;", "c(CU := in, PV := 9);", "in=1 > c.CV=1; cut in=1 > c.CV=1"},
      {"c : CTU; t : TON;", "t(IN := NOT t.Q, PT := T#10ms); c(CU := t.Q, PV := 2);",
       "> c.CV=0; > c.CV=1; > c.CV=1; > c.CV=1; > c.CV=2 c.Q=TRUE"},
  });
}

}  // namespace
}  // namespace structured_text_timer_programs_test
