// python-can (Debian's python3-can) reads what we write, and writes what we read.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "trace/support_trace.hpp"

namespace canopus::trace::python_can_test {
namespace {

using can::Time;
using namespace std::chrono_literals;

constexpr char script[] = R"(
import sys, can
mode, form, path = sys.argv[1:4]
def channel(m):
    if form == "csv": return "can0"
    if form == "trc": return f"can{m.channel - 1}"
    return m.channel if isinstance(m.channel, str) else f"can{m.channel}"
if mode == "write":
    options = {"max_container_size": 200} if form == "blf" else {}
    if form == "blf" and len(sys.argv) > 4: options["compression_level"] = int(sys.argv[4])
    kinds = {"asc": can.ASCWriter, "trc": can.TRCWriter, "csv": can.CSVWriter, "blf": can.BLFWriter,
             "candump": can.CanutilsLogWriter}
    writer = kinds[form](path, **options)
    for i in range(200):
        remote = i % 11 == 3
        error = i % 37 == 36
        writer.on_message_received(can.Message(
            timestamp=1700000000.125 + i * 0.012345, arbitration_id=0 if error else i * 10 if i % 3 else i * 2000000,
            is_extended_id=i % 3 == 0, is_remote_frame=remote and not error, is_error_frame=error,
            channel=i % 2, is_rx=i % 5 != 0, dlc=i % 9 if not error else 0,
            data=None if remote or error else bytes((i * 7 + k) % 256 for k in range(i % 9))))
    writer.stop()
if form == "asc": reader = can.ASCReader(path, relative_timestamp=False)
else: reader = {"trc": can.TRCReader, "csv": can.CSVReader, "blf": can.BLFReader,
                "candump": can.CanutilsLogReader}[form](path)
first = None
for m in reader:
    if first is None: first = m.timestamp if form == "trc" else 0
    time = round((m.timestamp - first) * 1e6)
    if m.is_error_frame: print(time, "error")  # its reader of candump logs gives no channel
    else:
        side = "" if form == "csv" else " Rx" if m.is_rx else " Tx"
        data = "" if m.is_remote_frame else bytes(m.data).hex()
        print(time, channel(m), f"{m.arbitration_id:x}", int(m.is_extended_id), int(m.is_remote_frame), m.dlc,
              f"[{data}]{side}")
)";

bool has_python_can() { return std::system("/usr/bin/python3 -c 'import can' >/dev/null 2>&1") == 0; }

/// As the script prints a message.
std::string lines_of(FileFormat format, const std::vector<NamedRecord>& records) {
  std::string lines;
  Time first{};
  for (const auto& [channel, record] : records) {
    if (format == FileFormat::trc && lines.empty()) first = record.time;
    const auto time = std::chrono::floor<std::chrono::microseconds>(record.time - first + 500ns).count();
    if (record.error_frame) {
      lines += fmt::format("{} error\n", time);
      continue;
    }
    lines += fmt::format("{} {} ", time, channel);
    const can::Frame& frame = record.frame;
    lines += fmt::format("{:x} {:d} {:d} {} [", frame.identifier, frame.extended, frame.remote, frame.dlc);
    for (const std::uint8_t byte : frame.bytes()) lines += fmt::format("{:02x}", byte);
    lines += format == FileFormat::csv ? "]\n" : record.transmitted ? "] Tx\n" : "] Rx\n";
  }
  return lines;
}

class PythonCan : public testing::TestWithParam<FileFormat> {
 protected:
  PythonCan() {
    base = fmt::format("{}canopus_python_can_{}_{}", testing::TempDir(), name_of(GetParam()), ::getpid());
    path = base + "_trace";
    std::ofstream(base + ".py") << script;
  }
  ~PythonCan() override {
    for (const char* end : {"_trace", ".py"}) (void)std::remove((base + end).c_str());
  }
  /// What the script prints.
  std::string run(const std::string& mode, const std::string& more = "") const {
    const std::string command = "TZ=UTC /usr/bin/python3 " + base + ".py " + mode + ' ' +
                                std::string(name_of(GetParam())) + ' ' + path + ' ' + more + " 2>/dev/null";
    std::string output;
    std::FILE* pipe = ::popen(command.c_str(), "r");
    std::array<char, 4096> part;
    while (const std::size_t size = std::fread(part.data(), 1, part.size(), pipe))
      output.append(part.data(), size);
    (void)::pclose(pipe);
    return output;
  }

  std::string base, path;
};

class PythonCanWrites : public PythonCan {};

TEST_P(PythonCanWrites, WhatWeReadAsItReadsIt) {
  if (!has_python_can()) GTEST_SKIP() << "python3-can is not installed";
  for (const char* level : {"", "0"}) {
    const std::string lines = run("write", level);
    EXPECT_GT(std::ranges::count(lines, '\n'), 150) << lines;
    const WholeTrace all = read_whole(open_trace(path));
    EXPECT_TRUE(all.errors.empty()) << testing::PrintToString(all.errors);
    EXPECT_EQ(lines_of(GetParam(), all.records), lines);
    if (GetParam() != FileFormat::blf) break;
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, PythonCanWrites,
                         testing::Values(FileFormat::candump, FileFormat::asc, FileFormat::trc,
                                         FileFormat::csv, FileFormat::blf),
                         [](const auto& format) { return std::string(name_of(format.param)); });

class PythonCanReads : public PythonCan {};

TEST_P(PythonCanReads, WhatWeWriteAsWeMeantIt) {
  if (!has_python_can()) GTEST_SKIP() << "python3-can is not installed";
  std::vector<NamedRecord> records;
  for (unsigned i = 0; i < 200; ++i) {
    TraceRecord record{.time = Time(1'700'000'000s + std::chrono::microseconds(123'456 + i * 7'654)),
                       .transmitted = i % 5 == 0};
    record.frame.extended = i % 3 == 0;
    record.frame.identifier = record.frame.extended ? i * 2'000'000 : i * 10;
    // python-can does not read remote frames of TRC
    record.frame.remote = GetParam() != FileFormat::trc && i % 7 == 0;
    record.frame.dlc = static_cast<std::uint8_t>(i % 9);
    // nor the length that a remote frame of a candump log asks for
    if (GetParam() == FileFormat::candump && record.frame.remote) record.frame.dlc = 0;
    for (std::size_t k = 0; k < record.frame.length(); ++k)
      record.frame.data[k] = static_cast<std::uint8_t>(i * 7 + k);
    records.push_back({i % 2 == 0 ? "can0" : "can1", record});
  }
  std::ofstream(path, std::ios::binary) << encoded(GetParam(), records);
  EXPECT_EQ(run("read"), lines_of(GetParam(), records));
}

INSTANTIATE_TEST_SUITE_P(Formats, PythonCanReads,
                         testing::Values(FileFormat::candump, FileFormat::asc, FileFormat::trc),
                         [](const auto& format) { return std::string(name_of(format.param)); });

class PythonCanTrc11 : public PythonCan {};

TEST_P(PythonCanTrc11, WhatWeWriteAsWeMeantIt) {
  if (!has_python_can()) GTEST_SKIP() << "python3-can is not installed";
  std::vector<NamedRecord> records;
  TraceEncoder encoder(FileFormat::trc, TrcVersion::v1_1);
  std::string bytes(encoder.begin());
  for (unsigned i = 0; i < 200; ++i) {
    TraceRecord record{.time = Time(1'700'000'000s + std::chrono::microseconds(123'400 + i * 7'600)),
                       .transmitted = i % 5 == 0};
    record.frame.extended = i % 3 == 0;
    record.frame.identifier = record.frame.extended ? i * 2'000'000 : i * 10;
    record.frame.dlc = static_cast<std::uint8_t>(i % 9);
    for (std::size_t k = 0; k < record.frame.length(); ++k)
      record.frame.data[k] = static_cast<std::uint8_t>(i * 7 + k);
    bytes += encoder.encode("can7", record);
    records.push_back({"can0", record});  // 1.1 has no channels
  }
  bytes += encoder.end();
  std::ofstream(path, std::ios::binary) << bytes;
  EXPECT_EQ(run("read"), lines_of(FileFormat::trc, records));
  const WholeTrace again = read_whole(open_trace(path));
  EXPECT_TRUE(again.errors.empty()) << testing::PrintToString(again.errors);
  ASSERT_EQ(again.records.size(), records.size());
  for (std::size_t i = 0; i < records.size(); ++i) EXPECT_EQ(again.records[i].record, records[i].record) << i;
}

INSTANTIATE_TEST_SUITE_P(Formats, PythonCanTrc11, testing::Values(FileFormat::trc),
                         [](const auto& format) { return std::string(name_of(format.param)); });

}  // namespace
}  // namespace canopus::trace::python_can_test
