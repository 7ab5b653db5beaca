// Conversations in which something is wrong: the end code, its error information, and that nothing happened.

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plc/conversation.hpp"

namespace canopus::plc::melsec_refusal_test {
namespace {

using testing::bytes;
using testing::Plc;

/// The end code of a binary 3E reply, "c059".
std::string end_code(Plc& plc, const std::string& request) {
  const std::string reply = plc.request(request);
  return reply.size() < 32 ? reply : reply.substr(30, 2) + reply.substr(27, 2);
}
std::string end_code(const std::string& request) {
  Plc plc;
  return end_code(plc, request);
}

std::string ascii_end_code(const std::string& request) {
  const std::string reply = Plc{}.raw(request);
  return reply.size() < 22 ? reply : reply.substr(18, 4);
}

TEST(MelsecRefusal, EndCode_IsFollowedByRouteCommandAndSubcommand) {
  EXPECT_EQ(Plc{}.request("50 00 00 ff ff 03 00 0c 00 10 00 01 04 01 00 64 00 00 a8 01 00"),
            "d0 00 00 ff ff 03 00 0b 00 5c c0 00 ff ff 03 00 01 04 01 00");
  EXPECT_EQ(Plc{}.raw("500000FF03FF000018001004010001D*0001000001"),
            "D00000FF03FF000016C05C00FF03FF0004010001");
}

TEST(MelsecRefusal, UnknownCommandOrSubcommand_IsC059) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 06 00 10 00 99 99 00 00"), "c059");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 04 00 64 00 00 a8 01 00"), "c059");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 06 00 10 00 01 01 01 00"), "c059");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 03 04 01 00 01 00 64 00 00 a8"), "c059");
}

TEST(MelsecRefusal, IqrSubcommands_ToAQCpu_AreC059) {
  Plc plc(q03udvcpu());
  EXPECT_EQ(end_code(plc, "50 00 00 ff ff 03 00 0e 00 10 00 01 04 02 00 64 00 00 00 a8 00 01 00"), "c059");
}

TEST(MelsecRefusal, NumberOfWords_OutsideOf1To960_IsC052) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 00 00 00 a8 00 00"), "c052");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 00 00 00 a8 c1 03"), "c052");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 00 00 00 a8 c0 03"), "0000");
}

TEST(MelsecRefusal, NumberOfBits_Beyond7168OrInAscii3584_IsC051) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 01 00 00 00 00 90 00 1c"), "0000");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 01 00 00 00 00 90 01 1c"), "c051");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 01 00 00 00 00 90 00 00"), "c051");
  EXPECT_EQ(ascii_end_code("500000FF03FF000018001004010001M*0000000E00"), "0000");
  EXPECT_EQ(ascii_end_code("500000FF03FF000018001004010001M*0000000E01"), "C051");
}

TEST(MelsecRefusal, DeviceNumbers_BeyondTheLastOne_Are4031) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 ff 47 00 a8 01 00"), "0000");  // D18431
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 ff 47 00 a8 02 00"), "4031");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 00 48 00 a8 01 00"), "4031");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 01 00 00 30 00 90 01 00"), "4031");  // M12288
  EXPECT_EQ(ascii_end_code("500000FF03FF000018001004010000D*9999990001"), "4031");
}

TEST(MelsecRefusal, WriteBeyondTheLastDevice_WritesNothing) {
  Plc plc;
  EXPECT_EQ(end_code(plc, "50 00 00 ff ff 03 00 10 00 10 00 01 14 00 00 ff 47 00 a8 02 00 34 12 78 56"),
            "4031");
  EXPECT_EQ(plc.word(Device::d, 18431), 0);
}

TEST(MelsecRefusal, SingleBitsOfWords_AreC05C) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 01 00 64 00 00 a8 01 00"), "c05c");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0d 00 10 00 01 14 01 00 64 00 00 a8 01 00 10"), "c05c");
  // U0\G25
  EXPECT_EQ(
      end_code("50 00 00 ff ff 03 00 13 00 10 00 01 04 81 00 | 00 00 19 00 00 ab 00 00 00 00 f8 | 01 00"),
      "c05c");
}

TEST(MelsecRefusal, UnknownDeviceOrGWithoutModule_IsC05B) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 01 01 00"), "c05b");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 ab 01 00"), "c05b");
  EXPECT_EQ(ascii_end_code("500000FF03FF000018001004010000Q*0001000001"), "C05B");
}

TEST(MelsecRefusal, DeviceWithoutPoints_Is4030) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 00 00 00 c8 01 00"), "4030");
}

TEST(MelsecRefusal, ModuleThatIsNotThere_Is4043) {
  EXPECT_EQ(
      end_code("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 00 00 19 00 00 ab 00 00 07 00 f8 | 01 00"),
      "4043");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0e 00 10 00 01 06 00 00 | 00 00 00 00 02 00 07 00"), "4043");
}

TEST(MelsecRefusal, BeyondTheBufferMemory_Is4041) {
  EXPECT_EQ(
      end_code("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 00 00 ff 01 00 ab 00 00 03 00 f8 | 02 00"),
      "4041");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0e 00 10 00 01 06 00 00 | fe 03 00 00 04 00 03 00"), "4041");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0e 00 10 00 01 06 00 00 | fe ff ff ff 04 00 03 00"), "4041");
}

TEST(MelsecRefusal, ModuleBuffer_OddBytesOrModuleNumberBeyondFF_Is4080) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0e 00 10 00 01 06 00 00 | 01 00 00 00 02 00 00 00"), "4080");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0e 00 10 00 01 06 00 00 | 00 00 00 00 03 00 00 00"), "4080");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0e 00 10 00 01 06 00 00 | 00 00 00 00 02 00 ff 03"), "4080");
}

TEST(MelsecRefusal, ModuleBuffer_OfMoreThan780HBytes_IsC052) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0e 00 10 00 01 06 00 00 | 00 00 00 00 80 07 00 00"), "0000");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0e 00 10 00 01 06 00 00 | 00 00 00 00 82 07 00 00"), "c052");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0e 00 10 00 01 06 00 00 | 00 00 00 00 00 00 00 00"), "c052");
}

// D100Z4 was refused here until index registers were there; it is read now (melsec_index_test.cpp).
TEST(MelsecRefusal, LinkDirectTargets_LongIndexRegistersAndIndirectOnes_AreC070) {
  EXPECT_EQ(
      end_code("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 00 00 00 01 00 b4 00 00 01 00 f9 | 01 00"),
      "c070");
  EXPECT_EQ(
      end_code("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 04 80 64 00 00 a8 00 00 00 00 00 | 01 00"),
      "c070");
  EXPECT_EQ(
      end_code("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 00 08 00 00 00 a8 00 00 00 00 00 | 01 00"),
      "c070");
  EXPECT_EQ(ascii_end_code("500000FF03FF000024001004010080"
                           "0@0000000D*000100000"
                           "0001"),
            "C070");
  EXPECT_EQ(ascii_end_code("500000FF03FF000024001004010080"
                           "00J001000W*000100000"
                           "0001"),
            "C070");
}

TEST(MelsecRefusal, LengthThatDoesNotFit_IsC061_InAsciiC058) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0b 00 10 00 01 04 00 00 64 00 00 a8 01"), "c061");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0d 00 10 00 01 04 00 00 64 00 00 a8 01 00 00"), "c061");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0e 00 10 00 01 14 00 00 64 00 00 a8 02 00 34 12"), "c061");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 04 00 10 00 01 04"), "c061");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 00 00"), "c061");
  EXPECT_EQ(ascii_end_code("500000FF03FF000017001004010000D*000100001"), "C058");
}

TEST(MelsecRefusal, AsciiThatIsNoNumber_IsC050) {
  EXPECT_EQ(ascii_end_code("500000FF03FF000018001004010000D*00010A0001"), "C050");  // D is decimal
  EXPECT_EQ(ascii_end_code("500000FF03FF000018001004010000W*0001GG0001"), "C050");
  EXPECT_EQ(ascii_end_code("500000FF03FF000020001014010000D*00010000021234567G"), "C050");
  EXPECT_EQ(ascii_end_code("500000FF03FF000018001004010000W*0001ff0001"), "C050");
}

TEST(MelsecRefusal, BitDataOtherThan0And1_IsC060AndWritesNothing) {
  Plc plc;
  EXPECT_EQ(end_code(plc, "50 00 00 ff ff 03 00 0d 00 10 00 01 14 01 00 64 00 00 90 02 00 12"), "c060");
  EXPECT_FALSE(plc.bit(Device::m, 100));
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 02 14 01 00 | 01 31 00 00 9d 02"), "c060");
  EXPECT_EQ(ascii_end_code("500000FF03FF000019001014010001M*00010000012"), "C060");
}

TEST(MelsecRefusal, RandomPoints_TooManyOrNone_AreC054OrC053) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 08 00 10 00 03 04 00 00 | 00 00"), "c054");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 08 00 10 00 03 04 00 00 | c0 01"), "c054");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 08 00 10 00 03 04 02 00 | 60 01"), "c054");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 08 00 10 00 02 14 00 00 | a0 01"), "c054");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 07 00 10 00 02 14 01 00 | bd"), "c053");
}

TEST(MelsecRefusal, OneWrongPointOfARandomWrite_WritesNone) {
  Plc plc;
  EXPECT_EQ(
      end_code(plc,
               "50 00 00 ff ff 03 00 14 00 10 00 02 14 00 00 | 02 00 64 00 00 a8 34 12 00 48 00 a8 01 00"),
      "4031");
  EXPECT_EQ(plc.word(Device::d, 100), 0);
}

TEST(MelsecRefusal, BlockOfTheWrongKind_IsC05BAndWritesNothing) {
  Plc plc;
  EXPECT_EQ(
      end_code(plc,
               "50 00 00 ff ff 03 00 18 00 10 00 06 14 00 00 | 02 00 | 64 00 00 a8 01 00 01 00 | 00 00 00 90 "
               "01 00 05 80"),
      "c05b");
  EXPECT_EQ(plc.word(Device::d, 100), 0);
}

TEST(MelsecRefusal, BlocksOfMoreThan960Words_AreC052) {
  EXPECT_EQ(
      end_code(
          "50 00 00 ff ff 03 00 14 00 10 00 06 04 00 00 | 02 00 | 00 00 00 a8 c0 03 | 00 00 00 a8 01 00"),
      "c052");
}

TEST(MelsecRefusal, MonitorWithoutRegistration_IsC05D) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 06 00 10 00 02 08 00 00"), "c05d");
}

TEST(MelsecRefusal, OtherNetworkStationOrCpu_IsC05F) {
  EXPECT_EQ(end_code("50 00 01 ff ff 03 00 06 00 10 00 01 01 00 00"), "c05f");
  EXPECT_EQ(end_code("50 00 00 01 ff 03 00 06 00 10 00 01 01 00 00"), "c05f");
  EXPECT_EQ(end_code("50 00 00 ff e1 03 00 06 00 10 00 01 01 00 00"), "c05f");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 01 06 00 10 00 01 01 00 00"), "c05f");
  EXPECT_EQ(end_code("50 00 00 ff e0 03 00 06 00 10 00 01 01 00 00"), "0000");
}

TEST(MelsecRefusal, LoopbackOfNothingOrOfTooMuch_IsC05C) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 08 00 10 00 19 06 00 00 | 00 00"), "c05c");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 08 00 10 00 19 06 00 00 | c1 03"), "c05c");
}

TEST(MelsecRefusal, LatchClearWhileRunning_Is4013_AndResetIs408B) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 08 00 10 00 05 10 00 00 | 01 00"), "4013");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 08 00 10 00 06 10 00 00 | 01 00"), "408b");
}

TEST(MelsecRefusal, RemotePauseInAnUnknownMode_IsC05C) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 08 00 10 00 03 10 00 00 | 02 00"), "c05c");
}

TEST(MelsecRefusal, LatchClearInPause_Is4013) {
  Plc plc;
  (void)plc.request("50 00 00 ff ff 03 00 08 00 10 00 03 10 00 00 | 01 00");
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 08 00 10 00 05 10 00 00 | 01 00").substr(27, 5), "13 40");
}

TEST(MelsecRefusal, OwnBufferMemory_BeyondItsEnd_Is4041_AndNothingIsWritten) {
  Plc plc;
  const auto code = [&](std::string_view request) { return plc.request(request).substr(27, 5); };
  EXPECT_EQ(code("50 00 00 ff ff 03 00 0c 00 10 00 13 06 00 00 | 00 08 00 00 01 00"), "41 40");
  EXPECT_EQ(code("50 00 00 ff ff 03 00 0c 00 10 00 13 06 00 00 | ff ff ff ff 02 00"), "41 40");
  EXPECT_EQ(code("50 00 00 ff ff 03 00 10 00 10 00 13 16 00 00 | ff 07 00 00 02 00 34 12 cd ab"), "41 40");
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0c 00 10 00 13 06 00 00 | ff 07 00 00 01 00"),
            "d0 00 00 ff ff 03 00 04 00 00 00 00 00");
}

TEST(MelsecRefusal, OwnBufferMemory_OutsideOf1To480Words_IsC052) {
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 13 06 00 00 | 00 00 00 00 00 00"), "c052");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 13 06 00 00 | 00 00 00 00 e1 01"), "c052");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 13 06 00 00 | 00 00 00 00 e0 01"), "0000");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 13 16 00 00 | 00 00 00 00 00 00"), "c052");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0c 00 10 00 13 16 00 00 | 00 00 00 00 01 00"), "c061");
  EXPECT_EQ(end_code("50 00 00 ff ff 03 00 0a 00 10 00 13 06 00 00 | 00 00 00 00"), "c061");
}

TEST(MelsecRefusal, OwnBufferMemory_OfAQCpu_IsC059) {
  Plc plc(q03udvcpu());
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0c 00 10 00 13 06 00 00 | 00 00 00 00 01 00").substr(27, 5),
            "59 c0");
  EXPECT_EQ(
      plc.request("50 00 00 ff ff 03 00 0e 00 10 00 13 16 00 00 | 00 00 00 00 01 00 34 12").substr(27, 5),
      "59 c0");
}

TEST(MelsecRefusal, RequestAfterARefusedOne_IsAnsweredAsUsual) {
  Plc plc;
  EXPECT_EQ(
      plc.request(
          "50 00 00 ff ff 03 00 06 00 10 00 99 99 00 00 | 50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 "
          "64 00 00 "
          "a8 01 00"),
      "d0 00 00 ff ff 03 00 0b 00 59 c0 00 ff ff 03 00 99 99 00 00 d0 00 00 ff ff 03 00 04 00 00 00 00 00");
}

}  // namespace
}  // namespace canopus::plc::melsec_refusal_test
