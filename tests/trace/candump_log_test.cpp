#include "canopus/trace/file/candump_log.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "paths.hpp"

namespace canopus::trace::candump_log_test {
namespace {

using can::Duration;
using can::Frame;
using can::Time;
using namespace std::chrono_literals;

std::string written(const Frame& frame, Time time = Time{}, std::string_view channel = "line1") {
  std::array<char, candump_max_line> line{};
  const std::size_t size = write_candump_line(line, channel, frame, time);
  return {line.data(), size};
}

Frame extended(Frame frame) {
  frame.extended = true;
  return frame;
}

Frame with_dlc(Frame frame, std::uint8_t dlc) {
  frame.dlc = dlc;
  return frame;
}

std::string error_of(std::string_view line, std::size_t number = 1) {
  const auto entry = read_candump_line(line, number);
  return entry ? "no error" : entry.error().message();
}

TEST(CandumpWrite, DataFrame_IsOneLineWithPaddedTime) {
  EXPECT_EQ(written(can::data_frame(0x601, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0}), Time(12s + 345us)),
            "(0000000012.000345) line1 601#4018100100000000\n");
}

TEST(CandumpWrite, FrameWithoutData_EndsAfterTheHash) {
  EXPECT_EQ(written(can::data_frame(0x080)), "(0000000000.000000) line1 080#\n");
}

TEST(CandumpWrite, ExtendedIdentifier_HasEightDigits) {
  EXPECT_EQ(written(extended(can::data_frame(0x601, {0xAB}))), "(0000000000.000000) line1 00000601#AB\n");
}

TEST(CandumpWrite, RemoteFrame_IsAnR) {
  EXPECT_EQ(written(can::remote_frame(0x701)), "(0000000000.000000) line1 701#R\n");
}

TEST(CandumpWrite, RemoteFrameWithLength_NamesIt) {
  EXPECT_EQ(written(can::remote_frame(0x701, 4)), "(0000000000.000000) line1 701#R4\n");
}

TEST(CandumpWrite, DlcAboveEight_IsKeptBehindTheData) {
  EXPECT_EQ(written(with_dlc(can::data_frame(0x123, {1, 2, 3, 4, 5, 6, 7, 8}), 15)),
            "(0000000000.000000) line1 123#0102030405060708_F\n");
}

TEST(CandumpWrite, Nanoseconds_AreCutNotRounded) {
  EXPECT_EQ(written(can::data_frame(0), Time(1s - 1ns)), "(0000000000.999999) line1 000#\n");
}

TEST(CandumpWrite, BlanksInTheChannel_BecomeUnderscores) {
  EXPECT_EQ(written(can::data_frame(0), Time{}, "line 1\n\xE4"), "(0000000000.000000) line_1__ 000#\n");
}

TEST(CandumpWrite, LongestLine_FitsTheAnnouncedRoom) {
  const Frame longest = with_dlc(extended(can::data_frame(0x1FFFFFFF, {1, 2, 3, 4, 5, 6, 7, 8})), 15);
  const std::string line = written(longest, can::never, std::string(100, 'x'));
  EXPECT_LE(line.size(), candump_max_line);
}

TEST(CandumpRead, DataFrame_GivesTimeChannelAndFrame) {
  const auto entry = read_candump_line("(0000000012.000345) line1 601#4018100100000000");
  ASSERT_TRUE(entry) << entry.error().message();
  EXPECT_EQ(*entry, (CandumpEntry{.time = Time(12s + 345us),
                                  .channel = "line1",
                                  .frame = can::data_frame(0x601, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0}),
                                  .log_form = true}));
}

TEST(CandumpRead, UnixTime_IsKeptToTheNanosecond) {
  const auto entry = read_candump_line("(1521802991.795187123) can0 601#");
  ASSERT_TRUE(entry) << entry.error().message();
  EXPECT_EQ(entry->time.time_since_epoch(), Duration(1'521'802'991'795'187'123));
}

TEST(CandumpRead, EightDigits_AreAnExtendedIdentifier) {
  const auto entry = read_candump_line("(1.0) can0 00000601#ab\r\n");
  ASSERT_TRUE(entry) << entry.error().message();
  EXPECT_EQ(entry->frame, extended(can::data_frame(0x601, {0xAB})));
}

TEST(CandumpRead, RemoteFrame_KeepsTheLengthItAsksFor) {
  const auto entry = read_candump_line("(1.0) can0 701#R4");
  ASSERT_TRUE(entry) << entry.error().message();
  EXPECT_EQ(entry->frame, can::remote_frame(0x701, 4));
}

TEST(CandumpRead, RawDlc_IsTaken) {
  const auto entry = read_candump_line("(1.0) can0 123#0102030405060708_F");
  ASSERT_TRUE(entry) << entry.error().message();
  EXPECT_EQ(entry->frame, with_dlc(can::data_frame(0x123, {1, 2, 3, 4, 5, 6, 7, 8}), 15));
}

TEST(CandumpRead, DirectionOfCandumpX_IsSkipped) {
  const auto entry = read_candump_line("(1.0) can0 123#01 T");
  ASSERT_TRUE(entry) << entry.error().message();
  EXPECT_EQ(entry->frame, can::data_frame(0x123, {1}));
}

TEST(CandumpRead, ErrorFrame_IsMarkedAndIsNoFrame) {
  const auto entry = read_candump_line("(1.0) can0 20000004#0001000000000000");
  ASSERT_TRUE(entry) << entry.error().message();
  EXPECT_TRUE(entry->error_frame);
}

TEST(CandumpRead, ScreenForm_IsReadToo) {
  const auto entry = read_candump_line(
      "    (000.000010)  vcan0  603   [8]  A2 7F 7F 00 00 00 00 00   '........' < response");
  ASSERT_TRUE(entry) << entry.error().message();
  EXPECT_EQ(*entry, (CandumpEntry{.time = Time(10us),
                                  .channel = "vcan0",
                                  .frame = can::data_frame(0x603, {0xA2, 0x7F, 0x7F, 0, 0, 0, 0, 0})}));
}

TEST(CandumpRead, ScreenFormOfARemoteFrame_KeepsItsLength) {
  const auto entry = read_candump_line(" (1.0)  vcan0  701   [1]  remote request");
  ASSERT_TRUE(entry) << entry.error().message();
  EXPECT_EQ(entry->frame, can::remote_frame(0x701, 1));
}

TEST(CandumpReadError, NamesLineColumnAndWhatWasExpected) {
  EXPECT_EQ(error_of("(1.0) can0 123#0G", 12),
            "12:17: expected two hexadecimal digits for a byte, found 'G'");
}

TEST(CandumpReadError, EndOfLine_IsNamedAsSuch) {
  EXPECT_EQ(error_of("(1.0) can0 123#0"),
            "1:17: expected two hexadecimal digits for a byte, found the end of the line");
}

TEST(CandumpReadError, UnprintableByte_IsNamedByItsNumber) {
  EXPECT_EQ(error_of("\x01"), "1:1: expected '(' and a time in seconds, found byte 01H");
}

TEST(CandumpReadError, NineBytes_AreTooMany) {
  EXPECT_EQ(error_of("(1.0) can0 123#010203040506070809"), "1:32: expected at most 8 bytes, found '0'");
}

TEST(CandumpReadError, BaseIdentifierAbove7FF_IsRefused) {
  EXPECT_EQ(error_of("(1.0) can0 800#"), "1:12: expected an identifier up to 7FF, found '8'");
}

TEST(CandumpReadError, ExtendedIdentifierAbove29Bits_IsRefused) {
  EXPECT_EQ(error_of("(1.0) can0 80000000#"), "1:12: expected an identifier up to 1FFFFFFF, found '8'");
}

TEST(CandumpReadError, FourDigits_AreNoIdentifier) {
  EXPECT_EQ(error_of("(1.0) can0 0601#"),
            "1:12: expected an identifier of 3 or 8 hexadecimal digits, found '0'");
}

TEST(CandumpReadError, CanFd_IsNamed) {
  EXPECT_EQ(error_of("(1.0) can0 123##311"),
            "1:16: expected the data of a classical frame ('##' begins a CAN FD frame), found '#'");
}

TEST(CandumpReadError, TimeThatDoesNotFit_IsRefused) {
  EXPECT_EQ(error_of("(99999999999.0) can0 123#"),
            "1:2: expected a time below 9223372036 seconds, found '9'");
}

TEST(CandumpRead, DateInsteadOfSeconds_IsUtc) {
  const auto entry = read_candump_line("(2023-01-01 12:00:00.123456) can0 123#");
  ASSERT_TRUE(entry) << entry.error().message();
  EXPECT_EQ(entry->time, Time(1'672'574'400s + 123'456us));
}

TEST(CandumpReadError, DateThatDoesNotExist_IsRefused) {
  EXPECT_EQ(error_of("(2023-02-29 12:00:00.123456) can0 123#"),
            "1:2: expected a date that exists, found '2'");
  EXPECT_EQ(error_of("(2023-13-01 12:00:00.123456) can0 123#"),
            "1:7: expected a number of 1 to 12, found '1'");
}

TEST(CandumpReadError, ScreenFormWithTooFewBytes_IsRefused) {
  EXPECT_EQ(error_of(" (1.0)  vcan0  701   [2]  01"),
            "1:29: expected a blank and another byte, found the end of the line");
}

/// The line that can-utils would write, put together with printf.
std::string printed(const CandumpEntry& entry) {
  const auto microseconds =
      std::chrono::floor<std::chrono::microseconds>(entry.time.time_since_epoch()).count();
  const Frame& frame = entry.frame;
  char text[128];
  std::snprintf(text, sizeof text, "(%010lld.%06lld) %s ", static_cast<long long>(microseconds / 1000000),
                static_cast<long long>(microseconds % 1000000), entry.channel.c_str());
  std::string line = text;
  std::snprintf(text, sizeof text, frame.extended ? "%08X#" : "%03X#", frame.identifier);
  line += text;
  if (frame.remote) {
    line += 'R';
    if (frame.dlc > 0) line += std::to_string(frame.dlc > 8 ? 8 : frame.dlc);
  }
  for (const std::uint8_t byte : frame.bytes()) {
    std::snprintf(text, sizeof text, "%02X", byte);
    line += text;
  }
  if (frame.dlc > 8) {
    std::snprintf(text, sizeof text, "_%X", frame.dlc);
    line += text;
  }
  return line + "\n";
}

CandumpEntry any_entry() {
  CandumpEntry entry;
  entry.log_form = true;
  entry.time = Time(std::chrono::microseconds(*rc::gen::inRange<std::int64_t>(0, 9'223'372'036'000'000)));
  entry.channel = *rc::gen::element<std::string>("can0", "line1", "x", "a#b");
  Frame& frame = entry.frame;
  frame.extended = *rc::gen::arbitrary<bool>();
  frame.remote = *rc::gen::arbitrary<bool>();
  frame.identifier = *rc::gen::inRange<std::uint32_t>(
      0, (frame.extended ? can::max_extended_identifier : can::max_base_identifier) + 1);
  frame.dlc = *rc::gen::inRange<std::uint8_t>(0, 16);
  for (std::size_t i = 0; i < frame.length(); ++i) frame.data[i] = *rc::gen::arbitrary<std::uint8_t>();
  return entry;
}

RC_GTEST_PROP(CandumpProperties, AnyFrame_IsWrittenAsPrintfWould, ()) {
  const CandumpEntry entry = any_entry();
  RC_ASSERT(written(entry.frame, entry.time, entry.channel) == printed(entry));
}

RC_GTEST_PROP(CandumpProperties, AnyLinePrintfWrites_IsReadBack, ()) {
  const CandumpEntry entry = any_entry();
  const auto read = read_candump_line(printed(entry));
  RC_ASSERT(read.has_value());
  RC_ASSERT(*read == entry);
}

RC_GTEST_PROP(CandumpProperties, AnyDamageToALine_GivesAFrameOrAnErrorInsideTheLine, ()) {
  std::string line = printed(any_entry());
  line.pop_back();
  const auto place = *rc::gen::inRange<std::size_t>(0, line.size());
  line[place] = *rc::gen::element('(', ')', '#', '_', 'R', ' ', '.', '0', 'F', '[', '\xFF', '\0');
  if (*rc::gen::arbitrary<bool>()) line.resize(place);
  const auto read = read_candump_line(line);
  if (!read) {
    RC_ASSERT(read.error().column >= 1U);
    RC_ASSERT(read.error().column <= line.size() + 1);
  }
}

TEST(CandumpTraces, CanopenNodeBlockTransfer_IsReadWhole) {
  const std::string path =
      CANOPUS_SOURCE_DIR "/../shared/data/traces/canopennode_two-sdo-block-transfers.candump.txt";
  std::ifstream file(path);
  if (!file) GTEST_SKIP() << "no trace of CANopenNode beside the project";
  std::map<std::uint32_t, int> frames;
  std::vector<std::string> errors;
  std::size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    const auto entry = read_candump_line(line, ++number);
    if (entry) {
      ++frames[entry->frame.identifier];
    } else {
      errors.push_back(entry.error().message());
    }
  }
  // counted with grep; the one line that is no frame is the author's ellipsis
  EXPECT_EQ(errors, std::vector<std::string>{"34:5: expected '(' and a time in seconds, found '.'"});
  EXPECT_EQ(frames, (std::map<std::uint32_t, int>{{0x583, 36}, {0x584, 2}, {0x603, 2}, {0x604, 45}}));
}

}  // namespace
}  // namespace canopus::trace::candump_log_test
