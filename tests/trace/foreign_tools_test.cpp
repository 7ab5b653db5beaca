// Judges from outside: log2asc of can-utils and tshark read what this room writes. A judge that is not
// installed is skipped, with the reason printed.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "canopus/trace/file/candump_log.hpp"
#include "canopus/trace/file/trace_file.hpp"

#include "paths.hpp"
#include "trace/support_trace.hpp"

namespace canopus::trace::foreign_tools_test {
namespace {

using can::Frame;
using can::Time;
using namespace std::chrono_literals;

bool installed(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

/// What a command wrote to its standard output; standard error goes nowhere.
std::string output_of(const std::string& command) {
  std::string output;
  std::FILE* pipe = ::popen((command + " 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> part;
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), pipe))
    output.append(part.data(), size);
  (void)::pclose(pipe);
  return output;
}

class ForeignTools : public testing::Test {
 protected:
  ForeignTools() {
    std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    std::ranges::replace(name, '/', '_');
    path = testing::TempDir() + "canopus_" + name + '_' + std::to_string(::getpid());
  }
  ~ForeignTools() override { (void)std::remove(path.c_str()); }

  struct Record {
    Frame frame;
    Time time;
  };
  void write(FileFormat format, const std::vector<Record>& records) {
    auto trace = TraceFile::create(path, format);
    ASSERT_TRUE(trace) << trace.error();
    for (const Record& record : records) trace->write("line1", record.frame, record.time);
    ASSERT_TRUE(trace->close());
  }

  std::string path;
};

Frame extended(Frame frame) {
  frame.extended = true;
  return frame;
}

Frame frame_of(std::uint32_t identifier, std::initializer_list<std::uint8_t> bytes) {
  return can::data_frame(identifier, bytes);
}

TEST_F(ForeignTools, Log2asc_ReadsIdentifiersLengthsAndData) {
  if (!installed("log2asc")) GTEST_SKIP() << "log2asc (can-utils) is not installed";
  write(FileFormat::candump, {{frame_of(0x601, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0}), Time(12s + 345us)},
                              {extended(frame_of(0x601, {0x40, 0x18})), Time(12s + 100'345us)},
                              {can::remote_frame(0x701), Time(13s + 345us)},
                              {can::remote_frame(0x701, 4), Time(14s + 345us)},
                              {frame_of(0x080, {}), Time(15s + 345us)}});
  const std::string lines = output_of("LC_ALL=C log2asc -I " + path + " line1 | tail -n +4 | tr -s ' '");
  EXPECT_EQ(lines,
            " 0.000000 1 601 Rx d 8 40 18 10 01 00 00 00 00\n"
            " 0.100000 1 601x Rx d 2 40 18\n"
            " 1.000000 1 701 Rx r 0\n"
            " 2.000000 1 701 Rx r 4\n"
            " 3.000000 1 80 Rx d 0\n");
}

class TsharkReads : public ForeignTools, public testing::WithParamInterface<FileFormat> {};

TEST_P(TsharkReads, EveryKindOfCanopenMessageByItsName) {
  if (!installed("tshark")) GTEST_SKIP() << "tshark is not installed";
  write(GetParam(), {{frame_of(0x705, {0x00}), Time(1ms)},
                     {frame_of(0x000, {0x01, 0x05}), Time(2ms)},
                     {frame_of(0x605, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}), Time(3ms)},
                     {frame_of(0x585, {0x80, 0x00, 0x10, 0x00, 0x00, 0x00, 0x02, 0x06}), Time(4ms)},
                     {frame_of(0x185, {0x12, 0x34}), Time(5ms)},
                     {frame_of(0x705, {0x05}), Time(6ms)},
                     {frame_of(0x085, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0}), Time(7ms)},
                     {frame_of(0x080, {}), Time(8ms)}});
  const std::string text = output_of("tshark -r " + path + " -d can.subdissector,canopen -V");
  std::vector<std::string> missing;
  for (const char* word : {"Boot-up", "Start remote node", "Initiate upload request", "Object does not exist",
                           "PDO1 (tx)", "Operational", "EMCY", "SYNC"}) {
    if (text.find(word) == std::string::npos) missing.emplace_back(word);
  }
  EXPECT_TRUE(missing.empty()) << testing::PrintToString(missing) << text;
}

INSTANTIATE_TEST_SUITE_P(Formats, TsharkReads,
                         testing::Values(FileFormat::candump, FileFormat::pcap, FileFormat::pcapng),
                         [](const auto& format) { return std::string(name_of(format.param)); });

TEST_F(ForeignTools, Tshark_ReadsChannelsTimesAndDirectionsOfOurPcapng) {
  if (!installed("tshark")) GTEST_SKIP() << "tshark is not installed";
  auto trace = TraceFile::create(path, FileFormat::pcapng);
  ASSERT_TRUE(trace) << trace.error();
  trace->write("line1", frame_of(0x123, {1, 2, 3}), Time(1'700'000'000s + 123'456'789ns));
  trace->write(
      "axis \xC3\xA4",
      {.time = Time(1'700'000'001s), .transmitted = true, .frame = extended(frame_of(0x12345678, {0xFF}))});
  trace->write("line1", can::remote_frame(0x701, 4), Time(1'700'000'002s + 1ns));
  trace->write("line1", {.time = Time(1'700'000'003s),
                         .error_frame = true,
                         .frame = frame_of(0x004, {0, 1, 0, 0, 0, 0, 0, 0})});
  ASSERT_TRUE(trace->close());
  EXPECT_EQ(output_of("tshark -r " + path +
                      " -T fields -e frame.time_epoch -e frame.interface_name -e frame.packet_flags_direction"
                      " -e can.id -e can.flags.xtd -e can.flags.rtr -e can.flags.err -e can.len"),
            "1700000000.123456789\tline1\t\t291\t0\t0\t0\t3\n"
            "1700000001.000000000\taxis \xC3\xA4\t0x00000002\t305419896\t1\t0\t0\t1\n"
            "1700000002.000000001\tline1\t\t1793\t0\t1\t0\t4\n"
            "1700000003.000000000\tline1\t\t\t\t\t1\t8\n");
}

TEST_F(ForeignTools, Asc2log_ReadsOurAsc) {
  if (!installed("asc2log")) GTEST_SKIP() << "asc2log (can-utils) is not installed";
  write(FileFormat::asc, {{frame_of(0x601, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0}), Time(12s + 345us)},
                          {extended(frame_of(0x601, {0x40, 0x18})), Time(12s + 100'345us)},
                          {can::remote_frame(0x701, 4), Time(14s + 345us)},
                          {frame_of(0x080, {}), Time(15s + 345us)}});
  // it reads the date with a locale of glibc that need not be there; then its times begin now
  EXPECT_EQ(output_of("TZ=UTC asc2log -I " + path + " | cut -d ' ' -f 2-"),
            "can0 601#4018100100000000 R\n"
            "can0 00000601#4018 R\n"
            "can0 701#R4 R\n"
            "can0 080# R\n");
}

TEST_F(ForeignTools, AscOfLog2asc_IsReadAsTheLogItWasMadeOf) {
  if (!installed("log2asc")) GTEST_SKIP() << "log2asc (can-utils) is not installed";
  std::vector<NamedRecord> records;
  for (std::uint32_t i = 0; i < 100; ++i) {
    TraceRecord record{.time = Time(1'700'000'000s + std::chrono::microseconds(i * 1234))};
    record.frame = {.identifier = i * 4, .extended = i % 3 == 0, .remote = i % 7 == 0};
    record.frame.dlc = static_cast<std::uint8_t>(i % 9);
    for (std::size_t byte = 0; byte < record.frame.length(); ++byte) {
      record.frame.data[byte] = static_cast<std::uint8_t>(i * 31 + byte);
    }
    records.push_back({i % 2 == 0 ? "can0" : "can1", record});
  }
  std::ofstream(path, std::ios::binary) << encoded(FileFormat::candump, records);
  const std::string asc = output_of("TZ=UTC log2asc -I " + path + " can0 can1");
  const WholeTrace all = read_whole(open_reader(TraceInput::from_memory("x", asc)));
  EXPECT_TRUE(all.errors.empty()) << testing::PrintToString(all.errors);
  EXPECT_EQ(all.records, records) << asc;
}

constexpr char tshark_fields[] =
    " -d can.subdissector,canopen -T fields -e can.id -e can.flags.xtd -e can.flags.rtr -e can.len"
    " -e _ws.col.Info -e canopen.sdo.main_idx -e canopen.sdo.data.bytes";

TEST_F(ForeignTools, RecordingOfRealDrives_IsDecodedTheSameAfterOurPcap) {
  if (!installed("tshark")) GTEST_SKIP() << "tshark is not installed";
  const std::string original = CANOPUS_SOURCE_DIR "/../shared/data/traces/maxon_epos-70-10_two-nodes.pcapng";
  if (!std::ifstream(original)) GTEST_SKIP() << "no recording of the drives beside the project";
  // tshark gives the frames, without any decoding of CANopen; our writer writes them again
  std::istringstream lines(output_of("tshark -r " + original +
                                     " -d can.subdissector,data -T fields -e frame.time_epoch -e can.id"
                                     " -e can.flags.rtr -e can.len -e data"));
  std::vector<Record> records;
  std::string time;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    std::uint32_t identifier = 0;
    unsigned remote = 0;
    unsigned length = 0;
    std::string data;
    fields >> time >> identifier >> remote >> length >> data;
    Frame frame{.identifier = identifier, .remote = remote != 0, .dlc = static_cast<std::uint8_t>(length)};
    for (std::size_t i = 0; i < frame.length() && 2 * i + 1 < data.size(); ++i) {
      frame.data[i] = static_cast<std::uint8_t>(std::stoul(data.substr(2 * i, 2), nullptr, 16));
    }
    const std::size_t point = time.find('.');
    records.push_back({frame, Time(std::chrono::seconds(std::stoll(time.substr(0, point))) +
                                   std::chrono::nanoseconds(std::stoll(time.substr(point + 1))))});
  }
  ASSERT_EQ(records.size(), 149U);
  write(FileFormat::pcap, records);
  EXPECT_EQ(output_of("tshark -r " + path + tshark_fields),
            output_of("tshark -r " + original + tshark_fields));
}

TEST_F(ForeignTools, Candump_OfTheSameFrames_IsReadByTsharkLikeOurPcap) {
  if (!installed("tshark")) GTEST_SKIP() << "tshark is not installed";
  std::vector<Record> records;
  for (std::uint32_t i = 0; i < 500; ++i) {
    Frame frame{.identifier = i * 4, .extended = i % 3 == 0, .remote = i % 7 == 0};
    // tshark makes up data for the length of a remote frame in a candump log
    frame.dlc = static_cast<std::uint8_t>(frame.remote ? 0 : i % 9);
    for (std::size_t byte = 0; byte < frame.length(); ++byte) {
      frame.data[byte] = static_cast<std::uint8_t>(i * 31 + byte);
    }
    records.push_back({frame, Time(std::chrono::microseconds(i * 1234))});
  }
  constexpr char fields[] =
      " -d can.subdissector,data -T fields -e frame.time_relative -e can.id -e can.flags.xtd"
      " -e can.flags.rtr -e can.len -e data";
  write(FileFormat::pcap, records);
  const std::string from_pcap = output_of("tshark -r " + path + fields);
  write(FileFormat::candump, records);
  const std::string from_candump = output_of("tshark -r " + path + fields);
  EXPECT_EQ(std::ranges::count(from_pcap, '\n'), 500);
  EXPECT_EQ(from_candump, from_pcap);
}

}  // namespace
}  // namespace canopus::trace::foreign_tools_test
