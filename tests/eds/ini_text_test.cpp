// A file that is changed in one place stays the same in all others.

#include "canopus/eds/ini_text.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/ascii/words.hpp"
// rapidcheck/gtest.h wants GoogleTest before it
#include <rapidcheck/gtest.h>

#include "canopus/eds/ini.hpp"
#include "canopus/eds/words.hpp"

#include "eds/reading.hpp"
#include "paths.hpp"

namespace canopus::eds::ini_text_test {
namespace {

using namespace canopus::eds;

/// Its error, or nothing.
std::string set(IniText& text, std::string_view section, std::string_view key, std::string_view value) {
  const auto done = text.set(section, key, value);
  return done ? "" : done.error();
}

std::string after(std::string_view before, std::string_view section, std::string_view key,
                  std::string_view value) {
  IniText text(before);
  const std::string error = set(text, section, key, value);
  return error.empty() ? text.text() : "refused: " + error;
}

std::vector<std::string> split(std::string_view text) {
  const char end = text.find('\n') == std::string_view::npos ? '\r' : '\n';
  std::vector<std::string> lines(1);
  for (const char c : text) {
    if (c == end) {
      lines.emplace_back();
    } else {
      lines.back() += c;
    }
  }
  return lines;
}

/// Lines that differ; all of them when the number of lines does.
std::size_t changed_lines(std::string_view a, std::string_view b) {
  const auto before = split(a);
  const auto now = split(b);
  if (before.size() != now.size()) return std::max(before.size(), now.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < now.size(); ++i) count += before[i] != now[i] ? 1 : 0;
  return count;
}

TEST(IniText, Unchanged_IsTheSameBytes) {
  for (const std::string& text :
       {std::string(), std::string("\n"), std::string("[A]"), std::string("\xEF\xBB\xBF[A]\r\nX=1"),
        std::string("\xFF\xFE[\0A\0]\0", 8), std::string("[A]\rX=1\r"), std::string("x\0[A\n\x1A", 6),
        std::string("[A]\r\nX=1\r\n\x1A\0\0", 13), std::string("[A]\nX=1\x1A\n[B]\n"),
        std::string("\r\r\n\n\r")}) {
    EXPECT_EQ(IniText(text).text(), text) << testing::PrintToString(text);
  }
}

TEST(IniText, Value_IsReplacedInItsPlace_BlanksAndLineEndStay) {
  EXPECT_EQ(
      after("; c\r\n[Dev Info]\r\n  vendor_name \t=  Acme \r\nY=2\r\n", "DevInfo", "VendorName", "Bolt"),
      "; c\r\n[Dev Info]\r\n  vendor_name \t=  Bolt \r\nY=2\r\n");
  EXPECT_EQ(after("[A]\nX=", "a", "x", "1"), "[A]\nX=1");
  EXPECT_EQ(after("[A]\nX= \n", "a", "x", "1"), "[A]\nX= 1\n");
  EXPECT_EQ(after("[A]\nX=1\n", "a", "x", ""), "[A]\nX=\n");
  EXPECT_EQ(after("[A]\rX=1\rY=1\r", "a", "x", "2"), "[A]\rX=2\rY=1\r");
  EXPECT_EQ(after("[A]\nX=a=b\n", "a", "x", "c=d"), "[A]\nX=c=d\n");
  EXPECT_EQ(after("\xEF\xBB\xBF[A]\nX=1\n", "a", "x", "2"), "\xEF\xBB\xBF[A]\nX=2\n");
}

TEST(IniText, CommentBehindANumber_StaysWhenItIsANumberAgain) {
  EXPECT_EQ(after("[A]\nX=0x10 ; a comment\n", "a", "x", "7"), "[A]\nX=7 ; a comment\n");
  EXPECT_EQ(after("[A]\nX=$NODEID+0x200;note\n", "a", "x", "5"), "[A]\nX=5;note\n");
  EXPECT_EQ(after("[A]\nX=0x10 ; a comment\n", "a", "x", "ten"), "[A]\nX=ten\n");
  EXPECT_EQ(after("[A]\nX=Speed; filtered\n", "a", "x", "7"), "[A]\nX=7\n");
}

TEST(IniText, KeyThatComesTwice_IsChangedWhereItCounts) {
  EXPECT_EQ(after("[A]\nX=1\n[B]\nX=5\n[a]\nX=2\nX=3\n", "A", "X", "4"),
            "[A]\nX=4\n[B]\nX=5\n[a]\nX=2\nX=3\n");
}

TEST(IniText, NewKey_IsTheLastOfItsSection) {
  EXPECT_EQ(after("[A]\r\nX=1\r\n\r\n; of B\r\n[B]\r\nX=1\r\n", "a", "New", "2"),
            "[A]\r\nX=1\r\nNew=2\r\n\r\n; of B\r\n[B]\r\nX=1\r\n");
  EXPECT_EQ(after("[A]\n[B]\nX=1", "A", "New", "2"), "[A]\nNew=2\n[B]\nX=1");
  EXPECT_EQ(after("[A]\nX=1", "A", "New", "2"), "[A]\nX=1\nNew=2");
  EXPECT_EQ(after("[A]\rX=1\r", "A", "New", "2"), "[A]\rX=1\rNew=2\r");
  EXPECT_EQ(after("[A]\r\nX=1\r", "A", "New", "2"), "[A]\r\nX=1\r\nNew=2");
  EXPECT_EQ(after("[A]\nX=1\r", "A", "New", "2"), "[A]\nX=1\r\nNew=2")
      << "a carriage return alone at the end";
  EXPECT_EQ(after("[A]\r\nX=1\x1A", "A", "New", "2"), "[A]\r\nX=1\r\nNew=2\x1A")
      << "before the DOS end of file";
}

TEST(IniText, NewSection_IsTheLastOfTheFile) {
  EXPECT_EQ(after("", "A", "X", "1"), "[A]\r\nX=1\r\n");
  EXPECT_EQ(after("[A]\nX=1\n", "B", "Y", "2"), "[A]\nX=1\n\n[B]\nY=2\n");
  EXPECT_EQ(after("[A]\nX=1\n\n", "B", "Y", "2"), "[A]\nX=1\n\n[B]\nY=2\n");
  EXPECT_EQ(after("[A]\r\nX=1\r\n\x1A", "B", "Y", "2"), "[A]\r\nX=1\r\n\r\n[B]\r\nY=2\r\n\x1A");
}

TEST(IniText, KeysThatWereAdded_AreFoundAndChangedAfterwards) {
  IniText text("[A]\nX=1\n[B]\nY=1\n");
  for (int i = 0; i < 50; ++i) {
    ASSERT_EQ(set(text, "A", "K" + std::to_string(i), "0"), "");
    ASSERT_EQ(set(text, "B", "K" + std::to_string(i), "0"), "");
  }
  ASSERT_EQ(set(text, "B", "y", "9"), "");
  ASSERT_EQ(set(text, "A", "K7", "9"), "");
  EXPECT_EQ(text.value("B", "Y"), "9");
  EXPECT_EQ(text.value("A", "K7"), "9");
  EXPECT_EQ(text.section_line("B"), 53U);
  EXPECT_EQ(text.section_line("C"), 0U);
  EXPECT_EQ(text.line("B", "Y"), 54U);
  EXPECT_EQ(text.keys("A").size(), 51U);
  EXPECT_EQ(text.keys("B").back(), "k49");
  EXPECT_EQ(IniText(text.text()).value("B", "K49"), "0");
}

TEST(IniText, WhatWouldNotBeReadAgain_IsRefused) {
  const std::string_view file = "[A]\nX=1\n";
  for (const std::string_view value : {" 1", "1 ", "a\nb", "a\rb", "\t", "\xFF"}) {
    EXPECT_TRUE(after(file, "A", "X", value).starts_with("refused: value \"")) << value;
  }
  EXPECT_TRUE(after(file, "A", "X", std::string_view("\0", 1)).starts_with("refused: value \""));
  for (const std::string_view key :
       {"", " ", "_", "a=b", "[a", ";a", "#a", "//a", " a", "a\nb", "\xC3\xA4"}) {
    EXPECT_TRUE(after(file, "A", key, "1").starts_with("refused: key ")) << key;
  }
  for (const std::string_view section : {"", "a]", "a\nb", " b", "[a", "\xC3\xA4"}) {
    EXPECT_TRUE(after(file, section, "X", "1").starts_with("refused: section ")) << section;
  }
}

TEST(IniText, Umlaut_IsWrittenAsTheFileIsEncoded) {
  EXPECT_EQ(after("[A]\nX=1\n", "A", "X", "\xC3\xBC"), "[A]\nX=\xC3\xBC\n") << "plain ASCII: UTF-8";
  EXPECT_EQ(after("[A]\nX=1\nY=\xE4\n", "A", "X", "\xC3\xBC"), "[A]\nX=\xFC\nY=\xE4\n") << "Windows Latin";
  EXPECT_EQ(after("[A]\nX=1\nY=\xE4\n", "A", "X", "\xE2\x82\xAC"), "[A]\nX=\x80\nY=\xE4\n")
      << "CP1252 has the euro";
  EXPECT_TRUE(after("[A]\nX=1\nY=\xE4\n", "A", "X", "\xE7\x94\xB5").starts_with("refused: "))
      << "no Chinese letter in it";
  EXPECT_TRUE(after("[A]\nX=1\nY=\xE4\n", "A", "X", "\xC3\x83\xC2\xBC").starts_with("refused: "))
      << "reads as UTF-8";
  EXPECT_EQ(IniText("[A]\nY=\xE4\n").value("A", "Y"), "\xC3\xA4");
}

TEST(IniText, Utf16_IsChangedAsUtf16) {
  const std::string text(
      "\xFF\xFE[\0A\0]\0\n\0X\0=\0"
      "1\0",
      16);
  IniText file(text);
  EXPECT_EQ(file.text(), text);
  EXPECT_EQ(set(file, "A", "X", "2"), "");
  std::string changed = text;
  changed[14] = '2';
  EXPECT_EQ(file.text(), changed);
  ASSERT_TRUE(file.remove("A", "X"));
  EXPECT_EQ(file.text(), text.substr(0, 10));
}

TEST(IniText, DamagedUtf16_IsKeptButNotChanged) {
  for (const std::string& text :
       {std::string("\xFF\xFE[\0A\0]", 7), std::string("\xFF\xFE[\0\0\xD8]\0", 8)}) {
    IniText file(text);
    EXPECT_EQ(file.problem(), "the file is not the UTF-16LE text that it begins as: save it as UTF-8 text");
    EXPECT_NE(set(file, "A", "X", "2"), "");
    EXPECT_FALSE(file.remove("A", "X").has_value());
    EXPECT_EQ(file.text(), text);
  }
}

TEST(IniText, LargerThan4MiB_IsKeptButNeitherReadNorChanged) {
  const std::string text = "[A]\nX=1\n" + std::string(std::size_t{4} << 20, '\n');
  IniText file(text);
  EXPECT_EQ(file.problem(), "the file has 4194312 bytes; expected at most 4194304");
  EXPECT_EQ(file.value("A", "X"), std::nullopt);
  EXPECT_EQ(set(file, "A", "X", "2"), file.problem());
  EXPECT_EQ(file.text(), text);
  EXPECT_EQ(IniText(text.substr(0, std::size_t{4} << 20)).value("A", "X"), "1");
}

TEST(IniText, RemovedKey_IsGoneWithAllItsLines) {
  IniText text("[A]\nX=1\n; X=c\nY=2\n[B]\nX=1\n[A]\nx=3\n_x = 4");
  ASSERT_TRUE(text.remove("A", "X"));
  EXPECT_EQ(text.text(), "[A]\n; X=c\nY=2\n[B]\nX=1\n[A]\n");
  ASSERT_TRUE(text.remove("A", "none"));
  EXPECT_EQ(text.text(), "[A]\n; X=c\nY=2\n[B]\nX=1\n[A]\n");

  std::string many = "[A]\n";
  for (int i = 0; i < 20'000; ++i) many += "X=1\n";
  IniText repeated(many);
  ASSERT_TRUE(repeated.remove("A", "X"));
  EXPECT_EQ(repeated.text(), "[A]\n");
}

rc::Gen<std::string> any_file() {
  return rc::gen::map(
      rc::gen::container<std::vector<std::string>>(rc::gen::element<std::string>(
          "[A]", "[B]", "[a ", "X=", "Y=1", "X=2;c", " ", "\t", "\r\n", "\n", "\r\n", "\r", ";", "#", "=",
          "\xE4", "\xC3\xA4", std::string(1, '\0'), "\x1A", "]", "Key=Value", "\xEF\xBB\xBF", "//")),
      [](const std::vector<std::string>& parts) {
        std::string text;
        for (const std::string& part : parts) text += part;
        return text;
      });
}

RC_GTEST_PROP(IniText, AnyFile_IsWrittenAsItWasRead, ()) {
  const std::string text = *any_file();
  RC_ASSERT(IniText(text).text() == text);
}

// Judged by IniFile, which has lines, columns and values of its own.
RC_GTEST_PROP(IniText, AnyValue_ThatIsSet_IsReadAgain_AndOneLineDiffers, ()) {
  const std::string before =
      *rc::gen::element<std::string>("[A]\nX=1\n", "[A]\r\nX=1", "[A]\rX=1\r", "[A]\nX=\n[B]\n") +
      *any_file();
  Problems unheard;
  const IniFile file(before, unheard);
  std::vector<std::pair<std::string, std::string>> places;
  for (const Section& section : file.sections()) {
    for (const Item& item : section.items) places.emplace_back(section.folded_name, item.folded_key);
  }
  if (places.empty()) return;  // the line feed that came behind made it one line
  const auto [section, key] = *rc::gen::elementOf(places);
  const std::string value = *rc::gen::element<std::string>("", "5", "0x1F", "New name", "x=y", "\xC3\xBC");
  IniText text(before);
  RC_ASSERT(text.line(section, key) == file.find(section)->find(key)->line);
  if (!text.set(section, key, value)) {
    RC_ASSERT(text.text() == before);
    return;
  }
  RC_ASSERT(changed_lines(before, text.text()) <= 1);
  const IniFile again(text.text(), unheard);
  for (const auto& [other_section, other_key] : places) {
    const std::string& now = again.find(other_section)->find(other_key)->value;
    const std::string& then = file.find(other_section)->find(other_key)->value;
    if (other_section != section || other_key != key) {
      RC_ASSERT(now == then);
    } else {
      const std::size_t comment = then.find(';');
      RC_ASSERT(now == value || now == "\xFC" ||
                (comment != std::string::npos && now.starts_with(value) &&
                 trim(now.substr(value.size())) == then.substr(comment)));
    }
  }
}

RC_GTEST_PROP(IniText, AnyKey_ThatIsAdded_IsReadAgain_AndTheRestStays, ()) {
  const std::string before = *any_file();
  const std::string section = *rc::gen::element<std::string>("A", "B", "New section");
  IniText text(before);
  if (!text.set(section, "Added", "5")) {
    RC_ASSERT(text.text() == before);
    return;
  }
  Problems unheard;
  const IniFile file(before, unheard);
  const IniFile again(text.text(), unheard);
  RC_ASSERT(text.value(section, "Added") == "5");
  RC_ASSERT(again.find(folded(section))->find("added")->value == "5");
  for (const Section& old : file.sections()) {
    for (const Item& item : old.items) {
      RC_ASSERT(again.find(old.folded_name)->find(item.folded_key)->value == item.value);
    }
  }
  RC_ASSERT(text.remove(section, "Added").has_value());
  RC_ASSERT(!text.value(section, "Added").has_value());
  RC_ASSERT(again.sections().size() >= file.sections().size());
}

// Some values of every real file, one at a time.
TEST(IniText, RealFiles_ChangedInOneValue_DifferInOneLine) {
  const std::filesystem::path folder = CANOPUS_SOURCE_DIR "/../shared/data";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no device files in " << folder;
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string extension = ascii::lower(entry.path().extension().string());
    if (extension != ".eds" && extension != ".dcf" && extension != ".cpj") continue;
    const std::string before = test::read_text(entry.path()).value_or("");
    IniText text(before);
    ASSERT_EQ(text.text(), before) << entry.path();
    ++files;
    if (!text.problem().empty()) continue;
    std::size_t count = 0;
    for (const std::string& section : text.sections()) count += text.keys(section).size();
    const std::size_t step = count / 8 + 1;
    std::size_t number = 0;
    for (const std::string& section : text.sections()) {
      for (const std::string& key : text.keys(section)) {
        if (++number % step != 0) continue;
        IniText changed(before);
        ASSERT_EQ(set(changed, section, key, "0x4D"), "") << entry.path() << section << key;
        ASSERT_EQ(changed_lines(before, changed.text()), before == changed.text() ? 0U : 1U) << entry.path();
        ASSERT_EQ(IniText(changed.text()).value(section, key)->substr(0, 4), "0x4D")
            << entry.path() << section << key;
      }
    }
  }
  EXPECT_GE(files, 38U);
}

}  // namespace
}  // namespace canopus::eds::ini_text_test
