// Lifts of a plant and an FX3U-CAN in 417 mode as their controller: both sides together.

#include <cstdlib>

#include <fmt/format.h>

#include "canopus/plant/lift_seat.hpp"

#include "plant/lift_control.hpp"
#include "support/plant_folder.hpp"

namespace canopus::plant {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::string_view controller = R"(
[[bus]]
name = "hoist"
bit_rate = 250_000

[[plc]]
name = "plc"
family = "FX3"
listen = "off"

[[plc.module]]
model = "FX3U-CAN"
position = 0
node = 1
buffer = { G21 = 417, G26 = 0 }
[plc.module.objects]
"1F80:00" = 0x03
"6001:00" = 0x03
"1902:01" = 0x40000182
"1904:01" = 0x40000180
"1908:01" = 0x40000200
"1912:01" = 0x40000192
"1914:01" = 0x40000190
"1918:01" = 0x40000210

)";

class LiftRun : public support::PlantFolder, public PlantObserver {
 protected:
  void start(std::string_view lift) {
    plant_ = support::PlantFolder::load(std::string(controller) + std::string(lift), *this);
    ASSERT_NE(plant_, nullptr);
    plant_->power_on();
  }
  [[nodiscard]] const sim::lift::Building& building() { return plant_->lift(0).building(); }
  [[nodiscard]] sim::lift::LiftReport report() { return building().report(); }

  std::unique_ptr<Plant> plant_;
};

std::string one_lift(unsigned seed, std::string_view more = "") {
  return fmt::format(
      "[[lift]]\nfloors = 5\nspeed = 1.6\n{}\n[lift.passengers]\ncount = 15\nfrom = \"8s\"\nuntil = "
      "\"3min\"\nseed = {}\n",
      more, seed);
}

TEST_F(LiftRun, Check_NamesItsDevices_AndHasNothingToSay) {
  EXPECT_THAT(check(std::string(controller) + one_lift(1)), IsEmpty());
  EXPECT_THAT(summary_, HasSubstr("lift 1 on hoist: 5 floors, 15 passengers\n  node 2: lift 1 floor 1\n"));
  EXPECT_THAT(summary_, HasSubstr("  node 11: lift 1 door 1\n"));
}

TEST_F(LiftRun, EverybodyArrives_WithOneLift) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    start(one_lift(seed));
    LiftControl control(*plant_, 1, {0, 3000, 6000, 9000, 12000}, 1600);
    while (plant_->timeline().now() < can::Time{15min} && report().arrived < 15) control.scan();
    const sim::lift::LiftReport end = report();
    EXPECT_EQ(end.arrived, 15U) << "seed " << seed;
    EXPECT_EQ(end.unsafe(), 0U) << "seed " << seed;
    EXPECT_GT(end.cars[0].starts, 5U);
    EXPECT_GT(end.cars[0].door_cycles, 5U);
  }
}

}  // namespace
}  // namespace canopus::plant
