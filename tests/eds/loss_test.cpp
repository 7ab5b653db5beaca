// "Accepted" means that nothing which matters for communication was left out: what is a loss, and what is none.

#include <gmock/gmock.h>

#include "eds/reading.hpp"
#include "eds/xdd_text.hpp"

namespace canopus::eds::loss_test {
namespace {

using namespace canopus::eds;
using namespace canopus::eds::test;
using testing::HasSubstr;

struct Case {
  const char* name;
  std::string text;
  const char* loss;  // empty: none
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

const std::string tpdo =
    "[1800]\nParameterName=T\nObjectType=9\nSubNumber=3\n[1800sub0]\nParameterName=N\nDataType=5\nAccessType="
    "ro\n"
    "DefaultValue=2\n[1800sub1]\nParameterName=C\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x180\n"
    "[1800sub2]\nParameterName=Y\nDataType=5\nAccessType=rw\nDefaultValue=255\n";

std::string mapping(const std::string& count, const std::string& first) {
  return tpdo +
         "[1A00]\nParameterName=M\nObjectType=9\nSubNumber=2\n[1A00sub0]\nParameterName=N\nDataType=5\n"
         "AccessType=rw\nDefaultValue=" +
         count + "\n[1A00sub1]\nParameterName=E\nDataType=7\nAccessType=rw\nDefaultValue=" + first + "\n";
}

const Case cases[] = {
    {"Nothing", with_variable("DataType=6\nDefaultValue=7\nLowLimit=1\nHighLimit=9\nPDOMapping=1\n"), ""},
    {"ListedAndNotDescribed", base + "[OptionalObjects]\nSupportedObjects=1\n1=0x1017\n",
     "there is no section [1017]"},
    {"ListedAsNoIndex", base + "[OptionalObjects]\nSupportedObjects=1\n1=banana\n",
     "is not the index of an object"},
    {"RecordWithoutSubIndexes", with_object("[2000]\nParameterName=R\nObjectType=9\n"),
     "no sub-index is described"},
    {"ValuesOfNoObject", base + "[2000Value]\nNrOfEntries=1\n1=5\n", "belongs to no object"},
    {"UnknownType", with_variable("DataType=0x99\n"), "no data type known here"},
    {"NoType", with_variable("PDOMapping=0\n"), "has no DataType: taken as UNSIGNED32"},
    {"NoTypeOfAStandardObject", base + "[1017]\nParameterName=H\nAccessType=rw\n", ""},
    {"ValueThatIsNone", with_variable("DataType=6\nDefaultValue=fast\n"), "is not a number"},
    {"ValueThatIsCut", with_variable("DataType=5\nDefaultValue=0x100\n"), "does not fit UNSIGNED8"},
    {"MappingOfAText", with_variable("DataType=9\nPDOMapping=1\n"), "PDOMapping is taken as 0"},
    {"MappingThatIsNone", with_variable("DataType=5\nPDOMapping=perhaps\n"),
     "is neither 0 nor 1: taken as 0"},
    {"MappedObjectThatIsMissing", base + mapping("1", "0x60000008"), "maps 6000:00, which does not exist"},
    {"MoreMappedThanDescribed", base + mapping("2", "0x10010008"),
     "says 2 objects mapped, but only 1 can be"},
    {"LineInAnObject", with_variable("DataType=5\nwhat is this\n"), "neither [section] nor Key=Value"},
    {"LineElsewhere", base + "[Comments]\nLines=0\nwhat is this\n", ""},
    {"NodeIdThatIsNone", base + "[DeviceComissioning]\nNodeID=five\n", "NodeID=five"},
    {"SafetyMapping", with_variable("DataType=5\nSRDOMapping=1\n"), "safety-relevant data objects"},
    {"NoSafetyMapping", with_variable("DataType=5\nSRDOMapping=0\n"), ""},
    {"DynamicChannels", base + "[DynamicChannels]\nNrOfSeg=1\nType1=7\n", "dynamic channels"},
    {"NoDynamicChannels", base + "[DynamicChannels]\nNrOfSeg=0\n", ""},
    {"MisspeltKey", with_variable("DataTyp=5\nDefaultValue=1\n"), ""},
    {"ObjectInNoList",
     with_object("[2000]\nParameterName=V\nDataType=5\nAccessType=rw\n[2001]\nParameterName=W\n"
                 "DataType=5\nAccessType=rw\n"),
     ""},
    {"ObjectTwiceInAnXdd",
     xdd("<CANopenObject index=\"2000\" name=\"V\" objectType=\"7\" dataType=\"0005\" accessType=\"rw\"/>\n"
         "<CANopenObject index=\"2000\" name=\"W\" objectType=\"7\" dataType=\"0005\" accessType=\"rw\"/>\n"),
     "before: left out"},
    {"Xdd",
     xdd("<CANopenObject index=\"2000\" name=\"V\" objectType=\"7\" dataType=\"0005\" accessType=\"rw\"/>\n"),
     ""},
};

class Loss : public testing::TestWithParam<Case> {};

TEST_P(Loss, WhatIsLeftOut_IsNamedAsALoss) {
  const ReadResult result = read_device_file(GetParam().text);
  ASSERT_NE(result.file, nullptr) << all_problems(result);
  std::string losses;
  for (const Problem& problem : result.problems) {
    if (problem.severity == Problem::Severity::loss) losses += problem.message + '\n';
  }
  EXPECT_EQ(result.has_losses(), !losses.empty());
  EXPECT_EQ(losses.empty(), std::string(GetParam().loss).empty()) << losses;
  EXPECT_THAT(losses, HasSubstr(GetParam().loss));
}

INSTANTIATE_TEST_SUITE_P(Kinds, Loss, testing::ValuesIn(cases),
                         [](const auto& instance) { return instance.param.name; });

TEST(Loss, EveryPlace_IsNamed) {
  const ReadResult result = read_device_file(with_object(
      "[2000]\nParameterName=A\nObjectType=8\nSubNumber=3\n[2000sub0]\nParameterName=N\nDataType=5\n"
      "AccessType=ro\nDefaultValue=2\n[2000sub1]\nParameterName=E\nDataType=9\nAccessType=rw\nPDOMapping=1\n"
      "[2000sub2]\nParameterName=F\nDataType=9\nAccessType=rw\nPDOMapping=1\n"));
  EXPECT_THAT(all_problems(result), HasSubstr("loss: 2000:01 is of type VISIBLE_STRING"));
  EXPECT_THAT(all_problems(result), HasSubstr("loss: 2000:02 is of type VISIBLE_STRING"));
}

TEST(Loss, OfARefusedFile_IsNone) { EXPECT_FALSE(read_device_file("hello").has_losses()); }

}  // namespace
}  // namespace canopus::eds::loss_test
