// A servo drive as CiA 402 has it, spoken to as a master does: controlword and set-points in, statusword and position out.

#include "canopus/sim/drive/servo.hpp"

#include <fstream>
#include <iterator>

#include <gmock/gmock.h>

#include "canopus/sim/device/device.hpp"

#include "paths.hpp"

namespace canopus::sim::servo_test {
namespace {

using namespace canopus;
using namespace std::chrono_literals;
using can::data_frame;
using can::Frame;
using can::Time;
using sim::DriveState;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr Time at(can::Duration since_start) { return Time{since_start}; }

std::shared_ptr<const eds::DeviceFile> drive_file() {
  std::ifstream stream(CANOPUS_SOURCE_DIR "/examples/devices/drive.eds", std::ios::binary);
  return eds::read_device_file(std::string(std::istreambuf_iterator<char>(stream), {})).file;
}

/// Node 5: examples/devices/drive.eds, which counts 10,000 to a revolution.
class ServoTest : public testing::Test, public can::Sink {
 protected:
  void make(sim::ServoSettings settings = {}) {
    device_ = std::make_unique<sim::Device>(drive_file(), std::uint8_t{5}, *this);
    auto servo = sim::Servo::make(*device_->file().dictionary, std::move(settings));
    ASSERT_TRUE(servo.has_value()) << servo.error();
    device_->set_application(std::move(*servo));
    device_->power_on(now_);
  }
  bool send(const Frame& frame) override {
    sent_.push_back(frame);
    return true;
  }
  /// Writes an object as an SDO client does.
  void write(std::uint16_t index, std::uint8_t sub, std::int32_t value, unsigned bytes) {
    Frame frame = data_frame(
        0x605, {static_cast<std::uint8_t>(0x23U | (4U - bytes) << 2U), static_cast<std::uint8_t>(index),
                static_cast<std::uint8_t>(index >> 8U), sub, 0, 0, 0, 0});
    for (unsigned i = 0; i < bytes; ++i)
      frame.data[4 + i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> 8U * i);
    sent_.clear();
    device_->receive(frame, now_);
    ASSERT_FALSE(sent_.empty());
    ASSERT_EQ(sent_[0].data[0], 0x60) << "refused";
  }
  void command(std::uint16_t controlword) { write(0x6040, 0, controlword, 2); }
  void enable(std::int8_t mode) {
    write(0x6060, 0, mode, 1);
    command(0x0006);
    command(0x0007);
    command(0x000F);
    ASSERT_EQ(status() & 0x6F, 0x27);
  }
  template <typename T>
  T value(std::uint16_t index, std::uint8_t sub = 0) {
    return device_->node().dictionary().get<T>(index, sub);
  }
  std::uint16_t status() { return value<std::uint16_t>(0x6041); }
  std::int32_t position() { return value<std::int32_t>(0x6064); }
  std::int32_t speed() { return value<std::int32_t>(0x606C); }
  void run_until(Time end) {
    while (device_->deadline() <= end) {
      now_ = device_->deadline();
      device_->tick(now_);
    }
    now_ = end;
  }
  void run_for(can::Duration time) { run_until(now_ + time); }
  /// 1000/s, 10,000/s² up and down.
  void go_to(std::int32_t target, std::uint16_t bits = 0) {
    write(0x607A, 0, target, 4);
    command(static_cast<std::uint16_t>(0x000F | bits));
    command(static_cast<std::uint16_t>(0x001F | bits));
  }

  std::unique_ptr<sim::Device> device_;
  std::vector<Frame> sent_;
  Time now_{};
};

TEST(DriveStates, EachCommandInEachState) {
  using enum DriveState;
  struct Row {
    DriveState from;
    std::uint16_t word;
    DriveState to;
    bool stays = false;
  };
  const Row rows[] = {
      {not_ready_to_switch_on, 0x0000, switch_on_disabled},
      {switch_on_disabled, 0x0000, switch_on_disabled},
      {switch_on_disabled, 0x000F, switch_on_disabled},
      {switch_on_disabled, 0x0006, ready_to_switch_on},  // 2
      {ready_to_switch_on, 0x0007, switched_on},         // 3
      {ready_to_switch_on, 0x000F, operation_enabled},   // 3 and 4
      {ready_to_switch_on, 0x0000, switch_on_disabled},  // 7
      {ready_to_switch_on, 0x0002, switch_on_disabled},  // 7
      {switched_on, 0x000F, operation_enabled},          // 4
      {switched_on, 0x0006, ready_to_switch_on},         // 6
      {switched_on, 0x0000, switch_on_disabled},         // 10
      {switched_on, 0x0002, switch_on_disabled},         // 10
      {operation_enabled, 0x0007, switched_on},          // 5
      {operation_enabled, 0x0006, ready_to_switch_on},   // 8
      {operation_enabled, 0x0000, switch_on_disabled},   // 9
      {operation_enabled, 0x000D, switch_on_disabled},   // 9: voltage is off, whatever else
      {operation_enabled, 0x0002, quick_stop_active},    // 11
      {operation_enabled, 0x000B, quick_stop_active},    // 11
      {quick_stop_active, 0x0000, switch_on_disabled},   // 12
      {quick_stop_active, 0x000F, quick_stop_active},
      {quick_stop_active, 0x000F, operation_enabled, true},  // 16
      {quick_stop_active, 0x0006, quick_stop_active, true},
      {fault_reaction_active, 0x0000, fault_reaction_active},
      {fault, 0x000F, fault},
  };
  for (const Row& row : rows) {
    EXPECT_EQ(sim::next_state(row.from, row.word, false, row.stays), row.to)
        << static_cast<int>(row.from) << " at " << std::hex << row.word;
  }
  EXPECT_EQ(sim::next_state(fault, 0x0080, true, false), switch_on_disabled);  // 15
  EXPECT_EQ(sim::next_state(fault_reaction_active, 0x0080, true, false), fault_reaction_active);
}

TEST_F(ServoTest, Enabling_ShowsEveryState) {
  make();
  EXPECT_EQ(status(), 0x0250);
  command(0x0006);
  EXPECT_EQ(status(), 0x0231);
  command(0x0007);
  EXPECT_EQ(status(), 0x0233);
  write(0x6060, 0, 1, 1);
  EXPECT_EQ(value<std::int8_t>(0x6061), 1);
  command(0x000F);
  EXPECT_EQ(status(), 0x0637);  // profile position: stands at its target
  command(0x0000);
  EXPECT_EQ(status(), 0x0250);
}

TEST_F(ServoTest, AModeThatItHasNot_IsNotTaken) {
  make();
  write(0x6060, 0, 1, 1);
  write(0x6060, 0, 8, 1);
  EXPECT_EQ(value<std::int8_t>(0x6061), 1);
  write(0x6060, 0, -1, 1);
  EXPECT_EQ(value<std::int8_t>(0x6061), 1);
}

// 0.1 s up to 1000/s over 50, 0.1 s down over 50, 900 evenly in 0.9 s.
TEST_F(ServoTest, ASetPoint_IsAcknowledgedAndReached) {
  make();
  enable(1);
  write(0x607A, 0, 1000, 4);
  command(0x001F);
  EXPECT_EQ(status(), 0x1237);  // acknowledged, not reached
  command(0x000F);
  EXPECT_EQ(status(), 0x0237);
  run_until(at(100ms));
  EXPECT_EQ(position(), 50);
  EXPECT_EQ(speed(), 1000);
  EXPECT_EQ(value<std::int32_t>(0x6062), 50);
  EXPECT_EQ(value<std::int16_t>(0x6077), 50);
  run_until(at(1099ms));
  EXPECT_EQ(status(), 0x0237);
  EXPECT_EQ(value<std::int16_t>(0x6077), -250);
  run_until(at(1100ms));
  EXPECT_EQ(status(), 0x0637);
  EXPECT_EQ(position(), 1000);
  EXPECT_EQ(speed(), 0);
  EXPECT_EQ(device_->deadline(), can::never);
}

TEST_F(ServoTest, ASecondSetPoint_WaitsForTheFirst) {
  make();
  enable(1);
  go_to(1000);
  go_to(0);
  EXPECT_EQ(status(), 0x1237);
  command(0x000F);
  EXPECT_EQ(status(), 0x1237) << "acknowledged until it can take another one";
  run_until(at(1100ms));
  EXPECT_EQ(position(), 1000);
  EXPECT_EQ(status(), 0x0237);
  run_until(at(2200ms));
  EXPECT_EQ(position(), 0);
  EXPECT_EQ(status(), 0x0637);
}

TEST_F(ServoTest, ASetPointAtOnce_TakesOverTheMotion) {
  make();
  enable(1);
  go_to(10000);
  run_until(at(500ms));
  EXPECT_EQ(position(), 450);
  go_to(0, 0x20);
  run_until(at(600ms));
  EXPECT_EQ(position(), 500);
  EXPECT_EQ(speed(), 0);
  run_until(at(1200ms));
  EXPECT_EQ(position(), 0);
  EXPECT_EQ(status() & 0x0400, 0x0400);
}

TEST_F(ServoTest, ARelativeSetPoint_CountsFromTheLast) {
  make();
  enable(1);
  go_to(300, 0x40);
  run_until(at(1s));
  go_to(300, 0x40);
  run_until(at(2s));
  EXPECT_EQ(position(), 600);
}

TEST_F(ServoTest, Halt_StopsAndGoesOn) {
  make();
  enable(1);
  go_to(1000);
  run_until(at(500ms));
  command(0x011F);
  EXPECT_EQ(status() & 0x0400, 0);
  run_until(at(700ms));
  EXPECT_EQ(position(), 500);
  EXPECT_EQ(status() & 0x0400, 0x0400);
  command(0x001F);
  run_until(at(2s));
  EXPECT_EQ(position(), 1000);
}

TEST_F(ServoTest, SoftwareLimits_EndTheWay) {
  make();
  enable(1);
  write(0x607D, 1, -100, 4);
  write(0x607D, 2, 200, 4);
  go_to(1000);
  run_until(at(1s));
  EXPECT_EQ(position(), 200);
  EXPECT_EQ(status(), 0x1E37);
  go_to(100);
  run_until(at(2s));
  EXPECT_EQ(position(), 100);
  EXPECT_EQ(status(), 0x1637);
}

TEST_F(ServoTest, TheHighestSpeed_LimitsEachMode) {
  make();
  write(0x607F, 0, 500, 4);
  enable(1);
  go_to(5000);
  run_until(at(1s));
  EXPECT_EQ(speed(), 500);
  write(0x60FF, 0, -2000, 4);
  write(0x6060, 0, 3, 1);
  run_until(at(2s));
  EXPECT_EQ(speed(), -500);
}

TEST_F(ServoTest, ProfileVelocity_RunsAtItsTarget) {
  make();
  enable(3);
  EXPECT_EQ(status(), 0x1637);  // reached, speed 0
  write(0x60FF, 0, 2000, 4);
  EXPECT_EQ(status(), 0x0237);
  run_until(at(200ms));
  EXPECT_EQ(speed(), 2000);
  EXPECT_EQ(position(), 200);
  EXPECT_EQ(status(), 0x0637);
  run_until(at(1200ms));
  EXPECT_EQ(position(), 2200);
  command(0x010F);
  run_until(at(1400ms));
  EXPECT_EQ(speed(), 0);
  EXPECT_EQ(status(), 0x1637);
  command(0x000F);
  run_until(at(1600ms));
  EXPECT_EQ(speed(), 2000);
}

TEST_F(ServoTest, HomingWhereItStands_IsDoneAtOnce) {
  make({.start = 1234});
  EXPECT_EQ(position(), 1234);
  enable(6);
  EXPECT_EQ(status(), 0x0637);
  command(0x001F);
  EXPECT_EQ(status(), 0x1637);
  EXPECT_EQ(position(), 0);
  command(0x000F);
  EXPECT_EQ(status(), 0x1637);
  write(0x6060, 0, 1, 1);
  go_to(100);
  run_until(at(1s));
  EXPECT_EQ(position(), 100);
}

// 500/s to the switch, back to its edge at 50/s, which becomes 0.
TEST_F(ServoTest, HomingToALimitSwitch_TakesItsEdge) {
  make({.start = 500, .low_switch = -250});
  enable(6);
  write(0x6098, 0, 17, 1);
  command(0x001F);
  EXPECT_EQ(status(), 0x0237);
  run_until(at(1s));
  EXPECT_EQ(speed(), -500);
  run_until(at(1900ms));
  EXPECT_EQ(value<std::uint32_t>(0x60FD) & 3U, 1U);
  run_until(at(10s));
  EXPECT_EQ(status(), 0x1E37) << "attained, and still at the switch";
  EXPECT_EQ(position(), 0);
  command(0x000F);
  write(0x6060, 0, 1, 1);
  go_to(750);
  run_until(at(12s));
  EXPECT_EQ(value<std::uint32_t>(0x60FD), 0U);
  go_to(-100);
  run_until(at(15s));
  EXPECT_NEAR(position(), 0, 12)
      << "the switch stops it: 1000/s at 50,000/s² and what a look of 1 ms is late";
  EXPECT_EQ(status() & 0x0800, 0x0800);
}

TEST_F(ServoTest, HomingToAnIndex_GoesThere) {
  make({.start = 9000, .high_switch = 30000, .revolution = 4000});
  enable(6);
  write(0x6098, 0, 34, 1);
  write(0x6099, 2, 1000, 4);
  command(0x001F);
  run_until(at(10s));
  EXPECT_EQ(status(), 0x1637);
  command(0x000F);
  write(0x6098, 0, 33, 1);
  command(0x001F);
  run_until(at(20s));
  EXPECT_EQ(status(), 0x1637);
  write(0x6060, 0, 1, 1);
  command(0x000F);
  go_to(22000);  // from the index at 8000: 30,000 of the machine
  run_until(at(60s));
  EXPECT_EQ(position(), 22000);
  EXPECT_EQ(value<std::uint32_t>(0x60FD), 2U);
}

TEST_F(ServoTest, HomingThatIsInterruptedOrImpossible_SaysSo) {
  make({.high_switch = 30000});
  enable(6);
  write(0x6098, 0, 18, 1);
  command(0x001F);
  run_until(at(1s));
  command(0x000F);
  run_until(at(3s));
  EXPECT_EQ(status(), 0x0637) << "interrupted";
  write(0x6098, 0, 17, 1);
  command(0x001F);
  EXPECT_EQ(status(), 0x2637) << "it has no negative limit switch";
  command(0x000F);
  write(0x6098, 0, 5, 1);
  command(0x001F);
  EXPECT_EQ(status(), 0x2637) << "it has no such method";
}

TEST_F(ServoTest, QuickStop_BrakesHardAndEndsAsItsOptionSays) {
  make();
  write(0x607F, 0, 0, 4);
  enable(3);
  write(0x60FF, 0, 10000, 4);
  run_until(at(2s));
  command(0x0002);  // 605AH = 2: 50,000/s², 0.2 s, then it is disabled
  EXPECT_EQ(status() & 0x6F, 0x07);
  run_until(at(2199ms));
  EXPECT_EQ(status() & 0x6F, 0x07);
  run_until(at(2200ms));
  EXPECT_EQ(status() & 0x4F, 0x40);
  EXPECT_EQ(speed(), 0);
  write(0x605A, 0, 5, 2);  // its own deceleration, 1 s, and stays
  command(0x0006);
  command(0x000F);
  run_until(at(4s));
  EXPECT_EQ(speed(), 10000);
  command(0x000B);
  run_until(at(4999ms));
  EXPECT_EQ(status() & 0x046F, 0x0007);
  run_until(at(6s));
  EXPECT_EQ(status() & 0x046F, 0x0407);
  command(0x000F);
  EXPECT_EQ(status() & 0x6F, 0x27);
}

TEST_F(ServoTest, AFault_StopsTheAxisAndIsReported) {
  make({.faults = {{at(2s), 0x4310}, {at(1s), 0x2310}}});
  enable(3);
  write(0x607F, 0, 0, 4);
  write(0x60FF, 0, 5000, 4);
  sent_.clear();
  run_until(at(1s));
  EXPECT_THAT(sent_, ElementsAre(data_frame(0x085, {0x10, 0x23, 0x03, 0, 0, 0, 0, 0})));
  EXPECT_EQ(status() & 0x4F, 0x0F);
  EXPECT_EQ(value<std::uint16_t>(0x603F), 0x2310);
  EXPECT_EQ(value<std::uint8_t>(0x1001), 0x03);
  command(0x0080);
  EXPECT_EQ(status() & 0x4F, 0x0F) << "it still brakes";
  run_until(at(1100ms));
  EXPECT_EQ(status() & 0x4F, 0x08);
  EXPECT_EQ(speed(), 0);
  command(0x0000);
  command(0x0080);
  EXPECT_EQ(status() & 0x4F, 0x40);
  EXPECT_EQ(value<std::uint16_t>(0x603F), 0);
  EXPECT_EQ(value<std::uint8_t>(0x1001), 0);
  sent_.clear();
  run_until(at(2s));
  EXPECT_THAT(sent_, ElementsAre(data_frame(0x085, {0x10, 0x43, 0x09, 0, 0, 0, 0, 0})));
  EXPECT_EQ(status() & 0x4F, 0x08);
}

// What blocks the axis forces its position.
TEST_F(ServoTest, ABlockedAxis_IsAFollowingError) {
  make();
  enable(1);
  go_to(5000);
  run_until(at(1s));
  EXPECT_EQ(position(), 950);
  const auto entry = device_->process_value(0x6064, 0);
  sent_.clear();
  device_->force(*entry, 950, can::never, now_);
  run_until(at(2s));
  EXPECT_THAT(sent_, IsEmpty());  // 1000 behind: within 6065H
  run_until(at(2010ms));
  EXPECT_THAT(sent_, ElementsAre(data_frame(0x085, {0x11, 0x86, 0x21, 0, 0, 0, 0, 0})));
  EXPECT_EQ(value<std::uint16_t>(0x603F), 0x8611);
  EXPECT_EQ(status() & 0x4F, 0x0F);
}

TEST_F(ServoTest, ADriveWithoutItsObjects_IsRefused) {
  std::ifstream stream(CANOPUS_SOURCE_DIR "/examples/devices/io-block.eds", std::ios::binary);
  const auto file = eds::read_device_file(std::string(std::istreambuf_iterator<char>(stream), {})).file;
  const auto servo = sim::Servo::make(*file->dictionary, {});
  ASSERT_FALSE(servo.has_value());
  EXPECT_EQ(servo.error(), "a drive needs the object 6040:00");
}

TEST_F(ServoTest, NothingElseMovesItsObjects) {
  make();
  EXPECT_EQ(device_->add_behaviour({.kind = sim::Behaviour::Kind::constant, .index = 0x6064}),
            "6064:00 is moved by the device itself");
  EXPECT_EQ(device_->add_behaviour({.kind = sim::Behaviour::Kind::constant, .index = 0x6071}), std::nullopt);
}

}  // namespace
}  // namespace canopus::sim::servo_test
