#include "canopus/client/bus_scan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/bus/scan_command.hpp"

#include "support/device_bus.hpp"

namespace canopus::cli::bus_scan_test {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;
using namespace std::chrono_literals;

class BusScanTest : public testing::Test {
 protected:
  std::vector<client::FoundNode> scan(std::uint8_t first = 1, std::uint8_t last = 127) {
    client::BusScan scan(bus.port, first, last, 100ms);
    bus.join(scan);
    scan.start(bus.now());
    const can::Time begin = bus.now();
    for (int step = 0; step < 1000 && !scan.finished(); ++step) bus.run_for(10ms);
    took = bus.now() - begin;
    EXPECT_TRUE(scan.finished());
    EXPECT_EQ(scan.asked(), scan.of());
    bus.port.disconnect();
    return scan.found();
  }
  support::DeviceBus bus;
  can::Duration took{};
};

TEST_F(BusScanTest, Node_IsFoundWithIdentityAndName) {
  bus.device(5, 200);
  const auto nodes = scan();
  ASSERT_EQ(nodes.size(), 1U);
  EXPECT_EQ(nodes[0].node_id, 5);
  EXPECT_TRUE(nodes[0].answers_sdo);
  EXPECT_EQ(nodes[0].device_type, 0U);
  EXPECT_EQ(nodes[0].vendor, 0U);
  EXPECT_EQ(nodes[0].product, 0x500U);
  EXPECT_EQ(nodes[0].revision, 0x10000U);
  EXPECT_EQ(nodes[0].serial, 7U);
  EXPECT_EQ(nodes[0].name, "Interop device");
  EXPECT_EQ(nodes[0].heartbeat_ms, 200U);
}

/// Node 5 answers every upload without the size of the value.
class NodeWithoutSizes final : public can::Participant {
 public:
  explicit NodeWithoutSizes(support::DeviceBus& bus) : port_(bus.bus.add_port("node without sizes")) {
    bus.timeline.add(*this);
    port_.connect(*this);
    port_.plug(true);
  }
  void receive(const can::Frame& frame, can::Time) override {
    if (frame.identifier != 0x605 || frame.data[0] != 0x40) return;
    (void)port_.send(
        can::data_frame(0x585, {0x42, frame.data[1], frame.data[2], frame.data[3], 0xC8, 0x00, 0xAA, 0xBB}));
  }
  void tick(can::Time) override {}

 private:
  sim::Port& port_;
};

TEST_F(BusScanTest, NodeThatIndicatesNoSize_IsReadByTheTypesOfItsObjects) {
  NodeWithoutSizes node(bus);
  const auto nodes = scan(5, 5);
  ASSERT_EQ(nodes.size(), 1U);
  EXPECT_EQ(nodes[0].heartbeat_ms, 200U) << "UNSIGNED16";
  EXPECT_EQ(nodes[0].guard_ms, 200U);
  EXPECT_EQ(nodes[0].vendor, 0xBBAA00C8U) << "UNSIGNED32";
}

TEST_F(BusScanTest, HeartbeatProducer_IsNotAskedByARemoteFrame) {
  bus.device(5, 2000).node().command(NmtCommand::start, {});
  bus.run_for(10ms);  // its boot-up message is over
  const auto nodes = scan(5, 5);
  ASSERT_EQ(nodes.size(), 1U);
  EXPECT_EQ(nodes[0].state, NmtState::operational);  // a node with 1017H does not answer guarding
}

TEST_F(BusScanTest, NodeWithoutHeartbeat_IsAskedByGuarding) {
  bus.device(5, 0).node().command(NmtCommand::start, {});
  bus.run_for(10ms);
  const auto nodes = scan(5, 5);
  ASSERT_EQ(nodes.size(), 1U);
  EXPECT_EQ(nodes[0].state, NmtState::operational);
}

TEST_F(BusScanTest, StoppedNode_IsOnlyHeard) {
  bus.device(5, 50).node().command(NmtCommand::stop, {});
  const auto nodes = scan(5, 5);
  ASSERT_EQ(nodes.size(), 1U);
  EXPECT_FALSE(nodes[0].answers_sdo);
  EXPECT_EQ(nodes[0].state, NmtState::stopped);
}

TEST_F(BusScanTest, NodesOutsideOfTheRange_AreNotFound) {
  bus.device(4, 50);
  bus.device(6, 50);
  EXPECT_TRUE(scan(5, 5).empty());
}

TEST_F(BusScanTest, EmptyBus_TakesEightTimeOuts) {
  bus.device(127, 50).node().command(NmtCommand::stop, {});  // somebody acknowledges
  (void)scan(1, 126);
  EXPECT_GE(took, 800ms);
  EXPECT_LE(took, 820ms);
}

/// The SDO requests on the bus.
class Requests final : public can::Participant {
 public:
  explicit Requests(support::DeviceBus& bus) : port_(bus.bus.add_port("recorder")) {
    bus.timeline.add(*this);
    port_.connect(*this);
    port_.plug(true);
  }
  void receive(const can::Frame& frame, can::Time) override {
    if ((frame.identifier & 0x780U) == 0x600) commands.push_back(frame.data[0]);
  }
  void tick(can::Time) override {}
  std::vector<std::uint8_t> commands;

 private:
  sim::Port& port_;
};

TEST_F(BusScanTest, NodesThatAreNotThere_GetOneFrameAndNoAbort) {
  Requests requests(bus);
  (void)scan(1, 126);
  EXPECT_EQ(requests.commands, std::vector<std::uint8_t>(126, 0x40));
}

std::string shown(const std::vector<client::FoundNode>& nodes, bool colour) {
  TextOutput out;
  for (const Line& line : scan_table(nodes, colour)) out.line(line);
  return out.text();
}

TEST(ScanTable, ShowsOneLinePerNode) {
  client::FoundNode node{.node_id = 5, .answers_sdo = true, .state = NmtState::operational};
  node.device_type = 0x191;
  node.name = "valve";
  const client::FoundNode silent{.node_id = 17, .state = NmtState::stopped};
  EXPECT_EQ(shown({node, silent}, false),
            "node  state            type      vendor    product   revision  serial    name\n"
            "   5  operational      00000191  -         -         -         -         valve\n"
            "  17  stopped          -         -         -         -         -         (no SDO answer)\n");
}

TEST(ScanTable, WithNames_HasThemBeforeThoseOfTheDevices) {
  client::FoundNode node{.node_id = 5, .answers_sdo = true, .state = NmtState::operational};
  node.name = "valve";
  const client::FoundNode other{.node_id = 17, .answers_sdo = true};
  TextOutput out;
  for (const Line& line : scan_table({node, other}, false, {{5, "inlet valve"}})) out.line(line);
  EXPECT_EQ(
      out.text(),
      "node  state            type      vendor    product   revision  serial    name         device name\n"
      "   5  operational      -         -         -         -         -         inlet valve  valve\n"
      "  17  unknown          -         -         -         -         -         -            -\n");
}

TEST(ScanTable, ColoursOnlyTheState) {
  const client::FoundNode node{.node_id = 5, .state = NmtState::operational};
  EXPECT_THAT(shown({node}, true), testing::HasSubstr("   5  \x1b[32moperational    \x1b[0m  -"));
}

TEST(ScanJson, LeavesOutWhatIsNotKnown) {
  client::FoundNode node{.node_id = 5, .answers_sdo = true};
  node.vendor = 0x195;
  EXPECT_EQ(scan_json(node).dump(), R"({"node":5,"answers_sdo":true,"vendor":405})");
}

TEST(ScanProgress, IsABarOfThirty) {
  EXPECT_EQ(scan_progress(0, 127, 0), "[------------------------------]   0 of 127 nodes asked, 0 found");
  EXPECT_EQ(scan_progress(64, 127, 3), "[###############---------------]  64 of 127 nodes asked, 3 found");
  EXPECT_EQ(scan_progress(127, 127, 4), "[##############################] 127 of 127 nodes asked, 4 found");
}

}  // namespace
}  // namespace canopus::cli::bus_scan_test
