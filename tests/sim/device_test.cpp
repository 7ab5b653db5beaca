// Simulated devices: slaves made from EDS files, and values that move.

#include "canopus/sim/device/device.hpp"

#include <bit>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>

#include "paths.hpp"

namespace canopus::sim::device_test {
namespace {

using namespace canopus;
using namespace std::chrono_literals;
using can::data_frame;
using can::Frame;
using can::Time;
using sim::Behaviour;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr Time at(can::Duration since_start) { return Time{since_start}; }

std::shared_ptr<const eds::DeviceFile> example(const std::string& name) {
  std::ifstream stream(CANOPUS_SOURCE_DIR "/examples/devices/" + name, std::ios::binary);
  return eds::read_device_file(std::string(std::istreambuf_iterator<char>(stream), {})).file;
}

/// Node 5, alone on a wire that takes no time.
class DeviceTest : public testing::Test, public can::Sink {
 protected:
  void SetUp() override { make("io-block.eds"); }
  void make(const std::string& file) {
    device_ = std::make_unique<sim::Device>(example(file), std::uint8_t{5}, *this);
  }
  bool send(const Frame& frame) override {
    sent_.push_back(frame);
    times_.push_back(now_);
    return true;
  }
  void power_on() { device_->power_on(now_); }
  void start() {
    power_on();
    receive(data_frame(0x000, {0x01, 0x05}));
  }
  void receive(const Frame& frame) { device_->receive(frame, now_); }
  void run_until(Time end) {
    while (device_->deadline() <= end) {
      now_ = device_->deadline();
      device_->tick(now_);
    }
    now_ = end;
  }
  /// All frames of this identifier since the last call of forget().
  std::vector<Frame> sent(std::uint32_t identifier) const {
    std::vector<Frame> found;
    for (const Frame& frame : sent_) {
      if (frame.identifier == identifier) found.push_back(frame);
    }
    return found;
  }
  void forget() {
    sent_.clear();
    times_.clear();
  }
  void add(const Behaviour& behaviour) { ASSERT_EQ(device_->add_behaviour(behaviour), std::nullopt); }

  std::unique_ptr<sim::Device> device_;
  std::vector<Frame> sent_;
  std::vector<Time> times_;
  Time now_{};
};

TEST_F(DeviceTest, PowerOn_SendsTheBootUpMessage) {
  power_on();
  EXPECT_THAT(sent_, ElementsAre(data_frame(0x705, {0x00})));
}

TEST_F(DeviceTest, Sdo_AnswersWhatTheFileSays) {
  power_on();
  forget();
  receive(data_frame(0x605, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}));
  receive(data_frame(0x605, {0x40, 0x00, 0x18, 0x01, 0, 0, 0, 0}));
  receive(data_frame(0x605, {0x2B, 0x00, 0x10, 0x00, 0x01, 0x00, 0, 0}));
  EXPECT_THAT(sent_, ElementsAre(data_frame(0x585, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00}),
                                 data_frame(0x585, {0x43, 0x00, 0x18, 0x01, 0x85, 0x01, 0x00, 0x00}),
                                 data_frame(0x585, {0x80, 0x00, 0x10, 0x00, 0x02, 0x00, 0x01, 0x06})));
}

TEST_F(DeviceTest, WithoutBehaviours_SitsStill) {
  start();
  forget();
  run_until(at(10s));
  EXPECT_THAT(sent_, IsEmpty());
  EXPECT_EQ(device_->deadline(), can::never);
}

TEST_F(DeviceTest, OutsideOperational_NothingTicks) {
  add({.kind = Behaviour::Kind::counter, .index = 0x6000, .sub = 1, .low = 0, .high = 255, .period = 100ms});
  power_on();
  EXPECT_EQ(device_->deadline(), can::never);
}

/// An application that sets its alarm from outside of its calls.
class Waiting final : public sim::DeviceApplication {
 public:
  void start(sim::Device&, Time) override {}
  bool act(sim::Device&, Time now) override {
    if (alarm_ > now) return false;
    acted_at.push_back(now);
    alarm_.cancel();
    return false;
  }
  can::Alarm& alarm() noexcept override { return alarm_; }

  std::vector<Time> acted_at;

 private:
  can::Alarm alarm_;
};

TEST_F(DeviceTest, AlarmOfItsApplication_IsItsOwnWhileItIsOn) {
  auto made = std::make_unique<Waiting>();
  Waiting& application = *made;
  device_->set_application(std::move(made));
  application.alarm() = at(1s);
  EXPECT_EQ(device_->deadline(), can::never) << "off";
  power_on();
  EXPECT_EQ(device_->deadline(), at(1s));
  run_until(at(2s));
  EXPECT_THAT(application.acted_at, ElementsAre(at(1s)));
  application.alarm() = at(3s);
  EXPECT_EQ(device_->deadline(), at(3s)) << "set outside of a call";
  device_->power_off();
  EXPECT_EQ(device_->deadline(), can::never);
  power_on();
  run_until(at(4s));
  EXPECT_THAT(application.acted_at, ElementsAre(at(1s), at(3s)));
}

TEST_F(DeviceTest, Counter_SendsItsTpdoWithEachStep) {
  add({.kind = Behaviour::Kind::counter, .index = 0x6000, .sub = 1, .low = 0, .high = 2, .period = 100ms});
  start();
  forget();
  run_until(at(350ms));
  EXPECT_THAT(sent_,
              ElementsAre(data_frame(0x185, {1, 0}), data_frame(0x185, {2, 0}), data_frame(0x185, {0, 0})));
  EXPECT_THAT(times_, ElementsAre(at(100ms), at(200ms), at(300ms)));
}

TEST_F(DeviceTest, Echo_FollowsItsSourceAtOnce) {
  add({.kind = Behaviour::Kind::echo, .index = 0x6000, .sub = 2, .source_index = 0x6200, .source_sub = 1});
  start();
  forget();
  now_ = at(1234us);
  receive(data_frame(0x205, {0xA5, 0x00}));
  EXPECT_THAT(sent_, ElementsAre(data_frame(0x185, {0x00, 0xA5})));
}

TEST_F(DeviceTest, Sdo_SeesTheValueOfNowInPreOperational) {
  add({.kind = Behaviour::Kind::counter, .index = 0x6000, .sub = 1, .low = 10, .high = 99, .period = 1s});
  power_on();
  forget();
  now_ = at(3500ms);
  receive(data_frame(0x605, {0x40, 0x00, 0x60, 0x01, 0, 0, 0, 0}));
  EXPECT_THAT(sent_, ElementsAre(data_frame(0x585, {0x4F, 0x00, 0x60, 0x01, 13, 0, 0, 0})));
}

TEST_F(DeviceTest, Constant_SurvivesAReset) {
  add({.kind = Behaviour::Kind::constant, .index = 0x6401, .sub = 1, .low = -5});
  start();
  receive(data_frame(0x000, {0x81, 0x05}));
  forget();
  receive(data_frame(0x605, {0x40, 0x01, 0x64, 0x01, 0, 0, 0, 0}));
  EXPECT_THAT(sent_, ElementsAre(data_frame(0x585, {0x4B, 0x01, 0x64, 0x01, 0xFB, 0xFF, 0, 0})));
}

TEST_F(DeviceTest, Stop_EndsTheSampling) {
  add({.kind = Behaviour::Kind::sine, .index = 0x6401, .sub = 1, .low = -100, .high = 100});
  start();
  EXPECT_NE(device_->deadline(), can::never);
  receive(data_frame(0x000, {0x02, 0x05}));
  EXPECT_EQ(device_->deadline(), can::never);
}

TEST_F(DeviceTest, PowerOff_IsSilence) {
  add({.kind = Behaviour::Kind::sine, .index = 0x6401, .sub = 1, .low = -100, .high = 100});
  start();
  device_->power_off();
  forget();
  run_until(at(1s));
  receive(data_frame(0x605, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}));
  EXPECT_THAT(sent_, IsEmpty());
}

TEST_F(DeviceTest, Emergency_IsSentWithTheErrorRegister) {
  start();
  forget();
  EXPECT_TRUE(device_->emergency(0x3110, 0x04, {1, 2, 3, 4, 5}, now_));
  EXPECT_THAT(sent(0x085), ElementsAre(data_frame(0x085, {0x10, 0x31, 0x05, 1, 2, 3, 4, 5})));
}

TEST_F(DeviceTest, SameSeed_GivesTheSameFrames) {
  const auto record = [&] {
    make("encoder.eds");
    now_ = {};
    forget();
    add({.kind = Behaviour::Kind::noise, .index = 0x6004, .low = 0, .high = 4095, .period = 20ms, .seed = 7});
    start();
    run_until(at(2s));
    return sent_;
  };
  const auto first = record();
  EXPECT_GT(first.size(), 90U);
  EXPECT_EQ(record(), first);
}

struct BadBehaviour {
  Behaviour behaviour;
  const char* problem;
};
class RefusedBehaviour : public testing::TestWithParam<BadBehaviour>, public can::Sink {
 protected:
  bool send(const Frame&) override { return true; }
};

TEST_P(RefusedBehaviour, Behaviour_IsRefusedInWords) {
  sim::Device device(example("io-block.eds"), 5, *this);
  EXPECT_EQ(device.add_behaviour(GetParam().behaviour), GetParam().problem);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, RefusedBehaviour,
    testing::Values(BadBehaviour{{.index = 0x7000, .sub = 1}, "the device has no object 7000:01"},
                    BadBehaviour{{.index = 0x1008}, "1008:00 is of type VISIBLE_STRING, not a number"},
                    BadBehaviour{
                        {.kind = Behaviour::Kind::sine, .index = 0x6000, .sub = 1, .low = 2, .high = 1},
                        "low must not be greater than high"},
                    BadBehaviour{{.kind = Behaviour::Kind::ramp, .index = 0x6000, .sub = 1, .period = 0ms},
                                 "period must be greater than 0"},
                    BadBehaviour{{.kind = Behaviour::Kind::counter, .index = 0x6000, .sub = 1, .step = 0},
                                 "step must be greater than 0"},
                    BadBehaviour{{.kind = Behaviour::Kind::echo,
                                  .index = 0x6000,
                                  .sub = 1,
                                  .source_index = 0x6411,
                                  .source_sub = 1},
                                 "6000:01 is of type UNSIGNED8, its source 6411:01 of type INTEGER16: an "
                                 "echo needs equal types"}));

TEST(BehaviourValue, Sine_GoesFromTheMiddleUp) {
  const Behaviour sine{.kind = Behaviour::Kind::sine, .low = -10, .high = 30, .period = 4s};
  EXPECT_NEAR(value_at(sine, at(0s)), 10, 1e-9);
  EXPECT_NEAR(value_at(sine, at(1s)), 30, 1e-9);
  EXPECT_NEAR(value_at(sine, at(3s)), -10, 1e-9);
}

TEST(BehaviourValue, Ramp_StartsAnewEachPeriod) {
  const Behaviour ramp{.kind = Behaviour::Kind::ramp, .low = 0, .high = 100, .period = 10s};
  EXPECT_NEAR(value_at(ramp, at(2500ms)), 25, 1e-9);
  EXPECT_NEAR(value_at(ramp, at(10s)), 0, 1e-9);
}

TEST(BehaviourValue, Counter_EndsAtTheLastStepWithinHigh) {
  const Behaviour counter{.kind = Behaviour::Kind::counter, .low = 1, .high = 8, .period = 1s, .step = 3};
  EXPECT_EQ(value_at(counter, at(2s)), 7);
  EXPECT_EQ(value_at(counter, at(3s)), 1);
}

TEST(BehaviourValue, Noise_StaysInItsRangeAndChangesWithTheSeed) {
  Behaviour noise{.kind = Behaviour::Kind::noise, .low = 5, .high = 6, .period = 1ms, .seed = 1};
  double lowest = 6;
  double highest = 5;
  for (int i = 0; i < 1000; ++i) {
    lowest = std::min(lowest, value_at(noise, at(i * 1ms)));
    highest = std::max(highest, value_at(noise, at(i * 1ms)));
  }
  EXPECT_GE(lowest, 5);
  EXPECT_LT(lowest, 5.01);
  EXPECT_LE(highest, 6);
  EXPECT_GT(highest, 5.99);
  const double before = value_at(noise, at(1s));
  noise.seed = 2;
  EXPECT_NE(value_at(noise, at(1s)), before);
}

TEST(Fitted, Value_IsRoundedAndKeptWithinTheType) {
  using canopen::DataType;
  EXPECT_EQ(sim::fitted(2.5001, DataType::unsigned8, {}), 3U);
  EXPECT_EQ(sim::fitted(-1, DataType::unsigned8, {}), 0U);
  EXPECT_EQ(sim::fitted(300, DataType::unsigned8, {}), 255U);
  EXPECT_EQ(sim::fitted(-300, DataType::integer8, {}), 0xFFFF'FFFF'FFFF'FF80);
  EXPECT_EQ(sim::fitted(1e30, DataType::unsigned64, {}), 0xFFFF'FFFF'FFFF'FFFF);
  EXPECT_EQ(sim::fitted(1e30, DataType::integer64, {}), 0x7FFF'FFFF'FFFF'FFFF);
  EXPECT_EQ(sim::fitted(0.7, DataType::boolean, {}), 1U);
  EXPECT_EQ(sim::fitted(1.5, DataType::real32, {}), 0x3FC0'0000U);
}

TEST(Fitted, Value_IsKeptWithinTheObjectsLimits) {
  using canopen::DataType;
  EXPECT_EQ(sim::fitted(99, DataType::unsigned16, {.low = 1, .high = 50}), 50U);
  EXPECT_EQ(sim::fitted(-99, DataType::integer16, {.low = static_cast<std::uint64_t>(-10), .high = {}}),
            static_cast<std::uint64_t>(-10));
}

}  // namespace
}  // namespace canopus::sim::device_test
