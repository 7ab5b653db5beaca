// Traces that others recorded, and what no trace is.

#include "canopus/trace/file/trace_reader.hpp"

#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/trace/file/reader_base.hpp"

#include "paths.hpp"

namespace canopus::trace::trace_reader_test {
namespace {

using namespace std::chrono_literals;

struct ReadTrace {
  std::vector<TraceRecord> records;
  std::vector<std::string> errors;
  std::vector<std::string> channels;
  std::uint64_t left_out = 0;
};

ReadTrace read_all(TraceReader& reader) {
  ReadTrace all;
  while (true) {
    auto next = reader.next();
    if (!next) {
      all.errors.push_back(next.error());
    } else if (*next) {
      all.records.push_back(**next);
    } else {
      break;
    }
  }
  for (std::size_t i = 0; i < reader.channel_count(); ++i) all.channels.emplace_back(reader.channel(i));
  all.left_out = reader.left_out().total();
  return all;
}

ReadTrace read_bytes(std::string bytes) {
  auto reader = open_reader(TraceInput::from_memory("x", std::move(bytes)));
  if (!reader) return {.records = {}, .errors = {reader.error()}, .channels = {}};
  return read_all(**reader);
}

struct Recording {
  const char* name;
  FileFormat format;
  std::size_t records;
  std::size_t left_out;
  std::size_t errors;
};

class SharedTraces : public testing::TestWithParam<Recording> {};

TEST_P(SharedTraces, AreReadWhole) {
  const std::string path = std::string(CANOPUS_SOURCE_DIR "/../shared/data/traces/") + GetParam().name;
  if (!std::ifstream(path)) GTEST_SKIP() << "no recordings beside the project";
  auto reader = open_trace(path);
  ASSERT_TRUE(reader) << reader.error();
  EXPECT_EQ((*reader)->format(), GetParam().format);
  const ReadTrace all = read_all(**reader);
  EXPECT_EQ(all.records.size(), GetParam().records);
  EXPECT_EQ(all.left_out, GetParam().left_out);
  EXPECT_EQ(all.errors.size(), GetParam().errors) << testing::PrintToString(all.errors);
}

// counted with tshark, grep and python-can
INSTANTIATE_TEST_SUITE_P(
    Files, SharedTraces,
    testing::Values(
        Recording{"canopennode_two-sdo-block-transfers.candump.txt", FileFormat::candump, 85, 0, 1},
        Recording{"maxon_epos-70-10_two-nodes.pcapng", FileFormat::pcapng, 149, 0, 0},
        Recording{"ngblume_emcy-tests.pcapng", FileFormat::pcapng, 10364, 0, 0},
        Recording{"ngblume_pdo-tests.pcapng", FileFormat::pcapng, 6046, 0, 0},
        Recording{"ngblume_sdo-tests.pcapng", FileFormat::pcapng, 4518, 0, 0},
        Recording{"ngblume_zmq-tests.pcapng", FileFormat::pcapng, 5683, 0, 0},
        // left out: 2 CAN FD, 2 J1939TP, 6 statistics, 3 status, 2 comments, the start of measurement. Of the four lines
        // CANFD two hold no CAN FD frame: a remote frame without the flag FDF, and an error frame.
        Recording{"python-can_logfile.asc", FileFormat::asc, 18, 16, 0},
        Recording{"python-can_v2.1.trc", FileFormat::trc, 11, 1, 0}),
    [](const auto& file) {
      std::string name = file.param.name;
      std::erase_if(name, [](char c) { return !(c >= 'a' && c <= 'z'); });
      return name;
    });

TEST(TraceReader, CandumpWithDifferences_SumsThemUp) {
  const ReadTrace all = read_bytes(
      " (000.000000)  can0  123   [1]  01\n (000.000200)  can0  123   [1]  02\n"
      " (000.000100)  can0  123   [1]  03\n");
  ASSERT_EQ(all.records.size(), 3U);
  EXPECT_EQ(all.records[2].time, can::Time(300us));
}

TEST(TraceReader, CandumpWithTimesSinceTheBegin_KeepsThem) {
  const ReadTrace all = read_bytes(
      " (000.000000)  can0  123   [1]  01\n (000.000200)  can1  123   [1]  02\n"
      " (000.000300)  can0  123   [1]  03\n");
  ASSERT_EQ(all.records.size(), 3U);
  EXPECT_EQ(all.records[2].time, can::Time(300us));
  EXPECT_EQ(all.channels, (std::vector<std::string>{"can0", "can1"}));
}

TEST(TraceReader, CandumpWithDates_IsUtc) {
  const ReadTrace all = read_bytes(" (2024-02-29 12:00:00.000345)  can0  TX - -  123   [1]  01\n");
  ASSERT_EQ(all.records.size(), 1U) << testing::PrintToString(all.errors);
  EXPECT_EQ(all.records[0].time, can::Time(1'709'208'000s + 345us));
  EXPECT_TRUE(all.records[0].transmitted);
}

TEST(TraceReader, CandumpWithoutTimes_IsReadToo) {
  const ReadTrace all = read_bytes("  can0  123   [2]  01 02\n  can0  12345678   [0]\n");
  ASSERT_EQ(all.records.size(), 2U) << testing::PrintToString(all.errors);
  EXPECT_EQ(all.records[0].frame, can::data_frame(0x123, {1, 2}));
}

TEST(TraceReader, MistakeInALine_DoesNotEndTheTrace) {
  const ReadTrace all =
      read_bytes("(1.0) can0 123#01\n(1.0) can0 123#0G\n(1.0) can0 123##101\n\n(2.0) can0 124#");
  EXPECT_EQ(all.records.size(), 2U);
  EXPECT_EQ(all.left_out, 1U);
  EXPECT_EQ(all.errors,
            std::vector<std::string>{"x:2:17: expected two hexadecimal digits for a byte, found 'G'"});
}

TEST(TraceReader, ErrorFrameOfCandump_HasClassAndData) {
  const ReadTrace all = read_bytes("(1.0) can0 20000004#0001000000000000\n");
  ASSERT_EQ(all.records.size(), 1U);
  EXPECT_TRUE(all.records[0].error_frame);
  EXPECT_EQ(all.records[0].frame, can::data_frame(4, {0, 1, 0, 0, 0, 0, 0, 0}));
}

TEST(TraceReader, LineLongerThanAnyTraceHas_IsOneError) {
  const ReadTrace all =
      read_bytes("(1.0) can0 123#01\n" + std::string(500'000, 'x') + "\n(2.0) can0 123#02\n");
  EXPECT_EQ(all.records.size(), 2U);
  EXPECT_EQ(all.errors, std::vector<std::string>{"x:2: expected a line of at most 16384 bytes"});
}

TEST(TraceReader, EmptyFile_IsATraceInWhichNothingHappened) {
  const ReadTrace all = read_bytes("");
  EXPECT_TRUE(all.records.empty());
  EXPECT_TRUE(all.errors.empty());
}

TEST(TraceReader, SomethingElse_IsRefusedByItsContent) {
  EXPECT_EQ(
      read_bytes("hello world\n").errors.at(0),
      "x: expected a trace: candump log, pcap, pcapng, ASC, TRC, CSV with a head line, BLF, or a log of "
      "BUSMASTER, Microchip's CAN BUS Analyzer, CARBUS Analyzer or CANHacker");
  EXPECT_EQ(read_bytes("\x1F\x8B\x08 something").errors.at(0),
            "x: expected a trace, found a gzip file; gunzip it first");
}

TEST(TraceReader, FileThatIsNotThere_IsNamed) {
  EXPECT_EQ(open_trace("/nowhere/x.log").error(),
            "/nowhere/x.log: cannot open the trace: No such file or directory");
  EXPECT_EQ(open_trace("/").error(), "/: cannot read the trace: Is a directory");
}

}  // namespace
}  // namespace canopus::trace::trace_reader_test
