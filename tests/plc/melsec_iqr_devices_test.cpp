// Devices of the iQ-R series alone: the refresh data register RD, and U3E0\HG, the fixed scan communication area of the CPU
// buffer memory, which the extended device specification reaches.

#include <string>

#include <gtest/gtest.h>

#include "plc/conversation.hpp"

namespace canopus::plc::melsec_iqr_devices_test {
namespace {

using testing::Plc;

const std::string head = "50 00 00 ff ff 03 00 ";
const std::string done = "d0 00 00 ff ff 03 00 02 00 00 00";
const std::string reply_1234 = "d0 00 00 ff ff 03 00 04 00 00 00 34 12";

/// The end code of a refusal in binary code, low byte first.
std::string end_code(Plc& plc, const std::string& request) { return plc.request(request).substr(27, 5); }
std::string end_code(Plc&& plc, const std::string& request) { return end_code(plc, request); }

TEST(MelsecIqrDevices, Rd_IsReadAndWrittenInEachLayout) {
  Plc plc;
  EXPECT_EQ(plc.request(head + "0e 00 10 00 01 14 00 00 | ff ff 07 2c | 01 00 34 12"), done);
  EXPECT_EQ(plc.word(Device::rd, 524287), 0x1234);
  EXPECT_EQ(plc.request(head + "0e 00 10 00 01 04 02 00 | ff ff 07 00 2c 00 | 01 00"), reply_1234);
  EXPECT_EQ(plc.request(head + "13 00 10 00 01 04 80 00 | 00 00 ff ff 07 2c 00 00 00 00 00 | 01 00"),
            reply_1234);
  Plc ascii;
  ascii.word(Device::rd, 10, 0xBEEF);
  EXPECT_EQ(ascii.raw("500000FF03FF000018001004010000RD0000100001"), "D00000FF03FF0000080000BEEF");
  EXPECT_EQ(ascii.raw("500000FF03FF00001C001004010002RD**000000100001"), "D00000FF03FF0000080000BEEF");
}

TEST(MelsecIqrDevices, Rd_EndsAt524287_AndHoldsWords) {
  Plc plc;
  EXPECT_EQ(end_code(plc, head + "0c 00 10 00 01 04 00 00 | 00 00 08 2c | 01 00"), "31 40");
  EXPECT_EQ(end_code(plc, head + "10 00 10 00 01 14 00 00 | ff ff 07 2c | 02 00 34 12 34 12"), "31 40");
  EXPECT_EQ(plc.word(Device::rd, 524287), 0) << "nothing is written";
  EXPECT_EQ(end_code(plc, head + "0c 00 10 00 01 04 01 00 | 00 00 00 2c | 01 00"), "5c c0");
}

TEST(MelsecIqrDevices, Rd_OfOtherCpus) {
  const std::string read = head + "0c 00 10 00 01 04 00 00 | 00 00 00 2c | 01 00";
  EXPECT_EQ(end_code(Plc(q03udvcpu()), read), "5b c0");
  EXPECT_EQ(end_code(Plc(fx5u()), read), "5c c0");
  EXPECT_EQ(end_code(Plc(fx3u()), read), "5b c0");
}

TEST(MelsecIqrDevices, Rd_ShowsItsPointsInSd308) {
  Plc plc;
  EXPECT_EQ(plc.word(Device::sd, 308), 0);
  EXPECT_EQ(plc.word(Device::sd, 309), 8);
}

TEST(MelsecIqrDevices, Rd_IsClearedWithTheOtherDevices) {
  Plc plc;
  plc.word(Device::rd, 524287, 7);
  plc.rack.clear_devices(false, plc.now);
  EXPECT_EQ(plc.word(Device::rd, 524287), 0);
}

TEST(MelsecIqrDevices, Hg_IsReadAndWrittenInEachExtendedLayout) {
  Plc plc;
  EXPECT_EQ(plc.request(head + "15 00 10 00 01 14 80 00 | 00 00 ff 2f 00 2e 00 00 e0 03 fa | 01 00 34 12"),
            done);
  EXPECT_EQ(plc.word(Device::hg, 12287), 0x1234);
  EXPECT_EQ(plc.request(head + "15 00 10 00 01 04 82 00 | 00 00 ff 2f 00 00 2e 00 00 00 e0 03 fa | 01 00"),
            reply_1234);
  EXPECT_EQ(plc.request(head + "13 00 10 00 01 04 80 00 | 00 00 ff 2f 00 2e 00 00 e0 03 f8 | 01 00"),
            reply_1234);
  Plc ascii;
  ascii.word(Device::hg, 10, 0xBEEF);
  EXPECT_EQ(ascii.raw("500000FF03FF000024001004010080"
                      "00U3E0000HG000010000"
                      "0001"),
            "D00000FF03FF0000080000BEEF");
  EXPECT_EQ(ascii.raw("500000FF03FF00002C001004010082"
                      "00U3E00000HG**00000000100000"
                      "0001"),
            "D00000FF03FF0000080000BEEF");
}

TEST(MelsecIqrDevices, Hg_InRandomReadsAndWritesBlocksAndMonitors) {
  Plc plc;
  const std::string hg5 = "00 00 05 00 00 2e 00 00 e0 03 fa ";
  EXPECT_EQ(plc.request(head + "15 00 10 00 02 14 80 00 | 01 00 | " + hg5 + "34 12"), done);
  EXPECT_EQ(plc.word(Device::hg, 5), 0x1234);
  EXPECT_EQ(plc.request(head + "13 00 10 00 03 04 80 00 | 01 00 | " + hg5), reply_1234);
  EXPECT_EQ(plc.request(head + "15 00 10 00 06 04 80 00 | 01 00 | " + hg5 + "01 00"), reply_1234);
  EXPECT_EQ(plc.request(head + "13 00 10 00 01 08 80 00 | 01 00 | " + hg5), done);
  EXPECT_EQ(plc.request(head + "06 00 10 00 02 08 00 00"), reply_1234);
}

TEST(MelsecIqrDevices, Hg_EndsAt12287_HoldsWords_AndIsTheOwnCpus) {
  Plc plc;
  const auto read = [](const std::string& number, const std::string& of) {
    return head + "13 00 10 00 01 04 80 00 | 00 00 " + number + " 2e 00 00 " + of + " fa | 01 00";
  };
  EXPECT_EQ(plc.request(read("ff 2f 00", "e0 03")), "d0 00 00 ff ff 03 00 04 00 00 00 00 00");
  EXPECT_EQ(end_code(plc, read("00 30 00", "e0 03")), "31 40");
  EXPECT_EQ(end_code(plc, read("00 00 00", "e1 03")), "43 40") << "there is no CPU No. 2";
  EXPECT_EQ(end_code(plc, read("00 00 00", "00 00")), "43 40") << "a module has no HG";
  EXPECT_EQ(end_code(plc, head + "13 00 10 00 01 04 81 00 | 00 00 00 00 00 2e 00 00 e0 03 fa | 01 00"),
            "5c c0");
  EXPECT_EQ(end_code(plc, head + "0c 00 10 00 01 04 00 00 | 00 00 00 2e | 01 00"), "5b c0") << "HG alone";
  EXPECT_EQ(end_code(plc, head + "13 00 10 00 01 04 80 00 | 00 00 00 00 00 2e 00 00 00 00 00 | 01 00"),
            "5b c0");
  EXPECT_EQ(end_code(Plc(q03udvcpu()), read("00 00 00", "e0 03")), "5b c0");
}

TEST(MelsecIqrDevices, Hg_IsBufferMemory_WhichARemoteRunDoesNotClear_ButTheSupply) {
  Plc plc;
  plc.word(Device::hg, 0, 7);
  plc.rack.clear_devices(true, plc.now);
  EXPECT_EQ(plc.word(Device::hg, 0), 7);
  plc.rack.reset_cpu(plc.now);
  EXPECT_EQ(plc.word(Device::hg, 0), 0);
}

}  // namespace
}  // namespace canopus::plc::melsec_iqr_devices_test
