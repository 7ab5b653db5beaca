// What the times of a flying master come to, in words [CiA 302-2; RJ71CN91 1.9, App. 3 1F90H].

#include <gmock/gmock.h>

#include "canopus/manager/nmt/flying_master.hpp"

#include "master_bench.hpp"

namespace canopus::manager::test::negotiation_words_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using namespace std::chrono_literals;

TEST(NegotiationWords, OfTheDefaults) {
  EXPECT_EQ(
      negotiation_words({}, 5),
      "negotiation: 500 ms + 1 x 1500 ms + 5 x 10 ms = 2.05 s after a reset, and 100 ms more while it looks "
      "for an active master; asked for by another one: 1.55 s");
}

TEST(NegotiationWords, HaveEveryDigitThatCounts_AndNoOther) {
  const auto first = [](FlyingMasterTiming timing, std::uint8_t node_id) {
    const std::string words = negotiation_words(timing, node_id);
    return words.substr(0, words.find(" after"));
  };
  EXPECT_EQ(first({.negotiation_delay = 0ms, .level = 0}, 99),
            "negotiation: 0 ms + 0 x 1500 ms + 99 x 10 ms = 990 ms");
  EXPECT_EQ(first({.negotiation_delay = 10ms, .level = 0}, 99),
            "negotiation: 10 ms + 0 x 1500 ms + 99 x 10 ms = 1 s");
  EXPECT_EQ(first({.negotiation_delay = 5ms, .level = 2, .priority_slot = 1000ms, .device_slot = 0ms}, 1),
            "negotiation: 5 ms + 2 x 1000 ms + 1 x 0 ms = 2.005 s");
  EXPECT_EQ(
      first({.negotiation_delay = 65535ms, .level = 2, .priority_slot = 65535ms, .device_slot = 65535ms},
            127),
      "negotiation: 65535 ms + 2 x 65535 ms + 127 x 65535 ms = 8519.55 s");
}

TEST(NegotiationWords, SlotsOverlap_WhenAPriorityHasNotMoreThan127DeviceSlots) {
  EXPECT_THAT(overlapping_slots({}), IsEmpty());
  EXPECT_THAT(overlapping_slots({.priority_slot = 1271ms, .device_slot = 10ms}), IsEmpty());
  EXPECT_THAT(overlapping_slots({.priority_slot = 1270ms, .device_slot = 10ms}),
              StartsWith("a priority time slot of 1270 ms is not more than 127 x 10 ms = 1270 ms: "));
  EXPECT_THAT(overlapping_slots({.priority_slot = 0ms, .device_slot = 0ms}), HasSubstr("overlap"));
}

/// What a node with these objects says is when it claims to be the active master.
class NegotiationOfANode : public MasterBench {};

TEST_F(NegotiationOfANode, SaysWhenItClaims) {
  object(0x1F80, 0, 0x23);
  object(0x1F90, 1, 40);
  object(0x1F90, 2, 300);
  object(0x1F90, 3, 2);
  object(0x1F90, 4, 700);
  object(0x1F90, 5, 5);
  switch_on();
  run_until_ms(0);
  EXPECT_THAT(
      negotiation_words(flying_timing(node.dictionary(), 1), 1),
      StartsWith("negotiation: 300 ms + 2 x 700 ms + 1 x 5 ms = 1.705 s after a reset, and 40 ms more"));
  run_until_ms(1744);
  EXPECT_THAT(only(sent(), " 071 "), IsEmpty());
  run_until_ms(1745);
  EXPECT_THAT(only(sent(), " 071 "), ::testing::ElementsAre("1745 071 02 01"));
}

}  // namespace
}  // namespace canopus::manager::test::negotiation_words_test
