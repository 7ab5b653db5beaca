// Access to an FX5 (label-less iQ-F) as clients of the PLC's maker and of others do it: random access, monitor lists and blocks,
// in each layout and data code.

#include <string>

#include <gtest/gtest.h>

#include "plc/conversation.hpp"

namespace canopus::plc::melsec_fx5_access_test {
namespace {

using testing::Plc;

const std::string head = "50 00 00 ff ff 03 00 ";
const std::string done = "d0 00 00 ff ff 03 00 02 00 00 00";

struct Fx5 : Plc {
  Fx5() : Plc(fx5u()) {
    word(Device::d, 100, 0x1234);
    word(Device::d, 200, 0x5678);
    word(Device::d, 201, 0x9ABC);
    bit(Device::m, 3, true);
  }
};

TEST(MelsecFx5, RandomRead_OfWordsAndDoubleWords_InEachLayout) {
  Fx5 plc;
  const std::string values = "34 12 08 00 78 56 bc 9a";
  EXPECT_EQ(plc.request(head + "14 00 10 00 03 04 00 00 | 02 01 64 00 00 a8 00 00 00 90 c8 00 00 a8"),
            "d0 00 00 ff ff 03 00 0a 00 00 00 " + values);
  EXPECT_EQ(
      plc.request(head +
                  "1a 00 10 00 03 04 02 00 | 02 01 64 00 00 00 a8 00 00 00 00 00 90 00 c8 00 00 00 a8 00"),
      "d0 00 00 ff ff 03 00 0a 00 00 00 " + values);
  Fx5 ascii;
  EXPECT_EQ(ascii.raw("500000FF03FF0000280010"
                      "04030000"
                      "0201D*000100M*000000D*000200"),
            "D00000FF03FF0000140000"
            "123400089ABC5678");
}

TEST(MelsecFx5, RandomRead_CountsXAndYInOctal_InAscii) {
  Fx5 plc;
  plc.bit(Device::y, 8, true);  // Y10
  EXPECT_EQ(plc.raw("500000FF03FF0000180010"
                    "04030000"
                    "0100Y*000010"),
            "D00000FF03FF0000080000"
            "0001");
}

TEST(MelsecFx5, RandomWrite_OfWordsAndDoubleWords) {
  Fx5 plc;
  EXPECT_EQ(plc.request(head + "16 00 10 00 02 14 00 00 | 01 01 65 00 00 a8 01 02 66 00 00 a8 04 03 02 01"),
            done);
  EXPECT_EQ(plc.word(Device::d, 101), 0x0201);
  EXPECT_EQ(plc.word(Device::d, 102), 0x0304);
  EXPECT_EQ(plc.word(Device::d, 103), 0x0102);
  Fx5 ascii;
  EXPECT_EQ(ascii.raw("500000FF03FF00001C0010"
                      "14020000"
                      "0100D*0001010201"),
            "D00000FF03FF0000040000");
  EXPECT_EQ(ascii.word(Device::d, 101), 0x0201);
}

TEST(MelsecFx5, RandomWrite_OfBits_InBothLayouts) {
  Fx5 plc;
  EXPECT_EQ(plc.request(head + "11 00 10 00 02 14 01 00 | 02 05 00 00 90 01 03 00 00 90 00"), done);
  EXPECT_TRUE(plc.bit(Device::m, 5));
  EXPECT_FALSE(plc.bit(Device::m, 3));
  EXPECT_EQ(plc.request(head + "0f 00 10 00 02 14 03 00 | 01 06 00 00 00 90 00 01 00"), done);
  EXPECT_TRUE(plc.bit(Device::m, 6));
}

TEST(MelsecFx5, MonitorList_IsRegisteredOnceAndReadAgainAndAgain) {
  Fx5 plc;
  EXPECT_EQ(plc.request(head + "10 00 10 00 01 08 00 00 | 01 01 64 00 00 a8 c8 00 00 a8"), done);
  const std::string read = head + "06 00 10 00 02 08 00 00";
  EXPECT_EQ(plc.request(read), "d0 00 00 ff ff 03 00 08 00 00 00 34 12 78 56 bc 9a");
  plc.word(Device::d, 100, 0x4321);
  EXPECT_EQ(plc.request(read), "d0 00 00 ff ff 03 00 08 00 00 00 21 43 78 56 bc 9a");
  Fx5 iqr;
  EXPECT_EQ(iqr.request(head + "0e 00 10 00 01 08 02 00 | 01 00 64 00 00 00 a8 00"), done);
  EXPECT_EQ(iqr.request(read), "d0 00 00 ff ff 03 00 04 00 00 00 34 12");
  Fx5 ascii;
  EXPECT_EQ(ascii.raw("500000FF03FF0000180010"
                      "08010000"
                      "0100D*000100"),
            "D00000FF03FF0000040000");
  EXPECT_EQ(ascii.raw("500000FF03FF00000C0010"
                      "08020000"),
            "D00000FF03FF0000080000"
            "1234");
}

TEST(MelsecFx5, MonitorWithoutAList_IsC05D) {
  Fx5 plc;
  EXPECT_EQ(plc.request(head + "06 00 10 00 02 08 00 00").substr(27, 5), "5d c0");
}

// A driver that asks for the CPU, then for blocks of words and of bits in one request, in 4E frames with its serial number.
TEST(MelsecFx5, BlocksIn4eFrames_HaveTheSerialNumberOfTheRequest) {
  Fx5 plc;
  EXPECT_EQ(
      plc.request("54 00 07 00 00 00 00 ff ff 03 00 14 00 10 00 06 04 00 00 | 01 01 | 64 00 00 a8 01 00 | "
                  "00 00 00 90 01 00"),
      "d4 00 07 00 00 00 00 ff ff 03 00 06 00 00 00 34 12 08 00");
}

TEST(MelsecFx5, RandomAccess_BeyondTheLastPoint_ChangesNothing) {
  Fx5 plc;
  EXPECT_EQ(
      plc.request(head + "14 00 10 00 02 14 00 00 | 02 00 65 00 00 a8 01 02 40 1f 00 a8 01 02").substr(27, 5),
      "31 40");
  EXPECT_EQ(plc.word(Device::d, 101), 0) << "D8000 is not there";
}

}  // namespace
}  // namespace canopus::plc::melsec_fx5_access_test
