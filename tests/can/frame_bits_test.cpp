#include "canopus/can/frame_bits.hpp"

#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "can/random_frame.hpp"
#include "can/slow_frame.hpp"
#include "support/random_cases.hpp"

namespace canopus::can::frame_bits_test {
namespace {

// A frame written out by hand: the bits of each field, a stuff bit in brackets where it is on the wire.
struct Vector {
  const char* name;
  Frame frame;
  std::uint16_t crc;
  const char* wire;
};

const Vector vectors[] = {
    {"base identifier 123H, one byte 55H", data_frame(0x123, {0x55}), 0x2363,
     // SOF id          RTR IDE r0 DLC     data     CRC             del ack del EOF
     "0 00100100011 0 0 0 00(1)01 01010101 010001101100011 1 1 1 1111111"},
    {"base identifier 0, no data: a row of 34 dominant bits", data_frame(0x000, {}), 0x0000,
     "0 0000(1)00000(1)00 0 0 0(1) 0000 0(1)00000(1)00000(1)0000 1 1 1 1111111"},
    {"a remote frame carries no data whatever its DLC", remote_frame(0x555, 8), 0x608E,
     "0 10101010101 1 0 0 1000 1100000(1)10001110 1 1 1 1111111"},
    {"the highest base identifier and 64 recessive data bits",
     data_frame(0x7FF, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}), 0x4C89,
     "0 11111(0)11111(0)1 0 0 0 1000 11111(0)111 11(0)11111(0)1 1111(0)1111 1(0)11111(0)11 111(0)11111(0)"
     " 11111(0)111 11(0)11111(0)1 1111(0)1111 1(0)00110010001001 1 1 1 1111111"},
    {"stuff bits that begin the next row", data_frame(0x078, {0x3C, 0x3C}), 0x2353,
     "0 0000(1)1111(0)000 0(1) 0 0 0010 00111100 00111100 010001101010011 1 1 1 1111111"},
    // SOF id 28-18 SRR IDE id 17-0 RTR r1 r0 DLC data CRC
    {"extended identifier 12345678H, three bytes",
     {.identifier = 0x12345678, .extended = true, .dlc = 3, .data = {0xDE, 0xAD, 0x00}},
     0x0C36,
     "0 10010001101 1 1 000101011001111000 0 0(1)0 0011 11011110 10101101 00000(1)000 00(1)0110000110110"
     " 1 1 1 1111111"},
    {"the highest extended identifier, remote, DLC 15",
     {.identifier = 0x1FFF'FFFF, .extended = true, .remote = true, .dlc = 15},
     0x48B7,
     "0 11111(0)11111(0)1 1 1 11(0)11111(0)11111(0)11111(0)1 1 00 1111 1(0)00100010110111 1 1 1 1111111"},
};

std::string without_marks(std::string wire) {
  std::erase_if(wire, [](char c) { return c != '0' && c != '1'; });
  return wire;
}

std::string without_stuff_bits(const std::string& wire) {
  std::string bits;
  bool stuff = false;
  for (const char c : wire) {
    if (c == '(' || c == ')') {
      stuff = c == '(';
    } else if (!stuff && c != ' ') {
      bits += c;
    }
  }
  return bits;
}

TEST(FrameBits, FramesWrittenOutByHand_HaveTheirLengthAndCrc) {
  for (const Vector& vector : vectors) {
    SCOPED_TRACE(vector.name);
    EXPECT_EQ(frame_bits(vector.frame), without_marks(vector.wire).size());
    EXPECT_EQ(frame_crc(vector.frame), vector.crc);
  }
}

TEST(FrameBits, TheSlowModel_GivesTheWireWrittenOutByHand) {
  for (const Vector& vector : vectors) {
    SCOPED_TRACE(vector.name);
    EXPECT_EQ(slow::wire(vector.frame), without_marks(vector.wire));
    EXPECT_EQ(without_stuff_bits(vector.wire).size(),
              (vector.frame.extended ? 64 : 44) + 8 * vector.frame.length());
  }
}

TEST(FrameBits, RandomFramesOfAllKinds_HaveTheLengthAndCrcOfTheSlowModel) {
  std::mt19937_64 random(20'260'101);
  for (unsigned left = support::random_cases(200'000, 1'000'000); left != 0; --left) {
    const Frame frame = random_frame(random);
    const std::string header_and_data = slow::before_crc(frame);
    ASSERT_EQ(frame_crc(frame), slow::crc(header_and_data)) << header_and_data;
    ASSERT_EQ(frame_bits(frame), slow::wire(frame).size()) << header_and_data;
  }
}

TEST(FrameBits, NoFrame_IsLongerThanItsWorstCase) {
  std::mt19937_64 random(7);
  for (int count = 0; count < 100'000; ++count) {
    const Frame frame = random_frame(random);
    const std::size_t n = frame.length();
    ASSERT_LE(frame_bits(frame) + intermission_bits, (frame.extended ? 80 : 55) + 10 * n);
    ASSERT_GE(frame_bits(frame) + intermission_bits, (frame.extended ? 67 : 47) + 8 * n);
  }
}

TEST(BitTime, ForEveryCiaBitRate_IsAWholeNumberOfNanoseconds) {
  using std::chrono_literals::operator""ns;
  EXPECT_EQ(bit_time(1, 1'000'000), 1'000ns);
  EXPECT_EQ(bit_time(1, 800'000), 1'250ns);
  EXPECT_EQ(bit_time(1, 500'000), 2'000ns);
  EXPECT_EQ(bit_time(1, 250'000), 4'000ns);
  EXPECT_EQ(bit_time(1, 125'000), 8'000ns);
  EXPECT_EQ(bit_time(1, 100'000), 10'000ns);
  EXPECT_EQ(bit_time(1, 50'000), 20'000ns);
  EXPECT_EQ(bit_time(1, 20'000), 50'000ns);
  EXPECT_EQ(bit_time(1, 10'000), 100'000ns);
}

}  // namespace
}  // namespace canopus::can::frame_bits_test
