// The one way to TOML: what is too deep or too long is refused before the parser, which calls itself for each level, sees it.

#include "canopus/text/toml.hpp"

#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::text::toml_test {
namespace {

constexpr std::string_view too_deep =
    "tables and arrays, or the parts of a key, are nested deeper than 64 levels; expected at most 64";

std::string repeated(std::string_view part, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += part;
  return text;
}

/// "t.toml:3:1: what", or nothing.
std::string error_of(std::string_view text) {
  const auto read = parse_toml(text);
  return read ? "" : describe(read.error(), "t.toml");
}

std::string too_deep_at(std::string_view place) {
  return "t.toml:" + std::string(place) + ": " + std::string(too_deep);
}

/// A key of so many parts: its last one stands in one table less.
std::string key(std::size_t parts) { return "a" + repeated(".a", parts - 1); }

TEST(Toml, AKeyThatIsThereTwice_IsNamed) {
  EXPECT_EQ(error_of("[a]\nb = 1\nb = 2\n"), "t.toml:3:5: 'b' is in this table already; expected it once");
}

TEST(Toml, Keys_HaveAtMost65Parts) {
  EXPECT_EQ(error_of(key(65) + " = 1\n"), "");
  EXPECT_EQ(error_of(key(66) + " = 1\n"), too_deep_at("1:130"));
  EXPECT_EQ(error_of("b = 1\n" + key(40'000) + " = 1\n"), too_deep_at("2:130"));
  EXPECT_EQ(error_of(repeated("\"a\" . ", 65) + "'a.b' = 1\n"), too_deep_at("1:389"));
  EXPECT_EQ(error_of(repeated("\"x.y\".", 64) + "'a.b' = 1\n"), "") << "a dot in quotes divides no key";
}

TEST(Toml, Tables_AreNamedByAtMost64Parts) {
  EXPECT_EQ(error_of("[" + key(64) + "]\n"), "");
  EXPECT_EQ(error_of("[" + key(65) + "]\n"), too_deep_at("1:129"));
  EXPECT_EQ(error_of("[[" + key(63) + "]]\n"), "");
  EXPECT_EQ(error_of("[[" + key(64) + "]]\n"), too_deep_at("1:128"));
  EXPECT_EQ(error_of("\n[" + key(40'000) + "]\n"), too_deep_at("2:129"));
}

TEST(Toml, ArraysAndInlineTables_CountLikeTables) {
  EXPECT_EQ(error_of("a = " + repeated("[", 64) + repeated("]", 64) + "\n"), "");
  EXPECT_EQ(error_of("a = " + repeated("[", 65) + repeated("]", 65) + "\n"), too_deep_at("1:69"));
  EXPECT_EQ(error_of("a = " + repeated("{a=", 65) + "1" + repeated("}", 65) + "\n"), too_deep_at("1:197"));
  EXPECT_EQ(error_of("a = " + repeated("[\n", 100'000)), too_deep_at("65:1"));
}

TEST(Toml, WhatIsWithinEachOther_IsCountedTogether) {
  EXPECT_EQ(error_of("[" + key(32) + "]\n" + key(17) + " = " + repeated("[", 16) + repeated("]", 16) + "\n"),
            "");
  EXPECT_EQ(error_of("[" + key(32) + "]\n" + key(17) + " = " + repeated("[", 17) + repeated("]", 17) + "\n"),
            too_deep_at("2:53"));
  EXPECT_EQ(error_of("a = [ { " + key(63) + " = 1 } ]\n"), "");
  EXPECT_EQ(error_of("a = [ { " + key(64) + " = 1 } ]\n"), too_deep_at("1:134"));
}

TEST(Toml, WhatIsBesideEachOther_IsNotCountedTogether) {
  EXPECT_EQ(error_of("a = [" + repeated("[1.5, 2.5], {b.c = 1.25}, ", 200) + "]\n"), "");
  EXPECT_EQ(error_of(repeated("[[a.b]]\nc.d = 1\nd.e = [\n 1.5, # ]\n]\n", 200)), "");
  EXPECT_EQ(error_of("a = 1979-05-27T07:32:00.5\nb = 127.25\n[c]\nd = 2.0\n"), "");
}

TEST(Toml, BracketsAndDotsInStringsAndComments_AreNotCounted) {
  const std::string many = repeated("[.{", 100);
  EXPECT_EQ(error_of("a = \"" + many + "\\\"" + many + "\" # " + many + "\n"), "");
  EXPECT_EQ(error_of("a = '" + many + "\\'\nb = '''" + many + "\n''" + many + "'''''\n"), "");
  EXPECT_EQ(error_of("a = \"\"\"" + many + "\n\\\"\"\"" + many + "\"\"\"\"\"\nb = \"\"\n"), "");
  const std::string deep = repeated("[", 65) + repeated("]", 65) + "\n";
  for (const std::string before : {"a = '''''''\n", "a = \"\"\"\"\"\"\"\"\n", "a = \"\\\\\"\n", "a = '\\'\n",
                                   "a = 1 # \"\n", "a = \"'\"\n"}) {
    EXPECT_EQ(error_of(before + "b = " + deep), too_deep_at("2:69")) << before;
  }
}

TEST(Toml, Text_HasAtMost4MiB) {
  EXPECT_EQ(error_of(std::string(std::size_t{4} << 20, '\n')), "");
  EXPECT_EQ(error_of(std::string((std::size_t{4} << 20) + 1, '\n')),
            "t.toml:1:1: the text has 4194305 bytes; expected at most 4194304");
}

TEST(Toml, Mistake_ComesWithItsPlace) {
  EXPECT_TRUE(error_of("a = 1\nb = \n").starts_with("t.toml:2:")) << error_of("a = 1\nb = \n");
  EXPECT_EQ(error_of(""), "");
}

/// Deepest table or array below a node.
std::size_t depth_of(const toml::node& node) {
  std::size_t deepest = 0;
  const auto below = [&](const toml::node& inner) { deepest = std::max(deepest, 1 + depth_of(inner)); };
  if (const auto* table = node.as_table()) {
    for (const auto& [name, value] : *table) below(value);
    return table->empty() ? 1 : deepest;
  }
  if (const auto* array = node.as_array()) {
    for (const toml::node& value : *array) below(value);
    return array->empty() ? 1 : deepest;
  }
  return 0;
}

// The count looks at characters, the parser at TOML: nothing that the parser accepts is deeper than the count allows.
RC_GTEST_PROP(Toml, WhatIsRead_IsNeverDeeperThanAllowed, ()) {
  const auto parts = *rc::gen::container<std::vector<std::string>>(rc::gen::element<std::string>(
      "a", "b", ".", "=", "1", "\n", "\n", "[", "]", "[[", "]]", "{", "}", ",", "\"", "'", "\"\"\"", "'''",
      "#", "\\", " ", "a=[", "a={b=", "a.b.c=1\n", "[a.b]\n", "[[a.c]]\n", "\r\n", "1.5"));
  std::string text;
  for (const std::string& part : parts) text += part;
  constexpr std::size_t most = 3;
  if (const auto read = parse_toml(text, {.depth = most})) RC_ASSERT(depth_of(*read) <= most + 1);
}

}  // namespace
}  // namespace canopus::text::toml_test
