// Service discovery: what a beacon says and where it goes.

#include "canopus/link/socketcand_beacon.hpp"

#include <array>

#include <boost/asio/buffer.hpp>
#include <gtest/gtest.h>

namespace canopus::link::socketcand_beacon_test {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using namespace std::chrono_literals;

TEST(SocketcandBeacon, NamesTheServerAndItsBus) {
  EXPECT_EQ(socketcand_beacon("press line", "line1", {asio::ip::make_address("127.0.0.1"), 29536}),
            "<CANBeacon name=\"press line\" type=\"SocketCAN\" description=\"Canopus\">"
            "<URL>can://127.0.0.1:29536</URL><Bus name=\"line1\"/></CANBeacon>");
  EXPECT_EQ(socketcand_beacon("a", "b", {asio::ip::make_address("::1"), 1}),
            "<CANBeacon name=\"a\" type=\"SocketCAN\" description=\"Canopus\">"
            "<URL>can://[::1]:1</URL><Bus name=\"b\"/></CANBeacon>");
}

TEST(SocketcandBeacon, NamesAreText) {
  EXPECT_EQ(socketcand_beacon("\"><x/>&\n", "b", {asio::ip::make_address("127.0.0.1"), 1}),
            "<CANBeacon name=\"&quot;&gt;&lt;x/&gt;&amp; \" type=\"SocketCAN\" description=\"Canopus\">"
            "<URL>can://127.0.0.1:1</URL><Bus name=\"b\"/></CANBeacon>");
}

TEST(SocketcandBeacon, OfAServerOfThisMachineAlone_StaysOnIt) {
  EXPECT_EQ(beacon_destination(asio::ip::make_address("127.0.0.1")),
            udp::endpoint(asio::ip::make_address("127.255.255.255"), 42000));
  EXPECT_EQ(beacon_destination(asio::ip::make_address("192.168.1.5")),
            udp::endpoint(asio::ip::make_address("255.255.255.255"), 42000));
  EXPECT_EQ(beacon_destination(asio::ip::make_address("::1")),
            udp::endpoint(asio::ip::make_address("::1"), 42000));
}

TEST(SocketcandBeacon, IsADatagramAtOnce) {
  asio::io_context io;
  udp::socket receiver(io, udp::endpoint(asio::ip::address_v4::loopback(), 0));
  const SocketcandBeacon beacon(io, receiver.local_endpoint(), "here");
  std::array<char, 100> memory{};
  const std::size_t size = receiver.receive(asio::buffer(memory));
  EXPECT_EQ(std::string(memory.data(), size), "here");
}

}  // namespace
}  // namespace canopus::link::socketcand_beacon_test
