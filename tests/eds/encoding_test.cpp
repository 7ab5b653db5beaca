// Device files in the encodings of other countries: names as they were meant, and which encoding was taken.

#include "canopus/eds/encoding.hpp"

#include <gmock/gmock.h>

#include "canopus/eds/files/device_text.hpp"
#include "canopus/eds/ini_text.hpp"

#include "eds/reading.hpp"
#include "eds/xdd_text.hpp"

namespace canopus::eds::encoding_test {
namespace {

using namespace canopus;
using namespace canopus::eds;
using namespace canopus::eds::test;
using testing::HasSubstr;

struct Case {
  const char* language;
  std::string bytes;
  const char* name;
  const char* note;  // of an EDS
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.language; }

// The bytes are from the tables of the encodings.
const Case cases[] = {
    {"Chinese", "\xB5\xE7\xBB\xFA\xD7\xAA\xCB\xD9", "电机转速",
     "1: note: bytes that are not UTF-8: read as GB18030 text, as they look\n"},
    {"Japanese", "\x83\x82\x81\x5B\x83\x5E\x91\xAC\x93\x78", "モータ速度",
     "1: note: bytes that are not UTF-8: read as CP932 text, as they look\n"},
    {"German",
     "Drehgeschwindigkeit (Gr\xF6\xDF"
     "e)",
     "Drehgeschwindigkeit (Größe)", "note: bytes that are not UTF-8: read as Windows Latin text\n"},
    {"Euro",
     "price \x80 \x96 \xB5s \xB0"
     "C",
     "price € – µs °C", "note: bytes that are not UTF-8: read as Windows Latin text\n"},
    {"French",
     "d\xE9"
     "c\xE9l\xE9ration apr\xE8s arr\xEAt",
     "décélération après arrêt", "note: bytes that are not UTF-8: read as Windows Latin text\n"},
};

class OtherEncoding : public testing::TestWithParam<Case> {};

TEST_P(OtherEncoding, NameInAnEds_IsReadAsItWasMeant) {
  const ReadResult result = read_device_file(
      with_object("[2000]\nParameterName=" + GetParam().bytes + "\nDataType=6\nAccessType=rw\n"));
  ASSERT_NE(result.file, nullptr);
  EXPECT_EQ(result.file->dictionary->name(*result.file->dictionary->find(0x2000)), GetParam().name);
  EXPECT_THAT(all_problems(result), HasSubstr(GetParam().note));
  EXPECT_FALSE(result.has_losses());
}

TEST_P(OtherEncoding, FileThatIsChanged_KeepsItsBytes) {
  const std::string text =
      with_variable("DataType=6\nDefaultValue=1\n") + "[Comments]\nLines=1\nLine1=" + GetParam().bytes;
  DeviceText file(text);
  EXPECT_EQ(file.text(), text);
  ASSERT_TRUE(file.set_parameter_value(0x2000, 0, "7"));
  std::string expected = text;
  expected.insert(expected.find("[Comments]"), "ParameterValue=7\n");
  EXPECT_EQ(file.text(), expected);
  IniText ini(text);
  ASSERT_TRUE(ini.set("FileInfo", "CreatedBy", GetParam().name));
  EXPECT_THAT(ini.text(), HasSubstr("CreatedBy=" + GetParam().bytes + "\n"));
}

INSTANTIATE_TEST_SUITE_P(Languages, OtherEncoding, testing::ValuesIn(cases),
                         [](const auto& instance) { return instance.param.language; });

struct Declared {
  const char* encoding;
  std::string bytes;
  const char* name;
};

TEST(DeclaredEncoding, OfAnXdd_IsRead_AndKeptWhenTheFileIsChanged) {
  const Declared all[] = {
      {"GB2312", "\xB5\xE7\xBB\xFA", "电机"},
      {"gbk", "\xB5\xE7\xBB\xFA", "电机"},
      {"Shift_JIS", "\x83\x82\x81\x5B\x83\x5E", "モータ"},
      {"windows-1251", "\xCC\xEE\xF2\xEE\xF0", "Мотор"},
      {"iso-8859-2", "\xB9", "š"},
      {"windows-1252", "5 \x80", "5 €"},
      {"EUC-JP", "\xA5\xE2\xA1\xBC\xA5\xBF", "モータ"},
      {"Big5", "\xA4\xA4", "中"},
      {"EUC-KR", "\xB8\xF0\xC5\xCD", "모터"},
  };
  for (const Declared& one : all) {
    SCOPED_TRACE(one.encoding);
    std::string text = xdd("<CANopenObject index=\"2000\" name=\"" + one.bytes +
                           "\" objectType=\"7\" dataType=\"0005\" accessType=\"rw\" defaultValue=\"1\"/>\n");
    text.replace(text.find("UTF-8"), 5, one.encoding);
    const ReadResult result = read_device_file(text);
    ASSERT_NE(result.file, nullptr) << all_problems(result);
    EXPECT_EQ(result.file->dictionary->name(*result.file->dictionary->find(0x2000)), one.name);
    EXPECT_THAT(all_problems(result), HasSubstr("23: note: bytes that are not UTF-8: read as "));
    DeviceText file(text);
    EXPECT_EQ(file.text(), text);
    ASSERT_TRUE(file.set_parameter_value(0x2000, 0, "7"));
    std::string expected = text;
    const std::string before = "defaultValue=\"1\"/>\n</CANopenObjectList>";
    expected.replace(expected.find(before), before.size(),
                     "defaultValue=\"1\" actualValue=\"7\"/>\n</CANopenObjectList>");
    EXPECT_EQ(file.text(), expected);
  }
}

TEST(DeclaredEncoding, ThatTheBytesAreNot_IsRefused) {
  std::string text =
      xdd("<CANopenObject index=\"2000\" name=\"\xFF\xFF\" objectType=\"7\" dataType=\"0005\"/>\n");
  text.replace(text.find("UTF-8"), 5, "Shift_JIS");
  EXPECT_THAT(all_problems(read_device_file(text)),
              HasSubstr("23: error: bytes that are not CP932, as which the file is declared"));
}

TEST(FindEncoding, TextOfFewOrRareLetters_IsNoGuess) {
  for (const char* text : {"", "abc", "\xFC",
                           "Gr\xF6\xDF"
                           "e",
                           "\xB0"
                           "C",
                           "\xC4rger \xDC"
                           "bung",
                           "\x81", "\xB5"}) {
    EXPECT_FALSE(find_encoding(text).has_value()) << text;
  }
}

TEST(Encoding, LatinAndBack_IsTheSame_ForEveryByte) {
  std::string all;
  for (int byte = 1; byte < 256; ++byte) all += static_cast<char>(byte);
  EXPECT_EQ(to_latin(from_latin(all)), all);
  EXPECT_EQ(to_latin("电"), std::nullopt);
}

TEST(IniText, ChangeAfterWhichAFileWouldBeReadInAnotherEncoding_IsRefused) {
  IniText chinese("[A]\nX=\xB5\xE7\xBB\xFA\nY=1\n");
  EXPECT_EQ(chinese.value("A", "X"), "电机");
  const std::string before = chinese.text();
  EXPECT_EQ(chinese.set("A", "Y", "üüü").error(),
            "with this change the file would be read in another encoding: save it as UTF-8 text before");
  EXPECT_EQ(chinese.text(), before);
  EXPECT_TRUE(chinese.set("A", "Y", "水机"));
  EXPECT_TRUE(chinese.set("A", "X", "motor pump"));
}

TEST(Encoding, WhatItLacks_IsNotWritten) {
  const Encoding japanese{"CP932", {}};
  EXPECT_EQ(encode("モ", japanese), "\x83\x82");
  EXPECT_EQ(encode("ü", japanese), std::nullopt);
  EXPECT_EQ(decode("\x83", japanese), std::nullopt);
}

}  // namespace
}  // namespace canopus::eds::encoding_test
