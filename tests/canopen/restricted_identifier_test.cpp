// CAN-IDs that CiA 301 restricts, as defaults of a dictionary (a device file, a stored value): no
// configurable service sends or hears on one [CiA 301 7.3.5]. What a write does:
// conformance/cia301/cob_id_test.cpp.

#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::restricted_identifier_test {
namespace {

/// standard_objects() with another default of one COB-ID.
DictionaryBuilder with_cob_id(std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
  DictionaryBuilder objects = standard_objects();
  EntrySpec spec{.name = "COB-ID", .value = little_endian(value, 4)};
  const bool is_variable = index == 0x1005 || index == 0x1012 || index == 0x1014;
  is_variable ? objects.variable(index, spec) : objects.sub(index, sub, spec);
  return objects;
}

TEST(RestrictedIdentifier, AnEmcyProducerDoesNotSendOnIt) {
  for (const std::uint32_t identifier : {0x000U, 0x085U - 0x80U, 0x180U, 0x585U, 0x605U, 0x705U, 0x7E5U}) {
    Conversation talk(with_cob_id(0x1014, 0, identifier));
    const std::uint8_t manufacturer[5] = {};
    EXPECT_TRUE(talk.node.emergency(0x1000, 0, manufacturer, talk.now));
    EXPECT_EQ(talk.bus.drain(), "") << identifier;
    EXPECT_EQ(talk.node.dictionary().get<std::uint32_t>(0x1014, 0), identifier);  // as the file has it
  }
}

TEST(RestrictedIdentifier, AnotherOneCanBeWrittenOverIt) {
  Conversation talk(with_cob_id(0x1014, 0, 0));
  EXPECT_EQ(talk.write(0x1014, 0, 0x85, 4), AbortCode::none);
  const std::uint8_t manufacturer[5] = {};
  EXPECT_TRUE(talk.node.emergency(0x1000, 0, manufacturer, talk.now));
  EXPECT_EQ(talk.bus.drain(), "085 00 10 01 00 00 00 00 00");
}

TEST(RestrictedIdentifier, ASyncConsumerDoesNotTakeAnNmtCommandForSync) {
  Conversation talk(with_cob_id(0x1005, 0, 0));
  talk.events.clear();
  talk.receive("000 01 05");
  EXPECT_EQ(talk.drain_events(), "operational");
  EXPECT_EQ(talk.node.dictionary().get<std::uint8_t>(0x1003, 0), 0);  // no SYNC of the wrong length, either
}

TEST(RestrictedIdentifier, ASyncProducerIsSilent) {
  DictionaryBuilder objects = with_cob_id(0x1005, 0, 0x4000'0000);
  objects.variable(0x1006, {.name = "period", .value = little_endian(10'000, 4)});
  Conversation talk(objects);
  EXPECT_EQ(talk.wait(100ms), "");
}

TEST(RestrictedIdentifier, ATimeConsumerDoesNotTakeAnotherServiceForTime) {
  Conversation talk(with_cob_id(0x1012, 0, 0x8000'0000));
  talk.receive("000 01 05 00 00 00 00");
  EXPECT_EQ(talk.drain_events().find("time"), std::string::npos);
  EXPECT_FALSE(talk.node.wants(0x180));
}

TEST(RestrictedIdentifier, ATimeProducerIsSilent) {
  Conversation talk(with_cob_id(0x1012, 0, 0x4000'0000));
  EXPECT_FALSE(talk.node.send_time({}, talk.now));
  EXPECT_EQ(talk.bus.drain(), "");
}

TEST(RestrictedIdentifier, AnEmcyConsumerDoesNotListenToIt) {
  DictionaryBuilder objects = standard_objects();
  objects.uniform(0x1028, ObjectCode::array, "emcy", 3, {.name = "emcy", .value = little_endian(0x712, 4)});
  Conversation talk(objects);
  EXPECT_FALSE(talk.node.wants(0x712));
}

TEST(RestrictedIdentifier, ATpdoIsNotSentOnIt) {
  DictionaryBuilder objects = with_cob_id(0x1800, 1, 0x4000'0000);
  objects.sub(0x1A00, 0, {.type = DataType::unsigned8, .value = {1}});
  objects.sub(0x1A00, 1, {.value = little_endian(0x60000108, 4)});
  Conversation talk(objects);
  talk.node.command(NmtCommand::start, talk.now);
  EXPECT_FALSE(talk.node.tpdo_event(0, talk.now));
  EXPECT_EQ(talk.bus.drain(), "");
  EXPECT_EQ(talk.write(0x1800, 1, 0x4000'0185, 4), AbortCode::none);
  EXPECT_TRUE(talk.node.tpdo_event(0, talk.now));
  EXPECT_EQ(talk.bus.drain(), "185 00");
}

TEST(RestrictedIdentifier, AnRpdoDoesNotListenToIt) {
  DictionaryBuilder objects = with_cob_id(0x1400, 1, 0);
  objects.sub(0x1600, 0, {.type = DataType::unsigned8, .value = {1}});
  objects.sub(0x1600, 1, {.value = little_endian(0x62000108, 4)});
  Conversation talk(objects);
  talk.receive("000 01 05");
  talk.receive("000 01 05");
  EXPECT_EQ(talk.node.dictionary().get<std::uint8_t>(0x6200, 1), 0);
}

TEST(RestrictedIdentifier, AnAdditionalSdoServerDoesNotAnswerOnIt) {
  DictionaryBuilder objects = standard_objects();
  objects.object(0x1201, ObjectCode::record, "server");
  objects.sub(0x1201, 1, {.value = little_endian(0x609, 4)});
  objects.sub(0x1201, 2, {.value = little_endian(0x589, 4)});
  Conversation talk(objects);
  EXPECT_EQ(talk.receive("609 40 00 10 00 00 00 00 00"), "");
}

TEST(RestrictedIdentifier, AnSdoClientUsesTheDefaultChannelOfAServerButNoOtherRestrictedOne) {
  DictionaryBuilder objects = standard_objects();
  for (const std::uint16_t index : {std::uint16_t{0x1280}, std::uint16_t{0x1281}}) {
    objects.object(index, ObjectCode::record, "client");
    objects.sub(index, 1, {.value = little_endian(index == 0x1280 ? 0x609 : 0, 4)});
    objects.sub(index, 2, {.value = little_endian(index == 0x1280 ? 0x589 : 0, 4)});
  }
  Conversation talk(objects);
  EXPECT_TRUE(talk.node.sdo_client_channel(0).has_value());
  EXPECT_FALSE(talk.node.sdo_client_channel(1).has_value());
}

}  // namespace
}  // namespace canopus::canopen::restricted_identifier_test
