#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::sdo_server_test {
namespace {

TEST(SdoServer, ReadOfUpToFourBytes_IsAnsweredExpedited) {
  Conversation c;
  EXPECT_EQ(c.receive("605 40 18 10 01 00 00 00 00"), "585 43 18 10 01 D0 01 00 00");
  EXPECT_EQ(c.receive("605 40 21 20 00 00 00 00 00"), "585 4B 21 20 00 34 12 00 00");
  EXPECT_EQ(c.receive("605 40 09 10 00 00 00 00 00"), "585 47 09 10 00 31 2E 30 00");
  EXPECT_EQ(c.receive("605 40 18 10 00 00 00 00 00"), "585 4F 18 10 00 02 00 00 00");
}

TEST(SdoServer, ExpeditedWrite_IsConfirmedAndRead) {
  Conversation c;
  EXPECT_EQ(c.receive("605 2B 17 10 00 E8 03 00 00"), "585 60 17 10 00 00 00 00 00");
  EXPECT_EQ(c.receive("605 40 17 10 00 00 00 00 00"), "585 4B 17 10 00 E8 03 00 00");
}

TEST(SdoServer, ExpeditedWriteWithoutSize_TakesTheLengthOfTheObject) {
  Conversation c;
  EXPECT_EQ(c.receive("605 22 17 10 00 E8 03 FF FF"), "585 60 17 10 00 00 00 00 00");
  EXPECT_EQ(c.node.dictionary().get<std::uint16_t>(0x1017, 0), 1000);
}

TEST(SdoServer, LongValue_IsReadInSegments) {
  Conversation c;
  EXPECT_EQ(c.receive("605 40 08 10 00 00 00 00 00"), "585 41 08 10 00 09 00 00 00");
  EXPECT_EQ(c.receive("605 60 00 00 00 00 00 00 00"), "585 00 4D 45 33 43 41 4E 31");
  EXPECT_EQ(c.receive("605 70 00 00 00 00 00 00 00"), "585 1B 2D 51 00 00 00 00 00");
}

TEST(SdoServer, EmptyString_IsReadAsOneSegmentWithoutData) {
  Conversation c;
  EXPECT_EQ(c.receive("605 40 08 20 00 00 00 00 00"), "585 41 08 20 00 00 00 00 00");
  EXPECT_EQ(c.receive("605 60 00 00 00 00 00 00 00"), "585 0F 00 00 00 00 00 00 00");
}

TEST(SdoServer, SegmentedWrite_IsTakenOverAtTheLastSegmentOnly) {
  Conversation c;
  EXPECT_EQ(c.receive("605 21 16 20 00 08 00 00 00"), "585 60 16 20 00 00 00 00 00");
  EXPECT_EQ(c.receive("605 00 01 02 03 04 05 06 07"), "585 20 00 00 00 00 00 00 00");
  EXPECT_EQ(c.node.dictionary().get<std::uint64_t>(0x2016, 0), 0U);
  EXPECT_EQ(c.receive("605 1D 08 00 00 00 00 00 00"), "585 30 00 00 00 00 00 00 00");
  EXPECT_EQ(c.node.dictionary().get<std::uint64_t>(0x2016, 0), 0x0807060504030201U);
}

TEST(SdoServer, SegmentedWriteWithoutSize_EndsWithTheLastSegment) {
  Conversation c;
  EXPECT_EQ(c.receive("605 20 08 20 00 00 00 00 00"), "585 60 08 20 00 00 00 00 00");
  EXPECT_EQ(c.receive("605 09 48 61 6C 00 00 00 00"), "585 20 00 00 00 00 00 00 00");
  EXPECT_EQ(c.receive("605 40 08 20 00 00 00 00 00"), "585 47 08 20 00 48 61 6C 00");
}

TEST(SdoServer, AbortedSegmentedWrite_ChangesNothing) {
  Conversation c;
  c.receive("605 21 16 20 00 08 00 00 00");
  c.receive("605 00 01 02 03 04 05 06 07");
  EXPECT_EQ(c.receive("605 80 16 20 00 00 00 00 08"), "");
  EXPECT_EQ(c.node.dictionary().get<std::uint64_t>(0x2016, 0), 0U);
  EXPECT_EQ(c.receive("605 40 16 20 00 00 00 00 00"), "585 41 16 20 00 08 00 00 00");
}

TEST(SdoServer, WrongToggleBit_IsAborted) {
  Conversation c;
  c.receive("605 40 08 10 00 00 00 00 00");
  EXPECT_EQ(c.receive("605 70 00 00 00 00 00 00 00"), "585 80 08 10 00 00 00 03 05");
  c.receive("605 21 16 20 00 08 00 00 00");
  EXPECT_EQ(c.receive("605 10 01 02 03 04 05 06 07"), "585 80 16 20 00 00 00 03 05");
}

TEST(SdoServer, MissingObjectsAndAccessRights_HaveTheirAbortCodes) {
  Conversation c;
  EXPECT_EQ(c.receive("605 40 00 50 00 00 00 00 00"), "585 80 00 50 00 00 00 02 06");
  EXPECT_EQ(c.receive("605 40 18 10 03 00 00 00 00"), "585 80 18 10 03 11 00 09 06");
  EXPECT_EQ(c.receive("605 40 20 20 00 00 00 00 00"), "585 80 20 20 00 01 00 01 06");
  EXPECT_EQ(c.receive("605 23 00 10 00 00 00 00 00"), "585 80 00 10 00 02 00 01 06");
}

TEST(SdoServer, LengthAndLimits_AreChecked) {
  Conversation c;
  EXPECT_EQ(c.receive("605 23 17 10 00 E8 03 00 00"), "585 80 17 10 00 12 00 07 06");
  EXPECT_EQ(c.receive("605 2F 17 10 00 E8 00 00 00"), "585 80 17 10 00 13 00 07 06");
  EXPECT_EQ(c.receive("605 2B 22 20 00 65 00 00 00"), "585 80 22 20 00 31 00 09 06");
  EXPECT_EQ(c.receive("605 2B 22 20 00 9B FF 00 00"), "585 80 22 20 00 32 00 09 06");
  EXPECT_EQ(c.receive("605 2B 22 20 00 9C FF 00 00"), "585 60 22 20 00 00 00 00 00");
}

TEST(SdoServer, AnnouncedSizeThatDoesNotFit_IsAbortedAtOnce) {
  Conversation c;
  EXPECT_EQ(c.receive("605 21 16 20 00 09 00 00 00"), "585 80 16 20 00 12 00 07 06");
  EXPECT_EQ(c.receive("605 21 08 20 00 00 00 00 80"), "585 80 08 20 00 05 00 04 05");
}

TEST(SdoServer, MoreOrFewerBytesThanAnnounced_AreAborted) {
  Conversation c;
  c.receive("605 21 08 20 00 03 00 00 00");
  EXPECT_EQ(c.receive("605 07 41 42 43 44 00 00 00"), "585 80 08 20 00 12 00 07 06");
  c.receive("605 21 08 20 00 09 00 00 00");
  EXPECT_EQ(c.receive("605 07 41 42 43 44 00 00 00"), "585 80 08 20 00 13 00 07 06");
}

TEST(SdoServer, WhatDoesNotFitTheState_IsAborted) {
  Conversation c;
  EXPECT_EQ(c.receive("605 60 00 00 00 00 00 00 00"), "585 80 00 00 00 01 00 04 05");
  EXPECT_EQ(c.receive("605 00 01 02 03 04 05 06 07"), "585 80 00 00 00 01 00 04 05");
  EXPECT_EQ(c.receive("605 E0 01 02 03 04 05 06 07"), "585 80 00 00 00 01 00 04 05");
  c.receive("605 40 08 10 00 00 00 00 00");
  EXPECT_EQ(c.receive("605 40 00 10 00 00 00 00 00"), "585 80 08 10 00 01 00 04 05");
  EXPECT_EQ(c.receive("605 40 00 10 00 00 00 00 00"), "585 43 00 10 00 91 01 02 00");
}

TEST(SdoServer, ShortAndRemoteFrames_AreIgnored) {
  Conversation c;
  EXPECT_EQ(c.receive("605 40 18 10 01"), "");
  EXPECT_EQ(c.receive("605 R8"), "");
}

NodeOptions short_requests_count() {
  NodeOptions options;
  options.accepts_short_sdo_requests = true;
  return options;
}

TEST(SdoServer, ShortRequests_CountWhereADeviceAcceptsThem) {
  Conversation c(short_requests_count());
  EXPECT_EQ(c.receive("605 40 00 10 00"), "585 43 00 10 00 91 01 02 00");
  EXPECT_EQ(c.receive("605 40 00 10 00 00 00"), "585 43 00 10 00 91 01 02 00");
  EXPECT_EQ(c.receive("605 2B 17 10 00 E8 03"), "585 60 17 10 00 00 00 00 00");
  EXPECT_EQ(c.receive("605 40 17 10 00"), "585 4B 17 10 00 E8 03 00 00");
  EXPECT_EQ(c.receive("605 40 08 10 00"), "585 41 08 10 00 09 00 00 00");
  EXPECT_EQ(c.receive("605 60"), "585 00 4D 45 33 43 41 4E 31");
  EXPECT_EQ(c.receive("605 70"), "585 1B 2D 51 00 00 00 00 00");
  EXPECT_EQ(c.receive("605 21 08 20 00 02 00 00 00"), "585 60 08 20 00 00 00 00 00");
  EXPECT_EQ(c.receive("605 0B 41 42"), "585 20 00 00 00 00 00 00 00");
  EXPECT_EQ(c.receive("605 40 08 20 00"), "585 4B 08 20 00 41 42 00 00");
}

TEST(SdoServer, ShortRequests_WithoutTheBytesTheyNeed_AreIgnored) {
  Conversation c(short_requests_count());
  EXPECT_EQ(c.receive("605 40 00 10"), "") << "no sub-index";
  EXPECT_EQ(c.receive("605 2B 17 10 00 E8"), "") << "one of two bytes";
  EXPECT_EQ(c.receive("605 22 17 10 00 E8 03"), "") << "of a value of unknown size all four";
  EXPECT_EQ(c.receive("605 21 16 20 00 02"), "") << "half a size";
  EXPECT_EQ(c.receive("605 A4 08 10 00 7F"), "") << "blocks need whole frames";
  EXPECT_EQ(c.receive("605"), "");
  EXPECT_EQ(c.receive("605 40 17 10 00"), "585 4B 17 10 00 00 00 00 00") << "nothing was written";
}

TEST(SdoServer, SilentClient_IsAbortedAfterTheTimeOut) {
  Conversation c;
  c.receive("605 40 08 10 00 00 00 00 00");
  c.wait(600ms);
  c.receive("605 60 00 00 00 00 00 00 00");
  EXPECT_EQ(c.wait(2s), "1600: 585 80 08 10 00 00 00 04 05");
}

TEST(SdoServer, InStopped_NothingIsAnswered) {
  Conversation c;
  c.receive("000 02 05");
  EXPECT_EQ(c.receive("605 40 18 10 01 00 00 00 00"), "");
}

}  // namespace
}  // namespace canopus::canopen::sdo_server_test
