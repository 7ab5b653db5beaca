#include "canopus/text/bit_rate.hpp"

#include <array>

#include <gtest/gtest.h>

namespace canopus::text::bit_rate_test {
namespace {

TEST(BitRate, AsPeopleWriteIt_IsInBitsPerSecond) {
  for (const char* text : {"500k", "500K", "500kbit/s", "500 kbit/s", "500000", "500000 bit/s"})
    EXPECT_EQ(parse_bit_rate(text), 500'000U) << text;
  EXPECT_EQ(parse_bit_rate("1M"), 1'000'000U);
  EXPECT_EQ(parse_bit_rate("1000k"), 1'000'000U);
  EXPECT_EQ(parse_bit_rate("10k"), 10'000U);
}

TEST(BitRate, AnotherOne_IsRefusedWithAllThatThereAre) {
  for (const char* text : {"", "k", "300k", "500", "0", "500m", "500k ", "4294967795k", "-500k", "0.5M"}) {
    const auto read = parse_bit_rate(text);
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error(), "expected 10k, 20k, 50k, 100k, 125k, 250k, 500k, 800k or 1M") << text;
  }
}

TEST(BitRate, OfAnotherTable_ZeroIsNone) {
  constexpr std::array<std::uint32_t, 3> table{1'000'000, 0, 50'000};
  EXPECT_EQ(parse_bit_rate("50k", table), 50'000U);
  EXPECT_EQ(parse_bit_rate("0", table).error(), "expected 1M or 50k");
  EXPECT_FALSE(parse_bit_rate("125k", table));
}

}  // namespace
}  // namespace canopus::text::bit_rate_test
