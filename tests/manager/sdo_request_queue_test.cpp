#include "canopus/manager/sdo/sdo_request_queue.hpp"

#include <algorithm>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::manager::test::sdo_request_queue_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

class SdoLineTest : public testing::Test, public can::Sink {
 protected:
  bool send(const can::Frame& frame) override {
    if (accepts) sent.push_back(frame.identifier);
    return accepts;
  }
  bool request(std::uint32_t identifier) {
    can::Frame frame;
    frame.identifier = identifier;
    return line.send(frame, *this, now);
  }

  /// The controller has sent it.
  void gone(std::uint32_t identifier) { line.transmitted(identifier, *this, now); }
  /// From now on the line knows that it is told.
  void begin() { gone(0x67E); }

  SdoRequestQueue line;
  bool accepts = true;
  can::Time now{1s};
  std::vector<std::uint32_t> sent;
};

TEST_F(SdoLineTest, WithoutNewsOfTransmissions_RequestsGoStraightThrough) {
  for (std::uint32_t id = 0x67F; id > 0x600; --id) EXPECT_TRUE(request(id));
  EXPECT_EQ(sent.size(), 127U);
}

// Node-IDs decide on the bus, so that the controller has one at a time.
TEST_F(SdoLineTest, OneAtATime_InTheOrderTheyWereMade) {
  begin();
  for (const std::uint32_t id : {0x67F, 0x605, 0x602}) EXPECT_TRUE(request(id));
  EXPECT_THAT(sent, ElementsAre(0x67F));
  EXPECT_TRUE(line.waits(0x67F, now));  // the controller waits for the bus
  EXPECT_TRUE(line.waits(0x605, now));
  gone(0x67F);
  EXPECT_THAT(sent, ElementsAre(0x67F, 0x605));
  EXPECT_FALSE(line.waits(0x67F, now));
  gone(0x605);
  EXPECT_THAT(sent, ElementsAre(0x67F, 0x605, 0x602));
  gone(0x602);
  EXPECT_FALSE(line.waits(0x602, now));
}

TEST_F(SdoLineTest, RequestsOfOthers_AreNotTakenForItsOwn) {
  begin();
  for (const std::uint32_t id : {0x601, 0x602}) request(id);
  gone(0x604);  // a request of the application
  EXPECT_THAT(sent, ElementsAre(0x601));
  EXPECT_TRUE(line.waits(0x601, now));
}

TEST_F(SdoLineTest, ABlockFillsTheLineOnlyWhileNobodyElseWaits) {
  begin();
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(request(0x602));
  EXPECT_TRUE(request(0x603));   // gets in at once,
  EXPECT_FALSE(request(0x602));  // and node 2 has more than its share
  EXPECT_TRUE(request(0x603));
  EXPECT_FALSE(request(0x603));  // two are a node's share
  EXPECT_TRUE(line.send(can::data_frame(0x603, {0x80, 0, 0, 0, 0, 0, 0, 0}), *this, now));  // but an abort
  for (int i = 0; i < 100; ++i) gone(0x602);
  EXPECT_EQ(sent.size(), 101U);
  EXPECT_EQ(std::count(sent.begin(), sent.end(), 0x602U), 100);
  EXPECT_TRUE(request(0x603));  // alone in line again
}

TEST_F(SdoLineTest, AFullController_KeepsTheFirstOneFirst) {
  begin();
  for (const std::uint32_t id : {0x601, 0x602, 0x603}) request(id);
  accepts = false;
  gone(0x601);
  EXPECT_THAT(sent, ElementsAre(0x601));
  accepts = true;
  gone(0x604);  // there is room now
  EXPECT_THAT(sent, ElementsAre(0x601, 0x602));
  gone(0x602);
  EXPECT_THAT(sent, ElementsAre(0x601, 0x602, 0x603));
}

TEST_F(SdoLineTest, AStandstill_IsNotWaitedFor) {
  begin();
  for (const std::uint32_t id : {0x601, 0x602}) request(id);
  now += 101ms;
  EXPECT_FALSE(line.waits(0x602, now));  // its time-out counts
  EXPECT_TRUE(request(0x603));           // what the controller had is lost
  EXPECT_THAT(sent, ElementsAre(0x601, 0x602));
}

TEST_F(SdoLineTest, Clear_ForgetsEverything) {
  begin();
  for (const std::uint32_t id : {0x601, 0x602, 0x603}) request(id);
  line.clear();
  sent.clear();
  gone(0x601);
  EXPECT_THAT(sent, IsEmpty());
  EXPECT_TRUE(request(0x605));
  EXPECT_THAT(sent, ElementsAre(0x605));
}

TEST_F(SdoLineTest, NoRoom_IsSaid) {
  begin();
  unsigned taken = 0;
  while (request(0x601) && taken < 1000) ++taken;
  EXPECT_EQ(taken, 1U + 512U);
}

}  // namespace
}  // namespace canopus::manager::test::sdo_request_queue_test
