#include <deque>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/canopen/sdo/sdo_crc.hpp"

#include "canopen/conversation.hpp"
#include "canopen/megabytes.hpp"

namespace canopus::canopen::sdo_block_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(SdoCrc, CheckValue_IsThatOfTheStandard) {
  EXPECT_EQ(sdo::crc16(0, text("123456789")), 0x31C3);
  EXPECT_EQ(sdo::crc16(0, text("0123456789")), 0x9C58);
}

RC_GTEST_PROP(SdoCrc, EqualsTheBitByBitDivision, (const Bytes& bytes)) {
  std::uint32_t remainder = 0;
  for (const std::uint8_t byte : bytes) {
    for (int bit = 7; bit >= 0; --bit) {
      const std::uint32_t feedback = (remainder >> 15 ^ byte >> bit) & 1U;
      remainder = (remainder << 1 & 0xFFFF) ^ (feedback != 0 ? 0x1021U : 0U);
    }
  }
  RC_ASSERT(sdo::crc16(0, bytes) == remainder);
}

struct SdoBlockServer : testing::Test, Conversation {
  std::string domain() {
    const auto value = node.dictionary().read(0x200A, 0, now);
    return {value->begin(), value->end()};
  }
  void set_domain(std::string_view value) {
    node.dictionary().assign(node.dictionary().description().find(0x200A, 0), text(value));
  }
};

TEST_F(SdoBlockServer, Download_OfTenBytes) {
  EXPECT_EQ(receive("605 C6 0A 20 00 0A 00 00 00"), "585 A4 0A 20 00 7F 00 00 00");
  EXPECT_EQ(receive("605 01 30 31 32 33 34 35 36"), "");
  EXPECT_EQ(receive("605 82 37 38 39 00 00 00 00"), "585 A2 02 7F 00 00 00 00 00");
  EXPECT_EQ(receive("605 D1 58 9C 00 00 00 00 00"), "585 A1 00 00 00 00 00 00 00");
  EXPECT_EQ(domain(), "0123456789");
}

TEST_F(SdoBlockServer, DownloadWithWrongCrc_IsAbortedAndChangesNothing) {
  receive("605 C6 0A 20 00 0A 00 00 00");
  receive("605 01 30 31 32 33 34 35 36");
  receive("605 82 37 38 39 00 00 00 00");
  EXPECT_EQ(receive("605 D1 59 9C 00 00 00 00 00"), "585 80 0A 20 00 04 00 04 05");
  EXPECT_EQ(domain(), "");
}

TEST_F(SdoBlockServer, DownloadWithoutCrc_DoesNotLookAtIt) {
  receive("605 C0 0A 20 00 00 00 00 00");
  receive("605 81 30 31 32 00 00 00 00");
  EXPECT_EQ(receive("605 D1 00 00 00 00 00 00 00"), "585 A1 00 00 00 00 00 00 00");
  EXPECT_EQ(domain(), "012");
}

TEST_F(SdoBlockServer, LostSegment_IsAskedForAgain) {
  receive("605 C4 0A 20 00 00 00 00 00");
  receive("605 01 30 31 32 33 34 35 36");
  EXPECT_EQ(receive("605 83 45 46 47 00 00 00 00"), "585 A2 01 7F 00 00 00 00 00");
  receive("605 01 37 38 39 41 42 43 44");
  EXPECT_EQ(receive("605 82 45 46 47 00 00 00 00"), "585 A2 02 7F 00 00 00 00 00");
  receive("605 80 0A 20 00 00 00 00 08");
}

TEST_F(SdoBlockServer, FirstSegmentLost_ConfirmsNone) {
  receive("605 C4 0A 20 00 00 00 00 00");
  EXPECT_EQ(receive("605 82 37 38 39 00 00 00 00"), "585 A2 00 7F 00 00 00 00 00");
}

TEST_F(SdoBlockServer, LostLastSegment_IsConfirmedAfterAPause) {
  receive("605 C4 0A 20 00 00 00 00 00");
  receive("605 01 30 31 32 33 34 35 36");
  EXPECT_EQ(wait(2s), "250: 585 A2 01 7F 00 00 00 00 00 | 1000: 585 80 0A 20 00 00 00 04 05");
}

TEST_F(SdoBlockServer, SequenceNumbersOutOfRange_AreAborted) {
  receive("605 C4 0A 20 00 00 00 00 00");
  EXPECT_EQ(receive("605 00 30 31 32 33 34 35 36"), "585 80 0A 20 00 03 00 04 05");
}

TEST_F(SdoBlockServer, AbortAmongSegments_IsAnAbort) {
  receive("605 C4 0A 20 00 00 00 00 00");
  EXPECT_EQ(receive("605 80 0A 20 00 00 00 00 08"), "");
  EXPECT_EQ(receive("605 01 30 31 32 33 34 35 36"), "585 80 00 00 00 01 00 04 05");
}

TEST_F(SdoBlockServer, DownloadOfAnotherSizeThanAnnounced_IsAborted) {
  receive("605 C2 0A 20 00 0B 00 00 00");
  receive("605 01 30 31 32 33 34 35 36");
  receive("605 82 37 38 39 00 00 00 00");
  EXPECT_EQ(receive("605 D1 00 00 00 00 00 00 00"), "585 80 0A 20 00 13 00 07 06");
  receive("605 C2 0A 20 00 09 00 00 00");
  receive("605 01 30 31 32 33 34 35 36");
  receive("605 82 37 38 39 00 00 00 00");
  EXPECT_EQ(receive("605 D1 00 00 00 00 00 00 00"), "585 80 0A 20 00 12 00 07 06");
}

TEST_F(SdoBlockServer, Upload_OfTenBytes) {
  set_domain("0123456789");
  EXPECT_EQ(receive("605 A4 0A 20 00 7F 00 00 00"), "585 C6 0A 20 00 0A 00 00 00");
  EXPECT_EQ(receive("605 A3 00 00 00 00 00 00 00"),
            "585 01 30 31 32 33 34 35 36 | 585 82 37 38 39 00 00 00 00");
  EXPECT_EQ(receive("605 A2 02 7F 00 00 00 00 00"), "585 D1 58 9C 00 00 00 00 00");
  EXPECT_EQ(receive("605 A1 00 00 00 00 00 00 00"), "");
  EXPECT_EQ(receive("605 40 18 10 01 00 00 00 00"), "585 43 18 10 01 D0 01 00 00");
}

TEST_F(SdoBlockServer, UploadWithoutCrc_HasCrcZero) {
  set_domain("012");
  receive("605 A0 0A 20 00 7F 00 00 00");
  receive("605 A3 00 00 00 00 00 00 00");
  EXPECT_EQ(receive("605 A2 01 7F 00 00 00 00 00"), "585 D1 00 00 00 00 00 00 00");
}

TEST_F(SdoBlockServer, Upload_GoesOnAfterTheSegmentThatIsConfirmed) {
  set_domain("0123456789ABCDEFGHIJ");
  receive("605 A0 0A 20 00 02 00 00 00");
  EXPECT_EQ(receive("605 A3 00 00 00 00 00 00 00"),
            "585 01 30 31 32 33 34 35 36 | 585 02 37 38 39 41 42 43 44");
  EXPECT_EQ(receive("605 A2 01 03 00 00 00 00 00"),
            "585 01 37 38 39 41 42 43 44 | 585 82 45 46 47 48 49 4A 00");
  EXPECT_EQ(receive("605 A2 00 01 00 00 00 00 00"), "585 01 37 38 39 41 42 43 44");
  EXPECT_EQ(receive("605 A2 01 01 00 00 00 00 00"), "585 81 45 46 47 48 49 4A 00");
  EXPECT_EQ(receive("605 A2 01 01 00 00 00 00 00"), "585 C5 00 00 00 00 00 00 00");
}

TEST_F(SdoBlockServer, EmptyValue_IsOneSegmentWithoutData) {
  EXPECT_EQ(receive("605 A4 0A 20 00 7F 00 00 00"), "585 C6 0A 20 00 00 00 00 00");
  EXPECT_EQ(receive("605 A3 00 00 00 00 00 00 00"), "585 81 00 00 00 00 00 00 00");
  EXPECT_EQ(receive("605 A2 01 7F 00 00 00 00 00"), "585 DD 00 00 00 00 00 00 00");
}

TEST_F(SdoBlockServer, ValueWithinTheSwitchThreshold_IsUploadedWithoutBlocks) {
  set_domain("0123");
  EXPECT_EQ(receive("605 A4 0A 20 00 7F 04 00 00"), "585 43 0A 20 00 30 31 32 33");
  set_domain("01234");
  EXPECT_EQ(receive("605 A4 0A 20 00 7F 05 00 00"), "585 41 0A 20 00 05 00 00 00");
  EXPECT_EQ(receive("605 60 00 00 00 00 00 00 00"), "585 05 30 31 32 33 34 00 00");
}

TEST_F(SdoBlockServer, InvalidBlockSizes_AreAborted) {
  set_domain("0123456789");
  EXPECT_EQ(receive("605 A4 0A 20 00 00 00 00 00"), "585 80 0A 20 00 02 00 04 05");
  EXPECT_EQ(receive("605 A4 0A 20 00 80 00 00 00"), "585 80 0A 20 00 02 00 04 05");
  receive("605 A4 0A 20 00 7F 00 00 00");
  receive("605 A3 00 00 00 00 00 00 00");
  EXPECT_EQ(receive("605 A2 02 00 00 00 00 00 00"), "585 80 0A 20 00 02 00 04 05");
}

TEST_F(SdoBlockServer, ConfirmationOfMoreThanWasSent_IsAborted) {
  set_domain("0123456789");
  receive("605 A4 0A 20 00 7F 00 00 00");
  receive("605 A3 00 00 00 00 00 00 00");
  EXPECT_EQ(receive("605 A2 03 7F 00 00 00 00 00"), "585 80 0A 20 00 03 00 04 05");
}

TEST_F(SdoBlockServer, FullTransmitQueue_GoesOnLater) {
  set_domain("0123456789");
  receive("605 A4 0A 20 00 7F 00 00 00");
  bus.is_full = true;
  EXPECT_EQ(receive("605 A3 00 00 00 00 00 00 00"), "");
  wait(1ms);
  bus.is_full = false;
  EXPECT_EQ(wait(1ms), "1.5: 585 01 30 31 32 33 34 35 36 | 1.5: 585 82 37 38 39 00 00 00 00");
}

TEST_F(SdoBlockServer, StreamThatRefuses_AbortsTheTransfer) {
  Megabytes stream(10, true);
  stream.refusal = AbortCode::hardware_error;
  node.attach(0x200A, 0x200A, stream);
  receive("605 21 0A 20 00 0A 00 00 00");
  receive("605 00 00 07 0E 15 1C 23 2A");
  EXPECT_EQ(receive("605 19 31 38 3F 00 00 00 00"), "585 80 0A 20 00 00 00 06 06");
  EXPECT_EQ(stream.closed, "incomplete ");
}

TEST_F(SdoBlockServer, AbortedStream_IsClosedIncomplete) {
  Megabytes stream(10, true);
  node.attach(0x200A, 0x200A, stream);
  receive("605 21 0A 20 00 0A 00 00 00");
  receive("605 80 0A 20 00 00 00 00 08");
  EXPECT_EQ(stream.closed, "incomplete ");
}

TEST_F(SdoBlockServer, StreamOfUnknownSize_IsUploadedWithoutSize) {
  Megabytes stream(10, false);
  node.attach(0x200A, 0x200A, stream);
  EXPECT_EQ(receive("605 40 0A 20 00 00 00 00 00"), "585 40 0A 20 00 00 00 00 00");
  EXPECT_EQ(receive("605 60 00 00 00 00 00 00 00"), "585 00 00 07 0E 15 1C 23 2A");
  EXPECT_EQ(receive("605 70 00 00 00 00 00 00 00"), "585 19 31 38 3F 00 00 00 00");
  EXPECT_EQ(stream.closed, "complete ");
}

TEST_F(SdoBlockServer, SmallStream_GoesExpedited) {
  Megabytes stream(3, true);
  node.attach(0x200A, 0x200A, stream);
  EXPECT_EQ(receive("605 40 0A 20 00 00 00 00 00"), "585 47 0A 20 00 00 07 0E 00");
  EXPECT_EQ(receive("605 27 0A 20 00 00 07 0E 00"), "585 60 0A 20 00 00 00 00 00");
  EXPECT_TRUE(stream.is_right);
  EXPECT_EQ(stream.closed, "complete complete ");
}

}  // namespace
}  // namespace canopus::canopen::sdo_block_test
