#include "canopus/text/byte_size.hpp"

#include <gtest/gtest.h>

namespace canopus::text::byte_size_test {
namespace {

TEST(ByteSize, SizesHaveALetterOrAreBytes) {
  EXPECT_EQ(parse_byte_size("1"), 1U);
  EXPECT_EQ(parse_byte_size("64K"), 65'536U);
  EXPECT_EQ(parse_byte_size("16M"), 16'777'216U);
  EXPECT_EQ(parse_byte_size("2G"), 2'147'483'648U);
}

TEST(ByteSize, WhatIsNoSizeIsRefused) {
  for (const auto* text : {"", "M", "0", "0M", "-1", "1.5M", "16m", "16MB", "16 M", "99999999999G"})
    EXPECT_FALSE(parse_byte_size(text)) << text;
  EXPECT_EQ(parse_byte_size("much").error(),
            "\"much\" is not a size; expected bytes, or a number with K, M or G, for example \"16M\"");
}

TEST(ByteSize, WholeUnitsAreShownAsSuch) {
  EXPECT_EQ(describe_byte_size(1), "1 byte");
  EXPECT_EQ(describe_byte_size(1000), "1000 bytes");
  EXPECT_EQ(describe_byte_size(65'536), "64 KiB");
  EXPECT_EQ(describe_byte_size(16'777'216), "16 MiB");
  EXPECT_EQ(describe_byte_size(16'777'217), "16777217 bytes");
}

}  // namespace
}  // namespace canopus::text::byte_size_test
