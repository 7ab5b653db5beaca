// NodeAlarms against a plain array.

#include "canopus/manager/sdo/node_alarms.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::manager::node_alarms_test {
namespace {

TEST(NodeAlarms, ThatAreNotSet_AreNeverDue) {
  NodeAlarms alarms;
  EXPECT_EQ(alarms.alarm().deadline(), can::never);
}

RC_GTEST_PROP(NodeAlarms, TheEarliestOneComesFirst_OfEqualOnesTheLowestNumber,
              (const std::vector<std::pair<std::uint8_t, std::uint8_t>>& changes)) {
  NodeAlarms alarms;
  can::Alarm whole;
  whole.add_part(alarms.alarm());
  std::array<can::Time, NodeAlarms::count> expected;
  expected.fill(can::never);
  for (const auto& [number, time] : changes) {
    const std::uint8_t node_id = number % NodeAlarms::count;
    expected[node_id] = time < 64 ? can::never : can::Time(can::Duration(time));
    alarms[node_id] = expected[node_id];
    const auto first = std::ranges::min_element(expected);
    RC_ASSERT(whole.deadline() == *first);
    if (*first != can::never) RC_ASSERT(alarms.first() == first - expected.begin());
  }
}

}  // namespace
}  // namespace canopus::manager::node_alarms_test
