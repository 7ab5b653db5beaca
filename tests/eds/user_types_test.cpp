// Data types of a file's own, as CANFestival's editor writes objects with limits.

#include <gtest/gtest.h>

#include "eds/reading.hpp"

namespace canopus::eds::user_types_test {
namespace {

using namespace canopus;
using namespace canopus::eds;
using namespace canopus::eds::test;
using canopen::DataType;

/// A DEFTYPE as CANFestival writes it; `third` is the highest value, or nothing.
std::string range_type(const std::string& index, const std::string& base_type, const std::string& second,
                       const std::string& third) {
  const auto member = [&](const char* sub, const std::string& value) {
    return "[" + index + "sub" + sub +
           "]\nParameterName=M\nObjectType=0x7\nDataType=0x0005\nAccessType=ro\nDefaultValue=" + value + "\n";
  };
  return "[" + index + "]\nParameterName=Limited\nObjectType=0x5\nSubNumber=4\n" + member("0", "3") +
         member("1", base_type) + member("2", second) + (third.empty() ? "" : member("3", third));
}

/// 2000H of that type, before it the type's sections.
ReadResult read(const std::string& types, const std::string& data_type, const std::string& lines = {}) {
  return read_device_file(with_object(types + "[2000]\nParameterName=Value\nObjectType=7\nDataType=" +
                                      data_type + "\nAccessType=rw\nPDOMapping=1\n" + lines));
}

struct Expected {
  DataType type;
  std::optional<std::uint64_t> low;
  std::optional<std::uint64_t> high;
  bool mappable = true;
};

void expect(const ReadResult& result, const Expected& expected) {
  const canopen::Entry entry = result.file->dictionary->find(0x2000, 0);
  ASSERT_TRUE(entry);
  EXPECT_EQ(entry.description->type, expected.type);
  EXPECT_EQ(result.file->dictionary->limits(entry).low, expected.low);
  EXPECT_EQ(result.file->dictionary->limits(entry).high, expected.high);
  EXPECT_EQ(entry.description->rpdo_mappable, expected.mappable);
  EXPECT_EQ(entry.description->tpdo_mappable, expected.mappable);
  EXPECT_EQ(result.has_losses(), !expected.mappable) << all_problems(result);
}

TEST(UserType, RangeOfCanFestival_IsItsBaseTypeWithLimits) {
  const ReadResult result = read(range_type("A0", "0x06", "10", "200"), "0x00A0", "DefaultValue=20\n");
  expect(result, {DataType::unsigned16, 10, 200});
  EXPECT_EQ(value(result, 0x2000), (std::vector<std::uint8_t>{20, 0}));
  EXPECT_NE(all_problems(result).find(
                "note: DataType=0x00A0 in [2000]: a type of the file's own, taken as UNSIGNED16 "
                "with its limits"),
            std::string::npos)
      << all_problems(result);
}

TEST(UserType, OtherSpellingsAndBaseTypes) {
  expect(read(range_type("A1", "0x03", "-5", "0x7"), "0xA1"),
         {DataType::integer16, ~std::uint64_t{0} - 4, 7});
  expect(read(range_type("00a2", "5", "1", "9"), "162"), {DataType::unsigned8, 1, 9});
  expect(read(range_type("0x40", "0x07", "0", "0x10000"), "0x40"),
         {DataType::unsigned32, std::nullopt, 0x10000});
  expect(read("[A0]\nParameterName=T\nObjectType=5\nDataType=6\nLowLimit=3\nHighLimit=4\n", "0x00A0"),
         {DataType::unsigned16, 3, 4});
}

TEST(UserType, OfAnotherOne_HasTheNarrowerLimits) {
  const std::string types = range_type("A0", "0x06", "10", "200") + range_type("A1", "0xA0", "20", "");
  expect(read(types, "0x00A1"), {DataType::unsigned16, 20, 200});
}

TEST(UserType, LimitsOfTheObjectCountBeforeThoseOfItsType) {
  expect(read(range_type("A0", "0x06", "10", "200"), "0x00A0", "LowLimit=50\nHighLimit=\n"),
         {DataType::unsigned16, 50, 200});
}

TEST(UserType, TextWithItsLength_IsAText) {
  const ReadResult result = read_device_file(
      with_object(range_type("A0", "0x09", "10", "") +
                  "[2000]\nParameterName=V\nObjectType=7\nDataType=0xA0\nAccessType=rw\nDefaultValue=abc\n"));
  EXPECT_EQ(value(result, 0x2000), (std::vector<std::uint8_t>{'a', 'b', 'c'}));
  EXPECT_FALSE(result.has_losses()) << all_problems(result);
}

TEST(UserType, OfSubIndexes_HoldsForThem) {
  const ReadResult result = read_device_file(with_object(
      range_type("A0", "0x06", "10", "200") +
      "[2000]\nParameterName=A\nObjectType=8\nSubNumber=2\n[2000sub0]\nParameterName=N\nDataType="
      "5\nAccessType=ro\n"
      "DefaultValue=1\n[2000sub1]\nParameterName=M\nDataType=0xA0\nAccessType=rw\nDefaultValue=11\n"));
  EXPECT_EQ(value(result, 0x2000, 1), (std::vector<std::uint8_t>{11, 0}));
  EXPECT_FALSE(result.has_losses()) << all_problems(result);
}

TEST(UserType, WithoutAKnownBase_IsALoss) {
  const Expected lost{DataType::domain, std::nullopt, std::nullopt, false};
  expect(read("", "0x00A0"), lost);  // no such type
  expect(read(range_type("A0", "0xA1", "1", "2") + range_type("A1", "0xA0", "1", "2"), "0xA0"),
         lost);  // a circle
  expect(read("[A0]\nParameterName=S\nObjectType=6\nSubNumber=2\n[A0sub1]\nParameterName=M\nDataType=5\n"
              "DefaultValue=5\n",
              "0xA0"),
         lost);  // a structure
}

}  // namespace
}  // namespace canopus::eds::user_types_test
