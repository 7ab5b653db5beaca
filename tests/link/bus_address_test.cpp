#include "canopus/link/bus_address.hpp"

#include <gtest/gtest.h>

namespace canopus::link::bus_address_test {
namespace {

using Kind = BusAddress::Kind;

TEST(BusAddressText, SocketcandWithEverything_IsHostPortAndBus) {
  const BusAddress expected{.kind = Kind::socketcand, .host = "plant.local", .port = 1234, .bus = "line1"};
  EXPECT_EQ(parse_bus_address("socketcand:plant.local:1234/line1"), expected);
}

TEST(BusAddressText, WhatIsLeftOut_IsTheLocalHostAndPort29536) {
  const BusAddress local{.kind = Kind::socketcand, .host = "127.0.0.1", .port = 29536, .bus = ""};
  EXPECT_EQ(parse_bus_address("socketcand:"), local);
  EXPECT_EQ(parse_bus_address("socketcand::29536"), local);
  EXPECT_EQ(parse_bus_address("socketcand:127.0.0.1"), local);
  const BusAddress named{.kind = Kind::socketcand, .host = "127.0.0.1", .port = 29536, .bus = "line1"};
  EXPECT_EQ(parse_bus_address("socketcand:/line1"), named);
}

TEST(BusAddressText, Ipv6Address_StandsInBrackets) {
  const BusAddress expected{.kind = Kind::socketcand, .host = "::1", .port = 29536, .bus = "a"};
  EXPECT_EQ(parse_bus_address("socketcand:[::1]:29536/a"), expected);
  EXPECT_EQ(describe(expected), "socketcand:[::1]:29536/a");
}

TEST(BusAddressText, Socketcan_IsAnInterface) {
  const BusAddress expected{.kind = Kind::socketcan, .host = "", .port = 0, .bus = "can0"};
  EXPECT_EQ(parse_bus_address("socketcan:can0"), expected);
  EXPECT_EQ(describe(expected), "socketcan:can0");
}

TEST(BusAddressText, DescribedAddress_IsReadAgainTheSame) {
  const BusAddress address{.kind = Kind::socketcand, .host = "10.0.0.7", .port = 1, .bus = ""};
  EXPECT_EQ(describe(address), "socketcand:10.0.0.7:1");
  EXPECT_EQ(parse_bus_address(describe(address)), address);
}

TEST(BusAddressText, Slcan_IsADeviceOrTcpAndABitRate) {
  BusAddress expected{
      .kind = Kind::slcan, .bus = "/dev/ttyACM0", .bit_rate = 250'000, .serial_speed = 115'200};
  EXPECT_EQ(parse_bus_address("slcan:/dev/ttyACM0@250000"), expected);
  EXPECT_EQ(describe(expected), "slcan:/dev/ttyACM0@250000");
  expected.serial_speed = 3'000'000;
  EXPECT_EQ(parse_bus_address("slcan:/dev/ttyACM0,3000000@250000"), expected);
  EXPECT_EQ(describe(expected), "slcan:/dev/ttyACM0,3000000@250000");
  const BusAddress tcp{.kind = Kind::slcan, .host = "fd00::7", .port = 3333, .tcp = true};
  EXPECT_EQ(parse_bus_address("slcan:tcp:[fd00::7]:3333"), tcp);
  EXPECT_EQ(describe(tcp), "slcan:tcp:[fd00::7]:3333");
}

TEST(BusAddressText, UdpMulticast_IsAGroupAndAPort) {
  const BusAddress usual{.kind = Kind::udp_multicast, .host = "239.74.163.2", .port = 43113};
  EXPECT_EQ(parse_bus_address("udp-multicast:"), usual);
  EXPECT_EQ(parse_bus_address("udp-multicast:239.74.163.2:43113"), usual);
  EXPECT_EQ(describe(usual), "udp-multicast:239.74.163.2:43113");
  const BusAddress ipv6{.kind = Kind::udp_multicast, .host = "ff15::1", .port = 9};
  EXPECT_EQ(parse_bus_address("udp-multicast:[ff15::1]:9"), ipv6);
}

TEST(BusAddressText, Cannelloni_IsUdpWithTwoPortsOrTcp) {
  BusAddress expected{.kind = Kind::cannelloni, .host = "10.0.0.7", .port = 20000, .local_port = 20000};
  EXPECT_EQ(parse_bus_address("cannelloni:10.0.0.7"), expected);
  EXPECT_EQ(describe(expected), "cannelloni:10.0.0.7:20000");
  expected.local_port = 20001;
  EXPECT_EQ(parse_bus_address("cannelloni:10.0.0.7:20000:20001"), expected);
  EXPECT_EQ(describe(expected), "cannelloni:10.0.0.7:20000:20001");
  const BusAddress tcp{.kind = Kind::cannelloni, .host = "plant", .port = 7, .tcp = true};
  EXPECT_EQ(parse_bus_address("cannelloni:tcp:plant:7"), tcp);
  EXPECT_EQ(describe(tcp), "cannelloni:tcp:plant:7");
}

struct Wrong {
  const char* text;
  const char* error;
};
class WrongBusAddress : public testing::TestWithParam<Wrong> {};

TEST_P(WrongBusAddress, IsRefusedWithTheTextAndWhatWasExpected) {
  const auto address = parse_bus_address(GetParam().text);
  ASSERT_FALSE(address.has_value());
  EXPECT_EQ(address.error(), GetParam().error);
}

INSTANTIATE_TEST_SUITE_P(
    Texts, WrongBusAddress,
    testing::Values(
        Wrong{
            "",
            R"("" is not a bus; expected socketcand:HOST:PORT/BUS, socketcan:INTERFACE, slcan:DEVICE@BITRATE, udp-multicast:GROUP:PORT or cannelloni:HOST:PORT)"},
        Wrong{
            "can0",
            R"("can0" is not a bus; expected socketcand:HOST:PORT/BUS, socketcan:INTERFACE, slcan:DEVICE@BITRATE, udp-multicast:GROUP:PORT or cannelloni:HOST:PORT)"},
        Wrong{"socketcan:",
              R"("socketcan:" is not a bus; expected socketcan:INTERFACE, for example socketcan:can0)"},
        Wrong{
            "socketcan:an-interface-name",
            R"("socketcan:an-interface-name" is not a bus; expected socketcan:INTERFACE, for example socketcan:can0)"},
        Wrong{
            "slcan:",
            R"("slcan:" is not a bus; expected slcan:DEVICE@BITRATE or slcan:tcp:HOST:PORT@BITRATE, for example slcan:/dev/ttyACM0@250000)"},
        Wrong{"slcan:/dev/x@fast",
              R"("slcan:/dev/x@fast" is not a bus; expected a bit rate of 1 to 1000000 bit/s behind the @)"},
        Wrong{
            "slcan:/dev/x@2000000",
            R"("slcan:/dev/x@2000000" is not a bus; expected a bit rate of 1 to 1000000 bit/s behind the @)"},
        Wrong{
            "slcan:tcp:host",
            R"("slcan:tcp:host" is not a bus; expected slcan:DEVICE@BITRATE or slcan:tcp:HOST:PORT@BITRATE, for example slcan:/dev/ttyACM0@250000)"},
        Wrong{
            "udp-multicast:10.0.0.1",
            R"("udp-multicast:10.0.0.1" is not a bus; expected a multicast group: 224.0.0.0 to 239.255.255.255, or ff00::/8 in brackets)"},
        Wrong{
            "cannelloni:",
            R"("cannelloni:" is not a bus; expected cannelloni:HOST:PORT, cannelloni:HOST:PORT:OUR-PORT or cannelloni:tcp:HOST:PORT)"},
        Wrong{"cannelloni:h:1:x",
              R"("cannelloni:h:1:x" is not a bus; expected our port, 1 to 65535, behind the other side's)"},
        Wrong{"socketcand:host:1:2",
              R"("socketcand:host:1:2" is not a bus; expected a port of 1 to 65535 after the host)"},
        Wrong{"socketcand:host:0",
              R"("socketcand:host:0" is not a bus; expected a port of 1 to 65535 after the host)"},
        Wrong{"socketcand:host:65536",
              R"("socketcand:host:65536" is not a bus; expected a port of 1 to 65535 after the host)"},
        Wrong{"socketcand:host:29536/",
              R"("socketcand:host:29536/" is not a bus; expected the bus's name, one word, after the slash)"},
        Wrong{
            "socketcand:host:29536/a b",
            R"("socketcand:host:29536/a b" is not a bus; expected the bus's name, one word, after the slash)"},
        Wrong{
            "socketcand:host:29536/a>",
            R"("socketcand:host:29536/a>" is not a bus; expected the bus's name, one word, after the slash)"},
        Wrong{
            "socketcand:[::1",
            R"("socketcand:[::1" is not a bus; expected an IPv6 address in brackets, for example socketcand:[::1]:29536)"}));

}  // namespace
}  // namespace canopus::link::bus_address_test
