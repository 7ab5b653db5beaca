// The bus computes whole frames while nothing is wrong and works bit by bit otherwise. Both must be the same
// bus.

#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/sim/bus/bus.hpp"

#include "can/random_frame.hpp"
#include "can/slow_frame.hpp"
#include "sim/bus_station.hpp"

namespace canopus::sim::bus_bits_test {
namespace {

using namespace std::chrono_literals;
using can::Frame;
using can::Time;

/// Writes down the level of the wire, which makes the bus work bit by bit.
struct Wire : WireObserver {
  void level_changed(bool dominant, Time now) override { edges.emplace_back(now, dominant); }
  void transmit_changed(const Port&, bool, Time) override {}
  void activity_changed(const Port&, bool, bool, Time) override {}
  /// The level at the middle of each of `count` bits from `start`: '0' dominant, '1' recessive.
  [[nodiscard]] std::string bits(Time start, std::size_t count, can::Duration bit) const {
    std::string text;
    for (std::size_t number = 0; number < count; ++number) {
      const Time middle = start + bit * static_cast<std::int64_t>(number) + bit / 2;
      bool dominant = false;
      for (const auto& [at, level] : edges) {
        if (at > middle) break;
        dominant = level;
      }
      text += dominant ? '0' : '1';
    }
    return text;
  }
  std::vector<std::pair<Time, bool>> edges;
};

struct Ledger : BusObserver {
  void frame_completed(const Frame& frame, Time start, Time end) override {
    lines.push_back(std::to_string(frame.identifier) + " " +
                    std::to_string(start.time_since_epoch().count()) + " " +
                    std::to_string(end.time_since_epoch().count()));
  }
  void error_detected(const Port& port, BusError, Time now) override {
    lines.push_back("error " + port.name() + " " + std::to_string(now.time_since_epoch().count()));
  }
  std::vector<std::string> lines;
};

/// Something that happens to the bus at a moment, before the bus acts at that moment.
struct Event final : can::Participant {
  Event(can::Timeline& timeline, Time moment, std::function<void()> what) : happens(std::move(what)) {
    alarm() = moment;
    timeline.add(*this);
  }
  void receive(const Frame&, Time) override {}
  void tick(Time) override {
    alarm().cancel();
    happens();
  }
  std::function<void()> happens;
};

/// Random frames of random stations at random times; some with each other, some answered at once. Rough:
/// stations are unplugged, plugged, restarted and set to listen, frames are corrupted.
std::vector<std::string> run(std::uint64_t seed, bool bit_by_bit, int frames, bool rough = false) {
  std::mt19937_64 random(seed);
  constexpr std::uint32_t rates[] = {1'000'000, 800'000, 500'000, 125'000};
  can::Timeline timeline;
  Bus bus("bus", rates[random() % 4], timeline);
  Wire wire;
  Ledger ledger;
  bus.add_observer(ledger);
  std::vector<std::unique_ptr<Station>> stations;
  const std::size_t count = 2 + random() % 6;
  for (std::size_t number = 0; number < count; ++number) {
    stations.push_back(std::make_unique<Station>(bus, timeline, std::to_string(number)));
  }
  for (std::size_t number = 0; number < count; ++number) {
    Station& station = *stations[number];
    station.on_receive = [&station, number](const Frame& frame, Time) {
      if (frame.identifier % 16 == number) {
        station.port.send(
            can::data_frame(0x400 + frame.identifier % 0x100 * 4 + static_cast<unsigned>(number)));
      }
    };
  }
  if (bit_by_bit) bus.add_observer(wire);
  std::vector<std::pair<Time, std::pair<std::size_t, Frame>>> plan;
  for (int number = 0; number < frames; ++number) {
    Frame frame = can::random_frame(random);
    const std::size_t station = random() % count;
    frame.identifier =
        frame.identifier / 8 * 8 + static_cast<std::uint32_t>(station);  // nobody has another's
    plan.emplace_back(
        Time(1us * static_cast<std::int64_t>(random() % (200 * static_cast<unsigned>(frames)) / 50 * 50)),
        std::pair(station, frame));
  }
  std::stable_sort(plan.begin(), plan.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [at, what] : plan) stations[what.first]->send_at(at, what.second);
  std::vector<std::unique_ptr<Event>> events;
  if (rough) {
    const std::vector<Fault> faults = {
        {.kind = FaultKind::corrupt, .probability = 0.05},
        {.kind = FaultKind::corrupt, .probability = 0.05, .receiver = "1", .bit = 17 + seed % 20},
        {.kind = FaultKind::duplicate, .probability = 0.01},
        {.kind = FaultKind::drop, .probability = 0.05, .receiver = "0"},
        {.kind = FaultKind::cut, .from = Time(8ms), .until = Time(12ms), .ports = {"1"}}};
    EXPECT_TRUE(bus.set_faults(faults, seed).has_value());
    for (int number = 0; number < 20; ++number) {
      Port& port = stations[random() % count]->port;
      const std::uint64_t kind = random() % 4;
      // Odd times: the start of a frame is never at the same moment.
      const Time at = Time(1us * static_cast<std::int64_t>(random() % 20'000)) + 17ns;
      const can::Duration pause = 1us * static_cast<std::int64_t>(random() % 3'000) + 3ns;
      const std::uint32_t rate = bus.bit_rate();
      const auto event = [&](Time moment, std::function<void()> what) {
        events.push_back(std::make_unique<Event>(timeline, moment, std::move(what)));
      };
      switch (kind) {
        case 0:
          event(at, [&port] { port.plug(false); });
          event(at + pause, [&port] { port.plug(true); });
          break;
        case 1: event(at, [&port, rate] { port.restart(rate); }); break;
        case 2:
          event(at, [&port] { port.set_listen_only(true); });
          event(at + pause, [&port] { port.set_listen_only(false); });
          break;
        default: event(at, [&port] { port.recover(); });
      }
    }
  }
  timeline.run_until(Time(10s));
  for (const auto& station : stations) {
    for (const Heard& heard : station->heard) {
      ledger.lines.push_back("heard " + std::to_string(heard.frame.identifier) + " " +
                             std::to_string(heard.at.time_since_epoch().count()));
    }
    for (const Heard& sent : station->sent) {
      ledger.lines.push_back("sent " + std::to_string(sent.at.time_since_epoch().count()));
    }
    ledger.lines.push_back(std::to_string(station->port.transmit_overflows()) + " " +
                           std::to_string(station->port.transmit_error_counter()) + " " +
                           std::to_string(station->port.receive_error_counter()) + " " +
                           std::to_string(station->changes));
  }
  const BusLoad load = bus.load(timeline.now());
  ledger.lines.push_back(std::to_string(load.frames));
  // An error frame that its lone sender does not live to finish counts whole when it is computed.
  if (!rough) {
    ledger.lines.push_back(std::to_string(load.error_frames) + " " + std::to_string(load.bits) + " " +
                           std::to_string(load.peak));
  }
  return ledger.lines;
}

TEST(BusBits, RandomTraffic_IsTheSameFrameByFrameAndBitByBit) {
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    const auto frame_by_frame = run(seed, false, 100);
    ASSERT_GE(frame_by_frame.size(), 200U);
    ASSERT_EQ(frame_by_frame, run(seed, true, 100)) << "seed " << seed;
  }
}

TEST(BusBits, RoughTraffic_IsTheSameFrameByFrameAndBitByBit) {
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    const auto frame_by_frame = run(seed, false, 100, true);
    const auto bit_by_bit = run(seed, true, 100, true);
    const auto differ =
        std::mismatch(frame_by_frame.begin(), frame_by_frame.end(), bit_by_bit.begin(), bit_by_bit.end());
    ASSERT_TRUE(differ.first == frame_by_frame.end() && differ.second == bit_by_bit.end())
        << "seed " << seed << ": " << (differ.first == frame_by_frame.end() ? "end" : *differ.first)
        << " and " << (differ.second == bit_by_bit.end() ? "end" : *differ.second);
  }
}

TEST(BusBits, TheWire_CarriesTheBitsOfTheSlowModelWithTheAckSlotDominant) {
  std::mt19937_64 random(5);
  can::Timeline timeline;
  Bus bus("bus", 1'000'000, timeline);
  Station a(bus, timeline, "a");
  Station b(bus, timeline, "b");
  for (int count = 0; count < 2'000; ++count) {
    Wire wire;
    bus.add_observer(wire);
    const Frame frame = can::random_frame(random);
    const Time start = timeline.now();
    a.port.send(frame);
    timeline.run_until(start + 1ms);
    std::string expected = can::slow::wire(frame);
    expected[expected.size() - 9] = '0';
    ASSERT_EQ(wire.bits(start, expected.size(), 1us), expected);
    ASSERT_EQ(b.heard.back().frame, frame);
    ASSERT_EQ(b.heard.back().at, start + 1us * static_cast<std::int64_t>(expected.size()));
    bus.remove_observer(wire);
  }
}

// Bit by bit over the arbitration fields: who sends recessive and sees dominant is out.
std::size_t slow_arbitration(const std::vector<Frame>& frames) {
  std::vector<std::size_t> in;
  std::vector<std::string> bits;
  for (std::size_t number = 0; number < frames.size(); ++number) {
    in.push_back(number);
    bits.push_back(can::slow::wire(frames[number]));
  }
  for (std::size_t bit = 0; in.size() > 1; ++bit) {
    bool dominant = false;
    for (const std::size_t number : in) dominant = dominant || bits[number][bit] == '0';
    if (dominant) std::erase_if(in, [&](std::size_t number) { return bits[number][bit] == '1'; });
  }
  return in.front();
}

TEST(BusBits, UpTo20Contenders_AreArbitratedAsTheSlowModelHasIt) {
  for (const bool bit_by_bit : {false, true}) {
    std::mt19937_64 random(11);
    for (int round = 0; round < 300; ++round) {
      can::Timeline timeline;
      Bus bus("bus", 500'000, timeline);
      std::vector<std::unique_ptr<Station>> stations;
      std::vector<Frame> frames;
      const std::size_t count = 2 + random() % 19;
      const std::uint64_t common = random();
      while (frames.size() < count) {
        // Much in common, so that arbitration is decided late, and by RTR and IDE too.
        Frame frame = can::random_frame(random);
        const std::uint64_t mask = random() & random() & random();
        const auto identifier = static_cast<std::uint32_t>((common & ~mask) | (random() & mask));
        frame.identifier = frame.extended ? identifier & 0x1FFF'FFFF : (identifier >> 18) & 0x7FF;
        const bool known = std::any_of(frames.begin(), frames.end(), [&](const Frame& other) {
          return other.identifier == frame.identifier && other.extended == frame.extended &&
                 other.remote == frame.remote;
        });
        if (!known) frames.push_back(frame);
      }
      Wire wire;
      for (std::size_t number = 0; number < count; ++number) {
        stations.push_back(std::make_unique<Station>(bus, timeline, std::to_string(number)));
        stations.back()->send_at(Time(1ms), frames[number]);
      }
      Station listener(bus, timeline, "listener");
      if (bit_by_bit) bus.add_observer(wire);
      timeline.run_until(Time(1s));
      std::vector<Frame> expected;
      while (!frames.empty()) {
        const std::size_t winner = slow_arbitration(frames);
        expected.push_back(frames[winner]);
        frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(winner));
      }
      ASSERT_EQ(listener.frames(), expected);
    }
  }
}

TEST(BusBits, LoneTransmitter_IsTheSameFrameByFrameAndBitByBit) {
  for (const bool bit_by_bit : {false, true}) {
    can::Timeline timeline;
    Bus bus("bus", 1'000'000, timeline);
    Station a(bus, timeline, "a");
    Wire wire;
    if (bit_by_bit) bus.add_observer(wire);
    a.port.send(can::data_frame(0x123, {0x55}));
    // 45 bits to the end of the ACK slot, 6 + 8 + 3 bits for the error frame and the intermission.
    timeline.run_until(Time(45us) + 14 * 62us + 1us);
    EXPECT_EQ(a.port.transmit_error_counter(), 120);
    timeline.run_until(Time(45us) + 15 * 62us);
    EXPECT_EQ(a.port.transmit_error_counter(), 128);
    EXPECT_EQ(a.port.error_state(), can::ErrorState::error_passive);
    // From here on each attempt waits 8 bits more: suspend transmission.
    timeline.run_until(Time(16 * 62us) + 8us + 1000 * 70us + 44us);
    EXPECT_EQ(a.port.counters().errors, 1016U);
    timeline.run_until(Time(16 * 62us) + 8us + 1000 * 70us + 46us);
    EXPECT_EQ(a.port.counters().errors, 1017U);
    EXPECT_EQ(a.port.transmit_error_counter(), 128);
  }
}

TEST(BusBits, WinnerUnpluggedInArbitration_LeavesTheContenderWithWhatItOfferedAtTheStart) {
  for (const bool bit_by_bit : {false, true}) {
    can::Timeline timeline;
    Bus bus("bus", 1'000'000, timeline);
    Station a(bus, timeline, "a");
    Station b(bus, timeline, "b");
    Station c(bus, timeline, "c");
    Wire wire;
    if (bit_by_bit) bus.add_observer(wire);
    a.send_at(Time(100us), can::data_frame(0x122, {0x55}));
    b.send_at(Time(100us), can::data_frame(0x123, {0x55}));
    timeline.run_until(Time(104us));
    b.port.send(can::data_frame(0x050));  // it waits; 123H stays in the arbitration
    a.port.plug(false);
    timeline.run_until(Time(1ms));
    EXPECT_EQ(c.frames(), (std::vector<Frame>{can::data_frame(0x123, {0x55}), can::data_frame(0x050)}));
    EXPECT_EQ(c.heard.at(0).at, Time(153us));
    EXPECT_EQ(b.sent.size(), 2U);
    EXPECT_EQ(b.port.transmit_error_counter(), 0);
    if (bit_by_bit) bus.remove_observer(wire);
  }
}

TEST(BusBits, FrameQueuedAtTheMomentAnotherHasBegun_TakesNoPartInItsArbitration) {
  for (const bool bit_by_bit : {false, true}) {
    can::Timeline timeline;
    Bus bus("bus", 1'000'000, timeline);
    Station a(bus, timeline, "a");
    Station b(bus, timeline, "b");
    Station c(bus, timeline, "c");
    Wire wire;
    if (bit_by_bit) bus.add_observer(wire);
    a.send_at(Time(100us), can::data_frame(0x123, {0x55}));
    timeline.run_until(Time(100us));
    b.port.send(can::data_frame(0x050));
    timeline.run_until(Time(120us));
    c.port.plug(false);
    timeline.run_until(Time(1ms));
    EXPECT_EQ(b.heard, (std::vector<Heard>{{can::data_frame(0x123, {0x55}), Time(153us)}}));
    EXPECT_EQ(a.frames(), (std::vector<Frame>{can::data_frame(0x050)}));
    EXPECT_EQ(a.port.transmit_error_counter() + b.port.transmit_error_counter(), 0);
    if (bit_by_bit) bus.remove_observer(wire);
  }
}

TEST(BusBits, ChangeInTheMiddleOfAFrame_LeavesTheFrameAsItIs) {
  for (int at = 1; at < 60; ++at) {
    can::Timeline timeline;
    Bus bus("bus", 1'000'000, timeline);
    Station a(bus, timeline, "a");
    Station b(bus, timeline, "b");
    Station c(bus, timeline, "c");
    a.port.send(can::data_frame(0x123, {0x55}));
    timeline.run_until(Time(1us * at));
    c.port.plug(false);  // neither sends nor is it the only one to acknowledge
    timeline.run_until(Time(1ms));
    ASSERT_EQ(b.heard, (std::vector<Heard>{{can::data_frame(0x123, {0x55}), Time(53us)}})) << at;
    ASSERT_EQ(a.sent.size(), 1U);
    ASSERT_EQ(c.heard.size(), at >= 53 ? 1U : 0U);
  }
}

}  // namespace
}  // namespace canopus::sim::bus_bits_test
