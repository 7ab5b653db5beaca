#include "canopus/client/gateway/gateway_value.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace canopus::client::gateway_value_test {
namespace {

struct ValueRow {
  const char* type;
  const char* text;
  std::vector<std::uint8_t> bytes;
  const char* shown;
};
class GatewayValue : public testing::TestWithParam<ValueRow> {};

TEST_P(GatewayValue, IsEncodedAndShown) {
  const auto type = parse_gateway_type(GetParam().type);
  ASSERT_TRUE(type);
  EXPECT_EQ(encode_gateway_value(GetParam().text, *type), GetParam().bytes);
  EXPECT_EQ(show_gateway_value(GetParam().bytes, *type), GetParam().shown);
}

INSTANTIATE_TEST_SUITE_P(
    Types, GatewayValue,
    testing::Values(
        ValueRow{"b", "1", {1}, "1"}, ValueRow{"i8", "-5", {0xFB}, "-5"},
        ValueRow{"i16", "-32768", {0, 0x80}, "-32768"}, ValueRow{"i24", "-2", {0xFE, 0xFF, 0xFF}, "-2"},
        ValueRow{"u32", "0x10", {0x10, 0, 0, 0}, "16"}, ValueRow{"u8", "010", {8}, "8"},
        ValueRow{"u40", "4294967296", {0, 0, 0, 0, 1}, "4294967296"},
        ValueRow{"i64", "-9223372036854775808", {0, 0, 0, 0, 0, 0, 0, 0x80}, "-9223372036854775808"},
        ValueRow{"x16", "255", {0xFF, 0}, "0x00FF"}, ValueRow{"r32", "1.5", {0, 0, 0xC0, 0x3F}, "1.5"},
        ValueRow{"r64", "-2", {0, 0, 0, 0, 0, 0, 0, 0xC0}, "-2"},
        ValueRow{"t", "2 1000", {0xE8, 3, 0, 0, 2, 0}, "2 1000"},
        ValueRow{"vs", "\"a \"\"b\"\"\"", {'a', ' ', '"', 'b', '"'}, "\"a \"\"b\"\"\""},
        ValueRow{"os", "AQID/w==", {1, 2, 3, 0xFF}, "AQID/w=="}, ValueRow{"d", "AQI=", {1, 2}, "AQI="},
        ValueRow{"d", "AQID", {1, 2, 3}, "AQID"}, ValueRow{"hex", "01 FFab", {1, 0xFF, 0xAB}, "01 FF AB"}));

TEST(GatewayValueText, ControlCharactersOfANode_StayInTheirLine) {
  const std::vector<std::uint8_t> bytes = {'a', '\r', '\n', 0x1B, 'b', 0, 0};
  EXPECT_EQ(show_gateway_value(bytes, *parse_gateway_type("vs")), "\"a\\x0d\\x0a\\x1bb\"");
}

TEST(GatewayValueText, WhatIsNoValue_IsNone) {
  const auto encode = [](const char* type, const char* text) {
    return encode_gateway_value(text, *parse_gateway_type(type));
  };
  for (const auto& [type, text] : std::vector<std::pair<const char*, const char*>>{{"b", "2"},
                                                                                   {"u8", "-1"},
                                                                                   {"u8", ""},
                                                                                   {"i8", "128"},
                                                                                   {"r32", "1e99"},
                                                                                   {"r32", "x"},
                                                                                   {"t", "1"},
                                                                                   {"t", "1 2 3"},
                                                                                   {"d", "AQ"},
                                                                                   {"d", "A==="},
                                                                                   {"d", "AQ=D"},
                                                                                   {"hex", "1"},
                                                                                   {"hex", "0x"},
                                                                                   {"vs", "a b"},
                                                                                   {"vs", "\"a\"b\""}}) {
    EXPECT_EQ(encode(type, text), std::nullopt) << type << ' ' << text;
  }
  for (const char* name : {"", "u", "u0", "u7", "u72", "u08", "i", "f32", "q8"})
    EXPECT_FALSE(parse_gateway_type(name)) << name;
}

}  // namespace
}  // namespace canopus::client::gateway_value_test
