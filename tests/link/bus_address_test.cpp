#include "canopus/link/bus_address.hpp"

#include <gtest/gtest.h>

namespace canopus::link {
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
        Wrong{"", R"("" is not a bus; expected socketcand:HOST:PORT/BUS or socketcan:INTERFACE)"},
        Wrong{"can0", R"("can0" is not a bus; expected socketcand:HOST:PORT/BUS or socketcan:INTERFACE)"},
        Wrong{"socketcan:",
              R"("socketcan:" is not a bus; expected socketcan:INTERFACE, for example socketcan:can0)"},
        Wrong{
            "socketcan:an-interface-name",
            R"("socketcan:an-interface-name" is not a bus; expected socketcan:INTERFACE, for example socketcan:can0)"},
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
}  // namespace canopus::link
