// Standard functions: conversions, bits, selection, strings, times. Values worked out by hand from the standard's descriptions.

#include <gtest/gtest.h>

#include "compiled.hpp"

namespace structured_text_functions_test {
namespace {

struct Example {
  const char* type;        ///< of x
  const char* expression;  ///< x := expression
  const char* expected;
  const char* variables = "";
};

void check(std::initializer_list<Example> examples) {
  for (const Example& example : examples) {
    SCOPED_TRACE(std::string(example.expression));
    compiled::Plc plc(std::string("PROGRAM P\nVAR x : ") + example.type + "; " + example.variables +
                      " END_VAR\nx := " + example.expression + ";\nEND_PROGRAM\n");
    EXPECT_EQ(plc.run(), "");
    EXPECT_EQ(plc.read("P.x"), example.expected);
  }
}

TEST(StandardFunctions, Conversions_RoundWrapOrKeepBits) {
  check({
      {"INT", "REAL_TO_INT(1.5)", "2"},
      {"INT", "REAL_TO_INT(2.5)", "2"},  // ties to even
      {"INT", "REAL_TO_INT(-1.5)", "-2"},
      {"INT", "REAL_TO_INT(1.4)", "1"},
      {"INT", "REAL_TRUNC_INT(1.9)", "1"},
      {"INT", "REAL_TRUNC_INT(-1.9)", "-1"},
      {"DINT", "LREAL_TO_DINT(-2147483648.4)", "-2147483648"},
      {"INT", "DINT_TO_INT(70000)", "4464"},
      {"SINT", "INT_TO_SINT(200)", "-56"},
      {"UINT", "INT_TO_UINT(a)", "65535", "a : INT := -1;"},
      {"WORD", "INT_TO_WORD(a)", "16#FFFF", "a : INT := -1;"},
      {"INT", "WORD_TO_INT(16#FFFF)", "-1"},
      {"DWORD", "INT_TO_DWORD(a)", "16#FFFFFFFF", "a : INT := -1;"},
      {"REAL", "DINT_TO_REAL(100)", "100.0"},
      {"LREAL", "ULINT_TO_LREAL(18446744073709551615)", "18446744073709551616.0"},
      {"DWORD", "REAL_TO_DWORD(1.0)", "16#3F800000"},
      {"REAL", "DWORD_TO_REAL(16#40490FDB)", "3.1415927"},
      {"LWORD", "LREAL_TO_LWORD(2.0)", "16#4000000000000000"},
      {"BOOL", "INT_TO_BOOL(2)", "TRUE"},
      {"BOOL", "WORD_TO_BOOL(0)", "FALSE"},
      {"INT", "BOOL_TO_INT(TRUE)", "1"},
      {"BYTE", "TO_BYTE(16#1234)", "16#34"},
      {"INT", "TO_INT(3.7)", "4"},
      {"DINT", "TRUNC(3.7)", "3"},
      {"UINT", "WORD_BCD_TO_UINT(16#1234)", "1234"},
      {"UINT", "BCD_TO_UINT(16#1234)", "1234"},
      {"UDINT", "BCD_TO_UDINT(16#98765432)", "98765432"},
      {"WORD", "TO_BCD_WORD(1234)", "16#1234"},
      {"UINT", "BCD_TO_UINT(a)", "1234", "a : WORD := 16#1234;"},
      {"WORD", "UINT_TO_BCD_WORD(9876)", "16#9876"},
      {"STRING", "INT_TO_STRING(-12)", "'-12'"},
      {"STRING", "REAL_TO_STRING(1.5)", "'1.5'"},
      {"STRING", "BOOL_TO_STRING(TRUE)", "'TRUE'"},
      {"STRING", "WORD_TO_STRING(16#FF)", "'255'"},
      {"STRING", "TIME_TO_STRING(T#1s500ms)", "'T#1s500ms'"},
      {"INT", "STRING_TO_INT('-12')", "-12"},
      {"REAL", "STRING_TO_REAL('1.25')", "1.25"},
      {"DINT", "STRING_TO_DINT('16#FF')", "255"},
      {"WSTRING", "DINT_TO_WSTRING(5)", "\"5\""},
      {"WSTRING", "STRING_TO_WSTRING('ab')", "\"ab\""},
      {"STRING", "WSTRING_TO_STRING(\"ab\")", "'ab'"},
      {"DINT", "TIME_TO_DINT(T#1s500ms)", "1500"},
      {"TIME", "DINT_TO_TIME(1500)", "T#1s500ms"},
      {"DATE", "DT_TO_DATE(DT#1998-05-29-12:00:00)", "DATE#1998-05-29"},
      {"TOD", "DT_TO_TOD(DT#1998-05-29-12:34:56)", "TOD#12:34:56"},
      {"LTIME", "TIME_TO_LTIME(T#5ms)", "LT#5ms"},
      {"DINT", "TO_DINT(a)", "2", "a : (red, green := 2) := green;"},
  });
}

TEST(StandardFunctions, Bits_ShiftAndRotateWithinTheType) {
  check({
      {"WORD", "SHL(WORD#16#8001, 1)", "16#0002"},
      {"WORD", "SHR(WORD#16#8001, 1)", "16#4000"},
      {"WORD", "ROL(WORD#16#8001, 1)", "16#0003"},
      {"WORD", "ROR(WORD#16#8001, 1)", "16#C000"},
      {"WORD", "SHL(WORD#16#8001, 16)", "16#0000"},
      {"WORD", "ROL(WORD#16#8001, 16)", "16#8001"},
      {"WORD", "ROL(WORD#16#8001, 17)", "16#0003"},
      {"BYTE", "ROR(IN := BYTE#16#01, N := 3)", "16#20"},
      {"LWORD", "ROL(LWORD#16#8000000000000001, 4)", "16#0000000000000018"},
      {"DWORD", "SHR(DWORD#16#80000000, 31)", "16#00000001"},
      {"WORD", "AND(WORD#16#FF, WORD#16#0F, WORD#16#3C)", "16#000C"},
      {"WORD", "OR(WORD#1, WORD#2)", "16#0003"},
      {"WORD", "XOR(WORD#3, WORD#6)", "16#0005"},
      {"BOOL", "NOT(TRUE)", "FALSE"},
      {"BOOL", "IS_VALID(1.0)", "TRUE"},
      {"BOOL", "IS_VALID_BCD(WORD#16#12A4)", "FALSE"},
      {"WORD", "TO_BIG_ENDIAN(WORD#16#1234)", "16#3412"},
      {"DWORD", "FROM_BIG_ENDIAN(DWORD#16#12345678)", "16#78563412"},
      {"WORD", "TO_LITTLE_ENDIAN(WORD#16#1234)", "16#1234"},
  });
}

TEST(StandardFunctions, Selection_TakesOneOfTheInputs) {
  check({
      {"INT", "SEL(FALSE, 3, 4)", "3"},
      {"INT", "SEL(G := TRUE, IN0 := 3, IN1 := 4)", "4"},
      {"STRING", "SEL(TRUE, 'no', 'yes')", "'yes'"},
      {"INT", "MUX(2, 10, 20, 30)", "30"},
      {"INT", "MUX(K := 1, IN0 := 10, IN1 := 20)", "20"},
      {"INT", "MAX(3, 9, 4)", "9"},
      {"INT", "MIN(3, 9, -4)", "-4"},
      {"REAL", "MAX(1.5, 0.5)", "1.5"},
      {"ULINT", "MAX(a, 1)", "18446744073709551615", "a : ULINT := 18446744073709551615;"},
      {"INT", "LIMIT(0, 15, 10)", "10"},
      {"INT", "LIMIT(MN := 0, IN := -5, MX := 10)", "0"},
      {"INT", "LIMIT(0, 5, 10)", "5"},
      {"TIME", "LIMIT(T#1s, T#500ms, T#2s)", "T#1s"},
      {"BOOL", "GT(3, 2)", "TRUE"},
      {"BOOL", "GE(2, 2)", "TRUE"},
      {"BOOL", "EQ(2, 3)", "FALSE"},
      {"BOOL", "LE(2, 3)", "TRUE"},
      {"BOOL", "LT(3, 3)", "FALSE"},
      {"BOOL", "NE(3, 2)", "TRUE"},
  });
}

TEST(StandardFunctions, Strings_AreThoseOfTheStandardsTable) {
  check({
      {"INT", "LEN('ASTRING')", "7"},
      {"STRING", "LEFT(IN := 'ASTR', L := 3)", "'AST'"},
      {"STRING", "RIGHT(IN := 'ASTR', L := 3)", "'STR'"},
      {"STRING", "MID(IN := 'ASTR', L := 2, P := 2)", "'ST'"},
      {"STRING", "CONCAT('AB', 'CD', 'E')", "'ABCDE'"},
      {"STRING", "INSERT(IN1 := 'ABC', IN2 := 'XY', P := 2)", "'ABXYC'"},
      {"STRING", "DELETE(IN := 'ABXYC', L := 2, P := 3)", "'ABC'"},
      {"STRING", "REPLACE(IN1 := 'ABCDE', IN2 := 'X', L := 2, P := 3)", "'ABXE'"},
      {"INT", "FIND(IN1 := 'ABCBC', IN2 := 'BC')", "2"},
      {"INT", "FIND('ABC', 'X')", "0"},
      {"INT", "LEN(\"wide\")", "4"},
      {"WSTRING", "CONCAT(\"a\", \"b\")", "\"ab\""},
      {"STRING", "LEFT('AB', 10)", "'AB'"},
      {"STRING", "MID('AB', 5, 3)", "''"},
      {"STRING", "CONCAT(a, CONCAT(a, a))", "'xyxyxy'", "a : STRING[2] := 'xy';"},
      {"STRING[3]", "CONCAT('AB', 'CD')", "'ABC'"},
      {"STRING", "INSERT('AB', 'x', 0)", "'xAB'"},
      {"STRING", "DELETE('ABC', 10, 2)", "'A'"},
  });
}

TEST(StandardFunctions, Times_AreAddedSubtractedAndScaled) {
  check({
      {"TIME", "T#1s + T#500ms", "T#1s500ms"},
      {"TIME", "T#1s - T#2s", "T#-1s"},
      {"TIME", "T#1s * 3", "T#3s"},
      {"TIME", "T#1s * 0.25", "T#250ms"},
      {"TIME", "T#1s / 4", "T#250ms"},
      {"TIME", "ADD_TIME(T#1s, T#1ms)", "T#1s1ms"},
      {"TIME", "SUB_TIME(T#1s, T#1ms)", "T#999ms"},
      {"TIME", "MUL_TIME(T#2s, 2)", "T#4s"},
      {"TIME", "DIV_TIME(T#2s, 2)", "T#1s"},
      {"TOD", "TOD#23:59:59 + T#2s", "TOD#00:00:01"},
      {"TOD", "TOD#12:00:00 - T#1m", "TOD#11:59:00"},
      {"TIME", "TOD#12:00:00 - TOD#11:00:00", "T#1h"},
      {"DT", "DT#2023-12-31-23:59:59 + T#1s", "DT#2024-01-01-00:00:00"},
      {"TIME", "D#2024-03-01 - D#2024-02-28", "T#2d"},
      {"TIME", "DT#2024-01-01-00:00:01 - DT#2024-01-01-00:00:00", "T#1s"},
      {"DT", "CONCAT_DATE_TOD(D#2024-02-29, TOD#01:02:03)", "DT#2024-02-29-01:02:03"},
      {"DATE", "CONCAT_DATE(2024, 2, 29)", "DATE#2024-02-29"},
      {"TOD", "CONCAT_TOD(1, 2, 3, 4)", "TOD#01:02:03.004"},
      {"DT", "CONCAT_DT(2024, 2, 29, 1, 2, 3, 0)", "DT#2024-02-29-01:02:03"},
      {"USINT", "DAY_OF_WEEK(D#2024-02-29)", "4"},  // a Thursday
  });
}

TEST(StandardFunctions, Split_GivesTheFieldsOfADateOrTime) {
  compiled::Plc plc(
      "PROGRAM P VAR y : INT; m, d : UINT; h, n, s, ms, day : DINT; END_VAR\n"
      "SPLIT_DATE(IN := D#2024-02-29, YEAR => y, MONTH => m, DAY => d);\n"
      "SPLIT_TOD(TOD#01:02:03.004, HOUR => h, MINUTE => n, SECOND => s, MILLISECOND => ms);\n"
      "SPLIT_DT(IN := DT#1969-12-31-23:00:00, DAY => day); END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P"), "(y := 2024, m := 2, d := 29, h := 1, n := 2, s := 3, ms := 4, day := 31)");
  EXPECT_EQ(compiled::errors_of(
                "PROGRAM P VAR x : INT; END_VAR SPLIT_DATE(IN := D#2024-02-29, HOUR => x); END_PROGRAM"),
            "main.st:1:63: SPLIT_DATE has no output HOUR\n");
}

// A long search in a loop must not take minutes that the watchdog does not see.
TEST(StandardFunctions, Find_CountsItsComparisonsTowardsTheWatchdog) {
  compiled::Plc plc(
      "PROGRAM P VAR a, b : STRING[1000]; x, i : INT; END_VAR\n"
      "FOR i := 1 TO 999 DO a := CONCAT(a, 'a'); END_FOR; b := CONCAT(LEFT(a, 499), 'b');\n"
      "x := FIND(a, b);\nEND_PROGRAM");
  if (plc.machine) plc.machine->set_watchdog(100'000);
  EXPECT_EQ(plc.run(), "main.st:3:6: the scan takes too long: a loop may not end");
  if (plc.machine) plc.machine->set_watchdog(1'000'000);
  EXPECT_EQ(plc.run(), "");
}

struct Failing {
  const char* statements;
  const char* error;
  const char* variables;
};

TEST(StandardFunctions, NoResult_EndsTheScanWithThePlaceInTheSource) {
  for (const Failing& example : std::initializer_list<Failing>{
           {"x := 5 / y;", "main.st:3:8: division by zero", "x, y : INT;"},
           {"x := 5 MOD y;", "main.st:3:8: division by zero", "x, y : INT;"},
           {"r := 1.0 / r;", "main.st:3:10: division by zero", "r : REAL;"},
           {"a[y] := 1;", "main.st:3:1: array index 0 is outside of 1 to 3",
            "y : INT; a : ARRAY[1..3] OF INT;"},
           {"y := 4; x := a[y];", "main.st:3:14: array index 4 is outside of 1 to 3",
            "x, y : INT; a : ARRAY[1..3] OF INT;"},
           {"s := y;", "main.st:3:6: value 0 is outside of 1 to 5", "y : INT; s : INT (1..5);"},
           {"x := REAL_TO_INT(r);", "main.st:3:6: value 40000 is outside of -32768 to 32767",
            "x : INT; r : REAL := 40000.0;"},
           {"r := SQRT(r);", "main.st:3:6: value -1 is outside of 0 to 9223372036854775807",
            "r : LREAL := -1.0;"},
           {"x := STRING_TO_INT('a');",
            "main.st:3:6: the text is no value of the type that it is converted to", "x : INT;"},
           {"x := MUX(y, 1, 2);", "main.st:3:6: value 7 is outside of 0 to 1", "x : INT; y : INT := 7;"},
           {"s := WSTRING_TO_STRING(\"$1234\");", "main.st:3:6: value 4660 is outside of 0 to 255",
            "s : STRING;"},
           {"WHILE TRUE DO x := 1; END_WHILE;", "main.st:3:1: the scan takes too long: a loop may not end",
            "x : INT;"},
       }) {
    SCOPED_TRACE(example.statements);
    compiled::Plc plc(std::string("PROGRAM P\nVAR ") + example.variables + " END_VAR\n" + example.statements +
                      "\nEND_PROGRAM\n");
    if (plc.machine) plc.machine->set_watchdog(10'000);
    EXPECT_EQ(plc.run(), example.error);
  }
}

}  // namespace
}  // namespace structured_text_functions_test
