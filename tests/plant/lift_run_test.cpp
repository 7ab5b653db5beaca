// Lifts of a plant and an FX3U-CAN in 417 mode as their controller: both sides together.

#include "plant/lift_run.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include <fmt/format.h>

#include "canopus/cli/run/lift_picture.hpp"

#include "support/random_cases.hpp"

namespace canopus::plant::lift_run_test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string one_lift(unsigned seed, std::string_view more = "") {
  return fmt::format(
      "[[lift]]\nfloors = 5\nspeed = 1.6\n{}\n[lift.passengers]\ncount = 15\nfrom = \"8s\"\nuntil = "
      "\"3min\"\nseed = {}\n",
      more, seed);
}

TEST_F(LiftRun, Check_NamesItsDevices_AndHasNothingToSay) {
  EXPECT_THAT(check(std::string(lift_controller) + one_lift(1)), IsEmpty());
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

// Two lifts in eight floors share their hall calls. CANOPUS_SEEDS: how many seeds.
TEST_F(LiftRun, EverybodyArrives_WithTwoLifts_FromEverySeed) {
  const unsigned seeds = support::random_cases(4, 10);
  can::Duration longest{};
  std::uint32_t overloads = 0, reversals = 0;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    start(fmt::format(R"([[lift]]
number = [1, 2]
floors = 8
floor_height = 3.2
speed = 1.6
[lift.doors]
close_time = "2.5s"
[lift.passengers]
count = 40
from = "10s"
until = "8min"
seed = {}
)",
                      seed));
    std::vector<std::uint32_t> levels;
    for (std::uint32_t floor = 0; floor < 8; ++floor) levels.push_back(3200 * floor);
    LiftControl control(*plant_, 2, levels, 1600);
    while (plant_->timeline().now() < can::Time{20min} && report().arrived < 40) control.scan();
    const sim::lift::LiftReport end = report();
    ASSERT_EQ(end.arrived, 40U) << "seed " << seed;
    ASSERT_EQ(end.unsafe(), 0U) << "seed " << seed;
    ASSERT_LT(end.longest_waiting, 5min) << "seed " << seed;
    longest = std::max(longest, end.longest_waiting);
    for (const sim::lift::CarCounts& car : end.cars) {
      EXPECT_GT(car.starts, 0U) << "seed " << seed;
      overloads += car.overloads;
      reversals += car.reversals;
    }
  }
  std::cout << seeds << " seeds, longest waiting " << longest / 1s << " s, " << reversals << " reversals, "
            << overloads << " overloads\n";
}

// Rush hour in a small car: some have to step back out of it, and no overloaded car moves.
TEST_F(LiftRun, AnOverloadedCar_WaitsUntilTheLastOnesHaveLeft) {
  start(R"([[lift]]
floors = 4
rated_load = 200
[lift.passengers]
count = 30
from = "8s"
until = "40s"
main_floor = 1
seed = 3
)");
  LiftControl control(*plant_, 1, {0, 3000, 6000, 9000}, 1000);
  while (plant_->timeline().now() < can::Time{30min} && report().arrived < 30) control.scan();
  EXPECT_EQ(report().arrived, 30U);
  EXPECT_GT(report().cars[0].overloads, 3U);
  EXPECT_EQ(report().unsafe(), 0U);
}

// A floor on the other side of the car.
TEST_F(LiftRun, DoorAtAWall_AndTravelWithOpenDoor_AreUnsafe) {
  start("[[lift]]\nfloors = [0, 3, 6.5]\n[lift.doors]\nrear_floors = [1]\n");
  LiftControl control(*plant_, 1, {}, 0);
  control.run_until(can::Time{10s});
  control.write(13050, 0x4FFF);  // door 1; floor 1 is reached by door 2
  control.run_until(can::Time{13s});
  EXPECT_EQ(control.read(12050), 0x3000);
  EXPECT_EQ(report().cars[0].door_open_between_floors, 1U);
  control.write(13050, 0x1FFF);
  control.run_until(can::Time{17s});
  EXPECT_EQ(control.read(12050), 0x0011);
  control.write(13051, 0x4FFF);
  control.run_until(can::Time{20s});
  EXPECT_EQ(control.read(12051), 0x3000);
  EXPECT_EQ(control.read(12083), 900);
  EXPECT_EQ(report().unsafe(), 1U);
  // It goes all the same: the safety circuit brakes it, and the drive is in the state Fault.
  control.enable(0);
  control.travel(0, 6500, 1000);
  control.run_until(control.now() + 4s);
  EXPECT_EQ(report().cars[0].door_open_while_moving, 1U);
  EXPECT_EQ(control.read(12428) & 0x4F, 0x08);
  EXPECT_LT(control.read(12300), 400);
  EXPECT_EQ(control.read(12492), 0);
}

// Behind the older numbers are the same words.
TEST_F(LiftRun, TravelInBothModes) {
  start("[[lift]]\nfloors = 8\nspeed = 2.5\nacceleration = 1\njerk = 1.5\n");
  LiftControl control(*plant_, 1, {}, 0);
  control.run_until(can::Time{10s});
  EXPECT_EQ(control.read(12428), 0x0240);
  EXPECT_EQ(control.read(12300), 0);
  EXPECT_EQ(control.read(12508), 0);
  EXPECT_EQ(control.read(12524), 1);
  control.enable(0);
  control.travel(0, 21'000, 2500);
  control.run_until(control.now() + 3s);
  EXPECT_GT(control.read(12492), 1000);
  EXPECT_NE(control.read(12444), 0);
  control.run_until(control.now() + 15s);
  EXPECT_EQ(control.read(12428) & 0x1400, 0x0400);
  EXPECT_EQ(control.read(12300), 21'000);
  EXPECT_EQ(control.read(3300), 21'000);
  EXPECT_EQ(control.read(12492), 0);
  control.write(13436, 3);
  control.write_long(13492, static_cast<std::uint32_t>(-500));
  control.run_until(control.now() + 4s);
  EXPECT_EQ(control.read(12436), 3);
  EXPECT_EQ(control.read(12492), 0xFE0C);
  EXPECT_EQ(control.read(12493), 0xFFFF);
  EXPECT_LT(control.read(12300), 20'500);
}

TEST_F(LiftRun, Picture) {
  start(one_lift(2, "[[lift.fault]]\nkind = \"light barrier blocked\"\nat = \"70s\"\nfor = \"5s\"\n"));
  const std::string path = (folder_ / "lift.svg").string();
  auto picture = cli::LiftPictureFile::open(path, *plant_);
  ASSERT_TRUE(picture);
  LiftControl control(*plant_, 1, {0, 3000, 6000, 9000, 12000}, 1600);
  control.run_until(can::Time{2min});
  EXPECT_EQ((*picture)->close(control.now()), "");
  std::ifstream file(path);
  const std::string svg((std::istreambuf_iterator<char>(file)), {});
  EXPECT_THAT(svg, ::testing::StartsWith("<svg xmlns="));
  EXPECT_THAT(svg, ::testing::EndsWith("</svg>\n"));
  EXPECT_THAT(svg, HasSubstr(">hoist lift 1</text>"));
  EXPECT_THAT(svg, HasSubstr("<polyline class=\"car\" points=\"70.0,"));
  EXPECT_THAT(svg, HasSubstr("<path class=\"door\""));
  EXPECT_THAT(svg, HasSubstr("<path class=\"hallcall\""));
  EXPECT_THAT(svg, HasSubstr("<circle class=\"carmark\""));
  EXPECT_THAT(svg, HasSubstr(">light barrier blocked</text>"));
  EXPECT_THAT(svg, HasSubstr(">2 min</text>"));
  // Not without a lift, nor where nobody may write.
  EXPECT_THAT(cli::LiftPictureFile::open("/nowhere/lift.svg", *plant_).error(),
              HasSubstr("cannot write /nowhere/lift.svg"));
  start("");
  EXPECT_EQ(cli::LiftPictureFile::open(path, *plant_).error(),
            "--svg: the plant has no [[lift]] to be drawn");
}

}  // namespace
}  // namespace canopus::plant::lift_run_test
