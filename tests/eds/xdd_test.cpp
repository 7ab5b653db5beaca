// XDD and XDC files [CiA 311] as device files.

#include <gtest/gtest.h>

#include "eds/reading.hpp"
#include "eds/xdd_text.hpp"

namespace canopus::eds::xdd_test {
namespace {

using namespace canopus;
using namespace canopus::eds;
using namespace canopus::eds::test;
using canopen::Access;
using canopen::DataType;
using Bytes = std::vector<std::uint8_t>;

canopen::Entry entry(const ReadResult& result, std::uint16_t index, std::uint8_t sub = 0) {
  return result.file->dictionary->find(index, sub);
}

std::string variable(std::string_view attributes) {
  return "<CANopenObject index=\"2000\" name=\"V\" objectType=\"7\" " + std::string(attributes) + "/>\n";
}

std::string first_problem(const ReadResult& result) {
  if (result.problems.empty()) return {};
  const Problem& found = result.problems.front();
  return std::to_string(found.line) + ": " + std::string(name(found.severity)) + ": " + found.message;
}

TEST(Xdd, LeastFile_IsADeviceWithoutAnyComplaint) {
  const ReadResult result = read_device_file(xdd(""));
  ASSERT_NE(result.file, nullptr);
  EXPECT_EQ(all_problems(result), "");
}

TEST(Xdd, DeviceAndFile_AreSaidAsAnEdsSaysThem) {
  const ReadResult result = read_device_file(xdd(""));
  ASSERT_NE(result.file, nullptr);
  const FileInfo& file = result.file->file;
  EXPECT_EQ(file.file_name, "a.xdd");
  EXPECT_EQ(file.created_by, "me");
  EXPECT_EQ(file.creation_date, "12-31-2025");
  EXPECT_EQ(file.creation_time, "04:49PM");
  EXPECT_EQ(file.version, 3U);
  EXPECT_EQ(file.revision, 1U);
  const DeviceInfo& device = result.file->device;
  EXPECT_EQ(device.vendor_name, "Pumps & Co");
  EXPECT_EQ(device.vendor_number, 1U);
  EXPECT_EQ(device.product_name, "P1");
  EXPECT_EQ(device.product_number, 2U);
  EXPECT_EQ(device.order_code, "P-1");
  EXPECT_EQ(device.bit_rates, (std::vector<std::uint32_t>{125'000, 1'000'000}));
  EXPECT_TRUE(device.lss);
  EXPECT_TRUE(device.simple_boot_up_slave);
  EXPECT_FALSE(device.simple_boot_up_master);
  EXPECT_EQ(device.granularity, 8);
  EXPECT_EQ(result.file->dummy_usage, 1U << 5);
  EXPECT_FALSE(result.file->commissioning);
}

TEST(Xdd, Object_HasItsTypeAccessValueLimitsAndName) {
  const ReadResult result = read_device_file(xdd(
      variable("dataType=\"0003\" accessType=\"rw\" defaultValue=\"-5\" lowLimit=\"-10\" highLimit=\"0x64\" "
               "PDOmapping=\"optional\" objFlags=\"0003\"")));
  ASSERT_NE(result.file, nullptr);
  const canopen::Entry found = entry(result, 0x2000);
  ASSERT_TRUE(found);
  EXPECT_EQ(found.description->type, DataType::integer16);
  EXPECT_EQ(found.description->access, Access::read_write);
  EXPECT_TRUE(found.description->rpdo_mappable && found.description->tpdo_mappable);
  EXPECT_EQ(value(result, 0x2000), (Bytes{0xFB, 0xFF}));
  EXPECT_EQ(result.file->dictionary->limits(found).low, static_cast<std::uint64_t>(-10));
  EXPECT_EQ(result.file->dictionary->limits(found).high, 100U);
  EXPECT_EQ(result.file->dictionary->name(found), "V");
  EXPECT_EQ(result.file->find_facts(0x2000, 0)->object_flags, 3U);
  EXPECT_EQ(result.file->find_facts(0x2000, 0)->line, xdd_object_line);
}

TEST(Xdd, SubIndexes_AreHexadecimal) {
  std::string object = "<CANopenObject index=\"2001\" name=\"A\" objectType=\"8\" subNumber=\"18\">\n";
  for (int sub = 0; sub <= 0x10; ++sub) {
    constexpr char digits[] = "0123456789ABCDEF";
    object += std::string("<CANopenSubObject subIndex=\"") + digits[sub / 16] + digits[sub % 16] +
              "\" name=\"S\" objectType=\"7\" dataType=\"0005\" accessType=\"rw\" defaultValue=\"" +
              std::to_string(sub == 0 ? 16 : sub) + "\"/>\n";
  }
  const ReadResult result = read_device_file(xdd(object + "</CANopenObject>\n"));
  EXPECT_EQ(result.file->dictionary->find(0x2001)->highest_sub, 0x10);
  EXPECT_EQ(value(result, 0x2001, 0x0A), (Bytes{10}));
  EXPECT_EQ(value(result, 0x2001, 0x10), (Bytes{16}));
}

struct Mapping {
  const char* access;
  const char* mapping;
  Access expected;
  bool rpdo;
  bool tpdo;
};
class XddMapping : public testing::TestWithParam<Mapping> {};

TEST_P(XddMapping, OfAnObject_SaysInWhichPdosItMayBe) {
  const Mapping& row = GetParam();
  const ReadResult result =
      read_device_file(xdd(variable("dataType=\"0005\" accessType=\"" + std::string(row.access) +
                                    "\" PDOmapping=\"" + row.mapping + "\"")));
  const canopen::Entry found = entry(result, 0x2000);
  ASSERT_TRUE(found);
  EXPECT_EQ(found.description->access, row.expected);
  EXPECT_EQ(found.description->rpdo_mappable, row.rpdo);
  EXPECT_EQ(found.description->tpdo_mappable, row.tpdo);
}

INSTANTIATE_TEST_SUITE_P(Words, XddMapping,
                         testing::Values(Mapping{"rw", "no", Access::read_write, false, false},
                                         Mapping{"rw", "default", Access::read_write, true, true},
                                         Mapping{"rw", "TPDO", Access::read_write_input, false, true},
                                         Mapping{"rw", "RPDO", Access::read_write_output, true, false},
                                         Mapping{"ro", "TPDO", Access::read_only, false, true},
                                         Mapping{"ro", "RPDO", Access::read_only, false, false},
                                         Mapping{"wo", "RPDO", Access::write_only, true, false},
                                         Mapping{"wo", "TPDO", Access::write_only, false, false},
                                         Mapping{"const", "optional", Access::constant, false, true}));

TEST(Xdd, MappingAgainstTheAccess_IsReported) {
  const ReadResult result =
      read_device_file(xdd(variable("dataType=\"0005\" accessType=\"ro\" PDOmapping=\"RPDO\"")));
  EXPECT_EQ(problem(result, xdd_object_line),
            "loss: PDOmapping=RPDO in [CANopenObject 2000H], which is ro: taken as not to be mapped");
}

const std::string process =
    "<ApplicationProcess><dataTypeList>"
    "<enum uniqueID=\"E\" name=\"Mode\"><USINT/><enumValue value=\"0\"/></enum>"
    "<derived uniqueID=\"D\" name=\"D\"><dataTypeIDRef uniqueIDRef=\"E\"/></derived>"
    "<derived uniqueID=\"C1\" name=\"C\"><dataTypeIDRef uniqueIDRef=\"C2\"/></derived>"
    "<derived uniqueID=\"C2\" name=\"C\"><dataTypeIDRef uniqueIDRef=\"C1\"/></derived>"
    "</dataTypeList><templateList>"
    "<parameterTemplate uniqueID=\"T\" access=\"readWrite\"><INT/><defaultValue value=\"7\"/>"
    "<allowedValues><range><minValue value=\"-3\"/><maxValue value=\"300\"/></range></allowedValues>"
    "</parameterTemplate></templateList><parameterList>"
    "<parameter uniqueID=\"P\" access=\"readWriteInput\"><label lang=\"en\">Label</label><UDINT/>"
    "<defaultValue value=\"$NODEID+0x40000180\"/><actualValue value=\"9\"/>"
    "<denotation><label lang=\"en\">Main</label></denotation></parameter>"
    "<parameter uniqueID=\"R\"><dataTypeIDRef uniqueIDRef=\"D\"/></parameter>"
    "<parameter uniqueID=\"S\" templateIDRef=\"T\"/>"
    "<parameter uniqueID=\"O\"><dataTypeIDRef uniqueIDRef=\"C1\"/></parameter>"
    "<parameter uniqueID=\"V\"><USINT/><allowedValues><value value=\"1\"/><range><minValue value=\"0\"/>"
    "<maxValue value=\"5\"/></range></allowedValues></parameter>"
    "</parameterList></ApplicationProcess>";

ReadResult with_parameter(const std::string& attributes) {
  return read_device_file(
      xdd("<CANopenObject index=\"2000\" objectType=\"7\" " + attributes + "/>\n", process));
}

TEST(XddParameter, OfAnObject_GivesWhatTheObjectDoesNotSay) {
  const ReadResult result = with_parameter("uniqueIDRef=\"P\"");
  const canopen::Entry found = entry(result, 0x2000);
  ASSERT_TRUE(found);
  EXPECT_EQ(result.file->dictionary->name(found), "Label");
  EXPECT_EQ(found.description->type, DataType::unsigned32);
  EXPECT_EQ(found.description->access, Access::read_write_input);
  EXPECT_EQ(value(result, 0x2000), (Bytes{9, 0, 0, 0})) << "its actual value";
  const EntryFacts* facts = result.file->find_facts(0x2000, 0);
  EXPECT_TRUE(facts->configured);
  EXPECT_EQ(facts->denotation, "Main");
  EXPECT_EQ(facts->default_text, "$NODEID+0x40000180");
}

TEST(XddParameter, OwnAttributes_CountBeforeTheParameters) {
  const ReadResult result = with_parameter(
      "name=\"N\" dataType=\"0006\" accessType=\"ro\" defaultValue=\"3\" actualValue=\"4\" "
      "uniqueIDRef=\"P\"");
  const canopen::Entry found = entry(result, 0x2000);
  ASSERT_TRUE(found);
  EXPECT_EQ(result.file->dictionary->name(found), "N");
  EXPECT_EQ(found.description->type, DataType::unsigned16);
  EXPECT_EQ(found.description->access, Access::read_only);
  EXPECT_EQ(value(result, 0x2000), (Bytes{4, 0}));
}

TEST(XddParameter, TypeMadeFromAnEnumeration_IsTheEnumerationsType) {
  const ReadResult result = with_parameter("uniqueIDRef=\"R\"");
  EXPECT_EQ(entry(result, 0x2000).description->type, DataType::unsigned8);
  EXPECT_EQ(entry(result, 0x2000).description->access, Access::read_only) << "the schema's default";
}

TEST(XddParameter, Template_GivesTheRest) {
  const ReadResult result = with_parameter("uniqueIDRef=\"S\"");
  const canopen::Entry found = entry(result, 0x2000);
  EXPECT_EQ(found.description->type, DataType::integer16);
  EXPECT_EQ(found.description->access, Access::read_write);
  EXPECT_EQ(value(result, 0x2000), (Bytes{7, 0}));
  EXPECT_EQ(result.file->dictionary->limits(found).low, static_cast<std::uint64_t>(-3));
  EXPECT_EQ(result.file->dictionary->limits(found).high, 300U);
}

TEST(XddParameter, RangeBesideSingleValues_IsNoLimit) {
  const ReadResult result = with_parameter("uniqueIDRef=\"V\"");
  EXPECT_FALSE(result.file->dictionary->limits(entry(result, 0x2000)).high);
}

TEST(XddParameter, TypeOfADomain_IsDomain) {
  const ReadResult result =
      read_device_file(xdd("<CANopenObject index=\"2000\" objectType=\"2\" uniqueIDRef=\"P\"/>\n", process));
  EXPECT_EQ(entry(result, 0x2000).description->type, DataType::domain);
}

TEST(XddParameter, CircleOfTypes_EndsWithoutAType) {
  const ReadResult result = with_parameter("uniqueIDRef=\"O\"");
  EXPECT_EQ(entry(result, 0x2000).description->type, DataType::unsigned32);
  EXPECT_NE(all_problems(result).find("2000:00 has no DataType: taken as UNSIGNED32"), std::string::npos);
}

TEST(XddParameter, UnknownReference_IsReported) {
  const ReadResult result = with_parameter("dataType=\"0005\" accessType=\"ro\" uniqueIDRef=\"X\"");
  EXPECT_NE(problem(result, xdd_object_line)
                .find("loss: uniqueIDRef=X in [CANopenObject 2000H]: there is no such parameter"),
            std::string::npos);
}

TEST(Xdd, ValueThatDoesNotFit_IsReportedWithItsPlaceInTheFile) {
  const ReadResult result = read_device_file(
      xdd("<CANopenObject index=\"2000\" name=\"V\" objectType=\"7\" dataType=\"0005\"\n accessType=\"rw\" "
          "defaultValue=\"0x1FF\"/>\n"));
  ASSERT_EQ(result.problems.size() >= 1, true);
  EXPECT_EQ(problem(result, xdd_object_line + 1),
            "loss: defaultValue=0x1FF of 2000:00 does not fit UNSIGNED8: taken as 0xFF");
  EXPECT_EQ(result.problems.front().column, 32U);
}

TEST(Xdd, IdentityThatDiffers_NamesTheElementOfTheFile) {
  std::string text = xdd("");
  text.replace(text.find(">0x1<"), 5, ">0x7<");
  EXPECT_NE(all_problems(read_device_file(text))
                .find("1018:01 is 1, but vendorID in [DeviceIdentity] is 7: the object counts"),
            std::string::npos);
}

TEST(Xdc, CommissioningAndActualValues_AreTheDcfs) {
  std::string text =
      xdd(variable("dataType=\"0005\" accessType=\"rw\" defaultValue=\"3\" actualValue=\"4\" "
                   "denotation=\"Speed\""));
  text.insert(
      text.find("</NetworkManagement>"),
      "<deviceCommissioning nodeID=\"5\" nodeName=\"Pump\" actualBaudRate=\"250 Kbps\" networkNumber=\"2\" "
      "networkName=\"Line\" CANopenManager=\"true\"/>");
  const ReadResult result = read_device_file(text);
  ASSERT_NE(result.file, nullptr);
  ASSERT_TRUE(result.file->commissioning);
  EXPECT_EQ(result.file->commissioning->node_id, 5);
  EXPECT_EQ(result.file->commissioning->node_name, "Pump");
  EXPECT_EQ(result.file->commissioning->bit_rate, 250'000U);
  EXPECT_EQ(result.file->commissioning->net_number, 2U);
  EXPECT_EQ(result.file->commissioning->network_name, "Line");
  EXPECT_TRUE(result.file->commissioning->canopen_manager);
  EXPECT_EQ(value(result, 0x2000), (Bytes{4}));
  EXPECT_TRUE(result.file->find_facts(0x2000, 0)->configured);
  EXPECT_EQ(result.file->find_facts(0x2000, 0)->denotation, "Speed");
}

TEST(Xdd, PrefixesOfNamespaces_ChangeNothing) {
  std::string text = xdd(variable("dataType=\"0005\" accessType=\"rw\" defaultValue=\"3\""));
  for (const std::string name : {"CANopenObject ", "CANopenObjectList>", "CANopenSubObject ", "ProfileBody>",
                                 "ProfileBody ", "CANopenObject>"}) {
    for (const std::string bracket : {"<", "</"}) {
      for (std::size_t place = 0; (place = text.find(bracket + name, place)) != std::string::npos; ++place) {
        text.insert(place + bracket.size(), "q1:");
      }
    }
  }
  const ReadResult result = read_device_file(text);
  ASSERT_NE(result.file, nullptr) << first_problem(result);
  EXPECT_EQ(value(result, 0x2000), (Bytes{3}));
}

TEST(Xdd, ContentNotTheName_SaysWhatAFileIs) {
  EXPECT_NE(read_device_file("\xEF\xBB\xBF\r\n " + xdd("").substr(39)).file, nullptr);
  EXPECT_EQ(first_problem(read_device_file("[FileInfo]\n<")),
            "1: error: no object is described: an EDS has sections "
            "such as [1000] and [1018sub1]");
}

TEST(Xdd, Utf16AndLatin_AreConverted) {
  std::string latin = xdd(variable("dataType=\"0005\" accessType=\"rw\""));
  latin.replace(latin.find("UTF-8"), 5, "ISO-8859-1");
  latin.replace(latin.find("\"V\""), 3, "\"K\xFChler\"");
  ReadResult result = read_device_file(latin);
  ASSERT_NE(result.file, nullptr);
  EXPECT_EQ(result.file->dictionary->name(entry(result, 0x2000)), "K\xC3\xBChler");
  std::string wide = "\xFF\xFE";
  for (const char c : xdd("")) (wide += c) += '\0';
  result = read_device_file(wide);
  ASSERT_NE(result.file, nullptr) << first_problem(result);
  EXPECT_NE(all_problems(result).find("1: note: the file is UTF-16 text: converted"), std::string::npos);
}

TEST(Xdd, ObjectOrSubIndexTwice_TheFirstCounts) {
  const std::string v = "dataType=\"0005\" accessType=\"rw\" defaultValue=";
  const ReadResult result = read_device_file(xdd(variable(v + "\"3\"") + variable(v + "\"4\"")));
  EXPECT_EQ(value(result, 0x2000), (Bytes{3}));
  EXPECT_EQ(problem(result, xdd_object_line + 1),
            "loss: 2000H was described in line " + std::to_string(xdd_object_line) + " before: left out");
}

/// 1400H with its sub-indexes written so.
std::string record_with_subs(const char* zero, const char* one, const char* two) {
  const auto member = [](const char* sub, const char* rest) {
    return std::string("<CANopenSubObject subIndex=\"") + sub + "\" objectType=\"7\" name=\"m\" " + rest +
           "/>\n";
  };
  return "<CANopenObject index=\"1400\" name=\"RPDO1\" objectType=\"9\" subNumber=\"3\">\n" +
         member(zero, "dataType=\"0005\" accessType=\"ro\" defaultValue=\"2\"") +
         member(one, "dataType=\"0007\" accessType=\"rw\" defaultValue=\"$NODEID+0x200\"") +
         member(two, "dataType=\"0005\" accessType=\"rw\" defaultValue=\"1\"") + "</CANopenObject>\n";
}

TEST(Xdd, SubIndex_IsReadWithAnyNumberOfDigits) {
  const char* const spellings[][3] = {
      {"0000", "0001", "0002"},  // CANopenEditor's XDD 1.0
      {"00", "01", "02"},       {"0", "1", "2"}, {"0x00", "0X01", "0x0002"}, {" 00", "01 ", "2"},
  };
  for (const auto& [zero, one, two] : spellings) {
    SCOPED_TRACE(one);
    const ReadResult result = read_device_file(xdd(record_with_subs(zero, one, two)));
    EXPECT_EQ(value(result, 0x1400, 0), (Bytes{2}));
    EXPECT_EQ(value(result, 0x1400, 1), (Bytes{0x05, 0x02, 0, 0}));
    EXPECT_EQ(value(result, 0x1400, 2), (Bytes{1}));
    EXPECT_FALSE(result.has_losses()) << all_problems(result);
  }
  const ReadResult letters = read_device_file(xdd(record_with_subs("00", "000a", "00FE")));
  EXPECT_EQ(value(letters, 0x1400, 0x0A), (Bytes{0x05, 0x02, 0, 0}));
  EXPECT_EQ(value(letters, 0x1400, 0xFE), (Bytes{1}));
}

TEST(Xdd, SubIndexThatIsNone_IsALoss) {
  for (const char* const sub : {"0100", "", "G1", "-1", "00001000000000"}) {
    SCOPED_TRACE(sub);
    const ReadResult result = read_device_file(xdd(record_with_subs("00", sub, "02")));
    EXPECT_EQ(problem(result, xdd_object_line + 2),
              std::string("loss: CANopenSubObject of 1400H with subIndex=\"") + sub +
                  "\": a sub-index is hexadecimal, 00 to FF: left out");
    EXPECT_TRUE(result.has_losses());
  }
}

TEST(Xdd, SeveralRangesOrSingleValues_AreALoss) {
  const std::string ranges =
      "<ApplicationProcess><parameterList><parameter uniqueID=\"P\"><UINT/><allowedValues>"
      "<range><minValue value=\"1\"/><maxValue value=\"3\"/></range>"
      "<range><minValue value=\"7\"/><maxValue value=\"9\"/></range>"
      "</allowedValues></parameter></parameterList></ApplicationProcess>";
  const ReadResult result = read_device_file(xdd(variable("uniqueIDRef=\"P\""), ranges));
  EXPECT_TRUE(result.has_losses());
  EXPECT_NE(all_problems(result).find(
                "9: loss: allowedValues of parameter P has single values or several ranges: no limits"),
            std::string::npos)
      << all_problems(result);
}

TEST(Xdd, UnusableIndex_LeavesItsObjectOut) {
  const ReadResult result =
      read_device_file(xdd("<CANopenObject index=\"20000\" name=\"V\"/>\n<CANopenObject/>\n"));
  EXPECT_EQ(problem(result, xdd_object_line),
            "loss: CANopenObject with index=\"20000\": an index is four hexadecimal digits: left out");
  EXPECT_NE(problem(result, xdd_object_line + 1), "");
}

struct Hostile {
  const char* name;
  std::string text;
  const char* error;
};
void PrintTo(const Hostile& hostile, std::ostream* out) { *out << hostile.name; }
class HostileXdd : public testing::TestWithParam<Hostile> {};

TEST_P(HostileXdd, IsRefusedWithItsLine) {
  const ReadResult result = read_device_file(GetParam().text);
  EXPECT_EQ(result.file, nullptr);
  EXPECT_EQ(first_problem(result), GetParam().error);
}

std::string nested(int levels) {
  std::string text;
  for (int i = 0; i < levels; ++i) text += "<a>";
  return text;
}

INSTANTIATE_TEST_SUITE_P(
    Texts, HostileXdd,
    testing::Values(
        Hostile{"page", "<html></html>",
                "1: error: this is a web page and no device file of CANopen (EDS, DCF, XDD or XDC)"},
        Hostile{"other root", "<device></device>",
                "1: error: the root element is no ISO15745ProfileContainer, as an XDD [CiA 311] has it"},
        Hostile{"nothing", "<", "1: error: this cannot be read as XML: a '<' that begins no tag"},
        Hostile{"truncated", xdd("").substr(0, 900),
                "18: error: this cannot be read as XML: an attribute is not name=\"value\""},
        Hostile{
            "bomb",
            "<?xml version=\"1.0\"?>\n<!DOCTYPE a [\n<!ENTITY b \"c\">\n<!ENTITY d \"&b;&b;\">]>\n<a>&d;</a>",
            "2: error: this cannot be read as XML: the file declares entities, which no device file needs: "
            "they are not "
            "expanded"},
        Hostile{"deep", nested(100'000),
                "1: error: this cannot be read as XML: an end tag that does not belong to the element it "
                "would end"},
        Hostile{
            "not UTF-8", "<?xml version=\"1.0\"?>\n<a b=\"\xFF\"/>",
            "2: error: bytes that are not UTF-8, as which an XML file is read that names no other encoding"},
        Hostile{"zero", std::string("<a>\n\0</a>", 9),
                "2: error: this cannot be read as XML: a zero byte: no XML text has one"},
        Hostile{"two roots", "<a/>\n<b/>", "2: error: this cannot be read as XML: a second root element"},
        Hostile{"attribute twice", "<a b=\"1\"\n b=\"2\"/>",
                "1: error: this cannot be read as XML: an element has an attribute twice"},
        Hostile{"huge", '<' + std::string(9U << 20, 'a'),
                "1: error: this cannot be read as XML: the text has 9437185 bytes; expected at most 8388608"},
        Hostile{"other network",
                "<ISO15745ProfileContainer><ISO15745Profile>\n<ProfileBody "
                "xsi:type=\"ProfileBody_CommunicationNetwork_Powerlink\"/></ISO15745Profile></"
                "ISO15745ProfileContainer>",
                "2: error: this is an Ethernet POWERLINK device file (XDD) and no device file of CANopen "
                "(EDS, DCF, "
                "XDD or XDC)"},
        Hostile{"unknown network",
                "<ISO15745ProfileContainer><ISO15745Profile>\n<ProfileBody "
                "xsi:type=\"ProfileBody_CommunicationNetwork_Tokenring\"/></ISO15745Profile></"
                "ISO15745ProfileContainer>",
                "2: error: the network is not described as ProfileBody_CommunicationNetwork_CANopen: this is "
                "a device "
                "of another network"},
        Hostile{"no objects", "<ISO15745ProfileContainer/>",
                "1: error: there is no ProfileBody_CommunicationNetwork_CANopen: no object is described"}),
    [](const auto& row) {
      std::string name = row.param.name;
      std::erase_if(name, [](char c) { return c == ' ' || c == '-'; });
      return name;
    });

TEST(Xdd, DeepElementsInAWholeFile_AreRefused) {
  std::string end;
  for (int i = 0; i < 70; ++i) end += "</a>";
  const ReadResult result = read_device_file(xdd("", nested(70) + end));
  EXPECT_EQ(first_problem(result),
            "9: error: this cannot be read as XML: elements are nested more than 64 deep");
}

TEST(Xdd, ElementWithThousandsOfAttributes_IsRefused) {
  std::string object = "<CANopenObject index=\"2000\"";
  for (int i = 0; i < 5000; ++i) object += " a" + std::to_string(i) + "=\"\"";
  EXPECT_EQ(first_problem(read_device_file(xdd(object + "/>"))),
            "23: error: this cannot be read as XML: an element with more than 64 attributes");
}

}  // namespace
}  // namespace canopus::eds::xdd_test
