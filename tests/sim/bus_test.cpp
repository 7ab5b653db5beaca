#include "canopus/sim/bus/bus.hpp"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/can/frame_bits.hpp"

#include "sim/bus_station.hpp"

namespace canopus::sim::bus_test {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::Duration;
using can::Frame;
using can::Time;

struct Recorder : BusObserver {
  void frame_completed(const Frame& frame, Time start, Time end) override {
    frames.push_back({frame, start, end});
  }
  struct Completed {
    Frame frame;
    Time start;
    Time end;
  };
  std::vector<Completed> frames;
};

struct BusTest : ::testing::Test {
  can::Timeline timeline;
  Bus bus{"main", 1'000'000, timeline};
  Station a{bus, timeline, "a"};
  Station b{bus, timeline, "b"};
  Station c{bus, timeline, "c"};
};

// 53 bits: see tests/can/frame_bits_test.cpp.
const Frame frame_of_53_bits = data_frame(0x123, {0x55});

TEST_F(BusTest, Frame_ArrivesAtTheEndOfItsLastBit) {
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(52'999ns));
  EXPECT_TRUE(b.heard.empty());
  timeline.run_until(Time(53us));
  EXPECT_EQ(b.heard, (std::vector<Heard>{{frame_of_53_bits, Time(53us)}}));
  EXPECT_EQ(c.heard, (std::vector<Heard>{{frame_of_53_bits, Time(53us)}}));
}

/// One frame sets its alarm, no other does.
struct Woken final : can::Participant {
  void receive(const Frame& frame, Time now) override {
    if (frame == frame_of_53_bits) alarm() = now + 10us;
  }
  void tick(Time now) override {
    ticks.push_back(now);
    alarm().cancel();
  }
  std::vector<Time> ticks;
};

TEST_F(BusTest, AReceiverThatSetsItsAlarm_GetsItsTickThen) {
  Woken woken;
  timeline.add(woken, "woken");
  bus.add_port("woken").connect(woken);
  for (unsigned i = 0; i < 10; ++i) a.port.send(data_frame(0x181, {static_cast<std::uint8_t>(i)}));
  timeline.run_until(Time(2ms));
  EXPECT_TRUE(woken.ticks.empty());
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(3ms));
  EXPECT_EQ(woken.ticks, std::vector{Time(2ms) + 53us + 10us});
}

TEST_F(BusTest, Transmitter_HearsItsFrameAsSentOnly) {
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1ms));
  EXPECT_TRUE(a.heard.empty());
  EXPECT_EQ(a.sent, (std::vector<Heard>{{frame_of_53_bits, Time(53us)}}));
}

TEST_F(BusTest, BitRate_SetsHowLongAFrameTakes) {
  can::Timeline slow_timeline;
  Bus slow("slow", 10'000, slow_timeline);
  Station from(slow, slow_timeline, "from");
  Station to(slow, slow_timeline, "to");
  from.port.send(frame_of_53_bits);
  slow_timeline.run_until(Time(1s));
  ASSERT_EQ(to.heard.size(), 1U);
  EXPECT_EQ(to.heard[0].at, Time(5'300us));
}

TEST_F(BusTest, NextFrame_StartsThreeBitsAfterTheLast) {
  Recorder recorder;
  bus.set_observer(&recorder);
  a.port.send(frame_of_53_bits);
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1ms));
  ASSERT_EQ(recorder.frames.size(), 2U);
  EXPECT_EQ(recorder.frames[0].end, Time(53us));
  EXPECT_EQ(recorder.frames[1].start, Time(56us));
}

TEST_F(BusTest, FrameQueuedInTheIntermission_StartsAtItsEnd) {
  Recorder recorder;
  bus.set_observer(&recorder);
  b.on_receive = [&](const Frame&, Time) { b.port.send(data_frame(0x001)); };
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1ms));
  ASSERT_EQ(recorder.frames.size(), 2U);
  EXPECT_EQ(recorder.frames[1].frame, data_frame(0x001));
  EXPECT_EQ(recorder.frames[1].start, Time(56us));
}

TEST_F(BusTest, FrameSentFromOutside_WakesAnIdleBus) {
  timeline.run_until(Time(1s));
  a.port.send(frame_of_53_bits);
  EXPECT_EQ(timeline.next(), Time(1s));
  timeline.run_until(Time(2s));
  ASSERT_EQ(b.heard.size(), 1U);
  EXPECT_EQ(b.heard[0].at, Time(1s) + 53us);
}

TEST_F(BusTest, FramesOfOneMoment_GoInTheOrderOfArbitration) {
  const Frame base_data = data_frame(0x100, {1});
  const Frame base_remote = can::remote_frame(0x100, 1);
  const Frame extended_data{.identifier = 0x100 << 18, .extended = true, .dlc = 0};
  const Frame extended_remote{.identifier = 0x100 << 18, .extended = true, .remote = true, .dlc = 0};
  const Frame lower = data_frame(0x0FF);
  const Frame higher = data_frame(0x101);
  Station d(bus, timeline, "d");
  Station e(bus, timeline, "e");
  Station f(bus, timeline, "f");
  Station listener(bus, timeline, "listener");
  a.send_at(Time(1ms), higher);
  b.send_at(Time(1ms), extended_remote);
  c.send_at(Time(1ms), base_remote);
  d.send_at(Time(1ms), extended_data);
  e.send_at(Time(1ms), base_data);
  f.send_at(Time(1ms), lower);
  timeline.run_until(Time(10ms));
  EXPECT_EQ(listener.frames(),
            (std::vector<Frame>{lower, base_data, base_remote, extended_data, extended_remote, higher}));
}

TEST_F(BusTest, LowerIdentifierQueuedLater_DoesNotInterruptTheFrameOnTheWire) {
  a.port.send(data_frame(0x700));
  timeline.run_until(Time(10us));
  b.port.send(data_frame(0x001));
  timeline.run_until(Time(1ms));
  EXPECT_EQ(c.frames(), (std::vector<Frame>{data_frame(0x700), data_frame(0x001)}));
}

TEST_F(BusTest, Queue_SortedByIdentifier_KeepsTheOrderOfEqualOnes) {
  a.port.send(data_frame(0x300));  // on the wire at once
  timeline.run_until(Time(1us));
  a.port.send(data_frame(0x200, {1}));
  a.port.send(data_frame(0x200, {2}));
  a.port.send(data_frame(0x100));
  timeline.run_until(Time(1ms));
  EXPECT_EQ(b.frames(), (std::vector<Frame>{data_frame(0x300), data_frame(0x100), data_frame(0x200, {1}),
                                            data_frame(0x200, {2})}));
}

TEST_F(BusTest, Queue_Fifo_KeepsTheOrderOfSending) {
  a.port.set_transmit_queue(TransmitOrder::fifo, 8);
  a.port.send(data_frame(0x300));
  a.port.send(data_frame(0x200));
  a.port.send(data_frame(0x100));
  timeline.run_until(Time(1ms));
  EXPECT_EQ(b.frames(), (std::vector<Frame>{data_frame(0x300), data_frame(0x200), data_frame(0x100)}));
}

TEST_F(BusTest, FullQueue_RefusesAndCounts) {
  a.port.set_transmit_queue(TransmitOrder::identifier, 2);
  EXPECT_TRUE(a.port.send(data_frame(1)));
  timeline.run_until(Time(1us));  // now on the wire: it keeps its place
  EXPECT_TRUE(a.port.send(data_frame(2)));
  EXPECT_FALSE(a.port.send(data_frame(3)));
  EXPECT_FALSE(a.port.send(data_frame(4)));
  EXPECT_EQ(a.port.transmit_overflows(), 2U);
  timeline.run_until(Time(1ms));
  EXPECT_EQ(b.frames(), (std::vector<Frame>{data_frame(1), data_frame(2)}));
  EXPECT_TRUE(a.port.send(data_frame(5)));
}

TEST_F(BusTest, Acceptance_KeepsOtherIdentifiersFromTheParticipant) {
  Acceptance only;
  only.base.reset();
  only.base.set(0x181);
  only.extended = false;
  b.port.accept(only);
  a.port.send(data_frame(0x180));
  a.port.send(data_frame(0x181));
  a.port.send({.identifier = 0x181, .extended = true});
  timeline.run_until(Time(1ms));
  EXPECT_EQ(b.frames(), (std::vector<Frame>{data_frame(0x181)}));
  EXPECT_EQ(c.frames().size(), 3U);
  EXPECT_EQ(b.port.counters().received, 1U);
}

TEST_F(BusTest, AnotherAcceptance_TakesThePlaceOfTheOneBefore) {
  const auto heard_with = [&](const std::vector<std::uint32_t>& identifiers, bool extended) {
    Acceptance acceptance;
    if (!identifiers.empty()) acceptance.base.reset();
    for (const std::uint32_t identifier : identifiers) acceptance.base.set(identifier);
    acceptance.extended = extended;
    b.port.accept(acceptance);
    b.heard.clear();
    for (const std::uint32_t identifier : {0x000U, 0x180U, 0x181U, 0x7FFU})
      a.port.send(data_frame(identifier));
    a.port.send({.identifier = 0x181, .extended = true});
    timeline.run_until(timeline.now() + 1ms);
    std::string all;
    for (const Frame& frame : b.frames())
      all += std::to_string(frame.identifier) + (frame.extended ? "x " : " ");
    return all;
  };
  EXPECT_EQ(heard_with({0x181, 0x7FF}, false), "385 2047 ");
  EXPECT_EQ(heard_with({0x000, 0x181}, true), "0 385x 385 ");
  EXPECT_EQ(heard_with({}, false), "0 384 385 2047 ");
  EXPECT_EQ(heard_with({0x180}, false), "384 ");
}

TEST_F(BusTest, AcceptancesOfMoreThan64Ports_AreApart) {
  std::vector<std::unique_ptr<Station>> stations;
  for (int number = 0; number < 130; ++number) {
    stations.push_back(std::make_unique<Station>(bus, timeline, "s"));
    Acceptance only;
    only.base.reset();
    only.base.set(static_cast<std::size_t>(number));
    stations.back()->port.accept(only);
  }
  for (std::uint32_t number = 0; number < 130; ++number) a.port.send(data_frame(number));
  timeline.run_until(Time(1s));
  for (std::uint32_t number = 0; number < 127; ++number) {
    EXPECT_EQ(stations[number]->frames(), (std::vector<Frame>{data_frame(number)}));
  }
  EXPECT_EQ(b.heard.size(), 128U);  // the other two did not fit into a's queue
}

TEST_F(BusTest, ParticipantsDeadline_IsReadAgainAfterReceiveAndTransmitted) {
  b.on_receive = [&](const Frame&, Time now) { b.alarm = now + 10us; };
  a.on_transmitted = [&](const Frame&, Time now) { a.alarm = now + 20us; };
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1ms));
  EXPECT_EQ(b.ticks, (std::vector<Time>{Time(63us)}));
  EXPECT_EQ(a.ticks, (std::vector<Time>{Time(73us)}));
}

TEST_F(BusTest, AllObservers_HearEveryFrame) {
  Recorder first;
  Recorder second;
  bus.add_observer(first);
  bus.add_observer(second);
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1ms));
  bus.remove_observer(first);
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(2ms));
  EXPECT_EQ(first.frames.size(), 1U);
  EXPECT_EQ(second.frames.size(), 2U);
  EXPECT_EQ(second.frames[0].start, Time{});
  EXPECT_EQ(second.frames[0].end, Time(53us));
}

TEST_F(BusTest, UnpluggedStation_HearsNothingAndItsFramesWait) {
  b.port.plug(false);
  EXPECT_TRUE(b.port.send(data_frame(0x222)));
  a.port.send(data_frame(0x111));
  timeline.run_until(Time(1ms));
  EXPECT_TRUE(b.heard.empty());
  EXPECT_EQ(c.frames(), (std::vector<Frame>{data_frame(0x111)}));
  b.port.plug(true);
  timeline.run_until(Time(2ms));
  EXPECT_EQ(c.frames(), (std::vector<Frame>{data_frame(0x111), data_frame(0x222)}));
}

TEST_F(BusTest, Load_IsTheShareOfTheLastFullSecond) {
  // 1000 frames of 56 bits, interframe space included, in the second second.
  for (int number = 0; number < 1000; ++number) {
    a.send_at(Time(1s) + number * 1ms, frame_of_53_bits);
  }
  timeline.run_until(Time(1'500ms));
  EXPECT_DOUBLE_EQ(bus.load(timeline.now()).now, 0.0);
  timeline.run_until(Time(2s));
  EXPECT_DOUBLE_EQ(bus.load(timeline.now()).now, 0.056);
  timeline.run_until(Time(5s));
  const BusLoad load = bus.load(timeline.now());
  EXPECT_DOUBLE_EQ(load.now, 0.0);
  EXPECT_DOUBLE_EQ(load.peak, 0.056);
  EXPECT_EQ(load.frames, 1000U);
  EXPECT_EQ(load.bits, 56'000U);
}

TEST_F(BusTest, Load_OfABusNeverIdle_IsOne) {
  a.on_transmitted = [&](const Frame& frame, Time) { a.port.send(frame); };
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(3s));
  EXPECT_NEAR(bus.load(timeline.now()).now, 1.0, 0.0001);  // a frame counts when it is complete
}

TEST_F(BusTest, FramesAreCountedPerIdentifier) {
  a.port.send(data_frame(0x181));
  a.port.send(data_frame(0x181));
  a.port.send({.identifier = 0x181, .extended = true});
  timeline.run_until(Time(1ms));
  EXPECT_EQ(bus.frames_of(0x181), 2U);
  EXPECT_EQ(bus.frames_of(0x181, true), 1U);
  EXPECT_EQ(bus.frames_of(0x182), 0U);
  EXPECT_EQ(a.port.counters().transmitted, 3U);
  EXPECT_EQ(b.port.counters().received, 3U);
}

struct LoneTransmitter : ::testing::Test {
  can::Timeline timeline;
  Bus bus{"main", 1'000'000, timeline};
  Station a{bus, timeline, "a"};
};

TEST_F(LoneTransmitter, WithoutAcknowledgement_IsPassiveAfter16AttemptsAndNeverBusOff) {
  a.port.send(frame_of_53_bits);
  // Each attempt: 45 bits to the end of the ACK slot, error flag 6, delimiter 8, intermission 3.
  timeline.run_until(Time(45us) + 14 * 62us);
  EXPECT_EQ(a.port.transmit_error_counter(), 120);
  EXPECT_EQ(a.port.error_state(), can::ErrorState::error_active);
  timeline.run_until(Time(45us) + 15 * 62us);
  EXPECT_EQ(a.port.transmit_error_counter(), 128);
  EXPECT_EQ(a.port.error_state(), can::ErrorState::error_passive);
  timeline.run_until(Time(10s));
  EXPECT_EQ(a.port.transmit_error_counter(), 128);
  EXPECT_EQ(a.changes, 2);  // warning, passive
  EXPECT_TRUE(a.sent.empty());
}

TEST_F(LoneTransmitter, WhenSomebodyComes_GetsItsFrameOut) {
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1s));
  Station b(bus, timeline, "b");
  timeline.run_until(Time(2s));
  EXPECT_EQ(b.frames(), (std::vector<Frame>{frame_of_53_bits}));
  EXPECT_EQ(a.sent.size(), 1U);
  EXPECT_EQ(a.port.transmit_error_counter(), 127);
}

TEST_F(LoneTransmitter, Abort_EndsItsAttempts) {
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1s));
  a.port.abort_transmissions();
  timeline.run_until(Time(1s) + 200us);
  const std::uint64_t errors = bus.load(timeline.now()).error_frames;
  timeline.run_until(Time(2s));
  EXPECT_EQ(bus.load(timeline.now()).error_frames, errors);
  Station b(bus, timeline, "b");
  timeline.run_until(Time(3s));
  EXPECT_TRUE(b.heard.empty());
  EXPECT_TRUE(a.sent.empty());
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(4s));
  EXPECT_EQ(b.heard.size(), 1U);
}

TEST_F(BusTest, Abort_TakesWaitingFramesBack_TheOneOnTheWireIsCompleted) {
  a.port.send(data_frame(0x100));
  a.port.send(data_frame(0x101));
  a.port.send(data_frame(0x102));
  timeline.run_until(Time(20us));
  a.port.abort_transmissions();
  a.port.send(data_frame(0x103));
  timeline.run_until(Time(1ms));
  EXPECT_EQ(b.frames(), (std::vector<Frame>{data_frame(0x100), data_frame(0x103)}));
  EXPECT_EQ(a.sent.size(), 2U);
  EXPECT_EQ(a.port.transmit_error_counter(), 0);
}

TEST_F(BusTest, Abort_OfAFrameThatLosesArbitration_IsNotRepeated) {
  for (const bool bit_by_bit : {false, true}) {
    struct Watch final : WireObserver {
      void level_changed(bool, Time) override {}
      void transmit_changed(const Port&, bool, Time) override {}
      void activity_changed(const Port&, bool, bool, Time) override {}
    } watch;
    if (bit_by_bit) bus.add_observer(watch);
    b.heard.clear();
    const Time start = timeline.now() + 1ms;
    timeline.run_until(start);
    a.port.send(data_frame(0x101));
    b.port.send(data_frame(0x100));
    timeline.run_until(start + 2us);  // both are in arbitration
    a.port.abort_transmissions();
    timeline.run_until(start + 1ms);
    EXPECT_TRUE(b.heard.empty());
    if (bit_by_bit) bus.remove_observer(watch);
  }
}

TEST_F(BusTest, HasRoom_UntilAsManyFramesWaitAsTheQueueTakes) {
  a.port.set_transmit_queue(TransmitOrder::identifier, 2);
  EXPECT_TRUE(a.port.has_room());
  a.port.send(data_frame(0x100));
  EXPECT_TRUE(a.port.has_room());
  a.port.send(data_frame(0x101));
  EXPECT_FALSE(a.port.has_room());
  timeline.run_until(Time(20us));  // the first one is on the wire and still counts
  EXPECT_FALSE(a.port.has_room());
  EXPECT_EQ(a.port.transmit_overflows(), 0U);
  timeline.run_until(Time(1ms));
  EXPECT_TRUE(a.port.has_room());
  a.port.set_listen_only(true);
  EXPECT_FALSE(a.port.has_room());
}

}  // namespace
}  // namespace canopus::sim::bus_test
