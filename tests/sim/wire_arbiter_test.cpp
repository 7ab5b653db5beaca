// Which port wins: the arbiter against a search through all offers.

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/can/transmit_queue.hpp"
#include "canopus/sim/bus/wire/arbiter.hpp"

namespace canopus::sim::test::wire_arbiter_test {
namespace {

constexpr std::uint32_t ports = 70;  // more than a word of them

/// Receivers identifiers, so that many are the same; base and extended ones, data and remote frames.
std::uint32_t some_arbitration(unsigned choice) {
  const can::Frame frame{
      .identifier = choice % 7 * 300 + choice % 3, .extended = choice % 5 == 0, .remote = choice % 4 == 0};
  return can::arbitration(frame);
}

/// An arbiter, and all offers beside it.
struct ArbiterBeside {
  explicit ArbiterBeside(std::uint32_t count) : offers(count, Arbiter::none) { arbiter.resize(count); }
  /// A port offers something or nothing. True: the arbiter has what a search finds.
  [[nodiscard]] bool agrees_after(std::uint32_t step) {
    const std::uint32_t port = step % static_cast<std::uint32_t>(offers.size());
    const std::uint32_t choice = step / static_cast<std::uint32_t>(offers.size()) % 211;
    offers[port] = choice % 3 == 2 ? Arbiter::none : Arbiter::key(some_arbitration(choice), port);
    arbiter.set(port, offers[port]);
    const std::uint64_t lowest = *std::ranges::min_element(offers);
    if (arbiter.lowest() != lowest || arbiter.of(port) != offers[port]) return false;
    if (lowest == Arbiter::none) return true;
    const auto shared = std::ranges::count_if(offers, [&](std::uint64_t offer) {
      return offer != Arbiter::none && Arbiter::value_of(offer) == Arbiter::value_of(lowest);
    });
    return arbiter.is_lowest_shared() == (shared > 1);
  }

  Arbiter arbiter;
  std::vector<std::uint64_t> offers;
};

RC_GTEST_PROP(WireArbiter, FindsWhatASearchFinds, ()) {
  ArbiterBeside pair(ports);
  const auto steps = *rc::gen::container<std::vector<std::uint32_t>>(rc::gen::arbitrary<std::uint32_t>());
  for (const std::uint32_t step : steps) RC_ASSERT(pair.agrees_after(step));
}

TEST(WireArbiter, OfAFewPortsThatComeAndGoAllTheTime_FindsWhatASearchFinds) {
  std::mt19937 random(3);
  for (std::uint32_t count = 1; count <= 6; ++count) {
    ArbiterBeside pair(count);
    for (int step = 0; step < 5'000; ++step)
      ASSERT_TRUE(pair.agrees_after(static_cast<std::uint32_t>(random())))
          << count << " ports, step " << step;
  }
}

TEST(WireArbiter, AnArbiterThatWasJustMade_HasRoomForEveryIdentifier) {
  Arbiter arbiter;
  arbiter.resize(2);
  EXPECT_EQ(arbiter.lowest(), Arbiter::none);
  for (const std::uint32_t identifier : {0x7FFU, 0x181U, 0U}) {
    arbiter.set(1, Arbiter::key(can::arbitration({.identifier = identifier}), 1));
    EXPECT_EQ(arbiter.lowest(), Arbiter::key(can::arbitration({.identifier = identifier}), 1));
  }
}

// [ISO 11898-1 arbitration field]: RTR of a base frame, then SRR and IDE of an extended one are recessive where a base data
// frame is dominant.
TEST(WireArbiter, OfFramesWithTheSameFirstElevenBits_ABaseDataFrameWinsThenItsRemoteFrameThenAnExtendedOne) {
  Arbiter arbiter;
  arbiter.resize(3);
  arbiter.set(0, Arbiter::key(can::arbitration({.identifier = 0x123U << 18, .extended = true}), 0));
  EXPECT_EQ(Arbiter::port_of(arbiter.lowest()), 0U);
  arbiter.set(1, Arbiter::key(can::arbitration({.identifier = 0x123, .remote = true}), 1));
  EXPECT_EQ(Arbiter::port_of(arbiter.lowest()), 1U);
  arbiter.set(2, Arbiter::key(can::arbitration({.identifier = 0x123}), 2));
  EXPECT_EQ(Arbiter::port_of(arbiter.lowest()), 2U);
  EXPECT_FALSE(arbiter.is_lowest_shared());
}

TEST(WireArbiter, GrowsWithItsPorts) {
  Arbiter arbiter;
  arbiter.resize(1);
  const auto base = Arbiter::key(can::arbitration({.identifier = 0x181}), 0);
  arbiter.set(0, base);
  arbiter.resize(3);
  EXPECT_EQ(arbiter.lowest(), base);
  EXPECT_FALSE(arbiter.is_lowest_shared());
  arbiter.set(2, Arbiter::key(can::arbitration({.identifier = 0x181}), 2));
  EXPECT_EQ(arbiter.lowest(), base);
  EXPECT_TRUE(arbiter.is_lowest_shared());
  arbiter.set(0, Arbiter::none);
  EXPECT_EQ(Arbiter::port_of(arbiter.lowest()), 2U);
  EXPECT_FALSE(arbiter.is_lowest_shared());
}

}  // namespace
}  // namespace canopus::sim::test::wire_arbiter_test
