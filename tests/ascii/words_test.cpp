#include "canopus/ascii/words.hpp"

#include <cctype>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <strings.h>

namespace canopus::ascii::words_test {
namespace {

/// Characters with ctype.h of the C locale as the second witness; none beyond 7FH is a letter or digit.
TEST(Words, EachCharacter_IsOfTheKindThatTheCLibrarySays) {
  for (int code = 0; code < 256; ++code) {
    const char c = static_cast<char>(code);
    const bool is_ascii = code < 128;
    EXPECT_EQ(is_digit(c), is_ascii && std::isdigit(code) != 0) << code;
    EXPECT_EQ(is_letter(c), is_ascii && std::isalpha(code) != 0) << code;
    EXPECT_EQ(is_blank(c), is_ascii && std::isblank(code) != 0) << code;
    EXPECT_EQ(lower(c), is_ascii ? static_cast<char>(std::tolower(code)) : c) << code;
    EXPECT_EQ(upper(c), is_ascii ? static_cast<char>(std::toupper(code)) : c) << code;
  }
  EXPECT_EQ(lower("Gerät-7 AZ"), "gerät-7 az");
  EXPECT_EQ(upper("Gerät-7 az"), "GERäT-7 AZ");
}

rc::Gen<std::string> lines() {
  return rc::gen::container<std::string>(rc::gen::elementOf(std::string("aAzZ@[`{0 \t")));
}

RC_GTEST_PROP(Words, TwoTexts_AreEqualIfStrcasecmpSaysSo, ()) {
  const std::string a = *lines();
  const std::string b = *rc::gen::oneOf(lines(), rc::gen::just(upper(a)), rc::gen::just(lower(a)));
  RC_ASSERT(equal_ignoring_case(a, b) == (::strcasecmp(a.c_str(), b.c_str()) == 0));
}

RC_GTEST_PROP(Words, TheWordsOfALine_AreThoseOfAStream, ()) {
  const std::string line = *lines();
  std::vector<std::string> expected;
  std::istringstream stream(line);
  for (std::string word; stream >> word;) expected.push_back(word);
  const auto found = words(line);
  RC_ASSERT(std::vector<std::string>(found.begin(), found.end()) == expected);
}

TEST(Words, TrimmedText_HasNoBlanksAtItsEnds) {
  EXPECT_EQ(trim(" \t a b\t "), "a b");
  EXPECT_EQ(trim(" \t "), "");
  EXPECT_EQ(trim(""), "");
  EXPECT_EQ(trim("\na\r"), "\na\r");
  EXPECT_EQ(trim("--a-b-", [](char c) { return c == '-'; }), "a-b");
}

TEST(Words, AWordTaken_LeavesTheRestWithItsBlanks) {
  std::string_view text = "  set 6000:01\t5 ";
  EXPECT_EQ(next_word(text), "set");
  EXPECT_EQ(text, " 6000:01\t5 ");
  EXPECT_EQ(next_word(text), "6000:01");
  EXPECT_EQ(next_word(text), "5");
  EXPECT_EQ(next_word(text), "");
  EXPECT_EQ(text, "");
  text = "a\nb";
  EXPECT_EQ(next_word(text, [](char c) { return c == '\n'; }), "a");
  EXPECT_EQ(text, "\nb");
}

TEST(Words, APartOfAText_IsFoundInEitherCase) {
  EXPECT_TRUE(contains_ignoring_case("Producer Heartbeat Time", "heartBEAT"));
  EXPECT_FALSE(contains_ignoring_case("Producer Heartbeat Time", "heartbeats"));
  EXPECT_TRUE(contains_ignoring_case("", ""));
  EXPECT_FALSE(contains_ignoring_case("", "a"));
}

}  // namespace
}  // namespace canopus::ascii::words_test
