// What objects of the standards are for.

#include "canopus/trace/decode/object_meaning.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::trace::object_meaning_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ObjectMeaning, SubIndexWithARowOfItsOwn) {
  EXPECT_THAT(object_meaning(0x1018, 2).text, HasSubstr("Which device"));
  EXPECT_THAT(object_meaning(0x1018, 4).text, HasSubstr("this piece"));
  EXPECT_THAT(object_meaning(0x1003, 0).text, HasSubstr("0 written deletes"));
  EXPECT_THAT(object_meaning(0x1029, 1).text, HasSubstr("loses the bus"));
}

TEST(ObjectMeaning, SubIndexesThatAreAlike) {
  EXPECT_THAT(object_meaning(0x1016, 1).text, HasSubstr("A heartbeat that the device watches"));
  EXPECT_EQ(object_meaning(0x1016, 127).text, object_meaning(0x1016, 1).text);
  EXPECT_EQ(object_meaning(0x1F88, 127).source, "CiA 302-2");
}

TEST(ObjectMeaning, TimesOfAFlyingMaster) {
  EXPECT_THAT(object_meaning(0x1F90, 4).text, HasSubstr("more than 127 device time slots"));
  EXPECT_EQ(object_meaning(0x1F90, 4).unit, "ms");
  EXPECT_EQ(object_meaning(0x1F90, 3).unit, "");
  EXPECT_EQ(object_meaning(0x1F90, 0).unit, "");
}

TEST(ObjectMeaning, NumberOfSubIndexes) {
  for (const unsigned index : {0x1010, 0x1018, 0x1029, 0x1F22, 0x1F81})
    EXPECT_EQ(object_meaning(static_cast<std::uint16_t>(index), 0).text,
              "How many sub-indexes the object has.")
        << index;
  // An object without sub-indexes is its 00H.
  EXPECT_THAT(object_meaning(0x1F80, 0).text, HasSubstr("NMT master"));
  EXPECT_THAT(object_meaning(0x1005, 0).text, HasSubstr("SYNC"));
  EXPECT_THAT(object_meaning(0x6064, 0).text, HasSubstr("Where the drive is"));
}

TEST(ObjectMeaning, PdosByTheirRange) {
  for (const unsigned index : {0x1800, 0x19FF})
    EXPECT_THAT(object_meaning(static_cast<std::uint16_t>(index), 2).text, HasSubstr("SYNC"));
  EXPECT_EQ(object_meaning(0x1800, 5).unit, "ms");
  EXPECT_EQ(object_meaning(0x1800, 3).unit, "x 100 us");
  EXPECT_THAT(object_meaning(0x17FF, 8).text, HasSubstr("go: index"));
  EXPECT_THAT(object_meaning(0x1A00, 0).text, HasSubstr("How many objects"));
  EXPECT_EQ(object_meaning(0x1A00, 1).source, "CiA 301 7.5.2.38");
  EXPECT_THAT(object_meaning(0x1800, 4).text, IsEmpty()) << "reserved";
}

TEST(ObjectMeaning, WhatIsNotKnown) {
  for (const unsigned index : {0x0000, 0x0007, 0x1004, 0x1FA0 - 1, 0x2000, 0x5FFF, 0x6000, 0xFFFF})
    EXPECT_THAT(object_meaning(static_cast<std::uint16_t>(index), 1).text, IsEmpty()) << index;
}

}  // namespace
}  // namespace canopus::trace::object_meaning_test
