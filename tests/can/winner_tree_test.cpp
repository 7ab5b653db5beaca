#include "canopus/can/winner_tree.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace canopus::can::winner_tree_test {
namespace {

using namespace std::chrono_literals;

TEST(WinnerTree, WithoutDeadlines_HasNoEarliest) {
  WinnerTree tree;
  EXPECT_EQ(tree.earliest(), never);
  EXPECT_EQ(tree.add(), 0U);
  EXPECT_EQ(tree.add(), 1U);
  EXPECT_EQ(tree.earliest(), never);
}

TEST(WinnerTree, OfEqualDeadlines_TheLowestIndexWins) {
  WinnerTree tree;
  for (int i = 0; i < 5; ++i) (void)tree.add();
  for (const WinnerTree::Index index : {4U, 2U, 3U}) tree.set(index, Time(1ms));
  EXPECT_EQ(tree.winner(), 2U);
  tree.set(2, never);
  EXPECT_EQ(tree.winner(), 3U);
}

TEST(WinnerTree, DeadlinesNearYearsAwayAndBeforeThoseOfBefore_WinAsASearchFindsThem) {
  constexpr Duration reaches[] = {1us, 1s, 4h, 5h, 24h, 24h * 365 * 100};
  std::mt19937_64 random(5);
  for (int round = 0; round < 60; ++round) {
    WinnerTree tree;
    std::vector<Time> deadlines;
    for (int step = 0; step < 300; ++step) {
      if (deadlines.empty() || random() % 10 == 0) {
        ASSERT_EQ(tree.add(), deadlines.size());
        deadlines.push_back(never);
      }
      const auto index = static_cast<WinnerTree::Index>(random() % deadlines.size());
      deadlines[index] =
          random() % 4 == 0
              ? never
              : Time(reaches[random() % std::size(reaches)] * static_cast<std::int64_t>(random() % 3));
      tree.set(index, deadlines[index]);
      const auto earliest = std::ranges::min_element(deadlines);
      ASSERT_EQ(tree.earliest(), *earliest) << "round " << round << ", step " << step;
      if (*earliest != never) {
        ASSERT_EQ(tree.winner(), static_cast<std::size_t>(earliest - deadlines.begin()));
      }
      ASSERT_EQ(tree.deadline(index), deadlines[index]);
    }
  }
}

}  // namespace
}  // namespace canopus::can::winner_tree_test
