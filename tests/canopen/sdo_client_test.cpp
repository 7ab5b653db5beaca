#include "canopus/canopen/sdo/sdo_client.hpp"

#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::sdo_client_test {
namespace {

class SdoClientTest : public testing::Test, public SdoClientListener {
 protected:
  SdoClientTest() { client.set_server(9); }
  std::string receive(const std::string& frame) {
    client.receive(from_text(frame), now);
    return bus.drain();
  }
  void sdo_finished(SdoClient&, can::Time) override { ++finished; }
  std::vector<std::uint8_t> data() const { return {client.data().begin(), client.data().end()}; }

  Notebook bus;
  SdoClient client{bus};
  can::Time now{};
  int finished = 0;
};

TEST_F(SdoClientTest, ExpeditedUpload_GivesTheBytesThatAreIndicated) {
  ASSERT_TRUE(client.upload(0x1018, 1, *this, now));
  EXPECT_EQ(bus.drain(), "609 40 18 10 01 00 00 00 00");
  EXPECT_EQ(receive("589 4B 18 10 01 D0 01 00 00"), "");
  EXPECT_EQ(data(), (std::vector<std::uint8_t>{0xD0, 0x01}));
  EXPECT_EQ(client.abort_code(), AbortCode::none);
  EXPECT_EQ(finished, 1);
  EXPECT_EQ(client.deadline(), can::never);
}

TEST_F(SdoClientTest, ExpeditedUploadWithoutItsSize_GivesAllFourBytesAsOfUnknownSize) {
  client.upload(0x2000, 0, *this, now);
  receive("589 42 00 20 00 34 12 00 00");
  EXPECT_EQ(data(), (std::vector<std::uint8_t>{0x34, 0x12, 0, 0}));
  EXPECT_FALSE(client.is_size_indicated());
  client.upload(0x2000, 0, *this, now);
  receive("589 4B 00 20 00 34 12 00 00");
  EXPECT_EQ(data(), (std::vector<std::uint8_t>{0x34, 0x12}));
  EXPECT_TRUE(client.is_size_indicated());
  client.upload(0x2000, 0, *this, now);
  receive("589 40 00 20 00 00 00 00 00");  // segmented, of unknown size: the last segment has it
  receive("589 0D 01 00 00 00 00 00 00");
  EXPECT_EQ(data().size(), 1U);
  EXPECT_TRUE(client.is_size_indicated());
}

TEST_F(SdoClientTest, ShortAnswerAboutAnotherObject_IsIgnored) {
  client.upload(0x1018, 1, *this, now);
  bus.drain();
  EXPECT_EQ(receive("589 43 00 10 00 92 01 02"), "");
  EXPECT_TRUE(client.busy());
  EXPECT_EQ(receive("589 43 18 10 01 D0 01 00 00"), "");
  EXPECT_EQ(client.abort_code(), AbortCode::none);
}

TEST_F(SdoClientTest, ShortFrameOutsideOfATransfer_IsNothing) {
  EXPECT_EQ(receive("589 43 00 10 00 92 01 02"), "");
  EXPECT_EQ(finished, 0);
  EXPECT_EQ(client.short_answer(), nullptr);
}

/// Answers to what a client does; the last one is too short.
struct ShortAnswer {
  const char* name;
  enum class Transfer : std::uint8_t { upload, download, block_upload, block_download } transfer;
  std::vector<std::string> answers;
  bool is_abort = false;
};
std::ostream& operator<<(std::ostream& out, const ShortAnswer& answer) { return out << answer.name; }

class ShortSdoAnswer : public SdoClientTest, public testing::WithParamInterface<ShortAnswer> {};

TEST_P(ShortSdoAnswer, EndsTheTransferWithTheFrame) {
  using Transfer = ShortAnswer::Transfer;
  const ShortAnswer& test = GetParam();
  const std::vector<std::uint8_t> value(9, 0x11);
  const bool in_blocks = test.transfer == Transfer::block_upload || test.transfer == Transfer::block_download;
  const auto mode = in_blocks ? SdoClient::Mode::block : SdoClient::Mode::segmented;
  if (test.transfer == Transfer::upload || test.transfer == Transfer::block_upload) {
    ASSERT_TRUE(client.upload(0x1008, 0, *this, now, 200ms, mode));
  } else {
    ASSERT_TRUE(client.download(0x1008, 0, value, *this, now, 200ms, mode));
  }
  for (const std::string& answer : test.answers) {
    ASSERT_EQ(finished, 0);
    bus.drain();
    client.receive(from_text(answer), now);
  }
  EXPECT_EQ(bus.drain(), test.is_abort ? "" : "609 80 08 10 00 13 00 07 06");
  EXPECT_EQ(finished, 1);
  EXPECT_EQ(client.abort_code(), AbortCode::length_too_low);
  EXPECT_TRUE(client.gave_up());
  ASSERT_NE(client.short_answer(), nullptr);
  EXPECT_EQ(to_text(*client.short_answer()), test.answers.back());
}

const ShortAnswer short_answers[] = {
    {"InitiateUpload7", ShortAnswer::Transfer::upload, {"589 43 08 10 00 92 01 02"}},
    {"InitiateUpload4", ShortAnswer::Transfer::upload, {"589 4F 08 10 00"}},
    {"InitiateUpload1", ShortAnswer::Transfer::upload, {"589 43"}},
    {"Nothing", ShortAnswer::Transfer::upload, {"589"}},
    {"UploadSegment", ShortAnswer::Transfer::upload, {"589 41 08 10 00 09 00 00 00", "589 00 4D 45 33 43"}},
    {"LastUploadSegment",
     ShortAnswer::Transfer::upload,
     {"589 41 08 10 00 09 00 00 00", "589 00 4D 45 33 43 41 4E 31", "589 1B 2D 51"}},
    {"InitiateDownload", ShortAnswer::Transfer::download, {"589 60 08 10 00"}},
    {"DownloadSegment", ShortAnswer::Transfer::download, {"589 60 08 10 00 00 00 00 00", "589 20"}},
    {"InitiateBlockUpload", ShortAnswer::Transfer::block_upload, {"589 C6 08 10 00 09"}},
    {"BlockSegment",
     ShortAnswer::Transfer::block_upload,
     {"589 C6 08 10 00 09 00 00 00", "589 01 4D 45 33 43 41 4E"}},
    {"EndBlockUpload",
     ShortAnswer::Transfer::block_upload,
     {"589 C2 08 10 00 09 00 00 00", "589 01 4D 45 33 43 41 4E 31", "589 82 2D 51 00 00 00 00 00",
      "589 D5 00 00"}},
    {"InitiateBlockDownload", ShortAnswer::Transfer::block_download, {"589 A4 08 10 00 7F"}},
    {"BlockConfirmed",
     ShortAnswer::Transfer::block_download,
     {"589 A4 08 10 00 7F 00 00 00", "589 A2 02 7F"}},
    {"Abort", ShortAnswer::Transfer::upload, {"589 80 08 10 00"}, true},
    {"AbortOfADownload", ShortAnswer::Transfer::download, {"589 80 08 10 00 11 00"}, true},
    {"AbortInABlock",
     ShortAnswer::Transfer::block_upload,
     {"589 C6 08 10 00 09 00 00 00", "589 80 08 10 00"},
     true},
};
INSTANTIATE_TEST_SUITE_P(Frames, ShortSdoAnswer, testing::ValuesIn(short_answers),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_F(SdoClientTest, SegmentedUpload_CollectsTheSegments) {
  client.upload(0x1008, 0, *this, now);
  bus.drain();
  EXPECT_EQ(receive("589 41 08 10 00 09 00 00 00"), "609 60 00 00 00 00 00 00 00");
  EXPECT_EQ(receive("589 00 4D 45 33 43 41 4E 31"), "609 70 00 00 00 00 00 00 00");
  EXPECT_EQ(receive("589 1B 2D 51 00 00 00 00 00"), "");
  EXPECT_EQ(std::string(client.data().begin(), client.data().end()), "ME3CAN1-Q");
  EXPECT_EQ(finished, 1);
}

TEST_F(SdoClientTest, BlockUpload_ServerMaySwitchWithinTheThreshold) {
  client.set_switch_threshold(4);
  client.upload(0x1000, 0, *this, now, 200ms, SdoClient::Mode::block);
  EXPECT_EQ(bus.drain(), "609 A4 00 10 00 7F 04 00 00");
  EXPECT_EQ(receive("589 43 00 10 00 95 01 00 00"), "");
  EXPECT_EQ(client.abort_code(), AbortCode::none);
  EXPECT_EQ(data(), (std::vector<std::uint8_t>{0x95, 0x01, 0, 0}));
}

TEST_F(SdoClientTest, BlockUpload_ServerThatSwitchesUnaskedIsAborted) {
  client.set_switch_threshold(0);
  client.upload(0x1000, 0, *this, now, 200ms, SdoClient::Mode::block);
  EXPECT_EQ(bus.drain(), "609 A4 00 10 00 7F 00 00 00");
  EXPECT_EQ(receive("589 43 01 10 00 95 01 00 00"), "") << "late, about another object";
  EXPECT_TRUE(client.busy());
  EXPECT_EQ(receive("589 43 00 10 00 95 01 00 00"), "609 80 00 10 00 01 00 04 05");
  EXPECT_EQ(client.abort_code(), AbortCode::command_specifier);
  EXPECT_EQ(finished, 1);
}

TEST_F(SdoClientTest, DownloadOfUpToFourBytes_IsExpedited) {
  const std::uint8_t bytes[] = {0xE8, 0x03};
  ASSERT_TRUE(client.download(0x1017, 0, bytes, *this, now));
  EXPECT_EQ(bus.drain(), "609 2B 17 10 00 E8 03 00 00");
  EXPECT_EQ(receive("589 60 17 10 00 00 00 00 00"), "");
  EXPECT_EQ(client.abort_code(), AbortCode::none);
  EXPECT_EQ(finished, 1);
}

TEST_F(SdoClientTest, LongerDownload_GoesInSegments) {
  const std::uint8_t bytes[] = {1, 2, 3, 4, 5, 6, 7, 8};
  client.download(0x2016, 0, bytes, *this, now);
  EXPECT_EQ(bus.drain(), "609 21 16 20 00 08 00 00 00");
  EXPECT_EQ(receive("589 60 16 20 00 00 00 00 00"), "609 00 01 02 03 04 05 06 07");
  EXPECT_EQ(receive("589 20 00 00 00 00 00 00 00"), "609 1D 08 00 00 00 00 00 00");
  EXPECT_EQ(finished, 0);
  EXPECT_EQ(receive("589 30 00 00 00 00 00 00 00"), "");
  EXPECT_EQ(finished, 1);
}

TEST_F(SdoClientTest, EmptyDownload_IsOneSegmentWithoutData) {
  client.download(0x2008, 0, {}, *this, now);
  EXPECT_EQ(bus.drain(), "609 21 08 20 00 00 00 00 00");
  EXPECT_EQ(receive("589 60 08 20 00 00 00 00 00"), "609 0F 00 00 00 00 00 00 00");
  EXPECT_EQ(receive("589 20 00 00 00 00 00 00 00"), "");
  EXPECT_EQ(finished, 1);
}

TEST_F(SdoClientTest, AbortOfTheServer_IsReportedAsItCame) {
  client.upload(0x5000, 0, *this, now);
  bus.drain();
  EXPECT_EQ(receive("589 80 00 50 00 00 00 02 06"), "");
  EXPECT_EQ(client.abort_code(), AbortCode::no_object);
  EXPECT_EQ(finished, 1);
}

TEST_F(SdoClientTest, Silence_IsAbortedAtTheTimeOut) {
  client.upload(0x1000, 0, *this, now, 200ms);
  bus.drain();
  EXPECT_EQ(client.deadline(), now + 200ms);
  client.tick(now + 199ms);
  EXPECT_EQ(bus.drain(), "");
  client.tick(now + 200ms);
  EXPECT_EQ(bus.drain(), "609 80 00 10 00 00 00 04 05");
  EXPECT_EQ(client.abort_code(), AbortCode::timed_out);
  EXPECT_EQ(finished, 1);
}

TEST_F(SdoClientTest, EverySegment_StartsTheTimeOutAnew) {
  client.upload(0x1008, 0, *this, now, 200ms);
  now += 150ms;
  receive("589 41 08 10 00 09 00 00 00");
  EXPECT_EQ(client.deadline(), now + 200ms);
}

TEST_F(SdoClientTest, WrongToggleBit_IsAborted) {
  client.upload(0x1008, 0, *this, now);
  receive("589 41 08 10 00 09 00 00 00");
  EXPECT_EQ(receive("589 10 4D 45 33 43 41 4E 31"), "609 80 08 10 00 00 00 03 05");
  EXPECT_EQ(client.abort_code(), AbortCode::toggle_bit);
}

TEST_F(SdoClientTest, AnswerThatDoesNotFit_IsAborted) {
  client.upload(0x1008, 0, *this, now);
  bus.drain();
  EXPECT_EQ(receive("589 60 08 10 00 00 00 00 00"), "609 80 08 10 00 01 00 04 05");
  EXPECT_EQ(client.abort_code(), AbortCode::command_specifier);
}

TEST_F(SdoClientTest, LateAnswerAboutAnotherObject_IsIgnored) {
  client.upload(0x1008, 0, *this, now);
  bus.drain();
  EXPECT_EQ(receive("589 43 00 10 00 01 02 03 04"), "");
  EXPECT_TRUE(client.busy());
}

TEST_F(SdoClientTest, MoreThanTheMaximum_IsReportedAsBufferTooSmall) {
  client.set_maximum_size(8);
  client.upload(0x1008, 0, *this, now);
  bus.drain();
  EXPECT_EQ(receive("589 41 08 10 00 09 00 00 00"), "609 80 08 10 00 05 00 04 05");
  EXPECT_EQ(static_cast<std::uint32_t>(client.abort_code()), 0x60600000U);
}

TEST_F(SdoClientTest, AnnouncedSizeAboveTheUsualLimit_IsRefusedAtOnce) {
  client.upload(0x1008, 0, *this, now);
  bus.drain();
  EXPECT_EQ(receive("589 41 08 10 00 01 00 00 01"), "609 80 08 10 00 05 00 04 05") << "16 MiB and a byte";
  client.upload(0x1008, 0, *this, now, 200ms, SdoClient::Mode::block);
  bus.drain();
  EXPECT_EQ(receive("589 C6 08 10 00 01 00 00 01"), "609 80 08 10 00 05 00 04 05");
  EXPECT_EQ(finished, 2);
}

TEST_F(SdoClientTest, HigherLimit_LetsAnAnnouncedSizeThrough) {
  client.set_maximum_size(0x01000001);
  client.upload(0x1008, 0, *this, now);
  bus.drain();
  EXPECT_EQ(receive("589 41 08 10 00 01 00 00 01"), "609 60 00 00 00 00 00 00 00");
}

TEST_F(SdoClientTest, MoreBytesThanAnnounced_AreAborted) {
  client.upload(0x1008, 0, *this, now);
  receive("589 41 08 10 00 03 00 00 00");
  EXPECT_EQ(receive("589 01 4D 45 33 43 41 4E 31"), "609 80 08 10 00 12 00 07 06");
}

TEST_F(SdoClientTest, Cancel_SendsAnAbortAndCallsNobody) {
  client.upload(0x1008, 0, *this, now);
  bus.drain();
  client.cancel(AbortCode::general);
  EXPECT_EQ(bus.drain(), "609 80 08 10 00 00 00 00 08");
  EXPECT_FALSE(client.busy());
  EXPECT_EQ(finished, 0);
}

TEST_F(SdoClientTest, FullTransmitQueue_StartsNothing) {
  bus.is_full = true;
  EXPECT_FALSE(client.upload(0x1008, 0, *this, now));
  EXPECT_FALSE(client.busy());
}

TEST_F(SdoClientTest, FramesOfOtherChannels_AreNotItsOwn) {
  EXPECT_FALSE(client.receive(from_text("588 43 00 10 00 01 02 03 04"), now));
  EXPECT_TRUE(client.receive(from_text("589 43 00 10 00 01 02 03 04"), now));
}

/// A server that has always another segment, and never says how many bytes there are.
class EndlessServer : public testing::TestWithParam<SdoClient::Mode>,
                      public can::Sink,
                      public SdoClientListener {
 protected:
  static constexpr std::size_t limit = 16'777'216;

  EndlessServer() { client.set_server(9); }
  bool send(const can::Frame& frame) override {
    last_sent = frame;
    return true;
  }
  void sdo_finished(SdoClient&, can::Time) override {}
  void answer(std::initializer_list<std::uint8_t> bytes) {
    client.receive(can::data_frame(0x589, bytes), can::Time{});
  }
  /// Gives bytes until the client has enough, or has taken twice the limit.
  std::size_t upload() {
    const bool in_blocks = GetParam() == SdoClient::Mode::block;
    client.upload(0x1008, 0, *this, can::Time{}, 200ms, GetParam());
    answer({static_cast<std::uint8_t>(in_blocks ? 0xC0 : 0x40), 0x08, 0x10, 0, 0, 0, 0, 0});
    std::size_t bytes = 0;
    for (std::uint8_t segment = 0; client.busy() && bytes < 2 * limit; bytes += 7) {
      if (in_blocks) {
        segment = static_cast<std::uint8_t>(segment % 127 + 1);
        answer({segment, 1, 2, 3, 4, 5, 6, 7});
      } else {
        answer({segment, 1, 2, 3, 4, 5, 6, 7});
        segment ^= 0x10;
      }
    }
    return bytes;
  }

  can::Frame last_sent;
  SdoClient client{*this};
};

TEST_P(EndlessServer, UploadIsAbortedAtTheLimit) {
  EXPECT_LE(upload(), limit + 127 * 7);
  EXPECT_FALSE(client.busy());
  EXPECT_EQ(to_text(last_sent), "609 80 08 10 00 05 00 04 05");
  EXPECT_EQ(static_cast<std::uint32_t>(client.abort_code()), 0x60600000U);
}

INSTANTIATE_TEST_SUITE_P(Modes, EndlessServer,
                         testing::Values(SdoClient::Mode::segmented, SdoClient::Mode::block),
                         [](const auto& test) {
                           return test.param == SdoClient::Mode::block ? "Block" : "Segmented";
                         });

}  // namespace
}  // namespace canopus::canopen::sdo_client_test
