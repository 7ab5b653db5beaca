#include "canopus/eds/ini.hpp"

#include <gtest/gtest.h>

namespace canopus::eds::ini_test {
namespace {

using namespace canopus::eds;

struct Read {
  Problems problems;
  IniFile file;
  explicit Read(std::string_view text) : file(text, problems) {}
  std::string first_problem() {
    const auto list = problems.release();
    if (list.empty()) return "";
    return std::to_string(list[0].line) + ": " + std::string(name(list[0].severity)) + ": " + list[0].message;
  }
};

TEST(Ini, Key_IsFoundWithoutRegardToCase) {
  Read read("[DeviceInfo]\nVENDORNAME = Acme \n");
  const Section* section = read.file.find("deviceinfo");
  ASSERT_NE(section, nullptr);
  ASSERT_NE(section->find("vendorname"), nullptr);
  EXPECT_EQ(section->find("vendorname")->value, "Acme");
  EXPECT_EQ(section->find("vendorname")->line, 2U);
  EXPECT_EQ(section->find("vendorname")->column, 14U);
}

TEST(Ini, Key_WithABlankInside_IsFoundAndNoted) {
  Read read("[A]\nSupported Objects=3\n");
  EXPECT_EQ(read.file.find("a")->find("supportedobjects")->value, "3");
  EXPECT_EQ(read.first_problem(), "2: note: key \"Supported Objects\" is written with a blank");
}

TEST(Ini, Lines_AreCountedTheSameWithAnyLineEnd) {
  for (const std::string_view text : {"[A]\n\nX=1\n", "[A]\r\n\r\nX=1\r\n", "[A]\r\rX=1\r", "[A]\n\nX=1"}) {
    Read read(text);
    EXPECT_EQ(read.file.find("a")->find("x")->line, 3U) << text;
    EXPECT_EQ(read.file.find("a")->find("x")->value, "1");
  }
}

TEST(Ini, Semicolon_InsideAValue_IsKept) {
  Read read("[A]\nParameterName=Speed; filtered\n");
  EXPECT_EQ(read.file.find("a")->find("parametername")->value, "Speed; filtered");
}

TEST(Ini, Key_ComingTwiceInALongSection_IsFound_WhereverItCameFirst) {
  for (const unsigned first : {0U, 1U, 23U, 24U, 25U, 199U}) {
    std::string text = "[A]\n";
    for (unsigned i = 0; i < 200; ++i) text += "Key" + std::to_string(i) + "=" + std::to_string(i) + "\n";
    text += "[B]\nKey0=1\n[A]\nKEY" + std::to_string(first) + "=other\nNew=1\n";
    Read read(text);
    const Section* section = read.file.find("a");
    EXPECT_EQ(section->items.size(), 201U) << first;
    EXPECT_EQ(section->find("key" + std::to_string(first))->value, std::to_string(first));
    EXPECT_EQ(section->find("new")->line, 206U);
    EXPECT_EQ(read.file.find("b")->items.size(), 1U);
  }
}

TEST(Ini, Section_ComingTwice_IsJoinedAndTheFirstValueCounts) {
  Read read("[A]\nX=1\n[B]\n[A]\nX=2\nY=3\n");
  EXPECT_EQ(read.file.find("a")->find("x")->value, "1");
  EXPECT_EQ(read.file.find("a")->find("y")->value, "3");
  EXPECT_EQ(read.first_problem(),
            "4: warning: section [A] was in line 1 before: only what is new in it counts");
}

TEST(Ini, Utf16Text_IsConverted) {
  const std::string text("\xFF\xFE[\0A\0]\0\n\0X\0=\0\xE4\0\n\0", 18);
  Read read(text);
  ASSERT_NE(read.file.find("a"), nullptr);
  EXPECT_EQ(read.file.find("a")->find("x")->value, "\xC3\xA4");
}

TEST(Ini, ByteOrderMark_DoesNotHideTheFirstSection) {
  Read read("\xEF\xBB\xBF[A]\nX=1\n");
  EXPECT_NE(read.file.find("a"), nullptr);
}

TEST(Ini, Section_WithoutClosingBracket_IsRead) {
  Read read("[DeviceInfo\nX=1\n");
  EXPECT_NE(read.file.find("deviceinfo"), nullptr);
  EXPECT_EQ(read.first_problem(), "1: warning: section \"[DeviceInfo\" has no closing bracket");
}

TEST(Ini, StrangeLine_IsSkippedWithItsNumber) {
  Read read("[A]\nX=1\nwhat is this\n");
  EXPECT_EQ(read.first_problem(),
            "3: warning: neither [section] nor Key=Value nor ;comment: skipped: \"what is this\"");
  EXPECT_EQ(read.file.strange_lines(), 1U);
}

TEST(Ini, BytesThatAreNotUtf8_AreSeenWhereverTheyStand) {
  for (std::size_t length = 1; length < 40; ++length) {
    for (std::size_t place = 0; place < length; ++place) {
      std::string value(length, 'x');
      EXPECT_EQ(Read("[A]\nK=" + value + "\n").first_problem(), "");
      value[place] = '\xE4';
      EXPECT_EQ(Read("[A]\nK=" + value + "\n").first_problem(),
                "2: note: bytes that are not UTF-8: read as Windows Latin text")
          << length << " " << place;
    }
  }
}

TEST(Problems, Repeated_AreToldOnceAndCounted) {
  Problems problems;
  for (unsigned line = 5; line < 9; ++line) problems.repeated(Problem::Severity::note, "kind", line, "odd");
  const auto list = problems.release();
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].line, 5U);
  EXPECT_EQ(list[0].message, "odd (and in 3 more places)");
}

TEST(Problems, List_IsWorstFirstThenByLine) {
  Problems problems;
  problems.note(1, "n");
  problems.warning(9, "w9");
  problems.warning(4, "w4");
  problems.error(7, "e");
  std::string order;
  for (const Problem& problem : problems.release()) order += problem.message + ' ';
  EXPECT_EQ(order, "e w4 w9 n ");
}

}  // namespace
}  // namespace canopus::eds::ini_test
