// Nothing of a trace goes in silence: classical frames in the records of CAN FD channels are read, and what is no
// classical frame is counted by its kind.

#include <chrono>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "trace/support_trace.hpp"

namespace canopus::trace::left_out_test {
namespace {

using can::Time;
using namespace std::chrono_literals;

WholeTrace read(std::string bytes) {
  return read_whole(open_reader(TraceInput::from_memory("x", std::move(bytes))));
}

/// "601 40 18", "701 R4", "00000601 40", "error 088 ..."
std::string text_of(const TraceRecord& record) {
  const can::Frame& frame = record.frame;
  std::string text = record.error_frame ? "error " : "";
  text += fmt::format("{:0{}X}", frame.identifier, frame.extended && !record.error_frame ? 8 : 3);
  if (frame.remote) return text + fmt::format(" R{}", frame.dlc);
  for (const std::uint8_t byte : frame.bytes()) text += fmt::format(" {:02X}", byte);
  if (frame.dlc > 8) text += fmt::format(" DLC {}", frame.dlc);
  return text;
}

std::vector<std::string> texts_of(const WholeTrace& all) {
  std::vector<std::string> texts;
  for (const NamedRecord& named : all.records) texts.push_back(text_of(named.record));
  return texts;
}

using Texts = std::vector<std::string>;

const std::string asc_head = "base hex  timestamps absolute\n";

TEST(AscOfAnFdChannel, ClassicalFrames_AreRead_AndFdFramesAreNamed) {
  const WholeTrace all = read(asc_head +
                              "   0.001000 CANFD   1 Rx        601                                   0 0 8  "
                              "8 40 00 10 00 00 00 00 00   "
                              "130000  130   220000 0 0 0 0 0\n"
                              "   0.002000 CANFD   1 Rx        701                                   0 0 1  "
                              "0 0   0   000010 0 0 0 0 0\n"
                              "   0.003000 CANFD   1 Rx        181                                   1 0 8  "
                              "8 01 02 03 04 05 06 07 08   "
                              "130000  130   303000 0 0 0 0 0\n");
  EXPECT_EQ(texts_of(all), (Texts{"601 40 00 10 00 00 00 00 00", "701 R1"}));
  EXPECT_EQ(all.errors, Texts{});
  EXPECT_EQ(all.left_out_text, "1 CAN FD frame");
  EXPECT_EQ(all.records.at(0).channel, "can0");
  EXPECT_EQ(all.records.at(0).record.time, Time(1ms));
}

TEST(AscOfAnFdChannel, RemoteFrameWithAZeroInPlaceOfItsData_IsRead) {
  const WholeTrace all = read(asc_head +
                              "0.1 CANFD 1 Rx 701 0 0 1 0 0 0 0 000010 0 0 0 0 0\n"
                              "0.2 CANFD 1 Rx 701 0 0 1 0 0 0 0 0 0 0 0 0\n");
  EXPECT_EQ(texts_of(all), Texts{"701 R1"});
  EXPECT_EQ(all.errors, Texts{"x:3: expected 1 bytes of data, found 0"});
}

TEST(AscOfAnFdChannel, NamesExtendedIdentifiersRawDlcAndErrors_AreRead) {
  const WholeTrace all = read(
      asc_head +
      "0.1 CANFD   2 Tx    18FF0011x  Motor_Status  0 0 2 2 AA BB 130000 130 0 0 0 0 0 0\n"
      "0.2 CANFD   1 Rx    100        0 0 f 8 01 02 03 04 05 06 07 08 130000 130 0 0 0 0 0 0\n"
      "0.3 CANFD   1 Rx    100        0 0 0 0 130000 130 0 0 0 0 0 0\n"
      "0.4 CANFD   5 Tx ErrorFrame Not Acknowledge error, dominant error flag fffe c7 31ca\n"
      "0.5 CANFD   1 Rx    100        0 0 f 64 01 02 1331984 11 0 0 0 0 0\n"  // 64 bytes, whatever the flags say
      "0.6 CANFD   1 TxRq  100        0 0 0 0 130000 130 0 0 0 0 0 0\n");
  EXPECT_EQ(texts_of(all), (Texts{"18FF0011 AA BB", "100 01 02 03 04 05 06 07 08 DLC 15", "100",
                                  "error 080 00 00 00 00 00 00 00 00"}));
  EXPECT_TRUE(all.records.at(0).record.transmitted);
  EXPECT_EQ(all.records.at(0).channel, "can1");
  EXPECT_EQ(all.errors, Texts{});
  EXPECT_EQ(all.left_out_text, "1 CAN FD frame, 1 request to send");
}

TEST(AscOfAnFdChannel, Mistakes_SayWhatWasExpected) {
  const WholeTrace all = read(asc_head +
                              "0.1 CANFD 1 Rx 8FF 0 0 1 1 AA 1 1 0\n"
                              "0.2 CANFD 1 Rx 100 0 0 1 1 AA\n"
                              "0.3 CANFD 1 Rx 100 0 0 2 1 AA 1 1 0\n"
                              "0.4 CANFD 300 Rx 100 0 0 1 1 AA 1 1 0\n"
                              "0.5 CANFD 1 Rx 100 0 0 1f 1 AA 1 1 0\n");
  EXPECT_EQ(all.errors, (Texts{"x:2:16: expected an identifier, hexadecimal, with x if extended, found '8FF'",
                               "x:3:30: expected the flags of the frame, hexadecimal",
                               "x:4: expected 2 bytes of data, found 1",
                               "x:5:11: expected the number of a channel, found '300'",
                               "x:6:24: expected a DLC of 0 to F, found '1f'"}));
  EXPECT_TRUE(all.records.empty());
}

TEST(AscOfAnXlChannel, ClassicalFrames_AreRead_AndOthersAreNamed) {
  const WholeTrace all = read(
      asc_head +
      "59.171614 CANXL   2 Rx   CBFF   243215   176      432  msgCanCCTest1 f 8 e1 89 e8 c2 b9 6d 5a f1 174 "
      "00000000 00000000 000000050005000e\n"
      "59.2 CANXL   2 Rx   CEFF   243215   176   18FF0011x 2 2 e1 89 174 00000000 00000000\n"
      "59.3 CANXL   2 Rx   FBFF   243215   176      432  msgCanFDTest2 9 12 e1 89 e8 c2 b9 6d 5a f1 11 22 33 "
      "44 a "
      "12345 00001240 00000000\n"
      "59.4 CANXL   2 Rx   XLFF   984438   4656     432  msgCanXlTest1 e0 0 1fe 511 1 1f96 00 00000000 e1 "
      "89\n");
  EXPECT_EQ(texts_of(all), (Texts{"432 E1 89 E8 C2 B9 6D 5A F1 DLC 15", "18FF0011 E1 89"}));
  EXPECT_EQ(all.errors, Texts{});
  EXPECT_EQ(all.left_out_text, "1 CAN FD frame, 1 CAN XL frame");
}

TEST(AscForms, Tabulators_AndNoHead_AreRead) {
  const WholeTrace tabs = read(
      "date\tSat Sep 30 15:06:13.191 2017\nbase hex\ttimestamps absolute\n0.1\t1\t601\tRx\td\t2\t40\t18\n");
  EXPECT_EQ(texts_of(tabs), Texts{"601 40 18"}) << testing::PrintToString(tabs.errors);
  EXPECT_EQ(tabs.records.at(0).record.time, Time(1'506'783'973s + 291ms));
  for (const char* line : {"   0.001000 1  601             Rx   d 2 40 18\n",
                           "   0.001000 CANFD   1 Rx  601  0 0 2 2 40 18 1 1 0 0 0 0 0 0\n",
                           "0.000500 1 ErrorFrame\n0.001000 1\t601\tTx\td 2 40 18\n"}) {
    const WholeTrace all = read(line);
    ASSERT_FALSE(all.records.empty()) << line << testing::PrintToString(all.errors);
    EXPECT_EQ(text_of(all.records.back().record), "601 40 18") << line;
    EXPECT_EQ(all.records.back().record.time, Time(1ms)) << line;
  }
}

std::string little16(unsigned value) {
  return {static_cast<char>(value & 0xFF), static_cast<char>(value >> 8 & 0xFF)};
}
std::string little32(unsigned value) { return little16(value & 0xFFFF) + little16(value >> 16); }
std::string little64(std::uint64_t value) {
  return little32(static_cast<unsigned>(value)) + little32(static_cast<unsigned>(value >> 32));
}

std::string blf_object(unsigned type, const std::string& body) {
  return "LOBJ" + little16(32) + little16(1) + little32(32 + static_cast<unsigned>(body.size())) +
         little32(type) + little32(2) + little32(0) + little64(1'000'000) + body +
         std::string(body.size() % 4, '\0');
}

std::string blf(const std::string& objects) {
  std::string head = "LOGG" + little32(144);
  head.resize(144);
  return head + objects;
}

/// CAN_FD_MESSAGE: channel, flags, DLC, identifier, frame length, bits of the arbitration, FD flags, valid bytes.
std::string fd_message(char flags, char dlc, unsigned identifier, char fd_flags, std::string data) {
  data.resize(64);
  return blf_object(100, little16(1) + flags + dlc + little32(identifier) + little32(0) + '\0' + fd_flags +
                             static_cast<char>(8) + '\0' + little32(0) + data + little32(0));
}

/// CAN_FD_MESSAGE_64: channel, DLC, valid bytes, transmissions, identifier, frame length, flags ... direction.
std::string fd_message_64(char dlc, unsigned identifier, unsigned flags, char direction,
                          const std::string& data) {
  std::string body{'\x02', dlc, static_cast<char>(data.size()), '\0'};
  body += little32(identifier) + little32(0) + little32(flags) + std::string(16, '\0') + little16(0) +
          direction + '\0' + little32(0) + data;
  return blf_object(101, body);
}

TEST(BlfOfAnFdChannel, ClassicalFrames_AreRead_AndFdFramesAreNamed) {
  const std::string bytes("\x43\x00\x10\x00\x92\x01\x02\x00", 8);
  const WholeTrace all =
      read(blf(fd_message(0, 8, 0x581, 0, bytes) + fd_message(1, 2, 0x80000601U, 0, "\x40\x18") +
               fd_message('\x80', 4, 0x701, 0, "") + fd_message(0, 8, 0x183, 1, bytes) +
               fd_message_64(8, 0x182, 0, 0, bytes) + fd_message_64(0, 0x702, 0x10, 1, "") +
               fd_message_64(8, 0x183, 0x3000, 0, bytes) + fd_message_64(1, 0x705, 0, 2, "\x05")));
  EXPECT_EQ(texts_of(all), (Texts{"581 43 00 10 00 92 01 02 00", "00000601 40 18", "701 R4",
                                  "182 43 00 10 00 92 01 02 00", "702 R0"}));
  EXPECT_EQ(all.errors, Texts{});
  EXPECT_EQ(all.left_out_text, "2 CAN FD frames, 1 request to send");
  EXPECT_TRUE(all.records.at(1).record.transmitted);
  EXPECT_TRUE(all.records.at(4).record.transmitted);
  EXPECT_EQ(all.records.at(0).channel, "can0");
  EXPECT_EQ(all.records.at(3).channel, "can1");
  EXPECT_EQ(all.records.at(0).record.time, Time(1ms));
}

TEST(BlfOfAnFdChannel, ErrorsLostRecordsAndOtherObjects_AreTold) {
  const WholeTrace all = read(
      blf(blf_object(104, std::string("\x03\x08\x08\x00", 4) + std::string(40, '\0')) +
          blf_object(126, little32(0) + little64(0) + little32(7)) + blf_object(4, std::string(32, '\0')) +
          blf_object(65, std::string(16, '\0')) + blf_object(118, std::string(16, '\0'))));
  EXPECT_EQ(texts_of(all), Texts{"error 080 00 00 00 00 00 00 00 00"});
  EXPECT_EQ(all.records.at(0).channel, "can2");
  EXPECT_EQ(all.lost, 7U);
  EXPECT_EQ(all.left_out_text, "1 statistic, 1 comment, 1 other record");
}

TEST(BlfOfAnFdChannel, ObjectThatIsTooSmall_IsAnError) {
  EXPECT_EQ(read(blf(blf_object(100, std::string(12, '\0')))).errors,
            Texts{"x: object at byte 0 of what the containers hold: expected a larger object of this type"});
}

TEST(EachFormat, NamesCanFd) {
  const std::string trc = ";$FILEVERSION=2.1\n;$STARTTIME=25569.5\n;$COLUMNS=N,O,T,B,I,d,R,L,D\n";
  const std::string pcap_head =
      little32(0xA1B23C4D) + little16(2) + little16(4) + little64(0) + little32(65535) + little32(227);
  const std::string pcap_record = little32(1) + little32(0) + little32(16) + little32(16);
  const struct {
    std::string name, bytes, left_out;
  } traces[] = {
      {"candump log", "(1.0) can0 181##1112233\n(1.0) can0 00123#81:00:00000001#1122\n(1.0) can0 705#05\n",
       "1 CAN FD frame, 1 CAN XL frame"},
      {"candump screen", "  can0  181  [03]  11 22 33\n  can0  123  [0002]  11 22\n  can0  705   [1]  05\n",
       "1 CAN FD frame, 1 CAN XL frame"},
      {"trc",
       trc + "1 0.0 FD 1 0181 Rx - 9 00 00 00 00 00 00 00 00 00 00 00 00\n2 0.0 ST 1 - Rx - 4 00 00 00 08\n"
             "3 0.0 EC 1 - Rx - 2 01 02\n4 0.0 EV 1 note\n",
       "1 CAN FD frame, 2 statuses, 1 other record"},
      {"csv", "time,id,fd,data\n0.1,181,1,00\n0.2,181,0,00 01 02 03 04 05 06 07 08\n",
       "1 CAN FD frame, 1 frame of more than 8 bytes"},
      {"pcap",
       pcap_head + pcap_record + std::string("\0\0\x01\x23\x08\x04\0\0........", 16) + pcap_record +
           std::string("\0\0\x01\x23\x80\x04\0\0........", 16),
       "1 CAN FD frame, 1 CAN XL frame"},
  };
  for (const auto& [name, bytes, left_out] : traces) {
    const WholeTrace all = read(bytes);
    EXPECT_EQ(all.left_out_text, left_out) << name;
    EXPECT_EQ(all.errors, Texts{}) << name;
  }
}

TEST(LostFrames, OfCandumpAndPcapng_AreCounted) {
  const WholeTrace log = read(
      "(1700000000.000001) can0 705#05\nDROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)\n"
      "(1700000000.000009) can0 705#05\nDROPCOUNT: dropped 1 CAN frame on 'can0' socket (total drops 4)\n");
  EXPECT_EQ(log.lost, 4U);
  EXPECT_EQ(log.records.size(), 2U);
  EXPECT_EQ(log.left_out, 0U);
  EXPECT_EQ(log.errors, Texts{});
  EXPECT_EQ(read("DROPCOUNT: dropped many\n").errors,
            Texts{"x:1:20: expected the number of dropped frames, found 'many'"});

  const auto block = [](unsigned type, const std::string& body) {
    const unsigned size = static_cast<unsigned>(body.size()) + 12;
    return little32(type) + little32(size) + body + little32(size);
  };
  const auto dropped = [&](unsigned interface_drops, unsigned system_drops) {
    return block(5, little32(0) + little64(0) + little16(5) + little16(8) + little64(interface_drops) +
                        little16(7) + little16(8) + little64(system_drops) + little32(0));
  };
  const WholeTrace pcapng =
      read(block(0x0A0D0D0A, little32(0x1A2B3C4D) + little16(1) + little16(0) + std::string(8, '\xFF')) +
           block(1, little16(227) + little16(0) + little32(0)) + dropped(2, 1) + dropped(5, 1));
  EXPECT_EQ(pcapng.lost, 6U);
  EXPECT_EQ(pcapng.errors, Texts{});
}

TEST(LeftOutCounts, AreWordsAndKeys) {
  LeftOut counts;
  EXPECT_EQ(counts.text(), "");
  for (const LeftOutName& name : left_out_names) counts.add(name.kind);
  counts.add(LeftOutKind::can_fd);
  EXPECT_EQ(
      counts.text(),
      "2 CAN FD frames, 1 CAN XL frame, 1 frame of more than 8 bytes, 1 request to send, 1 record of another "
      "bus, 1 status, 1 statistic, 1 comment, 1 other record");
  EXPECT_EQ(counts.total(), 10U);
  EXPECT_EQ(counts.frames(), 5U);
  for (std::size_t i = 0; i < left_out_names.size(); ++i)
    EXPECT_EQ(static_cast<std::size_t>(left_out_names[i].kind), i);
  counts.add_lost(~std::uint64_t{0});
  counts.add_lost(1);
  EXPECT_EQ(counts.lost(), ~std::uint64_t{0});
}

TEST(OtherFiles, AreNamedWhenTheyAreRefused) {
  const struct {
    std::string bytes, named;
  } files[] = {
      {"MDF     4.10    ", "an ASAM MDF file (MF4, MDF), which is not read; export it as ASC, BLF or CSV"},
      {"UnFinMF 4.10    ",
       "an ASAM MDF file (MF4) whose recording was not finished; it is not read, export it as ASC, BLF or "
       "CSV"},
      {"VERSION \"\"\n\nNS_ :\n", "a DBC file, which describes messages and has no frames"},
      {"\nBU_: Vector\n", "a DBC file, which describes messages and has no frames"},
      {"[FileInfo]\nFileName=a.eds\n", "a device file (EDS, DCF), which has no frames"},
      {"<?xml version=\"1.0\"?>", "an XML file; device files (XDD, XDC) are none"},
      {std::string("PK\x03\x04 rest of the archive"), "a ZIP archive; unzip it first"},
      {"SQLite format 3\n", "an SQLite database; python-can's can.logconvert makes a trace of its own"},
      {"\xFF\xFE(\x01 some text", "text in UTF-16; save it as UTF-8"}};
  for (const auto& [bytes, named] : files)
    EXPECT_EQ(read(bytes).errors, Texts{"x: expected a trace, found " + named});
}

TEST(ByteOrderMarks, OfUtf8_AreSkippedInEveryTextFormat) {
  for (const char* text : {"(1.0) can0 601#4018\n", "  can0  601   [2]  40 18\n", "0.1 1 601 Rx d 2 40 18\n",
                           "base hex timestamps absolute\n0.1 1 601 Rx d 2 40 18\n",
                           ";$FILEVERSION=1.1\n1) 1.0 Rx 0601 2 40 18\n", "time,id,data\n0.1,601,40 18\n"}) {
    const WholeTrace all = read(std::string("\xEF\xBB\xBF") + text);
    EXPECT_EQ(texts_of(all), Texts{"601 40 18"}) << text << testing::PrintToString(all.errors);
    EXPECT_EQ(all.errors, Texts{}) << text;
  }
}

}  // namespace
}  // namespace canopus::trace::left_out_test
