// What a socketcand client hears of its controller on a simulated bus.

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/serve/client_ports.hpp"
#include "canopus/sim/bus/bus.hpp"

namespace canopus::serve::client_errors_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct Client final : link::AttachedClient {
  void receive(const can::Frame&, can::Time) override {}
  void tick(can::Time) override {}
  void unacknowledged(can::Time) override { heard.emplace_back("unacknowledged"); }
  void controller_error(std::uint32_t error_class, can::Time) override {
    heard.push_back("class " + std::to_string(error_class));
  }
  std::vector<std::string> heard;
};

struct ClientErrors : ::testing::Test {
  can::Timeline timeline;
  sim::Bus bus{"bus", 1'000'000, timeline};
  ClientPorts ports{bus, timeline, true};
  Client client;
  std::unique_ptr<link::BusAttachment> attachment = ports.attach(client);
  can::Port& a = bus.add_port("a");
  can::Port& b = bus.add_port("b");
  void run(const sim::Fault& fault) {
    ASSERT_TRUE(bus.set_faults({fault}, 1).has_value());
    a.send(can::data_frame(0x123, {0x55}));
    timeline.run_until(timeline.now() + 1ms);
  }
};

TEST_F(ClientErrors, AreTheClassOfWhatItsOwnControllerFinds) {
  run({.kind = sim::FaultKind::corrupt, .count = 1, .receiver = "b", .bit = 43});
  EXPECT_THAT(client.heard, ElementsAre("class 648"));  // 288H
}

TEST_F(ClientErrors, AreNotSaidAgainBeforeTheNextFrame) {
  run({.kind = sim::FaultKind::corrupt, .count = 3, .bit = 43});
  EXPECT_THAT(client.heard, ElementsAre("class 648"));
  run({.kind = sim::FaultKind::corrupt, .count = 1, .bit = 43});
  EXPECT_THAT(client.heard, ElementsAre("class 648", "class 648"));
}

TEST_F(ClientErrors, OfAClientWithABitRateOfItsOwn_EndWithIt_AndTheNextClientHasTheBitRateOfTheBus) {
  ASSERT_TRUE(attachment->restart(500'000));
  timeline.run_until(timeline.now() + 1ms);  // it takes part after 11 recessive bits
  a.send(can::data_frame(0x123, {0x55}));
  timeline.run_until(timeline.now() + 1ms);
  EXPECT_FALSE(client.heard.empty()) << "it takes the frame for an error";
  attachment.reset();
  timeline.run_until(timeline.now() + 10ms);
  Client next;
  const auto place = ports.attach(next);
  timeline.run_until(timeline.now() + 1ms);
  b.send(can::data_frame(0x124, {0x55}));
  timeline.run_until(timeline.now() + 10ms);
  EXPECT_THAT(next.heard, IsEmpty());
  EXPECT_EQ(b.counters().transmitted, 1U);
}

TEST_F(ClientErrors, OfABusWhereClientsHaveNoBitRatesOfTheirOwn_AreNotOfOne) {
  attachment.reset();  // a client has one place
  ClientPorts others{bus, timeline, false};
  EXPECT_FALSE(others.attach(client)->restart(500'000));
}

TEST_F(ClientErrors, AreNoneWhereNothingIsWrong) {
  run({.kind = sim::FaultKind::drop, .count = 1});
  EXPECT_THAT(client.heard, IsEmpty());
}

TEST_F(ClientErrors, OfAClientThatIsAlone_AreItsStates_AndOnceThatNobodyAcknowledges) {
  a.plug(false);
  b.plug(false);
  attachment->send(can::data_frame(0x123));
  timeline.run_until(can::Time(20ms));
  EXPECT_THAT(client.heard,
              ElementsAre("unacknowledged", "class 516"));  // 204H: warning, and passive has its class
}

}  // namespace
}  // namespace canopus::serve::client_errors_test
