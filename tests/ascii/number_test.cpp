#include "canopus/ascii/number.hpp"

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::ascii::number_test {
namespace {

/// What the C library reads: the whole text, without what it allows and we do not (blanks, '+', a prefix, '-' of an unsigned number).
std::optional<std::uint64_t> read_by_c(const std::string& text, int base) {
  const bool begins_well = !text.empty() && std::isalnum(static_cast<unsigned char>(text[0])) != 0;
  const bool has_prefix = base == 16 && text.size() > 1 && (text[1] == 'x' || text[1] == 'X');
  if (!begins_well || has_prefix) return std::nullopt;
  char* end = nullptr;
  errno = 0;
  const unsigned long long value = std::strtoull(text.c_str(), &end, base);
  if (errno != 0 || end != text.c_str() + text.size()) return std::nullopt;
  return value;
}

rc::Gen<std::string> texts() {
  return rc::gen::container<std::string>(rc::gen::weightedElement<char>({{6, '0'},
                                                                         {6, '1'},
                                                                         {6, '7'},
                                                                         {6, '9'},
                                                                         {4, 'a'},
                                                                         {4, 'F'},
                                                                         {1, 'g'},
                                                                         {1, 'x'},
                                                                         {1, '-'},
                                                                         {1, '+'},
                                                                         {1, ' '}}));
}

RC_GTEST_PROP(Number, AText_IsTheNumberThatStrtoullReads, ()) {
  const std::string text = *texts();
  for (const int base : {8, 10, 16})
    RC_ASSERT(parse_number<std::uint64_t>(text, base) == read_by_c(text, base));
}

RC_GTEST_PROP(Number, ASmallType_HasNothingBeyondItsRange, ()) {
  const std::string text = std::to_string(*rc::gen::inRange<std::int64_t>(-70'000, 70'000));
  const long value = std::strtol(text.c_str(), nullptr, 10);
  const auto number = parse_number<std::int16_t>(text);
  RC_ASSERT(number.has_value() == (value >= -32768 && value <= 32767));
  if (number) RC_ASSERT(*number == value);
  RC_ASSERT(parse_number<std::uint16_t>(text).has_value() == (value >= 0 && value <= 65535));
}

RC_GTEST_PROP(Number, ARealNumber_IsTheOneThatStrtodReads, (std::int64_t mantissa)) {
  const double value = std::ldexp(static_cast<double>(mantissa), *rc::gen::inRange(-900, 900));
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", *rc::gen::inRange(1, 18), value);
  RC_ASSERT(parse_number<double>(text) == std::strtod(text, nullptr));
}

TEST(Number, OnlyAWholeText_IsANumber) {
  for (const char* const text : {"", " 1", "1 ", "+1", "1.", "0x1", "1u", "--1", "-"}) {
    EXPECT_EQ(parse_number<int>(text), std::nullopt) << text;
    EXPECT_EQ(parse_number_or_error<int>(text).error(), NumberError::no_number) << text;
  }
  EXPECT_EQ(parse_number<int>("-5"), -5);
  EXPECT_EQ(parse_number<unsigned>("-5"), std::nullopt);
  EXPECT_EQ(parse_number<unsigned>("fF", 16), 255U);
  EXPECT_EQ(parse_number<unsigned>(std::string_view{}), std::nullopt);
}

TEST(Number, TooLarge_DiffersFromNoNumber) {
  EXPECT_EQ(parse_number_or_error<std::uint8_t>("255"), 255);
  EXPECT_EQ(parse_number_or_error<std::uint8_t>("256").error(), NumberError::out_of_range);
  EXPECT_EQ(parse_number_or_error<std::int8_t>("-129").error(), NumberError::out_of_range);
  EXPECT_EQ(parse_number_or_error<std::uint8_t>("256x").error(), NumberError::no_number);
  EXPECT_EQ(parse_number_or_error<std::uint8_t>("-1").error(), NumberError::no_number);
}

TEST(Number, RealNumbers_AreWholeTextsWithinTheRange) {
  EXPECT_EQ(parse_number<double>("-2e3"), -2000.0);
  EXPECT_EQ(parse_number<double>("inf"), HUGE_VAL);
  EXPECT_TRUE(std::isnan(parse_number<double>("nan").value_or(0)));
  for (const char* const text : {"", "1.5 ", " 1", "+1", "1,5", "1e", "1e999", "1e-999", "x"})
    EXPECT_EQ(parse_number<double>(text), std::nullopt) << text;
  EXPECT_EQ(parse_number<float>("1e39"), std::nullopt);
}

TEST(Number, APrefix_MakesItHexadecimal) {
  EXPECT_EQ(parse_number_with_prefix<unsigned>("31"), 31U);
  EXPECT_EQ(parse_number_with_prefix<unsigned>("0x1f"), 31U);
  EXPECT_EQ(parse_number_with_prefix<unsigned>("0X1F"), 31U);
  for (const char* const text : {"", "0x", "1F", "0x-1", "0x0x1", "-0x1", "0x100000000"})
    EXPECT_EQ(parse_number_with_prefix<unsigned>(text), std::nullopt) << text;
}

TEST(Number, ANumberThatIsAlwaysHexadecimal_HasAPrefixOrALetterBehindItOrNeither) {
  for (const char* const text : {"1f", "0x1F", "0X1f", "1FH", "1fh", "0x1FH"})
    EXPECT_EQ(parse_hexadecimal<unsigned>(text), 31U) << text;
  for (const char* const text : {"", "0x", "H", "0xH", "1FHH", " 1F", "1G"})
    EXPECT_EQ(parse_hexadecimal<unsigned>(text), std::nullopt) << text;
  EXPECT_EQ(parse_hexadecimal<std::uint8_t>("100"), std::nullopt);
}

}  // namespace
}  // namespace canopus::ascii::number_test
