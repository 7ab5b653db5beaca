// Drives of a plant file: what is read, what is wrong, and that the axis moves.

#include <fmt/format.h>

#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/event.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::plant::device_drive_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

std::string device(std::string_view eds = "drive.eds") {
  return fmt::format(
      "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[device]]\nname = \"axis\"\nnode = 3\neds = "
      "\"{}/examples/devices/{}\"\n",
      CANOPUS_SOURCE_DIR, eds);
}

std::string force(std::string_view at, std::string_view object, std::string_view value) {
  return fmt::format("[[device.script]]\nat = \"{}\"\nset = {{ object = \"{}\", value = {} }}\n", at, object,
                     value);
}

class DeviceDrive : public support::PlantFolder, public PlantObserver {
 protected:
  void run(std::string_view text, can::Duration time) {
    plant_ = support::PlantFolder::load(text, *this);
    ASSERT_NE(plant_, nullptr);
    plant_->power_on();
    plant_->bus(0).add_port("peer").plug(true);
    plant_->timeline().run_until(can::Time{time});
  }
  template <typename T>
  T value(std::uint16_t index) {
    return plant_->device(0).device().node().dictionary().get<T>(index, 0);
  }

  std::unique_ptr<Plant> plant_;
};

TEST_F(DeviceDrive, EachMistakeIsSaidWithItsPlace) {
  const auto says = [&](std::string_view keys, std::string_view error) {
    EXPECT_THAT(check(device() + "[device.drive]\n" + std::string(keys)),
                ElementsAre(AllOf(HasSubstr("plant.toml:"), HasSubstr(error))))
        << keys;
  };
  says("low_switch = 5\nhigh_switch = 5\n", ":9:14: low_switch = 5: expected less than high_switch");
  says("high_switch = 2147483648\n",
       ":9:15: high_switch = 2147483648: a position is -2147483648 to 2147483647");
  says("start = \"here\"\n", ":9:9: start = \"here\": expected a number");
  says("revolution = 0\n", ":9:14: revolution = 0: a revolution is 1 to 2147483647");
  says("[[device.drive.fault]]\nat = \"1s\"\n",
       "device.drive.fault: code is missing; an error code is 0x0001 to 0xFFFF");
  says("[[device.drive.fault]]\nat = \"1s\"\ncode = 0x10000\n",
       ":11:8: code = 65536: an error code is 0x0001 to 0xFFFF");
  says("[[device.drive.fault]]\ncode = 1\n", "at is missing");
  says("limit = 5\n", "limit");
  EXPECT_THAT(check(device() + "drive = 5\n"),
              ElementsAre(HasSubstr(":8:9: drive = 5: expected a table, written as [device.drive]")));
  EXPECT_THAT(check(device("io-block.eds") + "[device.drive]\n"),
              ElementsAre(HasSubstr(":8:1: drive: a drive needs the object 6040:00")));
  EXPECT_THAT(
      check(device() + "[device.drive]\n[[device.behaviour]]\nobject = \"6064:00\"\nkind = \"sine\"\n"),
      ElementsAre(HasSubstr("behaviour: 6064:00 is moved by the device itself")));
  EXPECT_THAT(check(device() + "[device.drive]\nlow_switch = -5.5\nrevolution = 100\n"), IsEmpty());
}

// What a master writes comes from a script here: enabled, and 1000 units at 1000/s and 10,000/s², 1.1 s.
const std::string travel = force("1s", "6060:00", "1") + force("1.1s", "6040:00", "6") +
                           force("1.2s", "6040:00", "7") + force("1.3s", "6040:00", "15") +
                           force("1.4s", "607A:00", "1000") + force("2s", "6040:00", "31");

TEST_F(DeviceDrive, TheAxisGoesToItsSetPoint) {
  run(device() + "[device.drive]\nstart = -100\n" + travel, 3000ms);
  EXPECT_EQ(value<std::int32_t>(0x6064), 850) << "1 s, less 50 while it sped up";
  EXPECT_EQ(value<std::uint16_t>(0x6041), 0x1237);
  plant_->timeline().run_until(can::Time{3200ms});
  EXPECT_EQ(value<std::int32_t>(0x6064), 1000);
  EXPECT_EQ(value<std::uint16_t>(0x6041), 0x1637);
}

TEST_F(DeviceDrive, AFaultComesAtItsTime) {
  run(device() + "[device.drive]\n" + travel + "[[device.drive.fault]]\nat = \"2.5s\"\ncode = 0x4310\n",
      2499ms);
  EXPECT_EQ(value<std::uint16_t>(0x603F), 0);
  plant_->timeline().run_until(can::Time{2500ms});
  EXPECT_EQ(value<std::uint16_t>(0x603F), 0x4310);
  EXPECT_EQ(value<std::uint16_t>(0x6041) & 0x4F, 0x0F);
  plant_->timeline().run_until(can::Time{2520ms});
  EXPECT_EQ(value<std::uint16_t>(0x6041) & 0x4F, 0x08);
  EXPECT_EQ(value<std::int32_t>(0x6064), 460) << "450, and 1000/s braked at 50,000/s²";
}

/// Warnings of the run.
class StandingDrive : public DeviceDrive {
 protected:
  void on(const Event& event) override {
    if (const auto* const warning = std::get_if<Warning>(&event.what); warning != nullptr)
      warnings.push_back(
          fmt::format("{} {}: {}", event.time.time_since_epoch() / 1ms, warning->source, warning->message));
  }
  std::vector<std::string> why(std::string_view scripts, std::string_view objects = "") {
    warnings.clear();
    run(device() + std::string(objects) + "[device.drive]\n" + std::string(scripts), 4000ms);
    return std::move(warnings);
  }
  std::vector<std::string> warnings;
};

const std::string enable =
    force("1.1s", "6040:00", "6") + force("1.2s", "6040:00", "7") + force("1.3s", "6040:00", "15");

TEST_F(StandingDrive, ThatMoves_SaysNothing) { EXPECT_THAT(why(travel), IsEmpty()); }

TEST_F(StandingDrive, WithoutSupportedModes_SaysSoOnceWhenItIsEnabled) {
  EXPECT_THAT(why(travel, "objects = { \"6502:00\" = 0 }\n"),
              ElementsAre(AllOf(
                  HasSubstr("1300 line1 node 3 (axis): does not move: its 6502:00 (supported drive modes)"),
                  HasSubstr("so 6061:00 stays \"no mode\""))));
}

TEST_F(StandingDrive, WithoutAMode_SaysSoOnceWhenItIsToMove) {
  EXPECT_THAT(
      why(enable + force("2s", "6040:00", "31") + force("2.5s", "6040:00", "15") +
              force("3s", "6040:00", "31"),
          "objects = { \"6060:00\" = 0 }\n"),
      ElementsAre(HasSubstr("2000 line1 node 3 (axis): does not move: 6060:00 (modes of operation) is 0")));
  EXPECT_THAT(why(enable + force("2s", "60FF:00", "100"), "objects = { \"6060:00\" = 8 }\n"),
              ElementsAre(HasSubstr(
                  "2000 line1 node 3 (axis): does not move: 6060:00 (modes of operation) asks for a "
                  "mode that is not simulated")));
}

TEST_F(StandingDrive, ThatIsNotEnabled_SaysSo) {
  EXPECT_THAT(why(force("1s", "6060:00", "1") + force("2s", "6040:00", "31")),
              ElementsAre(HasSubstr(
                  "2000 line1 node 3 (axis): does not move: a set point or a speed comes while it is "
                  "not enabled; expected 6040:00 = 6, 7 and 15")));
}

TEST_F(StandingDrive, WithoutASpeed_SaysSo) {
  EXPECT_THAT(
      why(travel, "objects = { \"6081:00\" = 0 }\n"),
      ElementsAre(HasSubstr("2000 line1 node 3 (axis): does not move: 6081:00 (profile velocity) is 0")));
}

}  // namespace
}  // namespace canopus::plant::device_drive_test
