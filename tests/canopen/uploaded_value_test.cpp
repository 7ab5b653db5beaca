// How many of the bytes that an upload brought are the value's.

#include "canopus/canopen/sdo/uploaded_value.hpp"

#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::canopen::uploaded_value_test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Remark = UploadedValue::Remark;

Bytes value(const Bytes& bytes, bool size_indicated, std::size_t length) {
  const auto kept = uploaded_value(bytes, size_indicated, length).bytes;
  return {kept.begin(), kept.end()};
}
Remark remark(const Bytes& bytes, bool size_indicated, std::size_t length) {
  return uploaded_value(bytes, size_indicated, length).remark;
}

TEST(UploadedValue, SizeNotIndicated_HasTheBytesOfItsType) {
  const Bytes came{0x34, 0x12, 0xAA, 0xBB};
  EXPECT_EQ(value(came, false, 1), (Bytes{0x34}));
  EXPECT_EQ(value(came, false, 2), (Bytes{0x34, 0x12}));
  EXPECT_EQ(value(came, false, 3), (Bytes{0x34, 0x12, 0xAA}));
  EXPECT_EQ(value(came, false, 4), came);
  EXPECT_EQ(value(came, false, 0), came) << "no type";
  EXPECT_EQ(value(came, false, 8), came) << "too short for the type";
  EXPECT_EQ(remark(came, false, 2), Remark::size_not_indicated);
  EXPECT_EQ(remark(came, false, 0), Remark::size_not_indicated);
}

TEST(UploadedValue, MoreBytesThanTheTypeHas_AreLeftOutIfTheyAre0) {
  EXPECT_EQ(value({0x34, 0x12, 0, 0}, true, 2), (Bytes{0x34, 0x12}));
  EXPECT_EQ(remark({0x34, 0x12, 0, 0}, true, 2), Remark::longer_than_type);
  EXPECT_EQ(value({0x34, 0x12, 1, 0}, true, 2), (Bytes{0x34, 0x12, 1, 0}));
  EXPECT_EQ(remark({0x34, 0x12, 0, 1}, true, 2), Remark::none);
  EXPECT_EQ(value({5, 0, 0, 0, 0, 0}, true, 2).size(), 6U) << "no expedited answer";
  EXPECT_EQ(remark({0x34, 0x12}, true, 2), Remark::none);
}

RC_GTEST_PROP(UploadedValueProperties, AreTheFirstBytesThatCame_AndNeverFewerThanTheType,
              (const Bytes& came, bool size_indicated)) {
  const auto length = *rc::gen::inRange<std::size_t>(0, 9);
  const auto kept = value(came, size_indicated, length);
  RC_ASSERT(kept.size() <= came.size());
  RC_ASSERT(std::equal(kept.begin(), kept.end(), came.begin()));
  RC_ASSERT(kept.size() == came.size() || kept.size() == length);
}

}  // namespace
}  // namespace canopus::canopen::uploaded_value_test
