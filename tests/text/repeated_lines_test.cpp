#include "canopus/text/repeated_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::text::repeated_lines_test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

can::Time at(can::Duration time) { return can::Time(time); }

TEST(RepeatedLines, OneThousandThreeHundred_BecomeThreeAndACount) {
  RepeatedLines lines;
  int printed = 0;
  for (int i = 0; i < 1300; ++i) {
    EXPECT_THAT(lines.ended(at(i * 9ms)), IsEmpty());
    printed += lines.passes("node 2: bus-off", at(i * 9ms)) ? 1 : 0;
    printed += lines.passes("node 2: error active", at(i * 9ms + 1ms)) ? 1 : 0;
  }
  EXPECT_EQ(printed, 6);
  EXPECT_THAT(lines.ended(at(12'690ms)), IsEmpty()) << "a second has not passed";
  EXPECT_THAT(lines.ended(at(12'700ms)), ElementsAre("node 2: bus-off (×1300, last 11.7 s)",
                                                     "node 2: error active (×1300, last 11.7 s)"));
  EXPECT_THAT(lines.ended(can::never), IsEmpty()) << "each count is printed once";
  EXPECT_TRUE(lines.passes("node 2: bus-off", at(20s)));
}

TEST(RepeatedLines, OnceASecondOrLess_IsNoRepetition) {
  RepeatedLines lines;
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(lines.passes("boot-up", at(i * 1s)));
  EXPECT_THAT(lines.ended(can::never), IsEmpty());
}

TEST(RepeatedLines, EndOfARun_ShowsWhatIsStillCounted) {
  RepeatedLines lines;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(lines.passes("X10 ON", at(i * 1ms)), i < 3);
  EXPECT_THAT(lines.ended(can::never), ElementsAre("X10 ON (×4, last 0.0 s)"));
}

TEST(RepeatedLines, VeryManyDifferentLines_ArePrinted) {
  RepeatedLines lines;
  for (int i = 0; i < 100'000; ++i) ASSERT_TRUE(lines.passes(std::to_string(i), at(i * 1us)));
}

}  // namespace
}  // namespace canopus::text::repeated_lines_test
