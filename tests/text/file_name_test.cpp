#include "canopus/text/file_name.hpp"

#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::text::file_name_test {
namespace {

TEST(FileName, OrdinaryNames_StayAsTheyAre) {
  EXPECT_EQ(file_name_of("line1"), "line1");
  EXPECT_EQ(file_name_of("io-block_2"), "io-block_2");
  EXPECT_EQ(file_name_of(""), "");
}

TEST(FileName, WhatLeadsElsewhere_DoesNot) {
  EXPECT_EQ(file_name_of(".."), "%2E%2E");
  EXPECT_EQ(file_name_of("../../etc/passwd"), "%2E%2E%2F%2E%2E%2Fetc%2Fpasswd");
  EXPECT_EQ(file_name_of("/"), "%2F");
  EXPECT_EQ(file_name_of(std::string_view("a\0b", 3)), "a%00b");
  EXPECT_EQ(file_name_of("a\x1B[2J\n"), "a%1B%5B2J%0A");
  EXPECT_EQ(file_name_of("Stra\xC3\x9F"
                         "e 1"),
            "Stra%C3%9Fe%201");
  EXPECT_EQ(file_name_of("100%"), "100%25");
}

TEST(FileName, LongNames_AreCutAndStayDifferent) {
  const std::string one = file_name_of(std::string(100'000, 'x') + "1");
  const std::string two = file_name_of(std::string(100'000, 'x') + "2");
  EXPECT_LE(one.size(), 80U);
  EXPECT_NE(one, two);
}

RC_GTEST_PROP(FileName, OfAnyNames_DifferIfTheNamesDo, (const std::string& a, const std::string& b)) {
  RC_ASSERT((file_name_of(a) == file_name_of(b)) == (a == b));
}

RC_GTEST_PROP(FileName, OfAnyName_IsOneNameOfHarmlessCharacters, (const std::string& name)) {
  const std::string file = file_name_of(name);
  RC_ASSERT(file.size() <= 80U);
  RC_ASSERT(file.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_%") ==
            std::string::npos);
}

}  // namespace
}  // namespace canopus::text::file_name_test
