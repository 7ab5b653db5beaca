// Who wins: the table of offers against a search through all of them.

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/can/transmit_queue.hpp"
#include "canopus/sim/bus/port_table.hpp"

namespace canopus::sim::test {
namespace {

constexpr std::uint32_t ports = 70;  // more than a word of them

/// Few identifiers, so that many are the same; base and extended ones, data and remote frames.
std::uint32_t some_arbitration(unsigned choice) {
  const can::Frame frame{
      .identifier = choice % 7 * 300 + choice % 3, .extended = choice % 5 == 0, .remote = choice % 4 == 0};
  return can::arbitration(frame);
}

RC_GTEST_PROP(WireArbiter, IsWhoASearchFinds, ()) {
  Arbiter arbiter;
  arbiter.expect_identifiers();
  arbiter.resize(ports);
  std::vector<std::uint64_t> offers(ports, Arbiter::none);
  const auto steps = *rc::gen::container<std::vector<std::uint32_t>>(rc::gen::arbitrary<std::uint32_t>());
  for (const std::uint32_t step : steps) {
    const std::uint32_t port = step % ports;
    const std::uint32_t choice = step / ports % 211;
    offers[port] = choice % 3 == 2 ? Arbiter::none : Arbiter::key(some_arbitration(choice), port);
    arbiter.set(port, offers[port]);
    const std::uint64_t lowest = *std::ranges::min_element(offers);
    RC_ASSERT(arbiter.lowest() == lowest);
    RC_ASSERT(arbiter.of(port) == offers[port]);
    if (lowest == Arbiter::none) continue;
    const auto shared = std::ranges::count_if(offers, [&](std::uint64_t offer) {
      return offer != Arbiter::none && Arbiter::value_of(offer) == Arbiter::value_of(lowest);
    });
    RC_ASSERT(arbiter.is_lowest_shared() == (shared > 1));
  }
}

TEST(WireArbiter, GrowsWithItsPorts) {
  Arbiter arbiter;
  arbiter.expect_identifiers();
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
}  // namespace canopus::sim::test
