// Conversations in 1E frames, byte by byte: every command in binary and in ASCII.

#include "plc/plc_1e.hpp"

namespace canopus::plc::melsec_1e_test {
namespace {

TEST(Melsec1e, StepRelaysAndSpecialRelaysOfAnFx_AreReadAndWritten) {
  Plc1e plc(fx3u());
  EXPECT_EQ(plc.request("02 ff 0a 00 | ff 0f 00 00 20 53 | 01 00 | 10"), "82 00");
  EXPECT_TRUE(plc.bit(Device::s, 4095));
  EXPECT_EQ(plc.request("00 ff 0a 00 | fe 0f 00 00 20 53 | 02 00"), "80 00 01");
  EXPECT_EQ(plc.request("00 ff 0a 00 | 40 1f 00 00 20 4d | 02 00"), "80 00 10") << "M8000, M8001";
}

// --- what the manuals print ---

TEST(Melsec1e, ReadBits_M100To107_AsThePrintedExample) {
  Plc1e plc;
  for (const std::uint32_t number : {100U, 102U, 105U, 106U}) plc.bit(Device::m, number, true);
  EXPECT_EQ(plc.request("00 ff 0a 00 | 64 00 00 00 20 4d | 08 00"), "80 00 10 10 01 10");
}

TEST(Melsec1e, ReadBits_InAscii_AsThePrintedExample) {
  Plc1e plc;
  for (const std::uint32_t number : {100U, 102U, 105U, 106U}) plc.bit(Device::m, number, true);
  EXPECT_EQ(plc.raw("00FF000A4D20000000640800"), "800010100110");
}

TEST(Melsec1e, TestInWords_InAscii_AsThePrintedExample) {
  Plc1e plc;
  EXPECT_EQ(plc.raw("05FF000A03005920000000107B2952200000001A1234434E000000120050"), "8500");
  EXPECT_EQ(plc.word(Device::y, 0x10), 0x7B29);
  EXPECT_EQ(plc.word(Device::r, 26), 0x1234);
  EXPECT_EQ(plc.word(Device::cn, 18), 0x0050);
}

TEST(Melsec1e, CpuModelOfAnFx3u_IsF3H) {
  EXPECT_EQ(Plc1e(fx3u()).request("15 ff 0a 00"), "95 00 f3 00");
  EXPECT_EQ(Plc1e(fx3u()).raw("15FF000A"), "9500F300");
}

// --- each command ---

TEST(Melsec1e, ReadBits_OfAnOddNumber_EndsWithADummy) {
  Plc1e plc;
  plc.bit(Device::m, 16, true);
  plc.bit(Device::m, 18, true);
  EXPECT_EQ(plc.request("00 ff 00 00 10 00 00 00 20 4d 03 00"), "80 00 10 10");
  EXPECT_EQ(Plc1e{}.raw("00FF00004D20000000100300"), "80000000");
}

TEST(Melsec1e, ReadBits_CountOf00H_Is256) {
  Plc1e plc;
  plc.bit(Device::m, 255, true);
  const std::string reply = plc.raw(bytes("00 ff 00 00 00 00 00 00 20 4d 00 00"));
  ASSERT_EQ(reply.size(), 2U + 128U);
  EXPECT_EQ(reply.back(), '\x01');
}

TEST(Melsec1e, ReadWords) {
  Plc1e plc;
  plc.word(Device::d, 100, 0x1234);
  plc.word(Device::d, 101, 0xABCD);
  EXPECT_EQ(plc.request("01 ff 0a 00 | 64 00 00 00 20 44 | 02 00"), "81 00 34 12 cd ab");
  Plc1e ascii;
  ascii.word(Device::d, 100, 0x1234);
  ascii.word(Device::d, 101, 0xABCD);
  EXPECT_EQ(ascii.raw("01FF000A4420000000640200"), "81001234ABCD");
}

TEST(Melsec1e, ReadWords_OfABitDevice_Are16PointsEach) {
  Plc1e plc;
  plc.word(Device::m, 16, 0xAB12);
  EXPECT_EQ(plc.request("01 ff 0a 00 10 00 00 00 20 4d 02 00"), "81 00 12 ab 00 00");
}

TEST(Melsec1e, WriteBits) {
  Plc1e plc;
  EXPECT_EQ(plc.request("02 ff 0a 00 | 32 00 00 00 20 4d | 03 00 | 11 10"), "82 00");
  EXPECT_TRUE(plc.bit(Device::m, 50));
  EXPECT_TRUE(plc.bit(Device::m, 51));
  EXPECT_TRUE(plc.bit(Device::m, 52));
  EXPECT_FALSE(plc.bit(Device::m, 53));
}

TEST(Melsec1e, WriteBits_InAscii_OfAnOddNumberHasADummy) {
  Plc1e plc;
  EXPECT_EQ(plc.raw("02FF000A4D200000003203001010"), "8200");
  EXPECT_TRUE(plc.bit(Device::m, 50));
  EXPECT_FALSE(plc.bit(Device::m, 51));
  EXPECT_TRUE(plc.bit(Device::m, 52));
  EXPECT_FALSE(plc.session->half_request());
}

TEST(Melsec1e, WriteBits_OfY_AreEdgesAtTheModule) {
  Plc1e plc;
  EXPECT_EQ(plc.request("02 ff 00 00 01 00 00 00 20 59 02 00 11"), "82 00");
  EXPECT_EQ(plc.module.edges.size(), 2U);
  EXPECT_EQ(plc.module.y, 0x6U);
}

TEST(Melsec1e, WriteWords) {
  Plc1e plc;
  EXPECT_EQ(plc.request("03 ff 0a 00 | 64 00 00 00 20 44 | 02 00 | 34 12 cd ab"), "83 00");
  EXPECT_EQ(plc.word(Device::d, 100), 0x1234);
  EXPECT_EQ(plc.word(Device::d, 101), 0xABCD);
  EXPECT_EQ(Plc1e{}.raw("03FF000A4420000000640200"
                        "1234ABCD"),
            "8300");
}

TEST(Melsec1e, TestInBits) {
  Plc1e plc;
  plc.bit(Device::m, 3, true);
  EXPECT_EQ(plc.request("04 ff 0a 00 | 02 00 | 02 00 00 00 20 59 01 | 03 00 00 00 20 4d 00"), "84 00");
  EXPECT_EQ(plc.module.y, 0x4U);
  EXPECT_FALSE(plc.bit(Device::m, 3));
  EXPECT_EQ(Plc1e{}.raw("04FF000A0200"
                        "59200000000201"
                        "4D200000000300"),
            "8400");
}

TEST(Melsec1e, TestInWords) {
  Plc1e plc;
  EXPECT_EQ(plc.request("05 ff 0a 00 | 02 00 | 0a 00 00 00 20 44 34 12 | 10 00 00 00 20 4d 03 00"), "85 00");
  EXPECT_EQ(plc.word(Device::d, 10), 0x1234);
  EXPECT_EQ(plc.word(Device::m, 16), 3);
}

TEST(Melsec1e, BufferMemory_GoesByByteAddresses) {
  Plc1e plc;
  plc.other_module.words[0x3F8] = 0;
  plc.module.words[0x3F8] = 0x1809;
  plc.module.words[0x3F9] = 0x3420;
  EXPECT_EQ(plc.request("0e ff 0a 00 | f0 07 00 | 04 | 00 | 00"), "8e 00 09 18 20 34");
  EXPECT_EQ(plc.request("0f ff 0a 00 | 02 00 00 | 02 | 03 | 00 | 78 56"), "8f 00");
  EXPECT_EQ(plc.other_module.words[1], 0x5678);
  Plc1e ascii;
  ascii.module.words[0x3F8] = 0x1809;
  ascii.module.words[0x3F9] = 0x3420;
  EXPECT_EQ(ascii.raw("0EFF000A0007F0040000"), "8E0009182034");
  EXPECT_EQ(ascii.raw("0FFF000A0000020203007856"), "8F00");
  EXPECT_EQ(ascii.other_module.words[1], 0x5678);
}

TEST(Melsec1e, BufferMemory_ByteCountOf00H_Is256) {
  const std::string reply = Plc1e{}.raw(bytes("0e ff 0a 00 00 00 00 00 00 00"));
  EXPECT_EQ(reply.size(), 2U + 256U);
}

TEST(Melsec1e, ModuleNumber_MayBeThatOfItsLastPoints) {
  Plc1e plc;  // 32 points from 00H on: 01 is the module, too, as the manual's 13 for 120H to 13FH
  plc.module.words[0] = 7;
  EXPECT_EQ(plc.request("0e ff 0a 00 00 00 00 02 01 00"), "8e 00 07 00");
}

TEST(Melsec1e, RemoteStopAndRun) {
  Plc1e plc;
  EXPECT_EQ(plc.request("14 ff 0a 00"), "94 00");
  EXPECT_EQ(plc.rack.cpu_state(), module::CpuState::stop);
  EXPECT_EQ(plc.request("13 ff 0a 00"), "93 00");
  EXPECT_EQ(plc.rack.cpu_state(), module::CpuState::run);
  EXPECT_EQ(Plc1e{}.raw("14FF000A"), "9400");
  EXPECT_EQ(Plc1e{}.raw("13FF000A"), "9300");
}

TEST(Melsec1e, CpuModel_OfOtherCpus_IsTheCodeOf0101) {
  EXPECT_EQ(request("15 ff 0a 00"), "95 00 00 48");
  EXPECT_EQ(Plc1e(q03udvcpu()).raw("15FF000A"), "95006603");
}

TEST(Melsec1e, Loopback) {
  EXPECT_EQ(request("16 ff 0a 00 | 05 | 41 42 43 44 45"), "96 00 05 41 42 43 44 45");
  EXPECT_EQ(request_ascii("16FF000A0241F7"), "96000241F7");
}

}  // namespace
}  // namespace canopus::plc::melsec_1e_test
