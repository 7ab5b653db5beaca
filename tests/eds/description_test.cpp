// Descriptions of objects and sub-indexes: read from EDS and XDD, written in both.

#include <gmock/gmock.h>

#include "canopus/eds/files/losses.hpp"
#include "canopus/eds/files/xdd_writer.hpp"
#include "canopus/eds/writer.hpp"

#include "eds/reading.hpp"
#include "eds/xdd_text.hpp"

namespace canopus::eds::description_test {
namespace {

using namespace canopus::eds;
using namespace canopus::eds::test;
using testing::HasSubstr;
using testing::Not;

std::string description(const DeviceFile& file, std::uint16_t index, std::uint8_t sub = 0) {
  const EntryFacts* facts = file.find_facts(index, sub);
  return facts == nullptr ? "no such sub-index" : facts->description.text();
}
std::string object_description(const DeviceFile& file, std::uint16_t index) {
  const EntryFacts* facts = file.find_facts(index, 0);
  return facts == nullptr ? "no such object" : facts->object_description.text();
}

const std::string eds =
    base +
    "[ManufacturerObjects]\nSupportedObjects=3\n1=0x2000\n2=0x2001\n3=0x2002\n"
    "[2000]\nParameterName=Speed\nDataType=6\nAccessType=rw\nDescription=In rounds per minute; 0: off\n"
    "[2001]\nParameterName=Ramp\nObjectType=9\nSubNumber=2\nDescription=How it gets faster\n"
    "[2001sub0]\nParameterName=N\nDataType=5\nAccessType=ro\nDefaultValue=1\n"
    "[2001sub1]\nParameterName=Up\nDataType=0x16\nAccessType=rw\nDescription=<1/s\xC2\xB2>\n"
    "[2002]\nParameterName=Many\nObjectType=8\nDataType=5\nAccessType=rw\nCompactSubObj=9\nDescription=Nine "
    "of them\n";

void expect_descriptions(const DeviceFile& file) {
  EXPECT_EQ(description(file, 0x2000), "In rounds per minute; 0: off");
  EXPECT_EQ(object_description(file, 0x2000), "");
  EXPECT_EQ(object_description(file, 0x2001), "How it gets faster");
  EXPECT_EQ(description(file, 0x2001, 0), "");
  EXPECT_EQ(description(file, 0x2001, 1), "<1/s\xC2\xB2>");
  EXPECT_EQ(object_description(file, 0x2002), "Nine of them");
  EXPECT_EQ(description(file, 0x2002, 4), "");
  EXPECT_EQ(description(file, 0x1000), "");
}

TEST(Description, OfAnEds_IsKeptByEveryFormat) {
  const ReadResult read = read_device_file(eds);
  expect_descriptions(*read.file);
  const ReadResult eds_again = read_device_file(write_eds(*read.file).text);
  expect_descriptions(*eds_again.file);
  const std::string xdd_text = write_xdd(*read.file).text;
  const ReadResult xdd_again = read_device_file(xdd_text);
  expect_descriptions(*xdd_again.file);
  EXPECT_FALSE(xdd_again.has_losses()) << all_problems(xdd_again);
  expect_descriptions(*read_device_file(write_eds(*xdd_again.file).text).file);
  EXPECT_TRUE(beyond_device_file(xdd_text).empty());
  EXPECT_THAT(xdd_text, HasSubstr("<parameter uniqueID=\"UID_2001_01\">\n"
                                  "            <label lang=\"en\">Up</label>\n"
                                  "            <description lang=\"en\">&lt;1/s\xC2\xB2></description>\n"
                                  "            <BITSTRING/>\n"));
}

TEST(Description, OfAFileWithoutAny_WritesNoProcess) {
  EXPECT_THAT(write_xdd(*read_device_file(base).file).text, Not(HasSubstr("ApplicationProcess")));
}

TEST(Description, OfAnXdd_IsTheEnglishOne) {
  const std::string process =
      "<ApplicationProcess><parameterList><parameter uniqueID=\"P\">"
      "<label lang=\"de\">Drehzahl</label><label lang=\"en-us\">Speed</label>"
      "<description lang=\"de\">Umdrehungen</description><description lang=\"en\">Rounds</description><UINT/>"
      "</parameter><parameter uniqueID=\"Q\"><description lang=\"fr\">Tours</description><UINT/></parameter>"
      "</parameterList></ApplicationProcess>";
  const ReadResult read = read_device_file(
      xdd("<CANopenObject index=\"2000\" objectType=\"7\" uniqueIDRef=\"P\" accessType=\"rw\"/>\n"
          "<CANopenObject index=\"2001\" name=\"T\" objectType=\"7\" uniqueIDRef=\"Q\" accessType=\"rw\"/>\n",
          process));
  EXPECT_EQ(description(*read.file, 0x2000), "Rounds");
  EXPECT_EQ(read.file->dictionary->name(*read.file->dictionary->find(0x2000)), "Speed");
  EXPECT_EQ(description(*read.file, 0x2001), "Tours");
  EXPECT_TRUE(beyond_device_file(xdd("", process)).empty());
}

TEST(Description, WithLineEnds_BecomesOneLineOfAnEds_WithAWarning) {
  const std::string process =
      "<ApplicationProcess><parameterList><parameter uniqueID=\"P\"><description>* bit 0: on\n* bit 1: off"
      "</description><UINT/></parameter></parameterList></ApplicationProcess>";
  const ReadResult read = read_device_file(
      xdd("<CANopenObject index=\"2000\" name=\"V\" objectType=\"7\" uniqueIDRef=\"P\" accessType=\"rw\"/>\n",
          process));
  EXPECT_EQ(description(*read.file, 0x2000), "* bit 0: on\n* bit 1: off");
  const WrittenFile written = write_eds(*read.file);
  EXPECT_THAT(written.text, HasSubstr("Description=* bit 0: on * bit 1: off\r\n"));
  EXPECT_THAT(written.warnings,
              testing::Contains("2000:00: Description has a line end or the like in it: a blank is written"));
  EXPECT_EQ(description(*read_device_file(write_xdd(*read.file).text).file, 0x2000),
            "* bit 0: on\n* bit 1: off");
}

}  // namespace
}  // namespace canopus::eds::description_test
