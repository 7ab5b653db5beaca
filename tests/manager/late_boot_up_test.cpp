// Boot-ups that come late or again, and what else happens to a network that starts [CiA 302-2; ME3CAN1-Q 4.8.6].

#include <gmock/gmock.h>

#include "master_bench.hpp"

namespace canopus::manager::test::late_boot_up_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::uint32_t optional = 0x05;   // assigned, boot slave
constexpr std::uint32_t mandatory = 0x0D;  // and mandatory

class LateBootUp : public MasterBench {};

TEST_F(LateBootUp, LateBootUp_WhileOperational_BootsAndStartsTheSlave) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2);
  switch_on();
  run_until_ms(3000);
  sent();
  receive(can::data_frame(0x702, {0x00}));
  EXPECT_EQ(master.node_state(2), 0x7F);
  EXPECT_TRUE(master.starting());
  run_for(1s);
  EXPECT_THAT(sent(), ElementsAre("3000 602 40 00 10 00 00 00 00 00", "3001 000 01 02"));
  EXPECT_FALSE(master.starting());
}

TEST_F(LateBootUp, LateBootUp_WhileTheMasterIsStopped_IsNotFollowed) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2);
  switch_on();
  run_until_ms(3000);
  node.command(canopen::NmtCommand::stop, now);
  sent();
  receive(can::data_frame(0x702, {0x00}));
  run_for(10s);
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(LateBootUp, BootUpOfAnUnassignedNode_IsOnlyShown) {
  object(0x1F80, 0, 0x01);
  switch_on();
  run_until_ms(3000);
  sent();
  receive(can::data_frame(0x709, {0x00}));
  run_for(10s);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(master.node_state(9), 0x7F);
}

TEST_F(LateBootUp, BootUpInTheMiddleOfTheBoot_BeginsAgain) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  object(0x1F85, 2, 0x71);
  ScriptedSlave& device = slave(2);
  device.objects[{0x1018, 1}] = {0x71, 0, 0, 0};
  device.answer_delay = 10ms;
  switch_on();
  run_until_ms(20);  // 1018:01 is being asked
  receive(can::data_frame(0x702, {0x00}));
  run_for(5s);
  EXPECT_EQ(only(sent(), " 602 40 00 10").size(), 2U);
  EXPECT_TRUE(std::count(events.begin(), events.end(), "booted 2") == 1);
}

TEST_F(LateBootUp, BootUpThatComesAfterAnAnswer_BelongsToTheReset_AndBeginsNothingAnew) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2).boot_up_delay = 3s;  // held up on a full bus
  switch_on();
  run_until_ms(10000);
  EXPECT_THAT(only(sent(), " 602 "), ElementsAre("1000 602 40 00 10 00 00 00 00 00"));
  receive(can::data_frame(0x702, {0x00}));  // the next one is a real one
  run_for(1s);
  EXPECT_THAT(sent(), ElementsAre("10000 602 40 00 10 00 00 00 00 00", "10001 000 01 02"));
}

TEST_F(LateBootUp, BootUpLongAfterTheReset_IsANewOne) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2).boots_up = false;
  switch_on();
  run_until_ms(10000);
  sent();
  receive(can::data_frame(0x702, {0x00}));
  run_for(1s);
  EXPECT_THAT(sent(), ElementsAre("10000 602 40 00 10 00 00 00 00 00", "10001 000 01 02"));
}

TEST_F(LateBootUp, ChannelInUseByTheApplication_IsTriedAgain) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2);
  channel_free = false;
  switch_on();
  run_until_ms(300);
  EXPECT_THAT(only(sent(), " 602 "), IsEmpty());
  channel_free = true;
  run_until_ms(400);
  EXPECT_THAT(only(sent(), " 602 "), ElementsAre("305 602 40 00 10 00 00 00 00 00"));
}

TEST_F(LateBootUp, TransmitQueueFull_CommandsAndRequestsComeLaterInOrder) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  slave(2);
  node.power_on(now);
  refuse_frames = 2;  // the reset is refused twice
  run_for(0ms);
  run_until_ms(100);
  EXPECT_THAT(commands(), ElementsAre("2 000 82 00", "8 000 01 02"));
}

TEST_F(LateBootUp, NmtInhibitTime_SeparatesCommands) {
  object(0x102A, 0, 100);  // 10 ms
  object(0x1F80, 0, 0x01);
  for (std::uint8_t id = 2; id <= 4; ++id) {
    object(0x1F81, id, mandatory);
    slave(id);
  }
  switch_on();
  run_for(1s);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00", "10 000 01 02", "20 000 01 03", "30 000 01 04"));
}

TEST_F(LateBootUp, ResetOfTheOwnCommunication_StartsTheNetworkAnew) {
  object(0x1F80, 0, 0x03);
  switch_on();
  run_until_ms(2000);
  sent();
  node.command(canopen::NmtCommand::reset_communication, now);
  EXPECT_FALSE(master.active());
  run_for(5s);
  EXPECT_THAT(sent(), ElementsAre("2000 701 00", "2000 000 82 00", "2500 000 01 00"));
  EXPECT_TRUE(master.active());
}

TEST_F(LateBootUp, Stop_IsSilentAndForgetsEverything) {
  object(0x1F80, 0, 0x01);
  object(0x1F81, 2, mandatory);
  absent_slave(2);
  switch_on();
  run_until_ms(1200);
  sent();
  master.stop(now);
  run_for(60s);
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(master.deadline(), can::never);
  EXPECT_EQ(master.node_state(2), 0);
}

TEST_F(LateBootUp, Boot126SlavesInParallel_AllAreStarted) {
  object(0x1F80, 0, 0x03);
  for (std::uint8_t id = 2; id <= 127; ++id) {
    object(0x1F81, id, mandatory);
    slave(id).answer_delay = std::chrono::milliseconds(id);
  }
  switch_on();
  run_until_ms(499);
  EXPECT_EQ(std::count_if(events.begin(), events.end(),
                          [](const std::string& event) { return event.starts_with("booted"); }),
            126);
  run_for(1s);
  EXPECT_THAT(commands(), ElementsAre("0 000 82 00", "500 000 01 00"));
}

}  // namespace
}  // namespace canopus::manager::test::late_boot_up_test
