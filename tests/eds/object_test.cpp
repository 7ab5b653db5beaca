// Objects, their sub-indexes and the lists they stand in.

#include <gmock/gmock.h>

#include "eds/reading.hpp"

namespace canopus::eds::object_test {
namespace {

using namespace canopus;
using namespace canopus::eds;
using namespace canopus::eds::test;
using canopen::ObjectCode;
using testing::ElementsAre;
using testing::HasSubstr;

ReadResult object(std::string_view sections) { return read_device_file(with_object(sections)); }

std::string sub(int number, std::string_view rest = "DataType=6\nAccessType=rw\n",
                const char* spelling = "2000sub") {
  char text[32];
  std::snprintf(text, sizeof text, "[%s%X]\nParameterName=S\n", spelling, static_cast<unsigned>(number));
  return text + std::string(rest);
}

TEST(Base, File_IsReadWithoutComplaint) {
  const auto result = read_device_file(base);
  ASSERT_NE(result.file, nullptr);
  EXPECT_EQ(all_problems(result), "");
  EXPECT_EQ(result.file->dictionary->objects().size(), 3U);
  EXPECT_EQ(std::ranges::count(base, '\n'), base_lines);
}

TEST(Array, AlikeMembers_ShareOneDescription) {
  std::string text =
      "[2000]\nParameterName=A\nObjectType=8\nSubNumber=7\n" + sub(0, "DataType=5\nAccessType=ro\n");
  for (int i = 1; i <= 6; ++i) text += sub(i, "DataType=6\nAccessType=rw\nDefaultValue=7\n");
  const auto result = object(text);
  EXPECT_TRUE(result.file->dictionary->find(0x2000)->uniform);
  EXPECT_THAT(value(result, 0x2000, 6), ElementsAre(7, 0));
  EXPECT_THAT(value(result, 0x2000, 0), ElementsAre(6));
}

TEST(Record, Members_KeepTheirOwnTypes) {
  const auto result = object("[2000]\nParameterName=R\nObjectType=9\nSubNumber=3\n" +
                             sub(0, "DataType=5\nAccessType=ro\nDefaultValue=2\n") + sub(1) +
                             sub(2, "DataType=7\nAccessType=ro\n"));
  EXPECT_EQ(all_problems(result), "");
  EXPECT_EQ(result.file->dictionary->find(0x2000)->code, ObjectCode::record);
  EXPECT_EQ(result.file->dictionary->find(0x2000, 2).description->type, canopen::DataType::unsigned32);
}

TEST(Record, SubIndexSection_IsReadInAnySpelling) {
  const auto result = object("[2000]\nParameterName=R\nObjectType=9\nSubNumber=3\n" +
                             sub(0, "DataType=5\nAccessType=ro\nDefaultValue=10\n") +
                             sub(1, "DataType=6\nAccessType=rw\n", "2000Sub") +
                             sub(10, "DataType=6\nAccessType=rw\n", "0x2000sub0x"));
  EXPECT_TRUE(result.file->dictionary->find(0x2000, 1));
  EXPECT_TRUE(result.file->dictionary->find(0x2000, 0x0A));
}

TEST(Record, SubIndexesCountedInDecimal_AreSeen) {
  std::string text =
      "[2000]\nParameterName=R\nObjectType=9\n" + sub(0, "DataType=5\nAccessType=ro\nDefaultValue=11\n");
  for (int i = 1; i <= 9; ++i) text += sub(i);
  text += sub(0x10) + sub(0x11);
  const auto result = object(text);
  EXPECT_TRUE(result.file->dictionary->find(0x2000, 11));
  EXPECT_FALSE(result.file->dictionary->find(0x2000, 0x11));
  EXPECT_THAT(
      all_problems(result),
      HasSubstr("warning: sub-indexes of 2000H go from 9 to 10 without A to F: read as decimal numbers"));
}

TEST(Record, WithoutSubIndexZero_GetsOne) {
  const auto result = object("[2000]\nParameterName=R\nObjectType=9\n" + sub(3));
  EXPECT_THAT(value(result, 0x2000, 0), ElementsAre(3));
  EXPECT_EQ(problem(result, object_line), "warning: 2000H has no sub-index 00: made, with value 3");
}

TEST(Record, WithoutObjectType_IsInferred) {
  const auto result = object("[2000]\nParameterName=R\n" +
                             sub(0, "DataType=5\nAccessType=ro\nDefaultValue=2\n") + sub(1) + sub(2));
  EXPECT_EQ(result.file->dictionary->find(0x2000)->code, ObjectCode::array);
  EXPECT_EQ(problem(result, object_line), "warning: 2000H has sub-indexes and no ObjectType: taken as ARRAY");
}

TEST(Record, ObjectTypeAsAWord_IsUnderstood) {
  const auto result = object("[2000]\nParameterName=R\nObjectType=RECORD\n" +
                             sub(0, "DataType=5\nAccessType=ro\nDefaultValue=1\n") + sub(1));
  EXPECT_EQ(result.file->dictionary->find(0x2000)->code, ObjectCode::record);
  EXPECT_EQ(problem(result, object_line + 2),
            "note: ObjectType=RECORD in [2000]: a word instead of the object code");
}

TEST(Record, SubIndexesWithoutTheirObject_MakeOne) {
  const auto result = object(sub(0, "DataType=5\nAccessType=ro\nDefaultValue=1\n") + sub(1));
  EXPECT_TRUE(result.file->dictionary->find(0x2000, 1));
  EXPECT_EQ(problem(result, object_line), "warning: sub-indexes of 2000H, but no [2000]: made, a ARRAY");
}

TEST(Record, SubNumber_IsOnlyAHint) {
  const auto result = object("[2000]\nParameterName=R\nObjectType=9\nSubNumber=9\n" +
                             sub(0, "DataType=5\nAccessType=ro\nDefaultValue=1\n") + sub(1));
  EXPECT_EQ(problem(result, object_line), "note: 2000H has SubNumber=9, but 2 sub-indexes described");
}

TEST(Compact, SubIndexes_TakeWhatTheHeadSays) {
  const auto result = object(
      "[2000]\nParameterName=C\nObjectType=8\nDataType=6\nAccessType=rw\nDefaultValue=3\nCompactSubObj="
      "200\n");
  EXPECT_EQ(all_problems(result), "");
  EXPECT_THAT(value(result, 0x2000, 0), ElementsAre(200));
  EXPECT_THAT(value(result, 0x2000, 200), ElementsAre(3, 0));
  EXPECT_TRUE(result.file->dictionary->find(0x2000)->uniform);
}

TEST(Compact, NameAndValueLists_Override) {
  const auto result = object(
      "[2000]\nParameterName=C\nObjectType=8\nDataType=6\nAccessType=rw\nDefaultValue=3\nCompactSubObj=12\n"
      "[2000Name]\nNrOfEntries=1\n12=Twelfth\n[2000Value]\nNrOfEntries=1\n12=0x1234\n[DeviceComissioning]"
      "\nNodeID=5\n");
  EXPECT_EQ(all_problems(result), "");
  const auto& dictionary = *result.file->dictionary;
  EXPECT_EQ(dictionary.name(dictionary.find(0x2000, 12)), "Twelfth");
  EXPECT_EQ(dictionary.name(dictionary.find(0x2000, 11)), "C 11");
  EXPECT_THAT(value(result, 0x2000, 12), ElementsAre(0x34, 0x12));
  EXPECT_THAT(value(result, 0x2000, 11), ElementsAre(3, 0));
  EXPECT_TRUE(result.file->find_facts(0x2000, 12)->configured);
}

TEST(Compact, ValueOfASubIndexThatIsNotThere_IsTold) {
  const auto result = object(
      "[2000]\nParameterName=C\nObjectType=8\nDataType=6\nAccessType=rw\nCompactSubObj=2\n"
      "[2000Value]\nNrOfEntries=1\n3=1\n");
  EXPECT_EQ(problem(result, 45), "loss: 3 in [2000Value]: 2000H has sub-indexes 1..2: left out");
}

TEST(Lists, WrongCount_IsTold) {
  const auto result = read_device_file(base +
                                       "[OptionalObjects]\nSupportedObjects=5\n1=0x1005\n[1005]"
                                       "\nParameterName=SYNC\nDataType=7\nAccessType=rw\n");
  EXPECT_EQ(problem(result, 35), "warning: [OptionalObjects] SupportedObjects=5, but 1 entry follows");
  EXPECT_TRUE(result.file->dictionary->find(0x1005, 0));
}

TEST(Lists, ObjectWithoutSection_IsLeftOut) {
  const auto result = read_device_file(base + "[OptionalObjects]\nSupportedObjects=1\n1=0x6505\n");
  EXPECT_EQ(problem(result, 36), "loss: 1=0x6505 in [OptionalObjects]: there is no section [6505]: left out");
}

TEST(Lists, SectionThatIsNotListed_IsTakenIn) {
  const auto result = read_device_file(base + "[2345]\nParameterName=X\nDataType=7\nAccessType=rw\n");
  EXPECT_EQ(problem(result, 34), "warning: 2345H is in no object list: taken in all the same");
  EXPECT_TRUE(result.file->dictionary->find(0x2345, 0));
}

TEST(Lists, DecimalIndex_IsReadAsHexadecimalWhenThatIsMeant) {
  const auto result = read_device_file(base +
                                       "[ManufacturerObjects]\nSupportedObjects=1\n1=2345\n[2345]"
                                       "\nParameterName=X\nDataType=7\nAccessType=rw\n");
  EXPECT_EQ(problem(result, 36), "warning: 1=2345 in [ManufacturerObjects] is read as 2345H");
}

TEST(Spelling, MisspeltSection_IsFound) {
  std::string text = base;
  text.replace(text.find("[MandatoryObjects]"), 18, "[MandatoryObject]");
  EXPECT_EQ(problem(read_device_file(text), 6),
            "warning: section [MandatoryObject] is read as [MandatoryObjects]");
}

TEST(Spelling, MisspeltKey_IsFound) {
  const auto result = object("[2000]\nParameterName=X\nDataType=5\nAcessType=ro\nDefaultVaule=7\n");
  EXPECT_THAT(value(result, 0x2000), ElementsAre(7));
  EXPECT_EQ(problem(result, 40), "warning: key AcessType in [2000] is taken for a misspelling of accesstype");
}

TEST(Mandatory, MissingObjects_AreMade) {
  const auto result = read_device_file(
      "[DeviceInfo]\nVendorNumber=0x195\nProductNumber=7\n[2000]\nParameterName=X\nDataType=5\nAccessType="
      "ro\n");
  ASSERT_NE(result.file, nullptr);
  EXPECT_THAT(value(result, 0x1000), ElementsAre(0, 0, 0, 0));
  EXPECT_THAT(value(result, 0x1018, 1), ElementsAre(0x95, 0x01, 0, 0));
  EXPECT_THAT(value(result, 0x1018, 2), ElementsAre(7, 0, 0, 0));
  EXPECT_THAT(all_problems(result),
              HasSubstr("1: warning: mandatory object 1001H (Error register) is missing"));
}

TEST(DataTypes, DefinitionSections_AreLeftOut) {
  const auto result = read_device_file(base + "[0005]\nParameterName=UNSIGNED8\nObjectType=5\nDataType=5\n");
  EXPECT_EQ(result.file->dictionary->find(0x0005), nullptr);
  EXPECT_EQ(problem(result, 34), "note: [0005] is a data type or NULL object: left out");
}

TEST(Dcf, Commissioning_IsReadInBothSpellings) {
  for (const char* spelling : {"DeviceComissioning", "DeviceCommissioning"}) {
    const auto result =
        read_device_file(base + "[" + spelling + "]\nNodeID=0x10\nNodeName=Pump\nBaudrate=500\n");
    ASSERT_TRUE(result.file->commissioning) << spelling;
    EXPECT_EQ(result.file->commissioning->node_id, 16);
    EXPECT_EQ(result.file->commissioning->bit_rate, 500'000U);
    EXPECT_EQ(result.file->commissioning->node_name, "Pump");
    EXPECT_EQ(all_problems(result), "");
  }
}

TEST(Dcf, NodeIdOutOfRange_IsTakenAsNotGiven) {
  const auto result = read_device_file(base + "[DeviceComissioning]\nNodeID=128\n");
  EXPECT_FALSE(result.file->commissioning->node_id);
  EXPECT_EQ(problem(result, 35),
            "loss: NodeID=128 in [DeviceComissioning]: a node-ID is 1 to 127: taken as not given");
}

struct Refusal {
  const char* text;
  unsigned line;
  const char* message;
};
class Refused : public testing::TestWithParam<Refusal> {};

TEST_P(Refused, TextWithoutOneObject_IsRefusedWithItsLine) {
  const auto result = read_device_file(GetParam().text);
  EXPECT_EQ(result.file, nullptr);
  ASSERT_FALSE(result.problems.empty());
  EXPECT_EQ(result.problems[0].severity, Problem::Severity::error);
  EXPECT_EQ(result.problems[0].line, GetParam().line);
  EXPECT_EQ(result.problems[0].message, GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Texts, Refused,
    testing::Values(Refusal{"", 1, "the file is empty"}, Refusal{" \n\n", 1, "the file is empty"},
                    Refusal{"<?xml version=\"1.0\"?>\n", 1,
                            "this cannot be read as XML: there is no element in it"},
                    Refusal{"\nhello\n", 2, "this is not an EDS or DCF: there is not one [section]"},
                    Refusal{"\x7F"
                            "ELF\x02\x01\n",
                            1, "this is a program and no device file of CANopen (EDS, DCF, XDD or XDC)"},
                    Refusal{"; nothing\n[FileInfo]\nFileName=x\n", 2,
                            "no object is described: an EDS has sections such as [1000] and [1018sub1]"}));

}  // namespace
}  // namespace canopus::eds::object_test
