// Device files of either kind, changed in place: line by line, and judged by the reader of device files.

#include "canopus/eds/files/device_text.hpp"

#include <filesystem>

#include <gtest/gtest.h>
// rapidcheck/gtest.h wants GoogleTest before it
#include <rapidcheck/gtest.h>

#include "eds/reading.hpp"
#include "eds/xdd_text.hpp"
#include "paths.hpp"

namespace canopus::eds::device_text_test {
namespace {

using namespace canopus::eds;
using namespace canopus::eds::test;

std::string error_of(const DeviceText::Done& done) { return done ? "" : done.error(); }

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The lines that are not the same, as "before -> after"; lines that one text has more are named as such.
std::string changes(const std::string& before, const std::string& after) {
  const auto a = lines_of(before);
  const auto b = lines_of(after);
  std::string text;
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() || j < b.size()) {
    if (i < a.size() && j < b.size() && a[i] == b[j]) {
      ++i, ++j;
    } else if (b.size() - j > a.size() - i && (i == a.size() || (j + 1 < b.size() && a[i] == b[j + 1]))) {
      text += "+ " + b[j++] + '\n';
    } else if (i == a.size() || j == b.size()) {
      return text + "too many lines differ\n";
    } else {
      text += a[i++] + " -> " + b[j++] + '\n';
    }
  }
  return text;
}

const std::string variable =
    "<CANopenObject index='2000' name='V' objectType='7' dataType='0005' accessType='rw' highLimit='9' "
    "defaultValue='3' />\n";

TEST(DeviceText, FileOfAForeignTool_UnchangedIsTheSameBytes) {
  for (const std::string& text :
       {xdd(variable), std::string("\xEF\xBB\xBF") + xdd(""), base, std::string("<a>"),
        std::string("\xFF\xFE<\0a\0", 6), std::string("<a b='\xFF'/>"), std::string()}) {
    EXPECT_EQ(DeviceText(text).text(), text);
  }
}

TEST(DeviceText, ValueOfAnXdd_IsOneAttributeMore) {
  const std::string before = xdd(variable);
  DeviceText file(before);
  EXPECT_EQ(error_of(file.set_parameter_value(0x2000, 0, "5")), "");
  EXPECT_EQ(changes(before, file.text()), variable.substr(0, variable.size() - 1) + " -> " +
                                              variable.substr(0, variable.size() - 4) +
                                              " actualValue=\"5\" />\n");
  const ReadResult read = read_device_file(file.text());
  EXPECT_EQ(value(read, 0x2000), (std::vector<std::uint8_t>{5}));
  EXPECT_TRUE(read.file->find_facts(0x2000, 0)->configured);
  EXPECT_EQ(error_of(file.set_parameter_value(0x2000, 0, "6")), "");
  EXPECT_NE(file.text().find(" actualValue=\"6\" />"), std::string::npos);
  EXPECT_EQ(error_of(file.remove_parameter_value(0x2000, 0)), "");
  EXPECT_EQ(file.text(), before);
}

TEST(DeviceText, ValueOfASubIndex_StandsInItsElement) {
  const std::string before = xdd("");
  DeviceText file(before);
  EXPECT_EQ(error_of(file.set_parameter_value(0x1018, 1, "0x11")), "");
  EXPECT_EQ(changes(before, file.text()),
            "<CANopenSubObject subIndex=\"01\" name=\"Vendor\" objectType=\"7\" dataType=\"0007\" "
            "accessType=\"ro\" "
            "defaultValue=\"1\"/> -> <CANopenSubObject subIndex=\"01\" name=\"Vendor\" objectType=\"7\" "
            "dataType=\"0007\" accessType=\"ro\" defaultValue=\"1\" actualValue=\"0x11\"/>\n");
}

TEST(DeviceText, UnusableValue_IsRefusedAndChangesNothing) {
  DeviceText file(xdd(variable));
  EXPECT_EQ(error_of(file.set_parameter_value(0x2000, 0, "x")),
            "actualValue=x of 2000:00 is not a number; expected 0 to 255");
  EXPECT_EQ(error_of(file.set_parameter_value(0x2000, 0, "10")),
            "actualValue=10 of 2000:00 is above its HighLimit");
  EXPECT_EQ(error_of(file.set_parameter_value(0x2000, 0, " ")), "no value is given for 2000:00");
  EXPECT_EQ(error_of(file.set_parameter_value(0x2000, 1, "1")), "the file has no sub-index 2000:01");
  EXPECT_EQ(error_of(file.set_parameter_value(0x3000, 0, "1")), "the file has no sub-index 3000:00");
  EXPECT_EQ(error_of(file.remove_parameter_value(0x3000, 0)), "the file has no sub-index 3000:00");
  EXPECT_EQ(file.text(), xdd(variable));
}

TEST(DeviceText, SubIndexThatTheReaderMade_HasNoPlaceForAValue) {
  DeviceText file(
      xdd("<CANopenObject index=\"2000\" name=\"A\" objectType=\"8\">\n<CANopenSubObject subIndex=\"01\" "
          "name=\"B\" dataType=\"0005\" accessType=\"rw\"/></CANopenObject>\n"));
  EXPECT_EQ(error_of(file.set_parameter_value(0x2000, 0, "1")),
            "the file has no element for 2000:00, so no place for its value");
}

const std::string parameter =
    "<ApplicationProcess><parameterList>\n"
    "<parameter uniqueID=\"P\" access=\"readWrite\"><USINT/><defaultValue value=\"1\"/>\n"
    "<actualValue value=\"2\"/>\n"
    "</parameter></parameterList></ApplicationProcess>";

std::string referring(const std::string& index) {
  return "<CANopenObject index=\"" + index + "\" name=\"V\" objectType=\"7\" uniqueIDRef=\"P\"/>\n";
}

TEST(DeviceText, ValueOfTheParameter_IsChangedWhereItStands) {
  const std::string before = xdd(referring("2000"), parameter);
  DeviceText file(before);
  EXPECT_EQ(error_of(file.set_parameter_value(0x2000, 0, "4")), "");
  EXPECT_EQ(changes(before, file.text()), "<actualValue value=\"2\"/> -> <actualValue value=\"4\"/>\n");
}

TEST(DeviceText, ValueOfTheParameter_IsTakenOutWithItsLine) {
  const std::string before = xdd(referring("2000"), parameter);
  const auto without = [&](const std::string& value, const std::string& rest) {
    std::string text = before;
    return text.replace(text.find("<actualValue value=\"2\"/>\n"), 25, value + rest);
  };
  for (const std::string& value :
       {std::string("<actualValue value=\"2\"/>"), std::string(" <actualValue value='2' />\t\r"),
        std::string("<actualValue value=\"2\"></actualValue>"),
        std::string(
            "<actualValue value=\"2\" offset=\"/>\"><label lang=\"en\">two</label></actualValue >")}) {
    DeviceText file(without(value, "\n"));
    EXPECT_EQ(error_of(file.remove_parameter_value(0x2000, 0)), "");
    EXPECT_EQ(file.text(), without("", "")) << value;
    EXPECT_EQ(test::value(read_device_file(file.text()), 0x2000), (std::vector<std::uint8_t>{1}));
  }
  DeviceText beside(without("<actualValue value=\"2\"/><!-- two -->", "\n"));
  EXPECT_EQ(error_of(beside.remove_parameter_value(0x2000, 0)), "");
  EXPECT_EQ(beside.text(), without("<!-- two -->", "\n"));
}

TEST(DeviceText, ParameterOfTwoObjects_IsLeftAlone) {
  const std::string before = xdd(referring("2000") + referring("2001"), parameter);
  DeviceText file(before);
  EXPECT_EQ(error_of(file.set_parameter_value(0x2000, 0, "4")), "");
  const ReadResult read = read_device_file(file.text());
  EXPECT_EQ(value(read, 0x2000), (std::vector<std::uint8_t>{4}));
  EXPECT_EQ(value(read, 0x2001), (std::vector<std::uint8_t>{2}));
}

Commissioning node_5() {
  Commissioning commissioning;
  commissioning.node_id = 5;
  commissioning.node_name = "Pump \"A\" & B";
  commissioning.bit_rate = 250'000;
  return commissioning;
}

TEST(DeviceText, XddOfANode_IsTheXddAndWhoItIsFor) {
  const std::string before = xdd(variable);
  const auto xdc = make_device_configuration(before, {"pump.xdc", "a.xdd"}, node_5());
  ASSERT_TRUE(xdc) << xdc.error();
  EXPECT_EQ(changes(before, xdc->text()),
            "<ProfileBody xsi:type=\"ProfileBody_Device_CANopen\" fileName=\"a.xdd\" fileCreator=\"me\" -> "
            "<ProfileBody xsi:type=\"ProfileBody_Device_CANopen\" fileName=\"pump.xdc\" fileCreator=\"me\"\n"
            "<ProfileBody xsi:type=\"ProfileBody_CommunicationNetwork_CANopen\" fileName=\"a.xdd\"> -> "
            "<ProfileBody xsi:type=\"ProfileBody_CommunicationNetwork_CANopen\" fileName=\"pump.xdc\">\n"
            "+   <deviceCommissioning nodeID=\"5\" nodeName=\"Pump &quot;A&quot; &amp; B\" "
            "actualBaudRate=\"250 Kbps\" "
            "networkNumber=\"0\" networkName=\"\" CANopenManager=\"false\"/>\n");
  const ReadResult read = read_device_file(xdc->text());
  ASSERT_NE(read.file, nullptr);
  EXPECT_EQ(read.file->commissioning->node_id, 5);
  EXPECT_EQ(read.file->commissioning->node_name, "Pump \"A\" & B");
  EXPECT_EQ(read.file->commissioning->bit_rate, 250'000U);
}

TEST(DeviceText, XdcForAnotherNode_DiffersInOneLine) {
  const auto first = make_device_configuration(xdd(""), {}, node_5());
  Commissioning other;
  other.node_id = 6;
  const auto second = make_device_configuration(first->text(), {}, other);
  ASSERT_TRUE(second) << second.error();
  std::string expected = first->text();
  expected.replace(expected.find("nodeID=\"5\""), 10, "nodeID=\"6\"");
  EXPECT_EQ(second->text(), expected);
}

TEST(DeviceText, EdsOfANode_IsMadeAsBefore) {
  const auto dcf = make_device_configuration(base, {"pump.dcf", "a.eds"}, node_5());
  ASSERT_TRUE(dcf) << dcf.error();
  EXPECT_EQ(dcf->text(), make_configuration(base, {"pump.dcf", "a.eds"}, node_5())->text());
  DeviceText file(base);
  EXPECT_FALSE(file.is_xml());
  EXPECT_EQ(error_of(file.set_parameter_value(0x1018, 1, "7")), "");
  EXPECT_EQ(changes(base, file.text()), "+ ParameterValue=7\n");
  EXPECT_EQ(error_of(file.remove_parameter_value(0x1018, 1)), "");
  EXPECT_EQ(file.text(), base);
}

TEST(DeviceText, UnusableXddOrNode_IsRefused) {
  EXPECT_EQ(make_device_configuration("<html>", {}, node_5()).error().substr(0, 38),
            "line 1: this cannot be read as XML: an");
  EXPECT_EQ(make_device_configuration("<a/>", {}, node_5()).error().substr(0, 26),
            "line 1: the root element i");
  Commissioning other = node_5();
  other.node_id = 128;
  EXPECT_EQ(make_device_configuration(xdd(""), {}, other).error(), "a node-ID is 1 to 127");
  other = node_5();
  other.node_name = std::string(247, 'x');
  EXPECT_NE(make_device_configuration(xdd(""), {}, other).error().find("at most 246 letters"),
            std::string::npos);
  other.node_name = "a\x01";
  EXPECT_EQ(make_device_configuration(xdd(""), {}, other).error(),
            "nodeName: the value has characters that XML cannot say, or is not UTF-8 text");
  other = node_5();
  other.lss_serial_number = 1;
  EXPECT_EQ(make_device_configuration(xdd(""), {}, other).error(),
            "an XDC has no place for an LSS serial number");
}

TEST(DeviceText, IniTextOfAnXdd_IsNotChanged) {
  EXPECT_EQ(make_configuration(xdd(""), {}, node_5()).error(),
            "line 1: this is XML, an XDD or XDC, and no EDS or DCF");
  IniText file(xdd(variable));
  EXPECT_FALSE(set_parameter_value(file, 0x2000, 0, "5"));
  EXPECT_FALSE(remove_parameter_value(file, 0x2000, 0));
  EXPECT_EQ(file.text(), xdd(variable));
}

TEST(DeviceText, LatinFile_StaysLatin) {
  std::string before = xdd(variable);
  before.replace(before.find("UTF-8"), 5, "ISO-8859-1");
  before.replace(before.find("name='V'"), 8, "name='K\xFChler'");
  Commissioning node = node_5();
  node.node_name = "\xC3\x84";
  DeviceText file(before);
  EXPECT_EQ(error_of(file.set_parameter_value(0x2000, 0, "5")), "");
  EXPECT_EQ(error_of(file.configure({}, node)), "");
  EXPECT_NE(file.text().find("name='K\xFChler'"), std::string::npos);
  EXPECT_NE(file.text().find("nodeName=\"&#196;\""), std::string::npos);
  EXPECT_EQ(read_device_file(file.text()).file->commissioning->node_name, "\xC3\x84");
}

TEST(DeviceText, Utf16File_IsNotChanged) {
  std::string wide = "\xFF\xFE";
  for (const char c : xdd(variable)) (wide += c) += '\0';
  DeviceText file(wide);
  EXPECT_EQ(error_of(file.set_parameter_value(0x2000, 0, "5")),
            "the file is UTF-16 text: save it as UTF-8 before it is changed");
  EXPECT_EQ(file.text(), wide);
}

TEST(DeviceText, WindowsLineEnds_Stay) {
  std::string before;
  for (const char c : xdd(variable)) before += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const auto xdc = make_device_configuration(before, {}, node_5());
  ASSERT_TRUE(xdc) << xdc.error();
  EXPECT_EQ(std::ranges::count(xdc->text(), '\n'), std::ranges::count(before, '\n') + 1);
  EXPECT_EQ(std::ranges::count(xdc->text(), '\r'), std::ranges::count(xdc->text(), '\n'));
}

TEST(DeviceText, XddsOfForeignTools_ChangeInOneLine) {
  const std::filesystem::path folder = CANOPUS_SOURCE_DIR "/../shared/data/eds";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no device files in " << folder;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".xdd") continue;
    const std::string before = *read_text(entry.path());
    DeviceText file(before);
    EXPECT_EQ(file.text(), before);
    EXPECT_EQ(error_of(file.set_parameter_value(0x1001, 0, "1")), "") << entry.path();
    const std::string difference = changes(before, file.text());
    EXPECT_EQ(std::ranges::count(difference, '\n'), 1) << difference;
    EXPECT_EQ(value(read_device_file(file.text()), 0x1001), (std::vector<std::uint8_t>{1}));
    const auto xdc = make_device_configuration(before, {}, node_5());
    ASSERT_TRUE(xdc) << entry.path() << xdc.error();
    EXPECT_EQ(std::ranges::count(changes(before, xdc->text()), '\n'), 1) << entry.path();
    EXPECT_EQ(read_device_file(xdc->text()).file->commissioning->node_id, 5);
  }
}

RC_GTEST_PROP(DeviceText, AnyNameOfANode_IsReadAgain, ()) {
  Commissioning node = node_5();
  node.node_name = "N" + *rc::gen::container<std::string>(rc::gen::inRange<char>(' ', 127)) + "N";
  const auto xdc = make_device_configuration(xdd(variable), {}, node);
  RC_ASSERT(xdc.has_value());
  RC_ASSERT(read_device_file(xdc->text()).file->commissioning->node_name == node.node_name);
}

}  // namespace
}  // namespace canopus::eds::device_text_test
