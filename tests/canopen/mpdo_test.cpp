#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::mpdo_test {
namespace {

DictionaryBuilder with_lists() {
  DictionaryBuilder b = standard_objects();
  b.object(0x1FA0, ObjectCode::array, "scanner list");
  b.sub(0x1FA0, 0, {.type = DataType::unsigned8});
  for (std::uint8_t sub = 1; sub <= 4; ++sub) b.sub(0x1FA0, sub, {});
  b.object(0x1FD0, ObjectCode::array, "dispatching list");
  b.sub(0x1FD0, 0, {.type = DataType::unsigned8});
  for (std::uint8_t sub = 1; sub <= 4; ++sub) b.sub(0x1FD0, sub, {.type = DataType::unsigned64});
  return b;
}

struct MpdoTest : testing::Test, Conversation {
  MpdoTest() : Conversation(with_lists()) {}
  void set_up_mpdo(std::uint16_t communication, std::uint8_t addressing) {
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    ASSERT_EQ(write(mapping, 0, addressing, 1), AbortCode::none);
    const std::uint32_t cob_id = node.dictionary().get<std::uint32_t>(communication, 1) & 0x7FF;
    ASSERT_EQ(write(communication, 1, cob_id, 4), AbortCode::none);
  }
};

TEST_F(MpdoTest, DestinationAddressing_WritesTheConsumersObject) {
  set_up_mpdo(0x1400, 0xFF);
  start();
  drain_events();
  EXPECT_EQ(receive("205 85 00 62 03 AB 00 00 00"), "");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 3), 0xAB);
  receive("205 80 11 64 02 34 12 00 00");
  EXPECT_EQ(node.dictionary().get<std::uint16_t>(0x6411, 2), 0x1234);
  EXPECT_EQ(drain_events(), "rpdo 0, rpdo 0");
}

TEST_F(MpdoTest, DestinationAddressing_OfAnotherNodeIsIgnored) {
  set_up_mpdo(0x1400, 0xFF);
  start();
  EXPECT_EQ(receive("205 86 00 62 03 AB 00 00 00"), "");
  EXPECT_EQ(receive("205 05 00 62 03 AB 00 00 00"), "") << "source addressing";
  EXPECT_EQ(receive("205 85 00 62 03 AB 00 00"), "") << "too short";
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 3), 0);
}

TEST_F(MpdoTest, MissingDestination_IsReportedOnce) {
  set_up_mpdo(0x1400, 0xFF);
  start();
  EXPECT_EQ(receive("205 85 00 50 01 AB 00 00 00"), "085 30 82 11 00 00 00 00 00");
  EXPECT_EQ(receive("205 85 00 50 01 AB 00 00 00"), "");
  EXPECT_EQ(receive("205 85 00 62 03 AB 00 00 00"), "085 00 00 00 00 00 00 00 00");
}

TEST_F(MpdoTest, SourceAddressing_GoesWhereTheDispatchingListSays) {
  write(0x1FD0, 1, 0x02'6200'05'A000'01'09, 8);  // A000:01-02 of node 9 to 6200:05-06
  write(0x1FD0, 2, 0x00'6200'01'A100'01'08, 8);  // A100:01 of node 8 to 6200:01
  write(0x1FD0, 0, 2, 1);
  set_up_mpdo(0x1400, 0xFE);
  start();
  receive("205 09 00 A0 02 77 00 00 00");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 6), 0x77);
  receive("205 08 00 A1 01 66 00 00 00");
  EXPECT_EQ(node.dictionary().get<std::uint8_t>(0x6200, 1), 0x66);
  drain_events();
  EXPECT_EQ(receive("205 09 00 A0 03 55 00 00 00"), "");
  EXPECT_EQ(receive("205 08 00 A0 01 55 00 00 00"), "");
  EXPECT_EQ(drain_events(), "");
}

TEST_F(MpdoTest, Producer_SendsToADestination) {
  set_up_mpdo(0x1800, 0xFF);
  const std::uint8_t value[] = {0x34, 0x12};
  EXPECT_FALSE(node.send_destination_mpdo(0, 9, 0x6411, 2, value, now)) << "not in Operational";
  start();
  EXPECT_TRUE(node.send_destination_mpdo(0, 9, 0x6411, 2, value, now));
  EXPECT_EQ(bus.drain(), "185 89 11 64 02 34 12 00 00");
  EXPECT_FALSE(node.send_destination_mpdo(1, 9, 0x6411, 2, value, now));
}

TEST_F(MpdoTest, Producer_SendsObjectsOfItsScannerList) {
  write(0x1FA0, 1, 0x02600003, 4);  // 6000:03-04
  write(0x1FA0, 2, 0x00200400, 4);  // 2004:00
  write(0x1FA0, 0, 2, 1);
  set_up_mpdo(0x1800, 0xFE);
  start();
  node.dictionary().set(0x6000, 4, std::uint8_t{0xEE});
  EXPECT_TRUE(node.send_source_mpdo(0x6000, 4, now));
  EXPECT_EQ(bus.drain(), "185 05 00 60 04 EE 00 00 00");
  EXPECT_FALSE(node.send_source_mpdo(0x6000, 5, now));
  EXPECT_EQ(receive("605 2F 04 20 00 11 00 00 00"),
            "185 05 04 20 00 11 00 00 00 | 585 60 04 20 00 00 00 00 00");
}

TEST_F(MpdoTest, Conditions_AreChecked) {
  write(0x1800, 2, 1, 1);
  EXPECT_EQ(write(0x1A00, 0, 0xFF, 1), AbortCode::parameter_incompatible) << "synchronous";
  write(0x1800, 2, 0xFE, 1);
  EXPECT_EQ(write(0x1A00, 0, 0xFE, 1), AbortCode::none);
  EXPECT_EQ(write(0x1A01, 0, 0xFE, 1), AbortCode::parameter_incompatible) << "a second source";
  EXPECT_EQ(write(0x1A01, 0, 0xFF, 1), AbortCode::none);
}

}  // namespace
}  // namespace canopus::canopen::mpdo_test
