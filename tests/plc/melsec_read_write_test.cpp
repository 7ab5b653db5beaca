// Conversations in which everything is right. Every byte is written here by hand, or taken from the example
// in a manual; none comes from the code under test.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plc/conversation.hpp"

namespace canopus::plc::melsec_read_write_test {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;
using testing::Plc;

TEST(Melsec, BatchReadWords_OfD100_IsTheManualsExample) {
  Plc plc;
  plc.word(Device::d, 101, 0x0101);
  plc.word(Device::d, 102, 0x0102);
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0c 00 04 00 01 04 00 00 64 00 00 a8 03 00"),
            "d0 00 00 ff ff 03 00 08 00 00 00 00 00 01 01 02 01");
}

TEST(Melsec, BatchReadWords_InAscii_IsUpperCaseText) {
  Plc plc;
  plc.word(Device::d, 100, 0xABCD);
  EXPECT_EQ(plc.raw("500000FF03FF000018000404010000D*0001000003"), "D00000FF03FF0000100000ABCD00000000");
}

TEST(Melsec, BatchReadWords_InAsciiWithBlanks_IsTheSame) {
  Plc plc;
  plc.word(Device::d, 100, 0xABCD);
  EXPECT_EQ(plc.raw("500000FF03FF000018000404010000D    1000001"), "D00000FF03FF0000080000ABCD");
}

TEST(Melsec, BatchReadWords_InAscii_TakesHexadecimalNumbersOfW) {
  Plc plc;
  plc.word(Device::w, 0x1FF, 7);
  EXPECT_EQ(plc.raw("500000FF03FF000018000404010000W*0001FF0001"), "D00000FF03FF00000800000007");
}

TEST(Melsec, Frame4E_CarriesItsSerialNumberBack) {
  Plc plc;
  EXPECT_EQ(plc.request("54 00 34 12 00 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 01 00"),
            "d4 00 34 12 00 00 00 ff ff 03 00 04 00 00 00 00 00");
  Plc ascii;
  EXPECT_EQ(ascii.raw("54001234000000FF03FF000018001004010000D*0001000001"),
            "D4001234000000FF03FF00000800000000");
}

TEST(Melsec, BatchWriteWords_InBinaryAndAscii) {
  Plc plc;
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 10 00 10 00 01 14 00 00 64 00 00 a8 02 00 34 12 78 56"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_EQ(plc.word(Device::d, 100), 0x1234);
  EXPECT_EQ(plc.word(Device::d, 101), 0x5678);
  Plc ascii;
  EXPECT_EQ(ascii.raw("500000FF03FF000020001014010000D*000100000212345678"), "D00000FF03FF0000040000");
  EXPECT_EQ(ascii.word(Device::d, 100), 0x1234);
  EXPECT_EQ(ascii.word(Device::d, 101), 0x5678);
}

TEST(Melsec, BatchReadBits_PutsTwoPointsInAByteFirstOneHigh) {
  Plc plc;
  plc.bit(Device::m, 100, true);
  plc.bit(Device::m, 103, true);
  plc.bit(Device::m, 104, true);
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0c 00 10 00 01 04 01 00 64 00 00 90 05 00"),
            "d0 00 00 ff ff 03 00 05 00 00 00 10 01 10");
}

TEST(Melsec, BatchReadBits_InAscii_IsACharacterAPoint) {
  Plc plc;
  plc.module.x = 0b10110;
  EXPECT_EQ(plc.raw("500000FF03FF000018001004010001X*0000000005"), "D00000FF03FF000009000001101");
}

TEST(Melsec, BatchWriteBits_SetsOutputsOfTheModule) {
  Plc plc;
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0e 00 10 00 01 14 01 00 31 00 00 9d 03 00 10 10"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_THAT(plc.other_module.edges, ElementsAre(Pair(1U, true), Pair(3U, true)));
  EXPECT_EQ(Plc{}.raw("500000FF03FF00001B001014010001Y*0000310003101"), "D00000FF03FF0000040000");
}

TEST(Melsec, WordsOfBitDevices_HaveTheFirstPointInBit0) {
  Plc plc;
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0e 00 10 00 01 14 00 00 40 00 00 9d 01 00 05 80"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_TRUE(plc.bit(Device::y, 0x40));
  EXPECT_TRUE(plc.bit(Device::y, 0x42));
  EXPECT_TRUE(plc.bit(Device::y, 0x4F));
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 40 00 00 9d 01 00"),
            "d0 00 00 ff ff 03 00 04 00 00 00 05 80");
}

TEST(Melsec, IqrLayout_HasFourByteNumbersAndTwoByteCodes) {
  Plc plc;
  plc.word(Device::d, 100, 0x1234);
  EXPECT_EQ(plc.request("54 00 01 00 00 00 00 ff ff 03 00 0e 00 10 00 01 04 02 00 64 00 00 00 a8 00 01 00"),
            "d4 00 01 00 00 00 00 ff ff 03 00 04 00 00 00 34 12");
  EXPECT_EQ(Plc{}.raw("500000FF03FF00001C001004010002D***000001000001"), "D00000FF03FF00000800000000");
}

TEST(Melsec, BufferMemory_BySubcommand0080_InBothCodes) {
  Plc plc;
  plc.module.words[25] = 0x0280;
  EXPECT_EQ(
      plc.request("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 00 00 19 00 00 ab 00 00 00 00 f8 | 01 00"),
      "d0 00 00 ff ff 03 00 04 00 00 00 80 02");
  Plc ascii;
  ascii.other_module.words[256] = 0xBEEF;
  EXPECT_EQ(ascii.raw("500000FF03FF000024001004010080"
                      "00U003000G*000256000"
                      "0001"),
            "D00000FF03FF0000080000BEEF");
}

TEST(Melsec, BufferMemory_BySubcommand0082_InBothCodes) {
  Plc plc;
  plc.other_module.words[256] = 0xBEEF;
  EXPECT_EQ(
      plc.request(
          "54 00 02 00 00 00 00 ff ff 03 00 15 00 10 00 01 04 82 00 | 00 00 00 01 00 00 ab 00 00 00 03 00 f8 "
          "| 01 00"),
      "d4 00 02 00 00 00 00 ff ff 03 00 04 00 00 00 ef be");
  Plc ascii;
  ascii.other_module.words[256] = 0xBEEF;
  EXPECT_EQ(ascii.raw("500000FF03FF00002C001004010082"
                      "00U0030000G***00000002560000"
                      "0001"),
            "D00000FF03FF0000080000BEEF");
}

TEST(Melsec, BufferMemory_Written_ReachesTheModuleInOrderOfAddresses) {
  Plc plc;
  EXPECT_EQ(
      plc.request(
          "50 00 00 ff ff 03 00 17 00 10 00 01 14 80 00 | 00 00 c8 32 00 ab 00 00 00 00 f8 | 02 00 d2 04 "
          "ff ff"),
      "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_THAT(plc.module.writes, ElementsAre(Pair(13000U, 1234), Pair(13001U, 0xFFFF)));
}

TEST(Melsec, DeviceThroughTheExtendedLayout_IsTheDevice) {
  Plc plc;
  plc.word(Device::d, 5, 0x0005);
  EXPECT_EQ(
      plc.request("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 00 00 05 00 00 a8 00 00 00 00 00 | 01 00"),
      "d0 00 00 ff ff 03 00 04 00 00 00 05 00");
}

TEST(Melsec, ModuleBuffer0601_CountsInBytes) {
  Plc plc;
  plc.other_module.words[25] = 0x0280;
  plc.other_module.words[26] = 0x1234;
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0e 00 10 00 01 06 00 00 | 32 00 00 00 04 00 03 00"),
            "d0 00 00 ff ff 03 00 06 00 00 00 80 02 34 12");
  Plc ascii;
  ascii.other_module.words[25] = 0x0280;
  EXPECT_EQ(ascii.raw("500000FF03FF00001C001006010000"
                      "0000003200020003"),
            "D00000FF03FF00000800008002");
}

TEST(Melsec, ModuleBuffer1601_WritesWords) {
  Plc plc;
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 12 00 10 00 01 16 00 00 | 32 00 00 00 04 00 03 00 80 02 34 12"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_THAT(plc.other_module.writes, ElementsAre(Pair(25U, 0x0280), Pair(26U, 0x1234)));
}

TEST(Melsec, RandomRead_AnswersWordsThenDoubleWords) {
  Plc plc;
  plc.word(Device::d, 100, 0x1234);
  plc.word(Device::w, 10, 0x5678);
  plc.word(Device::w, 11, 0x9ABC);
  plc.bit(Device::m, 3, true);
  EXPECT_EQ(
      plc.request("50 00 00 ff ff 03 00 14 00 10 00 03 04 00 00 | 02 01 64 00 00 a8 00 00 00 90 0a 00 00 b4"),
      "d0 00 00 ff ff 03 00 0a 00 00 00 34 12 08 00 78 56 bc 9a");
  Plc ascii;
  ascii.word(Device::w, 10, 0x5678);
  ascii.word(Device::w, 11, 0x9ABC);
  EXPECT_EQ(ascii.raw("500000FF03FF000018001004030000"
                      "0001W*00000A"),
            "D00000FF03FF00000C00009ABC5678");
}

TEST(Melsec, RandomWriteWords_WritesWordsAndDoubleWords) {
  Plc plc;
  EXPECT_EQ(
      plc.request(
          "50 00 00 ff ff 03 00 16 00 10 00 02 14 00 00 | 01 01 64 00 00 a8 34 12 0a 00 00 b4 01 02 03 04"),
      "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_EQ(plc.word(Device::d, 100), 0x1234);
  EXPECT_EQ(plc.word(Device::w, 10), 0x0201);
  EXPECT_EQ(plc.word(Device::w, 11), 0x0403);
}

TEST(Melsec, RandomWriteBits_HasAByteOrInIqrAWordPerValue) {
  Plc plc;
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 11 00 10 00 02 14 01 00 | 02 31 00 00 9d 01 05 00 00 90 01"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_THAT(plc.other_module.edges, ElementsAre(Pair(1U, true)));
  EXPECT_TRUE(plc.bit(Device::m, 5));
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0f 00 10 00 02 14 03 00 | 01 06 00 00 00 90 00 01 00"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_TRUE(plc.bit(Device::m, 6));
}

TEST(Melsec, MultipleBlocks_WrittenAndRead) {
  Plc plc;
  EXPECT_EQ(
      plc.request(
          "50 00 00 ff ff 03 00 1a 00 10 00 06 14 00 00 | 01 01 | 64 00 00 a8 02 00 01 00 02 00 | 00 00 00 "
          "90 01 00 05 80"),
      "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_EQ(plc.word(Device::d, 101), 2);
  EXPECT_TRUE(plc.bit(Device::m, 15));
  EXPECT_EQ(
      plc.request(
          "50 00 00 ff ff 03 00 14 00 10 00 06 04 00 00 | 01 01 | 64 00 00 a8 02 00 | 00 00 00 90 01 00"),
      "d0 00 00 ff ff 03 00 08 00 00 00 01 00 02 00 05 80");
}

TEST(Melsec, Monitor_ReadsWhatWasRegistered) {
  Plc plc;
  plc.word(Device::d, 100, 0x1234);
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0c 00 10 00 01 08 00 00 | 01 00 64 00 00 a8"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 06 00 10 00 02 08 00 00"),
            "d0 00 00 ff ff 03 00 04 00 00 00 34 12");
}

TEST(Melsec, CpuModel_IsSixteenCharactersAndACode) {
  Plc plc;
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 06 00 10 00 01 01 00 00"),
            "d0 00 00 ff ff 03 00 14 00 00 00 52 30 34 43 50 55 20 20 20 20 20 20 20 20 20 20 00 48");
  EXPECT_EQ(Plc(q03udvcpu()).raw("500000FF03FF00000C001001010000"),
            "D00000FF03FF0000180000Q03UDVCPU       0366");
}

TEST(Melsec, Loopback_SendsItsTextBack) {
  EXPECT_EQ(Plc{}.request("50 00 00 ff ff 03 00 0d 00 10 00 19 06 00 00 | 05 00 41 42 43 44 45"),
            "d0 00 00 ff ff 03 00 09 00 00 00 05 00 41 42 43 44 45");
  EXPECT_EQ(Plc{}.raw("500000FF03FF000015001006190000"
                      "0005ABCDE"),
            "D00000FF03FF00000D00000005ABCDE");
}

TEST(Melsec, OwnBufferMemory_IsReadAndWrittenByWordAddress) {
  Plc plc;
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 10 00 10 00 13 16 00 00 | fe 07 00 00 02 00 34 12 cd ab"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0c 00 10 00 13 06 00 00 | fd 07 00 00 03 00"),
            "d0 00 00 ff ff 03 00 08 00 00 00 00 00 34 12 cd ab");
  plc.rack.power_on(plc.now);
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0c 00 10 00 13 06 00 00 | fe 07 00 00 01 00"),
            "d0 00 00 ff ff 03 00 04 00 00 00 00 00");
}

TEST(Melsec, OwnBufferMemoryInAscii_HasTheHighDigitsFirst) {
  Plc plc;
  EXPECT_EQ(plc.raw("500000FF03FF00001C001016130000"
                    "00000010"
                    "00011234"),
            "D00000FF03FF0000040000");
  EXPECT_EQ(plc.raw("500000FF03FF000018001006130000"
                    "00000010"
                    "0001"),
            "D00000FF03FF00000800001234");
}

TEST(Melsec, Loopback_TakesAnyBytes) {
  EXPECT_EQ(Plc{}.request("50 00 00 ff ff 03 00 0c 00 10 00 19 06 00 00 | 04 00 00 67 ff 20"),
            "d0 00 00 ff ff 03 00 08 00 00 00 04 00 00 67 ff 20");
  EXPECT_EQ(Plc{}.raw("500000FF03FF000015001006190000"
                      "0005Hello"),
            "D00000FF03FF00000D00000005Hello");
}

TEST(Melsec, RemotePause_HoldsYAndShowsItself) {
  Plc plc;
  plc.bit(Device::y, 0x30, true);
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 08 00 10 00 03 10 00 00 | 01 00"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_TRUE(plc.bit(Device::y, 0x30));
  EXPECT_TRUE(plc.bit(Device::sm, 204));
  EXPECT_FALSE(plc.bit(Device::sm, 203));
  EXPECT_EQ(plc.word(Device::sd, 203), 0x0023);
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0a 00 10 00 01 10 00 00 | 01 00 00 00"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_FALSE(plc.bit(Device::sm, 204));
  EXPECT_EQ(plc.word(Device::sd, 203), 0x0000);
}

TEST(Melsec, RemotePause_EndsWithStop) {
  Plc plc;
  plc.bit(Device::y, 0x30, true);
  (void)plc.request("50 00 00 ff ff 03 00 08 00 10 00 03 10 00 00 | 03 00");
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 08 00 10 00 02 10 00 00 | 01 00"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_FALSE(plc.bit(Device::y, 0x30));
  EXPECT_FALSE(plc.bit(Device::sm, 204));
  EXPECT_EQ(plc.word(Device::sd, 203), 0x0022);
}

TEST(Melsec, RemotePauseInStop_IsCompletedAndStaysStop) {
  Plc plc;
  plc.rack.set_cpu_state(module::CpuState::stop, plc.now);
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 08 00 10 00 03 10 00 00 | 03 00"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_EQ(plc.word(Device::sd, 203), 0x0022);
  EXPECT_FALSE(plc.bit(Device::sm, 204));
}

TEST(Melsec, RemoteStopAndRun_ChangeTheCpuState) {
  Plc plc;
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 08 00 10 00 02 10 00 00 | 01 00"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_EQ(plc.rack.cpu_state(), module::CpuState::stop);
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0a 00 10 00 01 10 00 00 | 03 00 00 00"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_EQ(plc.rack.cpu_state(), module::CpuState::run);
}

TEST(Melsec, RemoteRun_ClearsDevicesWhenAsked) {
  Plc plc;
  plc.word(Device::d, 1, 5);
  plc.bit(Device::l, 1, true);
  plc.rack.set_cpu_state(module::CpuState::stop, plc.now);
  (void)plc.request("50 00 00 ff ff 03 00 0a 00 10 00 01 10 00 00 | 01 00 01 00");
  EXPECT_EQ(plc.word(Device::d, 1), 0);
  EXPECT_TRUE(plc.bit(Device::l, 1));
}

TEST(Melsec, RemoteLatchClear_InStop_ClearsL) {
  Plc plc;
  plc.bit(Device::l, 1, true);
  plc.rack.set_cpu_state(module::CpuState::stop, plc.now);
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 08 00 10 00 05 10 00 00 | 01 00"),
            "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_FALSE(plc.bit(Device::l, 1));
}

TEST(Melsec, EveryAccess_HappensAtTheTimeGiven) {
  Plc plc;
  (void)plc.request(
      "50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 00 00 19 00 00 ab 00 00 00 00 f8 | 01 00");
  EXPECT_EQ(plc.module.last_time, plc.now);
}

}  // namespace
}  // namespace canopus::plc::melsec_read_write_test
