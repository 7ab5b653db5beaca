#include "canopus/ascii/hex.hpp"

#include <array>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::ascii::hex_test {
namespace {

/// What the C library writes.
std::string printed(const char* format, int digits, std::uint64_t value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, digits, static_cast<unsigned long long>(value));
  return text.data();
}

RC_GTEST_PROP(Hex, ANumber_IsWhatPrintfWrites, (std::uint64_t value)) {
  const int digits = *rc::gen::inRange(1, 17);
  const std::uint64_t shown = value >> *rc::gen::inRange(0, 64);
  RC_ASSERT(hex(shown, digits) == printed("%0*llX", digits, shown));
  RC_ASSERT(lower_hex(shown, digits) == printed("%0*llx", digits, shown));
}

TEST(Hex, ANumberThatNeedsMoreDigits_HasThem) {
  EXPECT_EQ(hex(0x12345, 4), "12345");
  EXPECT_EQ(hex(0), "0");
  EXPECT_EQ(hex(0, 0), "");
  EXPECT_EQ(hex(0xFFFF'FFFF'FFFF'FFFF), "FFFFFFFFFFFFFFFF");
  EXPECT_EQ(lower_hex(0xAB), "ab");
}

TEST(Hex, WrittenDigits_AreTheLowestOnes) {
  std::string text = "........";
  char* const end = write_hex(text.data(), 0x1FFF'F7E5, 3);
  EXPECT_EQ(text, "7E5.....");
  EXPECT_EQ(end, text.data() + 3);
  EXPECT_EQ(write_hex(end, 0xA, 2), end + 2);
  EXPECT_EQ(text, "7E50A...");
  EXPECT_EQ(write_hex(end, 0xA, 0), end);
}

TEST(Hex, EachCharacter_IsADigitIfTheCLibrarySaysSo) {
  for (int code = 0; code < 256; ++code) {
    const char c = static_cast<char>(code);
    const std::string text(1, c);
    const auto value = hex_value(c);
    EXPECT_EQ(value.has_value(), code < 128 && std::isxdigit(code) != 0) << code;
    EXPECT_EQ(is_hex(text), value.has_value()) << code;
    if (value.has_value()) {
      EXPECT_EQ(*value, std::strtoul(text.c_str(), nullptr, 16)) << code;
    }
  }
  EXPECT_FALSE(is_hex(""));
  EXPECT_TRUE(is_hex("0aF9"));
  EXPECT_FALSE(is_hex("0x1"));
}

TEST(Hex, Bytes_AreTwoDigitsEach) {
  const std::vector<std::uint8_t> bytes{0x01, 0xA0, 0xFF};
  EXPECT_EQ(hex_bytes(bytes), "01A0FF");
  EXPECT_EQ(hex_bytes(bytes, " "), "01 A0 FF");
  EXPECT_EQ(hex_bytes({}, " "), "");
}

TEST(Hex, PairsOfDigits_AreBytes) {
  EXPECT_EQ(bytes_of_hex("01a0Ff"), (std::vector<std::uint8_t>{0x01, 0xA0, 0xFF}));
  EXPECT_EQ(bytes_of_hex(""), std::vector<std::uint8_t>{});
  for (const char* const text : {"1", "01a", "0g", "g0", " 1", "01 02", "0x", "-1", "+1"})
    EXPECT_EQ(bytes_of_hex(text), std::nullopt) << text;
  EXPECT_EQ(byte_of_hex("9F"), 0x9F);
  for (const char* const text : {"", "9", "09F", "-9", " 9"})
    EXPECT_EQ(byte_of_hex(text), std::nullopt) << text;
}

RC_GTEST_PROP(Hex, AByte_IsWhatStrtoulReads, (std::uint8_t byte)) {
  const std::string text = hex_bytes(std::vector{byte});
  RC_ASSERT(text.size() == 2U);
  RC_ASSERT(std::strtoul(text.c_str(), nullptr, 16) == byte);
  RC_ASSERT(byte_of_hex(printed("%0*llx", 2, byte)) == byte);
}

}  // namespace
}  // namespace canopus::ascii::hex_test
