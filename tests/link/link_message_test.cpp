#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/link/socketcan/netlink.hpp"

namespace canopus::link::link_message_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Little-endian, as on the machines that the tests run on.
struct Message {
  Bytes bytes;
  Message& u8(unsigned value) { return bytes.push_back(static_cast<std::uint8_t>(value)), *this; }
  Message& u16(unsigned value) { return u8(value & 0xFF).u8(value >> 8); }
  Message& u32(std::uint32_t value) { return u16(value & 0xFFFF).u16(value >> 16); }
  Message& text(const std::string& value) {
    for (const char c : value) u8(static_cast<unsigned char>(c));
    return u8(0);
  }
  Message& add(const Bytes& more) { return bytes.insert(bytes.end(), more.begin(), more.end()), *this; }
};
Bytes attribute(unsigned type, const Bytes& content) {
  Message message;
  message.u16(static_cast<unsigned>(content.size()) + 4).u16(type).add(content);
  while (message.bytes.size() % 4 != 0) message.u8(0);
  return message.bytes;
}
Bytes joined(const std::vector<Bytes>& parts) {
  Message message;
  for (const Bytes& part : parts) message.add(part);
  return message.bytes;
}

/// RTM_NEWLINK (16) of can0, up: bus-off, TEC 256, REC 3, 250 kbit/s at 87.5 %, restart after 100 ms.
Bytes can0(unsigned type = 16) {
  const Bytes state = attribute(4, Message{}.u32(3).bytes);
  const Bytes counters = attribute(8, Message{}.u16(256).u16(3).bytes);
  const Bytes timing =
      attribute(1, Message{}.u32(250'000).u32(875).u32(0).u32(0).u32(0).u32(0).u32(0).u32(0).bytes);
  const Bytes restart = attribute(6, Message{}.u32(100).bytes);
  const Bytes information = attribute(
      18, joined({attribute(1, {'c', 'a', 'n'}), attribute(2, joined({state, counters, timing, restart}))}));
  const Bytes name = attribute(3, Message{}.text("can0").bytes);
  const Bytes head = Message{}.u8(0).u8(0).u16(280).u32(7).u32(0x41).u32(0).bytes;
  const Bytes body = joined({head, name, information});
  return Message{}
      .u32(static_cast<std::uint32_t>(body.size()) + 16)
      .u16(type)
      .u16(0)
      .u32(1)
      .u32(0)
      .add(body)
      .bytes;
}

TEST(LinkMessage, Controller_IsReadWithItsStateCountersAndTiming) {
  const auto messages = read_link_messages(can0());
  ASSERT_EQ(messages.size(), 1U);
  const LinkMessage& link = messages[0];
  EXPECT_EQ(link.kind, LinkMessage::Kind::link);
  EXPECT_EQ(link.index, 7);
  EXPECT_TRUE(link.up);
  EXPECT_EQ(link.name, "can0");
  EXPECT_EQ(link.type, "can");
  EXPECT_EQ(link.restart_ms, 100U);
  EXPECT_EQ(link.controller, (ControllerStatus{.state = can::ErrorState::bus_off,
                                               .transmit_errors = 256,
                                               .receive_errors = 3,
                                               .bit_rate = 250'000,
                                               .sample_point = 875,
                                               .counters_known = true}));
}

TEST(LinkMessage, SeveralMessages_AreReadInTheirOrder) {
  const Bytes error = Message{}.u32(20).u16(2).u16(0).u32(1).u32(0).u32(static_cast<std::uint32_t>(-1)).bytes;
  const auto messages = read_link_messages(joined({error, can0(17)}));
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_EQ(messages[0].kind, LinkMessage::Kind::answer);
  EXPECT_EQ(messages[0].error, 1) << "EPERM";
  EXPECT_EQ(messages[1].kind, LinkMessage::Kind::gone);
}

TEST(LinkMessage, CutMessage_IsNone) {
  const Bytes whole = can0();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_TRUE(read_link_messages(std::span(whole).first(size)).empty()) << size;
  }
}

TEST(LinkMessage, RequestForABitRate_IsNestedAsTheKernelWantsIt) {
  const Bytes timing =
      attribute(1, Message{}.u32(125'000).u32(0).u32(0).u32(0).u32(0).u32(0).u32(0).u32(0).bytes);
  const Bytes information = attribute(18, joined({attribute(1, {'c', 'a', 'n'}), attribute(2, timing)}));
  const Bytes head = Message{}.u8(0).u8(0).u16(0).u32(7).u32(0).u32(0).bytes;
  const Bytes body = joined({head, information});
  const Bytes expected = Message{}
                             .u32(static_cast<std::uint32_t>(body.size()) + 16)
                             .u16(16)
                             .u16(5)
                             .u32(9)
                             .u32(0)
                             .add(body)
                             .bytes;
  EXPECT_EQ(set_link_bit_rate(7, 125'000, 9), expected);
}

RC_GTEST_PROP(LinkMessageProperties, AnyDamage_IsSurvived, (Bytes garbage)) {
  Bytes bytes = can0();
  for (int i = 0; i < 4; ++i) {
    bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = *rc::gen::arbitrary<std::uint8_t>();
  }
  (void)read_link_messages(bytes);
  (void)read_link_messages(garbage);
}

}  // namespace
}  // namespace canopus::link::link_message_test
