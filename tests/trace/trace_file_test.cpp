#include "canopus/trace/file/trace_file.hpp"

#include <bit>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

namespace canopus::trace::trace_file_test {
namespace {

using can::Frame;
using can::Time;
using namespace std::chrono_literals;

class TraceFileTest : public testing::Test {
 protected:
  TraceFileTest()
      : path(testing::TempDir() + "canopus_" +
             testing::UnitTest::GetInstance()->current_test_info()->name()) {}
  ~TraceFileTest() override { (void)std::remove(path.c_str()); }

  [[nodiscard]] std::string content() const {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::string path;
};

TEST(TraceFormatOf, NameThatEndsInPcap_IsPcap) {
  EXPECT_EQ(trace_format_of("run.pcap"), FileFormat::pcap);
  EXPECT_EQ(trace_format_of("RUN.PCAP"), FileFormat::pcap);
  for (const char* path : {"run.log", "run.candump", "run.txt", "pcap", "run.1", "/dev/stdout",
                           "runs.of.today/line1", ".hidden", "a.pcap/line1"}) {
    EXPECT_EQ(trace_format_of(path), FileFormat::candump) << path;
  }
}

TEST(TraceFormatOf, ExtensionOfAFormat_IsThatFormat) {
  EXPECT_EQ(trace_format_of("run.pcapng"), FileFormat::pcapng);
  EXPECT_EQ(trace_format_of("run.ASC"), FileFormat::asc);
  EXPECT_EQ(trace_format_of("run.trc"), FileFormat::trc);
  EXPECT_EQ(trace_format_of("run.csv"), FileFormat::csv);
}

TEST(TraceFormatOf, OneThatIsNotWritten_IsRefusedWithThoseThatAre) {
  EXPECT_EQ(
      trace_format_of("runs/x.blf").error(),
      "runs/x.blf: traces are written as candump log (name.log, or a name without extension), .pcap, "
      ".pcapng, .asc, .trc or .csv, not as .blf; python-can's can.logconvert makes a BLF file of an ASC "
      "file");
  for (const char* path : {"x.mf4", "x.vcd", "x.json"}) EXPECT_FALSE(trace_format_of(path)) << path;
}

TEST_F(TraceFileTest, Candump_HoldsOneLinePerFrame) {
  auto trace = TraceFile::create(path, FileFormat::candump);
  ASSERT_TRUE(trace) << trace.error();
  trace->write("line1", can::data_frame(0x701, {0x00}), Time(1ms));
  trace->write("line2", can::data_frame(0x000, {0x01, 0x00}), Time(2ms));
  ASSERT_TRUE(trace->close());
  EXPECT_EQ(content(), "(0000000000.001000) line1 701#00\n(0000000000.002000) line2 000#0100\n");
}

TEST_F(TraceFileTest, Flush_ShowsWhatWasWrittenSoFar) {
  auto trace = TraceFile::create(path, FileFormat::candump);
  ASSERT_TRUE(trace) << trace.error();
  trace->write("line1", can::data_frame(0x701, {0x00}), Time(1ms));
  trace->flush();
  EXPECT_EQ(content(), "(0000000000.001000) line1 701#00\n");
}

TEST_F(TraceFileTest, Destroyed_WritesWhatIsInTheBuffer) {
  {
    auto trace = TraceFile::create(path, FileFormat::candump);
    ASSERT_TRUE(trace) << trace.error();
    trace->write("line1", can::data_frame(0x701, {0x00}), Time(1ms));
  }
  EXPECT_EQ(content(), "(0000000000.001000) line1 701#00\n");
}

TEST_F(TraceFileTest, Pcap_IsHeaderAndRecords) {
  if constexpr (std::endian::native != std::endian::little) GTEST_SKIP() << "the bytes are little endian";
  auto trace = TraceFile::create(path, FileFormat::pcap);
  ASSERT_TRUE(trace) << trace.error();
  trace->write("line1", can::data_frame(0x581, {0x43, 0x00}), Time(3s + 5ns));
  Frame remote = can::remote_frame(0x12345678, 4);
  remote.extended = true;
  trace->write("line1", remote, Time(4s));
  ASSERT_TRUE(trace->close());
  constexpr unsigned char bytes[] = {
      0x4D, 0x3C, 0xB2, 0xA1, 0x02, 0x00, 0x04, 0x00, 0x00, 0x00, 0x00, 0x00,  // magic, version 2.4, zone
      0x00, 0x00, 0x00, 0x00, 0xFF, 0xFF, 0x00, 0x00, 0xE3, 0x00, 0x00, 0x00,  // sigfigs, snaplen, 227
      0x03, 0x00, 0x00, 0x00, 0x05, 0x00, 0x00, 0x00, 0x0A, 0x00, 0x00, 0x00, 0x0A, 0x00,
      0x00, 0x00, 0x00, 0x00, 0x05, 0x81, 0x02, 0x00, 0x00, 0x00, 0x43, 0x00,  // identifier, length, data
      0x04, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x08, 0x00, 0x00, 0x00, 0x08, 0x00,
      0x00, 0x00, 0xD2, 0x34, 0x56, 0x78, 0x04, 0x00, 0x00, 0x00};
  EXPECT_EQ(content(), std::string(std::begin(bytes), std::end(bytes)));
}

TEST_F(TraceFileTest, FolderThatDoesNotExist_IsAnErrorThatNamesTheFile) {
  const auto trace = TraceFile::create("/nowhere/at/all.log", FileFormat::candump);
  ASSERT_FALSE(trace);
  EXPECT_EQ(trace.error(), "/nowhere/at/all.log: cannot create the trace: No such file or directory");
}

TEST_F(TraceFileTest, FullDisk_IsToldOnClose) {
  std::ifstream full_disk("/dev/full");
  if (!full_disk) GTEST_SKIP() << "no /dev/full here";
  auto trace = TraceFile::create("/dev/full", FileFormat::candump);
  ASSERT_TRUE(trace) << trace.error();
  for (int i = 0; i < 10'000; ++i) trace->write("line1", can::data_frame(0x701, {0x00}), Time(1ms));
  const auto closed = trace->close();
  ASSERT_FALSE(closed);
  EXPECT_EQ(closed.error(), "/dev/full: the trace is not complete: No space left on device");
}

}  // namespace
}  // namespace canopus::trace::trace_file_test
