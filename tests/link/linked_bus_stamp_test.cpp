// The time stamps of a real bus, as observers see them.

#include <memory>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/link/linked_bus.hpp"

namespace canopus::link::linked_bus_stamp_test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

struct Kernel final : BusClient {
  bool send(const can::Frame&) override { return true; }
  void set_user(BusClientListener* new_user) override { user = new_user; }
  bool close(std::chrono::milliseconds) override { return true; }
  BusClientListener* user = nullptr;
};

struct Stamps final : can::BusObserver {
  explicit Stamps(const LinkedBus& the_bus) : bus(the_bus) {}
  void frame_completed(const can::Frame&, can::Time, can::Time) override {
    seen.push_back(bus.stamp().time_since_epoch());
  }
  const LinkedBus& bus;
  std::vector<can::Duration> seen;
};

struct Silent final : can::Participant {
  void receive(const can::Frame&, can::Time) override {}
  void tick(can::Time) override {}
};

class LinkedBusStamps : public testing::Test {
 protected:
  LinkedBusStamps() {
    auto client = std::make_unique<Kernel>();
    kernel = client.get();
    bus.emplace("line1", 250'000, timeline, std::move(client));
    bus->set_wall_clock([] { return wall; });
    bus->start(nullptr, {});
    stamps.emplace(*bus);
    bus->add_observer(*stamps);
    timeline.run_until(can::Time(50s));
  }
  void receive_at(std::optional<std::chrono::nanoseconds> stamp) {
    kernel->user->frame_received_at(frame, stamp);
  }

  static constexpr std::chrono::nanoseconds wall = 1'700'000'000s;
  const can::Frame frame = can::data_frame(0x181, {1});
  can::Timeline timeline;
  Kernel* kernel = nullptr;
  std::optional<LinkedBus> bus;
  std::optional<Stamps> stamps;
};

TEST_F(LinkedBusStamps, AFrameIsAsOldAsItsStamp) {
  receive_at(wall - 3ms);
  receive_at(wall - 1ms);
  EXPECT_THAT(stamps->seen, ElementsAre(50s - 3ms, 50s - 1ms));
}

TEST_F(LinkedBusStamps, WithoutOneItIsNow) {
  receive_at(std::nullopt);
  EXPECT_THAT(stamps->seen, ElementsAre(50s));
}

TEST_F(LinkedBusStamps, AnOwnFrameHasThatOfItsEcho) {
  Silent node;
  can::Port& port = bus->add_port("one");
  const auto handle = timeline.add(node, "one");
  port.connect(node);
  ASSERT_TRUE(port.send(frame));
  timeline.run_until(can::Time(51s));
  kernel->user->frame_sent_at(frame, wall - 4ms);
  EXPECT_THAT(stamps->seen, ElementsAre(51s - 4ms));
  port.disconnect();
  timeline.remove(handle);
}

TEST_F(LinkedBusStamps, TheyNeverGoBack) {
  receive_at(wall - 1ms);
  receive_at(wall - 3ms);
  EXPECT_THAT(stamps->seen, ElementsAre(50s - 1ms, 50s - 1ms));
}

TEST_F(LinkedBusStamps, ThoseOfAnotherClock_AreNotTaken) {
  receive_at(wall + 1ms);
  receive_at(wall - 11s);
  receive_at(5s);  // of a controller that counts from its start
  EXPECT_THAT(stamps->seen, ElementsAre(50s, 50s, 50s));
}

}  // namespace
}  // namespace canopus::link::linked_bus_stamp_test
