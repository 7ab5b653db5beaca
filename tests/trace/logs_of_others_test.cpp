// Logs of programs that we do not write for: tables, BUSMASTER, Microchip, CARBUS Analyzer, CANHacker. The lines of
// the properties are written here.

#include <chrono>
#include <functional>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "trace/support_trace.hpp"

namespace canopus::trace::logs_of_others_test {
namespace {

using can::data_frame;
using can::Frame;
using can::Time;
using namespace std::chrono_literals;
using Texts = std::vector<std::string>;

struct ReadLog {
  WholeTrace all;
  std::string format;
};

ReadLog read(std::string bytes) {
  auto reader = open_reader(TraceInput::from_memory("x", std::move(bytes)));
  const std::string format = reader ? std::string(name_of((*reader)->format())) : "";
  return {read_whole(std::move(reader)), format};
}

Frame extended(Frame frame) {
  frame.extended = true;
  return frame;
}

TEST(GvretCsv, HasMicrosecondsBusesAndAColumnForEachByte) {
  const auto [all, format] = read(
      "Time Stamp,ID,Extended,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8\n"
      "166064000,0000021A,false,0,8,FE,36,12,FE,69,05,07,AD,\n"
      "166064001,18FF0011,true,1,3,30,30,0D,00,00,00,00,00,\n"
      "166064002,0000027A,false,0,0,,,,,,,,\n");
  EXPECT_EQ(format, "csv");
  EXPECT_EQ(all.errors, Texts{});
  ASSERT_EQ(all.records.size(), 3U);
  EXPECT_EQ(all.records[0].record.frame, data_frame(0x21A, {0xFE, 0x36, 0x12, 0xFE, 0x69, 0x05, 0x07, 0xAD}));
  EXPECT_EQ(all.records[0].record.time, Time(166s + 64ms));
  EXPECT_EQ(all.records[0].channel, "can0");
  EXPECT_EQ(all.records[1].record.frame, extended(data_frame(0x18FF0011, {0x30, 0x30, 0x0D})));
  EXPECT_EQ(all.records[1].record.time, Time(166s + 64ms + 1us));
  EXPECT_EQ(all.records[1].channel, "can1");
  EXPECT_EQ(all.records[2].record.frame, data_frame(0x27A, {}));
}

TEST(GvretCsv, WithDirectionAndLongFrames_IsReadAndSaysWhatItLeavesOut) {
  const auto [all, format] = read(
      "Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8,D9,D10,D11,D12\r\n"
      "10,0000021A,false,Tx,0,2,FE,36,,,,,,,,,,\r\n"
      "20,0000021A,false,Rx,0,12,00,01,02,03,04,05,06,07,08,09,0A,0B\r\n");
  EXPECT_EQ(all.errors, Texts{});
  ASSERT_EQ(all.records.size(), 1U);
  EXPECT_TRUE(all.records[0].record.transmitted);
  EXPECT_EQ(all.records[0].record.frame, data_frame(0x21A, {0xFE, 0x36}));
  EXPECT_EQ(all.left_out_text, "1 frame of more than 8 bytes");
}

TEST(GenericCsv, IsReadByItsHead) {
  const struct {
    std::string bytes;
    Time time;
  } tables[] = {
      {"ID,Data Bytes\n0000021A,FE 36 \n", Time{}},
      {"Time (ms),CAN ID,DLC,Data (hex)\n1500.5,0x21A,2,FE 36\n", Time(1500ms + 500us)},
      {"identifier;timestamp [s];payload\n21a;1,5;0xFE 0x36\n", Time(1500ms)},
      {"Bus\tTime\tID (dec)\tRTR\tB1\tB2\n0\t0.25\t538\t0\tFE\t36\n", Time(250ms)},
      {"Time[us],Msg ID,Length,Byte 0,Byte 1,Byte 2\n7,21A,2,FE,36,00\n", Time(7us)},
      // IXXAT's minilog has lines for people before its head
      {"Start Time  Thursday May 01 2025 10:47:15\nBitrate   500 kbit/s\n\n"
       "\"Bus\",\"No\",\"Time\",\"State\",\"ID (hex)\",\"DLC\",\"Data (hex)\",\"ASCII\"\n"
       "\"USB-to-CAN V2 compact  CAN-1\",\"1,000\",\"00:00:00.083\",\"      \",\"21A\",\"2\",\"FE "
       "36\",\"@.\"\n",
       Time(83ms)},
  };
  for (const auto& [bytes, time] : tables) {
    const auto [all, format] = read(bytes);
    EXPECT_EQ(format, "csv") << bytes;
    EXPECT_EQ(all.errors, Texts{}) << bytes;
    ASSERT_EQ(all.records.size(), 1U) << bytes;
    EXPECT_EQ(all.records[0].record.frame, data_frame(0x21A, {0xFE, 0x36})) << bytes;
    EXPECT_EQ(all.records[0].record.time, time) << bytes;
  }
}

TEST(GenericCsv, IdentifierBeyond7FF_IsExtendedWhereNoColumnSaysIt) {
  const auto [all, format] = read("ID,Data\n18FF0011,01\n7FF,02\n20000000,03\n");
  ASSERT_EQ(all.records.size(), 2U);
  EXPECT_EQ(all.records[0].record.frame, extended(data_frame(0x18FF0011, {1})));
  EXPECT_EQ(all.records[1].record.frame, data_frame(0x7FF, {2}));
  EXPECT_EQ(all.errors, Texts{"x:4: expected a hexadecimal identifier, found '20000000'"});
}

TEST(GenericCsv, Mistakes_SayWhatWasExpected) {
  EXPECT_EQ(read("time,channel,note\n1,2,3\n").all.errors.at(0),
            "x:1: expected a head line with id and data, found 'time,channel,note'");
  EXPECT_EQ(read("Time (ms),ID,Data\nsoon,21A,FE\n").all.errors,
            Texts{"x:2: expected a time in ms, found 'soon'"});
  EXPECT_EQ(read("ID,Length,D1\n21A,3,FE\n").all.errors, Texts{"x:2: expected 3 bytes of data, found 1"});
}

const std::string busmaster_head =
    "***BUSMASTER Ver 2.4.0***\n***PROTOCOL CAN***\n***NOTE: PLEASE DO NOT EDIT THIS DOCUMENT***\n"
    "***[START LOGGING SESSION]***\n***START DATE AND TIME 8:8:2014 11:49:7:965***\n";
constexpr auto day = 1'407'456'000s;  // 2014-08-08

TEST(BusmasterLog, InSystemMode_HasTheDateOfItsHead) {
  const auto [all, format] = read(busmaster_head +
                                  "***HEX***\n***SYSTEM MODE***\n"
                                  "***<Time><Tx/Rx><Channel><CAN ID><Type><DLC><DataBytes>***\n"
                                  "11:49:12:9420 Rx 1 0x023 s 1 40\n"
                                  "11:49:12:9440 Tx 2 0x18FF0011 x 2 03 E0 \n"
                                  "22:20:15:2 Rx 0 0000021A s 0 \n"
                                  "00:00:01:0000 Rx 1 0x701 sr 1\n"
                                  "***END DATE AND TIME 9:8:2014 0:0:2:0***\n***[STOP LOGGING SESSION]***\n");
  EXPECT_EQ(format, "busmaster");
  EXPECT_EQ(all.errors, Texts{});
  ASSERT_EQ(all.records.size(), 4U);
  EXPECT_EQ(all.records[0].record.frame, data_frame(0x23, {0x40}));
  EXPECT_EQ(all.records[0].record.time, Time(day + 11h + 49min + 12s + 942ms));
  EXPECT_EQ(all.records[0].channel, "can0");
  EXPECT_EQ(all.records[1].record.frame, extended(data_frame(0x18FF0011, {3, 0xE0})));
  EXPECT_TRUE(all.records[1].record.transmitted);
  EXPECT_EQ(all.records[1].channel, "can1");
  EXPECT_EQ(all.records[2].record.time, Time(day + 22h + 20min + 15s + 2ms));
  EXPECT_EQ(all.records[3].record.frame, can::remote_frame(0x701, 1));
  EXPECT_EQ(all.records[3].record.time, Time(day + 24h + 1s));
}

TEST(BusmasterLog, AbsoluteRelativeAndDecimal_AreRead) {
  const auto [absolute, format] =
      read(busmaster_head + "***DEC***\n***ABSOLUTE MODE***\n0:0:1:5000 Rx 1 35 s 2 064 255\n");
  ASSERT_EQ(absolute.records.size(), 1U) << testing::PrintToString(absolute.errors);
  EXPECT_EQ(absolute.records[0].record.frame, data_frame(0x23, {0x40, 0xFF}));
  EXPECT_EQ(absolute.records[0].record.time, Time(day + 11h + 49min + 9s + 465ms));
  const WholeTrace relative =
      read(busmaster_head +
           "***HEX***\n***RELATIVE MODE***\n0:0:1:0000 Rx 1 0x023 s 0\n0:0:0:5000 Rx 1 0x023 s 0\n")
          .all;
  ASSERT_EQ(relative.records.size(), 2U);
  EXPECT_EQ(relative.records[1].record.time, Time(day + 11h + 49min + 9s + 465ms));
}

TEST(BusmasterLog, OtherProtocolsLongFramesAndMistakes_AreTold) {
  const WholeTrace lin =
      read("***BUSMASTER Ver 2.4.0***\n***PROTOCOL LIN***\n11:49:12:9420 Rx 1 0x023 1 40\n").all;
  EXPECT_EQ(lin.left_out_text, "1 record of another bus");
  const WholeTrace all = read(busmaster_head +
                              "11:49:12:9420 Rx 1 0x023 s 12 40\n"
                              "later Rx 1 0x023 s 1 40\n"
                              "11:49:12:9420 Rx 1 0x823 s 1 40\n"
                              "11:49:12:9420 Rx 1 0x023 q 1 40\n"
                              "11:49:12:9420 Rx 1 0x023 s 2 40\n")
                             .all;
  EXPECT_EQ(all.left_out_text, "1 frame of more than 8 bytes");
  EXPECT_EQ(all.errors, (Texts{"x:7:1: expected a time such as 11:49:12:9420, found 'later'",
                               "x:8:20: expected an identifier, hexadecimal, found '0x823'",
                               "x:9:26: expected the type s, x, sr or xr, found 'q'",
                               "x:10:32: expected a byte of data, found the end of the line"}));
}

const std::string microchip_head =
    "//---------------------------------\nMicrochip Technology Inc.\nCAN BUS Analyzer\nSavvyCAN Exporter\n"
    "Logging Started: 23/9/2015 22:17:43\n//---------------------------------\n";

TEST(MicrochipLog, HasMillisecondsAndPrefixes) {
  const auto [all, format] = read(microchip_head +
                                  "166064;RX;0x0000021A;8;0xFE;0x36;0x12;0xFE;0x69;0x05;0x07;0xAD;\n"
                                  "166064.5;TX;0x236;1;0x0F\n1247;RX;0x18FF0011;0;\n1248;RX;0x123x;0;\n");
  EXPECT_EQ(format, "microchip");
  EXPECT_EQ(all.errors, Texts{});
  ASSERT_EQ(all.records.size(), 4U);
  EXPECT_EQ(all.records[0].record.frame, data_frame(0x21A, {0xFE, 0x36, 0x12, 0xFE, 0x69, 0x05, 0x07, 0xAD}));
  EXPECT_EQ(all.records[0].record.time, Time(166s + 64ms));
  EXPECT_TRUE(all.records[1].record.transmitted);
  EXPECT_EQ(all.records[1].record.time, Time(166s + 64ms + 500us));
  EXPECT_EQ(all.records[2].record.frame, extended(data_frame(0x18FF0011, {})));
  EXPECT_EQ(all.records[3].record.frame, extended(data_frame(0x123, {})));
}

TEST(MicrochipLog, Mistakes_SayWhatWasExpected) {
  const WholeTrace all =
      read(microchip_head + "soon;RX;0x21A;0;\n1;XX;0x21A;0;\n1;RX;0xG;0;\n1;RX;0x1;1;0x100;\n").all;
  EXPECT_EQ(all.errors,
            (Texts{"x:7:1: expected a time in ms, found 'soon'", "x:8:3: expected RX or TX, found 'XX'",
                   "x:9:6: expected a hexadecimal identifier, found '0xG'",
                   "x:10:12: expected a byte of data, found '0x100'"}));
}

TEST(CarbusTrace, OfVersion2_HasLinesThatEndWithACarriageReturn) {
  const auto [all, format] = read(
      "@ TEXT @ 2 @ 64 @ 0 @ 3 @ 10078 @ 00:00:10.078 @\r"
      "46,016\t1\t0004\t45A\t8\t5A 04 00 00 00 00 00 00\t00000000\tZ       \t\r"
      "59,900\t2\t0005\t17333210\t3\t3C A6 00               \t00000000\t<       \t\r"
      "00,016\t1\t0006\t705\t1\t                       \t00000000\t        \t\r");
  EXPECT_EQ(format, "carbus");
  EXPECT_EQ(all.errors, Texts{});
  ASSERT_EQ(all.records.size(), 3U);
  EXPECT_EQ(all.records[0].record.frame, data_frame(0x45A, {0x5A, 4, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(all.records[0].record.time, Time(46s + 16ms));
  EXPECT_EQ(all.records[0].channel, "can0");
  EXPECT_EQ(all.records[1].record.frame, extended(data_frame(0x17333210, {0x3C, 0xA6, 0})));
  EXPECT_EQ(all.records[1].channel, "can1");
  EXPECT_EQ(all.records[2].record.frame, can::remote_frame(0x705, 1));
  EXPECT_EQ(all.records[2].record.time, Time(60s + 16ms));
}

TEST(CarbusTrace, OfVersion3_HasMicrosecondsTheLocalTimeAndNamesFd) {
  for (const std::string end : {"\r", "\n", "\r\n"}) {
    const auto [all, format] =
        read("@ TEXT @ 3 @ 64 @ 0 @ 2 @ 7283 @ 00:00:07.283 @" + end + "# $LocalTime=16:39:55.817" + end +
             "00,469067\t1\t00000030\t0A1\t8\t0A 00 00 00 00 00 00 03\t00000000\t  \t" + end +
             "00,473394\t1\t80000004\t319\t2\t40 18\t00000000\t  @   \t" + end);
    EXPECT_EQ(all.errors, Texts{});
    ASSERT_EQ(all.records.size(), 1U);
    EXPECT_EQ(all.records[0].record.frame, data_frame(0x319, {0x40, 0x18}));
    EXPECT_EQ(all.records[0].record.time, Time(16h + 40min + 473'394us));
    EXPECT_EQ(all.left_out_text, "1 CAN FD frame");
  }
}

TEST(CarbusTrace, Mistakes_SayWhatWasExpected) {
  const WholeTrace all =
      read("@ TEXT @ 3 @\n61,0\t1\t4\t1\t0\t\n1,0\t1\tflags\t1\t0\t\n1,0\t1\t4\t1\t2\t40\t00000000\n").all;
  EXPECT_EQ(all.errors, (Texts{"x:2:1: expected a time such as 46,016, found '61,0'",
                               "x:3:7: expected flags in hexadecimal, found 'flags'",
                               "x:4:16: expected a byte of data, found '00000000'"}));
}

TEST(CanhackerTrace, WithItsHeadOrWithout_IsRead) {
  for (const char* head : {"Time   ID     DLC Data                    Comment\n", "CANHacker trace\n", ""}) {
    const auto [all, format] = read(std::string(head) +
                                    "18,876 070      8 00 B0 C8 64 9D B0 01 D6 \n"
                                    "59.999 18EA0003 3 BE FE 00 \n"
                                    "00,001 301      0 \n");
    EXPECT_EQ(format, "canhacker") << head;
    EXPECT_EQ(all.errors, Texts{}) << head;
    ASSERT_EQ(all.records.size(), 3U) << head;
    EXPECT_EQ(all.records[0].record.frame, data_frame(0x70, {0, 0xB0, 0xC8, 0x64, 0x9D, 0xB0, 1, 0xD6}));
    EXPECT_EQ(all.records[0].record.time, Time(18s + 876ms));
    EXPECT_EQ(all.records[1].record.frame, extended(data_frame(0x18EA0003, {0xBE, 0xFE, 0})));
    EXPECT_EQ(all.records[2].record.frame, data_frame(0x301, {}));
    EXPECT_EQ(all.records[2].record.time, Time(60s + 1ms));
  }
}

TEST(CanhackerTrace, Mistakes_SayWhatWasExpected) {
  const WholeTrace all = read(
                             "Time   ID     DLC Data                    Comment\nsoon 070 0\n1,0 8FF 0\n1,0 "
                             "070 A\n1,0 070 1 XX\n")
                             .all;
  EXPECT_EQ(all.errors, (Texts{"x:2:1: expected a time such as 11,391, found 'soon'",
                               "x:3:5: expected an identifier of 3 or 8 hexadecimal digits, found '8FF'",
                               "x:4:9: expected a DLC of 0 to 8, found 'A'",
                               "x:5:11: expected a byte of data, found 'XX'"}));
}

/// A format, how this test writes a frame in it, and what of a frame it has.
struct Form {
  std::string name, head, line_end;
  std::function<std::string(std::int64_t, const Frame&)> line;  // time in ms
  bool has_remote = true;
};

std::string data_of(const Frame& frame, std::string_view before, std::string_view behind) {
  std::string text;
  for (const std::uint8_t byte : frame.bytes()) text += fmt::format("{}{:02X}{}", before, byte, behind);
  return text;
}

std::string gvret_line(std::int64_t ms, const Frame& frame) {
  std::string bytes = data_of(frame, "", ",");
  for (std::size_t i = frame.length(); i < 8; ++i) bytes += "00,";
  return fmt::format("{},{:08X},{},Rx,0,{},{}", ms * 1000, frame.identifier, frame.extended, frame.dlc,
                     bytes);
}

std::string busmaster_line(std::int64_t ms, const Frame& frame) {
  return fmt::format("{}:{}:{}:{:04} Rx 1 0x{:03X} {}{} {}{}", ms / 3'600'000, ms / 60'000 % 60,
                     ms / 1000 % 60, ms % 1000 * 10, frame.identifier, frame.extended ? "x" : "s",
                     frame.remote ? "r" : "", frame.dlc, data_of(frame, " ", ""));
}

std::string microchip_line(std::int64_t ms, const Frame& frame) {
  return fmt::format("{};RX;0x{:X}{};{};{}{}", ms, frame.identifier, frame.extended ? "x" : "", frame.dlc,
                     frame.remote ? "RTR" : "", data_of(frame, "0x", ";"));
}

std::string carbus_line(std::int64_t ms, const Frame& frame) {
  const unsigned flags = 4U | (frame.extended ? 1U : 0U) | (frame.remote ? 2U : 0U);
  return fmt::format("{:02},{:03}000\t1\t{:08X}\t{:03X}\t{}\t{}\t00000000\t.\t", ms / 1000 % 60, ms % 1000,
                     flags, frame.identifier, frame.dlc, data_of(frame, "", " "));
}

std::string canhacker_line(std::int64_t ms, const Frame& frame) {
  return fmt::format("{:02},{:03} {:0{}X} {} {}{}", ms / 1000 % 60, ms % 1000, frame.identifier,
                     frame.extended ? 8 : 3, frame.dlc, frame.remote ? "RTR" : "", data_of(frame, "", " "));
}

class LogOfOthers : public testing::TestWithParam<Form> {};

struct Written {
  Frame frame;
  std::int64_t ms;
};

std::vector<Written> any_frames(const Form& form) {
  std::vector<Written> frames;
  const auto count = *rc::gen::inRange<std::size_t>(1, 20);
  std::int64_t ms = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Frame frame{.extended = *rc::gen::arbitrary<bool>()};
    frame.remote = form.has_remote && *rc::gen::arbitrary<bool>();
    frame.identifier = *rc::gen::inRange<std::uint32_t>(
        0, (frame.extended ? can::max_extended_identifier : can::max_base_identifier) + 1);
    frame.dlc = *rc::gen::inRange<std::uint8_t>(0, 9);
    for (std::size_t byte = 0; byte < frame.length(); ++byte)
      frame.data[byte] = *rc::gen::arbitrary<std::uint8_t>();
    ms += *rc::gen::inRange<std::int64_t>(0, 29'000);
    frames.push_back({frame, ms});
  }
  return frames;
}

std::string text_of(const Form& form, const std::vector<Written>& frames) {
  std::string text = form.head;
  for (const Written& one : frames) text += form.line(one.ms, one.frame) + form.line_end;
  return text;
}

TEST_P(LogOfOthers, OfAnyFrames_GivesThemBack) {
  const Form& form = GetParam();
  const bool holds = rc::check([&] {
    const auto frames = any_frames(form);
    const auto [all, format] = read(text_of(form, frames));
    RC_ASSERT(all.errors == Texts{});
    RC_ASSERT(all.records.size() == frames.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      RC_ASSERT(all.records[i].record.frame == frames[i].frame);
      RC_ASSERT(all.records[i].record.time == Time(std::chrono::milliseconds(frames[i].ms)));
      RC_ASSERT(all.records[i].channel == "can0");
    }
  });
  EXPECT_TRUE(holds);
}

TEST_P(LogOfOthers, OverAPipe_ComesInPiecesOfAnySize) {
  const Form& form = GetParam();
  const bool holds = rc::check([&] {
    const std::string bytes = text_of(form, any_frames(form));
    const auto most = *rc::gen::inRange<std::size_t>(1, 40);
    const auto source =
        [&, at = std::size_t{0}](std::span<char> out) mutable -> std::expected<std::size_t, int> {
      const std::size_t size = std::min({most, out.size(), bytes.size() - at});
      std::copy_n(bytes.data() + at, size, out.data());
      at += size;
      return size;
    };
    const WholeTrace pieces = read_whole(open_reader(TraceInput("x", source)));
    RC_ASSERT(pieces.errors == Texts{});
    RC_ASSERT(pieces.records == read(bytes).all.records);
  });
  EXPECT_TRUE(holds);
}

TEST_P(LogOfOthers, OfDamagedBytes_EndsWithoutACrash) {
  const Form& form = GetParam();
  const bool holds = rc::check([&] {
    const auto frames = any_frames(form);
    std::string bytes = text_of(form, frames);
    for (int i = 0; i < 3; ++i)
      bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = *rc::gen::arbitrary<char>();
    if (*rc::gen::arbitrary<bool>()) bytes.resize(*rc::gen::inRange<std::size_t>(0, bytes.size()));
    const WholeTrace all =
        read_whole(open_reader(TraceInput::from_memory("x", bytes), format_of_name(form.name)));
    RC_ASSERT(all.records.size() <= frames.size() + 3);
    for (const NamedRecord& named : all.records) {
      RC_ASSERT(named.record.frame.dlc <= 15);
      RC_ASSERT(named.record.frame.identifier <= can::max_extended_identifier);
    }
  });
  EXPECT_TRUE(holds);
}

INSTANTIATE_TEST_SUITE_P(
    Forms, LogOfOthers,
    testing::Values(
        Form{"csv", "Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8\n", "\n", gvret_line, false},
        Form{"busmaster", "***BUSMASTER Ver 3.2.2***\n***PROTOCOL CAN***\n***HEX***\n***SYSTEM MODE***\n",
             "\r\n", busmaster_line},
        Form{"microchip", microchip_head, "\n", microchip_line},
        Form{"carbus", "@ TEXT @ 3 @ 64 @ 0 @ 1 @ 1 @ 00:00:01.000 @\r", "\r", carbus_line},
        Form{"canhacker", "Time   ID     DLC Data                    Comment\n", "\r\n", canhacker_line}),
    [](const auto& form) { return form.param.name; });

}  // namespace
}  // namespace canopus::trace::logs_of_others_test
