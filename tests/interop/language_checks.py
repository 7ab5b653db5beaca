"""A check of the table of the language in docs/structured-text.md: each of its rows has a small program here that says what is there, and
lines that are refused because they are not."""
import re

from kit import ROOT, check, command, program, require, scratch

PAGE = ROOT / "docs" / "structured-text.md"
REALS = ("REAL", "LREAL")
NUMBERS = ("SINT", "INT", "DINT", "LINT", "USINT", "UINT", "UDINT", "ULINT", *REALS)
BITS = ("BOOL", "BYTE", "WORD", "DWORD", "LWORD")
LINE = '[[bus]]\nname = "line1"\nbit_rate = 250_000\n'


def one_of_each(from_types, to_types):
    """Conditions: 1 of each type is converted to 1 of each other one."""
    def one(kind):
        return f"{kind}#{1.0 if kind in REALS else 1}"
    return [f"{a}_TO_{b}({one(a)}) = {one(b)}" for a in from_types for b in to_types
            if a != b and {a, b} not in ({"REAL", "DWORD"}, {"LREAL", "LWORD"})]


# Row of the table: variables, statements, conditions that hold after the statements, units beside the PROGRAM.
THERE = {
    "1 characters": ("aB : INT;", "AB := 1; Ab := aB + 1;", ["ab = 2"]),
    "2 names": ("_first, second_2, End_Of_It : INT := 4;", ";", ["_FIRST = second_2"]),
    "3 comments": ("x : INT; (* a (* nested *) one *)", "/* a /* nested */ one */ x := 1; // to the end", ["x = 1"]),
    "4 pragmas": ("x : INT;", "{ info 'skipped' } x := 1;", ["x = 1"]),
    "5 numbers": ("r : LREAL := -1.34E-12;", ";",
                  ["1_000 = 1000", "2#1111_0000 = 240", "8#377 = 255", "16#fF = 255", "-12 = 0 - 12", "BOOL#1 = TRUE", "INT#-3 = -3", "UINT#16#9AF = 2479",
                   "REAL#1.5 = 1.5", "r < 0.0"]),
    "6 strings": ("s : STRING; w : WSTRING; c : CHAR; v : WCHAR;", "s := STRING#'OK'; w := WSTRING#\"OK\"; c := CHAR#'x'; v := \"x\";",
                  ["s = 'OK'", "w = \"OK\"", "c = 'x'", "v = WCHAR#\"x\""]),
    "7 `$` in strings": ("s : STRING := '$$$'$L$N$P$R$T$0A'; w : WSTRING := \"$\"$0041\";", ";", ["LEN(s) = 8", "w = \"$\"A\"", "'$L' = '$0A'"]),
    "8 durations": ("", ";",
                    ["T#1d2h3m4s5ms6us7ns = TIME#93784s5ms6us7ns", "T#-14.7s = t#-14s_700ms", "LT#1us = LTIME#1000ns"]),
    "9 dates": ("", ";", ["D#1984-06-25 = DATE#1984-06-25", "LD#1984-06-25 = LDATE#1984-06-25", "TOD#15:36:55.36 = TIME_OF_DAY#15:36:55.360",
                          "LTOD#15:36:55 = LTIME_OF_DAY#15:36:55", "DT#1984-06-25-15:36:55 = DATE_AND_TIME#1984-06-25-15:36:55",
                          "LDT#1984-06-25-15:36:55 = LDATE_AND_TIME#1984-06-25-15:36:55"]),
    "10 elementary types": ("a : BOOL; b : SINT; c : INT; d : DINT; e : LINT; f : USINT; g : UINT; h : UDINT; i : ULINT; j : REAL; k : LREAL; l : TIME; m : LTIME; "
                            "n : DATE; o : LDATE; p : TOD; q : LTOD; r : DT; s : LDT; t : STRING[10]; u : WSTRING[10]; v : CHAR; w : WCHAR; x : BYTE; y : WORD; "
                            "z : DWORD; aa : LWORD; ab : TIME_OF_DAY; ac : DATE_AND_TIME; ad : LTIME_OF_DAY; ae : LDATE_AND_TIME;",
                            ";", ["NOT a", "c = 0", "k = 0.0", "l = T#0s", "n = D#1970-01-01", "t = ''", "aa = 0"]),
    "11 types of the user": ("c : Color; l : Level; p : Pressure; a : List; s : Part; d : Deep; t : ARRAY[1..2] OF TON;", "c := Color#green; s.list[2] := 7;",
                             ["c = green", "l = Level#high", "p = 5", "a[1, 2] = 2", "a[2, 1] = 3", "s.x = 4", "s.list[2] = 7", "d = 9", "NOT t[1].Q"],
                             "TYPE Color : (red, green); Level : INT (low := 1, high := 9) := high; Pressure : INT (5..10); List : ARRAY[1..2, 1..2] OF INT := [2(2), 2(3)];\n"
                             "Part : STRUCT x : INT := 4; list : ARRAY[1..3] OF INT; END_STRUCT; Deep : INT := 4 + 5; END_TYPE"),
    "12 references": None,
    "13 variables": ("x, y : INT; a : ARRAY[0..3] OF REAL; c : Color; t : TON; u : STRUCT v : INT; END_STRUCT;", "x := g;", ["x = 3", "e = 3", "k = 4"],
                     "TYPE Color : (red, green); END_TYPE VAR_GLOBAL g : INT := 3; e : INT := 3; END_VAR VAR_GLOBAL CONSTANT k : INT := 4; END_VAR\n"
                     "FUNCTION_BLOCK B VAR_INPUT RETAIN i : INT; END_VAR VAR_OUTPUT RETAIN o : INT; END_VAR VAR_IN_OUT io : INT; END_VAR VAR_TEMP t : INT; END_VAR\n"
                     "VAR_EXTERNAL g : INT; END_VAR VAR_EXTERNAL CONSTANT k : INT; END_VAR VAR RETAIN r : INT; END_VAR VAR NON_RETAIN n : INT; END_VAR\n"
                     "VAR CONSTANT c : INT := 1; END_VAR t := k; o := t + g + c; END_FUNCTION_BLOCK"),
    "14 initial values": ("a : INT := 2 * 3; b : ARRAY[1..4] OF INT := [1, 3(2)]; s : STRUCT x, y : INT := 5; END_STRUCT := (y := 6); t : TON := (PT := T#5s);\n"
                          "r : STRING[5] := 'abc'; w : REAL := 1.5;", ";", ["a = 6", "b[4] = 2", "s.x = 5", "s.y = 6", "t.PT = T#5s", "r = 'abc'", "w = 1.5"]),
    "15 arrays of any length": None,
    "16 direct variables": ("v AT %MW0.10 : INT; w AT D20 : ARRAY[1..2] OF INT;", "%MW0.10 := 5; %QX1 := %IX0; %MX0.3 := TRUE; %MD0.12 := 70000; w[2] := 8;",
                            ["v = 5", "D10 = 5", "M3", "D12 = 4464", "D21 = 8"]),
    "17 parts of bit strings": ("w : WORD := 16#1234; d : DWORD; l : LWORD;", "w.%X0 := TRUE; w.1 := TRUE; d.%W1 := 16#ABCD; l.%D1 := 1; l.%B0 := 2;",
                                ["w.%B0 = 16#37", "d = 16#ABCD0000", "l = 16#0000000100000002"]),
    "18 EN and ENO": ("x : INT := 7; ok : BOOL := TRUE; t : TON; y : BOOL;", "x := ADD(EN := FALSE, IN1 := 1, IN2 := 2, ENO => ok); t(EN := TRUE, IN := TRUE, ENO => y);",
                      ["NOT ok", "x = 0", "y"]),
    "19 FUNCTION": ("x, n, o : INT;", "x := twice(a := 2, n := n, o => o); nothing(n);", ["x = 10", "n = 6", "o = 3"],
                    "VAR_GLOBAL g : INT := 1; END_VAR VAR_GLOBAL CONSTANT k : INT := 1; END_VAR\n"
                    "FUNCTION twice : INT VAR_INPUT a : INT; b : INT := 5; END_VAR VAR_IN_OUT n : INT; END_VAR VAR_OUTPUT o : INT; END_VAR VAR t : INT; END_VAR\n"
                    "VAR_TEMP u : INT; END_VAR VAR CONSTANT c : INT := 2; END_VAR VAR_EXTERNAL g : INT; END_VAR VAR_EXTERNAL CONSTANT k : INT; END_VAR\n"
                    "n := n + 1; t := b; u := c; o := a + g; twice := u * t * k; END_FUNCTION\n"
                    "FUNCTION nothing VAR_IN_OUT n : INT; END_VAR n := n + 5; END_FUNCTION"),
    "20 calls of functions": ("x, y : INT; b, no : BOOL;", "x := LIMIT(0, 15, 10); y := LIMIT(MX := 10, IN := 15, MN := 0); f(i := 1, o => b); f(i := 2, NOT o => no);",
                              ["x = 10", "y = 10", "b", "no"],
                              "FUNCTION f VAR_INPUT i : INT; END_VAR VAR_OUTPUT o : BOOL; END_VAR o := i = 1; END_FUNCTION"),
    "21 overloaded functions": ("a : DINT := 70000; b : REAL := 0.5;", ";", ["MAX(a, 1) = 70000", "MAX(b, 1) = 1.0", "TO_INT(b) = 0", "ADD_DINT(1, a) = 70001", "SHL_WORD(1, 2) = WORD#4"]),
    "22 conversions": ("i : INT := 300; w : WORD := 16#1234;", ";",
                       ["INT_TO_REAL(i) = 300.0", "TO_REAL(i) = 300.0", "TRUNC(2.7) = 2", "REAL_TRUNC_INT(-2.7) = -2", "TRUNC_INT(2.7) = 2", "WORD_BCD_TO_UINT(w) = 1234",
                        "BCD_TO_UINT(w) = 1234", "UINT_TO_BCD_WORD(1234) = w", "TO_BCD_WORD(UINT#1234) = w"]),
    "23 conversions of numbers": ("", ";", ["LREAL_TO_REAL(1.5) = 1.5", "REAL_TO_INT(2.5) = 2", "DINT_TO_SINT(200) = -56", "UINT_TO_INT(65535) = -1", *one_of_each(NUMBERS, NUMBERS)]),
    "24 conversions of bit strings": ("", ";", ["DWORD_TO_WORD(16#12345678) = 16#5678", "WORD_TO_BYTE(16#1234) = 16#34", "BYTE_TO_LWORD(16#FF) = 16#FF", *one_of_each(BITS, BITS)]),
    "25 conversions of bit strings and numbers": ("", ";", ["WORD_TO_INT(16#FFFF) = -1", "INT_TO_WORD(-1) = 16#FFFF", "DWORD_TO_REAL(16#3F800000) = 1.0",
                                                            "REAL_TO_DWORD(1.0) = 16#3F800000", "LREAL_TO_LWORD(2.0) = 16#4000000000000000", "LWORD_TO_LREAL(16#4000000000000000) = 2.0",
                                                            *one_of_each(NUMBERS, BITS), *one_of_each(BITS, NUMBERS)]),
    "26 conversions of dates": ("", ";",
                                ["DT_TO_DATE(DT#1998-05-29-12:00:00) = D#1998-05-29", "DT_TO_TOD(DT#1998-05-29-12:00:00) = TOD#12:00:00", "LTIME_TO_TIME(LT#5ms) = T#5ms",
                                 "LDT_TO_DT(LDT#1998-05-29-12:00:00) = DT#1998-05-29-12:00:00", "DT_TO_LDATE(DT#1998-05-29-12:00:00) = LD#1998-05-29",
                                 "TOD_TO_LTOD(TOD#12:00:00) = LTOD#12:00:00", "TIME_TO_LTIME(T#5ms) = LT#5ms", "LDT_TO_TOD(LDT#1998-05-29-12:00:00) = TOD#12:00:00",
                                 "LDT_TO_DATE(LDT#1998-05-29-12:00:00) = D#1998-05-29", "LDT_TO_LDATE(LDT#1998-05-29-12:00:00) = LD#1998-05-29",
                                 "LDT_TO_LTOD(LDT#1998-05-29-12:00:00) = LTOD#12:00:00", "DT_TO_LDT(DT#1998-05-29-12:00:00) = LDT#1998-05-29-12:00:00",
                                 "DT_TO_LTOD(DT#1998-05-29-12:00:00) = LTOD#12:00:00", "LTOD_TO_TOD(LTOD#12:00:00) = TOD#12:00:00"]),
    "27 conversions of characters": ("c : CHAR := CHAR#'x'; w : WCHAR;", "w := CHAR_TO_WCHAR(c);",
                                     ["STRING_TO_WSTRING('ab') = \"ab\"", "WSTRING_TO_STRING(\"ab\") = 'ab'", "CHAR_TO_STRING(c) = 'x'", "w = WCHAR#\"x\"", "WCHAR_TO_CHAR(w) = c",
                                      "WCHAR_TO_WSTRING(w) = \"x\"", "CHAR_TO_BYTE(c) = 16#78", "BYTE_TO_CHAR(16#78) = c", "WCHAR_TO_WORD(w) = 16#78", "WORD_TO_WCHAR(16#78) = w", "INT_TO_STRING(-12) = '-12'",
                                      "STRING_TO_INT('-12') = -12", "STRING_TO_CHAR('xyz') = c", "WSTRING_TO_WCHAR(\"xyz\") = w", "DATE_TO_STRING(D#2024-02-29) = 'DATE#2024-02-29'", "STRING_TO_TIME('T#1s') = T#1s"]),
    "28 functions of one number": ("", ";", ["ABS(-5) = 5", "SQRT(2.25) = 1.5", "LN(1.0) = 0.0", "LOG(1000.0) = 3.0", "EXP(0.0) = 1.0", "SIN(0.0) = 0.0", "COS(0.0) = 1.0",
                                             "TAN(0.0) = 0.0", "ASIN(0.0) = 0.0", "ACOS(1.0) = 0.0", "ATAN(0.0) = 0.0", "ATAN2(0.0, 1.0) = 0.0"]),
    "29 arithmetic": ("", ";", ["ADD(1, 2, 3) = 6", "MUL(2, 3, 4) = 24", "SUB(5, 3) = 2", "DIV(7, 2) = 3", "MOD(7, 4) = 3", "EXPT(2.0, 10) = 1024.0", "MOVE(8) = 8"]),
    "30 shifts": ("w : WORD := 16#8001;", ";", ["SHL(w, 1) = 2", "SHR(IN := w, N := 1) = 16#4000", "ROL(w, 1) = 3", "ROR(w, 1) = 16#C000"]),
    "31 bits": ("w : WORD := 6;", ";", ["AND(w, WORD#3, WORD#2) = 2", "OR(w, WORD#1) = 7", "XOR(w, WORD#3) = 5", "NOT(w) = 16#FFF9", "(w & 3) = 2"]),
    "32 selection": ("", ";", ["MOVE(5) = 5", "SEL(TRUE, 3, 4) = 4", "MAX(3, 9, 4) = 9", "MIN('b', 'a') = 'a'", "LIMIT(0, 15, 10) = 10", "MUX(2, 10, 20, 30) = 30"]),
    "33 comparison": ("", ";", ["GT(3, 2, 1)", "GE(2, 2)", "EQ('a', 'a')", "LE(1, 2, 2)", "LT(T#1s, T#2s)", "NE(3, 2)"]),
    "34 functions of strings": ("", ";", ["LEN('ASTRING') = 7", "LEFT('ASTR', 3) = 'AST'", "RIGHT('ASTR', 3) = 'STR'", "MID('ASTR', 2, 2) = 'ST'", "CONCAT('AB', 'CD', 'E') = 'ABCDE'",
                                          "INSERT('ABC', 'XY', 2) = 'ABXYC'", "DELETE('ABXYC', 2, 3) = 'ABC'", "REPLACE('ABCDE', 'X', 2, 3) = 'ABXE'", "FIND(\"ABCBC\", \"BC\") = 2"]),
    "35 arithmetic of times": ("d : DT := DT#2024-01-01-00:00:00;", ";",
                               ["ADD_TIME(T#1s, T#1s) = T#2s", "T#1s - T#2s = T#-1s", "ADD_LTIME(LT#1s, LT#1s) = LT#2s", "ADD_TOD_TIME(TOD#01:00:00, T#1h) = TOD#02:00:00",
                                "ADD_LTOD_LTIME(LTOD#01:00:00, LT#1h) = LTOD#02:00:00", "ADD_DT_TIME(d, T#1s) = DT#2024-01-01-00:00:01", "SUB_DATE_DATE(D#2024-01-02, D#2024-01-01) = T#1d",
                                "SUB_TOD_TIME(TOD#01:00:00, T#1h) = TOD#00:00:00", "SUB_TOD_TOD(TOD#01:00:00, TOD#00:00:00) = T#1h", "SUB_DT_TIME(d, T#1s) = DT#2023-12-31-23:59:59",
                                "SUB_DT_DT(d, d) = T#0s", "SUB_TIME(T#2s, T#1s) = T#1s", "MUL_TIME(T#2s, 1.5) = T#3s", "DIV_TIME(T#2s, 2) = T#1s", "MUL_LTIME(LT#2s, 2) = LT#4s",
                                "DIV_LTIME(LT#2s, 2) = LT#1s", "SUB_LTIME(LT#2s, LT#1s) = LT#1s", "SUB_LDATE_LDATE(LD#2024-01-02, LD#2024-01-01) = LT#1d",
                                "SUB_LTOD_LTIME(LTOD#01:00:00, LT#1h) = LTOD#00:00:00", "SUB_LTOD_LTOD(LTOD#01:00:00, LTOD#00:00:00) = LT#1h",
                                "ADD_LDT_LTIME(LDT#2024-01-01-00:00:00, LT#1s) = LDT#2024-01-01-00:00:01", "SUB_LDT_LTIME(LDT#2024-01-01-00:00:01, LT#1s) = LDT#2024-01-01-00:00:00",
                                "SUB_LDT_LDT(LDT#2024-01-01-00:00:01, LDT#2024-01-01-00:00:00) = LT#1s"]),
    "36 parts of dates": ("y, m, n : INT;", "SPLIT_DATE(D#2024-02-29, YEAR => y, MONTH => m); SPLIT_LDT(LDT#2024-02-29-01:02:03, MINUTE => n);",
                          ["y = 2024", "m = 2", "n = 2", "CONCAT_DATE_TOD(D#2024-02-29, TOD#01:02:03) = DT#2024-02-29-01:02:03", "CONCAT_DATE(2024, 2, 29) = D#2024-02-29",
                           "CONCAT_TOD(1, 2, 3, 4) = TOD#01:02:03.004", "CONCAT_DT(2024, 2, 29, 1, 2, 3, 0) = DT#2024-02-29-01:02:03", "DAY_OF_WEEK(D#2024-02-29) = 4",
                           "CONCAT_DATE_LTOD(D#2024-02-29, LTOD#01:02:03) = LDT#2024-02-29-01:02:03", "CONCAT_LTOD(1, 2, 3, 4) = LTOD#01:02:03.004",
                           "CONCAT_LDT(2024, 2, 29, 1, 2, 3, 0) = LDT#2024-02-29-01:02:03"]),
    "37 order of bytes": ("", ";", ["TO_BIG_ENDIAN(WORD#16#1234) = 16#3412", "FROM_BIG_ENDIAN(WORD#16#1234) = 16#3412", "TO_LITTLE_ENDIAN(WORD#16#1234) = 16#1234",
                                    "FROM_LITTLE_ENDIAN(WORD#16#1234) = 16#1234"]),
    "38 functions of enumerations": ("a : (red, green) := green; b : BOOL;", ";", ["SEL(b, a, red) = green", "MUX(0, a, red) = green", "EQ(a, green)", "NE(a, red)"]),
    "39 is it valid": ("", ";", ["IS_VALID(1.0)", "NOT IS_VALID_BCD(WORD#16#12A4)"]),
    "40 FUNCTION_BLOCK": ("b : B; n : INT;", "b(i := TRUE, io := n);", ["b.o = 2", "n = 1", "b.e"],
                          "VAR_GLOBAL g : INT := 1; END_VAR FUNCTION_BLOCK B VAR_INPUT i : BOOL R_EDGE; j : BOOL F_EDGE; k : INT := 1; END_VAR VAR_OUTPUT o : INT; e : BOOL; END_VAR\n"
                          "VAR_IN_OUT io : INT; END_VAR VAR x : INT; t : TON; END_VAR VAR_TEMP y : INT; END_VAR VAR_EXTERNAL g : INT; END_VAR\n"
                          "io := io + 1; o := k + g; e := i; END_FUNCTION_BLOCK"),
    "41 instances": ("a, b : TON; l : ARRAY[1..2] OF CTU := [(PV := 3), (PV := 4)]; c : CTU := (PV := 7);", ";", ["c.PV = 7", "l[2].PV = 4", "NOT a.Q"]),
    "42 calls of blocks": ("c : CTU; l : ARRAY[0..1] OF CTU; n : INT; q : BOOL := TRUE;", "c(CU := TRUE, PV := 1, CV => n, NOT Q => q); l[1](TRUE, FALSE, 5); c.R := FALSE;",
                           ["n = 1", "NOT q", "l[1].CV = 1", "c.Q"]),
    "43 bistables": ("a : SR; b : RS;", "a(S1 := TRUE, R := TRUE); b(S := TRUE, R1 := TRUE);", ["a.Q1", "NOT b.Q1"]),
    "44 edges": ("r : R_TRIG; f : F_TRIG;", "r(CLK := TRUE); f(CLK := TRUE); f(CLK := FALSE);", ["r.Q", "f.Q"]),
    "45 counters": ("a : CTU; b : CTD; c : CTUD; d : CTU_DINT; e : CTD_ULINT; f : CTUD_LINT; g : CTU_UDINT;", "a(CU := TRUE, PV := 1); b(LD := TRUE, PV := 3); c(CD := TRUE); d(CU := TRUE);",
                    ["a.Q", "b.CV = 3", "c.CV = -1", "d.CV = 1", "e.CV = 0", "f.CV = 0", "g.CV = 0"]),
    "46 timers": ("a : TP; b : TON; c : TOF; d : TP_TIME; e : TON_LTIME; f : TOF_LTIME;", "a(IN := TRUE, PT := T#1s); b(IN := TRUE, PT := T#1s); c(IN := TRUE, PT := T#1s);",
                  ["a.Q", "NOT b.Q", "c.Q", "d.ET = T#0s", "e.ET = LT#0s", "NOT f.Q"]),
    "47 PROGRAM": ("x : INT;", "x := 1;", ["x = 1"], "PROGRAM Q VAR_INPUT i : INT; END_VAR VAR_OUTPUT o : INT; END_VAR VAR_EXTERNAL g : INT; END_VAR o := i + g; END_PROGRAM VAR_GLOBAL g : INT; END_VAR"),
    "48 CLASS": None,
    "49 instances of classes": None,
    "50 calls of methods": ("b : B; n, o : INT;", "n := b.m(1, 2); o := b.m(y := 2, x := 1);", ["n = 3", "o = 3"],
                            "FUNCTION_BLOCK B METHOD PUBLIC m : INT VAR_INPUT x, y : INT; END_VAR m := THIS.own(x, y); END_METHOD\n"
                            "METHOD PRIVATE own : INT VAR_INPUT x, y : INT; END_VAR own := x + y; END_METHOD END_FUNCTION_BLOCK"),
    "51 INTERFACE": None,
    "52 assignment attempt": None,
    "53 methods of blocks": ("b : B;", "b(); b.add(2);", ["b.n = 3"],
                             "FUNCTION_BLOCK B VAR_OUTPUT n : INT; END_VAR METHOD add VAR_INPUT x : INT; END_VAR n := n + x; END_METHOD add(1); END_FUNCTION_BLOCK"),
    "54 to 61 sequential function chart": None,
    "62, 63 CONFIGURATION, TASK": None,
    "64 to 66 NAMESPACE": None,
    "71 operators": ("a : INT := 5; b, c : BOOL := TRUE;", ";",
                     ["(2 + 3) * 4 = 20", "ABS(-a) = 5", "NOT FALSE AND TRUE", "-a + 6 = 1", "+a = 5", "2.0 ** 3.0 ** 2.0 = 64.0", "2 + 3 * 4 = 14", "7 / 2 = 3", "17 MOD 5 * 2 = 4",
                      "10 - 4 - 3 = 3", "1 < 2 = TRUE", "3 > 2", "2 <= 2", "2 >= 2", "1 <> 2", "b & c", "b AND c", "b XOR FALSE", "TRUE OR FALSE AND FALSE", "TRUE XOR TRUE AND FALSE"]),
    "72 statements": ("x, i, n : INT; t : TON; q : BOOL;",
                      "t(IN := q); f(1); IF x = 0 THEN x := 1; ELSIF x = 1 THEN x := 2; ELSE x := 3; END_IF; CASE x OF 1, 5: x := 10; 2..4: x := 20; ELSE x := 30; END_CASE;\n"
                      "FOR i := 1 TO 10 BY 2 DO IF i = 3 THEN CONTINUE; END_IF; IF i = 7 THEN EXIT; END_IF; n := n + i; END_FOR; WHILE n < 20 DO n := n + 7; END_WHILE;\n"
                      "REPEAT n := n + 1; UNTIL n > 25 END_REPEAT; ;", ["x = 10", "i = 7", "n = 26"], "FUNCTION f VAR_INPUT a : INT; END_VAR RETURN; END_FUNCTION"),
}

def with_variables(statements, variables=""):
    return f"PROGRAM P VAR {variables} END_VAR {statements} END_PROGRAM"


# Row of the table: programs that are refused, because the row says that something is not here.
NOT_HERE = {
    "11 types of the user": ["TYPE t : STRUCT a : TON; END_STRUCT; END_TYPE", "TYPE t : TON; END_TYPE", "TYPE t : STRUCT OVERLAP a : INT; END_STRUCT; END_TYPE"],
    "12 references": ["TYPE t : REF_TO INT; END_TYPE", with_variables("a := REF(b);", "a, b : INT;"), with_variables("a := b^;", "a, b : INT;"),
                      with_variables("a := NULL;", "a : INT;")],
    "13 variables": ["FUNCTION_BLOCK b VAR_INPUT CONSTANT x : INT; END_VAR END_FUNCTION_BLOCK", "FUNCTION_BLOCK b VAR_IN_OUT CONSTANT x : INT; END_VAR END_FUNCTION_BLOCK",
                     "FUNCTION_BLOCK b VAR PUBLIC x : INT; END_VAR END_FUNCTION_BLOCK", "FUNCTION_BLOCK b VAR PRIVATE x : INT; END_VAR END_FUNCTION_BLOCK"],
    "15 arrays of any length": ["FUNCTION f VAR_IN_OUT a : ARRAY[*] OF INT; END_VAR END_FUNCTION", with_variables("x := UPPER_BOUND(a, 1);", "a : ARRAY[1..2] OF INT; x : DINT;"),
                                with_variables("x := LOWER_BOUND(a, 1);", "a : ARRAY[1..2] OF INT; x : DINT;")],
    "16 direct variables": [with_variables(";", f"a AT {place} : {kind};") for place, kind in
                            (("%IB0", "BYTE"), ("%IW0", "WORD"), ("%ML0.0", "LWORD"), ("%IX0.1", "BOOL"), ("%I*", "BOOL"))],
    "19 FUNCTION": ["FUNCTION f VAR_INPUT t : TON; END_VAR END_FUNCTION", "FUNCTION f VAR RETAIN x : INT; END_VAR END_FUNCTION", "FUNCTION f : INT f := f(); END_FUNCTION"],
    "27 conversions of characters": [with_variables("c := STRING_TO_WCHAR('a');", "c : WCHAR;")],
    "41 instances": ["FUNCTION_BLOCK b VAR_TEMP t : TON; END_VAR END_FUNCTION_BLOCK"],
    "47 PROGRAM": ["PROGRAM P VAR_IN_OUT x : INT; END_VAR END_PROGRAM", "PROGRAM P VAR_ACCESS END_VAR END_PROGRAM"],
    "48 CLASS": ["CLASS c END_CLASS", "CLASS ABSTRACT c END_CLASS"],
    "49 instances of classes": [with_variables(";", "c : C;") + " CLASS C END_CLASS"],
    "50 calls of methods": ["FUNCTION_BLOCK b METHOD m SUPER.m(); END_METHOD END_FUNCTION_BLOCK", "FUNCTION_BLOCK b METHOD OVERRIDE m END_METHOD END_FUNCTION_BLOCK"],
    "51 INTERFACE": ["INTERFACE i END_INTERFACE"],
    "52 assignment attempt": [with_variables("a ?= b;", "a, b : INT;")],
    "53 methods of blocks": ["FUNCTION_BLOCK a END_FUNCTION_BLOCK FUNCTION_BLOCK b EXTENDS a END_FUNCTION_BLOCK", "FUNCTION_BLOCK b IMPLEMENTS a END_FUNCTION_BLOCK",
                             "FUNCTION_BLOCK ABSTRACT b END_FUNCTION_BLOCK", "FUNCTION_BLOCK FINAL b END_FUNCTION_BLOCK",
                             "FUNCTION_BLOCK b PROPERTY p : INT END_PROPERTY END_FUNCTION_BLOCK"],
    "54 to 61 sequential function chart": ["PROGRAM P INITIAL_STEP s: END_STEP END_PROGRAM", "PROGRAM P STEP s: END_STEP END_PROGRAM",
                                           "PROGRAM P TRANSITION FROM a TO b := TRUE; END_TRANSITION END_PROGRAM", "PROGRAM P ACTION a: ; END_ACTION END_PROGRAM"],
    "62, 63 CONFIGURATION, TASK": ["CONFIGURATION c END_CONFIGURATION", "RESOURCE r ON c END_RESOURCE", "TASK t (PRIORITY := 1);", "VAR_CONFIG END_VAR"],
    "64 to 66 NAMESPACE": ["NAMESPACE n END_NAMESPACE", "USING n; PROGRAM P END_PROGRAM"],
    "67 to 70 instruction list": ["PROGRAM P VAR x : INT; END_VAR\nLD x\nADD 1\nST x\nEND_PROGRAM"],
    "71 operators": [with_variables("a := b^;", "a, b : INT;")],
    "72 statements": [with_variables("GOTO a;")],
    "73 to 76 ladder, function block diagram": ["LADDER_DIAGRAM END_LADDER_DIAGRAM"],
}


def table():
    """Row of the table of the language -> (what is there, what is not)."""
    part = PAGE.read_text().split("\n## The language\n")[1].split("\n## ")[0]
    rows = [[cell.strip() for cell in line.strip("|").split(" |")] for line in part.splitlines() if line.startswith("| ")]
    return {row[0]: row[1:] for row in rows[1:]}


def plant_of(sources):
    """A plant with a PLC for each of these programs, so that each is compiled alone; 10 ms are one scan."""
    text = LINE
    for number, source in enumerate(sources):
        (scratch / f"row{number}.st").write_text(source + "\n")
        text += f'[[plc]]\nname = "row{number}"\nlisten = "127.0.0.1:{number + 1024}"\nprogram = ["row{number}.st"]\nscan = "20ms"\n'
    plant = scratch / "plant.toml"
    plant.write_text(text)
    return plant


@check
def table_of_the_language_has_the_rows_that_are_tried_and_names_tests():
    rows = table()
    tried = THERE.keys() | NOT_HERE.keys()
    require(rows.keys() == tried, f"only in the table or only in the check: {sorted(rows.keys() ^ tried)}")
    tests = "\n".join(path.read_text() for path in (ROOT / "tests" / "structured_text").glob("*_test.cpp"))
    for row, (there, missing) in rows.items():
        require(bool(there) == (THERE.get(row) is not None), f"{row}: what is there has a program, and only that")
        require(bool(missing) == (row in NOT_HERE), f"{row}: what is not here has a program that is refused, and only that")
        for name in re.findall(r"(?<!\*)\*(\w+)\*(?!\*)", there):
            require(re.search(rf"^TEST\((?:{name},|\w+, {name}(?:_\w+)?\))", tests, re.M), f"{row}: no test is called {name}")


@check
def what_the_table_of_the_language_says_is_so():
    """One scan of each row's program, which divides by zero where a condition is not as expected."""
    rows, sources = [], []
    for row, example in THERE.items():
        if example is not None:
            variables, statements, conditions, *units = example
            tests = "\n".join(f"IF NOT ({condition}) THEN zero := 1 / zero; END_IF; // {row}" for condition in conditions)
            rows.append(row)
            sources.append(f"{''.join(units)}\nPROGRAM P VAR zero : INT; {variables} END_VAR {statements}\n{tests}\nEND_PROGRAM")
    plant = plant_of(sources)
    done = command(program, "run", "--virtual", "--for", "10ms", plant)
    wrong = [f"{rows[int(plc)]}: {sources[int(plc)].splitlines()[int(line) - 1]}" for plc, line in re.findall(r"row(\d+)\.st:(\d+):", done.stdout + done.stderr)]
    require(not wrong, "\n".join(wrong))


@check
def what_the_table_of_the_language_does_not_have_is_refused():
    sources = [(row, source) for row, refused in NOT_HERE.items() for source in refused]
    done = command(program, "check", plant_of(source for _, source in sources), expect=2)
    refused = set(re.findall(r"/row(\d+)\.st:\d+:\d+: ", done.stdout + done.stderr))
    taken = [f"{row}: {source}" for number, (row, source) in enumerate(sources) if str(number) not in refused]
    require(not taken, "\n".join(["not refused:", *taken]))
