// SDO transfers folded into one line: frames written byte by byte [CiA 301 7.2.4.3].

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/trace/decode/decoder.hpp"

namespace canopus::trace::sdo_transfers_test {
namespace {

using can::data_frame;
using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

class SdoTransfers : public testing::Test {
 protected:
  void request(std::initializer_list<std::uint8_t> bytes) { receive(0x605, bytes); }
  void answer(std::initializer_list<std::uint8_t> bytes) { receive(0x585, bytes); }
  void receive(std::uint32_t identifier, std::initializer_list<std::uint8_t> bytes) {
    now += 250us;
    decoder.receive({.time = now, .frame = data_frame(identifier, bytes)}, "can0", sink);
  }
  std::vector<std::string> lines() {
    std::vector<std::string> all;
    for (const Message& message : messages) all.push_back(message.text);
    messages.clear();
    return all;
  }

  Decoder decoder;
  can::Time now{};
  std::vector<Message> messages;
  Decoder::Sink sink = [this](const Message& message) { messages.push_back(message); };
};

TEST_F(SdoTransfers, ExpeditedWrite_IsOneLineWithItsUnit) {
  request({0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0});
  EXPECT_THAT(lines(), IsEmpty());
  answer({0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0});
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].duration, 250us);
  EXPECT_EQ(messages[0].time, now);
  EXPECT_THAT(lines(), ElementsAre("1017:00 'Producer heartbeat time' write: 1000 ms (UNSIGNED16, 0.2 ms)"));
}

TEST_F(SdoTransfers, ExpeditedReadOfAnUnknownObject_HasItsBytes) {
  request({0x40, 0x00, 0x20, 0x05, 0, 0, 0, 0});
  answer({0x4B, 0x00, 0x20, 0x05, 0x34, 0x12, 0, 0});
  EXPECT_THAT(lines(), ElementsAre("2000:05 read: 1234H (2 bytes, 0.2 ms)"));
}

TEST_F(SdoTransfers, ExpeditedWithoutLength_HasThatOfItsType) {
  request({0x22, 0x17, 0x10, 0x00, 0xE8, 0x03, 0x55, 0x66});
  answer({0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_THAT(lines(), ElementsAre("1017:00 'Producer heartbeat time' write: 1000 ms (UNSIGNED16, 0.2 ms)"));
}

TEST_F(SdoTransfers, CobIdAndMapping_AreShownAsTheirFields) {
  request({0x23, 0x00, 0x18, 0x01, 0x85, 0x01, 0x00, 0x80});
  answer({0x60, 0x00, 0x18, 0x01, 0, 0, 0, 0});
  request({0x23, 0x00, 0x1A, 0x01, 0x08, 0x01, 0x00, 0x60});
  answer({0x60, 0x00, 0x1A, 0x01, 0, 0, 0, 0});
  EXPECT_THAT(lines(), ElementsAre("1800:01 'TPDO1 COB-ID' write: 80000185H (UNSIGNED32, 0.2 ms)",
                                   "1A00:01 'TPDO1 mapping' write: 6000:01, 8 bits (UNSIGNED32, 0.2 ms)"));
}

TEST_F(SdoTransfers, SegmentedRead_IsOneLine) {
  request({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  answer({0x41, 0x08, 0x10, 0x00, 9, 0, 0, 0});
  request({0x60, 0, 0, 0, 0, 0, 0, 0});
  answer({0x00, 'M', 'E', '3', 'C', 'A', 'N', '1'});
  request({0x70, 0, 0, 0, 0, 0, 0, 0});
  answer({0x1B, '-', 'Q', 0, 0, 0, 0, 0});
  EXPECT_THAT(
      lines(),
      ElementsAre(
          "1008:00 'Manufacturer device name' read: \"ME3CAN1-Q\" (VISIBLE_STRING, 9 bytes, 1.2 ms)"));
}

TEST_F(SdoTransfers, SegmentedWrite_IsOneLineAndSaysWhenTheAnnouncedLengthIsAnother) {
  request({0x21, 0x00, 0x20, 0x00, 10, 0, 0, 0});
  answer({0x60, 0x00, 0x20, 0x00, 0, 0, 0, 0});
  request({0x00, 1, 2, 3, 4, 5, 6, 7});
  answer({0x20, 0, 0, 0, 0, 0, 0, 0});
  request({0x1B, 8, 9, 0, 0, 0, 0, 0});
  answer({0x30, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(lines(),
              ElementsAre("2000:00 write: 01 02 03 04 05 06 07 08 09 (9 bytes, 1.2 ms); 10 bytes announced"));
}

TEST_F(SdoTransfers, BlockDownload_IsOneLine) {
  request({0xC6, 0x50, 0x1F, 0x01, 0x0A, 0, 0, 0});
  answer({0xA4, 0x50, 0x1F, 0x01, 0x7F, 0, 0, 0});
  request({0x01, 0x30, 0x31, 0x32, 0x33, 0x34, 0x35, 0x36});
  request({0x82, 0x37, 0x38, 0x39, 0, 0, 0, 0});
  answer({0xA2, 0x02, 0x7F, 0, 0, 0, 0, 0});
  request({0xD1, 0x58, 0x9C, 0, 0, 0, 0, 0});
  answer({0xA1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(lines(),
              ElementsAre("1F50:01 'Program data' write: 30 31 32 33 34 35 36 37 38 39 (DOMAIN, 10 bytes, "
                          "block transfer, 1.5 ms)"));
}

TEST_F(SdoTransfers, BlockUploadWithARepeatedSegment_CountsItOnce) {
  request({0xA4, 0x00, 0x20, 0x00, 0x7F, 0, 0, 0});
  answer({0xC6, 0x00, 0x20, 0x00, 0x0A, 0, 0, 0});
  request({0xA3, 0, 0, 0, 0, 0, 0, 0});
  answer({0x01, 1, 2, 3, 4, 5, 6, 7});
  answer({0x82, 8, 9, 10, 0, 0, 0, 0});
  request({0xA2, 0x01, 0x7F, 0, 0, 0, 0, 0});  // the second one was lost on the way to the client
  answer({0x81, 8, 9, 10, 0, 0, 0, 0});
  request({0xA2, 0x01, 0x7F, 0, 0, 0, 0, 0});
  answer({0xD1, 0x12, 0x34, 0, 0, 0, 0, 0});
  request({0xA1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(lines(),
              ElementsAre("2000:00 read: 01 02 03 04 05 06 07 08 09 0A (10 bytes, block transfer, 2.2 ms)"));
}

TEST_F(SdoTransfers, BlockSegmentsBehindALostOne_DoNotCount) {
  request({0xC2, 0x00, 0x20, 0x00, 21, 0, 0, 0});
  answer({0xA0, 0x00, 0x20, 0x00, 0x7F, 0, 0, 0});
  request({0x01, 1, 1, 1, 1, 1, 1, 1});
  request({0x83, 3, 3, 3, 3, 3, 3, 3});  // the second one is not in the trace
  answer({0xA2, 0x01, 0x7F, 0, 0, 0, 0, 0});
  request({0x01, 2, 2, 2, 2, 2, 2, 2});
  request({0x82, 3, 3, 3, 3, 3, 3, 3});
  answer({0xA2, 0x02, 0x7F, 0, 0, 0, 0, 0});
  request({0xC1, 0, 0, 0, 0, 0, 0, 0});
  answer({0xA1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(lines(),
              ElementsAre("2000:00 write: 01 01 01 01 01 01 01 02 02 02 02 02 02 02 03 03 03 03 03 03 03 "
                          "(21 bytes, block transfer, 2.2 ms)"));
}

TEST_F(SdoTransfers, BlockSegmentThatIsSentTwice_CountsOnce) {
  request({0xC2, 0x00, 0x20, 0x00, 14, 0, 0, 0});
  answer({0xA0, 0x00, 0x20, 0x00, 0x7F, 0, 0, 0});
  request({0x01, 1, 1, 1, 1, 1, 1, 1});
  request({0x01, 1, 1, 1, 1, 1, 1, 1});
  request({0x82, 2, 2, 2, 2, 2, 2, 2});
  answer({0xA2, 0x02, 0x7F, 0, 0, 0, 0, 0});
  request({0xC1, 0, 0, 0, 0, 0, 0, 0});
  answer({0xA1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(
      lines(),
      ElementsAre("2000:00 write: 01 01 01 01 01 01 01 02 02 02 02 02 02 02 (14 bytes, block transfer, "
                  "1.8 ms)"));
}

TEST_F(SdoTransfers, BlockSegmentThatLooksLikeARequest_IsASegment) {
  request({0xC2, 0x00, 0x20, 0x00, 0xC8, 0x01, 0, 0});  // 456 bytes
  answer({0xA0, 0x00, 0x20, 0x00, 0x7F, 0, 0, 0});
  for (std::uint8_t number = 1; number <= 66; ++number) {  // 40H would be an upload request
    request({static_cast<std::uint8_t>(number == 66 ? 0xC2 : number), 0, 0, 0, 0, 0, 0, 0});
  }
  answer({0xA2, 66, 0x7F, 0, 0, 0, 0, 0});
  request({0xD9, 0, 0, 0, 0, 0, 0, 0});  // n = 6
  answer({0xA1, 0, 0, 0, 0, 0, 0, 0});
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].size, 456U);
  EXPECT_EQ(messages[0].end, TransferEnd::done);
}

TEST_F(SdoTransfers, TraceThatBeginsInABlockTransfer_IsJoinedAtTheNextConfirmation) {
  answer({0xA2, 0x7F, 0x7F, 0, 0, 0, 0, 0});
  request({0x01, 1, 2, 3, 4, 5, 6, 7});
  request({0x82, 8, 0, 0, 0, 0, 0, 0});
  answer({0xA2, 0x02, 0x7F, 0, 0, 0, 0, 0});
  request({0xD9, 0, 0, 0, 0, 0, 0, 0});
  answer({0xA1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(lines(),
              ElementsAre("unknown object, begun before the trace, write: 0807060504030201H (8 bytes, "
                          "block transfer, 1.2 ms)"));
}

TEST_F(SdoTransfers, BlockUploadAnsweredByASegmentedOne_IsFollowed) {
  request({0xA4, 0x17, 0x10, 0x00, 0x7F, 0x20, 0, 0});
  answer({0x4B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0});
  EXPECT_THAT(lines(), ElementsAre("1017:00 'Producer heartbeat time' read: 1000 ms (UNSIGNED16, 0.2 ms)"));
}

TEST_F(SdoTransfers, Abort_SaysWhoAndWhy) {
  request({0x40, 0x00, 0x60, 0x09, 0, 0, 0, 0});
  answer({0x80, 0x00, 0x60, 0x09, 0x11, 0x00, 0x09, 0x06});
  request({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  answer({0x41, 0x08, 0x10, 0x00, 9, 0, 0, 0});
  request({0x80, 0x08, 0x10, 0x00, 0x00, 0x00, 0x04, 0x05});
  EXPECT_EQ(messages.at(0).abort_code, 0x06090011U);
  EXPECT_THAT(
      lines(),
      ElementsAre("6000:09 read: aborted by the server after 0.2 ms: 06090011H sub-index does not exist",
                  "1008:00 'Manufacturer device name' read: aborted by the client after 0.5 ms: "
                  "05040000H SDO protocol timed out"));
}

TEST_F(SdoTransfers, RequestsWithoutEnd_AreReported) {
  request({0x40, 0x00, 0x60, 0x01, 0, 0, 0, 0});
  request({0x40, 0x00, 0x60, 0x02, 0, 0, 0, 0});
  EXPECT_THAT(lines(), IsEmpty());  // of two clients: the answer to the first one may still come
  answer({0x41, 0x00, 0x60, 0x02, 9, 0, 0, 0});
  request({0x60, 0, 0, 0, 0, 0, 0, 0});
  answer({0x00, 1, 2, 3, 4, 5, 6, 7});
  request({0x40, 0x00, 0x60, 0x03, 0, 0, 0, 0});
  EXPECT_THAT(lines(),
              ElementsAre("6000:02 read: overtaken by another request after 7 bytes in 4 frames, 0.8 ms"));
  answer({0x41, 0x00, 0x60, 0x03, 9, 0, 0, 0});
  decoder.finish(sink);
  EXPECT_THAT(lines(), ElementsAre("6000:01 read: no answer",
                                   "6000:03 read: unfinished after 0 bytes in 2 frames, 0.2 ms"));
}

TEST_F(SdoTransfers, AnswersToTwoClients_AreMatchedByTheirObject) {
  request({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  request({0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0});
  answer({0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00});
  answer({0x43, 0x18, 0x10, 0x01, 0xFB, 0, 0, 0});
  decoder.finish(sink);
  EXPECT_THAT(lines(), ElementsAre("1000:00 'Device type' read: 00020192H (UNSIGNED32, 0.5 ms)",
                                   "1018:01 'Identity object' read: 000000FBH (UNSIGNED32, 0.5 ms)"));
}

TEST_F(SdoTransfers, AnswersToTwoClientsInTheOtherOrder_AreMatchedByTheirObject) {
  request({0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0});
  request({0x40, 0x00, 0x60, 0x09, 0, 0, 0, 0});
  answer({0x80, 0x00, 0x60, 0x09, 0x11, 0x00, 0x09, 0x06});
  answer({0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0});
  decoder.finish(sink);
  EXPECT_THAT(
      lines(),
      ElementsAre("6000:09 read: aborted by the server after 0.2 ms: 06090011H sub-index does not exist",
                  "1017:00 'Producer heartbeat time' write: 1000 ms (UNSIGNED16, 0.8 ms)"));
}

TEST_F(SdoTransfers, TwoClientsThatReadTheSameObject_BothHaveAnAnswer) {
  request({0x40, 0x00, 0x20, 0x05, 0, 0, 0, 0});
  request({0x40, 0x00, 0x20, 0x05, 0, 0, 0, 0});
  answer({0x4F, 0x00, 0x20, 0x05, 0x34, 0, 0, 0});
  answer({0x4F, 0x00, 0x20, 0x05, 0x34, 0, 0, 0});
  decoder.finish(sink);
  EXPECT_THAT(lines(),
              ElementsAre("2000:05 read: 34H (1 byte, 0.2 ms)", "2000:05 read: 34H (1 byte, 0.8 ms)"));
}

TEST_F(SdoTransfers, RequestDuringASegmentedRead_OfAnotherClient_FindsItsAnswerBeforeIt) {
  request({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  request({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  answer({0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00});
  answer({0x41, 0x08, 0x10, 0x00, 2, 0, 0, 0});
  request({0x60, 0, 0, 0, 0, 0, 0, 0});
  answer({0x0B, 'M', 'E', 0, 0, 0, 0, 0});
  EXPECT_THAT(
      lines(),
      ElementsAre("1000:00 'Device type' read: 00020192H (UNSIGNED32, 0.2 ms)",
                  "1008:00 'Manufacturer device name' read: \"ME\" (VISIBLE_STRING, 2 bytes, 1.2 ms)"));
}

TEST_F(SdoTransfers, RequestsOfAClientThatGetsNoAnswer_DoNotGrowForEver) {
  for (unsigned i = 0; i < 100; ++i) request({0x40, 0x00, 0x20, static_cast<std::uint8_t>(i), 0, 0, 0, 0});
  EXPECT_EQ(messages.size(), 100U - SdoChannel::most_requests);
  EXPECT_EQ(messages.at(0).text, "2000:00 read: no answer");
}

TEST_F(SdoTransfers, ShortFrames_AreShownWithWhatWasExpected) {
  request({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  answer({0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02});
  request({0x2F, 0x00, 0x62, 0x01, 0x05});
  request({});
  answer({0x60});
  for (const Message& message : messages) {
    EXPECT_TRUE(message.is_malformed);
    EXPECT_EQ(message.kind, "malformed");
    EXPECT_EQ(message.service, Service::sdo);
    EXPECT_EQ(message.node, 5);
  }
  EXPECT_THAT(lines(),
              ElementsAre("7 bytes, expected 8: 43 00 10 00 92 01 02", "5 bytes, expected 8: 2F 00 62 01 05",
                          "0 bytes, expected 8: ", "1 byte, expected 8: 60"));
  decoder.finish(sink);
  EXPECT_THAT(lines(), ElementsAre("1000:00 'Device type' read: no valid answer: one of 1 byte, expected 8"));
}

TEST_F(SdoTransfers, SegmentWhoseToggleBitDoesNotAlternate_IsShown) {
  request({0x21, 0x00, 0x20, 0x00, 16, 0, 0, 0});
  answer({0x60, 0x00, 0x20, 0x00, 0, 0, 0, 0});
  request({0x00, 1, 2, 3, 4, 5, 6, 7});
  answer({0x30, 0, 0, 0, 0, 0, 0, 0});
  request({0x00, 1, 2, 3, 4, 5, 6, 7});
  answer({0x20, 0, 0, 0, 0, 0, 0, 0});
  request({0x1B, 8, 9, 0, 0, 0, 0, 0});
  answer({0x30, 0, 0, 0, 0, 0, 0, 0});
  ASSERT_EQ(messages.size(), 3U);
  EXPECT_TRUE(messages[0].is_malformed);
  EXPECT_TRUE(messages[1].is_malformed);
  EXPECT_FALSE(messages[2].is_malformed);
  EXPECT_THAT(
      lines(),
      ElementsAre("download segment response 2000:00, toggle 1, expected 0",
                  "download segment 2000:00, toggle 0, expected 1: 01 02 03 04 05 06 07",
                  "2000:00 write: 01 02 03 04 05 06 07 01 02 03 04 05 06 07 08 09 (16 bytes, 1.8 ms)"));
}

TEST_F(SdoTransfers, ToggleBitsOfASegmentedRead_AreCheckedToo) {
  request({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  answer({0x41, 0x08, 0x10, 0x00, 9, 0, 0, 0});
  request({0x70, 0, 0, 0, 0, 0, 0, 0});
  answer({0x00, 'M', 'E', '3', 'C', 'A', 'N', '1'});
  request({0x60, 0, 0, 0, 0, 0, 0, 0});
  answer({0x0B, '-', 'Q', 0, 0, 0, 0, 0});
  ASSERT_EQ(messages.size(), 3U);
  EXPECT_EQ(messages[0].text,
            "upload segment request 1008:00 'Manufacturer device name', toggle 1, expected 0");
  EXPECT_EQ(messages[1].text,
            "upload segment 1008:00 'Manufacturer device name', toggle 0, expected 1: 4D 45 33 43 41 4E 31");
  EXPECT_FALSE(messages[2].is_malformed);
}

TEST_F(SdoTransfers, ShortAnswer_BelongsToTheRequestOfItsObject) {
  request({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  request({0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0});
  answer({0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02});
  messages.clear();
  decoder.finish(sink);
  EXPECT_THAT(lines(), ElementsAre("1000:00 'Device type' read: no valid answer: one of 7 bytes, expected 8",
                                   "1018:01 'Identity object' read: no answer"));
}

TEST_F(SdoTransfers, SilentServer_IsReportedAfterTenSeconds) {
  request({0x40, 0x00, 0x60, 0x01, 0, 0, 0, 0});
  now += 9s;
  receive(0x705, {0x05});
  messages.clear();
  now += 2s;
  receive(0x705, {0x05});
  EXPECT_THAT(lines(), ElementsAre("6000:01 read: no answer", "operational"));
}

TEST_F(SdoTransfers, ChannelsOfTwoNodes_DoNotMix) {
  receive(0x605, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  receive(0x606, {0x40, 0x01, 0x10, 0x00, 0, 0, 0, 0});
  receive(0x585, {0x43, 0x00, 0x10, 0x00, 0x96, 0x01, 0, 0});
  receive(0x586, {0x4F, 0x01, 0x10, 0x00, 0x81, 0, 0, 0});
  EXPECT_THAT(lines(),
              ElementsAre("1000:00 'Device type' read: 00000196H (UNSIGNED32, 0.5 ms)",
                          "1001:00 'Error register' read: 129 generic, manufacturer (UNSIGNED8, 0.5 ms)"));
}

TEST_F(SdoTransfers, SecondSdoServer_IsLearnt) {
  for (const auto& [sub, low] : {std::pair{1, 0x41}, std::pair{2, 0x42}}) {
    request({0x23, 0x01, 0x12, static_cast<std::uint8_t>(sub), static_cast<std::uint8_t>(low), 0x06, 0, 0});
    answer({0x60, 0x01, 0x12, static_cast<std::uint8_t>(sub), 0, 0, 0, 0});
  }
  messages.clear();
  receive(0x641, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  receive(0x642, {0x43, 0x00, 0x10, 0x00, 0x96, 0x01, 0, 0});
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].node, 5);
}

}  // namespace
}  // namespace canopus::trace::sdo_transfers_test
