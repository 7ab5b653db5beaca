#include "canopus/app/network_file.hpp"

#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::app {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

std::vector<std::string> errors_of(std::string_view text) {
  std::vector<std::string> lines;
  for (const PlantError& error : read_network(text, "n.toml").errors)
    lines.push_back(describe(error, "n.toml"));
  return lines;
}

TEST(NetworkFileText, SlaveAlone_GetsTheDefaults) {
  const NetworkReading reading = read_network("[[slave]]\nnode = 5\n", "n.toml");
  ASSERT_THAT(reading.errors, IsEmpty());
  EXPECT_EQ(reading.network.node, 127);
  EXPECT_TRUE(reading.network.start_slaves);
  EXPECT_FALSE(reading.network.boot_time.has_value());
  ASSERT_EQ(reading.network.slaves.size(), 1U);
  const NetworkSlave& slave = reading.network.slaves[0];
  EXPECT_EQ(slave.node, 5);
  EXPECT_TRUE(slave.mandatory);
  EXPECT_FALSE(slave.keep_alive);
  EXPECT_FALSE(slave.vendor.has_value());
  EXPECT_EQ(slave.guard_time, 0ms);
  EXPECT_EQ(slave.retry_factor, 3);
}

TEST(NetworkFileText, EveryKey_IsTaken) {
  const NetworkReading reading = read_network(R"(
name = "line"
[master]
node = 1
heartbeat = "1s"
boot_time = "10s"
start_slaves = false
[[slave]]
node = 2
name = "io"
mandatory = false
keep_alive = true
eds = "io.eds"
device_type = 0x191
vendor = 0x195
product = 1
revision = 0x10002
serial = 4
guard_time = "200ms"
retry_factor = 2
objects = { "1017:00" = 500, "2000" = "text" }
[[slave]]
node = 3
consumer_heartbeat_time = "1500ms"
)",
                                              "n.toml");
  ASSERT_THAT(reading.errors, IsEmpty());
  const NetworkFile& network = reading.network;
  EXPECT_EQ(network.name, "line");
  EXPECT_EQ(network.node, 1);
  EXPECT_EQ(network.heartbeat, 1s);
  EXPECT_EQ(network.boot_time, 10s);
  EXPECT_FALSE(network.start_slaves);
  ASSERT_EQ(network.slaves.size(), 2U);
  const NetworkSlave& slave = network.slaves[0];
  EXPECT_EQ(slave.name, "io");
  EXPECT_FALSE(slave.mandatory);
  EXPECT_TRUE(slave.keep_alive);
  EXPECT_EQ(slave.eds, "io.eds");
  EXPECT_EQ(slave.device_type, 0x191U);
  EXPECT_EQ(slave.vendor, 0x195U);
  EXPECT_EQ(slave.product, 1U);
  EXPECT_EQ(slave.revision, 0x10002U);
  EXPECT_EQ(slave.serial, 4U);
  EXPECT_EQ(slave.guard_time, 200ms);
  EXPECT_EQ(slave.retry_factor, 2);
  EXPECT_EQ(slave.objects.size(), 2U);
  EXPECT_EQ(network.slaves[1].consumer_heartbeat_time, 1500ms);
}

struct Wrong {
  const char* text;
  const char* error;
};
class WrongNetworkFile : public testing::TestWithParam<Wrong> {};

TEST_P(WrongNetworkFile, IsRefusedWithItsPlace) {
  EXPECT_THAT(errors_of(GetParam().text), ElementsAre(GetParam().error));
}

INSTANTIATE_TEST_SUITE_P(
    Keys, WrongNetworkFile,
    testing::Values(
        Wrong{"", "n.toml:1:1: there is no slave; expected at least one [[slave]]"},
        Wrong{"[[slave]]\nnode = 128\n", "n.toml:2:8: node = 128: a node-ID is 1 to 127"},
        Wrong{"[[slave]]\nnode = 127\n", "n.toml:1:1: node 127 is the master's own ([master] node)"},
        Wrong{"[[slave]]\nnode = 5\n[[slave]]\nnode = 5\n", "n.toml:3:1: node 5 is the slave of line 1, too"},
        Wrong{"[[slave]]\nnode = 5\nguard_time = \"70s\"\n",
              "n.toml:3:14: guard_time = \"70s\": expected whole milliseconds, at most 65535ms"},
        Wrong{"[[slave]]\nnode = 5\nguard_time = \"1s\"\nconsumer_heartbeat_time = \"1s\"\n",
              "n.toml:3:14: guard_time = \"1s\": a slave is watched by heartbeat or by guarding, not both"},
        Wrong{"[[slave]]\nnode = 5\nvendor = -1\n", "n.toml:3:10: vendor = -1: expected 0 to 0xFFFF_FFFF"},
        Wrong{"[[slave]]\nnode = 5\nobjects = { \"1017\" = 5 }\n",
              "n.toml:3:11: objects = a table: needs the device's eds, which says the objects' types"}));

TEST(NetworkFileText, UnknownKey_IsToldWithTheKnownOnes) {
  EXPECT_THAT(errors_of("[[slave]]\nnode = 5\nmandatroy = true\n"),
              ElementsAre(testing::StartsWith("n.toml:3:1: slave: unknown key mandatroy; expected one of ")));
}

TEST(NetworkFileText, SeveralMistakes_AreAllTold) {
  EXPECT_EQ(errors_of("[master]\nnode = 0\n[[slave]]\nnode = 0\nmandatory = 1\n").size(), 3U);
}

}  // namespace
}  // namespace canopus::app
