#include "canopus/link/udp_multicast/multicast_datagram.hpp"

#include <array>
#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::link::multicast_datagram_test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Kind = MulticastMessage::Kind;
using namespace std::chrono_literals;

Bytes from_hex(std::string_view text) {
  Bytes bytes;
  for (; text.size() >= 2; text.remove_prefix(2)) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(std::string(text.substr(0, 2)), nullptr, 16)));
  }
  return bytes;
}

// What python-can 4.1.0 sends.
const char* const python_data =
    "8ba974696d657374616d70cb41d954fc40200000ae6172626974726174696f6e5f6964cd0181ae69735f657874656e6465645f69"
    "64c2af69735f72"
    "656d6f74655f6672616d65c2ae69735f6572726f725f6672616d65c2a76368616e6e656cc0a3646c6303a464617461c4030102ff"
    "a569735f6664c2"
    "ae626974726174655f737769746368c2b56572726f725f73746174655f696e64696361746f72c2";
const char* const python_remote =
    "8ba974696d657374616d70cb0000000000000000ae6172626974726174696f6e5f6964ce1fffffffae69735f657874656e646564"
    "5f6964c3af69735f"
    "72656d6f74655f6672616d65c3ae69735f6572726f725f6672616d65c2a76368616e6e656cc0a3646c6308a464617461c400a569"
    "735f6664c2ae6269"
    "74726174655f737769746368c2b56572726f725f73746174655f696e64696361746f72c2";
const char* const python_fd =
    "8ba974696d657374616d70cb0000000000000000ae6172626974726174696f6e5f696401ae69735f657874656e6465645f6964c2"
    "af69735f72656d6f"
    "74655f6672616d65c2ae69735f6572726f725f6672616d65c2a76368616e6e656cc0a3646c630ca464617461c40c000000000000"
    "000000000000a569"
    "735f6664c3ae626974726174655f737769746368c2b56572726f725f73746174655f696e64696361746f72c2";

Bytes written(const can::Frame& frame, std::chrono::nanoseconds time) {
  std::array<std::uint8_t, multicast_max_datagram> out{};
  const std::size_t size = write_multicast_datagram(out, frame, time);
  return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(size)};
}

TEST(MulticastDatagram, DataFrameOfPythonCan_IsRead) {
  const auto message = read_multicast_datagram(from_hex(python_data));
  ASSERT_TRUE(message) << message.error();
  EXPECT_EQ(message->kind, Kind::frame);
  EXPECT_EQ(message->frame, can::data_frame(0x181, {1, 2, 0xFF}));
  EXPECT_EQ(message->time, 1'700'000'000'500ms);
}

TEST(MulticastDatagram, ExtendedRemoteFrameOfPythonCan_IsRead) {
  const auto message = read_multicast_datagram(from_hex(python_remote));
  ASSERT_TRUE(message) << message.error();
  EXPECT_EQ(message->frame,
            (can::Frame{.identifier = 0x1FFFFFFF, .extended = true, .remote = true, .dlc = 8}));
}

TEST(MulticastDatagram, CanFdFrame_IsToldApart) {
  const auto message = read_multicast_datagram(from_hex(python_fd));
  ASSERT_TRUE(message) << message.error();
  EXPECT_EQ(message->kind, Kind::fd_frame);
}

// The same bytes but for the identifier, whose form MessagePack leaves open: ours has always four bytes.
TEST(MulticastDatagram, FrameIsWrittenAsPythonCanDoes) {
  std::string expected = python_data;
  expected.replace(expected.find("cd0181"), 6, "ce00000181");
  EXPECT_EQ(written(can::data_frame(0x181, {1, 2, 0xFF}), 1'700'000'000'500ms), from_hex(expected));
  EXPECT_EQ(written({.identifier = 0x1FFFFFFF, .extended = true, .remote = true, .dlc = 8}, 0ns),
            from_hex(python_remote));
}

TEST(MulticastDatagram, MistakesAreSaid) {
  const auto error = [](const Bytes& bytes) {
    const auto message = read_multicast_datagram(bytes);
    return message ? std::string() : std::string(message.error());
  };
  Bytes bytes = from_hex(python_data);
  EXPECT_EQ(error({}), "it is cut, or no MessagePack");
  EXPECT_EQ(error({0xC1}), "it is cut, or no MessagePack");
  EXPECT_EQ(error({0x93, 1, 2, 3}), "it is no map of a message's fields");
  EXPECT_EQ(error({0x81, 1, 2}), "the name of a field is no text");
  EXPECT_EQ(error({0x80}), "a field of the message is missing");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(error({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}),
              "it is cut, or no MessagePack")
        << size;
  }
  bytes.push_back(0);
  EXPECT_EQ(error(bytes), "there are bytes behind the message");
  const auto with = [](const char* from, const char* to) {
    std::string text = python_data;
    const std::size_t place = text.find(from);
    EXPECT_NE(place, std::string::npos);
    return from_hex(text.replace(place, std::string(from).size(), to));
  };
  EXPECT_EQ(error(with("cd0181", "cd0800")), "its identifier is too high");
  EXPECT_EQ(error(with("cd0181", "d1ffff")), "a field of the message has another type");
  EXPECT_EQ(error(with("646c6303", "646c6304")), "its data are not as long as its length says");
  EXPECT_EQ(error(with("646c6303", "646c6309")), "its length is above 8");
  EXPECT_EQ(error(with("6964c2", "6964c0")), "a field of the message has another type");
}

TEST(MulticastDatagram, FieldsWeDoNotKnow_ArePassedOverHoweverDeep) {
  Bytes bytes = from_hex(python_data);
  bytes[0] = 0x8C;
  // "x": [{1: [nil, "ab"]}, 300, -5, 2.5f, a byte of an extension]
  for (const int byte : {0xA1, int{'x'}, 0x95, 0x81, 1,    0x92, 0xC0, 0xA2, 0x61, 0x62, 0xCD,
                         1,    0x2C,     0xFB, 0xCA, 0x40, 0x20, 0,    0,    0xD4, 7,    9}) {
    bytes.push_back(static_cast<std::uint8_t>(byte));
  }
  const auto message = read_multicast_datagram(bytes);
  ASSERT_TRUE(message) << message.error();
  EXPECT_EQ(message->frame, can::data_frame(0x181, {1, 2, 0xFF}));
}

TEST(MulticastDatagram, HugeCounts_EndWithTheBytes) {
  EXPECT_FALSE(read_multicast_datagram(
      Bytes{0xDF, 0xFF, 0xFF, 0xFF, 0xFF, 0xA1, 'x', 0xDD, 0xFF, 0xFF, 0xFF, 0xFF, 0xC0}));
  EXPECT_FALSE(read_multicast_datagram(Bytes{0x81, 0xDB, 0xFF, 0xFF, 0xFF, 0xFF, 'x'}));
}

RC_GTEST_PROP(MulticastDatagramProperties, AnyBytes_AreAFrameOrAMistake, (Bytes bytes, bool damaged)) {
  if (damaged) {
    bytes = from_hex(python_data);
    for (int i = 0; i < 3; ++i)
      bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = *rc::gen::arbitrary<std::uint8_t>();
  }
  const auto message = read_multicast_datagram(bytes);
  if (!message || message->kind == Kind::fd_frame) return;
  RC_ASSERT(message->frame.dlc <= 8);
  for (std::size_t i = message->frame.length(); i < 8; ++i) RC_ASSERT(message->frame.data[i] == 0);
}

}  // namespace
}  // namespace canopus::link::multicast_datagram_test
