#include "canopus/client/sdo_value.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::client::sdo_value_test {
namespace {

using canopen::DataType;
using testing::ElementsAre;
using Bytes = std::vector<std::uint8_t>;

TEST(SdoTypes, EveryName_IsReadAgainAsItself) {
  for (const std::string_view name : type_names()) {
    const auto type = parse_type(name);
    ASSERT_TRUE(type.has_value()) << name;
    EXPECT_EQ(type_name(*type), name);
  }
  EXPECT_EQ(type_names().size(), 23U);
}

TEST(SdoTypes, UnknownName_IsNone) {
  EXPECT_FALSE(parse_type("u99"));
  EXPECT_FALSE(parse_type(""));
}

struct Case {
  const char* text;
  DataType type;
  Bytes bytes;
  const char* shown;
};
class SdoValue : public testing::TestWithParam<Case> {};

TEST_P(SdoValue, IsWrittenAsTheseBytes) {
  const auto bytes = encode_value(GetParam().text, GetParam().type);
  ASSERT_TRUE(bytes.has_value()) << bytes.error();
  EXPECT_EQ(*bytes, GetParam().bytes);
}

TEST_P(SdoValue, IsShownInTheseWords) {
  const auto shown = show_value(GetParam().bytes, GetParam().type);
  ASSERT_TRUE(shown.has_value()) << shown.error();
  EXPECT_EQ(*shown, GetParam().shown);
}

INSTANTIATE_TEST_SUITE_P(
    OfEveryKind, SdoValue,
    testing::Values(
        Case{"true", DataType::boolean, {1}, "true"}, Case{"0", DataType::boolean, {0}, "false"},
        Case{"255", DataType::unsigned8, {0xFF}, "255  FFH"},
        Case{"0x1F4", DataType::unsigned16, {0xF4, 0x01}, "500  01F4H"},
        Case{"1F4H", DataType::unsigned16, {0xF4, 0x01}, "500  01F4H"},
        Case{"66051", DataType::unsigned24, {0x03, 0x02, 0x01}, "66051  010203H"},
        Case{"4294967295", DataType::unsigned32, {0xFF, 0xFF, 0xFF, 0xFF}, "4294967295  FFFFFFFFH"},
        Case{"18446744073709551615",
             DataType::unsigned64,
             {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF},
             "18446744073709551615  FFFFFFFFFFFFFFFFH"},
        Case{"-1", DataType::integer8, {0xFF}, "-1  FFH"},
        Case{"-128", DataType::integer8, {0x80}, "-128  80H"},
        Case{"FFH", DataType::integer8, {0xFF}, "-1  FFH"},
        Case{"-5", DataType::integer16, {0xFB, 0xFF}, "-5  FFFBH"},
        Case{"-8388608", DataType::integer24, {0x00, 0x00, 0x80}, "-8388608  800000H"},
        Case{"-9223372036854775808",
             DataType::integer64,
             {0, 0, 0, 0, 0, 0, 0, 0x80},
             "-9223372036854775808  8000000000000000H"},
        Case{"1.5", DataType::real32, {0x00, 0x00, 0xC0, 0x3F}, "1.5"},
        Case{"-2e3", DataType::real64, {0, 0, 0, 0, 0, 0x40, 0x9F, 0xC0}, "-2000"},
        Case{"drive", DataType::visible_string, {'d', 'r', 'i', 'v', 'e'}, "\"drive\""},
        Case{"Aé€", DataType::unicode_string, {0x41, 0x00, 0xE9, 0x00, 0xAC, 0x20}, "\"Aé€\""},
        Case{"01 a0FF", DataType::octet_string, {0x01, 0xA0, 0xFF}, "01 A0 FF"},
        Case{"", DataType::domain, {}, ""}));

struct Wrong {
  const char* text;
  DataType type;
  const char* error;
};
class WrongSdoValue : public testing::TestWithParam<Wrong> {};

TEST_P(WrongSdoValue, IsRefusedWithWhatWasExpected) {
  const auto bytes = encode_value(GetParam().text, GetParam().type);
  ASSERT_FALSE(bytes.has_value());
  EXPECT_EQ(bytes.error(), GetParam().error);
}

INSTANTIATE_TEST_SUITE_P(
    OfEveryKind, WrongSdoValue,
    testing::Values(
        Wrong{"300", DataType::unsigned8, "300 does not fit u8: expected 0 to 255"},
        Wrong{"-1", DataType::unsigned8, "-1 does not fit u8: expected 0 to 255"},
        Wrong{"100H", DataType::unsigned8, "100H does not fit u8: expected 0 to 255"},
        Wrong{"128", DataType::integer8, "128 does not fit i8: expected -128 to 127"},
        Wrong{"-129", DataType::integer8, "-129 does not fit i8: expected -128 to 127"},
        Wrong{"99999999999999999999", DataType::unsigned64,
              "99999999999999999999 does not fit u64: expected 0 to 18446744073709551615"},
        Wrong{"", DataType::unsigned16,
              R"("" is not a number for u16; expected for example 1234, 0x4D2 or 4D2H)"},
        Wrong{"12x", DataType::unsigned16,
              R"("12x" is not a number for u16; expected for example 1234, 0x4D2 or 4D2H)"},
        Wrong{"1,5", DataType::real32, R"("1,5" is not a number for f32; expected for example 1.5 or -2e3)"},
        Wrong{"yes", DataType::boolean, R"("yes" is not a bool; expected true, false, 1 or 0)"},
        Wrong{"012", DataType::octet_string,
              R"("012" are not bytes; expected pairs of hexadecimal digits, for example "01 A0 FF")"},
        Wrong{"0g", DataType::domain,
              R"("0g" are not bytes; expected pairs of hexadecimal digits, for example "01 A0 FF")"}));

TEST(SdoValueShown, WrongLength_IsToldWithTheBytes) {
  const auto shown = show_value(Bytes{1, 2, 3, 4}, DataType::unsigned16);
  ASSERT_FALSE(shown.has_value());
  EXPECT_EQ(shown.error(), "4 bytes came (01 02 03 04), u16 has 2");
}

TEST(SdoValueShown, TextWithControlCharacters_CannotCommandATerminal) {
  EXPECT_EQ(show_value(Bytes{'a', 0x1B, '"', 'b', 0, 'c'}, DataType::visible_string).value_or(""),
            "\"a\\x1B\\\"b\"");
}

TEST(SdoBytesShown, OfUnknownType_AreBytesAndWhatTheyMayMean) {
  EXPECT_EQ(show_bytes(Bytes{0x95, 0x01, 0x00, 0x00}), "95 01 00 00  405  00000195H");
  EXPECT_EQ(show_bytes(Bytes{'d', 'r', 'i', 'v', 'e'}), "64 72 69 76 65  \"drive\"");
  EXPECT_EQ(show_bytes(Bytes{1, 2, 3}), "01 02 03");
  EXPECT_EQ(show_bytes({}), "no bytes");
}

TEST(SdoValueJson, IsANumberTextOrHexadecimal) {
  EXPECT_EQ(json_value(Bytes{0xFB, 0xFF}, DataType::integer16).dump(), "-5");
  EXPECT_EQ(json_value(Bytes{1}, DataType::boolean).dump(), "true");
  EXPECT_EQ(json_value(Bytes{'a', 'b'}, DataType::visible_string).dump(), "\"ab\"");
  EXPECT_EQ(json_value(Bytes{1, 0xAB}, DataType::domain).dump(), "\"01AB\"");
  EXPECT_EQ(json_value(Bytes{1, 0xAB}, DataType::unsigned32).dump(), "null");
}

RC_GTEST_PROP(SdoValueProperty, EveryUnsigned32_IsReadAgainAsWritten, (std::uint32_t value)) {
  const auto bytes = encode_value(std::to_string(value), DataType::unsigned32);
  RC_ASSERT(bytes.has_value());
  RC_ASSERT(json_value(*bytes, DataType::unsigned32).get<std::uint32_t>() == value);
}

}  // namespace
}  // namespace canopus::client::sdo_value_test
