// What the compiler refuses: the place in the source, and what was expected.

#include <algorithm>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "compiled.hpp"

namespace structured_text_errors_test {
namespace {

using compiled::errors_of;

struct Wrong {
  const char* statements;  ///< line 3 of a program
  const char* error;
};

TEST(Errors, WhatAVariableCannotHaveAtItsPlace_IsRefused) {
  const auto first = [](const std::string& declarations) {
    const std::string errors = errors_of(declarations + " PROGRAM P END_PROGRAM");
    return errors.substr(0, errors.find('\n'));
  };
  EXPECT_EQ(first("TYPE t : STRUCT a AT D0 : INT; END_STRUCT; END_TYPE"),
            "main.st:1:19: expected : (this variable has no device), found 'AT'");
  EXPECT_EQ(first("TYPE t : STRUCT a : BOOL R_EDGE; END_STRUCT; END_TYPE"),
            "main.st:1:26: expected ;, found 'R_EDGE'");
  EXPECT_EQ(first("VAR_GLOBAL x : BOOL F_EDGE; END_VAR"), "main.st:1:21: expected ;, found 'F_EDGE'");
  EXPECT_EQ(first("FUNCTION_BLOCK b VAR_INPUT x : BOOL R_EDGE F_EDGE; END_VAR END_FUNCTION_BLOCK"),
            "main.st:1:44: expected ;, found 'F_EDGE'");
  const std::string global = "VAR_GLOBAL g : INT; END_VAR FUNCTION_BLOCK b VAR_EXTERNAL g";
  EXPECT_EQ(first(global + " : INT := 5; END_VAR END_FUNCTION_BLOCK"),
            "main.st:1:70: expected no initial value: its VAR_GLOBAL has it");
  EXPECT_EQ(first(global + " AT D0 : INT; END_VAR END_FUNCTION_BLOCK"),
            "main.st:1:61: expected : (this variable has no device), found 'AT'");
}

TEST(StructuredTextErrors, Statements_NameThePlaceAndWhatWasExpected) {
  for (const Wrong& example : std::initializer_list<Wrong>{
           {"x := 1", "4:1: expected ;, found 'END_PROGRAM'"},
           {"x = 1;", "3:3: expected :=, found '='"},
           {"x := ;", "3:6: expected an expression, found ';'"},
           {"x := (1 + 2;", "3:12: expected ), found ';'"},
           {"IF x THEN END_IF;", "3:4: expected BOOL, found INT: INT_TO_BOOL converts it"},
           {"IF b x := 1; END_IF;", "3:6: expected THEN, found 'x'"},
           {"FOR x := 1 TO 3 x := 1; END_FOR;", "3:17: expected DO, found 'x'"},
           {"FOR r := 1 TO 3 DO ; END_FOR;", "3:5: expected an integer variable, found REAL"},
           {"EXIT;", "3:1: expected EXIT within FOR, WHILE or REPEAT"},
           {"CONTINUE;", "3:1: expected CONTINUE within FOR, WHILE or REPEAT"},
           {"nothing := 1;", "3:1: there is no variable nothing"},
           {"x := nothing(1);", "3:6: there is no function nothing"},
           {"nothing(1);", "3:1: there is no function or function block instance nothing"},
           {"x := r;", "3:6: expected INT, found REAL: REAL_TO_INT converts it"},
           {"q := 'ab';", "3:6: expected one character for CHAR, found 2"},
           {"q := '';", "3:6: expected one character for CHAR, found 0"},
           {"q := \"a\";", "3:6: expected CHAR, found WSTRING[1]: WSTRING_TO_CHAR converts it"},
           {"q := WSTRING_TO_CHAR(\"a\");", "3:6: there is no conversion of WSTRING to CHAR"},
           {"b := q = 'ab';", "3:10: expected one character for CHAR, found 2"},
           {"CASE x OF 1: ; 2, 1: ; END_CASE;",
            "3:19: expected values that no other label has: line 3 has them already"},
           {"CASE x OF\n1..5: ;\n3: ;\nEND_CASE;",
            "5:1: expected values that no other label has: line 4 has them already"},
           {"CASE x OF\n-1: ;\n-5..3: ;\nEND_CASE;",
            "5:1: expected values that no other label has: line 4 has them already"},
           {"CASE x OF 5..1: ; END_CASE;", "3:11: expected a first value that is not above the last one"},
           {"x := 'a';", "3:6: expected INT, found STRING[1]: STRING_TO_INT converts it"},
           {"x := 40000;", "3:6: expected a value within the range of INT, found 40000"},
           {"x := -32769;", "3:6: expected a value within the range of INT, found -32769"},
           {"x := w + 1;",
            "3:8: expected numbers beside +, found WORD and integer literal: WORD_TO_UINT or the like "
            "converts it"},
           {"w := x AND 1;", "3:8: expected BOOL or bit strings beside AND, found INT and integer literal"},
           {"b := x = 'a';", "3:8: expected values that can be compared by =, found INT and STRING"},
           {"a[4] := 1;", "3:3: expected an index from 1 to 3"},
           {"a[1, 2] := 1;", "3:1: expected an array before [, found INT"},
           {"a[r] := 1;", "3:3: expected an integer as an index, found REAL"},
           {"x[1] := 1;", "3:1: expected an array before [, found INT"},
           {"x.y := 1;", "3:3: INT has no element y"},
           {"x.16 := TRUE;", "3:3: expected a number from 0 to 15 behind the point"},
           {"c := 1;", "3:1: expected a variable, not a constant"},
           {"t.Q := TRUE;", "3:3: expected a variable: an output of a function block can only be read"},
           {"t(XY := 1);", "3:3: TON has no input or output XY"},
           {"t(IN => b);", "3:3: expected := : IN is an input"},
           {"t(IN := b, IN := b);", "3:12: expected IN once"},
           {"TON(IN := b);", "3:1: expected an instance: a variable of type TON"},
           {"x := t;", "3:6: expected a value, found the function block TON"},
           {"x := MAX(1, b);", "3:13: expected integer literal, found BOOL"},
           {"x := LIMIT(1, 2);", "3:6: expected 3 inputs: MN,IN,MX"},
           {"x := SEL(b, IN1 := 2, 3);", "3:6: expected names for all inputs or for none"},
           {"CASE x OF 1: ; r: ; END_CASE;", "3:16: expected a constant, found the variable r"},
           {"CASE r OF 1: ; END_CASE;", "3:6: expected an integer or an enumeration, found REAL"},
           {"s := 'abc;", "3:6: the string does not end; expected '"},
           {"s := '$Q';", "3:6: expected $hh or one of $$ $' $\" $L $N $P $R $T"},
           {"x := 2#12;", "3:6: '2#12' is no number of its base"},
           {"x := 3#12;", "3:6: '3#12' has no base that there is; expected 2#, 8# or 16#"},
           {"x := 1abc;", "3:6: '1abc' is no number; a name begins with a letter or _"},
           {"x := 99999999999999999999;", "3:6: '99999999999999999999' is beyond the range of 64 bits"},
           {"d := T#1s1h;", "3:6: expected TIME, found '1s1h'"},
           {"d := D#2023-02-29;", "3:6: expected DATE, found '2023-02-29'"},
           {"x := color#red;", "3:6: expected a type before #, found 'COLOR'"},
           {"(* no end", "3:1: the comment does not end; expected *)"},
           {"x := 1 ? 2;", "3:8: unexpected character ?"},
           {"D9999 := 1;", "3:1: D9999: expected a smaller number"},
           {"x := D0.G;", "3:9: D0.G: expected a bit from 0 to F behind the point"},
           {"x := D0:STRING;", "3:6: D0: expected an elementary type for it, found STRING"},
           {"x := X9;", "3:6: X9: expected a device"},
           {"t(IN := b, EN := b, EN := b);", "3:21: TON has no input or output EN"},
           {"t(IN := b, EN := 5);", "3:18: expected BOOL, found INT: INT_TO_BOOL converts it"},
           {"MAX := 1;", "3:1: there is no variable MAX"},
       }) {
    SCOPED_TRACE(example.statements);
    const std::string errors = errors_of(
        std::string(
            "PROGRAM P\nVAR x : INT; q : CHAR; b : BOOL; r : REAL; w : WORD; s : STRING; d : TIME; t : TON; "
            "a : ARRAY[1..3] OF INT; END_VAR VAR CONSTANT c : INT := 1; END_VAR\n") +
        example.statements + "\nEND_PROGRAM\n");
    EXPECT_EQ(errors.substr(0, errors.find('\n')), std::string("main.st:") + example.error);
  }
}

struct WrongFile {
  const char* source;
  const char* error;
};

TEST(StructuredTextErrors, Declarations_NameThePlaceAndWhatWasExpected) {
  for (
      const WrongFile& example : std::initializer_list<WrongFile>{
          {"x := 1;", "1:1: expected PROGRAM, FUNCTION, FUNCTION_BLOCK, TYPE or VAR_GLOBAL, found 'x'"},
          {"PROGRAM P", "1:10: expected END_PROGRAM, found the end of the file"},
          {"PROGRAM P : INT END_PROGRAM",
           "1:11: expected VAR or statements: only a function or a method has a result, found ':'"},
          {"PROGRAM P VAR x INT; END_VAR END_PROGRAM", "1:17: expected :, found 'INT'"},
          {"PROGRAM P VAR x : ; END_VAR END_PROGRAM", "1:19: expected a type, found ';'"},
          {"PROGRAM P VAR x : NONE; END_VAR END_PROGRAM", "1:19: expected a type, found 'NONE'"},
          {"PROGRAM P VAR x, x : INT; END_VAR END_PROGRAM",
           "1:18: expected another name: x is declared already"},
          {"PROGRAM P VAR x : INT; END_PROGRAM",
           "1:24: expected the name of a variable or END_VAR, found 'END_PROGRAM'"},
          {"PROGRAM P END_PROGRAM PROGRAM P END_PROGRAM",
           "1:31: expected another name: P is declared already"},
          {"TYPE t : ARRAY[3..1] OF INT; END_TYPE",
           "1:16: expected a first index and a last one that is not below it, and at most 4000000 elements"},
          {"TYPE t : STRUCT a : t; END_STRUCT END_TYPE",
           "1:21: expected a type that does not contain itself: t"},
          {"TYPE t : INT (1..100000); END_TYPE", "1:15: expected a range within INT"},
          {"TYPE t : REAL (1..2); END_TYPE", "1:10: expected an integer type before the range"},
          {"TYPE t : (a, b, a); END_TYPE", "1:17: expected another name: there is a value a"},
          {"TYPE t : STRING[0]; END_TYPE", "1:17: expected a length from 1 to 1024"},
          {"VAR_GLOBAL x : INT := y; y : INT := 1; END_VAR",
           "1:23: expected a constant, found the variable y"},
          {"VAR_GLOBAL CONSTANT x : INT := y; y : INT := x; END_VAR",
           "1:46: the value of x depends on itself"},
          {"VAR_GLOBAL CONSTANT x : INT := 1 / 0; END_VAR",
           "1:34: expected a value that can be computed: division by zero"},
          {"VAR_GLOBAL x AT D0 : INT := 1; END_VAR",
           "1:29: expected no initial value: a device keeps its own"},
          {"VAR_GLOBAL x AT D0 : BOOL; END_VAR",
           "1:17: D0: expected a type of 16, 32 or 64 bits for a word device"},
          {"VAR_GLOBAL x AT %ZX0 : BOOL; END_VAR", "1:17: %ZX0: expected %IX, %QX, %MX, %MW or %MD"},
          {"FUNCTION f : INT f := f(); END_FUNCTION",
           "1:23: f is used by itself: a function or function block does not call itself"},
          {"FUNCTION_BLOCK b VAR c : b; END_VAR END_FUNCTION_BLOCK",
           "1:26: b is used by itself: a function or function block does not call itself"},
          {"FUNCTION f : INT VAR t : TON; END_VAR END_FUNCTION",
           "1:22: expected a data type: a function block needs a variable that keeps its values"},
          {"PROGRAM P VAR_EXTERNAL x : INT; END_VAR END_PROGRAM",
           "1:24: expected the name of a global variable: there is no VAR_GLOBAL x"},
          {"TYPE p : REF_TO INT; END_TYPE",
           "1:10: expected a type (there are no references; VAR_IN_OUT passes a variable itself), found "
           "'REF_TO'"},
          {"PROGRAM P VAR p : POINTER TO INT; END_VAR END_PROGRAM",
           "1:19: expected a type (there are no pointers; VAR_IN_OUT passes a variable itself), found "
           "'POINTER'"},
          {"PROGRAM P VAR a : ARRAY[1..2] OF INT := 1, 2, 3; END_VAR END_PROGRAM",
           "1:41: expected at most 2 values"},
          {"PROGRAM P VAR a : ARRAY[1..2] OF INT := ; END_VAR END_PROGRAM",
           "1:41: expected an expression, found ';'"},
          {"TYPE int : DINT; END_TYPE", "1:6: expected another name: int is declared already"},
          {"FUNCTION real : INT END_FUNCTION", "1:10: expected another name: real is declared already"},
          {"TYPE e : INT (x := 100000); END_TYPE",
           "1:15: expected a value within the range of INT, found 100000"},
          {"TYPE e : SINT (x := 127, y); END_TYPE",
           "1:26: expected a value within the range of SINT, found 128"},
          {"TYPE e : USINT (x := -1); END_TYPE",
           "1:17: expected a value within the range of USINT, found -1"},
          {"TYPE t : INT := 100000; END_TYPE",
           "1:17: expected a value within the range of INT, found 100000"},
          {"TYPE t : INT (1..5) := 6; END_TYPE",
           "1:24: expected a value that can be computed: value 6 is outside of 1 to 5"},
          {"TYPE t : ARRAY[1..2] OF INT (1..5) := [1, 6]; END_TYPE",
           "1:43: expected a value that can be computed: value 6 is outside of 1 to 5"},
          {"TYPE t : STRUCT a : INT (1..5) := 6; END_STRUCT; END_TYPE",
           "1:35: expected a value that can be computed: value 6 is outside of 1 to 5"},
          {"FUNCTION_BLOCK b VAR_IN_OUT CONSTANT x : INT; END_VAR END_FUNCTION_BLOCK",
           "1:29: expected CONSTANT behind VAR, VAR_GLOBAL or VAR_EXTERNAL alone, found 'CONSTANT'"},
          {"FUNCTION_BLOCK b VAR_INPUT CONSTANT x : INT := 5; END_VAR END_FUNCTION_BLOCK",
           "1:28: expected CONSTANT behind VAR, VAR_GLOBAL or VAR_EXTERNAL alone, found 'CONSTANT'"},
          {"PROGRAM P VAR CONSTANT x AT D0 : INT; END_VAR x := 1; END_PROGRAM",
           "1:47: expected a variable, not a constant"},
          {"VAR_GLOBAL CONSTANT x AT D0 : INT; END_VAR PROGRAM P x := 1; END_PROGRAM",
           "1:54: expected a variable, not a constant"},
          {"VAR_GLOBAL x : INT; END_VAR PROGRAM P VAR_EXTERNAL CONSTANT x : INT; END_VAR x := 1; END_PROGRAM",
           "1:78: expected a variable, not a constant"},
          {"VAR_GLOBAL x : INT; END_VAR FUNCTION_BLOCK b VAR_EXTERNAL CONSTANT x : INT; END_VAR VAR c : CTU; "
           "END_VAR FOR x := 1 TO 2 DO ; END_FOR; END_FUNCTION_BLOCK",
           "1:110: expected a variable, not a constant"},
          {"VAR_GLOBAL CONSTANT x : INT := 1; END_VAR PROGRAM P VAR_EXTERNAL x : INT; END_VAR END_PROGRAM",
           "1:66: expected VAR_EXTERNAL CONSTANT: its VAR_GLOBAL is CONSTANT"},
          {"VAR_GLOBAL x : INT; END_VAR PROGRAM P VAR_EXTERNAL x : DINT; END_VAR END_PROGRAM",
           "1:52: expected INT as in its VAR_GLOBAL, found DINT"},
          {"VAR_GLOBAL x : ARRAY[1..2] OF INT; END_VAR PROGRAM P VAR_EXTERNAL x : ARRAY[0..1] OF INT; "
           "END_VAR "
           "END_PROGRAM",
           "1:67: expected ARRAY[1..2] OF INT as in its VAR_GLOBAL, found ARRAY[0..1] OF INT"},
          {"PROGRAM P VAR a : ARRAY[1..2] OF INT := [1, 2, 3]; END_VAR END_PROGRAM",
           "1:41: expected at most 2 values"},
          {"PROGRAM P VAR a : ARRAY[1..1000000000] OF INT; END_VAR END_PROGRAM",
           "1:25: expected a first index and a last one that is not below it, and at most 4000000 elements"},
          {"PROGRAM P VAR a : ARRAY[1..3000] OF ARRAY[1..3000] OF INT; END_VAR END_PROGRAM",
           "1:19: the array is too large: expected at most 4000000 elements in all"},
      }) {
    SCOPED_TRACE(example.source);
    const std::string errors = errors_of(example.source);
    EXPECT_EQ(errors.substr(0, errors.find('\n')), std::string("main.st:") + example.error);
  }
}

TEST(StructuredTextErrors, SeveralMistakes_AreReportedAtOnce) {
  EXPECT_EQ(errors_of("PROGRAM P\nVAR x : INT; y : ; END_VAR\nx := ;\nIF x = 1 THEN\n x := 1 +;\nEND_IF;\ny "
                      ":= 2\nEND_PROGRAM"),
            "main.st:2:18: expected a type, found ';'\n"
            "main.st:3:6: expected an expression, found ';'\n"
            "main.st:5:10: expected an expression, found ';'\n"
            "main.st:8:1: expected ;, found 'END_PROGRAM'\n");
  EXPECT_EQ(errors_of("PROGRAM P\nVAR x : INT; END_VAR\nx := TRUE;\nx := y;\nz := x;\nEND_PROGRAM"),
            "main.st:3:6: expected INT, found BOOL: BOOL_TO_INT converts it\n"
            "main.st:4:6: there is no variable y\n"
            "main.st:5:1: there is no variable z\n");
}

TEST(StructuredTextErrors, DeepNesting_IsRefusedAndNothingOverflows) {
  const auto nested = [](int depth) {
    return "PROGRAM P VAR x : INT; END_VAR x := " + std::string(static_cast<std::size_t>(depth), '(') + "1" +
           std::string(static_cast<std::size_t>(depth), ')') + "; END_PROGRAM";
  };
  EXPECT_EQ(errors_of(nested(50)), "");
  EXPECT_NE(errors_of(nested(200)).find("expected at most 100 levels of nesting"), std::string::npos);
  EXPECT_NE(errors_of(nested(200'000)).find("expected at most 100 levels of nesting"), std::string::npos);
  std::string sum = "PROGRAM P VAR x : INT; END_VAR x := 1";
  for (int i = 0; i < 5000; ++i) sum += " + 1";
  EXPECT_NE(errors_of(sum + "; END_PROGRAM").find("expected a simpler expression"), std::string::npos);
  std::string ifs = "PROGRAM P ";
  for (int i = 0; i < 5000; ++i) ifs += "IF TRUE THEN ";
  EXPECT_NE(errors_of(ifs).find("expected at most 100 levels of nesting"), std::string::npos);
}

TEST(StructuredTextErrors, MoreThanTheMemoryPermits_IsRefused) {
  std::string types = "TYPE ";
  for (int i = 0; i < 100; ++i)
    types += "t" + std::to_string(i) + " : STRUCT a : ARRAY[1..1000000] OF INT; END_STRUCT ";
  EXPECT_NE(errors_of(types + "END_TYPE").find("the types and variables of the program need too much memory"),
            std::string::npos);
  std::string values = "TYPE e : (v";
  for (int i = 0; i < 10'000; ++i) values += ", v" + std::to_string(i);
  EXPECT_EQ(errors_of(values + "); END_TYPE"), "main.st:1:10: expected at most 5000 values\n");
  EXPECT_EQ(errors_of(std::string(2'000'001, ' ')),
            "main.st:1:1: too much Structured Text: expected at most 1000 files with 2000000 bytes in all\n");
  const std::string many = errors_of(std::string(10'000, '?'));
  EXPECT_LE(std::count(many.begin(), many.end(), '\n'), 100);
}

/// TYPE declarations, each of the next one; the names are in this order or the other way round.
std::string types_of_each_other(int count, bool is_rising, const std::string& begin, const std::string& end) {
  const auto name = [&](int i) { return "T" + std::to_string(100'000 + (is_rising ? i : count - i)); };
  std::string text = "TYPE\n";
  for (int i = 0; i < count; ++i) text += name(i) + " : " + begin + name(i + 1) + end + ";\n";
  return text + name(count) + " : INT; END_TYPE\nPROGRAM p VAR v : " + name(0) + "; END_VAR END_PROGRAM";
}

// A type is made of others by functions that call themselves: their number within one another is bounded.
TEST(StructuredTextErrors, TypesWithinOneAnother_AreRefusedFrom200On) {
  const std::string message = "expected at most 200 arrays, structures and names of types within one another";
  for (const bool is_rising : {true, false}) {
    for (const auto& [begin, end] : {std::pair("STRUCT a : ", "; END_STRUCT"), {"ARRAY[0..0] OF ", ""}}) {
      EXPECT_NE(errors_of(types_of_each_other(30'000, is_rising, begin, end)).find(message),
                std::string::npos);
      EXPECT_EQ(errors_of(types_of_each_other(50, is_rising, begin, end)), "");
    }
    const std::string names = errors_of(types_of_each_other(30'000, is_rising, "", ""));
    EXPECT_EQ(names.empty(), !is_rising) << names;  // a name of a type that is known is no level
    EXPECT_EQ(errors_of(types_of_each_other(50, is_rising, "", "")), "");
  }
}

TEST(StructuredTextErrors, ConstantsThatNeedEachOther_AreRefusedFrom100On) {
  const auto constants = [](int count, const std::string& type, const std::string& end) {
    std::string text = "VAR_GLOBAL CONSTANT\n";
    for (int i = 0; i < count; ++i)
      text += "c" + std::to_string(i) + type + "c" + std::to_string(i + 1) + end + ";\n";
    return text + "c" + std::to_string(count) + " : INT := 1; END_VAR PROGRAM p END_PROGRAM";
  };
  EXPECT_EQ(errors_of(constants(99, " : INT := ", "")), "");
  const std::string message = "expected at most 100 global variables that need each other in a row";
  EXPECT_NE(errors_of(constants(20'000, " : INT := ", "")).find(message), std::string::npos);
  EXPECT_NE(errors_of(constants(20'000, " : STRING[", "]")), "");
}

TEST(StructuredTextErrors, DimensionsOfAnArray_AreRefusedFrom200On) {
  const auto array_of = [](int dimensions) {
    std::string text = "PROGRAM p VAR a : ARRAY[";
    for (int i = 1; i < dimensions; ++i) text += "0..0,";
    return text + "0..0] OF INT; END_VAR END_PROGRAM";
  };
  EXPECT_EQ(errors_of(array_of(200)), "");
  EXPECT_EQ(errors_of(array_of(201)),
            "main.st:1:19: expected at most 200 arrays, structures and names of types within one another\n");
  EXPECT_NE(errors_of(array_of(100'000)), "");
}

// Whatever the text: the compiler returns, and what it accepts runs within its watchdog.
RC_GTEST_PROP(StructuredTextErrors, AnyOrderOfTokens_IsCompiledOrRefused, ()) {
  static const std::vector<std::string> tokens = {"PROGRAM",
                                                  "P",
                                                  "END_PROGRAM",
                                                  "VAR",
                                                  "END_VAR",
                                                  "x",
                                                  ":",
                                                  "INT",
                                                  ";",
                                                  ":=",
                                                  "1",
                                                  "+",
                                                  "-",
                                                  "*",
                                                  "(",
                                                  ")",
                                                  "[",
                                                  "]",
                                                  "IF",
                                                  "THEN",
                                                  "ELSE",
                                                  "ELSIF",
                                                  "END_IF",
                                                  "FOR",
                                                  "TO",
                                                  "BY",
                                                  "DO",
                                                  "END_FOR",
                                                  "WHILE",
                                                  "END_WHILE",
                                                  "CASE",
                                                  "OF",
                                                  "END_CASE",
                                                  "..",
                                                  ",",
                                                  ".",
                                                  "ARRAY",
                                                  "STRUCT",
                                                  "END_STRUCT",
                                                  "TYPE",
                                                  "END_TYPE",
                                                  "FUNCTION",
                                                  "END_FUNCTION",
                                                  "FUNCTION_BLOCK",
                                                  "END_FUNCTION_BLOCK",
                                                  "TON",
                                                  "TRUE",
                                                  "NOT",
                                                  "AND",
                                                  "MAX",
                                                  "'a'",
                                                  "1.5",
                                                  "T#1s",
                                                  "D0",
                                                  "X1",
                                                  "=",
                                                  "<",
                                                  "REPEAT",
                                                  "UNTIL",
                                                  "END_REPEAT",
                                                  "EXIT",
                                                  "RETURN",
                                                  "=>",
                                                  "REAL",
                                                  "STRING",
                                                  "VAR_INPUT",
                                                  "VAR_GLOBAL",
                                                  "CONSTANT"};
  std::string source =
      *rc::gen::arbitrary<bool>() ? "PROGRAM P VAR x : INT; t : TON; a : ARRAY[1..3] OF INT; END_VAR " : "";
  const auto numbers =
      *rc::gen::container<std::vector<unsigned>>(rc::gen::inRange(0U, static_cast<unsigned>(tokens.size())));
  for (const unsigned number : numbers) source += tokens[number] + ' ';
  memory_devices::MemoryDevices devices;
  const std::vector<compiled::st::Source> sources = {{"main.st", source}};
  auto made = compiled::st::compile(sources, &devices);
  RC_ASSERT((made.program != nullptr) == made.errors.empty());
  if (!made.program) return;
  compiled::Machine machine(std::move(made.program));
  machine.set_watchdog(10'000);
  (void)machine.scan(0, &devices);
}

}  // namespace
}  // namespace structured_text_errors_test
