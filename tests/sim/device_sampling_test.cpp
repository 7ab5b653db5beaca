// A device whose values move looks at them only when one can have changed, and nobody sees a difference to one that
// looks every 10 ms.

#include <cstdint>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include "canopus/sim/device/device.hpp"

#include "paths.hpp"

namespace canopus::sim::device_sampling_test {
namespace {

using namespace canopus;
using namespace std::chrono_literals;
using can::data_frame;
using can::Frame;
using can::Time;
using canopen::DataType;
using sim::Behaviour;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr can::Duration interval = 10ms;
constexpr Time at(can::Duration since_start) { return Time{since_start}; }

/// Node 5 of io-block.eds, alone on a wire that takes no time.
struct SampledDevice : can::Sink {
  SampledDevice() : device(io_block(), 5, *this) {}
  static std::shared_ptr<const eds::DeviceFile> io_block() {
    static const auto file = [] {
      std::ifstream stream(CANOPUS_SOURCE_DIR "/examples/devices/io-block.eds", std::ios::binary);
      std::string text(std::istreambuf_iterator<char>(stream), {});
      // Its outputs may be mapped in TPDOs, too.
      for (auto place = text.find("=rww"); place != std::string::npos; place = text.find("=rww"))
        text.erase(place + 3, 1);
      return eds::read_device_file(text).file;
    }();
    return file;
  }
  bool send(const Frame& frame) override {
    if (frame.identifier == 0x185) sent.emplace_back(now, frame.data[0]);
    if (frame.identifier == 0x285) sent_by_second.emplace_back(now, frame.data[0]);
    return true;
  }
  void start() {
    device.power_on(now);
    receive(data_frame(0x000, {0x01, 0x05}));
    sent.clear();
  }
  void receive(const Frame& frame) { device.receive(frame, now); }
  void run_until(Time end) {
    for (; device.deadline() <= end; ++ticks) {
      now = device.deadline();
      device.tick(now);
    }
    now = end;
  }
  [[nodiscard]] unsigned input() const { return device.node().dictionary().get<std::uint8_t>(0x6000, 1); }

  Time now{};
  sim::Device device;
  std::vector<std::pair<Time, unsigned>> sent;            // of 6000:01, when
  std::vector<std::pair<Time, unsigned>> sent_by_second;  // what TPDO 2 begins with
  unsigned ticks = 0;
};

TEST(DeviceSampling, ACounterIsLookedAtOncePerStep) {
  SampledDevice d;
  ASSERT_EQ(d.device.add_behaviour({.kind = Behaviour::Kind::counter, .index = 0x6000, .sub = 1, .high = 9}),
            std::nullopt);
  d.start();
  d.run_until(at(5s));
  EXPECT_EQ(d.ticks, 5U);
  EXPECT_THAT(d.sent, ElementsAre(std::pair(at(1s), 1U), std::pair(at(2s), 2U), std::pair(at(3s), 3U),
                                  std::pair(at(4s), 4U), std::pair(at(5s), 5U)));
}

TEST(DeviceSampling, AStepBetweenTwoSamplesShowsAtTheNextOfThem) {
  SampledDevice d;
  ASSERT_EQ(d.device.add_behaviour(
                {.kind = Behaviour::Kind::counter, .index = 0x6000, .sub = 1, .high = 9, .period = 250ms}),
            std::nullopt);
  d.now = at(3ms);  // samples are at 13 ms, 23 ms ...
  d.start();
  d.run_until(at(520ms));
  EXPECT_THAT(d.sent, ElementsAre(std::pair(at(253ms), 1U), std::pair(at(503ms), 2U)));
}

TEST(DeviceSampling, StepsOfEveryShortPeriodShowAtTheirSample_OrAtTheNext) {
  for (const can::Duration period : {10ms, 11ms, 15ms, 20ms, 25ms, 30ms, 39ms, 40ms, 41ms, 50ms, 55ms}) {
    SampledDevice d;
    ASSERT_EQ(
        d.device.add_behaviour(
            {.kind = Behaviour::Kind::counter, .index = 0x6000, .sub = 1, .high = 99, .period = period}),
        std::nullopt);
    d.start();
    d.run_until(at(300ms));
    std::vector<std::pair<Time, unsigned>> steps;
    for (unsigned step = 1; step * period <= 300ms; ++step) {
      const can::Duration sample = (step * period + interval - can::Duration{1}) / interval * interval;
      if (sample <= 300ms) steps.emplace_back(at(sample), step);
    }
    EXPECT_EQ(d.sent, steps) << period / 1ms << " ms";
  }
}

TEST(DeviceSampling, WhatAnSdoWritesThereLastsUntilTheNextSample) {
  SampledDevice d;
  ASSERT_EQ(
      d.device.add_behaviour(
          {.kind = Behaviour::Kind::counter, .index = 0x6200, .sub = 1, .low = 7, .high = 9, .period = 1h}),
      std::nullopt);
  d.start();
  d.run_until(at(1004ms));
  d.receive(data_frame(0x605, {0x2F, 0x00, 0x62, 0x01, 0x33, 0, 0, 0}));
  const auto output = [&] { return d.device.node().dictionary().get<std::uint8_t>(0x6200, 1); };
  d.run_until(at(1009ms));
  EXPECT_EQ(output(), 0x33);
  d.run_until(at(1010ms));
  EXPECT_EQ(output(), 7);
  EXPECT_EQ(d.ticks, 1U);
}

TEST(DeviceSampling, WhatAnRpdoWritesThereLastsUntilTheNextSample) {
  SampledDevice d;
  ASSERT_EQ(
      d.device.add_behaviour(
          {.kind = Behaviour::Kind::counter, .index = 0x6200, .sub = 1, .low = 7, .high = 9, .period = 1h}),
      std::nullopt);
  d.start();
  d.run_until(at(1004ms));
  d.receive(data_frame(0x205, {0x44, 0x55}));
  const auto output = [&] { return d.device.node().dictionary().get<std::uint8_t>(0x6200, 1); };
  EXPECT_EQ(output(), 0x44);
  d.run_until(at(1010ms));
  EXPECT_EQ(output(), 7);
}

/// A counter in TPDO 1 that steps every 50 ms, and one byte in TPDO 2.
struct TwoTpdos : SampledDevice {
  explicit TwoTpdos(std::uint16_t index, std::uint8_t sub) {
    EXPECT_EQ(device.add_behaviour(
                  {.kind = Behaviour::Kind::counter, .index = 0x6000, .sub = 1, .high = 9, .period = 50ms}),
              std::nullopt);
    start();
    const auto low = static_cast<std::uint8_t>(index);
    const auto high = static_cast<std::uint8_t>(index >> 8);
    receive(data_frame(0x605, {0x23, 0x01, 0x18, 0x01, 0x85, 0x02, 0, 0xC0}));
    receive(data_frame(0x605, {0x2F, 0x01, 0x1A, 0x00, 0, 0, 0, 0}));
    receive(data_frame(0x605, {0x23, 0x01, 0x1A, 0x01, 0x08, sub, low, high}));
    receive(data_frame(0x605, {0x2F, 0x01, 0x1A, 0x00, 1, 0, 0, 0}));
    receive(data_frame(0x605, {0x2F, 0x01, 0x18, 0x02, 0xFF, 0, 0, 0}));
    receive(data_frame(0x605, {0x23, 0x01, 0x18, 0x01, 0x85, 0x02, 0, 0x40}));
    run_until(at(105ms));
    sent_by_second.clear();
  }
};

TEST(DeviceSampling, WhatAnRpdoWritesInAnotherTpdoIsSentWithTheNextStep) {
  TwoTpdos d(0x6200, 1);
  d.receive(data_frame(0x205, {0x44, 0x55}));
  d.run_until(at(205ms));
  EXPECT_THAT(d.sent, ElementsAre(std::pair(at(50ms), 1U), std::pair(at(100ms), 2U), std::pair(at(150ms), 3U),
                                  std::pair(at(200ms), 4U)));
  EXPECT_THAT(d.sent_by_second, ElementsAre(std::pair(at(150ms), 0x44U)));
}

TEST(DeviceSampling, WhatTheNodeItselfPutsInAnotherTpdoIsSentWithTheNextStep) {
  TwoTpdos d(0x1001, 0);
  ASSERT_TRUE(d.device.emergency(0x1000, 0x01, {}, d.now));
  d.run_until(at(205ms));
  EXPECT_THAT(d.sent_by_second, ElementsAre(std::pair(at(150ms), 1U)));
}

TEST(DeviceSampling, WhatIsWrittenBeneathAForcedValueIsNotTakenForTheBehaviours) {
  SampledDevice d;
  ASSERT_EQ(
      d.device.add_behaviour(
          {.kind = Behaviour::Kind::counter, .index = 0x6200, .sub = 1, .low = 7, .high = 9, .period = 1h}),
      std::nullopt);
  d.start();
  const auto entry = *d.device.process_value(0x6200, 1);
  d.device.force(entry, 0x33, can::never, d.now);
  d.run_until(at(1004ms));
  d.receive(data_frame(0x605, {0x2F, 0x00, 0x62, 0x01, 0x33, 0, 0, 0}));
  ASSERT_TRUE(d.device.release(entry, d.now));
  EXPECT_EQ(d.device.node().dictionary().get<std::uint8_t>(0x6200, 1), 7);
}

TEST(DeviceSampling, WhatTheNodeItselfPutsThereLastsUntilTheNextSample) {
  SampledDevice d;
  ASSERT_EQ(
      d.device.add_behaviour({.kind = Behaviour::Kind::counter, .index = 0x1001, .high = 9, .period = 1h}),
      std::nullopt);
  d.start();
  d.run_until(at(1004ms));
  const auto error_register = [&] { return d.device.node().dictionary().get<std::uint8_t>(0x1001, 0); };
  ASSERT_TRUE(d.device.emergency(0x1000, 0x01, {}, d.now));
  EXPECT_EQ(error_register(), 1);
  d.run_until(at(1010ms));
  EXPECT_EQ(error_register(), 0);
}

TEST(DeviceSampling, AConstantThatSomebodyWritesIsWhatItWasWithTheNextFrame) {
  SampledDevice d;
  ASSERT_EQ(d.device.add_behaviour({.kind = Behaviour::Kind::constant, .index = 0x6200, .sub = 1, .low = 7}),
            std::nullopt);
  d.start();
  d.receive(data_frame(0x205, {0x44, 0x55}));
  d.run_until(at(10s));
  EXPECT_EQ(d.ticks, 0U);
  d.receive(data_frame(0x000, {0x01, 0x05}));
  EXPECT_EQ(d.device.node().dictionary().get<std::uint8_t>(0x6200, 1), 7);
}

TEST(DeviceSampling, StoppedAndStartedAgain_TheSamplesCountFromThere) {
  SampledDevice d;
  ASSERT_EQ(d.device.add_behaviour(
                {.kind = Behaviour::Kind::counter, .index = 0x6000, .sub = 1, .high = 99, .period = 100ms}),
            std::nullopt);
  d.start();
  d.run_until(at(50ms));
  d.receive(data_frame(0x000, {0x80, 0x05}));
  d.run_until(at(194ms));
  d.receive(data_frame(0x000, {0x01, 0x05}));
  d.sent.clear();
  d.run_until(at(210ms));
  EXPECT_THAT(d.sent, ElementsAre(std::pair(at(204ms), 2U)));
}

Behaviour any_behaviour() {
  Behaviour behaviour;
  behaviour.kind = *rc::gen::element(Behaviour::Kind::sine, Behaviour::Kind::ramp, Behaviour::Kind::counter,
                                     Behaviour::Kind::noise, Behaviour::Kind::constant);
  behaviour.index = 0x6000;
  behaviour.sub = 1;
  behaviour.low = *rc::gen::inRange(-50, 300) / 4.0;
  behaviour.high = behaviour.low + *rc::gen::inRange(0, 1200) / 4.0;
  behaviour.period = can::Duration(*rc::gen::inRange<std::int64_t>(1, 3'000'000'000));
  behaviour.step = *rc::gen::inRange(1, 40) / 4.0;
  behaviour.seed = *rc::gen::arbitrary<std::uint64_t>();
  return behaviour;
}

// The reference looks at every sample.
RC_GTEST_PROP(DeviceSampling, NobodySeesThatSamplesAreLeftOut, ()) {
  const Behaviour behaviour = any_behaviour();
  SampledDevice d;
  RC_ASSERT(d.device.add_behaviour(behaviour) == std::nullopt);
  d.now = at(can::Duration(*rc::gen::inRange<std::int64_t>(0, 2'000'000'000)));
  const auto value = [&](Time now) {
    return static_cast<unsigned>(sim::fitted(sim::value_at(behaviour, now), DataType::unsigned8, {}));
  };
  std::vector<std::pair<Time, unsigned>> expected;
  const Time from = d.now;
  unsigned last = value(from);
  for (Time now = from + interval; now <= from + 4s; now += interval) {
    if (value(now) != last) expected.emplace_back(now, last = value(now));
  }
  d.start();
  d.run_until(from + 4s);
  RC_ASSERT(d.sent == expected);
}

RC_GTEST_PROP(BehaviourValue, DoesNotChangeBeforeItsNextChange, ()) {
  const Behaviour behaviour = any_behaviour();
  const auto type = *rc::gen::element(DataType::boolean, DataType::unsigned8, DataType::integer16,
                                      DataType::integer64, DataType::real32, DataType::real64);
  const Time now = at(can::Duration(*rc::gen::inRange<std::int64_t>(0, 10'000'000'000)));
  const auto bits = [&](Time moment) { return sim::fitted(sim::value_at(behaviour, moment), type, {}); };
  const Time next = sim::next_change(behaviour, type, sim::value_at(behaviour, now), now);
  RC_ASSERT(next > now);
  const can::Duration rest = std::min<can::Duration>(next - now, 100s);
  for (const double part : {0.1, 0.5, 0.9, 0.999, 1.0}) {
    const auto after =
        can::Duration(static_cast<std::int64_t>(static_cast<double>(rest.count()) * part)) - 1ns;
    if (after > 0ns) RC_ASSERT(bits(now + after) == bits(now));
  }
}

/// Counters of whole numbers are worked out in another way than the rest, unless the object cannot hold them all.
RC_GTEST_PROP(ValueGenerator, GivesTheFittedValueAndItsNextChange, ()) {
  Behaviour behaviour = any_behaviour();
  if (*rc::gen::arbitrary<bool>()) {
    behaviour.kind = Behaviour::Kind::counter;
    behaviour.low = *rc::gen::element(-9e15, -9e16, -300.0, -128.0, -5.0, 0.0, 3.0, 100.0, 65'530.0, 0.5);
    behaviour.high = behaviour.low + *rc::gen::inRange(0, 400);
    behaviour.step = *rc::gen::element(1.0, 2.0, 7.0, 0.5, 1e17);
  }
  const auto type = *rc::gen::element(DataType::boolean, DataType::unsigned8, DataType::integer8,
                                      DataType::integer16, DataType::unsigned16, DataType::integer64,
                                      DataType::unsigned64, DataType::real32, DataType::real64);
  canopen::Limits limits;
  if (type == DataType::unsigned8 && *rc::gen::arbitrary<bool>()) limits = {.low = 4, .high = 90};
  const sim::Bounds bounds = sim::bounds(type, limits);
  sim::ValueGenerator generator(behaviour, bounds);
  Time now = at(can::Duration(*rc::gen::inRange<std::int64_t>(0, 10'000'000'000)));
  for (const int tenths : *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 40))) {
    const sim::Sample sample = generator.at(now);
    const double value = sim::value_at(behaviour, now);
    RC_ASSERT(sample.value == sim::fitted(value, bounds));
    RC_ASSERT(sample.next_change == sim::next_change(behaviour, type, value, now));
    now += behaviour.period / 10 * tenths + 1ns;
  }
}

TEST(BehaviourValue, ThatCannotChangeHasNoNextChange) {
  const auto next = [](Behaviour::Kind kind, double low, double high) {
    const Behaviour behaviour{.kind = kind, .low = low, .high = high, .period = 1s};
    return sim::next_change(behaviour, DataType::unsigned8, sim::value_at(behaviour, at(2500ms)), at(2500ms));
  };
  EXPECT_EQ(next(Behaviour::Kind::constant, 1, 9), can::never);
  EXPECT_EQ(next(Behaviour::Kind::echo, 0, 0), can::never);
  EXPECT_EQ(next(Behaviour::Kind::sine, 5, 5), can::never);
  EXPECT_EQ(next(Behaviour::Kind::counter, 0, 9), at(3s));
  EXPECT_EQ(next(Behaviour::Kind::noise, 0, 9), at(3s));
  EXPECT_GT(next(Behaviour::Kind::ramp, 0, 9.9), at(2501ms));  // 4.95: 0.45 of a step away from 4.5
  EXPECT_LT(next(Behaviour::Kind::ramp, 0, 9.9), at(2600ms));
}

}  // namespace
}  // namespace canopus::sim::device_sampling_test
