// Error frames as PEAK's programs have them in TRC [PEAK CAN TRC File Format], read and written.

#include <chrono>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "trace/support_trace.hpp"

namespace canopus::trace::trc_error_rows_test {
namespace {

using can::data_frame;
using Texts = std::vector<std::string>;

WholeTrace read(std::string bytes) {
  return read_whole(open_reader(TraceInput::from_memory("x", std::move(bytes))));
}

const std::string head_2_0 = ";$FILEVERSION=2.0\n;$STARTTIME=46062.5\n;$COLUMNS=N,O,T,I,d,l,D\n";
const std::string head_2_1 = ";$FILEVERSION=2.1\n;$STARTTIME=46062.5\n;$COLUMNS=N,O,T,B,I,d,R,L,D\n";

TEST(TrcErrorRows, OfEveryVersion_AreErrorFrames) {
  // stuff error (4) while sending (00), place 0AH (data field), REC 1, TEC 2
  const can::Frame expected = data_frame(0x288, {0, 0, 0x84, 0x0A, 0, 0, 2, 1});
  for (const std::string& bytes :
       {std::string(";   own test file\n     2)       200      0004  4  ERROR 00 0A 01 02\n"),
        std::string(";$FILEVERSION=1.1\n     2)       200.0  Error      0004  4  00 0A 01 02\n"),
        std::string(";$FILEVERSION=1.3\n     2)       200.000 1  Error      0004 -  4  00 0A 01 02\n"),
        head_2_0 + "      2         1.000 ER          Rx    04 00 0A 01 02\n",
        head_2_0 + "      2         1.000 ER        - Rx 5  04 00 0A 01 02\n",
        head_2_1 + "      2         1.000 ER 1         - Rx -  5    04 00 0A 01 02\n"}) {
    const WholeTrace all = read(bytes);
    EXPECT_EQ(all.errors, Texts{}) << bytes;
    ASSERT_EQ(all.records.size(), 1U) << bytes;
    EXPECT_TRUE(all.records[0].record.error_frame) << bytes;
    EXPECT_EQ(all.records[0].record.frame, expected) << bytes;
  }
}

TEST(TrcErrorRows, MissingAcknowledgement_IsTheClassOfSocketCan) {
  const WholeTrace all = read("; \n 2) 1842 0008 4 ERROR 00 19 08 09\n 3) 1843 0008 4 ERROR 01 19 08 09\n");
  ASSERT_EQ(all.records.size(), 2U) << testing::PrintToString(all.errors);
  EXPECT_EQ(all.records[0].record.frame, data_frame(0x2A8, {0, 0, 0x80, 0x19, 0, 0, 9, 8}));
  EXPECT_EQ(all.records[1].record.frame, data_frame(0x288, {0, 0, 0, 0x19, 0, 0, 9, 8}));
}

TEST(TrcErrorRows, RowsThatAreNoFrames_AreCountedByKind) {
  for (const std::string& bytes :
       {std::string("; \n 1) 100 0705 1 05\n 3) 300 FFFFFFFF 4 00 00 00 04 -- -- -- -- BUSLIGHT\n"),
        head_2_0 + "1 0.000 DT 0705 Rx 1 05\n3 2.000 ST          Rx    00 00 00 08\n",
        head_2_1 + "1 0.000 DT 1 0705 Rx - 1 05\n3 2.000 ST 1         - Rx -  4    00 00 00 08\n",
        head_2_1 + "1 0.000 DT 1 0705 Rx - 1 05\n3 2.000 EC 1         - Rx -  2    01 02\n"}) {
    const WholeTrace all = read(bytes);
    EXPECT_EQ(all.errors, Texts{}) << bytes;
    EXPECT_EQ(all.records.size(), 1U) << bytes;
    EXPECT_EQ(all.left_out_text, "1 status") << bytes;
  }
}

TEST(TrcErrorRows, Mistakes_SayWhatWasExpected) {
  EXPECT_EQ(read(head_2_1 + "2 1.000 ER 1 - Rx - 5 04 00 0G 01 02\n").errors,
            Texts{"x:4:29: expected a byte of an error, found '0G'"});
  EXPECT_EQ(read("; \n 2) 200 XYZ 4 ERROR 00 0A 01 02\n").errors,
            Texts{"x:2: expected a kind of error of 4 hexadecimal digits, found 'XYZ'"});
}

std::string row_of(std::uint32_t error_class, std::initializer_list<std::uint8_t> data, TrcVersion version) {
  TraceRecord record{.error_frame = true, .frame = data_frame(error_class, data)};
  TraceEncoder encoder(FileFormat::trc, version);
  (void)encoder.begin();
  (void)encoder.encode("can0", record);  // the head stands before the first one
  return std::string(encoder.encode("can0", record));
}

TEST(TrcErrorRows, AreWrittenAsPeakWritesThem) {
  using enum TrcVersion;
  // form error found by a receiver
  EXPECT_EQ(row_of(0x88, {0, 0, 2, 0, 0, 0, 0, 0}, v2_1),
            "      2         0.000 ER  1         - Rx -  5    02 01 00 00 00\r\n");
  // bit stuffing while sending, in the data field, TEC 2, REC 1
  EXPECT_EQ(row_of(0x288, {0, 0, 0x84, 0x0A, 0, 0, 2, 1}, v2_1),
            "      2         0.000 ER  1         - Rx -  5    04 00 0A 01 02\r\n");
  EXPECT_EQ(row_of(0x2A8, {0, 0, 0x80, 0x19, 0, 0, 8, 8}, v1_1),
            "     2)         0.0  Error      0008  4  00 19 08 08\r\n");
  EXPECT_EQ(row_of(0x288, {0, 0, 0x84, 0x0A, 0, 0, 2, 1}, v2_0),
            "      2         0.000 ER          Rx    04 00 0A 01 02\r\n");
  EXPECT_EQ(row_of(0x288, {0, 0, 0x84, 0x0A, 0, 0, 2, 1}, v1_0),
            "     2)         0      0004  4  ERROR 00 0A 01 02\r\n");
  // a state of the controller is another error; its counters stay
  EXPECT_EQ(row_of(0x204, {0, 8, 0, 0, 0, 0, 0x60, 0}, v2_1),
            "      2         0.000 ER  1         - Rx -  5    08 01 00 00 60\r\n");
}

class TrcVersions : public testing::TestWithParam<TrcVersionName> {};

TEST_P(TrcVersions, WhatIsWritten_IsReadAgain) {
  const auto& [version, name] = GetParam();
  can::Frame extended = data_frame(0x18FF0011, {1, 2, 3});
  extended.extended = true;
  const can::Time start(std::chrono::seconds(1'700'000'000) + std::chrono::milliseconds(123));
  TraceEncoder encoder(FileFormat::trc, version);
  std::string bytes(encoder.begin());
  std::vector<TraceRecord> records;
  for (const can::Frame& frame :
       {data_frame(0x181, {0x11}), extended, can::remote_frame(0x705, 1), data_frame(0x80, {})}) {
    const auto after = std::chrono::milliseconds(records.size() * 250);
    records.push_back({.time = start + after, .transmitted = records.size() == 1, .frame = frame});
  }
  records.push_back({.time = start + std::chrono::seconds(2),
                     .error_frame = true,
                     .frame = data_frame(0x288, {0, 0, 0x84, 0x0A, 0, 0, 2, 1})});
  for (const TraceRecord& record : records) bytes += encoder.encode("can0", record);
  bytes += encoder.end();
  const WholeTrace all = read(bytes);
  EXPECT_EQ(all.errors, Texts{}) << bytes;
  ASSERT_EQ(all.records.size(), records.size()) << bytes;
  if (version == TrcVersion::v1_0) records[1].transmitted = false;  // it has no direction
  for (std::size_t i = 0; i < records.size(); ++i) EXPECT_EQ(all.records[i].record, records[i]) << i << bytes;
}

INSTANTIATE_TEST_SUITE_P(Versions, TrcVersions, testing::ValuesIn(trc_version_names),
                         [](const auto& version) {
                           std::string name(version.param.name);
                           name[1] = '_';
                           return "v" + name;
                         });

TEST(TrcStart, OfVersion1_0_IsItsComment) {
  const WholeTrace all =
      read(";    Start time: 01.02.2020 10:00:00.250\n     1)       100      0705  1  05\n");
  ASSERT_EQ(all.records.size(), 1U);
  EXPECT_EQ(all.records[0].record.time,
            can::Time(std::chrono::seconds(1'580'551'200) + std::chrono::milliseconds(350)));
  const WholeTrace wrong =
      read(";    Start time: 31.02.2020 10:00:00.250\n     1)       100      0705  1  05\n");
  EXPECT_EQ(wrong.records.at(0).record.time, can::Time(std::chrono::milliseconds(100)));
}

}  // namespace
}  // namespace canopus::trace::trc_error_rows_test
