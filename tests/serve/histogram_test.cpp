#include "canopus/serve/histogram.hpp"

#include <gtest/gtest.h>

namespace canopus::serve::histogram_test {
namespace {

using namespace std::chrono_literals;

TEST(HistogramTest, Empty_IsZeroEverywhere) {
  const Histogram histogram;
  EXPECT_EQ(histogram.quantile(500), 0ns);
  EXPECT_EQ(histogram.mean(), 0ns);
  EXPECT_EQ(histogram.in_class(0), 0U);
}

TEST(HistogramTest, Classes_EndBeforeTheirUpperEnd) {
  Histogram histogram;
  for (const auto duration : {0ns, 4999ns, 5000ns, 9999ns, 10'000ns, 99'999'999ns, 100'000'000ns})
    histogram.add(duration);
  EXPECT_EQ(histogram.in_class(0), 2U);
  EXPECT_EQ(histogram.in_class(1), 2U);
  EXPECT_EQ(histogram.in_class(2), 1U);
  EXPECT_EQ(histogram.in_class(Histogram::ends.size() - 1), 1U);
  EXPECT_EQ(histogram.in_class(Histogram::ends.size()), 1U);
}

TEST(HistogramTest, Quantiles_AreValuesThatWereMeasured) {
  Histogram histogram;
  for (int i = 1000; i >= 1; --i) histogram.add(std::chrono::microseconds(i));
  EXPECT_EQ(histogram.quantile(0), 1us);
  EXPECT_EQ(histogram.quantile(500), 500us);
  EXPECT_EQ(histogram.quantile(999), 999us);
  EXPECT_EQ(histogram.quantile(1000), 1000us);
  EXPECT_EQ(histogram.mean(), 500'500ns);
}

TEST(HistogramTest, Relative_IsAgainstTheSmallest) {
  Histogram histogram;
  for (const auto duration : {30us, 10us, 50us}) histogram.add(duration);
  EXPECT_EQ(histogram.relative().quantile(0), 0us);
  EXPECT_EQ(histogram.relative().quantile(1000), 40us);
  EXPECT_EQ(Histogram().relative().count(), 0U);
}

TEST(LatenessTest, IsCountedAgainstTheMostPunctualOne) {
  const std::chrono::nanoseconds moments[] = {100ms, 109ms, 125ms, 130ms};  // of 10 ms: 0, -1, +5, 0
  const Histogram histogram = lateness(moments, 10ms);
  EXPECT_EQ(histogram.count(), 4U);
  EXPECT_EQ(histogram.quantile(0), 0ns);
  EXPECT_EQ(histogram.quantile(500), 1ms);
  EXPECT_EQ(histogram.quantile(1000), 6ms);
}

TEST(LatenessTest, ABurstAfterADelay_IsLateForEachOfThem) {
  const std::chrono::nanoseconds moments[] = {0ms, 35ms, 35ms, 35ms, 40ms};
  const Histogram histogram = lateness(moments, 10ms);
  EXPECT_EQ(histogram.quantile(1000), 25ms);
  EXPECT_EQ(histogram.in_class(0), 2U);
}

TEST(LatenessTest, NothingCame) { EXPECT_EQ(lateness({}, 10ms).count(), 0U); }

}  // namespace
}  // namespace canopus::serve::histogram_test
