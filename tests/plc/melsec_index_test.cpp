// Index modification of the extended device specification (subcommands 0080 to 0083).

#include <string>

#include <gtest/gtest.h>

#include "plc/conversation.hpp"

namespace canopus::plc::melsec_index_test {
namespace {

using testing::Plc;

struct PlcWithIndex : Plc {
  PlcWithIndex() {
    word(Device::z, 4, 3);
    word(Device::d, 103, 0x1234);
  }
};

const std::string reply_1234 = "d0 00 00 ff ff 03 00 04 00 00 00 34 12";

TEST(MelsecIndex, D100Z4_AsTheManualPrintsIt) {
  PlcWithIndex plc;
  EXPECT_EQ(
      plc.request("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 04 40 64 00 00 a8 00 00 00 00 00 | 01 00"),
      reply_1234);
  PlcWithIndex ascii;
  EXPECT_EQ(ascii.raw("500000FF03FF000024001004010080"
                      "00"
                      "0000"
                      "000"
                      "D*"
                      "000100"
                      "Z04"
                      "0001"),
            "D00000FF03FF00000800001234");
}

TEST(MelsecIndex, OfTheIqrLayout) {
  PlcWithIndex plc;
  EXPECT_EQ(
      plc.request(
          "50 00 00 ff ff 03 00 15 00 10 00 01 04 82 00 | 04 40 64 00 00 00 a8 00 00 00 00 00 00 | 01 00"),
      reply_1234);
}

TEST(MelsecIndex, ANegativeValue_GoesBack) {
  PlcWithIndex plc;
  plc.word(Device::z, 0, 0xFFFF);
  plc.word(Device::d, 99, 0x1234);
  EXPECT_EQ(
      plc.request("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 00 40 64 00 00 a8 00 00 00 00 00 | 01 00"),
      reply_1234);
}

TEST(MelsecIndex, OfBufferMemory_AndOfTheModulesNumber) {
  PlcWithIndex plc;  // U0Z4\\G22Z4 is U3\\G25
  plc.other_module.words[25] = 0x1234;
  EXPECT_EQ(
      plc.request("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 04 40 16 00 00 ab 04 40 00 00 f8 | 01 00"),
      reply_1234);
}

TEST(MelsecIndex, Writes) {
  PlcWithIndex plc;
  EXPECT_EQ(
      plc.request(
          "50 00 00 ff ff 03 00 15 00 10 00 01 14 80 00 | 04 40 64 00 00 a8 00 00 00 00 00 | 01 00 78 56"),
      "d0 00 00 ff ff 03 00 02 00 00 00");
  EXPECT_EQ(plc.word(Device::d, 103), 0x5678);
}

TEST(MelsecIndex, ARegisterOrANumberThatIsNotThere_Is4031) {
  PlcWithIndex plc;
  const auto end_code = [&](const std::string& request) { return plc.request(request).substr(27, 5); };
  EXPECT_EQ(
      end_code("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 14 40 64 00 00 a8 00 00 00 00 00 | 01 00"),
      "31 40");
  plc.word(Device::z, 0, 0x8000);
  EXPECT_EQ(
      end_code("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 00 40 64 00 00 a8 00 00 00 00 00 | 01 00"),
      "31 40");
}

TEST(MelsecIndex, ACpuWithoutIndexRegisters_DoesNotTakeThem) {
  Plc plc(fx3u());
  EXPECT_EQ(
      plc.request("50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 00 40 64 00 00 a8 00 00 00 00 00 | 01 00")
          .substr(27, 5),
      "70 c0");
}

TEST(MelsecOctal, XAndYOfAnFx5_AreOctalInAscii) {
  Plc plc(fx5u());
  plc.bit(Device::y, 8, true);  // Y10
  EXPECT_EQ(plc.raw("500000FF03FF000018000404010001Y*0000100001"),
            "D00000FF03FF000005"
            "0000"
            "1");
  EXPECT_EQ(plc.raw("500000FF03FF00001C000404010003Y***000000100001"),
            "D00000FF03FF000005"
            "0000"
            "1");
  EXPECT_EQ(plc.raw("500000FF03FF000018000404010001X*0000180001").substr(18, 4), "C050")
      << "8 is no octal digit";
  EXPECT_EQ(plc.raw("500000FF03FF000018000404010001B*00000F0001"),
            "D00000FF03FF000005"
            "0000"
            "0");
  Plc binary(fx5u());
  binary.bit(Device::y, 8, true);
  EXPECT_EQ(binary.request("50 00 00 ff ff 03 00 0c 00 10 00 01 04 01 00 | 08 00 00 9d | 01 00"),
            "d0 00 00 ff ff 03 00 03 00 00 00 10")
      << "in binary it is a number";
}

}  // namespace
}  // namespace canopus::plc::melsec_index_test
