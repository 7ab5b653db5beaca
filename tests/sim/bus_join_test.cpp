// A controller that comes to a running bus at any moment.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/sim/bus/bus.hpp"

#include "sim/bus_station.hpp"

namespace canopus::sim::bus_join_test {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::Time;

// On an idle bus of 250 kbit/s the one that was plugged in is idle at the sample point of its 11th bit, 43.5
// us after it came, and this bit ends at 44 us.
TEST(BusJoin, AFrameSentAtAnyMomentAfterAJoin_StartsAtOnce) {
  for (const can::Duration after : {0ns, 1ns, 3'499ns, 43'499ns, 43'500ns, 43'501ns, 43'750ns, 43'975ns,
                                    43'999ns, 44'000ns, 44'001ns, 100'000ns}) {
    can::Timeline timeline;
    std::vector<std::string> stalls;
    timeline.set_stall_handler([&](const can::Timeline::Stall& stall) { stalls.push_back(stall.text()); });
    Bus bus("main", 250'000, timeline);
    Station a(bus, timeline, "a");
    Station b(bus, timeline, "b");
    Station late(bus, timeline, "late");
    late.port.plug(false);
    const Time join = Time(1ms) + 1ns;
    timeline.run_until(join);
    late.port.plug(true);
    const Time sent = join + after;
    a.send_at(sent, data_frame(0x123, {0x55}));
    timeline.run_until(Time(10ms));
    ASSERT_EQ(stalls, std::vector<std::string>{}) << after.count();
    const std::vector<Heard> at_its_end{{data_frame(0x123, {0x55}), sent + 53 * 4us}};
    EXPECT_EQ(b.heard, at_its_end) << after.count();
    // Before its 11th recessive bit was sampled it takes no part.
    EXPECT_EQ(late.heard, after <= 43'500ns ? std::vector<Heard>{} : at_its_end) << after.count();
  }
}

}  // namespace
}  // namespace canopus::sim::bus_join_test
