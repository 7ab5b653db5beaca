#include "canopus/cli/trace/trace_comparison.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace canopus::cli::trace_comparison_test {
namespace {

using namespace std::chrono_literals;

std::vector<ComparedRecord> frames(const std::vector<std::uint32_t>& identifiers) {
  std::vector<ComparedRecord> all;
  for (const std::uint32_t identifier : identifiers) {
    ComparedRecord one{.channel = "can0", .time = can::Duration(1ms) * static_cast<int>(all.size())};
    one.record.frame = can::data_frame(identifier);
    all.push_back(one);
  }
  return all;
}

struct Compared {
  ComparisonCounts counts;
  std::string text;  // "-100 +200 ~300 !400"
};

Compared compare(std::vector<ComparedRecord> a, std::vector<ComparedRecord> b,
                 TraceComparison::Options options) {
  const auto source = [](std::vector<ComparedRecord>& all) {
    return [&all, at = std::size_t{0}]() mutable -> std::optional<ComparedRecord> {
      if (at == all.size()) return std::nullopt;
      return all[at++];
    };
  };
  Compared compared;
  TraceComparison comparison(source(a), source(b), options,
                             [&](Difference kind, const ComparedRecord* of_a, const ComparedRecord* of_b) {
                               const auto& one = of_a != nullptr ? *of_a : *of_b;
                               compared.text += "-+~!"[static_cast<std::size_t>(kind)];
                               compared.text += std::to_string(one.record.frame.identifier) + ' ';
                             });
  compared.counts = comparison.compare();
  return compared;
}

Compared compare(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  return compare(frames(a), frames(b), {.tolerance = 1h});
}

TEST(TraceComparison, SameTraces_AreTheSame) {
  const Compared all = compare({1, 2, 3}, {1, 2, 3});
  EXPECT_TRUE(all.counts.are_same());
  EXPECT_EQ(all.counts.same, 3U);
}

TEST(TraceComparison, EmptyTraces_AreTheSame) { EXPECT_TRUE(compare({}, {}).counts.are_same()); }

TEST(TraceComparison, FrameThatOneLacks_IsFound) {
  EXPECT_EQ(compare({1, 2, 3, 4, 5, 6}, {1, 3, 4, 5, 6}).text, "-2 ");
  EXPECT_EQ(compare({1, 3, 4, 5, 6}, {1, 2, 3, 4, 5, 6}).text, "+2 ");
}

TEST(TraceComparison, FrameThatOneLacksAtAnEnd_IsFound) {
  EXPECT_EQ(compare({1, 2, 3}, {1, 2}).text, "-3 ");
  EXPECT_EQ(compare({1, 2}, {0, 1, 2}).text, "+0 ");
  EXPECT_EQ(compare({}, {7}).text, "+7 ");
}

TEST(TraceComparison, TwoFramesThatChangedPlaces_AreInAnotherOrder) {
  const Compared all = compare({1, 2, 3, 4, 5, 6}, {1, 3, 2, 4, 5, 6});
  EXPECT_EQ(all.text, "~2 ~3 ");
  EXPECT_EQ(all.counts.same, 4U);
}

TEST(TraceComparison, RepeatedFrames_DoNotHideTheOneThatIsMissing) {
  EXPECT_EQ(compare({1, 9, 1, 9, 1, 5, 1, 9, 1, 9}, {1, 9, 1, 9, 1, 1, 9, 1, 9}).text, "-5 ");
}

TEST(TraceComparison, TimeBeyondTheTolerance_IsADifference) {
  auto a = frames({1, 2});
  auto b = frames({1, 2});
  b[1].time += 2ms;
  EXPECT_EQ(compare(a, b, {.tolerance = 1ms}).text, "!2 ");
  const Compared same = compare(a, b, {.tolerance = 2ms});
  EXPECT_TRUE(same.counts.are_same());
  EXPECT_EQ(same.counts.largest, can::Duration(2ms));
}

TEST(TraceComparison, Channels_AreComparedIfWanted) {
  auto b = frames({1});
  b[0].channel = "can1";
  EXPECT_EQ(compare(frames({1}), b, {.tolerance = 1ms}).text, "-1 +1 ");
  EXPECT_TRUE(compare(frames({1}), b, {.tolerance = 1ms, .channels = false}).counts.are_same());
}

TEST(TraceComparison, TracesWithNothingInCommon_ComeToAnEnd) {
  std::vector<std::uint32_t> a(2000, 1), b(1500, 2);
  const Compared all = compare(a, b);
  EXPECT_EQ(all.counts.only_in_a, 2000U);
  EXPECT_EQ(all.counts.only_in_b, 1500U);
}

}  // namespace
}  // namespace canopus::cli::trace_comparison_test
