#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::tpdo_test {
namespace {

constexpr std::uint16_t tpdo1 = 0x1800;

struct TpdoTest : testing::Test, Conversation {
  void set_input(std::uint8_t value) { node.dictionary().set(0x6000, 1, value); }
};
struct TpdoDismissTest : testing::Test, Conversation {
  TpdoDismissTest() : Conversation(NodeOptions{.dismiss_events_during_inhibit = true}) {}
};

TEST_F(TpdoTest, EnteringOperational_SendsEventDrivenTpdosOnce) {
  set_up(tpdo1, {0x60000108, 0x64010110}, 0xFF);
  node.dictionary().set(0x6401, 1, std::int16_t{-2});
  node.command(NmtCommand::start, now);
  EXPECT_EQ(bus.drain(), "185 00 FE FF");
}

TEST_F(TpdoTest, ChangedValues_AreSentOnce) {
  set_up(tpdo1, {0x60000108}, 0xFE);
  start();
  set_input(7);
  EXPECT_EQ(node.values_changed(now), 1U);
  EXPECT_EQ(bus.drain(), "185 07");
  EXPECT_EQ(node.values_changed(now), 0U);
  EXPECT_EQ(bus.drain(), "");
}

TEST_F(TpdoTest, OutsideOperational_NothingIsSent) {
  set_up(tpdo1, {0x60000108}, 0xFE);
  EXPECT_FALSE(node.tpdo_event(0, now));
  start();
  node.command(NmtCommand::enter_pre_operational, now);
  EXPECT_FALSE(node.tpdo_event(0, now));
  EXPECT_EQ(bus.drain(), "");
}

TEST_F(TpdoTest, EventDuringInhibitTime_WaitsForItsEnd) {
  write(tpdo1, 3, 100, 2);  // 10 ms
  set_up(tpdo1, {0x60000108}, 0xFE);
  start();
  wait(4ms);
  set_input(1);
  node.values_changed(now);
  set_input(2);
  EXPECT_EQ(wait(50ms), "10: 185 02");
}

TEST_F(TpdoDismissTest, EventDuringInhibitTime_IsForgotten) {
  write(tpdo1, 3, 100, 2);
  set_up(tpdo1, {0x60000108}, 0xFE);
  start();
  wait(4ms);
  EXPECT_FALSE(node.tpdo_event(0, now));
  EXPECT_EQ(wait(50ms), "");
  EXPECT_TRUE(node.tpdo_event(0, now));
}

TEST_F(TpdoTest, EventTimer_StartsAnewWithEachTransmission) {
  write(tpdo1, 5, 20, 2);
  set_up(tpdo1, {0x60000108}, 0xFE);
  start();
  EXPECT_EQ(wait(45ms), "20: 185 00 | 40: 185 00");
  node.tpdo_event(0, now);
  EXPECT_EQ(bus.drain(), "185 00");
  EXPECT_EQ(wait(45ms), "65: 185 00 | 85: 185 00");
}

TEST_F(TpdoTest, EventTimerShorterThanInhibitTime_SendsWhenTheInhibitTimeEnds) {
  write(tpdo1, 3, 500, 2);
  write(tpdo1, 5, 20, 2);
  set_up(tpdo1, {0x60000108}, 0xFE);
  start();
  EXPECT_EQ(wait(100ms), "50: 185 00 | 100: 185 00");
}

TEST_F(TpdoDismissTest, EventTimerDuringInhibitTime_SendsNothing) {
  write(tpdo1, 3, 500, 2);
  write(tpdo1, 5, 20, 2);
  set_up(tpdo1, {0x60000108}, 0xFE);
  start();
  EXPECT_EQ(wait(70ms), "60: 185 00");
}

TEST_F(TpdoTest, EventTimer_CanBeChangedWhileValid) {
  set_up(tpdo1, {0x60000108}, 0xFE);
  start();
  EXPECT_EQ(write(tpdo1, 5, 10, 2), AbortCode::none);
  EXPECT_EQ(wait(25ms), "10: 185 00 | 20: 185 00");
  EXPECT_EQ(write(tpdo1, 5, 0, 2), AbortCode::none);
  EXPECT_EQ(wait(25ms), "");
}

TEST_F(TpdoTest, CyclicSynchronous_IsSentAtEveryNthSync) {
  set_up(tpdo1, {0x60000108}, 3);
  start();
  EXPECT_EQ(receive("080"), "");
  EXPECT_EQ(receive("080"), "");
  EXPECT_EQ(receive("080"), "185 00");
  EXPECT_EQ(receive("080"), "");
}

TEST_F(TpdoTest, AcyclicSynchronous_NeedsAnEventBeforeTheSync) {
  set_up(tpdo1, {0x60000108}, 0);
  start();
  EXPECT_EQ(receive("080"), "");
  set_input(9);
  EXPECT_EQ(node.values_changed(now), 1U);
  EXPECT_EQ(bus.drain(), "");
  EXPECT_EQ(receive("080"), "185 09");
  EXPECT_EQ(receive("080"), "");
}

TEST_F(TpdoTest, SyncStartValue_IsTheCounterOfTheFirstTransmission) {
  write(0x1019, 0, 10, 1);
  write(tpdo1, 6, 4, 1);
  set_up(tpdo1, {0x60000108}, 2);
  start();
  EXPECT_EQ(receive("080 02"), "");
  EXPECT_EQ(receive("080 03"), "");
  EXPECT_EQ(receive("080 04"), "185 00");
  EXPECT_EQ(receive("080 05"), "");
  EXPECT_EQ(receive("080 06"), "185 00");
}

TEST_F(TpdoTest, SyncStartValueWithoutCounter_HasNoEffect) {
  write(tpdo1, 6, 4, 1);
  set_up(tpdo1, {0x60000108}, 1);
  start();
  EXPECT_EQ(receive("080"), "185 00");
}

TEST_F(TpdoTest, RtrOnly_IsSentOnRemoteFrames) {
  set_up(tpdo1, {0x60000108}, 0xFD);
  start();
  set_input(5);
  EXPECT_EQ(receive("185 R"), "185 05");
  EXPECT_EQ(receive("080"), "");
}

TEST_F(TpdoTest, RtrOnlySynchronous_SendsTheValuesOfTheLastSync) {
  set_up(tpdo1, {0x60000108}, 0xFC);
  start();
  set_input(5);
  EXPECT_EQ(receive("080"), "");
  set_input(6);
  EXPECT_EQ(receive("185 R1"), "185 05");
}

TEST_F(TpdoTest, WithBit30_RemoteFramesAreNotAnswered) {
  set_up(tpdo1, {0x60000108}, 0xFE);
  start();
  EXPECT_EQ(receive("185 R"), "");
}

TEST_F(TpdoTest, Booleans_ArePackedBitByBit) {
  set_up(tpdo1, {0x60200101, 0x60200201, 0x60200301, 0x60000108, 0x60200401}, 0xFE);
  node.dictionary().set(0x6020, 1, std::uint8_t{1});
  node.dictionary().set(0x6020, 3, std::uint8_t{1});
  node.dictionary().set(0x6020, 4, std::uint8_t{1});
  node.dictionary().set(0x6000, 1, std::uint8_t{0xFF});
  node.command(NmtCommand::start, now);
  EXPECT_EQ(bus.drain(), "185 FD 0F");
}

TEST_F(TpdoTest, WriteThroughSdo_IsAnEvent) {
  set_up(tpdo1, {0x65000040}, 0xFE);
  start();
  receive("605 21 00 65 00 08 00 00 00");
  receive("605 00 01 02 03 04 05 06 07");
  EXPECT_EQ(receive("605 1D 08 00 00 00 00 00 00"),
            "185 01 02 03 04 05 06 07 08 | 585 30 00 00 00 00 00 00 00");
}

TEST_F(TpdoTest, ExtendedIdentifier_IsUsed) {
  write(0x1A00, 1, 0x60000108, 4);
  write(0x1A00, 0, 1, 1);
  ASSERT_EQ(write(tpdo1, 1, 0x60012345, 4), AbortCode::none);
  node.command(NmtCommand::start, now);
  EXPECT_EQ(bus.drain(), "00012345 00");
}

TEST_F(TpdoTest, SynchronousTpdos_CarryTheValuesBeforeTheRpdosOfTheSameSync) {
  set_up(tpdo1, {0x65000040}, 1);
  set_up(0x1400, {0x65000040}, 1);
  start();
  receive("205 01 00 00 00 00 00 00 00");
  EXPECT_EQ(receive("080"), "185 00 00 00 00 00 00 00 00");
  EXPECT_EQ(receive("080"), "185 01 00 00 00 00 00 00 00");
}

TEST(Tpdo, Bit30_CanBeConstant) {
  Conversation c(NodeOptions{.tpdo_rtr_bit_is_constant = true});
  EXPECT_EQ(c.receive("605 40 00 18 01 00 00 00 00"), "585 43 00 18 01 85 01 00 C0");
  EXPECT_EQ(c.receive("605 23 00 18 01 85 01 00 00"), "585 60 00 18 01 00 00 00 00");
  EXPECT_EQ(c.receive("605 40 00 18 01 00 00 00 00"), "585 43 00 18 01 85 01 00 40");
}

TEST(Tpdo, InhibitTime_CanCountInMilliseconds) {
  Conversation c(NodeOptions{.inhibit_time_resolution = 1ms});
  c.write(tpdo1, 3, 3, 2);  // 0.3 ms acts as 1 ms
  c.set_up(tpdo1, {0x60000108}, 0xFE);
  c.start();
  c.node.tpdo_event(0, c.now);
  EXPECT_EQ(c.wait(5ms), "1: 185 00");
}

TEST_F(TpdoTest, FullTransmitQueue_KeepsTheChange) {
  set_up(tpdo1, {0x60000108}, 0xFE);
  start();
  set_input(3);
  bus.is_full = true;
  EXPECT_EQ(node.values_changed(now), 0U);
  bus.is_full = false;
  EXPECT_EQ(node.values_changed(now), 1U);
  EXPECT_EQ(bus.drain(), "185 03");
}

// A TPDO that is valid with nothing mapped has nothing to say, in whatever way it is asked.
TEST_F(TpdoTest, WithNothingMapped_IsNotSent) {
  for (const std::uint64_t type : {0x00, 0x01, 0xFC, 0xFE, 0xFF}) {
    node.command(NmtCommand::enter_pre_operational, now);
    write(tpdo1, 1, 0x8000'0185, 4);
    write(tpdo1, 2, type, 1);
    write(tpdo1, 5, 10, 2);
    EXPECT_EQ(write(tpdo1, 1, 0x185, 4), AbortCode::none);
    bus.drain();
    node.command(NmtCommand::start, now);
    EXPECT_EQ(bus.drain(), "") << type;
    EXPECT_FALSE(node.tpdo_event(0, now)) << type;
    EXPECT_EQ(receive("080"), "") << type;
    EXPECT_EQ(receive("185 R"), "") << type;
    EXPECT_EQ(wait(100ms), "") << type;
  }
}

TEST_F(TpdoTest, WithNothingMapped_IsSentOnceItIsMapped) {
  write(tpdo1, 1, 0x4000'0185, 4);
  start();
  write(tpdo1, 1, 0xC000'0185, 4);
  write(0x1A00, 1, 0x6000'0108, 4);
  write(0x1A00, 0, 1, 1);
  write(tpdo1, 1, 0x4000'0185, 4);
  bus.drain();
  EXPECT_TRUE(node.tpdo_event(0, now));
  EXPECT_EQ(bus.drain(), "185 00");
}

}  // namespace
}  // namespace canopus::canopen::tpdo_test
