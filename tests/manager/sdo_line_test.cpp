#include "canopus/manager/sdo_line.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::manager::test {
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

  SdoLine line;
  bool accepts = true;
  can::Time now{1s};
  std::vector<std::uint32_t> sent;
};

TEST_F(SdoLineTest, WithoutNewsOfTransmissions_RequestsGoStraightThrough) {
  for (std::uint32_t id = 0x67F; id > 0x600; --id) EXPECT_TRUE(request(id));
  EXPECT_EQ(sent.size(), 127U);
}

TEST_F(SdoLineTest, TwoAtOnce_TheOthersInTheOrderTheyWereMade) {
  line.transmitted(*this, now);
  for (const std::uint32_t id : {0x67F, 0x605, 0x610, 0x602}) EXPECT_TRUE(request(id));
  EXPECT_THAT(sent, ElementsAre(0x67F, 0x605));
  EXPECT_TRUE(line.waits(0x602, now));
  EXPECT_FALSE(line.waits(0x605, now));
  line.transmitted(*this, now);
  EXPECT_THAT(sent, ElementsAre(0x67F, 0x605, 0x610));
  line.transmitted(*this, now);
  EXPECT_THAT(sent, ElementsAre(0x67F, 0x605, 0x610, 0x602));
  EXPECT_FALSE(line.waits(0x602, now));
}

TEST_F(SdoLineTest, AFullController_KeepsTheFirstOneFirst) {
  line.transmitted(*this, now);
  for (const std::uint32_t id : {0x601, 0x602, 0x603, 0x604}) request(id);
  accepts = false;
  line.transmitted(*this, now);
  accepts = true;
  line.transmitted(*this, now);
  EXPECT_THAT(sent, ElementsAre(0x601, 0x602, 0x603, 0x604));
}

TEST_F(SdoLineTest, AStandstill_IsNotWaitedFor) {
  line.transmitted(*this, now);
  for (const std::uint32_t id : {0x601, 0x602, 0x603}) request(id);
  now += 101ms;
  EXPECT_FALSE(line.waits(0x603, now));  // its time-out counts
  EXPECT_TRUE(request(0x604));           // what the controller had is lost
  EXPECT_THAT(sent, ElementsAre(0x601, 0x602, 0x603, 0x604));
}

TEST_F(SdoLineTest, Clear_ForgetsEverything) {
  line.transmitted(*this, now);
  for (const std::uint32_t id : {0x601, 0x602, 0x603}) request(id);
  line.clear();
  sent.clear();
  line.transmitted(*this, now);
  EXPECT_THAT(sent, IsEmpty());
}

TEST_F(SdoLineTest, NoRoom_IsSaid) {
  line.transmitted(*this, now);
  unsigned taken = 0;
  while (request(0x601) && taken < 1000) ++taken;
  EXPECT_EQ(taken, 2U + 256U);
}

}  // namespace
}  // namespace canopus::manager::test
