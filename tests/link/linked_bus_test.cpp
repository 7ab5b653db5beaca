#include "canopus/link/linked_bus.hpp"

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::link::linked_bus_test {
namespace {

using can::data_frame;
using can::ErrorState;
using can::Frame;
using can::Time;
using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A transport whose other side is the test.
class Transport final : public BusClient {
 public:
  bool send(const Frame& frame) override {
    if (is_full) return false;
    sent.push_back(frame);
    return true;
  }
  void set_user(BusClientListener* new_user) override { user = new_user; }
  bool close(std::chrono::milliseconds) override { return true; }
  [[nodiscard]] ControllerStatus status() const override { return controller; }
  std::expected<void, std::string> restart(std::uint32_t bit_rate) override {
    restarts.push_back(bit_rate);
    if (!refusal.empty()) return std::unexpected(refusal);
    if (bit_rate != 0) controller.bit_rate = bit_rate;
    return {};
  }
  void report(const ControllerStatus& status) {
    controller = status;
    user->controller_changed(status);
  }

  BusClientListener* user = nullptr;
  std::vector<Frame> sent;
  std::vector<std::uint32_t> restarts;
  ControllerStatus controller;
  std::string refusal;
  bool is_full = false;
};

/// A node that writes down what it hears.
struct Node final : can::Participant {
  Node(can::Bus& bus, can::Timeline& timeline, const std::string& name)
      : port(bus.add_port(name)), handle(timeline.add(*this, name)) {
    port.connect(*this);
  }
  void receive(const Frame& frame, Time now) override {
    heard.push_back(frame);
    last = now;
    if (answer) (void)port.send(*answer);
  }
  void transmitted(const Frame& frame, Time now) override {
    done.push_back(frame);
    last = now;
  }
  void controller_changed(Time) override { states.push_back(port.error_state()); }
  void tick(Time) override {}

  can::Port& port;
  can::Timeline::Handle handle;
  std::vector<Frame> heard;
  std::vector<Frame> done;
  std::vector<ErrorState> states;
  std::optional<Frame> answer;
  Time last{};
};

struct Clock final : LoopClock {
  explicit Clock(can::Timeline& the_timeline) : timeline(the_timeline) {}
  Time now() override {
    timeline.run_until(wall);
    return timeline.now();
  }
  void touched() override { ++touches; }
  can::Timeline& timeline;
  Time wall{};
  int touches = 0;
};

class LinkedBusTest : public testing::Test {
 protected:
  LinkedBusTest() { start(250'000); }
  void start(std::uint32_t hardware_rate) {
    auto made = std::make_unique<Transport>();
    transport = made.get();
    transport->controller.bit_rate = hardware_rate;
    two.reset();
    one.reset();
    bus.emplace("line1", 250'000, timeline, std::move(made));
    one.emplace(*bus, timeline, "one");
    two.emplace(*bus, timeline, "two");
    bus->start(&clock, [this](std::string_view text, Time) { said.emplace_back(text); });
    pass(0ms);
  }
  void pass(can::Duration time) {
    clock.wall += time;
    timeline.run_until(clock.wall);
  }

  can::Timeline timeline;
  Clock clock{timeline};
  Transport* transport = nullptr;
  std::optional<LinkedBus> bus;
  std::optional<Node> one;
  std::optional<Node> two;
  std::vector<std::string> said;
};

const Frame high = data_frame(0x181, {1, 2});
const Frame low = data_frame(0x701, {5});

TEST_F(LinkedBusTest, FrameOfOutside_IsHeardByAllAtTheMomentItCame) {
  clock.wall += 7ms;  // the timeline is behind: nothing was due
  transport->user->frame_received(high);
  EXPECT_THAT(one->heard, ElementsAre(high));
  EXPECT_THAT(two->heard, ElementsAre(high));
  EXPECT_EQ(one->last, Time{} + 7ms);
  EXPECT_GT(clock.touches, 0);
}

TEST_F(LinkedBusTest, FrameOfANode_IsHeardByTheOthersOnceItIsOnTheBus) {
  ASSERT_TRUE(one->port.send(high));
  pass(1ms);
  EXPECT_THAT(transport->sent, ElementsAre(high));
  EXPECT_THAT(two->heard, IsEmpty());
  EXPECT_THAT(one->done, IsEmpty());
  clock.wall += 1ms;
  transport->user->frame_sent(high);
  EXPECT_THAT(two->heard, ElementsAre(high));
  EXPECT_THAT(one->done, ElementsAre(high));
  EXPECT_THAT(one->heard, IsEmpty());
  EXPECT_EQ(one->port.counters().transmitted, 1U);
  EXPECT_EQ(two->port.counters().received, 1U);
  EXPECT_EQ(one->last, Time{} + 2ms);
}

TEST_F(LinkedBusTest, Answer_LeavesAtOnce) {
  two->answer = low;
  transport->user->frame_received(high);
  pass(0ms);
  EXPECT_THAT(transport->sent, ElementsAre(low));
}

TEST_F(LinkedBusTest, NodesOfThePlant_ArbitrateForTheTransport) {
  for (std::uint8_t i = 0; i < 4; ++i) ASSERT_TRUE(one->port.send(data_frame(0x700, {i})));
  ASSERT_TRUE(one->port.send(low));
  ASSERT_TRUE(two->port.send(high));
  pass(0ms);
  ASSERT_EQ(transport->sent.size(), 4U);
  EXPECT_EQ(transport->sent[0], high);  // the lowest identifier, whoever sends it
  EXPECT_EQ(transport->sent[1], data_frame(0x700, {0}));
  EXPECT_EQ(transport->sent[3], data_frame(0x700, {2}));
  transport->user->frame_sent(high);  // makes room for one more
  pass(0ms);
  ASSERT_EQ(transport->sent.size(), 5U);
  EXPECT_EQ(transport->sent[4], data_frame(0x700, {3}));
}

TEST_F(LinkedBusTest, FullTransport_IsAskedAgain) {
  transport->is_full = true;
  ASSERT_TRUE(one->port.send(high));
  pass(0ms);
  transport->is_full = false;
  pass(900us);
  EXPECT_THAT(transport->sent, IsEmpty());
  pass(100us);
  EXPECT_THAT(transport->sent, ElementsAre(high));
}

TEST_F(LinkedBusTest, TransportThatIsFullForLong_GetsEverythingInTheEnd) {
  transport->is_full = true;
  for (std::uint8_t i = 0; i < 4; ++i) ASSERT_TRUE(one->port.send(data_frame(0x100, {i})));
  pass(50ms);
  transport->is_full = false;
  pass(1ms);
  EXPECT_EQ(transport->sent.size(), 4U);
}

TEST_F(LinkedBusTest, FullQueue_RefusesAndCounts) {
  one->port.set_transmit_queue(can::TransmitOrder::fifo, 2);
  EXPECT_TRUE(one->port.send(high));
  EXPECT_TRUE(one->port.send(low));
  EXPECT_FALSE(one->port.has_room());
  EXPECT_FALSE(one->port.send(low));
  EXPECT_EQ(one->port.transmit_overflows(), 1U);
  pass(0ms);
  EXPECT_FALSE(one->port.send(low)) << "what is under way has its place still";
  EXPECT_FALSE(one->port.has_room());
  transport->user->frame_sent(high);
  EXPECT_TRUE(one->port.send(low));
}

TEST_F(LinkedBusTest, AbortedFrames_AreNotReported) {
  ASSERT_TRUE(one->port.send(high));
  pass(0ms);
  one->port.abort_transmissions();
  transport->user->frame_sent(high);
  EXPECT_THAT(one->done, IsEmpty());
  EXPECT_THAT(two->heard, ElementsAre(high)) << "it was on the bus all the same";
}

TEST_F(LinkedBusTest, AbortedFrames_AreNotSent) {
  for (std::uint8_t i = 0; i < 8; ++i) ASSERT_TRUE(one->port.send(data_frame(0x100, {i})));
  pass(0ms);
  one->port.abort_transmissions();
  for (std::uint8_t i = 0; i < 4; ++i) transport->user->frame_sent(data_frame(0x100, {i}));
  pass(1ms);
  EXPECT_EQ(transport->sent.size(), 4U) << "what the transport had";
}

TEST_F(LinkedBusTest, SupplyThatGoes_TakesWhatWaitsWithIt) {
  one->port.plug(false);
  ASSERT_TRUE(one->port.send(high));
  one->port.set_power(false);
  one->port.set_power(true);
  one->port.plug(true);
  pass(1ms);
  EXPECT_THAT(transport->sent, IsEmpty());
  EXPECT_EQ(one->port.transmit_overflows(), 0U);
}

TEST_F(LinkedBusTest, NodeWithoutSupply_IsDeafAndSilent) {
  one->port.set_power(false);
  EXPECT_FALSE(one->port.send(high));
  transport->user->frame_received(low);
  EXPECT_THAT(one->heard, IsEmpty());
  EXPECT_THAT(two->heard, ElementsAre(low));
  one->port.set_power(true);
  transport->user->frame_received(low);
  EXPECT_THAT(one->heard, ElementsAre(low));
}

TEST_F(LinkedBusTest, UnpluggedNode_KeepsWhatWaits) {
  one->port.plug(false);
  EXPECT_TRUE(one->port.send(high));
  pass(5ms);
  EXPECT_THAT(transport->sent, IsEmpty());
  one->port.plug(true);
  pass(0ms);
  EXPECT_THAT(transport->sent, ElementsAre(high));
}

TEST_F(LinkedBusTest, ListenOnly_HearsAndSendsNothing) {
  ASSERT_TRUE(one->port.send(low));
  one->port.set_listen_only(true);
  EXPECT_FALSE(one->port.send(high));
  pass(1ms);
  transport->user->frame_received(high);
  EXPECT_THAT(one->heard, ElementsAre(high));
  one->port.set_listen_only(false);
  ASSERT_TRUE(one->port.send(high));
  pass(1ms);
  EXPECT_THAT(transport->sent, ElementsAre(high)) << "what waited is dropped";
}

TEST_F(LinkedBusTest, Acceptance_LeavesOut) {
  can::Acceptance acceptance;
  acceptance.base.reset();
  acceptance.base.set(0x701);
  acceptance.extended = false;
  one->port.accept(acceptance);
  transport->user->frame_received(high);
  transport->user->frame_received({.identifier = 0x701, .extended = true});
  transport->user->frame_received(low);
  EXPECT_THAT(one->heard, ElementsAre(low));
  EXPECT_EQ(two->heard.size(), 3U);
}

TEST_F(LinkedBusTest, CountersOfTheHardware_AreThoseOfEveryNode) {
  transport->report({.state = ErrorState::error_passive,
                     .transmit_errors = 128,
                     .receive_errors = 3,
                     .bit_rate = 250'000,
                     .counters_known = true});
  for (Node* node : {&*one, &*two}) {
    EXPECT_EQ(node->port.transmit_error_counter(), 128);
    EXPECT_EQ(node->port.receive_error_counter(), 3);
    EXPECT_THAT(node->states, ElementsAre(ErrorState::error_passive));
  }
}

TEST_F(LinkedBusTest, OtherBitRateOfTheOnlyNode_IsGivenToTheHardware) {
  two->port.set_power(false);
  one->port.restart(500'000);
  EXPECT_THAT(transport->restarts, ElementsAre(500'000U));
  EXPECT_THAT(said, IsEmpty());
  transport->user->frame_received(high);
  EXPECT_THAT(one->heard, ElementsAre(high));
}

TEST_F(LinkedBusTest, BitRateThatCannotBeSet_LeavesTheNodeDeafAndSaysWhatToDo) {
  two->port.set_power(false);
  transport->refusal = "ip link set can0 type can bitrate 500000";
  one->port.restart(500'000);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(said[0], HasSubstr("one wants 500000 bit/s, and the bus has 250000 bit/s"));
  EXPECT_THAT(said[0], HasSubstr("ip link set can0 type can bitrate 500000"));
  transport->user->frame_received(high);
  EXPECT_THAT(one->heard, IsEmpty());
  ASSERT_TRUE(one->port.send(low));
  pass(1ms);
  EXPECT_THAT(transport->sent, IsEmpty());
  one->port.restart(250'000);
  transport->user->frame_received(high);
  EXPECT_THAT(one->heard, ElementsAre(high));
}

TEST_F(LinkedBusTest, BitRateThatOthersUse_IsNotTakenFromThem) {
  one->port.restart(500'000);
  EXPECT_THAT(transport->restarts, IsEmpty());
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(said[0], HasSubstr("other nodes of the plant use it"));
}

TEST_F(LinkedBusTest, TransportWithoutBitRate_TakesAny) {
  start(0);
  one->port.restart(500'000);
  transport->user->frame_received(high);
  EXPECT_THAT(one->heard, ElementsAre(high));
  EXPECT_THAT(transport->restarts, IsEmpty());
}

TEST_F(LinkedBusTest, BusOff_RecoversByItselfWhenANodeWantsThat) {
  ASSERT_TRUE(one->port.send(high));
  pass(0ms);
  transport->report({.state = ErrorState::bus_off, .bit_rate = 250'000});
  EXPECT_THAT(said, ElementsAre("the controller is bus-off"));
  EXPECT_EQ(one->port.counters().bus_offs, 1U);
  pass(5ms);
  EXPECT_THAT(transport->restarts, IsEmpty()) << "128 times 11 bits are 5.632 ms";
  pass(1ms);
  EXPECT_THAT(transport->restarts, ElementsAre(0U));
  transport->report({.state = ErrorState::error_active, .bit_rate = 250'000});
  pass(0ms);
  EXPECT_THAT(one->done, IsEmpty()) << "the hardware dropped what it had";
  EXPECT_TRUE(one->port.send(low));
  pass(0ms);
  EXPECT_EQ(transport->sent.back(), low);
}

TEST_F(LinkedBusTest, FramesThatBusOffTook_KeepNoPlaces) {
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(one->port.send(high));
  pass(0ms);
  transport->report({.state = ErrorState::bus_off, .bit_rate = 250'000});
  transport->report({.state = ErrorState::error_active, .bit_rate = 250'000});
  ASSERT_TRUE(two->port.send(low));
  pass(0ms);
  EXPECT_EQ(transport->sent.back(), low);
}

TEST_F(LinkedBusTest, AutomaticRecoveryThatIsChosenInBusOff_StartsAtOnce) {
  one->port.set_automatic_recovery(false);
  two->port.set_automatic_recovery(false);
  transport->report({.state = ErrorState::bus_off, .bit_rate = 250'000});
  pass(1s);
  one->port.set_automatic_recovery(true);
  EXPECT_THAT(transport->restarts, ElementsAre(0U));
}

TEST_F(LinkedBusTest, Restart_CountsAnew) {
  one->port.set_transmit_queue(can::TransmitOrder::fifo, 1);
  EXPECT_TRUE(one->port.send(high));
  EXPECT_FALSE(one->port.send(high));
  one->port.restart(250'000);
  EXPECT_EQ(one->port.transmit_overflows(), 0U);
  EXPECT_TRUE(one->port.send(high));
}

TEST_F(LinkedBusTest, NodeThatWaitsForSomething_GetsItsTick) {
  struct Timer final : can::Participant {
    void receive(const Frame&, Time now) override { alarm() = now + 3ms; }
    void tick(Time now) override {
      ticked = now;
      alarm().cancel();
    }
    Time ticked{};
  } timer;
  can::Port& port = bus->add_port("timer");
  const auto handle = timeline.add(timer, "timer");
  port.connect(timer);
  transport->user->frame_received(high);
  pass(10ms);
  EXPECT_EQ(timer.ticked, Time{} + 3ms);
  port.disconnect();
  timeline.remove(handle);
}

TEST_F(LinkedBusTest, Load_IsThatOfTheHardwaresBitRate) {
  struct Watch final : can::BusObserver {
    void frame_completed(const Frame&, Time start, Time end) override { length = end - start; }
    can::Duration length{};
  };
  Watch slow;
  bus->add_observer(slow);
  clock.wall += 10ms;
  transport->user->frame_received(high);
  transport->report({.bit_rate = 500'000});
  clock.wall += 10ms;
  const can::Duration before = slow.length;
  transport->user->frame_received(high);
  EXPECT_EQ(slow.length * 2, before);
  bus->remove_observer(slow);
}

TEST_F(LinkedBusTest, BusOff_StaysUntilAskedWithoutAutomaticRecovery) {
  one->port.set_automatic_recovery(false);
  two->port.set_automatic_recovery(false);
  transport->report({.state = ErrorState::bus_off, .bit_rate = 250'000});
  pass(1s);
  EXPECT_THAT(transport->restarts, IsEmpty());
  one->port.recover();
  EXPECT_THAT(transport->restarts, ElementsAre(0U));
}

TEST_F(LinkedBusTest, InterruptedBus_IsSaidAndGoesOn) {
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(one->port.send(high));
  pass(0ms);
  EXPECT_TRUE(bus->is_there());
  transport->user->bus_interrupted("socketcan:can0: the interface is down");
  EXPECT_THAT(said, ElementsAre("socketcan:can0: the interface is down; it is tried again"));
  EXPECT_FALSE(bus->is_there());
  transport->user->bus_resumed();
  EXPECT_EQ(said.back(), "the bus is there again");
  EXPECT_TRUE(bus->is_there());
  transport->sent.clear();
  ASSERT_TRUE(two->port.send(low));
  pass(0ms);
  EXPECT_THAT(transport->sent, ElementsAre(low)) << "what was lost does not block the others";
}

TEST_F(LinkedBusTest, LostBus_IsSaidAndTakesNothingMore) {
  transport->user->bus_lost("gone");
  ASSERT_TRUE(one->port.send(high));
  pass(10ms);
  EXPECT_THAT(transport->sent, IsEmpty());
  EXPECT_THAT(said, ElementsAre("gone; no frames are received or sent any more"));
  EXPECT_FALSE(bus->is_there());
}

TEST_F(LinkedBusTest, Load_CountsTheBitsOfBothDirections) {
  struct Watch final : can::BusObserver {
    void frame_completed(const Frame&, Time start, Time end) override { times.emplace_back(start, end); }
    std::vector<std::pair<Time, Time>> times;
  } watch;
  bus->add_observer(watch);
  clock.wall += 10ms;
  transport->user->frame_received(
      data_frame(0x555, {0xAA, 0x55}));  // 44 + 16 bits and 3, no stuff bits in the data
  const can::BusLoad load = bus->load(timeline.now());
  EXPECT_EQ(load.frames, 1U);
  EXPECT_GE(load.bits, 63U);
  EXPECT_EQ(bus->frames_of(0x555, false), 1U);
  ASSERT_EQ(watch.times.size(), 1U);
  EXPECT_EQ(watch.times[0].second, Time{} + 10ms);
  EXPECT_EQ(watch.times[0].first, Time{} + 10ms - load.bits * 4us);
}

}  // namespace
}  // namespace canopus::link::linked_bus_test
