// Files of a PLC's program that are no Structured Text: PLCopen XML, and global labels of an engineering tool.

#include "canopus/plant/label_file.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/plant/plcopen_source.hpp"
#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/serve/device_control.hpp"
#include "canopus/serve/program_view.hpp"

#include "support/plant_folder.hpp"

namespace canopus::plant::program_files_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

class ProgramFiles : public support::PlantFolder, public PlantObserver {
 protected:
  static std::string plant(const std::string& rest) {
    return "[[bus]]\nname = \"line1\"\nbit_rate = 250000\n[[plc]]\nname = \"plc1\"\nlisten = \"off\"\n" +
           rest;
  }
};

constexpr const char* project = R"(<?xml version="1.0" encoding="utf-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0201">
  <types>
    <dataTypes>
      <dataType name="Colour"><baseType><enum><values><value name="red"/><value name="green"/></values></enum></baseType></dataType>
      <dataType name="Pair"><baseType><struct>
        <variable name="a"><type><INT/></type></variable>
        <variable name="b"><type><string length="10"/></type><initialValue><simpleValue value="'x'"/></initialValue></variable>
      </struct></baseType></dataType>
    </dataTypes>
    <pous>
      <pou name="Twice" pouType="function">
        <interface>
          <returnType><INT/></returnType>
          <inputVars><variable name="n"><type><INT/></type></variable></inputVars>
        </interface>
        <body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">Twice := 2 * n;</xhtml></ST></body>
      </pou>
      <pou name="Main" pouType="program">
        <interface>
          <localVars retain="true">
            <variable name="n"><type><INT/></type><initialValue><simpleValue value="5"/></initialValue></variable>
          </localVars>
          <localVars>
            <variable name="list"><type><array><dimension lower="1" upper="3"/><baseType><INT/></baseType></array></type>
              <initialValue><arrayValue><value repetitionValue="2"><simpleValue value="7"/></value><value><simpleValue value="9"/></value></arrayValue></initialValue>
            </variable>
            <variable name="pair"><type><derived name="Pair"/></type></variable>
            <variable name="colour"><type><derived name="Colour"/></type></variable>
            <variable name="out" address="%MW0.3"><type><INT/></type></variable>
          </localVars>
        </interface>
        <body>
          <ST>
            <xhtml xmlns="http://www.w3.org/1999/xhtml">n := Twice(n);
IF n &gt; 5 THEN
  out := list[3]; // the last one
END_IF;
colour := green;</xhtml>
          </ST>
        </body>
      </pou>
    </pous>
  </types>
</project>
)";

TEST_F(ProgramFiles, PlcopenXml_IsExecuted) {
  write("main.xml", project);
  const auto made = load(plant("program = [\"main.xml\"]\nscan = \"10ms\"\n"), *this);
  ASSERT_NE(made, nullptr);
  made->power_on();
  const program::Machine& machine = made->program(0)->machine();
  EXPECT_EQ(machine.read("Main.n"), "10");
  EXPECT_EQ(machine.read("Main.list"), "[7, 7, 9]");
  EXPECT_EQ(machine.read("Main.pair.b"), "'x'");
  EXPECT_EQ(machine.read("Main.colour"), "green");
  std::uint16_t word = 0;
  ASSERT_TRUE(made->rack(0).read_words(plc::Device::d, 3, {&word, 1}, can::Time{}));
  EXPECT_EQ(word, 9);
}

TEST_F(ProgramFiles, PlcopenXml_MistakesHaveTheLinesOfTheFile) {
  std::string text = project;
  text.replace(text.find("list[3]"), 7, "lost[3]");
  write("main.xml", text);
  EXPECT_THAT(
      check(plant("program = [\"main.xml\"]\n")),
      ElementsAre("plant.toml:7:12: program = \"main.xml\": main.xml:37:10: there is no variable lost"));
  text = project;
  text.replace(text.find("<INT/>"), 6, "<INT2/>");
  write("main.xml", text);
  EXPECT_THAT(check(plant("program = [\"main.xml\"]\n")), ElementsAre(HasSubstr("main.xml:6:")));
}

/// As CODESYS exports a device: types and units in <addData> of the resource, methods in <addData> of their block.
constexpr const char* device_export = R"(<?xml version="1.0" encoding="utf-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0200">
  <types><dataTypes/><pous/></types>
  <instances><configurations><configuration name="Device"><resource name="Application">
    <globalVars name="Counts" constant="true">
      <variable name="most"><type><INT/></type><initialValue><simpleValue value="9"/></initialValue></variable>
      <variable name="sum"><type><INT/></type></variable>
      <addData><data name="http://www.3s-software.com/plcopenxml/mixedattrsvarlist" handleUnknown="implementation"><MixedAttrsVarList>
        <globalVars name="Counts" constant="true">
          <variable name="most"><type><INT/></type><initialValue><simpleValue value="9"/></initialValue></variable>
        </globalVars>
        <globalVars name="Counts" persistent="true"><variable name="sum"><type><INT/></type></variable></globalVars>
      </MixedAttrsVarList></data></addData>
    </globalVars>
    <addData>
      <data name="http://www.3s-software.com/plcopenxml/datatype" handleUnknown="implementation">
        <dataType name="Kind"><baseType><enum><values><value name="add" value="0"/><value name="clear" value="5"/></values></enum></baseType></dataType>
      </data>
      <data name="http://www.3s-software.com/plcopenxml/pou" handleUnknown="implementation">
        <pou name="Meter" pouType="functionBlock">
          <interface><localVars><variable name="total"><type><INT/></type></variable></localVars></interface>
          <actions><action name="Clear"><body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">total := 0; // all of it</xhtml></ST></body></action></actions>
          <body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">total := total + 1;
sum := Twice(total); // so far</xhtml></ST></body>
          <addData>
            <data name="http://www.3s-software.com/plcopenxml/method" handleUnknown="implementation">
              <Method name="Twice">
                <interface><returnType><INT/></returnType><inputVars><variable name="n"><type><INT/></type></variable></inputVars></interface>
                <body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">Twice := 2 * n;</xhtml></ST></body>
              </Method>
            </data>
          </addData>
        </pou>
      </data>
      <data name="http://www.3s-software.com/plcopenxml/pou" handleUnknown="implementation">
        <pou name="Main" pouType="program">
          <interface><localVars>
            <variable name="meter"><type><derived name="Meter"/></type></variable>
            <variable name="wanted"><type><derived name="Kind"/></type></variable>
          </localVars></interface>
          <body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">meter();
IF sum &gt; most THEN
  meter.Clear();
  wanted := Kind.clear;
END_IF</xhtml></ST></body>
        </pou>
      </data>
    </addData>
  </resource></configuration></configurations></instances>
</project>
)";

TEST_F(ProgramFiles, PlcopenXmlOfCodesys_UnitsMethodsActionsAndGlobalsOfTheDevice_AreExecuted) {
  write("main.xml", device_export);
  const auto made = load(plant("program = [\"main.xml\"]\nscan = \"10ms\"\n"), *this);
  ASSERT_NE(made, nullptr);
  made->power_on();
  const program::Machine& machine = made->program(0)->machine();
  EXPECT_EQ(machine.read("sum"), "2");
  made->timeline().run_until(made->timeline().now() + 45ms);
  EXPECT_EQ(machine.read("sum"), "10");
  EXPECT_EQ(machine.read("Main.wanted"), "clear");
}

TEST_F(ProgramFiles, PlcopenXmlOfCodesys_MistakesHaveTheLinesOfTheFile) {
  std::string text = device_export;
  text.replace(text.find("2 * n"), 5, "2 * m");
  text.replace(text.find("sum := Twice"), 3, "sun");
  write("main.xml", text);
  const auto errors = check(plant("program = [\"main.xml\"]\n"));
  EXPECT_THAT(errors, Contains(HasSubstr("main.xml:24:1: there is no variable sun")));
  EXPECT_THAT(errors, Contains(HasSubstr("main.xml:29:")));
}

TEST_F(ProgramFiles, StructuredTextInUtf16_IsReadWithAByteOrderMark) {
  const std::string text = "PROGRAM P VAR n : INT; END_VAR n := 7; END_PROGRAM";
  std::string little = "\xFF\xFE", big = "\xFE\xFF";
  for (const char c : text) {
    little += {c, '\0'};
    big += {'\0', c};
  }
  for (const std::string& bytes : {little, big}) {
    write("main.st", bytes);
    const auto made = load(plant("program = [\"main.st\"]\n"), *this);
    ASSERT_NE(made, nullptr);
    made->power_on();
    EXPECT_EQ(made->program(0)->machine().read("P.n"), "7");
  }
  write("main.st", little.substr(2));
  EXPECT_THAT(
      check(plant("program = [\"main.st\"]\n")),
      ElementsAre(
          "plant.toml:7:12: program = \"main.st\": there is a zero byte; expected UTF-8, or UTF-16 with "
          "a byte order mark"));
  write("MAIN.csv", little.substr(2));
  EXPECT_THAT(check(plant("program = [\"MAIN.csv\"]\n")),
              ElementsAre(HasSubstr("MAIN.csv:1:1: there is a zero byte")));
}

TEST_F(ProgramFiles, AMistakeWithALongName_IsCut) {
  write("main.st", "PROGRAM P " + std::string(100'000, 'x') + " := 1; END_PROGRAM");
  const auto errors = check(plant("program = [\"main.st\"]\n"));
  ASSERT_THAT(errors, ElementsAre(HasSubstr("main.st:1:11: there is no variable xxx")));
  EXPECT_LT(errors.front().size(), 700U);
}

TEST_F(ProgramFiles, ListWithLinesThatEndWithCarriageReturnsAlone_IsRead) {
  write("MAIN.csv",
        "\"MAIN\"\r\"0\",\"\",\"LD\",\"SM400\"\r\"1\",\"\",\"OUT\",\"M0\"\r\"2\",\"\",\"FOO\",\"M1\"\r\"3\","
        "\"\",\"END\",\"\"\r");
  EXPECT_THAT(check(plant("program = [\"MAIN.csv\"]\n")), ElementsAre(HasSubstr("MAIN.csv:4:1: 'FOO'")));
}

TEST(PlcopenSource, WhatIsNoStructuredText_IsRefusedWithItsPlace) {
  const auto errors = [](std::string_view text) {
    std::vector<std::string> all;
    for (const auto& error : structured_text_of_plcopen("a.xml", text).errors)
      all.push_back(std::to_string(error.line) + ": " + error.message);
    return all;
  };
  const auto pou = [](const std::string& attributes, const std::string& inner) {
    return "<project><types><pous>\n<pou " + attributes + ">" + inner + "</pou></pous></types></project>";
  };
  EXPECT_THAT(errors("<a/>"), ElementsAre("1: expected PLCopen XML: <project>"));
  EXPECT_EQ(errors("<project>").size(), 1U);
  EXPECT_THAT(errors("<project/>"), ElementsAre("1: expected a <pou> with a body of <ST>"));
  EXPECT_THAT(errors(pou("name='P' pouType='program'", "<body><LD/></body>")),
              ElementsAre("2: the body of P is <LD>; expected <ST>"));
  EXPECT_THAT(errors(pou("name='P' pouType='program'", "")),
              ElementsAre("2: the body of P is missing; expected <ST>"));
  EXPECT_THAT(errors(pou("name='P' pouType='class'", "")),
              ElementsAre("2: pouType: expected program, functionBlock or function"));
  const std::string vendor = "http://www.3s-software.com/plcopenxml/";
  const auto with_data = [&](const std::string& kind, const std::string& inner) {
    return errors(pou("name='P' pouType='functionBlock'", "<body><ST/></body><addData><data name='" + vendor +
                                                              kind + "'>" + inner + "</data></addData>"));
  };
  EXPECT_THAT(with_data("pouinheritance", "<Inheritance/>"),
              ElementsAre("2: EXTENDS and IMPLEMENTS of P are not there; expected a block of its own"));
  EXPECT_THAT(with_data("property", "<Property name='speed'/>"),
              ElementsAre("2: property speed is not there; expected methods"));
  EXPECT_THAT(with_data("method", "<Method name='FB_Init'/>"),
              ElementsAre("2: FB_Init is not called by itself here; expected initial values"));
  EXPECT_THAT(with_data("method", "<Method name='m'><body><FBD/></body></Method>"),
              ElementsAre("2: the body of m is <FBD>; expected <ST>"));
  EXPECT_THAT(
      errors(pou("name='P' pouType='program'",
                 "<actions><action name='a'><body><ST/></body></action></actions><body><ST/></body>")),
      ElementsAre(
          "2: action a: only a function block has actions; expected its statements in the body of P"));
  EXPECT_THAT(
      errors(
          "<project><types><dataTypes><dataType name='s'><baseType><INT/></baseType><addData><data name='" +
          vendor +
          "datatypeinheritance'/></addData></dataType></dataTypes><pous><pou name='P' "
          "pouType='program'><body><ST/></body></pou></pous></types></project>"),
      ElementsAre("1: EXTENDS of s is not there; expected a STRUCT with all its elements"));
  EXPECT_THAT(errors(pou("name='P; END_PROGRAM' pouType='program'", "<body><ST/></body>")),
              ElementsAre("2: name: expected a name of letters, digits and _"));
  EXPECT_THAT(
      errors(pou("name='P' pouType='program'",
                 "<interface><localVars><variable name='n'><type><INT/></type><initialValue><simpleValue "
                 "value='1; m : INT'/></initialValue></variable></localVars></interface><body><ST/></body>")),
      ElementsAre("2: expected one value"));
  const auto with_value = [&](const std::string& value) {
    return errors(pou("name='P' pouType='program'",
                      "<interface><localVars><variable name='n'><type><INT/></type><initialValue>"
                      "<simpleValue value='" +
                          value + "'/></initialValue></variable></localVars></interface><body><ST/></body>"));
  };
  EXPECT_THAT(with_value("1 /* and all that follows"), ElementsAre("2: expected one value"));
  const std::string long_text(4'000'000, ';');
  EXPECT_THAT(errors(pou("name='P' pouType='program'", "<body><ST>" + long_text + "</ST></body>")),
              ElementsAre("1: expected at most 4000000 bytes of Structured Text"));
}

TEST_F(ProgramFiles, Labels_AreVariablesAtTheirDevices) {
  write("labels.csv",
        "\"Class\"\t\"Label Name\"\t\"Data Type\"\t\"Constant\"\t\"Device\"\t\"Comment\"\r\n"
        "\"VAR_GLOBAL\"\t\"speed\"\t\"Word [Signed]\"\t\"\"\t\"D100\"\t\"of the \"\"belt\"\"\"\r\n"
        "\"VAR_GLOBAL\"\t\"total\"\t\"Double Word [Signed]\"\t\"\"\t\"D102\"\t\"\"\r\n"
        "\"VAR_GLOBAL\"\t\"on\"\t\"Bit\"\t\"\"\t\"M5\"\t\"\"\r\n"
        "\"VAR_GLOBAL_CONSTANT\"\t\"step\"\t\"Word [Signed]\"\t\"-3\"\t\"\"\t\"\"\r\n"
        "\"VAR_GLOBAL\"\t\"text\"\t\"String(8)\"\t\"\"\t\"\"\t\"\"\r\n");
  write("main.st",
        "PROGRAM P\nspeed := speed + step;\ntotal := total - 100000;\non := TRUE;\ntext := "
        "'ok';\nEND_PROGRAM\n");
  const auto made =
      load(plant("program = [\"main.st\"]\nlabels = [\"labels.csv\"]\nscan = \"10ms\"\n"), *this);
  ASSERT_NE(made, nullptr);
  made->power_on();
  serve::DeviceControl control(*made);
  EXPECT_EQ(control.answer(R"({"request": "read variable", "name": "Speed"})"),
            "{\"ok\":true,\"t\":0.0,\"name\":\"speed\",\"type\":\"INT\",\"value\":\"-3\",\"forced\":false,"
            "\"device\":"
            "\"D100\",\"comment\":\"of the \\\"belt\\\"\"}\n");
  EXPECT_THAT(control.answer(R"({"request": "read variable", "name": "total"})"), HasSubstr("\"-100000\""));
  EXPECT_THAT(control.answer(R"({"request": "read variable", "name": "on"})"), HasSubstr("\"TRUE\""));
  EXPECT_THAT(control.answer(R"({"request": "read variable", "name": "text"})"), HasSubstr("'ok'"));
  EXPECT_THAT(control.answer(R"({"request": "write variable", "name": "total", "value": -5})"),
              HasSubstr("\"value\":\"-5\""));
  std::array<std::uint16_t, 2> words{};
  ASSERT_TRUE(made->rack(0).read_words(plc::Device::d, 102, words, can::Time{}));
  EXPECT_THAT(words, ElementsAre(0xFFFB, 0xFFFF));
  EXPECT_THAT(control.answer(R"({"request": "write variable", "name": "speed", "value": 70000})"),
              HasSubstr("value: expected INT"));
  EXPECT_THAT(control.answer(R"({"request": "force variable", "name": "speed", "value": 7})"),
              HasSubstr("name: \\\"speed\\\" stands for D100: a device cannot be forced"));
  EXPECT_THAT(control.answer(R"({"request": "program", "file": "main.st", "from": 2, "count": 1})"),
              HasSubstr("\"column\":1,\"length\":5,\"name\":\"D100\",\"type\":\"WORD\",\"value\":\"65533\","
                        "\"device\":true"));
}

TEST_F(ProgramFiles, CommentsOfLabels_AreThoseOfTheVariables) {
  write("global.csv",
        "Class,Label Name,Data Type,Constant,Device,Comment\n"
        "VAR_GLOBAL,speed,Word [Signed],,D100,of the belt\nVAR_GLOBAL,total,Word [Signed],,,parts in all\n");
  write("labels/MAIN.csv",
        "Class,Label Name,Data Type,Constant,Device,Comment\nVAR,last,Word [Signed],,,the one before\n");
  write("MAIN.csv",
        "0,,LD,SM400\n1,,MOV,K7\n,,,last\n2,,MOV,last\n,,,total\n3,,MOV,total\n,,,speed\n4,,END,\n");
  const auto made = load(
      plant("program = [\"MAIN.csv\"]\nlabels = [\"global.csv\", \"labels/MAIN.csv\"]\nscan = \"10ms\"\n"),
      *this);
  ASSERT_NE(made, nullptr);
  made->power_on();
  serve::DeviceControl control(*made);
  EXPECT_THAT(control.answer(R"({"request": "variables"})"),
              HasSubstr(R"({"name":"total","type":"INT","value":"7","comment":"parts in all"})"));
  const auto listed = [&](std::string_view find) {
    return serve::program_variables(*made, 0, find, 0, 10).dump();
  };
  EXPECT_THAT(listed(""), testing::AllOf(HasSubstr(R"("comment":"parts in all")"), HasSubstr(R"("of":3)"),
                                         HasSubstr(R"("comment":"the one before")")));
  EXPECT_EQ(listed("belt"),
            R"({"from":0,"rows":[{"name":"speed","type":"INT","value":"7","forced":false,"writable":true,)"
            R"("retain":false,"comment":"of the belt"}],"of":1})");
}

TEST_F(ProgramFiles, Labels_AreOperandsOfInstructionLists) {
  write("global.csv",
        "Class,Label Name,Data Type,Constant,Device,Comment\n"
        "VAR_GLOBAL,start,Bit,,M10,\nVAR_GLOBAL,total,Word [Signed],,,\nVAR_GLOBAL,delay,Timer,,T3,\n");
  write("labels/MAIN.csv",
        "Class,Label Name,Data Type,Constant,Device,Comment\n"
        "VAR,count,Word [Signed],,D100,of starts\nVAR_CONSTANT,step,Word [Signed],16#10,,\n"
        "VAR,last,Word [Signed],,,\n");
  write("MAIN.csv",
        "0,,LDI,start\n1,,+,step\n,,,count\n2,,MOV,count\n,,,last\n3,,MOV,last\n,,,total\n4,,OUT,delay\n,,,"
        "K5\n5,,END,\n");
  const auto made = load(
      plant("program = [\"MAIN.csv\"]\nlabels = [\"global.csv\", \"labels/MAIN.csv\"]\nscan = \"10ms\"\n"),
      *this);
  ASSERT_NE(made, nullptr);
  made->power_on();
  std::array<std::uint16_t, 1> words{};
  ASSERT_TRUE(made->rack(0).read_words(plc::Device::d, 100, words, can::Time{}));
  EXPECT_THAT(words, ElementsAre(16));
  EXPECT_EQ(made->program(0)->machine().read("total").value_or(""), "16");
  EXPECT_EQ(made->program(0)->machine().read("MAIN.last").value_or(""), "16");
  serve::DeviceControl control(*made);
  EXPECT_THAT(control.answer(R"({"request": "read variable", "name": "MAIN.count"})"),
              HasSubstr("\"value\":\"16\""));
}

TEST_F(ProgramFiles, LocalLabels_NeedTheirInstructionList) {
  write("main.st", "PROGRAM P D0 := 1; END_PROGRAM");
  write("OTHER.csv", "Class,Label Name,Data Type,Device\nVAR,count,Bit,M0\n");
  EXPECT_THAT(
      check(plant("program = [\"main.st\"]\nlabels = [\"OTHER.csv\"]\n")),
      ElementsAre("plant.toml:8:11: labels = \"OTHER.csv\": these are local labels (class VAR) of a program "
                  "OTHER; expected an instruction list OTHER.csv in program"));
}

TEST(LabelFile, QuotedFieldWithSeveralLines_KeepsTheLinesOfTheOthers) {
  const LabelFile made =
      read_labels("a.csv", "Label Name,Data Type,Device,Comment\nn,Bit,M1,\"two\nlines\"\nm,Bit,M2,\n");
  EXPECT_TRUE(made.errors.empty());
  EXPECT_EQ(made.text, "\nVAR_GLOBAL n AT M1 : BOOL; END_VAR\n\nVAR_GLOBAL m AT M2 : BOOL; END_VAR\n");
  const LabelFile broken = read_labels("a.csv", "Label Name,Data Type,Device\nn,Bit,\"M1\n");
  ASSERT_EQ(broken.errors.size(), 1U);
  EXPECT_EQ(broken.errors[0].message, "the quote that is opened in line 2 is not closed");
}

TEST_F(ProgramFiles, Labels_MistakesNameTheLine) {
  write("main.st", "PROGRAM P D0 := 1; END_PROGRAM");
  const std::string file = plant("program = [\"main.st\"]\nlabels = [\"labels.csv\"]\n");
  EXPECT_THAT(check(file),
              ElementsAre("plant.toml:8:11: labels = \"labels.csv\": No such file or directory"));
  write("labels.csv", "a,b\n");
  EXPECT_THAT(check(file),
              ElementsAre(HasSubstr("labels.csv:1:1: expected a row of titles with \"Label Name\"")));
  write("labels.csv", "Label Name,Data Type,Device\na b,Bit,M0\nx,Wort,D0\ny,Bit,M0;\nz,Bit,D99999999\n");
  EXPECT_THAT(check(file),
              ElementsAre(HasSubstr("labels.csv:2:1: label name \"a b\": expected letters, digits and _"),
                          HasSubstr("labels.csv:4:1: device \"M0;\": expected one such as D100")));
  write("labels.csv", "Label Name,Data Type,Device\nx,Wort,D0\n");
  EXPECT_THAT(check(file), ElementsAre(HasSubstr("labels.csv (labels):2:")));
  EXPECT_THAT(
      check(plant("program = [\"main.st\"]\nlabels = [\"labels.txt\"]\n")),
      ElementsAre(
          "plant.toml:8:11: labels = \"labels.txt\": expected up to 100 files of global labels, such as "
          "[\"labels.csv\"]"));
}

TEST(LabelFile, Utf16_IsRead) {
  const std::string_view text = "Label Name\tData Type\tDevice\nn\tBit\tM1\n";
  std::string bytes = "\xFF\xFE";
  for (const char c : text) bytes += std::string{c, '\0'};
  const LabelFile made = read_labels("a.csv", bytes);
  EXPECT_TRUE(made.errors.empty());
  EXPECT_EQ(made.text, "\nVAR_GLOBAL n AT M1 : BOOL; END_VAR\n");
  ASSERT_EQ(made.labels.size(), 1U);
  EXPECT_EQ(made.labels[0].device, "M1");
}

}  // namespace
}  // namespace canopus::plant::program_files_test
