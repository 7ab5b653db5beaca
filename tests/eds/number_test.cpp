#include "canopus/eds/number.hpp"

#include <cstdio>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::eds::number_test {
namespace {

using canopus::eds::Number;
using canopus::eds::read_number;
using canopus::eds::read_real;

struct Case {
  const char* text;
  std::uint64_t bits;
  bool adds_node_id;
  const char* overlooked;
};

class NumberAsWritten : public testing::TestWithParam<Case> {};

TEST_P(NumberAsWritten, Number_IsReadAsAPersonWould) {
  const auto number = read_number(GetParam().text);
  ASSERT_TRUE(number);
  EXPECT_EQ(number->bits(), GetParam().bits);
  EXPECT_EQ(number->adds_node_id, GetParam().adds_node_id);
  EXPECT_EQ(number->overlooked, GetParam().overlooked);
}

INSTANTIATE_TEST_SUITE_P(
    Spellings, NumberAsWritten,
    testing::Values(
        Case{"0", 0, false, ""}, Case{"12", 12, false, ""}, Case{"-1", 0xFFFF'FFFF'FFFF'FFFF, false, ""},
        Case{"+3", 3, false, ""}, Case{"0x1F", 0x1F, false, ""}, Case{"0X1f", 0x1F, false, ""},
        Case{"010", 8, false, "a leading 0 makes it octal"}, Case{"0000", 0, false, ""},
        Case{"007", 7, false, ""}, Case{"089", 89, false, ""},
        Case{"0xFFFFFFFFFFFFFFFF", 0xFFFF'FFFF'FFFF'FFFF, false, ""},
        Case{"1AH", 0x1A, false, "hexadecimal without 0x"}, Case{"FF", 0xFF, false, "hexadecimal without 0x"},
        Case{"8U", 8, false, "letters behind the number"},
        Case{"0x3ED ; prevent homing", 0x3ED, false, "a comment behind the number"},
        Case{"\"5\"", 5, false, "quotes round the number"}, Case{"0x12 34", 0x1234, false, "blanks inside"},
        Case{"5.0", 5, false, "a fraction where a whole number belongs"}, Case{"$NODEID", 0, true, ""},
        Case{"$NODEID+0x180", 0x180, true, ""}, Case{"$NODEID+384", 384, true, ""},
        Case{"$NodeID+0x80", 0x80, true, "not written as $NODEID+number"},
        Case{"$NODEID + 0x600", 0x600, true, "not written as $NODEID+number"},
        Case{"$NODEID +0x80", 0x80, true, "not written as $NODEID+number"},
        Case{"1280+$NODEID", 1280, true, "not written as $NODEID+number"},
        Case{"NODEID+1", 1, true, "not written as $NODEID+number"}));

INSTANTIATE_TEST_SUITE_P(
    Formulas, NumberAsWritten,
    testing::Values(Case{"$NODEID+0x80000000+0x200", 0x8000'0200, true, "not written as $NODEID+number"},
                    Case{"0x80000000+0x200+$NODEID", 0x8000'0200, true, "not written as $NODEID+number"},
                    Case{"0x200 + $nodeid + 0x80000000", 0x8000'0200, true, "not written as $NODEID+number"},
                    Case{"0x80000000+($NODEID+0x200)", 0x8000'0200, true, "not written as $NODEID+number"},
                    Case{"$NODEID+0x280-0x80", 0x200, true, "not written as $NODEID+number"},
                    Case{"2*0x100+$NODEID", 0x200, true, "not written as $NODEID+number"},
                    Case{"$NODEID*1+512", 512, true, "not written as $NODEID+number"},
                    Case{"-16+$NODEID", 0xFFFF'FFFF'FFFF'FFF0, true, "not written as $NODEID+number"},
                    Case{"$NODEID+512 ; RPDO1", 512, true, "a comment behind the number"},
                    Case{"0x80000000+0x200", 0x8000'0200, false, "a formula where a number belongs"}));

RC_GTEST_PROP(Number, AnyOf64Bits_InEveryUsualSpelling, ()) {
  const auto any = *rc::gen::arbitrary<std::uint64_t>();
  const std::uint64_t value = any >> *rc::gen::inRange(0, 64);
  const auto same = [&](const std::string& text, bool hexadecimal) {
    const auto number = read_number(text);
    return number && number->magnitude == value && number->hexadecimal == hexadecimal && !number->negative &&
           !number->adds_node_id && number->overlooked.empty();
  };
  char text[32];
  RC_ASSERT(same(std::to_string(value), false));
  for (const char* form : {"0x%llx", "0x%llX", "0X%llx", "0x%016llX"}) {
    std::snprintf(text, sizeof text, form, static_cast<unsigned long long>(value));
    RC_ASSERT(same(text, true));
  }
}

class NoNumber : public testing::TestWithParam<const char*> {};

TEST_P(NoNumber, Number_IsRefusedWhereNobodyCouldReadOne) { EXPECT_FALSE(read_number(GetParam())); }

INSTANTIATE_TEST_SUITE_P(Texts, NoNumber,
                         testing::Values("", "0x", "-", "N/A", "12 apples", "0x10000000000000000",
                                         "99999999999999999999", "$NODEID*2", "1 << 3", "0x0x1", "--1",
                                         "$NODEID+$NODEID", "0x1G", "0x@", "12:", "1 2 apples",
                                         "0x123456789012345678", "$NODEID+", "+", "$NODEID 0x200",
                                         "2*$NODEID", "-$NODEID", "($NODEID+0x200", "$NODEID+0x200)",
                                         "$NODEID+()", "12-10-2024", "1+2", "$NODEID+0xFFFFFFFFFFFFFFFF+1",
                                         "$NODEID**2", "(((((((((($NODEID))))))))))", "face-b",
                                         "$NODEID+banana"));

TEST(Real, Real_TakesPointAndComma) {
  EXPECT_EQ(read_real("1.5"), 1.5);
  EXPECT_EQ(read_real("1,5"), 1.5);
  EXPECT_EQ(read_real("-3e-4"), -3e-4);
  EXPECT_EQ(read_real("2.0f"), 2.0);
}

TEST(Real, Real_IsNotReadFromHexadecimal) { EXPECT_FALSE(read_real("0x3F800000")); }

}  // namespace
}  // namespace canopus::eds::number_test
