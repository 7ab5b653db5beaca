// Values, limits and data types of objects.

#include <gmock/gmock.h>

#include "eds/reading.hpp"

namespace canopus::eds::value_test {
namespace {

using namespace canopus;
using namespace canopus::eds;
using namespace canopus::eds::test;
using testing::ElementsAre;
using testing::IsEmpty;

ReadResult variable(const std::string& lines) { return read_device_file(with_variable(lines)); }

struct ValueCase {
  const char* type;
  const char* text;
  std::vector<std::uint8_t> bytes;
};
class ValueAsBytes : public testing::TestWithParam<ValueCase> {};

TEST_P(ValueAsBytes, DefaultValue_BecomesTheBytesAnSdoCarries) {
  const auto result =
      variable(std::string("DataType=") + GetParam().type + "\nDefaultValue=" + GetParam().text + "\n");
  ASSERT_NE(result.file, nullptr);
  EXPECT_EQ(value(result, 0x2000), GetParam().bytes) << all_problems(result);
  EXPECT_EQ(all_problems(result), "");
}

INSTANTIATE_TEST_SUITE_P(
    Types, ValueAsBytes,
    testing::Values(ValueCase{"0x0001", "1", {0x01}}, ValueCase{"0x0002", "-2", {0xFE}},
                    ValueCase{"0x0002", "0xFE", {0xFE}}, ValueCase{"0x0003", "-100", {0x9C, 0xFF}},
                    ValueCase{"0x0004", "0x80000000", {0x00, 0x00, 0x00, 0x80}},
                    ValueCase{"0x0005", "200", {0xC8}}, ValueCase{"0x0006", "0x1234", {0x34, 0x12}},
                    ValueCase{"0x0007", "$NODEID+0x180", {0x85, 0x01, 0x00, 0x00}},
                    ValueCase{"0x0008", "1.5", {0x00, 0x00, 0xC0, 0x3F}},
                    ValueCase{"0x0008", "0x3FC00000", {0x00, 0x00, 0xC0, 0x3F}},
                    ValueCase{"0x0008", "2", {0x00, 0x00, 0x00, 0x40}},
                    ValueCase{"0x0009", "Ab; c", {'A', 'b', ';', ' ', 'c'}},
                    ValueCase{"0x000A", "0A 1b FF", {0x0A, 0x1B, 0xFF}},
                    ValueCase{"0x000B", "A\xE2\x9C\x93", {0x41, 0x00, 0x13, 0x27}},
                    ValueCase{"0x000C", "3 1000", {0xE8, 0x03, 0x00, 0x00, 0x03, 0x00}},
                    ValueCase{"0x000F", "C83D", {0xC8, 0x3D}}, ValueCase{"0x0010", "-1", {0xFF, 0xFF, 0xFF}},
                    ValueCase{"0x0011", "0.5", {0, 0, 0, 0, 0, 0, 0xE0, 0x3F}},
                    ValueCase{"0x0015", "-64", {0xC0, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}},
                    ValueCase{"0x001B", "0x0102030405060708", {8, 7, 6, 5, 4, 3, 2, 1}}));

TEST(Value, TooLarge_IsCutAndTold) {
  const auto result = variable("DataType=5\nDefaultValue=0x1FF\n");
  EXPECT_THAT(value(result, 0x2000), ElementsAre(0xFF));
  EXPECT_EQ(problem(result, 41), "loss: DefaultValue=0x1FF of 2000:00 does not fit UNSIGNED8: taken as 0xFF");
}

TEST(Value, NegativeOfAnUnsigned_IsTakenAsBitPattern) {
  const auto result = variable("DataType=6\nDefaultValue=-1\n");
  EXPECT_THAT(value(result, 0x2000), ElementsAre(0xFF, 0xFF));
  EXPECT_EQ(problem(result, 41), "loss: DefaultValue=-1 of 2000:00 does not fit UNSIGNED16: taken as 0xFFFF");
}

TEST(Value, Garbage_IsTakenAsNotGiven) {
  const auto result = variable("DataType=7\nDefaultValue=banana\n");
  EXPECT_THAT(value(result, 0x2000), ElementsAre(0, 0, 0, 0));
  EXPECT_EQ(problem(result, 41), "loss: DefaultValue=banana of 2000:00 is not a number: taken as not given");
}

TEST(Value, QuotedText_LosesItsQuotes) {
  const auto result = variable("DataType=9\nDefaultValue=\"IOCB\"\n");
  EXPECT_THAT(value(result, 0x2000), ElementsAre('I', 'O', 'C', 'B'));
  EXPECT_EQ(problem(result, 41), "note: DefaultValue=\"IOCB\" of 2000:00: quotes round a text");
}

TEST(Value, ParameterValue_WinsOverTheDefault) {
  const auto result =
      variable("DataType=5\nDefaultValue=1\nParameterValue=2\n[DeviceComissioning]\nNodeID=5\n");
  EXPECT_THAT(value(result, 0x2000), ElementsAre(2));
  EXPECT_TRUE(result.file->find_facts(0x2000, 0)->configured);
  EXPECT_EQ(all_problems(result), "");
}

TEST(Value, ParameterValueWithoutANode_IsNoted) {
  const auto result = variable("DataType=5\nParameterValue=2\n");
  EXPECT_EQ(problem(result, 41),
            "note: 2000:00 has a ParameterValue, which counts, but the file has no [DeviceComissioning]");
}

TEST(Limits, Limits_AreWatchedByTheDictionary) {
  const auto result = variable("DataType=3\nLowLimit=-10\nHighLimit=10\n");
  canopen::ObjectDictionary dictionary(result.file->dictionary, 5);
  EXPECT_EQ(dictionary.write(0x2000, 0, std::vector<std::uint8_t>{0xF5, 0xFF}, {}),
            canopen::AbortCode::value_too_low);
  EXPECT_EQ(dictionary.write(0x2000, 0, std::vector<std::uint8_t>{0xF6, 0xFF}, {}), canopen::AbortCode::none);
  EXPECT_EQ(dictionary.write(0x2000, 0, std::vector<std::uint8_t>{0x0B, 0x00}, {}),
            canopen::AbortCode::value_too_high);
}

TEST(Limits, HexadecimalLimitsOfASignedType_AreBitPatterns) {
  const auto result = variable("DataType=4\nLowLimit=0x80000000\nHighLimit=0xFFFFFFFF\n");
  canopen::ObjectDictionary dictionary(result.file->dictionary, 5);
  EXPECT_EQ(dictionary.write(0x2000, 0, std::vector<std::uint8_t>{0, 0, 0, 0}, {}),
            canopen::AbortCode::value_too_high);
  EXPECT_EQ(all_problems(result), "");
}

TEST(Limits, LowAboveHigh_AreNoLimits) {
  const auto result = variable("DataType=5\nLowLimit=9\nHighLimit=3\n");
  canopen::ObjectDictionary dictionary(result.file->dictionary, 5);
  EXPECT_EQ(dictionary.write(0x2000, 0, std::vector<std::uint8_t>{20}, {}), canopen::AbortCode::none);
  EXPECT_EQ(problem(result, 41), "loss: LowLimit=9 of 2000:00 is above HighLimit=3: no limits");
}

TEST(Limits, LimitOutsideTheType_IsNoLimit) {
  const auto result = variable("DataType=5\nHighLimit=70000\n");
  EXPECT_EQ(problem(result, 41), "warning: HighLimit=70000 of 2000:00 is outside UNSIGNED8: no limit");
}

TEST(Limits, LimitThatWouldKeepValuesOut_IsALossWhereItIsDropped) {
  EXPECT_EQ(problem(variable("DataType=5\nLowLimit=300\n"), 41),
            "loss: LowLimit=300 of 2000:00 is outside UNSIGNED8: no limit");
  EXPECT_EQ(problem(variable("DataType=5\nHighLimit=$NODEID+4\n"), 41),
            "loss: HighLimit=$NODEID+4 of 2000:00 depends on the node-ID: no limit");
  EXPECT_EQ(problem(variable("DataType=5\nHighLimit=many\n"), 41),
            "loss: HighLimit=many of 2000:00 is not a number: no limit");
}

TEST(Limits, DefaultOutsideItsLimits_IsTold) {
  const auto result = variable("DataType=5\nDefaultValue=1\nLowLimit=2\n");
  EXPECT_EQ(problem(result, 41), "warning: the value of 2000:00 is below LowLimit=2 in line 42");
}

TEST(Limits, EmptyLimits_AreNone) {
  const auto result = variable("DataType=5\nLowLimit=\nHighLimit=\nDefaultValue=\n");
  EXPECT_EQ(all_problems(result), "");
}

TEST(Limits, FullRange_CostsNothing) {
  const auto result = variable("DataType=3\nLowLimit=-32768\nHighLimit=32767\n");
  EXPECT_EQ(result.file->dictionary->find(0x2000, 0).description->limits, 0);
}

TEST(Type, Unknown_IsTakenAsDomain) {
  const auto result = variable("DataType=0x40\n");
  EXPECT_EQ(result.file->dictionary->find(0x2000, 0).description->type, canopen::DataType::domain);
  EXPECT_EQ(problem(result, 40), "loss: DataType=0x40 in [2000] is no data type known here: taken as DOMAIN");
}

TEST(Type, Word_IsUnderstood) {
  const auto result = variable("DataType=UNSIGNED16\n");
  EXPECT_EQ(result.file->dictionary->find(0x2000, 0).description->type, canopen::DataType::unsigned16);
  EXPECT_EQ(problem(result, 40), "note: DataType=UNSIGNED16 in [2000]: a word instead of the type's index");
}

TEST(Type, Missing_IsTakenAsUnsigned32) {
  const auto result = variable("PDOMapping=0\n");
  EXPECT_EQ(problem(result, 37), "loss: 2000:00 has no DataType: taken as UNSIGNED32");
}

struct MappingCase {
  const char* access;
  bool rpdo;
  bool tpdo;
};
class Mappable : public testing::TestWithParam<MappingCase> {};

TEST_P(Mappable, PdoMapping_GoesTheWayTheAccessAllows) {
  const auto result =
      read_device_file(with_object("[2000]\nParameterName=V\nDataType=5\nPDOMapping=1\nAccessType=" +
                                   std::string(GetParam().access) + "\n"));
  const auto* entry = result.file->dictionary->find(0x2000, 0).description;
  EXPECT_EQ(entry->rpdo_mappable, GetParam().rpdo);
  EXPECT_EQ(entry->tpdo_mappable, GetParam().tpdo);
}

INSTANTIATE_TEST_SUITE_P(Access, Mappable,
                         testing::Values(MappingCase{"ro", false, true}, MappingCase{"const", false, true},
                                         MappingCase{"wo", true, false}, MappingCase{"rw", true, true},
                                         MappingCase{"rwr", false, true}, MappingCase{"rww", true, false}));

TEST(AccessType, Capitals_AreUnderstood) {
  const auto result = read_device_file(with_object("[2000]\nParameterName=V\nDataType=5\nAccessType=RO\n"));
  EXPECT_EQ(result.file->dictionary->find(0x2000, 0).description->access, canopen::Access::read_only);
  EXPECT_EQ(problem(result, 40), "note: AccessType=RO of 2000:00 is in capitals");
}

TEST(AccessType, Nonsense_IsTakenAsRw) {
  const auto result =
      read_device_file(with_object("[2000]\nParameterName=V\nDataType=5\nAccessType=maybe\n"));
  EXPECT_EQ(result.file->dictionary->find(0x2000, 0).description->access, canopen::Access::read_write);
  EXPECT_EQ(problem(result, 40),
            "loss: AccessType=maybe of 2000:00 is none of ro wo rw rwr rww const: taken as rw");
}

}  // namespace
}  // namespace canopus::eds::value_test
