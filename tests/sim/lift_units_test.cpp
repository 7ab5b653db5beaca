// Drive and door of a lift, its panels and its device files.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/sim/lift/door_unit.hpp"
#include "canopus/sim/lift/drive_unit.hpp"
#include "canopus/sim/lift/panel.hpp"
#include "canopus/sim/lift/units.hpp"

#include "paths.hpp"

namespace canopus::sim::lift::lift_units_test {
namespace {

using namespace std::chrono_literals;

class LiftDrive : public testing::Test {
 protected:
  std::uint16_t command(std::uint16_t control, can::Duration wait = 10ms) {
    command_.control_word = control;
    return again(wait);
  }
  std::uint16_t again(can::Duration wait) {
    for (const can::Time end = now_ + wait; now_ < end; now_ += 10ms) drive_.command(command_, now_);
    drive_.command(command_, now_);
    return drive_.status_word();
  }
  void enable() {
    command(6);
    command(7);
    EXPECT_EQ(command(0xF) & 0x6F, 0x27);
  }
  [[nodiscard]] double position() const { return drive_.motion(now_).position; }
  [[nodiscard]] double velocity() const { return drive_.motion(now_).velocity; }

  DriveUnit drive_{{{1000, 1000, 2000}, 0, 20'000}, 0};
  DriveCommand command_{.mode = 1, .profile_velocity = 1000};
  can::Time now_{};
};

TEST_F(LiftDrive, StateMachine) {
  EXPECT_EQ(again(10ms), 0x0240);
  EXPECT_EQ(command(0xF), 0x0240);  // shutdown comes first
  EXPECT_EQ(command(6), 0x0231);
  EXPECT_EQ(command(7), 0x0233);
  EXPECT_EQ(command(0xF) & 0x02FF, 0x0237);
  EXPECT_EQ(command(7), 0x0233);
  EXPECT_EQ(command(6), 0x0231);
  EXPECT_EQ(command(0xF) & 0x02FF, 0x0237);  // switch on and enable operation in one
  EXPECT_EQ(command(0), 0x0240);
  enable();
  EXPECT_EQ(command(2, 0ms), 0x0217);  // quick stop, at rest already
  EXPECT_EQ(again(20ms), 0x0240);
}

TEST_F(LiftDrive, ProfilePosition) {
  enable();
  command_.target_position = 10'000;
  EXPECT_EQ(again(50ms) & 0x1400, 0);  // a target alone is none
  EXPECT_EQ(velocity(), 0);
  EXPECT_EQ(command(0x1F) & 0x1400, 0x1000);
  EXPECT_EQ(command(0x0F, 1s) & 0x1400, 0);
  EXPECT_GT(velocity(), 100);
  EXPECT_EQ(again(11s) & 0x1400, 0x0400);
  EXPECT_EQ(position(), 10'000);
  // Relative, and changed at once on the way.
  command_.target_position = -2000;
  command(0x5F);
  again(500ms);
  command(0x0F);
  command_.target_position = 9'500;
  command(0x3F);
  EXPECT_EQ(again(10s) & 0x0400, 0x0400);
  EXPECT_EQ(position(), 9'500);
  // Without bit 5 it waits for its turn.
  command(0x0F);
  command_.target_position = 5'000;
  command(0x1F);
  command(0x0F);
  command_.target_position = 6'000;
  EXPECT_EQ(command(0x1F, 100ms) & 0x1400, 0x1000);
  again(6s);
  EXPECT_LT(position(), 6'000);
  again(6s);
  EXPECT_EQ(position(), 6'000);
  // Beyond the end, and faster than it can.
  command_.target_position = 30'000;
  command_.profile_velocity = 5'000;
  command(0x0F);
  EXPECT_EQ(command(0x1F) & 0x0800, 0x0800);
  again(30s);
  EXPECT_EQ(position(), 20'000);
}

TEST_F(LiftDrive, ProfileVelocity_Halt_QuickStop) {
  command_.mode = 3;
  enable();
  EXPECT_EQ(drive_.mode_display(), 3);
  command_.target_velocity = 500;
  EXPECT_EQ(again(2s) & 0x0400, 0x0400);
  EXPECT_EQ(velocity(), 500);
  EXPECT_EQ(command(0x10F, 2s) & 0x0400, 0x0400);
  EXPECT_EQ(velocity(), 0);
  command(0x0F, 2s);
  EXPECT_EQ(velocity(), 500);
  EXPECT_EQ(command(2, 50ms) & 0x6F, 0x07);
  EXPECT_GT(velocity(), 0);
  EXPECT_EQ(again(2s), 0x0240);
  EXPECT_EQ(velocity(), 0);
  command_.mode = 6;
  again(10ms);
  EXPECT_EQ(drive_.mode_display(), 0);
}

TEST_F(LiftDrive, Fault_EndsByItsResetAlone) {
  enable();
  command_.target_position = 10'000;
  command(0x1F, 2s);
  drive_.fail(true, now_);
  EXPECT_EQ(again(10ms) & 0x4F, 0x0F);
  EXPECT_EQ(again(3s) & 0x4F, 0x08);
  const double stopped = position();
  EXPECT_EQ(command(0x80) & 0x4F, 0x08);  // it is broken still
  drive_.repaired();
  EXPECT_EQ(again(10ms) & 0x4F, 0x08);  // the edge counts
  command(0);
  EXPECT_EQ(command(0x80), 0x0240);
  EXPECT_EQ(position(), stopped);
}

class LiftDoor : public testing::Test {
 protected:
  unsigned run(can::Duration time, bool blocked = false) {
    for (; time > 0ms; time -= 10ms) door_.step(10ms, blocked);
    return door_.status_word();
  }
  DoorUnit door_{{1000, 2s, 4s}};
};

TEST_F(LiftDoor, OpensAndCloses_InItsTime) {
  EXPECT_EQ(run(10ms), 0x1011U);  // closed without torque, locked, contact
  door_.command(0x4FFF);
  EXPECT_EQ(run(1000ms), 0x5000U);
  EXPECT_NEAR(door_.position(), 500, 1);
  EXPECT_EQ(run(1010ms), 0x3000U);
  EXPECT_EQ(door_.position(), 1000);
  door_.command(0x1FFF);
  EXPECT_EQ(run(3900ms), 0x2000U);
  EXPECT_EQ(run(110ms), 0x0011U);
  EXPECT_EQ(door_.openings(), 1U);
  door_.command(0x4FFF);
  run(500ms);
  door_.command(0x7FFF);
  EXPECT_EQ(run(10ms), 0x8000U);
  door_.command(0x8FFF);
  EXPECT_EQ(run(10ms), 0x7000U);
  door_.command(0x1FFF);
  EXPECT_EQ(run(4s), 0x0011U);
  EXPECT_EQ(door_.reversals(), 0U);
}

TEST_F(LiftDoor, Reopens_AndThenWaitsForACommand) {
  door_.command(0x4FFF);
  run(3s);
  door_.command(0x1FFF);
  run(1s);
  EXPECT_EQ(run(10ms, true), 0x6000U);
  EXPECT_EQ(run(2s, true), 0x3000U);
  EXPECT_EQ(run(10s), 0x3000U);
  EXPECT_EQ(door_.reversals(), 1U);
  door_.command(0xFFFF);
  door_.command(0x1FFF);
  EXPECT_EQ(run(1s, true), 0x3000U);  // does not begin while somebody stands there
  EXPECT_EQ(run(5s), 0x0011U);
  // Nudging: half as quick, and nothing stops it.
  door_.command(0x4FFF);
  run(3s);
  door_.command(0x2FFF);
  EXPECT_EQ(run(4s, true), 0x2000U);
  EXPECT_NEAR(door_.position(), 500, 5);
  EXPECT_EQ(run(5s, true), 0x0011U);
}

TEST(LiftPanel, ButtonsAndLamps) {
  Panel hall(3, 0x03, 0);
  hall.press(hall_call, up, can::Time{1s});
  EXPECT_EQ(hall.next_input(can::Time{1s}), (Mapping{2, 1, 3, 3, 1, 1}));
  EXPECT_EQ(hall.next_input(can::Time{1s}), std::nullopt);
  EXPECT_EQ(hall.deadline(can::Time{1s}), can::Time{1300ms});
  EXPECT_EQ(hall.next_input(can::Time{1300ms}), (Mapping{2, 1, 3, 3, 1, 0}));
  EXPECT_EQ(hall.deadline(can::Time{2s}), can::never);
  const auto out = [&](Mapping output) { return hall.output(output, can::Time{2s}); };
  EXPECT_FALSE(out({2, 1, 4, 3, 1, 1}));  // another lift's
  EXPECT_FALSE(out({2, 1, 1, 4, 1, 1}));  // another floor's
  EXPECT_TRUE(out({2, 1, 1, 3, 1, 0x81}));
  EXPECT_TRUE(hall.is_lit(up));
  EXPECT_FALSE(hall.is_lit(down));
  out({0x40, 5, 1, 0xFF, 1, 0});
  EXPECT_EQ(hall.shown_floor(), 5);
  out({0x41, 2, 2, 3, 1, 1});
  EXPECT_EQ(hall.lantern(1), down);
  EXPECT_EQ(hall.lantern(0), 0);
  out({0x42, 0x11, 1, 0xFF, 1, 1});
  EXPECT_EQ(hall.arrows(), 0x11);
  // The controller asks for what is active.
  out({0, 1, 1, 3, 1, 1});
  EXPECT_EQ(hall.next_input(can::Time{2s}), (Mapping{2, 1, 3, 3, 1, 1}));
  out({2, 1, 1, 3, 1, 0});
  EXPECT_FALSE(hall.is_lit(up));
  Panel car(0, 0x02, 0);
  EXPECT_FALSE(car.output({5, 4, 2, 0xFF, 1, 1}, can::Time{}));  // floor panels
  EXPECT_TRUE(car.output({5, 4, 2, 0, 1, 1}, can::Time{}));
  EXPECT_TRUE(car.is_lit(4));
  car.output({5, 0xFF, 2, 0, 1, 0}, can::Time{});
  EXPECT_FALSE(car.is_lit(4));
}

TEST(LiftUnits, DeviceFiles_AreWithoutFault) {
  const auto units = units_of({1, 2, 8}, {0, 1, 2});
  EXPECT_EQ(units.size(), 3U + 3U + 3U * 6U);
  std::set<std::string> names;
  for (const Unit& unit : units) {
    EXPECT_TRUE(names.insert(name(unit)).second) << name(unit);
    const eds::ReadResult read = eds::read_device_file(eds_text(unit));
    ASSERT_NE(read.file, nullptr);
    for (const eds::Problem& problem : read.problems) ADD_FAILURE() << name(unit) << ": " << problem.message;
    EXPECT_EQ(read.file->dictionary->objects().size(), device_file(unit)->dictionary->objects().size());
  }
  EXPECT_TRUE(names.contains("lift 1+2+8 floor 3"));
  EXPECT_TRUE(names.contains("lift 8 door 3"));
}

// With CANOPUS_WRITE_EXAMPLES set it writes them.
TEST(LiftUnits, ExampleFiles_AreThoseOfLift1) {
  for (const Unit& unit : units_of({1}, {0})) {
    const std::filesystem::path path = std::filesystem::path(CANOPUS_SOURCE_DIR "/examples/lift/devices") /
                                       device_file(unit)->file.file_name;
    if (std::getenv("CANOPUS_WRITE_EXAMPLES") != nullptr)
      std::ofstream(path, std::ios::binary) << eds_text(unit);
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    EXPECT_EQ(text.str(), eds_text(unit)) << path;
  }
}

TEST(LiftUnits, CanIdsOfLift8) {
  for (const Unit& unit : units_of({8}, {0, 0})) {
    const canopen::ObjectDictionary values(device_file(unit)->dictionary, 20);
    switch (unit.kind) {
      case UnitKind::hall_panel:
      case UnitKind::car_panel:
        EXPECT_EQ(values.get<std::uint32_t>(0x1881, 1), 0x40000494U);
        EXPECT_EQ(values.get<std::uint32_t>(0x1500, 1), 0x400U);
        break;
      case UnitKind::car_drive_unit:
        EXPECT_EQ(values.get<std::uint32_t>(0x1973, 1), 0x400001F3U);
        EXPECT_EQ(values.get<std::uint32_t>(0x1B73, 1), 0x9C010010U);
        EXPECT_EQ(values.get<std::uint32_t>(0x1572, 1), 0x1F2U);
        EXPECT_EQ(values.get<std::uint32_t>(0x1574, 1), 0x1F0U);
        EXPECT_EQ(values.get<std::uint32_t>(0x1975, 1), 0x400001F1U);
        break;
      case UnitKind::car_position_unit: EXPECT_EQ(values.get<std::uint32_t>(0x1976, 1), 0x400001FCU); break;
      case UnitKind::load_unit: EXPECT_EQ(values.get<std::uint32_t>(0x1971, 1), 0x400001F8U); break;
      case UnitKind::car_door_unit:
        EXPECT_EQ(values.get<std::uint32_t>(0x197A, 1), 0x40000271U);
        EXPECT_EQ(values.get<std::uint32_t>(0x197B, 1), 0x40000275U);
        EXPECT_EQ(values.get<std::uint32_t>(0x1578, 1), 0x270U);
        break;
    }
  }
}

}  // namespace
}  // namespace canopus::sim::lift::lift_units_test
