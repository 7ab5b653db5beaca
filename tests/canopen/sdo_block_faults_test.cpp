// Block transfers between our client and our server over a line that loses, repeats and holds up frames.
// Frames of one direction never overtake each other: CAN does not do that.

#include <algorithm>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/canopen/sdo/sdo_client.hpp"

#include "canopen/conversation.hpp"

namespace canopus::canopen::sdo_block_faults_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

enum class Fault : std::uint8_t { lost, twice, held_up };

struct Disturbance {
  unsigned frame = 0;  // the how-manieth of both directions
  Fault fault = Fault::lost;
  can::Duration hold_up{};
};

struct Kind {
  bool upload = false;
  bool with_crc = true;
  bool with_size = true;
};

class Line final : public SdoClientListener {
 public:
  Line(Kind kind, std::vector<Disturbance> disturbances)
      : node(standard_objects().build(), 5, from_server, {.sdo_maximum_download = 1U << 20}),
        kind_(kind),
        disturbances_(std::move(disturbances)) {
    node.power_on(now);
    from_server.frames.clear();
    client.set_server(5);
    client.set_switch_threshold(0);
  }

  void transfer(const Bytes& value) {
    if (kind_.upload) {
      node.dictionary().assign(domain(), value);
      client.upload(0x200A, 0, *this, now, 500ms, SdoClient::Mode::block);
    } else {
      source_.rest = value;
      std::optional<std::uint32_t> size;
      if (kind_.with_size) size = static_cast<std::uint32_t>(value.size());
      client.download(0x200A, 0, source_, size, *this, now, 500ms, SdoClient::Mode::block);
    }
    // The server's side comes to its end, too.
    for (unsigned step = 0; step < 20'000 && (client.busy() || now < can::Time(20s)); ++step) {
      deliver(from_client, [&](const can::Frame& frame) { node.receive(frame, now); });
      deliver(from_server, [&](const can::Frame& frame) { client.receive(frame, now); });
      can::Time next = std::min({client.deadline(), node.deadline(), from_client.next(), from_server.next()});
      if (next == can::never) break;
      now = std::max(now + 100us, next);
      if (client.deadline() <= now) client.tick(now);
      if (node.deadline() <= now) node.tick(now);
    }
  }

  [[nodiscard]] bool succeeded() const {
    return finished == 1 && !client.busy() && client.abort_code() == AbortCode::none;
  }
  [[nodiscard]] Bytes stored() const {
    const auto bytes = node.dictionary().bytes(domain());
    return {bytes.begin(), bytes.end()};
  }
  /// At the receiver: the server's object, or what the client has.
  [[nodiscard]] Bytes delivered() const {
    return kind_.upload ? Bytes(client.data().begin(), client.data().end()) : stored();
  }
  void sdo_finished(SdoClient&, can::Time) override { ++finished; }

  struct Queue final : can::Sink {
    bool send(const can::Frame& frame) override {
      if (frames.size() >= capacity) return false;
      frames.push_back(frame);
      return true;
    }
    [[nodiscard]] can::Time next() const { return frames.empty() ? can::never : free_at; }
    std::deque<can::Frame> frames;
    std::size_t capacity = 1000;
    can::Time free_at{};
    bool is_told = false;  // what happens to the first of the frames
  };
  struct Source final : ByteSource {
    std::expected<std::size_t, AbortCode> read(std::span<std::uint8_t> into) override {
      const std::size_t count = std::min(into.size(), rest.size());
      std::copy_n(rest.begin(), count, into.begin());
      rest = rest.subspan(count);
      return count;
    }
    std::span<const std::uint8_t> rest;
  };

  Queue from_client;
  Queue from_server;
  can::Time now{};
  Node node;
  SdoClient client{from_client};
  int finished = 0;
  std::vector<std::string> passed;  // every frame, as text, in the order of the line

 private:
  [[nodiscard]] Entry domain() const { return node.dictionary().description().find(0x200A, 0); }

  void deliver(Queue& queue, const std::function<void(const can::Frame&)>& receive) {
    if (queue.frames.empty() || now < queue.free_at) return;
    can::Frame frame = queue.frames.front();
    bool lost = false;
    bool twice = false;
    if (!std::exchange(queue.is_told, true)) {
      const auto number = static_cast<unsigned>(passed.size());
      passed.push_back(to_text(frame));
      for (const Disturbance& d : disturbances_) {
        if (d.frame != number) continue;
        if (d.fault == Fault::held_up) queue.free_at = now + d.hold_up;
        lost = lost || d.fault == Fault::lost;
        twice = twice || d.fault == Fault::twice;
      }
      if (now < queue.free_at) return;
    }
    queue.is_told = false;
    queue.frames.pop_front();
    queue.free_at = now + 100us;
    // Neither side has a CRC when the initiate frames do not say so.
    if (!kind_.with_crc && first_[&queue == &from_server]) frame.data[0] &= 0xFB;
    first_[&queue == &from_server] = false;
    if (lost) return;
    receive(frame);
    if (twice) receive(frame);
  }

  Kind kind_;
  std::vector<Disturbance> disturbances_;
  Source source_;
  bool first_[2] = {true, true};
};

/// Of any length different everywhere, or the same everywhere: repeated pieces show in the length alone.
Bytes value_of(std::size_t size, bool constant) {
  Bytes bytes(size, 0);
  std::uint32_t state = 0x1234567;
  for (std::uint8_t& byte : bytes) {
    state = state * 1664525U + 1013904223U;
    if (!constant) byte = static_cast<std::uint8_t>(state >> 24);
  }
  return bytes;
}

/// What a lost frame costs, from the frame alone and its neighbours.
enum class Part : std::uint8_t {
  segment,
  end_of_sub_block,
  only_segment_of_sub_block,
  confirmation,
  frame_of_a_handshake,
};

Part part_of(const std::vector<std::string>& frames, std::size_t i, Kind kind) {
  const bool from_sender = (frames[i].substr(0, 3) == "605") != kind.upload;
  const std::size_t initiation = kind.upload ? 3 : 2;
  if (i < initiation || i + 2 >= frames.size()) return Part::frame_of_a_handshake;
  if (!from_sender) return Part::confirmation;
  const auto is_of_the_sender = [&](std::size_t n) {
    return n >= initiation && frames[n].substr(0, 3) == frames[i].substr(0, 3);
  };
  if (is_of_the_sender(i + 1)) return Part::segment;
  return is_of_the_sender(i - 1) ? Part::end_of_sub_block : Part::only_segment_of_sub_block;
}

class SdoBlockFault : public testing::TestWithParam<std::size_t> {};

// Each frame of the transfer in turn is lost. What the receiver can see by itself is repeated; what ends in
// silence is repeated if something of the sub-block came and there is a CRC; everything else ends the
// transfer.
TEST_P(SdoBlockFault, OneFrameLost) {
  for (const bool constant : {false, true}) {
    const Bytes value = value_of(GetParam(), constant);
    for (const bool upload : {false, true}) {
      for (const bool with_crc : {false, true}) {
        const Kind kind{.upload = upload, .with_crc = with_crc, .with_size = false};
        Line whole(kind, {});
        whole.transfer(value);
        ASSERT_TRUE(whole.succeeded());
        ASSERT_EQ(whole.delivered(), value);
        for (unsigned i = 0; i < whole.passed.size(); ++i) {
          const Part part = part_of(whole.passed, i, kind);
          if (part == Part::segment && i > 8 && i % 16 != 0) continue;  // one is like the other
          Line line(kind, {{.frame = i}});
          line.transfer(value);
          SCOPED_TRACE(std::string(upload ? "upload" : "download") + (with_crc ? " with CRC, " : ", ") +
                       "lost " + std::to_string(i) + ": " + whole.passed[i]);
          ASSERT_EQ(line.finished, 1);
          ASSERT_TRUE(!line.succeeded() || line.delivered() == value);
          ASSERT_TRUE(line.stored() == value || (!upload && line.stored().empty()));
          switch (part) {
            case Part::segment: ASSERT_TRUE(line.succeeded()); break;
            case Part::end_of_sub_block: ASSERT_EQ(line.succeeded(), with_crc); break;
            case Part::only_segment_of_sub_block:
            case Part::confirmation: ASSERT_FALSE(line.succeeded()); break;
            case Part::frame_of_a_handshake: break;
          }
        }
      }
    }
  }
}

// One segment; a full sub-block; that and one segment; and seven; two full ones; these and one segment.
INSTANTIATE_TEST_SUITE_P(Bytes, SdoBlockFault, testing::Values(5, 889, 890, 938, 1778, 1780));

// A line that is held up for less than a time-out, and loses nothing, costs time alone.
TEST(SdoBlockFaultOnce, LateRestOfASubBlock_CostsNothingButTime) {
  const Bytes value = value_of(2000, false);
  for (const bool upload : {false, true}) {
    for (unsigned i = 5; i < 125; i += 7) {
      Line line({.upload = upload}, {{.frame = i, .fault = Fault::held_up, .hold_up = 300ms}});
      line.transfer(value);
      EXPECT_TRUE(line.succeeded()) << i;
      EXPECT_EQ(line.delivered(), value) << i;
    }
  }
}

TEST(SdoBlockFaultOnce, OneFrameTwice_NeverDeliversWrongData) {
  for (const std::size_t size : {5U, 455U, 890U}) {
    for (const bool constant : {false, true}) {
      const Bytes value = value_of(size, constant);
      for (const bool upload : {false, true}) {
        for (const bool with_crc : {false, true}) {
          const Kind kind{.upload = upload, .with_crc = with_crc, .with_size = false};
          for (unsigned i = 0; i < size / 7 + 12; i += i < 120 ? 3 : 1) {
            Line line(kind, {{.frame = i, .fault = Fault::twice}});
            line.transfer(value);
            SCOPED_TRACE(std::to_string(size) + " bytes, frame " + std::to_string(i));
            ASSERT_TRUE(!line.succeeded() || line.delivered() == value);
            ASSERT_TRUE(line.stored() == value || (!upload && line.stored().empty()));
          }
        }
      }
    }
  }
}

// Whatever gets lost and is held up: who reports success has the value, and an object has all or nothing of
// it. Frames that come twice besides may deceive who has no CRC (sdo_block.hpp).
RC_GTEST_PROP(SdoBlockFaults, WhatReportsSuccessIsRight, ()) {
  const auto size = *rc::gen::inRange<std::size_t>(5, 2500);
  const Kind kind{.upload = *rc::gen::arbitrary<bool>(),
                  .with_crc = *rc::gen::arbitrary<bool>(),
                  .with_size = *rc::gen::arbitrary<bool>()};
  const bool repeats = kind.with_crc && *rc::gen::arbitrary<bool>();
  const auto frames = static_cast<unsigned>(size / 7 + 12);
  const auto count = *rc::gen::inRange(1, 8);
  std::vector<Disturbance> disturbances;
  for (int i = 0; i < count; ++i) {
    const int fault = *rc::gen::inRange(0, repeats ? 3 : 2);
    disturbances.push_back({.frame = *rc::gen::inRange(0U, frames),
                            .fault = fault == 0   ? Fault::lost
                                     : fault == 1 ? Fault::held_up
                                                  : Fault::twice,
                            .hold_up = *rc::gen::inRange(1, 700) * 1ms});
  }
  const Bytes value = value_of(size, *rc::gen::arbitrary<bool>());
  Line line(kind, disturbances);
  line.from_client.capacity = *rc::gen::element<std::size_t>(40, 1000);
  line.from_server.capacity = *rc::gen::element<std::size_t>(40, 1000);
  line.transfer(value);
  RC_ASSERT(line.finished == 1);
  RC_ASSERT(!line.succeeded() || line.delivered() == value);
  RC_ASSERT(line.stored() == value || (!kind.upload && line.stored().empty()));
  RC_TAG(line.succeeded() ? "success" : "abort");
}

}  // namespace
}  // namespace canopus::canopen::sdo_block_faults_test
