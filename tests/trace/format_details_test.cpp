// What the formats can say that our own writers do not: bytes and lines written by hand.

#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "trace/support_trace.hpp"

namespace canopus::trace::format_details_test {
namespace {

using can::Time;
using namespace std::chrono_literals;

WholeTrace read(std::string bytes) {
  return read_whole(open_reader(TraceInput::from_memory("x", std::move(bytes))));
}

std::string big16(unsigned value) { return {static_cast<char>(value >> 8), static_cast<char>(value & 0xFF)}; }
std::string big32(unsigned value) { return big16(value >> 16) + big16(value & 0xFFFF); }
std::string little16(unsigned value) {
  return {static_cast<char>(value & 0xFF), static_cast<char>(value >> 8)};
}
std::string little32(unsigned value) { return little16(value & 0xFFFF) + little16(value >> 16); }
std::string little64(std::uint64_t value) {
  return little32(static_cast<unsigned>(value)) + little32(static_cast<unsigned>(value >> 32));
}

/// 123#AABB
const std::string frame_packet = big32(0x123) + std::string("\x02\0\0\0\xAA\xBB", 6);
const can::Frame frame = can::data_frame(0x123, {0xAA, 0xBB});

TEST(PcapDetails, BigEndianMicroseconds_AreRead) {
  const WholeTrace all = read(big32(0xA1B2C3D4) + big16(2) + big16(4) + big32(0) + big32(0) + big32(65535) +
                              big32(227) + big32(12) + big32(345) + big32(10) + big32(10) + frame_packet);
  ASSERT_EQ(all.records.size(), 1U) << testing::PrintToString(all.errors);
  EXPECT_EQ(all.records[0].record.time, Time(12s + 345us));
  EXPECT_EQ(all.records[0].record.frame, frame);
}

TEST(PcapDetails, CookedPacketsOfOldRecorders_HaveTheIdentifierInTheirOwnOrder) {
  const std::string head = little32(0xA1B2C3D4) + little16(2) + little16(4) + little32(0) + little32(0) +
                           little32(65535) + little32(113) + little32(1) + little32(0) + little32(26) +
                           little32(26);
  const std::string cooked = big16(4) + big16(280) + big16(0) + std::string(8, '\0') + big16(0x000C);
  const std::string rest("\x02\0\0\0\xAA\xBB", 6);
  for (const std::string& identifier : {little32(0x123), big32(0x123)}) {
    const WholeTrace all = read(head + cooked + identifier + rest);
    ASSERT_EQ(all.records.size(), 1U) << testing::PrintToString(all.errors);
    EXPECT_EQ(all.records[0].record.frame, frame);
    EXPECT_TRUE(all.records[0].record.transmitted);
  }
}

TEST(PcapDetails, CanFd_IsLeftOut) {
  const std::string head = little32(0xA1B23C4D) + little16(2) + little16(4) + little32(0) + little32(0) +
                           little32(65535) + little32(227);
  const std::string fd = big32(0x123) + std::string("\x08\x04\0\0", 4) + std::string(8, 'x');
  const WholeTrace all = read(head + little32(1) + little32(0) + little32(16) + little32(16) + fd);
  EXPECT_EQ(all.left_out, 1U);
  EXPECT_TRUE(all.records.empty());
}

TEST(PcapDetails, OtherLinkType_IsRefused) {
  const WholeTrace all = read(little32(0xA1B23C4D) + std::string(16, '\0') + little32(1));
  EXPECT_EQ(all.errors,
            std::vector<std::string>{"x: offset 20: expected link type 227 (CAN over SocketCAN), 113 or "
                                     "276 (Linux cooked), found 1"});
}

TEST(PcapDetails, LengthBeyondAllReason_EndsTheTrace) {
  const WholeTrace all = read(little32(0xA1B23C4D) + std::string(16, '\0') + little32(227) + little32(1) +
                              little32(0) + little32(0xFFFFFFFF) + little32(0) + std::string(100, 'x'));
  EXPECT_EQ(all.errors, std::vector<std::string>{
                            "x: offset 32: expected a packet of at most 262144 bytes, found 4294967295"});
}

std::string big_block(unsigned type, const std::string& body) {
  const unsigned size = static_cast<unsigned>(body.size()) + 12;
  return big32(type) + big32(size) + body + big32(size);
}

TEST(PcapngDetails, BigEndianSectionWithResolutionOffsetAndOldPackets_IsRead) {
  const std::string section =
      big_block(0x0A0D0D0A, big32(0x1A2B3C4D) + big16(1) + big16(0) + std::string(8, '\xFF'));
  // if_tsresol 10^-3 s, if_tsoffset 1000 s
  const std::string interface = big_block(1, big16(227) + big16(0) + big32(0) + big16(2) + big16(4) + "left" +
                                                 big16(9) + big16(1) + std::string("\x03\0\0\0", 4) +
                                                 big16(14) + big16(8) + big32(0) + big32(1000) + big32(0));
  const std::string packet = frame_packet + std::string(2, '\0');
  const std::string enhanced =
      big_block(6, big32(0) + big32(0) + big32(250) + big32(10) + big32(10) + packet);
  const std::string old =
      big_block(2, big16(0) + big16(0) + big32(0) + big32(500) + big32(10) + big32(10) + packet);
  const std::string simple = big_block(3, big32(10) + packet);
  const WholeTrace all = read(section + interface + enhanced + old + simple);
  ASSERT_EQ(all.records.size(), 3U) << testing::PrintToString(all.errors);
  EXPECT_EQ(all.records[0].record.time, Time(1000s + 250ms));
  EXPECT_EQ(all.records[1].record.time, Time(1000s + 500ms));
  for (const NamedRecord& named : all.records) {
    EXPECT_EQ(named.record.frame, frame);
    EXPECT_EQ(named.channel, "left");
  }
}

TEST(AscDetails, RelativeTimes_AddUp_OfOtherEventsToo) {
  const WholeTrace all = read(
      "date Sam Sep 30 03:06:13.191 pm 2017\nbase dec  timestamps relative\nno internal events logged\n"
      "   0.500000 1  291             Rx   d 2 170 187\n   0.250000 Start of measurement\n"
      "   0.250000 2  291             Tx   d 2 170 187 Length = 1 BitCount = 2 ID = 291\n"
      "   0.000000 2  291             TxRq d 2 170 187\n");
  ASSERT_EQ(all.records.size(), 2U) << testing::PrintToString(all.errors);
  EXPECT_EQ(all.records[0].record.time, Time(1'506'783'973s + 691ms));
  EXPECT_EQ(all.records[1].record.time, Time(1'506'783'974s + 191ms));
  EXPECT_EQ(all.records[1].record.frame, frame);
  EXPECT_EQ(all.records[1].channel, "can1");
  EXPECT_TRUE(all.records[1].record.transmitted);
  EXPECT_EQ(all.left_out, 2U);
}

TEST(AscDetails, WrongIdentifier_IsNamedWithItsPlace) {
  const WholeTrace all = read("base hex  timestamps absolute\n 0.1 1 8FF Rx d 0\n 0.2 1 7FF Rx d 0\n");
  EXPECT_EQ(all.errors, std::vector<std::string>{
                            "x:2:8: expected an identifier, hexadecimal, with x if extended, found '8FF'"});
  EXPECT_EQ(all.records.size(), 1U);
}

TEST(TrcDetails, EveryVersion_HasItsColumns) {
  const std::string data = "2  AA BB";
  const struct {
    std::string version, line;
  } versions[] = {{"", "1)  1841 0123 " + data},
                  {"1.1", "1)  1841.0 Rx 0123 " + data},
                  {"1.2", "1)  1841.000 1 Rx 0123 " + data},
                  {"1.3", "1)  1841.000 1 Rx 0123 - " + data},
                  {"2.0", "1  1841.000 DT 0123 Rx " + data},
                  {"2.1", "1  1841.000 DT 1 0123 Rx - " + data}};
  for (const auto& [version, line] : versions) {
    const std::string head =
        version.empty() ? ";####\n" : ";$FILEVERSION=" + version + "\n;$STARTTIME=25569.5\n";
    const WholeTrace all = read(head + line + "\n");
    ASSERT_EQ(all.records.size(), 1U) << version << testing::PrintToString(all.errors);
    EXPECT_EQ(all.records[0].record.frame, frame) << version;
    EXPECT_EQ(all.records[0].record.time, Time((version.empty() ? 0s : 43'200s) + 1841ms)) << version;
  }
}

TEST(TrcDetails, RemoteErrorAndWarning_AreTold) {
  const WholeTrace all = read(
      ";$FILEVERSION=1.1\n 1) 1.0 Rx 0100 3 RTR\n 2) 2.0 Error 0004 4 00 19 08 08\n"
      " 3) 3.0 Warng FFFFFFFF 4 00 00 00 04 BUSLIGHT\n");
  ASSERT_EQ(all.records.size(), 2U) << testing::PrintToString(all.errors);
  EXPECT_EQ(all.records[0].record.frame, can::remote_frame(0x100, 3));
  EXPECT_TRUE(all.records[1].record.error_frame);
  // 00 sending, 19H acknowledge slot, REC 8, TEC 8: they are in the row, so they are in the frame
  EXPECT_EQ(all.records[1].record.frame, can::data_frame(0x288, {0, 0, 0x84, 0x19, 0, 0, 8, 8}));
  EXPECT_EQ(all.left_out, 1U);
}

TEST(CsvDetails, SemicolonsAndAnotherOrder_AreWhatASpreadsheetMakes) {
  const WholeTrace all = read("time;dlc;id;data;note\r\n1.5;2;123;AA BB;\"a;b\"\r\n");
  ASSERT_EQ(all.records.size(), 1U) << testing::PrintToString(all.errors);
  EXPECT_EQ(all.records[0].record.frame, frame);
  EXPECT_EQ(all.records[0].record.time, Time(1500ms));
}

TEST(BlfDetails, TimesOf10us_SendRequestsAndUnknownObjects) {
  const auto object = [](unsigned type, unsigned flags, const std::string& body) {
    return "LOBJ" + little16(32) + little16(1) + little32(32 + static_cast<unsigned>(body.size())) +
           little32(type) + little32(flags) + little32(0) + little64(150'000) + body;
  };
  const auto message = [](char flags) {
    return little16(2) + std::string{flags, '\x02'} + little32(0x123) +
           std::string("\xAA\xBB\0\0\0\0\0\0", 8);
  };
  const std::string objects = object(1, 1, message(1)) + object(1, 1, message(2)) +
                              object(65, 2, std::string(8, 'x')) + object(86, 2, message(0));
  std::string head = "LOGG" + little32(144);
  head.resize(40);
  for (const unsigned field : {2017U, 9U, 6U, 30U, 15U, 6U, 13U, 191U}) head += little16(field);
  head.resize(144);
  const auto container = [](const std::string& content) {
    return "LOBJ" + little16(16) + little16(1) + little32(32 + static_cast<unsigned>(content.size())) +
           little32(10) + little16(0) + std::string(6, '\0') +
           little32(static_cast<unsigned>(content.size())) + little32(0) + content +
           std::string(content.size() % 4, '\0');
  };
  // the second object goes on in the second container
  const WholeTrace all = read(head + container(objects.substr(0, 60)) + container(objects.substr(60)));
  ASSERT_EQ(all.records.size(), 2U) << testing::PrintToString(all.errors);
  const Time start(1'506'783'973s + 191ms);
  EXPECT_EQ(all.records[0].record.time, start + 1500ms);
  EXPECT_EQ(all.records[1].record.time, start + 150us);
  EXPECT_EQ(all.records[0].record.frame, frame);
  EXPECT_TRUE(all.records[0].record.transmitted);
  EXPECT_EQ(all.records[0].channel, "can1");
  EXPECT_EQ(all.left_out, 2U);
}

}  // namespace
}  // namespace canopus::trace::format_details_test
