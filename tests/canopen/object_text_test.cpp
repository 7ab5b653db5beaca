#include "canopus/canopen/dictionary/object_text.hpp"

#include <gtest/gtest.h>

namespace canopus::canopen::object_text_test {
namespace {

TEST(ObjectText, AnEntry_HasItsNumbersInHexadecimalWithAllDigits) {
  EXPECT_EQ(object_text(0x1018, 1), "1018:01");
  EXPECT_EQ(object_text(5, 0), "0005:00");
  EXPECT_EQ(object_text(0xFFFF, 0xFF), "FFFF:FF");
}

TEST(ObjectText, InASentence_TheIndexHasAnH) {
  EXPECT_EQ(object_name(0x1A), "001AH");
  EXPECT_EQ(object_text(0x6041, 0x0A), "6041:0A");
}

}  // namespace
}  // namespace canopus::canopen::object_text_test
