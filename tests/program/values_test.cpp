// Values of variables as people write them.

#include <bit>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/program/data_type.hpp"
#include "canopus/program/time_text.hpp"

namespace program_values_test {
namespace {

using canopus::program::DataType;
using canopus::program::Elementary;
using canopus::program::Slot;

TEST(Durations, Texts_HaveFallingUnitsAndAFractionInTheLastOneAlone) {
  using canopus::program::parse_duration;
  EXPECT_EQ(parse_duration("1d2h3m4s5ms6us7ns"), 93784005006007);
  EXPECT_EQ(parse_duration("1.5s"), 1500000000);
  EXPECT_EQ(parse_duration("0.001ms"), 1000);
  EXPECT_EQ(parse_duration("-2m"), -120000000000);
  EXPECT_EQ(parse_duration("90m"), 5400000000000);
  for (const char* const wrong : {"", "1", "s", "1s1h", "1.5s3ms", "1x", "1.s", "99999999999d", "--1s"}) {
    EXPECT_EQ(parse_duration(wrong), std::nullopt) << wrong;
  }
}

TEST(Durations, Shown_AreReadAgain) {
  for (const std::int64_t ns : {0LL, 1LL, 999LL, 1000LL, -1500000000LL, 86400000000000LL, 93784005006007LL}) {
    EXPECT_EQ(canopus::program::parse_duration(canopus::program::duration_text(ns)), ns);
  }
}

TEST(Dates, Texts_AreOfTheCalendar) {
  using canopus::program::parse_date;
  EXPECT_EQ(parse_date("1970-01-02"), 86400000000000);
  EXPECT_EQ(parse_date("2000-02-29"), 951782400000000000);
  for (const char* const wrong : {"2001-02-29", "1970-13-01", "1970-01", "70-01-01", "1970-01-00", "x"}) {
    EXPECT_EQ(parse_date(wrong), std::nullopt) << wrong;
  }
  EXPECT_EQ(canopus::program::parse_time_of_day("24:00:00"), std::nullopt);
  EXPECT_EQ(canopus::program::parse_time_of_day("23:59:59.5"), 86399500000000);
}

TEST(Values, OutOfRange_AreRefusedAndChangeNothing) {
  for (const auto& [type, text] : {std::pair{Elementary::sint, "128"},
                                   {Elementary::sint, "-129"},
                                   {Elementary::usint, "256"},
                                   {Elementary::usint, "-1"},
                                   {Elementary::byte, "16#100"},
                                   {Elementary::boolean, "2"},
                                   {Elementary::ulint, "18446744073709551616"},
                                   {Elementary::real, "1e39"},
                                   {Elementary::int_, "1.5"}}) {
    Slot value = 42;
    EXPECT_TRUE(canopus::program::parse_value(DataType{.base = type}, text, &value).has_value()) << text;
    EXPECT_EQ(value, 42U);
  }
}

/// Bits that a value of the type may have in its slot.
Slot any_value(Elementary type) {
  using canopus::program::Family;
  constexpr std::int64_t day = 86'400'000'000'000;
  const auto bits = *rc::gen::arbitrary<std::uint64_t>();
  const canopus::program::ElementaryInfo& kind = info(type);
  switch (kind.family) {
    case Family::boolean: return bits & 1U;
    case Family::signed_integer: {
      const unsigned shift = 64U - kind.bits;
      return static_cast<Slot>(static_cast<std::int64_t>(bits << shift) >> shift);
    }
    case Family::unsigned_integer:
    case Family::bits: return kind.bits == 64 ? bits : bits & ((Slot{1} << kind.bits) - 1);
    case Family::real:
      return kind.bits == 32
                 ? std::bit_cast<std::uint32_t>(static_cast<float>(static_cast<std::int32_t>(bits)) / 8)
                 : std::bit_cast<Slot>(static_cast<double>(static_cast<std::int64_t>(bits)) / 3);
    case Family::duration: return static_cast<Slot>(static_cast<std::int64_t>(bits) / 2);
    default: break;
  }
  const auto days = static_cast<std::int64_t>(bits % 80'000);  // up to 2189
  const auto time = static_cast<std::int64_t>(bits / 80'000 % static_cast<Slot>(day));
  if (type == Elementary::tod || type == Elementary::ltod) return static_cast<Slot>(time);
  if (type == Elementary::date || type == Elementary::ldate) return static_cast<Slot>(days * day);
  return static_cast<Slot>(days * day + time);
}

RC_GTEST_PROP(Values, OfEachType_AreReadAsTheyAreShown, ()) {
  const auto type = static_cast<Elementary>(*rc::gen::inRange(0, static_cast<int>(Elementary::char_)));
  const Slot value = any_value(type);
  const DataType data_type{.base = type};
  Slot again = ~value;
  const std::string text = value_text(data_type, &value);
  RC_ASSERT(!parse_value(data_type, text, &again).has_value());
  RC_ASSERT(again == value);
}

}  // namespace
}  // namespace program_values_test
