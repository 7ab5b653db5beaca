// An EDS as a node's DCF: judged by the reader of device files, and line by line.

#include "canopus/eds/configuration_text.hpp"

#include <gtest/gtest.h>

#include "eds/reading.hpp"

namespace canopus::eds::configuration_text_test {
namespace {

using namespace canopus::eds;
using namespace canopus::eds::test;

std::string error_of(IniText& file, std::uint16_t index, std::uint8_t sub, std::string_view value) {
  const auto done = set_parameter_value(file, index, sub, value);
  return done ? "" : done.error();
}

const std::string compact = with_object(
    "[2000]\nParameterName=C\nObjectType=8\nDataType=5\nAccessType=rw\nLowLimit=1\nHighLimit=9\n"
    "DefaultValue=3\nCompactSubObj=12\n; end\n");

Commissioning node_5() {
  Commissioning commissioning;
  commissioning.node_id = 5;
  commissioning.node_name = "Pump";
  commissioning.bit_rate = 250'000;
  return commissioning;
}

TEST(ConfigurationText, EdsOfANode_IsTheEdsAndWhoItIsFor) {
  const auto dcf = make_configuration(base, {"pump.dcf", "a.eds"}, node_5());
  ASSERT_TRUE(dcf) << dcf.error();
  std::string expected = base;
  expected.replace(expected.find("FileName=a.eds\n"), 15, "FileName=pump.dcf\nLastEDS=a.eds\n");
  EXPECT_EQ(dcf->text(), expected + "\n[DeviceComissioning]\nNodeID=5\nNodeName=Pump\nBaudrate=250\n");
  const ReadResult read = read_device_file(dcf->text());
  ASSERT_NE(read.file, nullptr);
  EXPECT_EQ(read.file->commissioning->node_id, 5);
  EXPECT_EQ(read.file->commissioning->bit_rate, 250'000U);
  EXPECT_EQ(read.file->file.last_eds, "a.eds");
}

TEST(ConfigurationText, DcfForAnotherNode_DiffersInItsLineAlone) {
  const std::string before = base + "[DeviceCommissioning]\nNodeID=4 ; was 3\nNodeName=Pump\nBaudrate=250\n";
  const auto dcf = make_configuration(before, {}, node_5());
  ASSERT_TRUE(dcf) << dcf.error();
  std::string expected = before;
  expected.replace(expected.find("NodeID=4"), 8, "NodeID=5");
  EXPECT_EQ(dcf->text(), expected) << "spelt with two m: as the file has it";
}

TEST(ConfigurationText, UnusableEdsOrNode_IsRefused) {
  EXPECT_EQ(make_configuration("<html>", {}, node_5()).error().substr(0, 8), "line 1: ");
  Commissioning other = node_5();
  other.node_id = 128;
  EXPECT_EQ(make_configuration(base, {}, other).error(), "a node-ID is 1 to 127");
  other.node_id.reset();
  EXPECT_EQ(make_configuration(base, {}, other).error(), "a node-ID is 1 to 127");
  other = node_5();
  other.node_name = "a\n[1000]\nb";
  EXPECT_TRUE(make_configuration(base, {}, other).error().starts_with("NodeName: value \"a"));
  other.node_name = std::string(247, 'x');
  EXPECT_TRUE(make_configuration(base, {}, other).error().ends_with("a name has at most 246 letters"));
}

TEST(ConfigurationText, ValueOfAVariable_IsOneMoreLine_ThenOneOtherLine) {
  IniText file(with_variable("DataType=6\nDefaultValue=3\n\n; end\n"));
  ASSERT_EQ(error_of(file, 0x2000, 0, "0x1234"), "");
  EXPECT_EQ(file.text(), with_variable("DataType=6\nDefaultValue=3\nParameterValue=0x1234\n\n; end\n"));
  ASSERT_EQ(error_of(file, 0x2000, 0, "7"), "");
  EXPECT_EQ(file.text(), with_variable("DataType=6\nDefaultValue=3\nParameterValue=7\n\n; end\n"));
  const ReadResult read = read_device_file(file.text());
  EXPECT_EQ(value(read, 0x2000), (std::vector<std::uint8_t>{7, 0}));
  EXPECT_TRUE(read.file->find_facts(0x2000, 0)->configured);
}

TEST(ConfigurationText, ValueOfASubIndex_StandsInItsSection) {
  IniText file(base);
  ASSERT_EQ(error_of(file, 0x1018, 1, "0x2E5"), "");
  EXPECT_EQ(file.text(), base + "ParameterValue=0x2E5\n");
}

TEST(ConfigurationText, ValueOfACompactMember_StandsInItsList) {
  IniText file(compact);
  ASSERT_EQ(error_of(file, 0x2000, 12, "5"), "");
  EXPECT_EQ(file.text(), compact + "\n[2000Value]\nNrOfEntries=1\n12=5\n");
  ASSERT_EQ(error_of(file, 0x2000, 2, "6"), "");
  ASSERT_EQ(error_of(file, 0x2000, 12, "7"), "");
  EXPECT_EQ(file.text(), compact + "\n[2000Value]\nNrOfEntries=2\n12=7\n2=6\n");
  const ReadResult read = read_device_file(file.text());
  EXPECT_EQ(value(read, 0x2000, 12), std::vector<std::uint8_t>{7});
  EXPECT_EQ(value(read, 0x2000, 3), std::vector<std::uint8_t>{3});
  EXPECT_TRUE(read.file->find_facts(0x2000, 2)->configured);
  EXPECT_FALSE(read.file->find_facts(0x2000, 3)->configured);
}

TEST(ConfigurationText, ValueThatDoesNotFit_IsRefused_AndChangesNothing) {
  IniText file(with_variable("DataType=5\nLowLimit=2\nHighLimit=0x10\n"));
  const std::string before = file.text();
  EXPECT_TRUE(error_of(file, 0x2000, 0, "256").starts_with("ParameterValue=256 of 2000:00 "));
  EXPECT_TRUE(error_of(file, 0x2000, 0, "many").starts_with("ParameterValue=many of 2000:00 "));
  EXPECT_EQ(error_of(file, 0x2000, 0, "1"), "ParameterValue=1 of 2000:00 is below its LowLimit");
  EXPECT_EQ(error_of(file, 0x2000, 0, "17"), "ParameterValue=17 of 2000:00 is above its HighLimit");
  EXPECT_EQ(error_of(file, 0x2000, 0, " "), "no value is given for 2000:00");
  EXPECT_EQ(error_of(file, 0x2001, 0, "1"), "the file has no object 2001H");
  EXPECT_EQ(error_of(file, 0x2000, 1, "1"), "the file has no sub-index 2000:01");
  EXPECT_NE(error_of(file, 0x2000, 0, "2\n[1000]"), "");
  EXPECT_EQ(file.text(), before);
  EXPECT_EQ(error_of(file, 0x2000, 0, "16"), "");

  IniText list(compact);
  EXPECT_EQ(error_of(list, 0x2000, 12, "10"), "ParameterValue=10 of 2000:0C is above its HighLimit");
  EXPECT_EQ(error_of(list, 0x2000, 13, "5"), "the file has no sub-index 2000:0D");
  EXPECT_TRUE(error_of(list, 0x2000, 0, "5").starts_with("the file has no section for 2000:00"));
  EXPECT_EQ(list.text(), compact);
}

}  // namespace
}  // namespace canopus::eds::configuration_text_test
