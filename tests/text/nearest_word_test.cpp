#include "canopus/text/nearest_word.hpp"

#include <array>
#include <string>

#include <gtest/gtest.h>

namespace canopus::text::nearest_word_test {
namespace {

using namespace std::string_view_literals;

constexpr std::array commands{"run"sv, "check"sv, "plc"sv, "eds"sv,    "module"sv, "scan"sv,
                              "sdo"sv, "nmt"sv,   "lss"sv, "master"sv, "device"sv};

TEST(NearestWord, AMistakeOrTwoAreForgiven) {
  EXPECT_EQ(nearest("rnu", commands), "run") << "two neighbours exchanged";
  EXPECT_EQ(nearest("runn", commands), "run") << "a letter more";
  EXPECT_EQ(nearest("rn", commands), "run") << "a letter less";
  EXPECT_EQ(nearest("SCAM", commands), "scan") << "another letter, capital ones";
  EXPECT_EQ(nearest("mastre", commands), "master");
  EXPECT_EQ(nearest("modlues", commands), "module") << "two mistakes";
}

TEST(NearestWord, TheBeginningOfOneIsEnough) {
  EXPECT_EQ(nearest("mod", commands), "module");
  EXPECT_EQ(nearest("m", commands), "") << "module or master";
}

TEST(NearestWord, WhatIsNotNearIsNotGuessed) {
  EXPECT_EQ(nearest("frobnicate", commands), "");
  EXPECT_EQ(nearest("", commands), "");
  EXPECT_EQ(nearest("zzz", commands), "");
  EXPECT_EQ(nearest(std::string(100'000, 'r'), commands), "");
  EXPECT_EQ(nearest("run", {}), "");
}

TEST(NearestWord, SuggestionNamesTheNearestOneOrAll) {
  constexpr std::array formats{"dec"sv, "hex"sv, "both"sv};
  EXPECT_EQ(suggestion("hxe", formats), "; did you mean \"hex\"?");
  EXPECT_EQ(suggestion("octal", formats), "; expected dec, hex or both");
  EXPECT_EQ(one_of(std::array{"candump"sv}), "candump");
}

}  // namespace
}  // namespace canopus::text::nearest_word_test
