// Values of a device that are forced: by hand, by a script, and values that are played back.

#include <fstream>
#include <iomanip>
#include <iterator>
#include <sstream>

#include <gmock/gmock.h>

#include "canopus/sim/device/device.hpp"

#include "paths.hpp"

namespace canopus::sim::device_force_test {
namespace {

using namespace canopus;
using namespace std::chrono_literals;
using can::data_frame;
using can::Frame;
using can::Time;
using canopen::Entry;
using sim::Behaviour;
using sim::Comparison;
using sim::Condition;
using sim::Playback;
using sim::ScriptStep;
using testing::ElementsAre;
using testing::IsEmpty;

std::shared_ptr<const eds::DeviceFile> io_block() {
  std::ifstream stream(CANOPUS_SOURCE_DIR "/examples/devices/io-block.eds", std::ios::binary);
  return eds::read_device_file(std::string(std::istreambuf_iterator<char>(stream), {})).file;
}

/// An I/O block, node 5, on a wire that takes no time: inputs 6000:01 and :02 in its TPDO1 (event-driven),
/// outputs 6200:01 and :02 in its RPDO1.
class DeviceForce : public testing::Test, public can::Sink, public sim::ForceListener {
 protected:
  bool send(const Frame& frame) override {
    if (frame.identifier == 0x185)
      tpdos_.push_back(us() + hexadecimal(frame.data[0]) + hexadecimal(frame.data[1]));
    if (frame.identifier == 0x585) answer_ = frame;
    return true;
  }
  void value_forced(const sim::Forcing::Force& force, Time) override {
    events_.push_back(us() + name(force.entry) + " = " + std::to_string(force.value));
  }
  void value_released(const Entry& entry, Time) override {
    events_.push_back(us() + name(entry) + " released");
  }
  static std::string hexadecimal(unsigned number) {
    std::ostringstream text;
    text << ' ' << std::hex << std::uppercase << std::setw(2) << std::setfill('0') << number;
    return text.str();
  }
  static std::string name(const Entry& entry) {
    return hexadecimal(entry.index) + ":" + std::to_string(entry.sub);
  }
  /// The moment, in microseconds.
  std::string us() const { return std::to_string(now_.time_since_epoch() / 1us); }

  void power_on() {
    device_.set_force_listener(this);
    device_.power_on(now_);
  }
  void start() {
    power_on();
    receive(data_frame(0x000, {0x01, 0x05}));
    tpdos_.clear();
  }
  void receive(const Frame& frame) { device_.receive(frame, now_); }
  void run_until(can::Duration end) {
    while (device_.deadline() <= Time{end}) {
      now_ = device_.deadline();
      device_.tick(now_);
    }
    now_ = Time{end};
  }
  Entry entry(std::uint16_t index, std::uint8_t sub) const {
    return device_.process_value(index, sub).value();
  }
  void force(std::uint16_t index, std::uint8_t sub, std::uint64_t value, Time until = can::never) {
    device_.force(entry(index, sub), value, until, now_);
  }
  std::uint64_t value(std::uint16_t index, std::uint8_t sub) const {
    return device_.node().dictionary().get<std::uint64_t>(index, sub);
  }
  /// What an SDO reads.
  unsigned sdo_read(std::uint16_t index, std::uint8_t sub) {
    receive(data_frame(0x605, {0x40, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8),
                               sub, 0, 0, 0, 0}));
    return answer_.data[4];
  }
  void sdo_write(std::uint16_t index, std::uint8_t sub, std::uint8_t byte) {
    receive(data_frame(0x605, {0x2F, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8),
                               sub, byte, 0, 0, 0}));
    EXPECT_EQ(answer_.data[0], 0x60) << "a write is taken, forced or not";
  }
  /// Counts 1, 2, 3 ... one a second.
  void count(std::uint16_t index, std::uint8_t sub) {
    const auto problem = device_.add_behaviour(
        {.kind = Behaviour::Kind::counter, .index = index, .sub = sub, .low = 1, .high = 200});
    EXPECT_EQ(problem, std::nullopt);
  }
  ScriptStep set_at(can::Duration at, std::uint64_t value,
                    std::optional<can::Duration> hold = std::nullopt) const {
    return {.at = Time{at}, .entry = entry(0x6000, 1), .value = value, .hold = hold};
  }
  ScriptStep set_when(Condition when, std::uint64_t value,
                      std::optional<can::Duration> hold = std::nullopt) const {
    return {.when = when, .entry = entry(0x6000, 1), .value = value, .hold = hold};
  }

  sim::Device device_{io_block(), 5, *this};
  std::vector<std::string> tpdos_;
  std::vector<std::string> events_;
  Frame answer_;
  Time now_{};
};

TEST_F(DeviceForce, AForcedValueIsSentAtOnceAsAChange) {
  start();
  run_until(5ms);
  force(0x6000, 1, 0x3C);
  EXPECT_THAT(tpdos_, ElementsAre("5000 3C 00"));
  EXPECT_EQ(sdo_read(0x6000, 1), 0x3CU);
  force(0x6000, 1, 0x3C);
  EXPECT_EQ(tpdos_.size(), 1U) << "the same value is no change";
  force(0x6000, 1, 0x3D);
  EXPECT_THAT(tpdos_, ElementsAre("5000 3C 00", "5000 3D 00"));
}

TEST_F(DeviceForce, TheBehaviourGoesOnBeneath_AndComesBack) {
  count(0x6000, 1);
  start();
  run_until(1500ms);
  ASSERT_EQ(value(0x6000, 1), 2U);
  force(0x6000, 1, 99);
  tpdos_.clear();
  run_until(4500ms);
  EXPECT_EQ(value(0x6000, 1), 99U);
  EXPECT_THAT(tpdos_, IsEmpty());
  EXPECT_TRUE(device_.release(entry(0x6000, 1), now_));
  EXPECT_EQ(value(0x6000, 1), 5U) << "the count of now";
  EXPECT_THAT(tpdos_, ElementsAre("4500000 05 00"));
  EXPECT_FALSE(device_.release(entry(0x6000, 1), now_)) << "it is not forced any more";
  EXPECT_THAT(events_, ElementsAre("1500000 6000:1 = 99", "4500000 6000:1 released"));
}

TEST_F(DeviceForce, ReleasedOutsideOfOperational_TheBehavioursValueIsThatOfNow) {
  count(0x6000, 1);
  power_on();
  force(0x6000, 1, 99);
  run_until(3500ms);
  device_.release(entry(0x6000, 1), now_);
  EXPECT_EQ(value(0x6000, 1), 4U);
}

TEST_F(DeviceForce, AnRpdoChangesWhatIsBeneath_NotWhatIsSeen) {
  ASSERT_EQ(device_.add_behaviour({.kind = Behaviour::Kind::echo,
                                   .index = 0x6000,
                                   .sub = 2,
                                   .source_index = 0x6200,
                                   .source_sub = 1}),
            std::nullopt);
  start();
  force(0x6200, 1, 7);
  EXPECT_THAT(tpdos_, ElementsAre("0 00 07")) << "the echo follows what is seen";
  receive(data_frame(0x205, {0x55, 0x66}));
  EXPECT_EQ(value(0x6200, 1), 7U);
  EXPECT_EQ(value(0x6200, 2), 0x66U) << "its neighbour in the PDO";
  EXPECT_EQ(tpdos_.size(), 1U);
  receive(data_frame(0x205, {0x07, 0x66}));  // by chance the forced value
  device_.release(entry(0x6200, 1), now_);
  EXPECT_EQ(value(0x6200, 1), 7U) << "what was received last";
  force(0x6200, 1, 9);
  receive(data_frame(0x205, {0x55, 0x66}));
  device_.release(entry(0x6200, 1), now_);
  EXPECT_EQ(value(0x6200, 1), 0x55U);
}

TEST_F(DeviceForce, AnSdoWriteIsTaken_AndSeenWhenReleased) {
  start();
  force(0x6200, 1, 7);
  sdo_write(0x6200, 1, 0x42);
  EXPECT_EQ(sdo_read(0x6200, 1), 7U);
  device_.release(entry(0x6200, 1), now_);
  EXPECT_EQ(sdo_read(0x6200, 1), 0x42U);
}

TEST_F(DeviceForce, ItEndsByItselfToTheNanosecond) {
  count(0x6000, 1);
  start();
  run_until(100ms);
  force(0x6000, 1, 99, now_ + 200ms + 1ns);
  run_until(300ms);
  EXPECT_EQ(value(0x6000, 1), 99U);
  run_until(300ms + 1ns);
  EXPECT_EQ(value(0x6000, 1), 1U);
  EXPECT_THAT(events_, ElementsAre("100000 6000:1 = 99", "300000 6000:1 released"));
  EXPECT_THAT(device_.forced(), IsEmpty());
}

TEST_F(DeviceForce, SeveralThatEndAtOnceAreReportedEach) {
  start();
  force(0x6000, 1, 1, now_ + 100ms);
  force(0x6000, 2, 2, now_ + 100ms);
  run_until(1s);
  EXPECT_THAT(events_, ElementsAre("0 6000:1 = 1", "0 6000:2 = 2", "100000 6000:1 released",
                                   "100000 6000:2 released"));
}

TEST_F(DeviceForce, AgainForcedItHasItsNewEnd) {
  start();
  force(0x6000, 1, 1, now_ + 100ms);
  force(0x6000, 1, 2);
  run_until(1s);
  EXPECT_EQ(value(0x6000, 1), 2U);
}

TEST_F(DeviceForce, ItOutlivesResetsAndTheSupply) {
  start();
  receive(data_frame(0x205, {0x55, 0x00}));
  force(0x6200, 1, 7);
  receive(data_frame(0x000, {0x81, 0x05}));
  EXPECT_EQ(value(0x6200, 1), 7U);
  receive(data_frame(0x000, {0x82, 0x05}));
  EXPECT_EQ(value(0x6200, 1), 7U);
  device_.power_off();
  device_.power_on(now_);
  EXPECT_EQ(value(0x6200, 1), 7U);
  device_.release(entry(0x6200, 1), now_);
  EXPECT_EQ(value(0x6200, 1), 0U) << "the default of the reset lay beneath";
}

TEST_F(DeviceForce, AResetOfTheCommunicationLeavesWhatIsBeneath) {
  start();
  receive(data_frame(0x205, {0x55, 0x00}));
  force(0x6200, 1, 7);
  receive(data_frame(0x000, {0x82, 0x05}));
  device_.release(entry(0x6200, 1), now_);
  EXPECT_EQ(value(0x6200, 1), 0x55U);
}

TEST_F(DeviceForce, OnlyNumbersOfTheProcessAreForced) {
  const auto why = [&](std::uint16_t index, std::uint8_t sub) {
    const auto found = device_.process_value(index, sub);
    return found ? std::string("taken") : found.error();
  };
  EXPECT_EQ(why(0x6000, 1), "taken");
  EXPECT_EQ(why(0x6000, 9), "the device has no object 6000:09");
  EXPECT_EQ(why(0x1017, 0), "1017:00 configures the node; expected a process value, 2000H to FFFFH");
}

TEST_F(DeviceForce, AStepAtAMomentComesToTheNanosecond_AndIsHeldAsLong) {
  device_.add_script_step(set_at(5s + 1us, 3, 200ms));
  device_.add_script_step(set_at(2s, 1));
  device_.add_script_step({.at = Time{3s}, .action = ScriptStep::Action::release, .entry = entry(0x6000, 1)});
  start();
  run_until(10s);
  EXPECT_THAT(tpdos_, ElementsAre("2000000 01 00", "3000000 00 00", "5000001 03 00", "5200001 00 00"));
}

TEST_F(DeviceForce, AStepComesWhileTheDeviceIsOff) {
  device_.add_script_step(set_at(1s, 3));
  device_.set_force_listener(this);
  run_until(2s);
  EXPECT_THAT(events_, ElementsAre("1000000 6000:1 = 3"));
  power_on();
  EXPECT_EQ(value(0x6000, 1), 3U);
}

TEST_F(DeviceForce, AConditionActsWheneverItBecomesTrue) {
  device_.add_script_step(set_when({entry(0x6200, 1), Comparison::greater_or_equal, 3}, 0x80, 200ms));
  start();
  const auto output = [&](std::uint8_t value_now) { receive(data_frame(0x205, {value_now, 0})); };
  output(2);
  EXPECT_THAT(tpdos_, IsEmpty());
  run_until(1s);
  output(3);
  run_until(1100ms);
  output(4);  // true already
  run_until(2s);
  output(1);
  output(5);
  run_until(3s);
  EXPECT_THAT(tpdos_, ElementsAre("1000000 80 00", "1200000 00 00", "2000000 80 00", "2200000 00 00"));
}

TEST_F(DeviceForce, AConditionThatHoldsAtPowerOnActs) {
  device_.add_script_step(set_when({entry(0x6200, 1), Comparison::equal, 0}, 4));
  power_on();
  EXPECT_EQ(value(0x6000, 1), 4U);
}

TEST_F(DeviceForce, StepsThatSwitchEachOtherComeToAnEnd) {
  device_.add_script_step(set_when({entry(0x6000, 1), Comparison::equal, 0}, 1));
  device_.add_script_step(set_when({entry(0x6000, 1), Comparison::equal, 1}, 0));
  start();
  run_until(1s);
  EXPECT_LE(events_.size(), 6U);
}

TEST_F(DeviceForce, ReleaseAllReleasesAll) {
  device_.add_script_step({.at = Time{1s}, .action = ScriptStep::Action::release_all});
  start();
  force(0x6000, 1, 1);
  force(0x6000, 2, 2);
  run_until(1s);
  EXPECT_THAT(device_.forced(), IsEmpty());
  EXPECT_EQ(value(0x6000, 1) + value(0x6000, 2), 0U);
}

TEST_F(DeviceForce, ConditionsCompareSignedAsSigned) {
  canopen::DictionaryBuilder builder;
  builder.variable(0x2000, {.name = "x", .type = canopen::DataType::integer16});
  builder.variable(0x2001, {.name = "r", .type = canopen::DataType::real32});
  canopen::ObjectDictionary dictionary(builder.build(), 1);
  dictionary.set<std::int16_t>(0x2000, 0, -5);
  dictionary.set<float>(0x2001, 0, -0.5F);
  const auto holds = [&](std::uint16_t index, Comparison comparison, std::uint64_t bits) {
    return Condition{dictionary.description().find(index, 0), comparison, bits}.holds(dictionary);
  };
  EXPECT_TRUE(holds(0x2000, Comparison::less, 3));
  EXPECT_TRUE(holds(0x2000, Comparison::equal, 0xFFFB));
  EXPECT_TRUE(holds(0x2000, Comparison::not_equal, 5));
  EXPECT_FALSE(holds(0x2000, Comparison::greater_or_equal, 0xFFFC));
  EXPECT_TRUE(holds(0x2000, Comparison::less_or_equal, 0xFFFB));
  EXPECT_TRUE(holds(0x2001, Comparison::greater, std::bit_cast<std::uint32_t>(-0.75F)));
}

Playback rows(std::vector<Entry> entries,
              const std::vector<std::pair<can::Duration, std::vector<Playback::Value>>>& list) {
  Playback playback(std::move(entries));
  for (const auto& [time, values] : list) playback.add(time, values);
  return playback;
}

TEST_F(DeviceForce, APlaybackPlaysItsRowsAtTheirMoments) {
  ASSERT_EQ(device_.add_playback(rows({entry(0x6000, 1), entry(0x6000, 2)},
                                      {{500ms, {1, 10}}, {1s, {2, {}}}, {1250ms, {2, 11}}})),
            std::nullopt);
  start();
  run_until(1100ms);
  force(0x6000, 2, 0xEE);
  run_until(3s);
  device_.release(entry(0x6000, 2), now_);
  EXPECT_THAT(tpdos_, ElementsAre("500000 01 0A", "1000000 02 0A", "1100000 02 EE", "3000000 02 0B"))
      << "an empty field keeps the value; beneath the forced one the file went on";
}

TEST_F(DeviceForce, ARepeatedPlaybackGivesItsLastRowTheTimeOfTheOneBefore) {
  Playback playback = rows({entry(0x6000, 1)}, {{0s, {1}}, {10ms, {2}}, {30ms, {3}}});
  playback.repeat();
  ASSERT_EQ(device_.add_playback(playback), std::nullopt);
  start();
  run_until(65ms);
  EXPECT_THAT(tpdos_, ElementsAre("10000 02 00", "30000 03 00", "50000 01 00", "60000 02 00"));
}

TEST_F(DeviceForce, APlaybackThatRepeatsHoldsItsLastRowUntilTheFirst) {
  Playback playback = rows({entry(0x6000, 1)}, {{10ms, {1}}, {20ms, {2}}});
  playback.repeat();
  EXPECT_THAT(playback.at(Time{5ms}), IsEmpty());
  EXPECT_EQ(playback.at(Time{35ms})[0], 2U) << "5 ms into the second cycle of 30 ms";
  EXPECT_EQ(playback.next_after(Time{35ms}), Time{40ms});
  EXPECT_EQ(playback.next_after(Time{20ms}), Time{40ms});
  EXPECT_EQ(playback.at(Time{40ms})[0], 1U);
}

TEST_F(DeviceForce, APlaybackComesBackAfterAReset) {
  ASSERT_EQ(device_.add_playback(rows({entry(0x6000, 1)}, {{0s, {9}}})), std::nullopt);
  start();
  receive(data_frame(0x000, {0x81, 0x05}));
  EXPECT_EQ(value(0x6000, 1), 9U);
}

TEST_F(DeviceForce, OneObjectHasOneMover) {
  count(0x6000, 1);
  EXPECT_EQ(device_.add_playback(rows({entry(0x6000, 1)}, {{0s, {9}}})),
            "6000:01 moves already, by a behaviour or another file");
}

}  // namespace
}  // namespace canopus::sim::device_force_test
