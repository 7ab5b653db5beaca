#include <deque>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/canopen/sdo/sdo_crc.hpp"

#include "canopen/conversation.hpp"
#include "canopen/megabytes.hpp"

namespace canopus::canopen::sdo_stream_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Client and server with two queues between them that may lose frames; a frame takes 100 us.
class LossyLine : public SdoClientListener {
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
        const can::Frame frame = next(from_client.frames);
        if (!lost()) node.receive(frame, now);
      } else if (!from_server.frames.empty()) {
        const can::Frame frame = next(from_server.frames);
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
  static can::Frame next(std::deque<can::Frame>& frames) {
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
  struct User final : SdoClientListener {
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

class SdoStream : public testing::TestWithParam<SdoClient::Mode> {};

TEST_P(SdoStream, Megabytes_PassThroughAKilobyte) {
  const std::size_t size = GetParam() == SdoClient::Mode::block ? 10'000'000 : 1'000'000;
  LossyLine line(1, 0);
  Megabytes there(size, false);
  line.node.attach(0x200A, 0x200A, there);
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

}  // namespace
}  // namespace canopus::canopen::sdo_stream_test
