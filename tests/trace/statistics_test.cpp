#include "canopus/trace/report/statistics.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/can/frame_bits.hpp"

namespace canopus::trace::statistics_test {
namespace {

using can::data_frame;
using namespace std::chrono_literals;

class StatisticsTest : public testing::Test {
 protected:
  void receive(can::Duration at, std::uint32_t identifier, std::initializer_list<std::uint8_t> bytes) {
    const TraceRecord record{.time = can::Time(at), .frame = data_frame(identifier, bytes)};
    statistics.record(record, "can0");
    decoder.receive(record, "can0", take);
  }
  const ChannelFigures& finish() {
    decoder.finish(take);
    statistics.finish();
    return statistics.channels().at(0);
  }

  Decoder decoder{{}, {.frames = true}};
  Statistics statistics;
  Decoder::Sink take = [this](const Message& message) { statistics.message(message, decoder); };
};

TEST_F(StatisticsTest, CycleTimes_AreThoseBetweenFramesOfOneIdentifier) {
  for (const auto at : {0ms, 10ms, 22ms, 30ms}) {
    receive(at, 0x181, {1});
    receive(at + 1ms, 0x182, {1});
  }
  const IdentifierFigures& figures = finish().identifiers.at(0x181);
  EXPECT_EQ(figures.frames, 4U);
  EXPECT_EQ(figures.cycle.count(), 3U);
  EXPECT_EQ(figures.cycle.min(), 8ms);
  EXPECT_EQ(figures.cycle.mean(), 10ms);
  EXPECT_EQ(figures.cycle.max(), 12ms);
  EXPECT_EQ(figures.cycle.deviation(), 1632993ns);  // of 10, 12 and 8 ms: the root of 8/3
  EXPECT_EQ(figures.who, "TPDO1 of 1");
}

TEST_F(StatisticsTest, MalformedMessages_AreCountedByServiceAndByNode) {
  receive(0ms, 0x605, {0x2F, 0x00, 0x62, 0x01, 0x05});
  receive(1ms, 0x585, {0x60, 0x00, 0x62});
  receive(2ms, 0x000, {0x01});
  receive(3ms, 0x085, {0x00, 0x10, 0x01});
  receive(4ms, 0x705, {0x05});
  const ChannelFigures& channel = finish();
  EXPECT_EQ(statistics.malformed_services().at(static_cast<std::size_t>(Service::sdo)), 2U);
  EXPECT_EQ(statistics.malformed_services().at(static_cast<std::size_t>(Service::nmt)), 1U);
  EXPECT_EQ(statistics.malformed_services().at(static_cast<std::size_t>(Service::emcy)), 1U);
  EXPECT_EQ(statistics.malformed_services().at(static_cast<std::size_t>(Service::error_control)), 0U);
  EXPECT_EQ(channel.nodes.at(5).malformed, 3U);
  ASSERT_EQ(statistics.malformed().size(), 4U);
  EXPECT_EQ(statistics.malformed()[0].text, "605 sdo: 5 bytes, expected 8: 2F 00 62 01 05");
  EXPECT_EQ(statistics.malformed()[0].node, 5);
  EXPECT_EQ(statistics.malformed()[2].text, "000 nmt: 1 byte, expected 2: 01");
  EXPECT_EQ(statistics.malformed()[2].node, 0);
}

TEST_F(StatisticsTest, Bits_HaveStuffBitsAndIntermission) {
  receive(0ms, 0x123, {});
  receive(1s, 0x000, {0x00, 0x00});
  const ChannelFigures& channel = finish();
  EXPECT_EQ(channel.frames, 2U);
  const auto bits = [](const can::Frame& frame) { return can::frame_bits(frame) + 3U; };
  EXPECT_EQ(channel.bits, bits(data_frame(0x123)) + bits(data_frame(0x000, {0x00, 0x00})));
  EXPECT_EQ(channel.busiest_bits, bits(data_frame(0x000, {0x00, 0x00})));
  EXPECT_DOUBLE_EQ(load(100, 1s, 1000), 0.1);
  EXPECT_DOUBLE_EQ(load(100, 0s, 1000), 0);
}

TEST_F(StatisticsTest, LostHeartbeats_AreCountedByTheProducerTimeThatWasWritten) {
  receive(0ms, 0x605, {0x2B, 0x17, 0x10, 0x00, 100, 0, 0, 0});
  receive(1ms, 0x585, {0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0});
  for (const auto at : {100ms, 200ms, 300ms, 601ms, 700ms}) receive(at, 0x705, {0x05});
  receive(1000ms, 0x706, {0x05});  // the trace goes on: two more are missing
  const NodeFigures& node = finish().nodes.at(5);
  EXPECT_EQ(node.producer_time, 100ms);
  EXPECT_FALSE(node.producer_time_is_measured);
  EXPECT_EQ(node.heartbeats, 5U);
  EXPECT_EQ(node.lost_heartbeats, 2U + 2U);
}

TEST_F(StatisticsTest, ProducerTime_IsMeasuredWhereNobodySaysIt) {
  for (const auto at : {100ms, 200ms, 300ms, 400ms, 700ms, 800ms}) receive(at, 0x705, {0x05});
  const NodeFigures& node = finish().nodes.at(5);
  EXPECT_EQ(node.producer_time, 100ms);
  EXPECT_TRUE(node.producer_time_is_measured);
  EXPECT_EQ(node.lost_heartbeats, 2U);
}

TEST_F(StatisticsTest, NodeThatBoots_HasLostNoHeartbeat) {
  receive(0ms, 0x605, {0x2B, 0x17, 0x10, 0x00, 100, 0, 0, 0});
  receive(1ms, 0x585, {0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0});
  receive(100ms, 0x705, {0x05});
  receive(900ms, 0x705, {0x00});
  receive(1200ms, 0x705, {0x7F});  // its producer time may be another one now
  const NodeFigures& node = finish().nodes.at(5);
  EXPECT_EQ(node.boot_ups, 1U);
  EXPECT_EQ(node.lost_heartbeats, 0U);
}

TEST_F(StatisticsTest, SdoTransfers_AreCountedPerNodeWithTheirTimes) {
  receive(0ms, 0x605, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  receive(2ms, 0x585, {0x43, 0x00, 0x10, 0x00, 1, 0, 0, 0});
  receive(10ms, 0x605, {0x40, 0x01, 0x10, 0x00, 0, 0, 0, 0});
  receive(14ms, 0x585, {0x4F, 0x01, 0x10, 0x00, 1, 0, 0, 0});
  receive(20ms, 0x605, {0x2F, 0x00, 0x20, 0x00, 0, 0, 0, 0});
  receive(21ms, 0x585, {0x80, 0x00, 0x20, 0x00, 0x00, 0x00, 0x02, 0x06});
  receive(30ms, 0x605, {0x40, 0x02, 0x10, 0x00, 0, 0, 0, 0});
  const NodeFigures& node = finish().nodes.at(5);
  EXPECT_EQ(node.reads, 2U);
  EXPECT_EQ(node.writes, 1U);
  EXPECT_EQ(node.aborts, 1U);
  EXPECT_EQ(node.unanswered, 1U);
  EXPECT_EQ(node.sdo.min(), 2ms);
  EXPECT_EQ(node.sdo.mean(), 3ms);
  EXPECT_EQ(node.sdo.max(), 4ms);
  ASSERT_EQ(statistics.failures().size(), 2U);
  EXPECT_EQ(statistics.failures()[1].text, "1002:00 'Manufacturer status register' read: no answer");
}

TEST_F(StatisticsTest, Emergencies_AreListed) {
  receive(5ms, 0x085, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0});
  EXPECT_EQ(finish().nodes.at(5).emergencies, 1U);
  ASSERT_EQ(statistics.emergencies().size(), 1U);
  EXPECT_EQ(statistics.emergencies()[0].node, 5);
  EXPECT_EQ(statistics.services().at(static_cast<std::size_t>(Service::emcy)), 1U);
}

/// A scan asks all node-IDs: those that are not there are no failures of the network.
TEST_F(StatisticsTest, NodesThatAScanAsksInVain_AreCountedApart) {
  for (const unsigned node : {1U, 2U, 3U, 9U}) {
    receive(0ms, 0x600U + node, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
    if (node == 3) receive(1ms, 0x583, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x00, 0x00});
    if (node == 2)
      receive(200ms, 0x602, {0x80, 0x00, 0x10, 0x00, 0x00, 0x00, 0x04, 0x05});  // the time-out of a client
  }
  receive(300ms, 0x709, {0x05});
  receive(400ms, 0x604, {0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  const ChannelFigures& channel = finish();
  EXPECT_THAT(channel.absent, testing::ElementsAre(1, 2));
  EXPECT_FALSE(channel.nodes.contains(1));
  EXPECT_FALSE(channel.nodes.contains(2));
  EXPECT_EQ(channel.nodes.at(3).reads, 1U);
  EXPECT_EQ(channel.nodes.at(9).unanswered, 1U) << "it has a heartbeat: that it does not answer is a failure";
  EXPECT_EQ(channel.nodes.at(4).unanswered, 1U) << "not what a scan asks for";
  ASSERT_EQ(statistics.failures().size(), 2U);
}

}  // namespace
}  // namespace canopus::trace::statistics_test
