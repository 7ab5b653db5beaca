#include "canopus/master/network_file.hpp"

#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::master::network_file_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

std::vector<std::string> errors_of(std::string_view text) {
  std::vector<std::string> lines;
  for (const text::FileError& error : read_network(text, "n.toml").errors)
    lines.push_back(describe(error, "n.toml"));
  return lines;
}

TEST(NetworkFileText, ThatIsTooDeep_IsRefusedWithItsLine) {
  std::string deep = "[[slave]]\nnode = 5\na";
  for (int i = 0; i < 40'000; ++i) deep += ".a";
  EXPECT_THAT(
      errors_of(deep + " = 1\n"),
      ElementsAre("n.toml:3:126: tables and arrays, or the parts of a key, are nested deeper than 64 levels; "
                  "expected at most 64"));
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
start_together = true
on_error = "stop all"
nmt_inhibit_time = "1500us"
block_from = 0
blocks_at_once = 5
program_attempts = 1
program_clear_attempts = 2
[master.times]
start_all_delay = "1ms"
wait_after_reset = "2ms"
presence_retry = "3ms"
guarding_probe = "4ms"
boot_up_timeout = "5ms"
late_boot_up = "6ms"
state_change_grace = "7ms"
flying_heartbeat = "8ms"
flying_consumer_time = "9ms"
program_timeout = "10ms"
program_poll = "11ms"
program_flash_limit = "12ms"
program_start_limit = "13ms"
[master.flying]
priority = 0
timeout = "20ms"
negotiation_delay = "21ms"
priority_slot = "260ms"
device_slot = "2ms"
detect_cycle = "23ms"
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
software_version = 0x22
program = "io.bin"
restore = 2
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
  EXPECT_TRUE(network.start_together);
  EXPECT_EQ(network.on_error, ErrorReaction::stop_all);
  EXPECT_EQ(network.nmt_inhibit_time, 1500us);
  const manager::MasterOptions& options = network.options;
  EXPECT_EQ(options.block_from, 0U);
  EXPECT_EQ(options.blocks_at_once, 5U);
  EXPECT_EQ(options.program_attempts, 1U);
  EXPECT_EQ(options.program_clear_attempts, 2U);
  EXPECT_THAT((std::array{options.start_all_delay, options.wait_after_reset, options.presence_retry,
                          options.guarding_probe, options.boot_up_time_out, options.late_boot_up,
                          options.state_change_grace, options.flying_heartbeat, options.flying_consumer_time,
                          options.program_time_out, options.program_poll, options.program_flash_limit,
                          options.program_start_limit}),
              ElementsAre(1ms, 2ms, 3ms, 4ms, 5ms, 6ms, 7ms, 8ms, 9ms, 10ms, 11ms, 12ms, 13ms));
  ASSERT_TRUE(network.flying.has_value());
  EXPECT_EQ(network.flying->level, 0);
  EXPECT_EQ(network.flying->time_out, 20ms);
  EXPECT_EQ(network.flying->negotiation_delay, 21ms);
  EXPECT_EQ(network.flying->priority_slot, 260ms);
  EXPECT_EQ(network.flying->device_slot, 2ms);
  EXPECT_EQ(network.flying->detect_cycle, 23ms);
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
  EXPECT_EQ(slave.software_version, 0x22U);
  EXPECT_EQ(slave.program, "io.bin");
  EXPECT_EQ(slave.restore, 2);
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
        Wrong{"", "n.toml:1:1: there is no slave; expected at least one [[slave]], or a project"},
        Wrong{"[[slave]]\nnode = 128\n", "n.toml:2:8: node = 128: a node-ID is 1 to 127"},
        Wrong{"[[slave]]\nnode = 127\n", "n.toml:1:1: node 127 is the master's own ([master] node)"},
        Wrong{"[[slave]]\nnode = 5\n[[slave]]\nnode = 5\n", "n.toml:3:1: node 5 is the slave of line 1, too"},
        Wrong{"[[slave]]\nnode = 5\nguard_time = \"70s\"\n",
              "n.toml:3:14: guard_time = \"70s\": expected whole milliseconds, at most 65535ms"},
        Wrong{"[[slave]]\nnode = 5\nguard_time = \"1s\"\nconsumer_heartbeat_time = \"1s\"\n",
              "n.toml:3:14: guard_time = \"1s\": a slave is watched by heartbeat or by guarding, not both"},
        Wrong{
            "[[slave]]\nnode = 5\nprogram = \"a.bin\"\n",
            "n.toml:3:11: program = \"a.bin\": needs software_version, other than 0: what the new program's "
            "1F56H reads"},
        Wrong{"[[slave]]\nnode = 5\nrestore = 0\n",
              "n.toml:3:11: restore = 0: expected a sub-index of 1011H, 1 to 127"},
        Wrong{"[master]\non_error = \"stop\"\n[[slave]]\nnode = 5\n",
              "n.toml:2:12: on_error = \"stop\": expected \"reset slave\", \"reset all\" or \"stop all\""},
        Wrong{"[master]\nnmt_inhibit_time = \"50us\"\n[[slave]]\nnode = 5\n",
              "n.toml:2:20: nmt_inhibit_time = \"50us\": expected whole 100us, at most 6553500us"},
        Wrong{"[master.flying]\npriority = 3\n[[slave]]\nnode = 5\n",
              "n.toml:2:12: priority = 3: expected 0 (high), 1 or 2 (low)"},
        Wrong{"[master.flying]\ndevice_slot = \"12ms\"\n[[slave]]\nnode = 5\n",
              "n.toml:1:1: [master.flying]: priority_slot is missing; expected more than 127 times "
              "device_slot, or priorities overlap"},
        Wrong{"[[slave]]\nnode = 5\nvendor = -1\n", "n.toml:3:10: vendor = -1: expected 0 to 0xFFFF_FFFF"},
        Wrong{"[[slave]]\nnode = 5\nobjects = { \"1017\" = 5 }\n",
              "n.toml:3:11: objects = a table: needs the device's eds, which says the objects' types"}));

TEST(NetworkFileText, UnknownKey_IsReportedWithTheNearestOne) {
  EXPECT_THAT(errors_of("[[slave]]\nnode = 5\nmandatroy = true\n"),
              ElementsAre("n.toml:3:1: slave: unknown key mandatroy; did you mean mandatory?"));
}

TEST(NetworkFileText, SeveralMistakes_AreAllTold) {
  EXPECT_EQ(errors_of("[master]\nnode = 0\n[[slave]]\nnode = 0\nmandatory = 1\n").size(), 3U);
}

// --- networks of CiA 306 projects

class NetworkOfAProject : public testing::Test {
 protected:
  NetworkOfAProject() {
    std::string name = (std::filesystem::temp_directory_path() / "canopus-network-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
    write("p.cpj",
          "[Topology]\nNodes=4\nNode1Present=1\nNode1Name=Master\nNode1DCFName=master.dcf\n"
          "Node2Present=1\nNode2Name=Encoder\nNode2DCFName=encoder.dcf\n"
          "Node5Present=1\nNode5Name=Drive\nNode5DCFName=drive.dcf\nNode9Present=0\nNode9DCFName=gone.dcf\n");
    write("master.dcf", "[DeviceComissioning]\nCANopenManager=1\n");
    write("encoder.dcf", "[DeviceComissioning]\n");
    write("drive.dcf", "[DeviceComissioning]\n");
  }
  ~NetworkOfAProject() override { std::filesystem::remove_all(folder_); }
  void write(const std::string& name, std::string_view text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  /// "master 127: 2 Encoder encoder.dcf, ..."
  static std::string shown(const NetworkReading& reading) {
    std::string text = fmt::format("master {}", reading.network.node);
    for (const NetworkSlave& slave : reading.network.slaves) {
      text +=
          fmt::format(", {} {} {}{}", slave.node, slave.name, slave.eds, slave.mandatory ? "" : " optional");
    }
    for (const text::FileError& error : reading.errors) text += "\n" + describe(error, "n.toml");
    return text;
  }
  [[nodiscard]] std::string read(std::string_view text) const {
    return shown(read_network(text, (folder_ / "n.toml").string()));
  }
  std::filesystem::path folder_;
};

TEST_F(NetworkOfAProject, NodesThatArePresent_AreSlaves_AndTheManagerIsTheMaster) {
  EXPECT_EQ(shown(read_project((folder_ / "p.cpj").string())),
            "master 1, 2 Encoder encoder.dcf, 5 Drive drive.dcf");
  EXPECT_EQ(read("project = \"p.cpj\"\n"), "master 1, 2 Encoder encoder.dcf, 5 Drive drive.dcf");
}

TEST_F(NetworkOfAProject, SlavesOfTheFile_GetTheirDcf_AndHaveWhatTheyHave) {
  EXPECT_EQ(read("project = \"p.cpj\"\n[master]\nnode = 100\n[[slave]]\nnode = 5\nmandatory = false\nobjects "
                 "= { \"1017\" = 5 }\n"
                 "[[slave]]\nnode = 7\n"),
            "master 100, 5 Drive drive.dcf optional, 7  , 1 Master master.dcf, 2 Encoder encoder.dcf");
}

TEST_F(NetworkOfAProject, WhatIsWrong_IsSaid) {
  EXPECT_THAT(read("project = \"none.cpj\"\n"), testing::HasSubstr("n.toml:1:11: cannot read "));
  write("empty.cpj", "[Topology]\nNodes=0\n");
  EXPECT_EQ(read("project = \"empty.cpj\"\n"),
            "master 127\nn.toml:1:1: there is no slave; expected at least one [[slave]], or a project");
  EXPECT_THAT(shown(read_project((folder_ / "none.cpj").string())),
              testing::HasSubstr("No such file or directory"));
}

}  // namespace
}  // namespace canopus::master::network_file_test
