// Small programs: declarations, statements, and the value that a variable has after one scan, worked out by hand.

#include <gtest/gtest.h>

#include "compiled.hpp"

namespace structured_text_values_test {
namespace {

struct Example {
  const char* variables;
  const char* statements;
  const char* variable;
  const char* expected;
};

void check(std::initializer_list<Example> examples) {
  for (const Example& example : examples) {
    SCOPED_TRACE(std::string(example.variables) + " | " + example.statements);
    compiled::Plc plc(std::string("PROGRAM P\nVAR ") + example.variables + " END_VAR\n" + example.statements +
                      "\nEND_PROGRAM\n");
    EXPECT_EQ(plc.run(), "");
    EXPECT_EQ(plc.read(std::string("P.") + example.variable), example.expected);
  }
}

TEST(StructuredText, Literals_HaveTheValuesOfTheStandardsExamples) {
  check({
      {"x : INT;", "x := -12;", "x", "-12"},
      {"x : DINT;", "x := 123_456;", "x", "123456"},
      {"x : INT;", "x := +986;", "x", "986"},
      {"x : BYTE;", "x := 2#1111_1111;", "x", "16#FF"},
      {"x : UINT;", "x := 8#377;", "x", "255"},
      {"x : UINT;", "x := 16#FF;", "x", "255"},
      {"x : UINT;", "x := 16#ff;", "x", "255"},
      {"x : REAL;", "x := -12.0;", "x", "-12.0"},
      {"x : REAL;", "x := 0.4560;", "x", "0.456"},
      {"x : LREAL;", "x := 3.14159_26;", "x", "3.1415926"},
      {"x : LREAL;", "x := -1.34E-12;", "x", "-1.34e-12"},
      {"x : LREAL;", "x := 1.0e+6;", "x", "1e+06"},
      {"x : BOOL;", "x := 1;", "x", "TRUE"},
      {"x : DINT;", "x := DINT#5;", "x", "5"},
      {"x : UINT;", "x := UINT#16#9AF;", "x", "2479"},
      {"x : BOOL;", "x := BOOL#0;", "x", "FALSE"},
      {"x : BOOL := TRUE;", "x := BOOL#FALSE;", "x", "FALSE"},
      {"x : INT;", "x := 16#FFFF;", "x", "-1"},
      {"x : INT;", "x := INT#16#FFFE;", "x", "-2"},
      {"x : LINT;", "x := -9223372036854775808;", "x", "-9223372036854775808"},
      {"x : ULINT;", "x := 18446744073709551615;", "x", "18446744073709551615"},
      {"x : TIME;", "x := T#14ms;", "x", "T#14ms"},
      {"x : TIME;", "x := T#-14ms;", "x", "T#-14ms"},
      {"x : TIME;", "x := T#14.7s;", "x", "T#14s700ms"},
      {"x : TIME;", "x := t#25h_15m;", "x", "T#1d1h15m"},
      {"x : TIME;", "x := TIME#5d14h12m18s3.5ms;", "x", "T#5d14h12m18s3ms500us"},
      {"x : LTIME;", "x := LTIME#5m_30s_500ms_100.1us;", "x", "LT#5m30s500ms100us100ns"},
      {"x : LTIME;", "x := lt#-1us;", "x", "LT#-1us"},
      {"x : DATE;", "x := D#1984-06-25;", "x", "DATE#1984-06-25"},
      {"x : DATE;", "x := date#1984-06-25;", "x", "DATE#1984-06-25"},
      {"x : TOD;", "x := TOD#15:36:55.36;", "x", "TOD#15:36:55.36"},
      {"x : TIME_OF_DAY;", "x := TIME_OF_DAY#15:36:55;", "x", "TOD#15:36:55"},
      {"x : DT;", "x := DT#1984-06-25-15:36:55.360227400;", "x", "DT#1984-06-25-15:36:55.3602274"},
      {"x : STRING;", "x := 'A';", "x", "'A'"},
      {"x : STRING;", "x := '';", "x", "''"},
      {"x : STRING;", "x := '$'';", "x", "'$''"},
      {"x : STRING;", "x := '$$1.00';", "x", "'$$1.00'"},
      {"x : STRING;", "x := '$44$6F';", "x", "'Do'"},
      {"x : STRING;", "x := 'a$Lb';", "x", "'a$0Ab'"},
      {"x : WSTRING;", "x := \"A$\"\";", "x", "\"A$\"\""},
      {"x : WSTRING;", "x := \"$0041\";", "x", "\"A\""},
      {"x : CHAR;", "x := CHAR#'a';", "x", "'a'"},
  });
}

TEST(StructuredText, Characters_AreLiteralsOfOneCharacterAndFirstOnesOfStrings) {
  check({
      {"x : CHAR;", "x := 'a';", "x", "'a'"},
      {"x : CHAR := 'b';", ";", "x", "'b'"},
      {"x : CHAR;", "x := '$41';", "x", "'A'"},
      {"x : CHAR;", "x := CHAR#'$41';", "x", "'A'"},
      {"x : CHAR;", "x := ' ';", "x", "' '"},
      {"c : WCHAR; x : WORD;", "c := \"$20AC\"; x := WCHAR_TO_WORD(c);", "x", "16#20AC"},
      {"c : WCHAR; x : WORD;", "c := WCHAR#\"\u20AC\"; x := WCHAR_TO_WORD(c);", "x", "16#20AC"},
      {"a : ARRAY[1..2] OF CHAR := ['p', 'q']; x : CHAR;", "x := a[2];", "x", "'q'"},
      {"c : CHAR := CHAR#'m'; x : BOOL;", "x := c = 'm' AND 'n' > c AND c <> 'M';", "x", "TRUE"},
      {"x : CHAR;", "x := STRING_TO_CHAR('pqr');", "x", "'p'"},
      {"s : STRING := '1'; x : CHAR;", "x := STRING_TO_CHAR(s);", "x", "'1'"},
      {"s : STRING; x : BYTE;", "x := CHAR_TO_BYTE(STRING_TO_CHAR(s));", "x", "16#00"},
      {"s : STRING := ' z'; x : CHAR;", "x := TO_CHAR(s);", "x", "' '"},
      {"x : WORD;", "x := WCHAR_TO_WORD(WSTRING_TO_WCHAR(\"$20ACx\"));", "x", "16#20AC"},
      {"x : CHAR;", "x := STRING_TO_CHAR(MID('canopus', 1, 3));", "x", "'n'"},
      {"x : STRING;", "x := CONCAT(CHAR_TO_STRING('a'), 'b');", "x", "'ab'"},
  });
}

TEST(StructuredText, InitialValues_AreThoseOfTheStandardOrOfTheDeclaration) {
  check({
      {"x : BOOL;", ";", "x", "FALSE"},
      {"x : INT;", ";", "x", "0"},
      {"x : REAL;", ";", "x", "0.0"},
      {"x : TIME;", ";", "x", "T#0s"},
      {"x : DATE;", ";", "x", "DATE#1970-01-01"},
      {"x : STRING;", ";", "x", "''"},
      {"x : INT := 5;", ";", "x", "5"},
      {"a, b : INT := 7;", ";", "b", "7"},
      {"x : INT := 2 + 3 * 4;", ";", "x", "14"},
      {"x : REAL := 1;", ";", "x", "1.0"},
      {"x : LREAL := 1 / 4;", ";", "x", "0.0"},
      {"x : ARRAY[1..3] OF INT := [1, 2];", ";", "x", "[1, 2, 0]"},
      {"x : ARRAY[0..4] OF INT := [2(7), 3(1)];", ";", "x", "[7, 7, 1, 1, 1]"},
      {"x : ARRAY[0..3] OF INT := 1, 2;", ";", "x", "[1, 2, 0, 0]"},
      {"x : ARRAY[0..4] OF INT := 2(7), 1, 2(0);", ";", "x", "[7, 7, 1, 0, 0]"},
      {"x : ARRAY[1..2, 1..3] OF INT := [1, 2, 3, 4, 5, 6];", ";", "x", "[[1, 2, 3], [4, 5, 6]]"},
      {"x : ARRAY[1..2] OF ARRAY[1..2] OF INT := [[1, 2], [3, 4]];", ";", "x", "[[1, 2], [3, 4]]"},
      {"x : (red, green, blue);", ";", "x", "red"},
      {"x : (red, green, blue) := green;", ";", "x", "green"},
      {"x : INT (5..10);", ";", "x", "5"},
      {"x : STRING[10] := 'hello';", ";", "x", "'hello'"},
      {"t : TON := (PT := T#5s);", ";", "t.PT", "T#5s"},
  });
}

TEST(StructuredText, Operators_BindAsInTheStandardsTable) {
  check({
      {"x : INT;", "x := 2 + 3 * 4;", "x", "14"},
      {"x : INT;", "x := (2 + 3) * 4;", "x", "20"},
      {"x : INT;", "x := 10 - 4 - 3;", "x", "3"},
      {"x : INT;", "x := 17 MOD 5 * 2;", "x", "4"},
      {"x : INT; y : INT := 5;", "x := -y + 2;", "x", "-3"},
      {"x : LREAL;", "x := 2.0 ** 3.0 ** 2.0;", "x", "64.0"},
      {"x : LREAL; y : LREAL := 2.0;", "x := -y ** 2;", "x", "4.0"},
      {"x : BOOL;", "x := TRUE OR FALSE AND FALSE;", "x", "TRUE"},
      {"x : BOOL;", "x := TRUE XOR TRUE AND FALSE;", "x", "TRUE"},
      {"x : BOOL;", "x := NOT FALSE AND FALSE;", "x", "FALSE"},
      {"x : BOOL;", "x := 1 + 1 = 2 AND 3 > 2;", "x", "TRUE"},
      {"x : BOOL;", "x := 1 < 2 = TRUE;", "x", "TRUE"},
      {"x : BOOL;", "x := TRUE & FALSE;", "x", "FALSE"},
      {"x : WORD;", "x := 16#F0F0 AND 16#FF00 OR 16#000F;", "x", "16#F00F"},
      {"x : WORD;", "x := NOT 16#00FF;", "x", "16#FF00"},
      {"x : BYTE := 16#0F;", "x := NOT x;", "x", "16#F0"},
      {"x : LWORD;", "x := NOT x;", "x", "16#FFFFFFFFFFFFFFFF"},
  });
}

TEST(StructuredText, Division_GoesTowardsZeroAndModHasTheSignOfTheDividend) {
  check({
      {"x : INT; y : INT := 7;", "x := y / 2;", "x", "3"},
      {"x : INT; y : INT := -7;", "x := y / 2;", "x", "-3"},
      {"x : INT; y : INT := -7;", "x := y MOD 2;", "x", "-1"},
      {"x : INT; y : INT := 7;", "x := y MOD -2;", "x", "1"},
      {"x : UINT; y : UINT := 65535;", "x := y / 2;", "x", "32767"},
      {"x : REAL; y : REAL := 7.0;", "x := y / 2;", "x", "3.5"},
      {"x : ULINT; y : ULINT := 18446744073709551615;", "x := y / 10;", "x", "1844674407370955161"},
  });
}

// Beyond its range a result keeps its lowest bits, as in a MELSEC CPU.
TEST(StructuredText, Overflow_WrapsAroundInTheTypeOfTheOperands) {
  check({
      {"x : SINT := 127;", "x := x + 1;", "x", "-128"},
      {"x : INT := 32767;", "x := x + 1;", "x", "-32768"},
      {"x : INT := -32768;", "x := x - 1;", "x", "32767"},
      {"x : INT := -32768;", "x := -x;", "x", "-32768"},
      {"x : INT := -32768; y : INT := -1;", "x := x / y;", "x", "-32768"},
      {"x : INT := 300;", "x := x * x;", "x", "24464"},
      {"x : DINT; a : INT := 300;", "x := a * a;", "x", "24464"},
      {"x : DINT; a : INT := 300;", "x := INT_TO_DINT(a) * a;", "x", "90000"},
      {"x : DINT := 2147483647;", "x := x + 1;", "x", "-2147483648"},
      {"x : LINT := 9223372036854775807;", "x := x + 1;", "x", "-9223372036854775808"},
      {"x : LINT := -9223372036854775808; y : LINT := -1;", "x := x / y;", "x", "-9223372036854775808"},
      {"x : LINT := -9223372036854775808; y : LINT := -1;", "x := x MOD y;", "x", "0"},
      {"x : USINT := 255;", "x := x + 1;", "x", "0"},
      {"x : UINT := 0;", "x := x - 1;", "x", "65535"},
      {"x : UDINT := 4294967295;", "x := x + 1;", "x", "0"},
      {"x : ULINT := 0;", "x := x - 1;", "x", "18446744073709551615"},
      {"x : UINT := 65535; y : BOOL;", "y := x + 1 = 0;", "y", "TRUE"},
  });
}

TEST(StructuredText, Comparisons_GoByTheTypesOfBothSides) {
  check({
      {"x : BOOL; a : INT := -1;", "x := a < 1;", "x", "TRUE"},
      {"x : BOOL; a : UINT := 65535;", "x := a > 1;", "x", "TRUE"},
      {"x : BOOL; a : ULINT := 18446744073709551615;", "x := a > 1;", "x", "TRUE"},
      {"x : BOOL; a : LINT := -1;", "x := a >= -1;", "x", "TRUE"},
      {"x : BOOL; a : REAL := 0.5;", "x := a <> 0.5;", "x", "FALSE"},
      {"x : BOOL; a : LREAL := 0.1; b : LREAL := 0.2;", "x := a <= b;", "x", "TRUE"},
      {"x : BOOL; a : STRING := 'abc';", "x := a < 'abd';", "x", "TRUE"},
      {"x : BOOL; a : STRING := 'abc';", "x := a = 'abc';", "x", "TRUE"},
      {"x : BOOL; a : STRING := 'ab';", "x := a < 'abc';", "x", "TRUE"},
      {"x : BOOL; a : WSTRING := \"b\";", "x := a > \"a\";", "x", "TRUE"},
      {"x : BOOL; a : TIME := T#1s;", "x := a >= T#1000ms;", "x", "TRUE"},
      {"x : BOOL; a : DATE := D#2024-02-29;", "x := a > D#2024-02-28;", "x", "TRUE"},
      {"x : BOOL; a : (red, green);", "x := a = red;", "x", "TRUE"},
      {"x : BOOL; a : UINT := 40000; b : INT := -1;", "x := a > b;", "x", "TRUE"},
      {"x : BOOL; a : BOOL := TRUE;", "x := a > FALSE;", "x", "TRUE"},
  });
}

TEST(StructuredText, MixedTypes_WidenWithoutLoss) {
  check({
      {"x : DINT; a : INT := -5;", "x := a;", "x", "-5"},
      {"x : LINT; a : UDINT := 4294967295;", "x := a;", "x", "4294967295"},
      {"x : DINT; a : UINT := 65535;", "x := a;", "x", "65535"},
      {"x : REAL; a : INT := -3;", "x := a;", "x", "-3.0"},
      {"x : LREAL; a : DINT := 100000;", "x := a / 3.0;", "x", "33333.333333333336"},
      {"x : LREAL; a : REAL := 0.5;", "x := a;", "x", "0.5"},
      {"x : WORD; a : BYTE := 16#AB;", "x := a;", "x", "16#00AB"},
      {"x : WORD; a : BOOL := TRUE;", "x := a;", "x", "16#0001"},
      {"x : INT; a : SINT := -1; b : USINT := 200;", "x := a + b;", "x", "199"},
      {"x : DINT; a : INT := -1; b : UINT := 40000;", "x := a + b;", "x", "39999"},
      {"x : DINT; a : INT := 1;", "x := a + 100000;", "x", "100001"},
      {"x : LTIME; a : TIME := T#1s;", "x := a;", "x", "LT#1s"},
  });
}

TEST(StructuredText, If_TakesTheFirstBranchWhoseConditionIsTrue) {
  check({
      {"x : INT; a : INT := 1;", "IF a = 1 THEN x := 10; ELSIF a = 2 THEN x := 20; ELSE x := 30; END_IF;",
       "x", "10"},
      {"x : INT; a : INT := 2;", "IF a = 1 THEN x := 10; ELSIF a = 2 THEN x := 20; ELSE x := 30; END_IF;",
       "x", "20"},
      {"x : INT; a : INT := 3;", "IF a = 1 THEN x := 10; ELSIF a = 2 THEN x := 20; ELSE x := 30; END_IF;",
       "x", "30"},
      {"x : INT; a : BOOL;", "IF NOT a THEN x := 1; END_IF;", "x", "1"},
      {"x : INT; a, b : BOOL := TRUE;", "IF a AND b THEN x := 1; END_IF;", "x", "1"},
      {"x : INT; a : BOOL := TRUE; b : BOOL;", "IF a AND b THEN x := 1; END_IF;", "x", "0"},
      {"x : INT; a : REAL := 2.5;", "IF a > 2.0 THEN x := 1; END_IF;", "x", "1"},
      {"x : INT; a : INT := 5;", "IF a >= 5 AND a <= 5 THEN x := 1; END_IF;", "x", "1"},
      {"x : INT; a : INT := 5;", "IF a > 5 OR a < 5 THEN x := 1; END_IF;", "x", "0"},
  });
}

TEST(StructuredText, Case_TakesValuesRangesAndLists) {
  const char* const text =
      "CASE a OF 1, 5: x := 1; 2..4: x := 2; y := 1; 10: ; -1: x := 9; ELSE x := 3; END_CASE;";
  check({
      {"x, y : INT; a : INT := 1;", text, "x", "1"},
      {"x, y : INT; a : INT := 5;", text, "x", "1"},
      {"x, y : INT; a : INT := 2;", text, "x", "2"},
      {"x, y : INT; a : INT := 4;", text, "y", "1"},
      {"x, y : INT; a : INT := 10;", text, "x", "0"},
      {"x, y : INT; a : INT := -1;", text, "x", "9"},
      {"x, y : INT; a : INT := 7;", text, "x", "3"},
      {"x : INT; a : (red, green, blue) := green;", "CASE a OF red: x := 1; green: x := 2; END_CASE;", "x",
       "2"},
      {"x : INT; a : BYTE := 16#12;", "CASE a OF 16#10..16#1F: x := 1; END_CASE;", "x", "1"},
      {"x : INT; a : INT := 3;", "CASE a OF 1: x := 1; END_CASE; x := x + 5;", "x", "5"},
      {"x : INT; a : INT := 1;", "CASE a OF 1: CASE x OF 0: x := 4; END_CASE; 2: x := 5; END_CASE;", "x",
       "4"},
  });
}

TEST(StructuredText, Loops_CountAsWritten) {
  check({
      {"x, i : INT;", "FOR i := 1 TO 10 DO x := x + i; END_FOR;", "x", "55"},
      {"x, i : INT;", "FOR i := 1 TO 10 DO x := x + i; END_FOR;", "i", "11"},
      {"x, i : INT;", "FOR i := 10 TO 1 BY -3 DO x := x + i; END_FOR;", "x", "22"},
      {"x, i : INT;", "FOR i := 5 TO 4 DO x := 1; END_FOR;", "x", "0"},
      {"x : INT; i : USINT;", "FOR i := 250 TO 255 DO x := x + 1; END_FOR;", "x", "6"},
      {"x : INT; i : UINT;", "FOR i := 3 TO 0 BY -1 DO x := x + 1; END_FOR;", "x", "4"},
      {"x, i, n : INT := 3;", "FOR i := 1 TO n DO n := 10; x := x + 1; END_FOR;", "x", "6"},
      {"x, i : INT;", "FOR i := 1 TO 10 DO IF i = 4 THEN EXIT; END_IF; x := x + 1; END_FOR;", "x", "3"},
      {"x, i : INT;", "FOR i := 1 TO 10 DO IF i MOD 2 = 0 THEN CONTINUE; END_IF; x := x + i; END_FOR;", "x",
       "25"},
      {"x : INT;", "WHILE x < 7 DO x := x + 2; END_WHILE;", "x", "8"},
      {"x : INT := 9;", "WHILE x < 7 DO x := x + 2; END_WHILE;", "x", "9"},
      {"x : INT := 9;", "REPEAT x := x + 1; UNTIL x > 3 END_REPEAT;", "x", "10"},
      {"x : INT;", "REPEAT x := x + 1; UNTIL x = 5 END_REPEAT;", "x", "5"},
      {"x, i, k : INT;",
       "FOR i := 1 TO 3 DO FOR k := 1 TO 3 DO IF k = 2 THEN EXIT; END_IF; x := x + 1; END_FOR; END_FOR;", "x",
       "3"},
      {"x, y : INT;",
       "WHILE TRUE DO x := x + 1; IF x > 5 THEN EXIT; END_IF; IF x > 2 THEN CONTINUE; END_IF; y := y + 1; "
       "END_WHILE;",
       "y", "2"},
      {"x : INT;", "x := 1; RETURN; x := 2;", "x", "1"},
      {"x : INT; a : ARRAY[1..5] OF INT; i : INT;",
       "FOR i := 1 TO 5 DO a[i] := i * i; END_FOR; x := a[1] + a[5];", "x", "26"},
  });
}

TEST(StructuredText, ArraysAndStructures_AreReadWrittenAndCopied) {
  check({
      {"a : ARRAY[-2..2] OF INT; i : INT := -2;", "a[i] := 7; a[2] := a[i] + 1;", "a", "[7, 0, 0, 0, 8]"},
      {"a, b : ARRAY[1..3] OF INT := [1, 2, 3];", "a[2] := 9; b := a;", "b", "[1, 9, 3]"},
      {"a : ARRAY[1..2, 1..3] OF INT; i, k : INT := 2;", "a[i, k] := 5; a[1, 3] := a[i, k] + 1;", "a",
       "[[0, 0, 6], [0, 5, 0]]"},
      {"a : ARRAY[1..2] OF ARRAY[0..1] OF INT; i : INT := 2;", "a[i][1] := 4;", "a[2]", "[0, 4]"},
      {"s : STRUCT x : INT := 3; y : REAL; END_STRUCT;", "s.y := s.x;", "s", "(x := 3, y := 3.0)"},
      {"s, t : STRUCT x : INT; n : STRING[5]; END_STRUCT;", "s.x := 1; s.n := 'abc'; t := s;", "t",
       "(x := 1, n := 'abc')"},
      {"a : ARRAY[1..3] OF STRUCT x, y : INT; END_STRUCT; i : INT := 2;", "a[i].y := 8; a[3] := a[i];",
       "a[3].y", "8"},
      {"a : ARRAY[1..3] OF STRING[4]; i : INT := 3;", "a[i] := 'toolong'; a[1] := a[i];", "a[1]", "'tool'"},
      {"x : INT (1..5); y : INT := 4;", "x := y;", "x", "4"},
      {"w : WORD := 16#1234; x : BYTE;", "x := w.%B1;", "x", "16#12"},
      {"w : WORD := 16#1234; x : BOOL;", "x := w.2;", "x", "TRUE"},
      {"w : WORD;", "w.15 := TRUE; w.%X0 := TRUE;", "w", "16#8001"},
      {"w : DWORD := 16#12345678;", "w.%W0 := 16#ABCD;", "w", "16#1234ABCD"},
      {"w : LWORD;", "w.%D1 := 16#DEADBEEF;", "w", "16#DEADBEEF00000000"},
      {"w : INT;", "w.15 := TRUE;", "w", "-32768"},
  });
}

TEST(StructuredText, NumericFunctions_ReturnWhatTheirNamesSay) {
  check({
      {"x : INT := -5;", "x := ABS(x);", "x", "5"},
      {"x : REAL := -5.5;", "x := ABS(x);", "x", "5.5"},
      {"x : LREAL;", "x := SQRT(2.25);", "x", "1.5"},
      {"x : LREAL;", "x := LN(1.0);", "x", "0.0"},
      {"x : LREAL;", "x := LOG(1000.0);", "x", "3.0"},
      {"x : LREAL;", "x := EXP(0.0);", "x", "1.0"},
      {"x : LREAL;", "x := SIN(0.0) + COS(0.0);", "x", "1.0"},
      {"x : LREAL;", "x := TAN(0.0) + ASIN(0.0) + ACOS(1.0) + ATAN(0.0);", "x", "0.0"},
      {"x : LREAL;", "x := ATAN2(Y := 0.0, X := 1.0);", "x", "0.0"},
      {"x : INT;", "x := ADD(1, 2, 3);", "x", "6"},
      {"x : INT;", "x := MUL(IN1 := 2, IN2 := 3);", "x", "6"},
      {"x : INT;", "x := SUB(IN2 := 3, IN1 := 10);", "x", "7"},
      {"x : INT;", "x := DIV(7, 2);", "x", "3"},
      {"x : INT;", "x := MOD(7, 4);", "x", "3"},
      {"x : LREAL;", "x := EXPT(2.0, 10);", "x", "1024.0"},
      {"x : INT;", "x := MOVE(8);", "x", "8"},
      {"x : DINT;", "x := TRUNC(-2.7);", "x", "-2"},
  });
}

}  // namespace
}  // namespace structured_text_values_test
