#include "canopus/link/slcan/slcan_text.hpp"

#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::link::slcan_text_test {
namespace {

using can::Frame;
using testing::ElementsAre;
using testing::IsEmpty;
using Kind = SlcanLine::Kind;

struct Seen {
  Kind kind;
  Frame frame{};
  int flags = 0;

  friend bool operator==(const Seen&, const Seen&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Seen& seen) {
    return out << "kind " << static_cast<int>(seen.kind) << " frame " << std::hex << seen.frame.identifier
               << " dlc " << int{seen.frame.dlc} << " flags " << seen.flags;
  }
};

std::vector<Seen> read(SlcanReader& reader, std::string_view bytes) {
  std::vector<Seen> seen;
  reader.receive(bytes, [&](const SlcanLine& line) { seen.push_back({line.kind, line.frame, line.flags}); });
  return seen;
}
std::vector<Seen> read(std::string_view bytes) {
  SlcanReader reader;
  return read(reader, bytes);
}
std::string text_of(const Frame& frame) {
  std::array<char, slcan_max_line> out{};
  return {out.data(), write_slcan_frame(out, frame)};
}
Seen frame(const Frame& frame) { return {Kind::frame, frame}; }

TEST(SlcanText, FramesAreWrittenAsTheProtocolHasThem) {
  EXPECT_EQ(text_of(can::data_frame(0x601, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0xAB})),
            "t60184018100100000\x30"
            "AB\r");
  EXPECT_EQ(text_of(can::data_frame(0x80)), "t0800\r");
  EXPECT_EQ(text_of({.identifier = 0x1FFFFFFF, .extended = true, .dlc = 1, .data = {5}}), "T1FFFFFFF105\r");
  EXPECT_EQ(text_of(can::remote_frame(0x705, 1)), "r7051\r");
  EXPECT_EQ(text_of({.identifier = 0x1, .extended = true, .remote = true, .dlc = 8}), "R000000018\r");
  EXPECT_EQ(text_of({.identifier = 0x1, .dlc = 15}), "t00180000000000000000\r")
      << "lengths above 8 are 8 bytes";
}

TEST(SlcanText, FramesAreRead) {
  EXPECT_THAT(
      read("t1812ab0C\rT1FFFFFFF0\rr7051\rR000000018\r"),
      ElementsAre(frame(can::data_frame(0x181, {0xAB, 0x0C})),
                  frame({.identifier = 0x1FFFFFFF, .extended = true}), frame(can::remote_frame(0x705, 1)),
                  frame({.identifier = 1, .extended = true, .remote = true, .dlc = 8})));
}

TEST(SlcanText, TimeStampsBehindAFrameArePassedOver) {
  EXPECT_THAT(read("t18110512AB\rr70511234\rt18110500112233\r"),
              ElementsAre(frame(can::data_frame(0x181, {5})), frame(can::remote_frame(0x705, 1)),
                          frame(can::data_frame(0x181, {5}))));
}

TEST(SlcanText, AnswersAreToldApart) {
  EXPECT_THAT(read("\rz\rZ\r\aF24\rV1013\rNA123\r"),
              ElementsAre(Seen{Kind::done}, Seen{Kind::taken}, Seen{Kind::taken}, Seen{Kind::refused},
                          Seen{Kind::flags, {}, 0x24}, Seen{Kind::other}, Seen{Kind::other}));
}

TEST(SlcanText, WhatIsNoFrameIsNone) {
  for (const char* text : {"t181", "t1812ab", "t181905", "t8000", "tXYZ0", "T200000000", "t18110", "t1811055",
                           "t1811051", "r705", "r7059", "zz", "F2", "F245", "Fxx", "d1810", "b1810"}) {
    EXPECT_THAT(read(std::string(text) + "\r"), ElementsAre(Seen{Kind::other})) << text;
  }
}

TEST(SlcanText, RefusalEndsALineThatWasBegun) {
  EXPECT_THAT(read("t18\a\rt0800\r"),
              ElementsAre(Seen{Kind::refused}, Seen{Kind::done}, frame(can::data_frame(0x80))));
}

TEST(SlcanText, GarbageWithoutEndIsThrownAwayUpToTheNextEnd) {
  SlcanReader reader;
  EXPECT_THAT(read(reader, std::string(100'000, 't')), IsEmpty());
  EXPECT_THAT(read(reader, "\rt0800\r"), ElementsAre(Seen{Kind::other}, frame(can::data_frame(0x80))));
}

TEST(SlcanText, BitRatesOfTheProtocolHaveTheirNumber) {
  EXPECT_EQ(slcan_bit_rate(10'000), "S0");
  EXPECT_EQ(slcan_bit_rate(250'000), "S5");
  EXPECT_EQ(slcan_bit_rate(1'000'000), "S8");
}

// BTR0 and BTR1 of an SJA1000 at 16 MHz: bit rate = 8 MHz / (BRP (1 + TSEG1 + TSEG2)).
TEST(SlcanText, OtherBitRatesAreRegistersThatGiveThem) {
  for (const std::uint32_t rate : {40'000U, 62'500U, 80'000U, 200'000U, 400'000U}) {
    const auto text = slcan_bit_rate(rate);
    ASSERT_TRUE(text && text->size() == 5 && text->front() == 's') << rate;
    const auto registers = std::stoul(text->substr(1), nullptr, 16);
    const auto prescaler = (registers >> 8 & 0x3F) + 1;
    const auto first = (registers & 0x0F) + 1;
    const auto second = (registers >> 4 & 0x07) + 1;
    EXPECT_EQ(8'000'000 / (prescaler * (1 + first + second)), rate) << *text;
    EXPECT_GE((1 + first) * 1000 / (1 + first + second), 750U) << *text;
  }
  EXPECT_EQ(slcan_bit_rate(333'333), std::nullopt);
  EXPECT_EQ(slcan_bit_rate(1'500'000), std::nullopt);
  EXPECT_EQ(slcan_bit_rate(0), std::nullopt);
}

RC_GTEST_PROP(SlcanTextProperties, CutAnywhere_AreTheSameLines, (const std::string& garbage)) {
  const std::string text = "t1812AB0C\r" + garbage + "\rz\rT1FFFFFFF105\r\aF00\r";
  SlcanReader reader;
  std::vector<Seen> seen;
  for (std::string_view rest = text; !rest.empty();) {
    const auto size = *rc::gen::inRange<std::size_t>(1, rest.size() + 1);
    for (const Seen& line : read(reader, rest.substr(0, size))) seen.push_back(line);
    rest.remove_prefix(size);
  }
  RC_ASSERT(seen == read(text));
}

}  // namespace
}  // namespace canopus::link::slcan_text_test
