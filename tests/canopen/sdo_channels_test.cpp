#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::sdo_channels_test {
namespace {

DictionaryBuilder with_channels() {
  DictionaryBuilder b = standard_objects();
  for (const int number : {0x1201, 0x1202, 0x1280}) {
    const auto index = static_cast<std::uint16_t>(number);
    b.object(index, ObjectCode::record, "SDO parameter");
    b.sub(index, 1, {.value = little_endian(0x80000000, 4)});
    b.sub(index, 2, {.value = little_endian(0x80000000, 4)});
    b.sub(index, 3, {.type = DataType::unsigned8});
  }
  return b;
}

struct SdoChannelsTest : testing::Test, Conversation {
  SdoChannelsTest() : Conversation(with_channels()) {}
};

TEST_F(SdoChannelsTest, AdditionalServer_AnswersOnItsOwnIdentifiers) {
  EXPECT_FALSE(node.wants(0x6A0));
  EXPECT_EQ(write(0x1201, 1, 0x6A0, 4), AbortCode::none);
  EXPECT_FALSE(node.wants(0x6A0)) << "the other direction is still invalid";
  EXPECT_EQ(write(0x1201, 2, 0x6B0, 4), AbortCode::none);
  EXPECT_TRUE(node.wants(0x6A0));
  EXPECT_EQ(receive("6A0 40 18 10 01 00 00 00 00"), "6B0 43 18 10 01 D0 01 00 00");
}

TEST_F(SdoChannelsTest, SeveralClients_HaveTheirTransfersAtOnce) {
  write(0x1201, 1, 0x6A0, 4);
  write(0x1201, 2, 0x6B0, 4);
  receive("605 40 08 10 00 00 00 00 00");
  EXPECT_EQ(receive("6A0 40 08 10 00 00 00 00 00"), "6B0 41 08 10 00 09 00 00 00");
  EXPECT_EQ(receive("605 60 00 00 00 00 00 00 00"), "585 00 4D 45 33 43 41 4E 31");
  EXPECT_EQ(receive("6A0 60 00 00 00 00 00 00 00"), "6B0 00 4D 45 33 43 41 4E 31");
}

TEST_F(SdoChannelsTest, ServerSwitchedOffThroughItself_AnswersOnceMore) {
  write(0x1201, 1, 0x6A0, 4);
  write(0x1201, 2, 0x6B0, 4);
  EXPECT_EQ(receive("6A0 23 01 12 02 00 00 00 80"), "6B0 60 01 12 02 00 00 00 00");
  EXPECT_EQ(receive("6A0 40 18 10 01 00 00 00 00"), "");
}

TEST_F(SdoChannelsTest, IdentifierOfAValidChannel_CannotBeChanged) {
  write(0x1201, 1, 0x6A0, 4);
  EXPECT_EQ(write(0x1201, 1, 0x6A1, 4), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1201, 2, 0x585, 4), AbortCode::invalid_value) << "restricted";
  EXPECT_EQ(write(0x1201, 1, 0x80000000, 4), AbortCode::none);
}

TEST_F(SdoChannelsTest, ClientChannel_MayBeTheDefaultOfAServer) {
  EXPECT_FALSE(node.sdo_client_channel(0));
  EXPECT_EQ(write(0x1280, 1, 0x609, 4), AbortCode::none);
  EXPECT_EQ(write(0x1280, 2, 0x589, 4), AbortCode::none);
  EXPECT_EQ(write(0x1280, 2, 0x58A, 4), AbortCode::invalid_value) << "while valid";
  write(0x1280, 3, 9, 1);
  const auto channel = node.sdo_client_channel(0);
  ASSERT_TRUE(channel);
  EXPECT_EQ(channel->request, 0x609U);
  EXPECT_EQ(channel->response, 0x589U);
  EXPECT_EQ(channel->node_id, 9);
  EXPECT_EQ(write(0x1280, 1, 0x80000000, 4), AbortCode::none);
  EXPECT_EQ(write(0x1280, 1, 0x000, 4), AbortCode::invalid_value);
}

}  // namespace
}  // namespace canopus::canopen::sdo_channels_test
