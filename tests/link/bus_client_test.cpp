#include "canopus/link/bus_client.hpp"

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/link/socketcand_server.hpp"

#include "link/toy_bus.hpp"

namespace canopus::link::bus_client_test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using namespace std::chrono_literals;

constexpr auto patience = 10s;  // never reached when all is well

struct Listener : BusClientListener {
  void frame_received(const can::Frame& frame) override { frames.push_back(frame); }
  void frame_sent(const can::Frame& frame) override { sent.push_back(frame); }
  void controller_changed(const ControllerStatus& status) override { statuses.push_back(status); }
  void bus_lost(const std::string& reason) override { lost.push_back(reason); }
  void bus_interrupted(const std::string& reason) override { interrupted.push_back(reason); }
  void bus_resumed() override { ++resumed; }

  std::vector<can::Frame> frames;
  std::vector<can::Frame> sent;
  std::vector<ControllerStatus> statuses;
  std::vector<std::string> lost;
  std::vector<std::string> interrupted;
  int resumed = 0;
};

class SocketcandClientTest : public testing::Test {
 protected:
  void SetUp() override {
    server = std::make_unique<SocketcandServer>(io, tcp::endpoint(asio::ip::address_v4::loopback(), 0),
                                                "line1", bus.attach(), bus);
    const auto listening = server->listen();
    ASSERT_TRUE(listening) << listening.error();
    address.host = "127.0.0.1";
    address.port = server->port();
  }
  void TearDown() override { client.reset(); }

  std::string join(const std::string& name) {
    address.bus = name;
    auto opened = open_bus(io, address, {.time_out = patience, .keep_trying = keep_trying, .retry = 1ms});
    if (!opened) return opened.error();
    client = std::move(*opened);
    client->set_user(&listener);
    bus.advance(100ms);  // the server's frames wait until the client has settled
    return "joined";
  }
  void until(const std::function<bool()>& condition) {
    while (!condition()) io.run_one();
  }

  asio::io_context io;
  ToyBus bus;
  std::unique_ptr<SocketcandServer> server;
  BusAddress address;
  bool keep_trying = false;
  Listener listener;
  std::unique_ptr<BusClient> client;
};

TEST_F(SocketcandClientTest, NamedBus_IsJoined) { EXPECT_EQ(join("line1"), "joined"); }

TEST_F(SocketcandClientTest, OnlyBus_IsJoinedWithoutItsName) { EXPECT_EQ(join(""), "joined"); }

TEST_F(SocketcandClientTest, AnotherName_IsRefusedWithAddressAndReason) {
  EXPECT_EQ(join("can7"), "socketcand:127.0.0.1:" + std::to_string(address.port) +
                              "/can7: the server does not open the bus \"can7\": error could not open bus");
}

TEST_F(SocketcandClientTest, NobodyListening_IsToldAtOnce) {
  server->close();
  EXPECT_THAT(join("line1"), HasSubstr("Connection refused. Is `canopus run` running"));
}

TEST_F(SocketcandClientTest, SentFrame_ReachesTheBus) {
  join("line1");
  EXPECT_TRUE(client->send(can::data_frame(0x601, {0x40, 0, 0x10, 0, 0, 0, 0, 0})));
  until([&] { return bus.waiting() == 1; });
  bus.run();
  EXPECT_THAT(bus.delivered, ElementsAre(can::data_frame(0x601, {0x40, 0, 0x10, 0, 0, 0, 0, 0})));
}

TEST_F(SocketcandClientTest, SentFrames_AreReportedInTheirOrderOnceHandedOver) {
  join("line1");
  client->send(can::data_frame(0x601, {1}));
  client->send(can::data_frame(0x080));
  EXPECT_TRUE(listener.sent.empty());
  until([&] { return listener.sent.size() == 2; });
  EXPECT_THAT(listener.sent, ElementsAre(can::data_frame(0x601, {1}), can::data_frame(0x080)));
}

TEST_F(SocketcandClientTest, Restart_ChangesTheBitRateOfItsPlace_AndDropsWhatWaits) {
  for (const char* name : {"line1", ""}) {
    ASSERT_EQ(join(name), "joined");
    ASSERT_TRUE(client->restart(500'000));
    EXPECT_FALSE(client->restarted()) << "not before the answer";
    until([&] { return client->restarted().has_value(); });
    EXPECT_TRUE(client->restarted()->has_value());
    ASSERT_TRUE(client->send(can::data_frame(0x123)));
    until([&] { return bus.waiting() == 1; });
    ASSERT_TRUE(client->restart(125'000));
    until([&] { return client->restarted().has_value(); });
    EXPECT_EQ(bus.waiting(), 0U);
  }
  EXPECT_THAT(bus.bit_rates, ElementsAre(500'000U, 125'000U, 500'000U, 125'000U));
  EXPECT_EQ(server->statistics().frames_dropped, 2U);
}

TEST_F(SocketcandClientTest, RestartOfABusThatDoesNotTakeIt_IsSaid) {
  join("line1");
  bus.own_bit_rates = false;
  ASSERT_TRUE(client->restart(500'000));
  until([&] { return client->restarted().has_value(); });
  ASSERT_FALSE(client->restarted()->has_value());
  EXPECT_EQ(client->restarted()->error(),
            "the server does not change the bit rate: B: the bit rate of this bus is not set from here");
}

TEST_F(SocketcandClientTest, EndedServer_IsTriedAgainUntilItIsThere) {
  keep_trying = true;
  join("line1");
  const auto endpoint = tcp::endpoint(asio::ip::address_v4::loopback(), address.port);
  server->close();
  until([&] { return !listener.interrupted.empty(); });
  EXPECT_FALSE(client->send(can::data_frame(0x080)));
  io.run_for(5ms);  // tries in vain
  server = std::make_unique<SocketcandServer>(io, endpoint, "line1", bus.attach(), bus);
  ASSERT_TRUE(server->listen());
  until([&] { return listener.resumed == 1; });
  EXPECT_TRUE(client->send(can::data_frame(0x080)));
  until([&] { return bus.waiting() == 1; });
  EXPECT_THAT(listener.interrupted, ElementsAre("the server ended the connection"));
  EXPECT_THAT(listener.lost, ElementsAre());
}

TEST_F(SocketcandClientTest, FrameOfTheBus_IsHeard) {
  join("line1");
  bus.inject(can::data_frame(0x701, {0x05}));
  until([&] { return !listener.frames.empty(); });
  EXPECT_THAT(listener.frames, ElementsAre(can::data_frame(0x701, {0x05})));
}

TEST_F(SocketcandClientTest, EndedServer_IsTold) {
  join("line1");
  server->close();
  until([&] { return !listener.lost.empty(); });
  EXPECT_THAT(listener.lost, ElementsAre("the server ended the connection"));
  EXPECT_FALSE(client->send(can::data_frame(0x080)));
}

TEST(SocketcandClient, SilentServer_IsGivenUpAfterTheTime) {
  asio::io_context io;
  tcp::acceptor silent(io, tcp::endpoint(asio::ip::address_v4::loopback(), 0));
  const BusAddress address{.host = "127.0.0.1", .port = silent.local_endpoint().port()};
  const auto opened = open_bus(io, address, {.time_out = 20ms});
  ASSERT_FALSE(opened.has_value());
  EXPECT_THAT(opened.error(), HasSubstr("no answer within 20 ms"));
}

TEST(SocketcanClient, MissingKernelOrInterface_IsToldWithTheAddress) {
  asio::io_context io;
  const auto opened =
      open_bus(io, {.kind = BusAddress::Kind::socketcan, .bus = "nosuchcan9"}, {.time_out = 1s});
  ASSERT_FALSE(opened.has_value());
  EXPECT_THAT(opened.error(), StartsWith("socketcan:nosuchcan9: "));
  EXPECT_THAT(opened.error(), testing::AnyOf(HasSubstr("kernel has no SocketCAN"),
                                             HasSubstr("no such interface"), HasSubstr("no CAN socket")));
}

}  // namespace
}  // namespace canopus::link::bus_client_test
