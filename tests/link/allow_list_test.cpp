#include "canopus/link/allow_list.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::link::allow_list_test {
namespace {

using ::testing::HasSubstr;

InternetAddress address(std::string_view text) { return parse_internet_address(text).value(); }

AllowList list(std::initializer_list<std::string_view> networks) {
  std::vector<Network> all;
  for (const std::string_view network : networks) all.push_back(parse_network(network).value());
  return AllowList(std::move(all));
}

TEST(AllowList, Empty_AllowsThisMachineAlone) {
  const AllowList allowed;
  EXPECT_TRUE(allowed.allows(address("127.0.0.1")));
  EXPECT_TRUE(allowed.allows(address("127.1.2.3")));
  EXPECT_TRUE(allowed.allows(address("::1")));
  EXPECT_FALSE(allowed.allows(address("192.168.1.7")));
  EXPECT_FALSE(allowed.allows(address("fd00::7")));
}

TEST(AllowList, NetworkOfIpv4_AllowsItsAddressesAndNoOther) {
  const AllowList allowed = list({"192.168.0.0/23"});
  EXPECT_TRUE(allowed.allows(address("192.168.0.0")));
  EXPECT_TRUE(allowed.allows(address("192.168.1.255")));
  EXPECT_FALSE(allowed.allows(address("192.168.2.0")));
  EXPECT_FALSE(allowed.allows(address("192.167.255.255")));
  EXPECT_TRUE(allowed.allows(address("127.0.0.1")));
}

TEST(AllowList, Ipv4ClientOfAnIpv6Server_IsTheSameMachine) {
  EXPECT_TRUE(list({"192.168.1.0/24"}).allows(address("::ffff:192.168.1.7")));
  EXPECT_TRUE(AllowList().allows(address("::ffff:127.0.0.1")));
}

TEST(AllowList, NetworkOfIpv6_AllowsItsAddressesAndNoOther) {
  const AllowList allowed = list({"fd00:1234::/31"});
  EXPECT_TRUE(allowed.allows(address("fd00:1235:ffff::1")));
  EXPECT_FALSE(allowed.allows(address("fd00:1236::")));
}

TEST(AllowList, OneAddress_AllowsThatMachine) {
  const AllowList allowed = list({"10.0.0.7", "fd00::7"});
  EXPECT_TRUE(allowed.allows(address("10.0.0.7")));
  EXPECT_TRUE(allowed.allows(address("fd00::7")));
  EXPECT_FALSE(allowed.allows(address("10.0.0.8")));
  EXPECT_FALSE(allowed.allows(address("fd00::8")));
}

TEST(AllowList, PrefixZero_AllowsEverybodyOfItsKind) {
  EXPECT_TRUE(list({"0.0.0.0/0"}).allows(address("8.8.8.8")));
  EXPECT_FALSE(list({"0.0.0.0/0"}).allows(address("fd00::7")));
  EXPECT_TRUE(list({"::/0"}).allows(address("fd00::7")));
}

TEST(AllowList, WrongNetwork_IsAnErrorThatSaysWhatWasExpected) {
  const auto error = [](std::string_view text) { return parse_network(text).error(); };
  EXPECT_EQ(error("192.168.1.7/24"),
            "\"192.168.1.7/24\" has bits behind its prefix; expected 192.168.1.0/24, or 192.168.1.7 for one "
            "machine");
  EXPECT_EQ(error("192.168.1.0/33"), "\"192.168.1.0/33\": a network's prefix is 0 to 32");
  EXPECT_EQ(error("fd00::/129"), "\"fd00::/129\": a network's prefix is 0 to 128");
  for (const std::string_view prefix : {"/", "/-1", "/+8", "/8x", "/ 8", "/8/8"}) {
    SCOPED_TRACE(prefix);
    EXPECT_THAT(error("10.0.0.0" + std::string(prefix)), HasSubstr("a network's prefix is 0 to 32"));
  }
  constexpr std::string_view with_nul("127.0.0.1\0x", 11);
  for (const std::string_view text :
       {std::string_view(), with_nul, std::string_view("plc.local"), std::string_view("192.168.1"),
        std::string_view("192.168.1.256"), std::string_view("1.2.3.4:5007"), std::string_view("[fd00::7]")}) {
    SCOPED_TRACE(text);
    EXPECT_THAT(error(text), HasSubstr("is not an address; expected numbers such as 192.168.1.7 or fd00::7"));
  }
}

}  // namespace
}  // namespace canopus::link::allow_list_test
