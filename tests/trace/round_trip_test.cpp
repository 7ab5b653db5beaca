// What a format can carry comes back equal; what it cannot is the table of docs/traces.md, and lossy() here.

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "trace/support_trace.hpp"

namespace canopus::trace::round_trip_test {
namespace {

using can::Frame;
using can::Time;
using std::chrono::microseconds;

constexpr std::int64_t one_second = 1'000'000'000;

NamedRecord any_record(FileFormat format) {
  NamedRecord named;
  const bool numbered = format == FileFormat::asc || format == FileFormat::trc;
  named.channel = *(numbered ? rc::gen::element<std::string>("can0", "can1", "can7")
                             : rc::gen::element<std::string>("can0", "line1", "a#b", "q;\"x,"));
  if (format == FileFormat::pcap) named.channel = "can0";
  TraceRecord& record = named.record;
  record.time = Time(can::Duration(*rc::gen::inRange<std::int64_t>(0, 4'000'000'000) * one_second +
                                   *rc::gen::inRange<std::int64_t>(0, one_second)));
  record.transmitted = *rc::gen::arbitrary<bool>();
  record.error_frame = *rc::gen::inRange(0, 8) == 0;
  Frame& frame = record.frame;
  frame.extended = *rc::gen::arbitrary<bool>();
  frame.remote = *rc::gen::arbitrary<bool>();
  frame.dlc = *rc::gen::inRange<std::uint8_t>(0, 16);
  frame.identifier = *rc::gen::inRange<std::uint32_t>(
      0, (frame.extended ? can::max_extended_identifier : can::max_base_identifier) + 1);
  if (record.error_frame) {
    frame.remote = false;
    frame.dlc = 8;
    set_error_frame(record, frame.identifier);
  }
  for (std::size_t i = 0; i < frame.length(); ++i) frame.data[i] = *rc::gen::arbitrary<std::uint8_t>();
  return named;
}

/// The record as the format keeps it.
NamedRecord lossy(FileFormat format, NamedRecord named) {
  TraceRecord& record = named.record;
  const auto cut = std::chrono::floor<microseconds>(record.time.time_since_epoch());
  switch (format) {
    case FileFormat::pcap: record.transmitted = false; break;
    case FileFormat::candump: record.time = Time(cut); break;
    case FileFormat::asc:
      record.time = Time(cut);
      if (!record.error_frame) break;
      record.frame = {.identifier = 0x80, .dlc = 8};
      record.transmitted = false;
      break;
    case FileFormat::trc: {
      record.time = Time(cut);
      if (!record.error_frame) break;
      // PEAK's rows have kind, direction and place of a protocol error, and the counters of every error
      const can::Frame given = record.frame;
      const bool has_place = (given.identifier & 0x08U) != 0;
      const auto kind = static_cast<std::uint8_t>(has_place ? given.data[2] & 0x87U : 0U);
      const std::uint8_t place = has_place ? given.data[3] : std::uint8_t{0};
      const bool no_acknowledgement = kind == 0x80 && place == 0x19;
      record.frame = {.identifier = no_acknowledgement ? 0x2A8U : 0x288U,
                      .dlc = 8,
                      .data = {0, 0, kind, place, 0, 0, given.data[6], given.data[7]}};
      break;
    }
    default: break;
  }
  return named;
}

class RoundTrip : public testing::TestWithParam<FileFormat> {};

TEST_P(RoundTrip, OfAnyRecords_GivesThemBack) {
  const FileFormat format = GetParam();
  const bool holds = rc::check([&] {
    const auto count = *rc::gen::inRange<std::size_t>(0, 20);
    std::vector<NamedRecord> records, expected;
    for (std::size_t i = 0; i < count; ++i) {
      records.push_back(any_record(format));
      expected.push_back(lossy(format, records.back()));
    }
    const std::string bytes = encoded(format, records);
    const WholeTrace all = read_whole(open_reader(TraceInput::from_memory("x", bytes)));
    RC_ASSERT(all.errors == std::vector<std::string>{});
    RC_ASSERT(all.records.size() == expected.size());
    for (std::size_t i = 0; i < count; ++i) {
      RC_ASSERT(all.records[i].channel == expected[i].channel);
      RC_ASSERT(all.records[i].record.time == expected[i].record.time);
      RC_ASSERT(all.records[i].record == expected[i].record);
    }
    // and what was read is written as the same bytes
    RC_ASSERT(encoded(format, all.records).size() == bytes.size());
  });
  EXPECT_TRUE(holds);
}

TEST_P(RoundTrip, OverAPipe_ComesInPiecesOfAnySize) {
  const FileFormat format = GetParam();
  const bool holds = rc::check([&] {
    std::vector<NamedRecord> records;
    for (int i = 0; i < 5; ++i) records.push_back(any_record(format));
    std::string bytes = encoded(format, records);
    if (format == FileFormat::candump || format == FileFormat::csv)
      bytes.pop_back();  // no end of the last line
    const auto most = *rc::gen::inRange<std::size_t>(1, 40);
    const auto source =
        [&, at = std::size_t{0}](std::span<char> out) mutable -> std::expected<std::size_t, int> {
      const std::size_t size = std::min({most, out.size(), bytes.size() - at});
      std::copy_n(bytes.data() + at, size, out.data());
      at += size;
      return size;
    };
    const WholeTrace pieces = read_whole(open_reader(TraceInput("x", source)));
    const WholeTrace whole = read_whole(open_reader(TraceInput::from_memory("x", bytes)));
    RC_ASSERT(pieces.errors == std::vector<std::string>{});
    RC_ASSERT(pieces.records == whole.records);
    RC_ASSERT(pieces.records.size() == 5U);
  });
  EXPECT_TRUE(holds);
}

TEST_P(RoundTrip, OfDamagedBytes_EndsWithoutACrash) {
  const FileFormat format = GetParam();
  const bool holds = rc::check([&] {
    std::vector<NamedRecord> records;
    for (int i = 0; i < 5; ++i) records.push_back(any_record(format));
    std::string bytes = encoded(format, records);
    for (int i = 0; i < 3; ++i)
      bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = *rc::gen::arbitrary<char>();
    if (*rc::gen::arbitrary<bool>()) bytes.resize(*rc::gen::inRange<std::size_t>(0, bytes.size()));
    const WholeTrace all = read_whole(open_reader(TraceInput::from_memory("x", bytes), format));
    RC_ASSERT(all.records.size() <= 6U);
    for (const NamedRecord& named : all.records) {
      RC_ASSERT(named.record.frame.dlc <= 15);
      RC_ASSERT(named.record.frame.identifier <= can::max_extended_identifier);
    }
  });
  EXPECT_TRUE(holds);
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip,
                         testing::Values(FileFormat::candump, FileFormat::pcap, FileFormat::pcapng,
                                         FileFormat::asc, FileFormat::trc, FileFormat::csv),
                         [](const auto& format) { return std::string(name_of(format.param)); });

}  // namespace
}  // namespace canopus::trace::round_trip_test
