// Fault confinement on the wire, walked through by hand: bit numbers count from the SOF (0) of the frame.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/sim/bus/bus.hpp"

#include "sim/bus_station.hpp"

namespace canopus::sim::bus_errors_test {
namespace {

using namespace std::chrono_literals;
using can::data_frame;
using can::ErrorState;
using can::Frame;
using can::Time;

struct ErrorLog : BusObserver {
  void frame_completed(const Frame&, Time start, Time) override { starts.push_back(start); }
  void error_detected(const Port& port, BusError error, Time now) override {
    constexpr const char* names[] = {"none", "bit", "stuff", "crc", "form", "ack"};
    // The bit that was sampled, at 1 Mbit/s.
    lines.push_back(port.name() + " " + names[static_cast<int>(error)] + " " +
                    std::to_string(now.time_since_epoch() / 1us));
  }
  std::vector<std::string> lines;
  std::vector<Time> starts;
};

struct BusErrors : ::testing::Test {
  BusErrors() { bus.add_observer(log); }
  void faults(std::vector<Fault> list) { ASSERT_TRUE(bus.set_faults(list, 1).has_value()); }

  can::Timeline timeline;
  Bus bus{"main", 1'000'000, timeline};
  ErrorLog log;
  Station a{bus, timeline, "a"};
  Station b{bus, timeline, "b"};
  Station c{bus, timeline, "c"};
};

using Lines = std::vector<std::string>;

// 0 00100100011 0 0 0 00(1)01 01010101 010001101100011 1 1 1 1111111
// 0 1        11 12 .. 15   19 20    27 28           42 43 44 45 46..52
const Frame frame_of_53_bits = data_frame(0x123, {0x55});
// 0 0000(1)00000(1)00 ...: stuff bits are bits 5 and 11.
const Frame all_dominant = data_frame(0x000);

TEST_F(BusErrors, StuffErrorOfOneReceiver_DestroysTheFrameForAll) {
  faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "b", .bit = 5}});
  a.port.send(all_dominant);
  timeline.run_until(Time(28us));
  // b sends its flag in bits 6 to 11, the others see six dominant bits in a row at bit 11 and send theirs in
  // bits 12 to 17.
  EXPECT_EQ(log.lines, (Lines{"b stuff 5", "a stuff 11", "c stuff 11"}));
  EXPECT_EQ(b.port.receive_error_counter(), 9);  // 1, and 8 for the dominant bit after its flag
  EXPECT_EQ(c.port.receive_error_counter(), 1);
  EXPECT_EQ(a.port.transmit_error_counter(), 0);  // a recessive stuff bit lost in the arbitration field
  timeline.run_until(Time(1ms));
  // Delimiter 18 to 25, intermission 26 to 28; then 50 bits.
  EXPECT_EQ(log.starts, (std::vector<Time>{Time(29us)}));
  EXPECT_EQ(b.heard, (std::vector<Heard>{{all_dominant, Time(79us)}}));
  EXPECT_EQ(c.heard, (std::vector<Heard>{{all_dominant, Time(79us)}}));
  EXPECT_EQ(b.port.receive_error_counter(), 8);
  EXPECT_EQ(c.port.receive_error_counter(), 0);
}

TEST_F(BusErrors, CrcErrorOfOneReceiver_IsFlaggedAfterTheAckDelimiter) {
  faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "b", .bit = 22}});
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(63us));
  EXPECT_EQ(log.lines, (Lines{"b crc 45", "a bit 46", "c form 46"}));
  EXPECT_EQ(b.port.receive_error_counter(), 9);
  EXPECT_EQ(c.port.receive_error_counter(), 1);
  EXPECT_EQ(a.port.transmit_error_counter(), 8);
  timeline.run_until(Time(1ms));
  // Flags 46 to 52, delimiter 53 to 60, intermission 61 to 63.
  EXPECT_EQ(log.starts, (std::vector<Time>{Time(64us)}));
  EXPECT_EQ(b.frames(), (std::vector<Frame>{frame_of_53_bits}));
  EXPECT_EQ(c.frames(), (std::vector<Frame>{frame_of_53_bits}));
  EXPECT_EQ(a.port.transmit_error_counter(), 7);
}

TEST_F(BusErrors, BitErrorOfTheTransmitter_IsRepeatedAtOnce) {
  faults({{.kind = FaultKind::corrupt, .count = 1, .receiver = "a", .bit = 21}});
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1ms));
  // The flag of a is bits 22 to 27; bits 17 to 21 were 1 0 1 0 1, so six dominant bits are 22 to 27.
  EXPECT_EQ(log.lines, (Lines{"a bit 21", "b stuff 27", "c stuff 27"}));
  // Their flags are bits 28 to 33, delimiter 34 to 41, intermission 42 to 44.
  EXPECT_EQ(log.starts, (std::vector<Time>{Time(45us)}));
  EXPECT_EQ(a.port.transmit_error_counter(), 7);
  EXPECT_EQ(b.port.receive_error_counter(), 0);
}

TEST_F(BusErrors, NoDominantAckSlot_IsAnErrorOfTheTransmitterOnly) {
  b.port.set_listen_only(true);
  c.port.set_listen_only(true);
  timeline.run_until(Time(1ms));
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1ms) + 44us);
  EXPECT_TRUE(log.lines.empty());
  timeline.run_until(Time(1ms) + 45us);
  EXPECT_EQ(log.lines, (Lines{"a ack 1044"}));
  EXPECT_EQ(a.port.transmit_error_counter(), 8);
}

TEST_F(BusErrors, TransmitterWhoseFramesAreAlwaysCorrupted_IsBusOffAfter32Attempts) {
  faults({{.kind = FaultKind::corrupt, .bit = 21}});
  a.port.set_automatic_recovery(false);
  std::vector<std::string> states;
  a.on_change = [&](Time) { states.push_back(std::to_string(a.port.transmit_error_counter())); };
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1s));
  EXPECT_EQ(a.port.error_state(), ErrorState::bus_off);
  EXPECT_EQ(a.port.transmit_error_counter(), 256);
  EXPECT_EQ(a.port.counters().errors, 32U);
  EXPECT_EQ(a.port.counters().bus_offs, 1U);
  EXPECT_EQ(states, (Lines{"96", "128", "256"}));
  EXPECT_TRUE(a.sent.empty());
  EXPECT_TRUE(b.heard.empty());
  EXPECT_EQ(b.port.error_state(), ErrorState::error_active);
}

TEST_F(BusErrors, BusOff_EndsAfter128Times11RecessiveBitsAndTheFrameGoesOut) {
  faults({{.kind = FaultKind::corrupt, .count = 32, .bit = 21}});
  Time off{};
  a.on_change = [&](Time now) {
    if (a.port.error_state() == ErrorState::bus_off) off = now;
  };
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1s));
  ASSERT_EQ(log.starts.size(), 1U);
  // When a falls silent at bit 21 of its last attempt the others see the sixth recessive bit at most five
  // bits later and send their flag of six bits.
  const auto after = (log.starts[0] - off) / 1us;
  EXPECT_GE(after, 1408);
  EXPECT_LE(after, 1408 + 12);
  EXPECT_EQ(a.port.error_state(), ErrorState::error_active);
  EXPECT_EQ(a.port.transmit_error_counter(), 0);
  EXPECT_EQ(b.frames(), (std::vector<Frame>{frame_of_53_bits}));
}

TEST_F(BusErrors, BusOffWithoutAutomaticRecovery_LastsUntilRecover) {
  faults({{.kind = FaultKind::corrupt, .count = 32, .bit = 21}});
  a.port.set_automatic_recovery(false);
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1s));
  ASSERT_EQ(a.port.error_state(), ErrorState::bus_off);
  b.port.send(data_frame(0x10));
  timeline.run_until(Time(2s));
  EXPECT_TRUE(a.heard.empty());
  EXPECT_EQ(c.frames(), (std::vector<Frame>{data_frame(0x10)}));
  a.port.recover();
  timeline.run_until(Time(2s) + 1407us);
  EXPECT_EQ(a.port.error_state(), ErrorState::bus_off);
  timeline.run_until(Time(2s) + 1408us);
  EXPECT_EQ(a.port.error_state(), ErrorState::error_active);
  timeline.run_until(Time(3s));
  EXPECT_EQ(log.starts.back(), Time(2s) + 1408us);
  EXPECT_EQ(a.sent.size(), 1U);
}

TEST_F(BusErrors, Restart_EndsBusOffAfter11RecessiveBitsWithAnEmptyQueue) {
  faults({{.kind = FaultKind::corrupt, .count = 32, .bit = 21}});
  a.port.set_automatic_recovery(false);
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1s));
  a.port.restart(1'000'000);
  EXPECT_EQ(a.port.error_state(), ErrorState::error_active);
  EXPECT_EQ(a.port.transmit_error_counter(), 0);
  a.port.send(data_frame(0x77));
  timeline.run_until(Time(2s));
  EXPECT_EQ(log.starts, (std::vector<Time>{Time(1s) + 11us}));
  EXPECT_EQ(b.frames(), (std::vector<Frame>{data_frame(0x77)}));
}

TEST_F(BusErrors, RecessiveBitsOfFramesOfOthers_CountForTheRecovery) {
  faults({{.kind = FaultKind::corrupt, .identifier = 0x123, .count = 32, .bit = 21}});
  a.port.set_automatic_recovery(false);
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1s));
  b.on_transmitted = [&](const Frame&, Time) { b.port.send(data_frame(0x200)); };
  b.port.send(data_frame(0x200));
  timeline.run_until(Time(2s));
  a.port.recover();
  // Back to back, each frame has 11 recessive bits at its end: ACK delimiter, EOF, intermission.
  const std::size_t before = c.heard.size();
  timeline.run_until(Time(3s));
  std::size_t frames = 0;
  while (c.heard[before + frames].frame == data_frame(0x200)) ++frames;
  EXPECT_GE(frames, 128U);
  EXPECT_LE(frames, 129U);
}

TEST_F(BusErrors, PassiveReceiver_NoLongerDestroysFrames) {
  // Each attempt costs b 1 for the error and 8 for the dominant bit after its flag, and a 8.
  faults({{.kind = FaultKind::corrupt, .receiver = "b", .bit = 22}});
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(14 * 64us));
  EXPECT_EQ(b.port.receive_error_counter(), 126);
  EXPECT_EQ(b.port.error_state(), ErrorState::error_active);
  timeline.run_until(Time(15 * 64us));
  EXPECT_EQ(b.port.receive_error_counter(), 135);
  EXPECT_EQ(b.port.error_state(), ErrorState::error_passive);
  EXPECT_EQ(a.port.transmit_error_counter(), 120);
  EXPECT_TRUE(c.heard.empty());
  timeline.run_until(Time(20ms));
  EXPECT_EQ(c.frames(), (std::vector<Frame>{frame_of_53_bits}));
  EXPECT_TRUE(b.heard.empty());
  EXPECT_EQ(a.port.transmit_error_counter(), 119);
  EXPECT_EQ(b.port.receive_error_counter(), 136);
}

TEST_F(BusErrors, PassiveReceiver_IsActiveAgainAfterOneFrame) {
  faults({{.kind = FaultKind::corrupt, .count = 15, .receiver = "b", .bit = 22}});
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(20ms));
  EXPECT_EQ(b.frames(), (std::vector<Frame>{frame_of_53_bits}));
  EXPECT_EQ(b.port.receive_error_counter(), 127);
  EXPECT_EQ(b.port.error_state(), ErrorState::error_active);
  EXPECT_EQ(b.changes, 3);  // warning, passive, active
}

TEST_F(BusErrors, PassiveTransmitter_LetsTheOthersGoFirst) {
  // 16 attempts of 43 bits destroyed; then a has to suspend 8 bits, and b with its higher identifier, which
  // has waited since the last of them, gets the bus.
  faults({{.kind = FaultKind::corrupt, .sender = "a", .count = 16, .bit = 21}});
  a.port.send(data_frame(0x123, {0x55}));
  timeline.run_until(Time(100us));
  b.send_at(Time(660us), data_frame(0x700));
  timeline.run_until(Time(20ms));
  EXPECT_EQ(c.frames(), (std::vector<Frame>{data_frame(0x700), data_frame(0x123, {0x55})}));
}

TEST(BusErrorsOfAFrame, BeginInIt_NotInTheIntermissionBefore) {
  // The frame of b begins while the passive a is suspended; whatever bit of it is corrupted, nothing happens before that.
  for (unsigned bit = 1; bit < 100; ++bit) {
    can::Timeline timeline;
    Bus bus("main", 1'000'000, timeline);
    ErrorLog log;
    bus.add_observer(log);
    Station a(bus, timeline, "a"), b(bus, timeline, "b"), c(bus, timeline, "c");
    const std::vector<Fault> faults{{.kind = FaultKind::corrupt, .sender = "a", .count = 16, .bit = 21},
                                    {.kind = FaultKind::corrupt, .sender = "b", .count = 1, .bit = bit}};
    ASSERT_TRUE(bus.set_faults(faults, 1).has_value());
    a.on_transmitted = [&](const Frame&, Time now) {
      b.send_at(now + 1us, data_frame(0x555, {0x55, 0x55, 0x55, 0x55, 0x55, 0x55, 0x55, 0x55}));
      log.lines.clear();
    };
    a.port.send(data_frame(0x123, {0x55}));
    timeline.run_until(Time(20ms));
    ASSERT_EQ(a.sent.size(), 1U);
    ASSERT_FALSE(log.lines.empty()) << bit;
    const std::string& first = log.lines.front();
    const long since =
        std::stol(first.substr(first.rfind(' ') + 1)) - (a.sent[0].at.time_since_epoch() / 1us);
    EXPECT_GE(since, 3 + bit) << first << ", bit " << bit;
    EXPECT_EQ(b.sent.size(), 1U) << bit;
  }
}

TEST_F(BusErrors, SameIdentifierDifferentData_CollidesUntilPassiveThenBothGetThrough) {
  a.send_at(Time(1ms), data_frame(0x123, {0x00}));
  b.send_at(Time(1ms), data_frame(0x123, {0xFF}));
  timeline.run_until(Time(100ms));
  // Each collision costs both 8. When b is passive its flag no longer disturbs a.
  EXPECT_EQ(c.frames(), (std::vector<Frame>{data_frame(0x123, {0x00}), data_frame(0x123, {0xFF})}));
  EXPECT_EQ(a.port.counters().errors, 16U);
  EXPECT_EQ(a.port.transmit_error_counter(), 127);
  EXPECT_EQ(a.sent.size(), 1U);
  EXPECT_EQ(b.sent.size(), 1U);
}

TEST_F(BusErrors, TheSameFrameOfTwo_IsOneFrameOnTheBus) {
  a.send_at(Time(1ms), frame_of_53_bits);
  b.send_at(Time(1ms), frame_of_53_bits);
  timeline.run_until(Time(100ms));
  EXPECT_EQ(c.heard, (std::vector<Heard>{{frame_of_53_bits, Time(1053us)}}));
  EXPECT_EQ(a.sent.size(), 1U);
  EXPECT_EQ(b.sent.size(), 1U);
  EXPECT_TRUE(a.heard.empty());
  EXPECT_EQ(bus.load(timeline.now()).frames, 1U);
}

TEST_F(BusErrors, ArbitrationLost_IsNoError) {
  Station lower(bus, timeline, "lower");
  struct Nothing : WireObserver {
    void level_changed(bool, Time) override {}
    void transmit_changed(const Port&, bool, Time) override {}
    void activity_changed(const Port&, bool, bool, Time) override {}
  } nothing;
  bus.add_observer(nothing);
  a.send_at(Time(1ms), data_frame(0x200));
  lower.send_at(Time(1ms), data_frame(0x100));
  timeline.run_until(Time(100ms));
  EXPECT_EQ(c.frames(), (std::vector<Frame>{data_frame(0x100), data_frame(0x200)}));
  EXPECT_TRUE(log.lines.empty());
}

TEST_F(BusErrors, TransmitterUnpluggedInItsFrame_LeavesAnErrorAndItsFrameWaits) {
  a.port.send(data_frame(0x123, {0x55}));
  timeline.run_until(Time(20us));
  a.port.plug(false);
  timeline.run_until(Time(1ms));
  EXPECT_TRUE(b.heard.empty());
  EXPECT_EQ(b.port.receive_error_counter(), 1);
  EXPECT_EQ(a.port.error_state(), ErrorState::error_active);
  a.port.plug(true);
  timeline.run_until(Time(2ms));
  EXPECT_EQ(b.heard, (std::vector<Heard>{{data_frame(0x123, {0x55}), Time(1ms) + 11us + 53us}}));
}

TEST_F(BusErrors, TransmitterUnpluggedAfterItsLastSample_HasSentItsFrame) {
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(52us) + 880ns);  // bit 52 is sampled at 52.875 us
  a.port.plug(false);
  timeline.run_until(Time(1ms));
  EXPECT_EQ(a.sent, (std::vector<Heard>{{frame_of_53_bits, Time(52us) + 880ns}}));
  EXPECT_EQ(b.heard.size(), 1U);
  a.port.plug(true);
  timeline.run_until(Time(2ms));
  EXPECT_EQ(a.sent.size(), 1U) << "it is not sent again";
  EXPECT_EQ(b.heard.size(), 1U);
  // A sample earlier the frame is not complete for its transmitter, and goes out again.
  a.send_at(Time(3ms), frame_of_53_bits);
  timeline.run_until(Time(3ms) + 52us + 870ns);
  a.port.plug(false);
  timeline.run_until(Time(4ms));
  EXPECT_EQ(a.sent.size(), 1U);
  a.port.plug(true);
  timeline.run_until(Time(5ms));
  EXPECT_EQ(a.sent.size(), 2U);
  EXPECT_EQ(b.heard.size(), 3U);
  // A controller that starts anew tells nobody.
  a.send_at(Time(6ms), frame_of_53_bits);
  timeline.run_until(Time(6ms) + 52us + 880ns);
  a.port.restart(1'000'000);
  timeline.run_until(Time(7ms));
  EXPECT_EQ(a.sent.size(), 2U);
  EXPECT_EQ(b.heard.size(), 4U);
}

TEST_F(BusErrors, LastListenerUnpluggedInAFrame_LeavesItUnacknowledged) {
  b.port.plug(false);
  timeline.run_until(Time(1ms));
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(1ms) + 20us);
  c.port.plug(false);
  timeline.run_until(Time(1ms) + 46us);
  EXPECT_EQ(log.lines, (Lines{"a ack 1044"}));
  EXPECT_EQ(a.port.transmit_error_counter(), 8);
}

TEST_F(BusErrors, StationPoweredUpInAFrame_HearsTheNextOne) {
  a.port.send(data_frame(0x300));
  a.port.send(data_frame(0x301));
  timeline.run_until(Time(30us));
  Station late(bus, timeline, "late");
  timeline.run_until(Time(1ms));
  EXPECT_EQ(late.frames(), (std::vector<Frame>{data_frame(0x301)}));
  EXPECT_EQ(b.frames().size(), 2U);
  EXPECT_TRUE(log.lines.empty());
}

TEST_F(BusErrors, ListenOnlyStation_HearsAllAndSendsNothing) {
  b.port.set_listen_only(true);
  EXPECT_FALSE(b.port.send(data_frame(1)));
  timeline.run_until(Time(1ms));
  a.port.send(frame_of_53_bits);
  timeline.run_until(Time(2ms));
  EXPECT_EQ(b.frames(), (std::vector<Frame>{frame_of_53_bits}));
  EXPECT_EQ(a.port.transmit_error_counter(), 0);
  EXPECT_EQ(b.port.receive_error_counter(), 0);
}

/// A passive sender lets another one go first, which leaves before anybody has sampled its SOF.
TEST(BusSuspension, GoesOnWhenTheRivalsStartOfFrameIsGoneBeforeItIsSampled) {
  can::Timeline timeline;
  Bus bus("main", 1'000'000, timeline);
  Station passive(bus, timeline, "passive");
  Station rival(bus, timeline, "rival");
  Station listener(bus, timeline, "listener");
  const Frame frame = can::data_frame(0x181, {1, 2});
  ASSERT_TRUE(bus.set_faults({{.kind = FaultKind::corrupt,
                               .sender = "passive",
                               .count = 17,
                               .receiver = "passive",
                               .bit = 24}},
                             1)
                  .has_value());
  passive.send_at(Time(1ms), frame);
  passive.send_at(Time(1ms), frame);
  rival.on_receive = [&](const Frame&, Time) { rival.port.send(can::data_frame(0x100)); };
  while (passive.sent.empty()) timeline.run_until(timeline.now() + 1us);
  ASSERT_EQ(passive.port.error_state(), can::ErrorState::error_passive);
  const Time free = passive.sent[0].at + 3us;
  timeline.run_until(free + 10ns);
  rival.port.plug(false);
  timeline.run_until(free + 1ms);
  ASSERT_EQ(listener.heard.size(), 2U);
  EXPECT_EQ(listener.heard[1].at, free + 8us + can::bit_time(can::frame_bits(frame), 1'000'000));
}

}  // namespace
}  // namespace canopus::sim::bus_errors_test
