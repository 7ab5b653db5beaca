// JSON values: what they are made of, their text byte for byte, and what text is taken. nlohmann-json is the witness.

#include "canopus/text/json.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <rapidcheck/gtest.h>

namespace canopus::text::json_test {
namespace {

using Witness = nlohmann::ordered_json;

std::string dump_of(const Witness& value) {
  return value.dump(-1, ' ', false, Witness::error_handler_t::replace);
}

std::string nested(std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); }

TEST(Json, Braces_AreAnObjectWhenEachHoldsAKeyAndAValue) {
  EXPECT_EQ((Json{{"a", 1}, {"b", {1, "x", nullptr, true}}, {"c", {{"d", -1}}}}).dump(),
            R"({"a":1,"b":[1,"x",null,true],"c":{"d":-1}})");
  EXPECT_EQ((Json{{"a", 1}, {2, "b"}}).dump(), R"([["a",1],[2,"b"]])");
  EXPECT_EQ((Json{"a", "b"}).dump(), R"(["a","b"])");
  EXPECT_EQ((Json{{"a", {"b"}}}).dump(), R"({"a":["b"]})");
  EXPECT_EQ((Json{{"a", 1}, {"a", 2}}).dump(), R"({"a":1})") << "the first of one key";
  EXPECT_EQ(Json::array({{"a", 1}}).dump(), R"([["a",1]])");
  EXPECT_EQ(Json::array().dump() + Json::object().dump() + Json().dump(), "[]{}null");
}

// Its elements are of its own type: as a list it would never end.
TEST(Json, ValueOfAnotherLibrary_IsNoList) {
  EXPECT_TRUE(JsonList<std::vector<int>>);
  EXPECT_FALSE(JsonList<nlohmann::json>);
  EXPECT_FALSE(JsonList<Witness>);
}

TEST(Json, Values_OfEachTypeOfTheProgram) {
  EXPECT_EQ(Json(true).dump(), "true");
  EXPECT_EQ(Json(std::uint8_t{255}).dump(), "255");
  EXPECT_EQ(Json(std::numeric_limits<std::int64_t>::min()).dump(), "-9223372036854775808");
  EXPECT_EQ(Json(std::numeric_limits<std::uint64_t>::max()).dump(), "18446744073709551615");
  EXPECT_EQ(Json(0.5F).dump(), "0.5");
  EXPECT_EQ(Json(std::string_view("ab")).dump(), "\"ab\"");
  EXPECT_EQ(Json(std::vector<std::string>{"a", "b"}).dump(), R"(["a","b"])");
  EXPECT_TRUE(Json(1U).is_number_unsigned());
  EXPECT_FALSE(Json(1).is_number_unsigned());
  EXPECT_TRUE(Json(1).is_number_integer());
}

TEST(Json, Members_StayInTheOrderOfInsertion) {
  Json object;
  object["b"] = 1;
  object["a"]["x"] = 2;
  object["b"] = 3;
  EXPECT_EQ(object.dump(), R"({"b":3,"a":{"x":2}})");
  object.update({{"c", 4}, {"b", 5}});
  EXPECT_EQ(object.dump(), R"({"b":5,"a":{"x":2},"c":4})");
  object.sort_members();
  EXPECT_EQ(object.dump(), R"({"a":{"x":2},"b":5,"c":4})");
  std::string walked;
  for (const auto& [key, value] : object.items()) walked += key + value.dump();
  EXPECT_EQ(walked, R"(a{"x":2}b5c4)");
}

TEST(Json, WhatIsNotThere_IsNotFound) {
  const Json object{{"a", true}, {"b", "x"}};
  EXPECT_EQ(object.find("c"), object.end());
  EXPECT_EQ(*object.find("a"), true);
  EXPECT_FALSE(Json(1).contains("a"));
  EXPECT_EQ(Json(1).find("a"), Json(1).end());
  EXPECT_TRUE(object.value("a", false));
  EXPECT_FALSE(object.value("b", false)) << "of another kind";
  EXPECT_EQ(object.value("b", "") + object.value("a", "-"), "x-");
  EXPECT_THROW((void)object["c"], std::logic_error);
  EXPECT_THROW((void)object["b"].get<int>(), std::logic_error);
  EXPECT_THROW((void)Json::array()[0], std::logic_error);
}

TEST(Json, APartOfAValue_CanTakeItsPlace) {
  Json value{{"a", {{"b", 1}}}};
  value = value["a"];
  EXPECT_EQ(value.dump(), R"({"b":1})");
  value = std::move(value["b"]);
  EXPECT_EQ(value, 1);
}

TEST(Json, Numbers_AreEqualByTheirValue) {
  EXPECT_EQ(Json(1), Json(1U));
  EXPECT_EQ(Json(1), Json(1.0));
  EXPECT_NE(Json(-1), Json(std::numeric_limits<std::uint64_t>::max()));
  EXPECT_NE(Json(1), Json("1"));
}

TEST(JsonText, Strings_AreEscapedAsLittleAsCanBe) {
  EXPECT_EQ(Json(std::string("\"\\/\b\f\n\r\t\0\x1f\x7f", 11)).dump(), R"("\"\\/\b\f\n\r\t\u0000\u001f)"
                                                                       "\x7f\"");
  EXPECT_EQ(Json("\u00e4\u20ac\U0001F600").dump(), "\"\u00e4\u20ac\U0001F600\"");
  EXPECT_EQ(Json("a\xFF"
                 "b")
                .dump(),
            "\"a\uFFFDb\"");
  EXPECT_EQ(Json("\xE2\x82\xE2\x82").dump(), "\"\uFFFD\uFFFD\"") << "two that are cut off";
  EXPECT_EQ(Json("\xED\xA0\x80").dump(), "\"\uFFFD\uFFFD\uFFFD\"") << "a surrogate";
  EXPECT_EQ((Json{{"\xFF", 1}}).dump(), "{\"\uFFFD\":1}");
}

TEST(JsonText, RealNumbers_ReadBackAsTheSame) {
  const std::map<double, std::string> cases{{0.0, "0.0"},
                                            {1, "1.0"},
                                            {-0.1, "-0.1"},
                                            {0.0001, "0.0001"},
                                            {0.00001234, "1.234e-05"},
                                            {0.01207, "0.012070000000000001"},
                                            {1e-4, "0.0001"},
                                            {123456789012345, "123456789012345.0"},
                                            {1e14, "100000000000000.0"},
                                            {1e15, "1e+15"},
                                            {1234567890123456, "1.234567890123456e+15"},
                                            {1e100, "1e+100"},
                                            {5e-324, "5e-324"},
                                            {1.7976931348623157e308, "1.7976931348623157e+308"}};
  for (const auto& [value, text] : cases) EXPECT_EQ(Json(value).dump(), text);
  EXPECT_EQ(Json(-0.0).dump(), "-0.0");
  EXPECT_EQ(Json(std::nan("")).dump(), "null");
  EXPECT_EQ(Json(-INFINITY).dump(), "null");
}

RC_GTEST_PROP(JsonText, AnyRealNumber_IsAsTheWitnessWritesIt, (std::uint64_t bits, std::int64_t digits)) {
  const auto any = std::bit_cast<double>(bits);
  RC_ASSERT(Json(any).dump() == Witness(any).dump());
  const double of_few_digits =
      static_cast<double>(digits % 1'000'000'000'000) * std::pow(10.0, *rc::gen::inRange(-20, 20));
  RC_ASSERT(Json(of_few_digits).dump() == Witness(of_few_digits).dump());
}

RC_GTEST_PROP(JsonText, AnyOctets_AreAsTheWitnessWritesThem, ()) {
  // Those that begin, go on or stand at an edge of what UTF-8 is.
  const auto octet = rc::gen::weightedOneOf<unsigned char>(
      {{1, rc::gen::arbitrary<unsigned char>()},
       {3, rc::gen::element<unsigned char>(0x00, 0x1F, 0x20, '"', '\\', 0x7F, 0x80, 0x8F, 0x90, 0x9F, 0xA0,
                                           0xBF, 0xC0, 0xC1, 0xC2, 0xDF, 0xE0, 0xE1, 0xED, 0xEE, 0xEF, 0xF0,
                                           0xF1, 0xF4, 0xF5, 0xFF)}});
  const auto octets = *rc::gen::container<std::vector<unsigned char>>(octet);
  const std::string text(octets.begin(), octets.end());
  RC_ASSERT(Json(text).dump() == dump_of(Witness(text)));
}

/// A value and the same one of the witness.
struct Pair {
  Json ours;
  Witness theirs;
};

Pair any_pair(int depth) {
  switch (*rc::gen::inRange(0, depth > 0 ? 8 : 6)) {
    case 0: return {nullptr, nullptr};
    case 1: {
      const bool value = *rc::gen::arbitrary<bool>();
      return {value, value};
    }
    case 2: {
      const auto value = *rc::gen::arbitrary<std::int64_t>();
      return {value, value};
    }
    case 3: {
      const auto value = *rc::gen::arbitrary<std::uint64_t>();
      return {value, value};
    }
    case 4: {
      const auto value = *rc::gen::arbitrary<std::string>();
      return {value, value};
    }
    case 5: {
      const double value = *rc::gen::inRange(-1'000'000, 1'000'000) / 1024.0;
      return {value, value};
    }
    case 6: {
      Pair made{Json::array(), Witness::array()};
      for (int i = *rc::gen::inRange(0, 4); i > 0; --i) {
        Pair one = any_pair(depth - 1);
        made.ours.push_back(std::move(one.ours));
        made.theirs.push_back(std::move(one.theirs));
      }
      return made;
    }
    default: {
      Pair made{Json::object(), Witness::object()};
      for (int i = *rc::gen::inRange(0, 4); i > 0; --i) {
        const std::string key(1, static_cast<char>('a' + *rc::gen::inRange(0, 3)));
        Pair one = any_pair(depth - 1);
        made.ours[key] = std::move(one.ours);
        made.theirs[key] = std::move(one.theirs);
      }
      return made;
    }
  }
}

RC_GTEST_PROP(JsonText, AnyValue_IsAsTheWitnessWritesIt_AndIsReadBack, ()) {
  const Pair pair = any_pair(4);
  const std::string text = pair.ours.dump();
  RC_ASSERT(text == dump_of(pair.theirs));
  const auto read = parse_json(text);
  RC_ASSERT(read.has_value());
  RC_ASSERT(read->dump() == text);
}

RC_GTEST_PROP(JsonText, WhatTheWitnessTakes_IsTaken, ()) {
  const auto part =
      rc::gen::element<std::string>("[", "]", "{", "}", ",", ":", "\"a\"", "\"b\"", "1", "-1", "0.5", "1e400",
                                    "-0", "true", "null", " ", "x", "\xFF", "\"\\u00e4\"");
  std::string text;
  for (const auto& one : *rc::gen::container<std::vector<std::string>>(part)) text += one;
  const Witness expected = Witness::parse(text, nullptr, false);
  const auto read = parse_json(text);
  RC_ASSERT(read.has_value() == !expected.is_discarded());
  if (read) RC_ASSERT(read->dump() == dump_of(expected));
}

TEST(JsonText, OfOneKeyTheLastValueIsTaken_AtThePlaceOfTheFirst) {
  const std::string text = R"({"b":1,"a":2,"b":[3],"c":4,"a":5,"b":6})";
  EXPECT_EQ(parse_json(text)->dump(), R"({"b":6,"a":5,"c":4})");
  EXPECT_EQ(Witness::parse(text).dump(), R"({"b":6,"a":5,"c":4})");
}

TEST(JsonText, ManyMembers_TakeNoTimeThatGrowsWithTheirSquare) {
  std::string text = "{";
  for (int i = 0; i < 100'000; ++i) text += "\"" + std::to_string(i) + "\":0,";
  text += "\"0\":1}";
  const auto read = parse_json(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->size(), 100'000U);
  EXPECT_EQ(read->at("0"), 1);
}

TEST(JsonText, IsRefusedWithItsPlace) {
  EXPECT_EQ(parse_json("").error(), "no JSON from octet 1 on");
  EXPECT_EQ(parse_json("{\"a\":1,}").error(), "no JSON from octet 8 on");
  EXPECT_EQ(parse_json("[1] 2").error(), "no JSON from octet 5 on");
  EXPECT_EQ(parse_json("\"\xFF\"").error(), "no JSON from octet 2 on");
  EXPECT_FALSE(parse_json("1e400"));
}

TEST(JsonText, ArraysAndObjects_AreNotDeeperThan64) {
  EXPECT_EQ(parse_json(nested(64))->dump(), nested(64));
  EXPECT_EQ(parse_json(nested(65)).error(), "more than 64 arrays and objects within each other");
  std::string objects;
  for (int i = 0; i < 64; ++i) objects += "{\"a\":";
  EXPECT_TRUE(parse_json(objects + "1" + std::string(64, '}')));
  EXPECT_EQ(parse_json(objects + "[]" + std::string(64, '}')).error(),
            "more than 64 arrays and objects within each other");
  EXPECT_TRUE(parse_json("[[],[]]", {.depth = 2}));
  EXPECT_FALSE(parse_json("[[[]]]", {.depth = 2}));
  EXPECT_EQ(parse_json(std::string(200'000, '[')).error(),
            "more than 64 arrays and objects within each other");
}

TEST(JsonText, IsNotLongerThanItsLimit) {
  EXPECT_TRUE(parse_json("\"12345678\"", {.bytes = 10}));
  EXPECT_EQ(parse_json("\"123456789\"", {.bytes = 10}).error(), "more than 10 octets");
  EXPECT_FALSE(parse_json(std::string((16U << 20U) + 1, ' ')));
}

}  // namespace
}  // namespace canopus::text::json_test
