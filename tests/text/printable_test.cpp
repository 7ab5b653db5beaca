// What comes from outside cannot control the terminal, and what people write stays as it is.

#include "canopus/text/printable.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace canopus::text::printable_test {
namespace {

using namespace std::string_literals;

TEST(Printable, AControlIsFoundAtEveryPlace) {
  const std::string plain = "~ a line of 24 octets. ~";
  for (const char control : {'\x00', '\x1F', '\x7F', '\x80', '\xFF'}) {
    for (std::size_t place = 0; place <= plain.size(); ++place) {
      const std::string text = plain.substr(0, place) + control + plain.substr(place);
      const std::string escape = fmt::format("\\x{:02X}", static_cast<std::uint8_t>(control));
      EXPECT_EQ(printable(text), plain.substr(0, place) + escape + plain.substr(place));
    }
  }
  EXPECT_EQ(printable(plain), plain);
}

TEST(Printable, OrdinaryTextStaysAsItIs) {
  for (const std::string text :
       {"U0\\G25 = 33281 (8201H)", "Gerät Überdruck µm", "エンコーダ", "🚀 e\u0301", ""}) {
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, ControlsAreShownAsEscapes) {
  EXPECT_EQ(printable("\x1b]0;owned\x07"), "\\x1B]0;owned\\x07");
  EXPECT_EQ(printable("a\nb\r\tc\x7f"), "a\\nb\\r\\tc\\x7F");
  EXPECT_EQ(printable("nul\0l"s), "nul\\x00l");
}

TEST(Printable, C1ControlsAreShownHoweverTheyAreEncoded) {
  EXPECT_EQ(printable("a\u009B2Jb\u0085c"), "a\\u009B2Jb\\u0085c");
  EXPECT_EQ(printable("a\x9b"
                      "2Jb"),
            "a\\x9B2Jb");
}

TEST(Printable, TextThatLooksOtherThanItReadsIsShown) {
  EXPECT_EQ(printable("drive\u202Etxt.exe\u202C"), "drive\\u202Etxt.exe\\u202C");
  EXPECT_EQ(printable("a\u2066b\u2069c\u200Fd\u061Ce"), "a\\u2066b\\u2069c\\u200Fd\\u061Ce");
  EXPECT_EQ(printable("one\u2028two\u2029"), "one\\u2028two\\u2029");
}

TEST(Printable, WhatIsNoUtf8IsShownByOctet) {
  EXPECT_EQ(printable("Ger\xE4t"), "Ger\\xE4t");
  EXPECT_EQ(printable("\xC0\xAF overlong"), "\\xC0\\xAF overlong");
  EXPECT_EQ(printable("\xE0\x80\x9B"), "\\xE0\\x80\\x9B");
  EXPECT_EQ(printable("\xED\xA0\x80 surrogate"), "\\xED\\xA0\\x80 surrogate");
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xF4\\x90\\x80\\x80");
  EXPECT_EQ(printable("cut \xE2\x82"), "cut \\xE2\\x82");
}

TEST(PrintableJson, SaysTheSameToAProgram) {
  const std::string name = "a\u009B2J\x7f\u202Eb\u2028Gerät\n";
  const std::string safe = printable_json(nlohmann::json(name).dump());
  EXPECT_EQ(safe, "\"a\\u009b2J\\u007f\\u202eb\\u2028Gerät\\n\"");
  EXPECT_EQ(nlohmann::json::parse(safe).get<std::string>(), name);
}

TEST(Columns, WideCharactersTakeTwoAndCombiningOnesNone) {
  EXPECT_EQ(columns_of("drive"), 5U);
  EXPECT_EQ(columns_of("Gerät"), 5U);
  EXPECT_EQ(columns_of("エンコーダ"), 10U);
  EXPECT_EQ(columns_of("e\u0301"), 1U);
}

TEST(Columns, ATextIsClippedBetweenCharacters) {
  EXPECT_EQ(clipped("drive", 3), "dri");
  EXPECT_EQ(clipped("drive", 9), "drive");
  EXPECT_EQ(clipped("エンコーダ", 5), "エン") << "half a wide character does not fit";
  EXPECT_EQ(clipped("e\u0301x", 1), "e\u0301");
  EXPECT_EQ(clipped("Gerät", 0), "");
}

}  // namespace
}  // namespace canopus::text::printable_test
