// Forms that other programming tools write, and what is said where one of them is not there.

#include <gtest/gtest.h>

#include "compiled.hpp"

namespace exported_programs_test {
namespace {

using compiled::errors_of;
using compiled::Plc;

std::string first_error(const std::string& source) {
  const std::string errors = errors_of(source);
  return errors.substr(0, errors.find('\n'));
}

TEST(ExportedPrograms, TypedNames_OfOverloadedFunctionsHaveInputsOfThatType) {
  Plc plc(
      "PROGRAM P VAR a : INT := 30000; s : SINT := 100; w : WORD := 16#00F0; r : REAL := 2.0; big : BOOL := "
      "TRUE;\n"
      "sum : INT; wide : DINT; limited, chosen, picked : INT; shifted : BYTE; root : LREAL; same, none : "
      "BOOL; power : REAL; END_VAR\n"
      "sum := ADD_INT(s, s, 1); wide := MUL_DINT(a, a); limited := LIMIT_INT(MN := 1, IN := a, MX := 1000);\n"
      "chosen := SEL_INT(big, 3, 4); picked := MUX_INT(1, 5, 6); shifted := SHL_BYTE(16#81, 1); root := "
      "SQRT_LREAL(r);\n"
      "same := EQ_WORD(w, 16#00F0); none := NOT_BOOL(same); power := EXPT_REAL(r, 3);\n"
      "END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.sum"), "201");         // not in the eight bits of its inputs
  EXPECT_EQ(plc.read("P.wide"), "900000000");  // not in the sixteen of its inputs
  EXPECT_EQ(plc.read("P.limited"), "1000");
  EXPECT_EQ(plc.read("P.chosen"), "4");
  EXPECT_EQ(plc.read("P.picked"), "6");
  EXPECT_EQ(plc.read("P.shifted"), "16#02");
  EXPECT_EQ(plc.read("P.root").substr(0, 6), "1.4142");
  EXPECT_EQ(plc.read("P.same"), "TRUE");
  EXPECT_EQ(plc.read("P.none"), "FALSE");
  EXPECT_EQ(plc.read("P.power"), "8.0");
}

TEST(ExportedPrograms, TypedNames_RefuseInputsThatLoseSomething) {
  const auto with = [](const std::string& statement) {
    return first_error("PROGRAM P VAR x : INT; d : DINT; r : REAL; END_VAR\n" + statement + "\nEND_PROGRAM");
  };
  EXPECT_EQ(with("x := ADD_INT(d, 1);"), "main.st:2:14: expected INT, found DINT: DINT_TO_INT converts it");
  EXPECT_EQ(with("x := ADD_INT(40000, 1);"),
            "main.st:2:14: expected a value within the range of INT, found 40000");
  EXPECT_EQ(with("x := ADD_REAL(r, 1.0);"), "main.st:2:6: expected INT, found REAL: REAL_TO_INT converts it");
  EXPECT_EQ(with("x := LEN_INT(x);"), "main.st:2:6: there is no function LEN_INT");
  EXPECT_EQ(with("x := ADD_COLOUR(x, x);"), "main.st:2:6: there is no function ADD_COLOUR");
}

TEST(ExportedPrograms, OwnFunctionWithATypedName_TakesItsPlace) {
  Plc plc(
      "FUNCTION ADD_INT : INT VAR_INPUT a, b : INT; END_VAR ADD_INT := a - b; END_FUNCTION\n"
      "PROGRAM P VAR x : INT; END_VAR x := ADD_INT(5, 3); END_PROGRAM");
  plc.run();
  EXPECT_EQ(plc.read("P.x"), "2");
}

TEST(ExportedPrograms, MethodsBehindTheStatements_AndThisWithADereference) {
  Plc plc(
      "FUNCTION_BLOCK Counter VAR_OUTPUT n : INT; END_VAR n := n + 1; THIS^.Twice();\n"
      "METHOD Twice n := 2 * n; END_METHOD\n"
      "METHOD PUBLIC Sum : INT VAR_INPUT x : INT; END_VAR Sum := THIS^.n + x; END_METHOD\n"
      "END_FUNCTION_BLOCK\n"
      "PROGRAM P VAR c : Counter; x : INT; END_VAR c(); x := c.Sum(100); END_PROGRAM");
  EXPECT_EQ(plc.run(2), "");
  EXPECT_EQ(plc.read("P.x"), "106");
}

TEST(ExportedPrograms, EnumerationWithItsBaseTypeBehind) {
  Plc plc(
      "TYPE Kind : (idle := 5, busy := 70000) DINT := busy; END_TYPE\n"
      "PROGRAM P VAR k, m : Kind; d : DINT; END_VAR m := Kind.idle; IF k = Kind.busy THEN d := 1; END_IF "
      "END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.k"), "busy");
  EXPECT_EQ(plc.read("P.m"), "idle");
  EXPECT_EQ(plc.read("P.d"), "1");
}

TEST(ExportedPrograms, EnumerationValuesBehindTheirTypeAndAPoint) {
  Plc plc(
      "TYPE Light : (off, red, green); Door : (shut, off, open); END_TYPE\n"
      "PROGRAM P VAR lamp : Light := Light.green; gate : Door; n, m : INT; END_VAR\n"
      "CASE gate OF Door.shut: n := 1; Door.off, Door.open: n := 2; END_CASE\n"
      "IF lamp = Light.green THEN gate := DOOR.OFF; END_IF m := SEL(lamp = Light.red, 5, 6);\n"
      "END_PROGRAM");
  EXPECT_EQ(plc.run(2), "");
  EXPECT_EQ(plc.read("P.gate"), "off");
  EXPECT_EQ(plc.read("P.n"), "2");
  EXPECT_EQ(plc.read("P.m"), "5");
  EXPECT_EQ(first_error("TYPE Light : (off, red); END_TYPE\nPROGRAM P VAR x : Light; END_VAR\nLight.red := "
                        "x;\nEND_PROGRAM"),
            "main.st:3:7: expected a variable");
  EXPECT_EQ(first_error("TYPE Light : (off, red); END_TYPE\nPROGRAM P VAR x : Light; END_VAR\nx := "
                        "Light.blue;\nEND_PROGRAM"),
            "main.st:3:6: there is no variable Light");
}

TEST(ExportedPrograms, AVariableWithTheNameOfAnEnumeration_HidesIt) {
  Plc plc(
      "TYPE Light : (off, red); Lamp : STRUCT red : INT := 7; END_STRUCT; END_TYPE\n"
      "PROGRAM P VAR Light : Lamp; n : INT; END_VAR n := Light.red; END_PROGRAM");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.n"), "7");
}

TEST(ExportedPrograms, WhatANameIs_StandsBehindTheMistake) {
  const auto with = [](const std::string& statement) {
    return first_error(
        "PROGRAM Other VAR n : INT; END_VAR END_PROGRAM\nPROGRAM P VAR x : INT; w : WORD; END_VAR\n" +
        statement + "\nEND_PROGRAM");
  };
  EXPECT_EQ(with("Other();"),
            "main.st:3:1: expected a function or an instance: the CPU executes the PROGRAM Other by itself");
  EXPECT_EQ(with("Other(n := 3);"),
            "main.st:3:1: expected a function or an instance: the CPU executes the PROGRAM Other by itself");
  EXPECT_EQ(with("x := Other(3);"),
            "main.st:3:6: expected a function or an instance: the CPU executes the PROGRAM Other by itself");
  EXPECT_EQ(with("%QX0.1 := TRUE;"),
            "main.st:3:1: %QX0.1: expected one number behind %IX and %QX, as in %IX10");
  EXPECT_EQ(with("x := Other.n;"),
            "main.st:3:6: there is no variable Other: it is a PROGRAM, whose variables are its own; use "
            "VAR_GLOBAL");
  EXPECT_EQ(with("x := K100;"), "main.st:3:6: there is no variable K100; expected 100");
  EXPECT_EQ(with("x := H0F;"), "main.st:3:6: there is no variable H0F; expected 16#0F");
  EXPECT_EQ(with("x := K; x := HAT;"), "main.st:3:6: there is no variable K");
  EXPECT_EQ(
      with("w := w + 1;"),
      "main.st:3:8: expected numbers beside +, found WORD and integer literal: WORD_TO_UINT or the like "
      "converts it");
  EXPECT_EQ(with("MOV(TRUE, x, x);"),
            "main.st:3:1: there is no function or function block instance MOV: instructions are for lists; "
            "expected "
            ":=, IF, or a block such as TON");
}

TEST(ExportedPrograms, LineEndsOfCarriageReturnsAlone_EndCommentsAndAreCounted) {
  Plc plc("PROGRAM P\rVAR x : INT; END_VAR\r// first\rx := 1; // last\rEND_PROGRAM\r");
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.read("P.x"), "1");
  EXPECT_EQ(first_error("PROGRAM P\r// a\r\nx := 'a\ry := 2;\rEND_PROGRAM"),
            "main.st:3:6: the string does not end; expected '");
}

TEST(ExportedPrograms, WhatIsNotThere_IsNamedWithWhatToWrite) {
  const auto statement = [](const std::string& text) {
    return first_error("PROGRAM P VAR x, y : INT; b : BOOL; END_VAR\n" + text + "\nEND_PROGRAM");
  };
  EXPECT_EQ(
      statement("IF b AND_THEN b THEN END_IF;"),
      "main.st:2:6: expected AND (AND evaluates both sides; write an IF within an IF), found 'AND_THEN'");
  EXPECT_EQ(statement("b := b OR_ELSE b;"),
            "main.st:2:8: expected OR (OR evaluates both sides; write ELSIF), found 'OR_ELSE'");
  EXPECT_EQ(statement("b S= TRUE;"), "main.st:2:3: expected := (write IF and := TRUE or FALSE), found 'S'");
  EXPECT_EQ(
      statement("x REF= y;"),
      "main.st:2:3: expected := (there are no references; VAR_IN_OUT passes a variable itself), found 'REF'");
  EXPECT_EQ(
      statement("INITIAL_STEP a: END_STEP"),
      "main.st:2:14: expected := (there is no sequential function chart; write a CASE over an enumeration), "
      "found 'a'");
  EXPECT_EQ(
      statement("ACTION a: ; END_ACTION"),
      "main.st:2:1: expected a statement (there are no actions; write a METHOD of a function block), found "
      "'ACTION'");
  EXPECT_EQ(
      statement("LD x\nST y"),
      "main.st:2:4: expected := (lists of the standard are not there; write Structured Text), found 'x'");
  const auto type = [](const std::string& text) {
    return first_error("PROGRAM P VAR x : " + text + "; END_VAR END_PROGRAM");
  };
  EXPECT_EQ(
      type("POINTER TO INT"),
      "main.st:1:19: expected a type (there are no pointers; VAR_IN_OUT passes a variable itself), found "
      "'POINTER'");
  EXPECT_EQ(
      type("REFERENCE TO INT"),
      "main.st:1:19: expected a type (there are no references; VAR_IN_OUT passes a variable itself), found "
      "'REFERENCE'");
  EXPECT_EQ(
      first_error("TYPE u : UNION a : INT; END_UNION END_TYPE"),
      "main.st:1:10: expected a type (there is none; parts of a bit string are x.%B0, x.%W1), found 'UNION'");
  EXPECT_EQ(first_error("TYPE s EXTENDS t : STRUCT a : INT; END_STRUCT; END_TYPE"),
            "main.st:1:8: expected : (there is no inheritance), found 'EXTENDS'");
  EXPECT_EQ(first_error("FUNCTION_BLOCK b EXTENDS a END_FUNCTION_BLOCK"),
            "main.st:1:18: expected VAR or statements (there is no inheritance), found 'EXTENDS'");
  EXPECT_EQ(
      first_error("FUNCTION_BLOCK ABSTRACT b END_FUNCTION_BLOCK"),
      "main.st:1:16: expected the name of the function block (there is no inheritance), found 'ABSTRACT'");
}

TEST(ExportedPrograms, Configuration_IsOneMistake_AndNamesThePlantFile) {
  EXPECT_EQ(errors_of("PROGRAM Main VAR x : INT; END_VAR x := 1; END_PROGRAM\n"
                      "CONFIGURATION c\nVAR_GLOBAL g : INT; END_VAR\nRESOURCE r ON PLC\n"
                      "TASK t(INTERVAL := T#20ms, PRIORITY := 0);\nPROGRAM i WITH t : Main;\nEND_RESOURCE\n"
                      "END_CONFIGURATION\n"),
            "main.st:2:1: expected PROGRAM, FUNCTION, FUNCTION_BLOCK, TYPE or VAR_GLOBAL (tasks are "
            "[[plc.task]] of "
            "the plant file; VAR_GLOBAL stands by itself), found 'CONFIGURATION'\n");
  EXPECT_EQ(errors_of("INTERFACE i METHOD m END_METHOD END_INTERFACE"),
            "main.st:1:1: expected PROGRAM, FUNCTION, FUNCTION_BLOCK, TYPE or VAR_GLOBAL (there is no "
            "inheritance), "
            "found 'INTERFACE'\n");
}

TEST(ExportedPrograms, SectionsOfCodesys_AreOneMistakeEach) {
  EXPECT_EQ(errors_of("FUNCTION_BLOCK b\nVAR_STAT x : INT; END_VAR\nVAR_INST y : INT; END_VAR\nx := y;\n"
                      "END_FUNCTION_BLOCK"),
            "main.st:2:1: expected VAR, found 'VAR_STAT'\nmain.st:3:1: expected VAR, found 'VAR_INST'\n");
}

}  // namespace
}  // namespace exported_programs_test
