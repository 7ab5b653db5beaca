// Flying master [CiA 302-2; ME3CAN1-Q 4.8.10]: one node's frames.

#include "canopus/manager/nmt/flying_master.hpp"

#include <cstdlib>
#include <iostream>
#include <random>

#include <gmock/gmock.h>

#include "master_bench.hpp"

namespace canopus::manager::test::flying_master_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Node 1, level 1, as the ME3CAN1-Q's defaults.
class Flying : public MasterBench {
 public:
  Flying() { object(0x1F80, 0, 0x23); }
  /// Without the heartbeats.
  std::vector<std::string> frames() {
    std::vector<std::string> lines;
    for (const std::string& line : sent()) {
      if (line.find(" 701 ") == std::string::npos) lines.push_back(line);
    }
    return lines;
  }
};

TEST_F(Flying, NobodyAnswers_NetworkReset_Negotiation_ThenActive) {
  switch_on();
  run_until_ms(499);
  EXPECT_THAT(frames(), IsEmpty());
  run_until_ms(599);
  EXPECT_THAT(frames(), ElementsAre("500 073"));
  run_until_ms(2109);
  EXPECT_THAT(frames(), ElementsAre("600 000 82 00", "600 072"));
  EXPECT_FALSE(master.active());
  EXPECT_EQ(master.active_master(), 0);
  run_until_ms(2110);  // 1 x 1500 + 1 x 10
  EXPECT_THAT(frames(), ElementsAre("2110 071 01 01", "2110 000 82 00"));
  EXPECT_TRUE(master.active());
  EXPECT_EQ(master.active_master(), 1);
  run_until_ms(2700);
  EXPECT_THAT(frames(), ElementsAre("2610 000 01 00"));
}

TEST_F(Flying, HeartbeatIsProducedEverySecond_WhenNoneIsConfigured) {
  switch_on();
  run_until_ms(2050);
  EXPECT_THAT(only(sent(), " 701 "), ElementsAre("0 701 00", "1000 701 7F", "2000 701 7F"));
}

TEST_F(Flying, HeartbeatConfigured_StaysAsItIs) {
  object(0x1017, 0, 400);
  switch_on();
  run_until_ms(900);
  EXPECT_THAT(only(sent(), " 701 "), ElementsAre("0 701 00", "400 701 7F", "800 701 7F"));
}

TEST_F(Flying, BetterMasterAnswers_StandsBy_AndWatchesItsHeartbeat) {
  switch_on();
  run_until_ms(550);
  receive(can::data_frame(0x071, {0x00, 0x05}));
  EXPECT_EQ(master.active_master(), 5);
  EXPECT_FALSE(master.active());
  const auto entry = node.dictionary().get<std::uint32_t>(0x1016, 1);
  EXPECT_EQ(entry, 0x000505E6U);  // 1510 ms
  sent();
  run_until_ms(2000);
  EXPECT_THAT(frames(), IsEmpty());
  EXPECT_EQ(write(0x1F82, 2, 0x05, 1), AbortCode::device_state);
}

TEST_F(Flying, WatchedAlready_KeepsItsOwnConsumerTime) {
  object(0x1016, 3, 0x00050BB8);
  switch_on();
  run_until_ms(550);
  receive(can::data_frame(0x071, {0x00, 0x05}));
  EXPECT_EQ(node.dictionary().get<std::uint32_t>(0x1016, 1), 0U);
  sent();
  run_until_ms(3549);
  EXPECT_THAT(frames(), IsEmpty());
  run_until_ms(3550);
  EXPECT_THAT(frames(), ElementsAre("3550 000 82 00"));
}

TEST_F(Flying, WorseMasterAnswers_IsForcedToNegotiate) {
  switch_on();
  run_until_ms(550);
  sent();
  receive(can::data_frame(0x071, {0x01, 0x05}));
  EXPECT_THAT(frames(), ElementsAre("550 076", "550 072"));
  receive(can::data_frame(0x072));
  run_until_ms(2059);
  EXPECT_FALSE(master.active());
  run_until_ms(2060);
  EXPECT_TRUE(master.active());
}

TEST_F(Flying, BetterMasterIsFasterInTheNegotiation_StandsBy) {
  switch_on();
  run_until_ms(1000);
  receive(can::data_frame(0x071, {0x00, 0x7F}));
  run_until_ms(2400);
  EXPECT_FALSE(master.active());
  EXPECT_EQ(master.active_master(), 127);
}

TEST_F(Flying, ActiveMasterLost_ResetsTheNetwork_AndNegotiates) {
  switch_on();
  run_until_ms(550);
  receive(can::data_frame(0x071, {0x00, 0x05}));
  run_until_ms(2000);
  heartbeat(5, 0x05);
  sent();
  run_until_ms(3509);
  EXPECT_THAT(frames(), IsEmpty());
  run_until_ms(6000);
  EXPECT_THAT(frames(),
              ElementsAre("3510 000 82 00", "4010 073", "4110 072", "5620 071 01 01", "5620 000 82 00"));
  EXPECT_TRUE(master.active());
}

TEST_F(Flying, ActiveMasterWithoutHeartbeat_IsResetAgainAndAgain) {
  switch_on();
  run_until_ms(550);
  for (int i = 0; i < 5; ++i) {
    receive(can::data_frame(0x071, {0x00, 0x05}));
    sent();
    run_for(1510ms);
    EXPECT_EQ(commands().size(), 1U);
    run_for(550ms);
  }
}

TEST_F(Flying, Active_AnswersWhoAsks) {
  switch_on();
  run_until_ms(3000);
  sent();
  receive(can::data_frame(0x073));
  EXPECT_THAT(frames(), ElementsAre("3000 071 01 01"));
  receive(can::data_frame(0x075));
  EXPECT_THAT(frames(), ElementsAre("3000 074"));
}

TEST_F(Flying, Active_LooksForASecondActiveMasterEveryCycle) {
  switch_on();
  run_until_ms(3000);
  sent();
  run_until_ms(15000);
  EXPECT_THAT(only(sent(), " 076"), ElementsAre("6120 076", "10130 076", "14140 076"));
}

TEST_F(Flying, Active_ForcedToNegotiate_GivesTheRoleUpMeanwhile) {
  object(0x1F81, 2, 0x00640301);
  slave(2);
  switch_on();
  run_until_ms(3000);
  ASSERT_TRUE(master.guarding(2));
  sent();
  receive(can::data_frame(0x076));
  EXPECT_THAT(frames(), ElementsAre("3000 072"));
  EXPECT_FALSE(master.active());
  EXPECT_FALSE(master.guarding(2));
  run_until_ms(4509);
  EXPECT_FALSE(master.active());
  EXPECT_THAT(frames(), IsEmpty());
  run_until_ms(4510);
  EXPECT_TRUE(master.active());
  const auto lines = frames();
  EXPECT_EQ(lines[0], "4510 071 01 01");
  EXPECT_EQ(lines[1], "4510 000 82 00");
}

TEST_F(Flying, Active_HearsABetterOne_StandsBy) {
  switch_on();
  run_until_ms(3000);
  receive(can::data_frame(0x071, {0x00, 0x09}));
  EXPECT_FALSE(master.active());
  EXPECT_EQ(master.active_master(), 9);
}

TEST_F(Flying, WaitingTime_IsLevelTimesPrioritySlotPlusNodeIdTimesDeviceSlot) {
  class Nobody : public can::Sink, public FlyingMasterListener {
   public:
    bool send(const can::Frame&) override { return true; }
    void mastership_won(can::Time) override {}
    void mastership_lost(can::Time) override {}
    can::Duration standby_for(std::uint8_t, can::Time) override { return 1s; }
    void reset_all_nodes(can::Time) override {}
  } nobody;
  FlyingMaster flying(nobody, nobody);
  const std::vector<std::tuple<std::uint8_t, std::uint8_t, can::Duration>> rows{
      {std::uint8_t{0}, std::uint8_t{1}, 10ms},
      {std::uint8_t{1}, std::uint8_t{1}, 1510ms},
      {std::uint8_t{1}, std::uint8_t{127}, 2770ms},
      {std::uint8_t{2}, std::uint8_t{127}, 4270ms}};
  for (const auto& [level, id, expected] : rows) {
    FlyingMasterTiming timing;
    timing.level = level;
    flying.start(id, timing, now);
    EXPECT_EQ(flying.waiting_time(), expected);
  }
}

TEST_F(Flying, PriorityLevelAbove2_IsRefused) {
  switch_on();
  EXPECT_EQ(write(0x1F90, 3, 2, 2), AbortCode::none);
  EXPECT_EQ(write(0x1F90, 3, 3, 2), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1F90, 3, 0x100, 2), AbortCode::invalid_value);
}

TEST_F(Flying, KeepAliveSlaves_AreResetAllTheSame) {
  object(0x1F81, 2, 0x1D);
  slave(2);
  switch_on();
  run_until_ms(2112);
  EXPECT_THAT(commands(), ElementsAre("600 000 82 00", "2110 000 82 00"));
}

}  // namespace
}  // namespace canopus::manager::test::flying_master_test
