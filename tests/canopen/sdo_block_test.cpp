#include <deque>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/canopen/sdo/sdo_crc.hpp"

#include "canopen/conversation.hpp"

namespace canopus::canopen {
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
  EXPECT_EQ(hear("605 C6 0A 20 00 0A 00 00 00"), "585 A4 0A 20 00 7F 00 00 00");
  EXPECT_EQ(hear("605 01 30 31 32 33 34 35 36"), "");
  EXPECT_EQ(hear("605 82 37 38 39 00 00 00 00"), "585 A2 02 7F 00 00 00 00 00");
  EXPECT_EQ(hear("605 D1 58 9C 00 00 00 00 00"), "585 A1 00 00 00 00 00 00 00");
  EXPECT_EQ(domain(), "0123456789");
}

TEST_F(SdoBlockServer, DownloadWithWrongCrc_IsAbortedAndChangesNothing) {
  hear("605 C6 0A 20 00 0A 00 00 00");
  hear("605 01 30 31 32 33 34 35 36");
  hear("605 82 37 38 39 00 00 00 00");
  EXPECT_EQ(hear("605 D1 59 9C 00 00 00 00 00"), "585 80 0A 20 00 04 00 04 05");
  EXPECT_EQ(domain(), "");
}

TEST_F(SdoBlockServer, DownloadWithoutCrc_DoesNotLookAtIt) {
  hear("605 C0 0A 20 00 00 00 00 00");
  hear("605 81 30 31 32 00 00 00 00");
  EXPECT_EQ(hear("605 D1 00 00 00 00 00 00 00"), "585 A1 00 00 00 00 00 00 00");
  EXPECT_EQ(domain(), "012");
}

TEST_F(SdoBlockServer, LostSegment_IsAskedForAgain) {
  hear("605 C4 0A 20 00 00 00 00 00");
  hear("605 01 30 31 32 33 34 35 36");
  EXPECT_EQ(hear("605 83 45 46 47 00 00 00 00"), "585 A2 01 7F 00 00 00 00 00");
  hear("605 01 37 38 39 41 42 43 44");
  EXPECT_EQ(hear("605 82 45 46 47 00 00 00 00"), "585 A2 02 7F 00 00 00 00 00");
  hear("605 80 0A 20 00 00 00 00 08");
}

TEST_F(SdoBlockServer, FirstSegmentLost_ConfirmsNone) {
  hear("605 C4 0A 20 00 00 00 00 00");
  EXPECT_EQ(hear("605 82 37 38 39 00 00 00 00"), "585 A2 00 7F 00 00 00 00 00");
}

TEST_F(SdoBlockServer, LostLastSegment_IsConfirmedAfterAPause) {
  hear("605 C4 0A 20 00 00 00 00 00");
  hear("605 01 30 31 32 33 34 35 36");
  EXPECT_EQ(wait(2s), "250: 585 A2 01 7F 00 00 00 00 00 | 1000: 585 80 0A 20 00 00 00 04 05");
}

TEST_F(SdoBlockServer, SequenceNumbersOutOfRange_AreAborted) {
  hear("605 C4 0A 20 00 00 00 00 00");
  EXPECT_EQ(hear("605 00 30 31 32 33 34 35 36"), "585 80 0A 20 00 03 00 04 05");
}

TEST_F(SdoBlockServer, AbortAmongSegments_IsAnAbort) {
  hear("605 C4 0A 20 00 00 00 00 00");
  EXPECT_EQ(hear("605 80 0A 20 00 00 00 00 08"), "");
  EXPECT_EQ(hear("605 01 30 31 32 33 34 35 36"), "585 80 00 00 00 01 00 04 05");
}

TEST_F(SdoBlockServer, DownloadOfAnotherSizeThanAnnounced_IsAborted) {
  hear("605 C2 0A 20 00 0B 00 00 00");
  hear("605 01 30 31 32 33 34 35 36");
  hear("605 82 37 38 39 00 00 00 00");
  EXPECT_EQ(hear("605 D1 00 00 00 00 00 00 00"), "585 80 0A 20 00 13 00 07 06");
  hear("605 C2 0A 20 00 09 00 00 00");
  hear("605 01 30 31 32 33 34 35 36");
  hear("605 82 37 38 39 00 00 00 00");
  EXPECT_EQ(hear("605 D1 00 00 00 00 00 00 00"), "585 80 0A 20 00 12 00 07 06");
}

TEST_F(SdoBlockServer, Upload_OfTenBytes) {
  set_domain("0123456789");
  EXPECT_EQ(hear("605 A4 0A 20 00 7F 00 00 00"), "585 C6 0A 20 00 0A 00 00 00");
  EXPECT_EQ(hear("605 A3 00 00 00 00 00 00 00"), "585 01 30 31 32 33 34 35 36 | 585 82 37 38 39 00 00 00 00");
  EXPECT_EQ(hear("605 A2 02 7F 00 00 00 00 00"), "585 D1 58 9C 00 00 00 00 00");
  EXPECT_EQ(hear("605 A1 00 00 00 00 00 00 00"), "");
  EXPECT_EQ(hear("605 40 18 10 01 00 00 00 00"), "585 43 18 10 01 D0 01 00 00");
}

TEST_F(SdoBlockServer, UploadWithoutCrc_HasCrcZero) {
  set_domain("012");
  hear("605 A0 0A 20 00 7F 00 00 00");
  hear("605 A3 00 00 00 00 00 00 00");
  EXPECT_EQ(hear("605 A2 01 7F 00 00 00 00 00"), "585 D1 00 00 00 00 00 00 00");
}

TEST_F(SdoBlockServer, Upload_GoesOnAfterTheSegmentThatIsConfirmed) {
  set_domain("0123456789ABCDEFGHIJ");
  hear("605 A0 0A 20 00 02 00 00 00");
  EXPECT_EQ(hear("605 A3 00 00 00 00 00 00 00"), "585 01 30 31 32 33 34 35 36 | 585 02 37 38 39 41 42 43 44");
  EXPECT_EQ(hear("605 A2 01 03 00 00 00 00 00"), "585 01 37 38 39 41 42 43 44 | 585 82 45 46 47 48 49 4A 00");
  EXPECT_EQ(hear("605 A2 00 01 00 00 00 00 00"), "585 01 37 38 39 41 42 43 44");
  EXPECT_EQ(hear("605 A2 01 01 00 00 00 00 00"), "585 81 45 46 47 48 49 4A 00");
  EXPECT_EQ(hear("605 A2 01 01 00 00 00 00 00"), "585 C5 00 00 00 00 00 00 00");
}

TEST_F(SdoBlockServer, EmptyValue_IsOneSegmentWithoutData) {
  EXPECT_EQ(hear("605 A4 0A 20 00 7F 00 00 00"), "585 C6 0A 20 00 00 00 00 00");
  EXPECT_EQ(hear("605 A3 00 00 00 00 00 00 00"), "585 81 00 00 00 00 00 00 00");
  EXPECT_EQ(hear("605 A2 01 7F 00 00 00 00 00"), "585 DD 00 00 00 00 00 00 00");
}

TEST_F(SdoBlockServer, ValueWithinTheSwitchThreshold_IsUploadedWithoutBlocks) {
  set_domain("0123");
  EXPECT_EQ(hear("605 A4 0A 20 00 7F 04 00 00"), "585 43 0A 20 00 30 31 32 33");
  set_domain("01234");
  EXPECT_EQ(hear("605 A4 0A 20 00 7F 05 00 00"), "585 41 0A 20 00 05 00 00 00");
  EXPECT_EQ(hear("605 60 00 00 00 00 00 00 00"), "585 05 30 31 32 33 34 00 00");
}

TEST_F(SdoBlockServer, InvalidBlockSizes_AreAborted) {
  set_domain("0123456789");
  EXPECT_EQ(hear("605 A4 0A 20 00 00 00 00 00"), "585 80 0A 20 00 02 00 04 05");
  EXPECT_EQ(hear("605 A4 0A 20 00 80 00 00 00"), "585 80 0A 20 00 02 00 04 05");
  hear("605 A4 0A 20 00 7F 00 00 00");
  hear("605 A3 00 00 00 00 00 00 00");
  EXPECT_EQ(hear("605 A2 02 00 00 00 00 00 00"), "585 80 0A 20 00 02 00 04 05");
}

TEST_F(SdoBlockServer, ConfirmationOfMoreThanWasSent_IsAborted) {
  set_domain("0123456789");
  hear("605 A4 0A 20 00 7F 00 00 00");
  hear("605 A3 00 00 00 00 00 00 00");
  EXPECT_EQ(hear("605 A2 03 7F 00 00 00 00 00"), "585 80 0A 20 00 03 00 04 05");
}

TEST_F(SdoBlockServer, FullTransmitQueue_GoesOnLater) {
  set_domain("0123456789");
  hear("605 A4 0A 20 00 7F 00 00 00");
  bus.is_full = true;
  EXPECT_EQ(hear("605 A3 00 00 00 00 00 00 00"), "");
  wait(1ms);
  bus.is_full = false;
  EXPECT_EQ(wait(1ms), "1.5: 585 01 30 31 32 33 34 35 36 | 1.5: 585 82 37 38 39 00 00 00 00");
}

/// Client and server with two queues between them that may lose frames; a frame takes 100 us.
class LossyLine : public SdoClientUser {
 public:
  explicit LossyLine(unsigned seed, unsigned loss_per_thousand)
      : node(standard_objects().build(), 5, from_server), random_(seed), loss_(loss_per_thousand) {
    node.power_on(now);
    client.set_server(5);
    from_server.frames.clear();
  }
  void run() {
    for (int step = 0; step < 2'000'000 && client.busy(); ++step) {
      now += 100us;
      if (!from_client.frames.empty()) {
        const can::Frame frame = take(from_client.frames);
        if (!lost()) node.receive(frame, now);
      } else if (!from_server.frames.empty()) {
        const can::Frame frame = take(from_server.frames);
        if (!lost()) client.receive(frame, now);
      }
      if (client.deadline() <= now) client.tick(now);
      if (node.deadline() <= now) node.tick(now);
    }
  }
  void sdo_finished(SdoClient&, can::Time) override { ++finished; }

  struct Queue final : can::Sink {
    bool send(const can::Frame& frame) override {
      if (frames.size() >= 20) return false;  // a small controller
      frames.push_back(frame);
      return true;
    }
    std::deque<can::Frame> frames;
  };
  Queue from_client;
  Queue from_server;
  can::Time now{};
  Node node;
  SdoClient client{from_client};
  int finished = 0;

 private:
  static can::Frame take(std::deque<can::Frame>& frames) {
    const can::Frame frame = frames.front();
    frames.pop_front();
    return frame;
  }
  bool lost() {
    random_ = random_ * 1103515245U + 12345U;
    return (random_ >> 16) % 1000 < loss_;
  }
  unsigned random_;
  unsigned loss_;
};

Bytes pattern(std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(i * 7 + i / 251);
  return bytes;
}

RC_GTEST_PROP(SdoTransfer, WithoutLoss_EverySizeArrivesInEveryMode, ()) {
  const auto size = *rc::gen::inRange<std::size_t>(0, 3000);
  const auto mode = *rc::gen::element(SdoClient::Mode::segmented, SdoClient::Mode::block);
  const Bytes value = pattern(size);
  LossyLine line(1, 0);
  RC_ASSERT(line.client.download(0x200A, 0, value, line, line.now, 500ms, mode));
  line.run();
  RC_ASSERT(describe(line.client.abort_code()) == "no error");
  RC_ASSERT(line.client.upload(0x200A, 0, line, line.now, 500ms, mode));
  line.run();
  RC_ASSERT(line.client.abort_code() == AbortCode::none);
  RC_ASSERT(Bytes(line.client.data().begin(), line.client.data().end()) == value);
  RC_ASSERT(line.finished == 2);
}

RC_GTEST_PROP(SdoTransfer, WithLoss_WhatReportsSuccessIsRight, ()) {
  const auto size = *rc::gen::inRange<std::size_t>(5, 3000);
  const auto seed = *rc::gen::arbitrary<unsigned>();
  const Bytes value = pattern(size);
  LossyLine line(seed, 20);
  line.client.download(0x200A, 0, value, line, line.now, 500ms, SdoClient::Mode::block);
  line.run();
  RC_ASSERT(line.finished == 1);
  const auto stored = line.node.dictionary().bytes(line.node.dictionary().description().find(0x200A, 0));
  if (line.client.abort_code() == AbortCode::none) RC_ASSERT(Bytes(stored.begin(), stored.end()) == value);
  line.node.dictionary().assign(line.node.dictionary().description().find(0x200A, 0), value);
  line.now += 2s;  // whatever the server still had is over
  line.node.tick(line.now);
  line.from_server.frames.clear();
  line.from_client.frames.clear();
  line.client.upload(0x200A, 0, line, line.now, 500ms, SdoClient::Mode::block);
  line.run();
  RC_ASSERT(line.finished == 2);
  if (line.client.abort_code() == AbortCode::none) {
    RC_ASSERT(Bytes(line.client.data().begin(), line.client.data().end()) == value);
  }
}

TEST(SdoTransfer, LostSegments_DoNotEndABlockTransfer) {
  // Only segments get lost here: initiate and end frames have nothing to recover by but a time-out.
  Conversation c;
  Notebook bus;
  SdoClient client(bus);
  client.set_server(5);
  struct User final : SdoClientUser {
    void sdo_finished(SdoClient&, can::Time) override { ++finished; }
    int finished = 0;
  } user;
  const Bytes value = pattern(5000);
  client.download(0x200A, 0, value, user, c.now, 500ms, SdoClient::Mode::block);
  unsigned segments = 0;
  while (client.busy()) {
    const auto lines = std::exchange(bus.lines, {});
    for (const auto& line : lines) {
      const bool is_segment = line.substr(4, 1) < "A" && line.substr(4, 2) != "80" && lines.size() > 1;
      if (is_segment && ++segments % 10 == 0) continue;
      c.node.receive(from_text(line), c.now);
      const auto answers = std::exchange(c.bus.lines, {});
      for (const auto& answer : answers) client.receive(from_text(answer), c.now);
    }
    if (bus.lines.empty()) {
      c.now += 300ms;  // the segment that asks for the confirmation was lost
      c.node.tick(c.now);
      const auto answers = std::exchange(c.bus.lines, {});
      for (const auto& answer : answers) client.receive(from_text(answer), c.now);
    }
  }
  EXPECT_EQ(client.abort_code(), AbortCode::none);
  const auto stored = c.node.dictionary().read(0x200A, 0, c.now);
  EXPECT_EQ(Bytes(stored->begin(), stored->end()), value);
}

/// A value that is counted and checked, never kept: each byte is its position times 7.
class Megabytes : public ObjectHandler, public ObjectStream {
 public:
  explicit Megabytes(std::size_t size, bool size_is_known) : size_(size), size_is_known_(size_is_known) {}
  ObjectStream* stream(const Entry&) override { return this; }
  std::expected<std::optional<std::size_t>, AbortCode> open_read(const Entry&, can::Time) override {
    position = 0;
    if (!size_is_known_) return std::nullopt;
    return size_;
  }
  std::expected<std::size_t, AbortCode> read(std::span<std::uint8_t> into) override {
    largest_piece = std::max(largest_piece, into.size());
    const std::size_t count = std::min(into.size(), size_ - position);
    for (std::size_t i = 0; i < count; ++i) into[i] = static_cast<std::uint8_t>((position + i) * 7);
    position += count;
    return count;
  }
  AbortCode open_write(const Entry&, std::optional<std::size_t> size, can::Time) override {
    announced = size;
    position = 0;
    return AbortCode::none;
  }
  AbortCode write(std::span<const std::uint8_t> bytes) override {
    largest_piece = std::max(largest_piece, bytes.size());
    for (const std::uint8_t byte : bytes)
      is_right = is_right && byte == static_cast<std::uint8_t>(position++ * 7);
    return refusal;
  }
  AbortCode close(const Entry&, bool complete, can::Time) override {
    closed += complete ? "complete " : "incomplete ";
    return AbortCode::none;
  }

  std::size_t position = 0;
  std::size_t largest_piece = 0;
  std::optional<std::size_t> announced;
  bool is_right = true;
  AbortCode refusal = AbortCode::none;
  std::string closed;

 private:
  std::size_t size_;
  bool size_is_known_;
};

class SdoStream : public testing::TestWithParam<SdoClient::Mode> {};

TEST_P(SdoStream, Megabytes_PassThroughAKilobyte) {
  const std::size_t size = GetParam() == SdoClient::Mode::block ? 10'000'000 : 1'000'000;
  LossyLine line(1, 0);
  Megabytes there(size, false);
  line.node.dictionary().attach(0x200A, 0x200A, there);
  Megabytes here(size, true);
  line.client.download(0x200A, 0, here, size, line, line.now, 500ms, GetParam());
  for (int part = 0; part < 4; ++part) line.run();
  ASSERT_EQ(line.client.abort_code(), AbortCode::none);
  EXPECT_EQ(there.position, size);
  EXPECT_EQ(there.announced, size);
  EXPECT_TRUE(there.is_right);
  EXPECT_EQ(there.closed, "complete ");
  EXPECT_LE(there.largest_piece, 2048U);
  EXPECT_LE(here.largest_piece, 2048U);

  here.position = 0;
  line.client.upload(0x200A, 0, line, line.now, 500ms, GetParam(), &here);
  for (int part = 0; part < 4; ++part) line.run();
  ASSERT_EQ(line.client.abort_code(), AbortCode::none);
  EXPECT_EQ(here.position, size);
  EXPECT_TRUE(here.is_right);
  EXPECT_TRUE(line.client.data().empty());
}

INSTANTIATE_TEST_SUITE_P(Modes, SdoStream,
                         testing::Values(SdoClient::Mode::segmented, SdoClient::Mode::block));

TEST_F(SdoBlockServer, StreamThatRefuses_AbortsTheTransfer) {
  Megabytes stream(10, true);
  stream.refusal = AbortCode::hardware_error;
  node.dictionary().attach(0x200A, 0x200A, stream);
  hear("605 21 0A 20 00 0A 00 00 00");
  hear("605 00 00 07 0E 15 1C 23 2A");
  EXPECT_EQ(hear("605 19 31 38 3F 00 00 00 00"), "585 80 0A 20 00 00 00 06 06");
  EXPECT_EQ(stream.closed, "incomplete ");
}

TEST_F(SdoBlockServer, AbortedStream_IsClosedIncomplete) {
  Megabytes stream(10, true);
  node.dictionary().attach(0x200A, 0x200A, stream);
  hear("605 21 0A 20 00 0A 00 00 00");
  hear("605 80 0A 20 00 00 00 00 08");
  EXPECT_EQ(stream.closed, "incomplete ");
}

TEST_F(SdoBlockServer, StreamOfUnknownSize_IsUploadedWithoutSize) {
  Megabytes stream(10, false);
  node.dictionary().attach(0x200A, 0x200A, stream);
  EXPECT_EQ(hear("605 40 0A 20 00 00 00 00 00"), "585 40 0A 20 00 00 00 00 00");
  EXPECT_EQ(hear("605 60 00 00 00 00 00 00 00"), "585 00 00 07 0E 15 1C 23 2A");
  EXPECT_EQ(hear("605 70 00 00 00 00 00 00 00"), "585 19 31 38 3F 00 00 00 00");
  EXPECT_EQ(stream.closed, "complete ");
}

TEST_F(SdoBlockServer, SmallStream_GoesExpedited) {
  Megabytes stream(3, true);
  node.dictionary().attach(0x200A, 0x200A, stream);
  EXPECT_EQ(hear("605 40 0A 20 00 00 00 00 00"), "585 47 0A 20 00 00 07 0E 00");
  EXPECT_EQ(hear("605 27 0A 20 00 00 07 0E 00"), "585 60 0A 20 00 00 00 00 00");
  EXPECT_TRUE(stream.is_right);
  EXPECT_EQ(stream.closed, "complete complete ");
}

}  // namespace
}  // namespace canopus::canopen
