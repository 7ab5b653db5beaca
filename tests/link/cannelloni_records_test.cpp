#include "canopus/link/cannelloni/cannelloni_records.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::link::cannelloni_records_test {
namespace {

std::string write_cannelloni_datagram(std::uint8_t sequence, std::span<const can::Frame> frames) {
  std::string datagram = "left over";
  link::write_cannelloni_datagram(datagram, sequence, frames);
  return datagram;
}

std::optional<CannelloniDatagram> read_cannelloni_datagram(std::span<const std::uint8_t> bytes) {
  CannelloniDatagram datagram{.sequence = 99, .records = {{}, {}}, .mistake = "left over"};
  return link::read_cannelloni_datagram(bytes, datagram) ? std::optional(datagram) : std::nullopt;
}

using Bytes = std::vector<std::uint8_t>;
using Kind = CannelloniRecord::Kind;

Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

const std::vector<can::Frame> three = {can::data_frame(0x181, {1, 2, 0xFF}),
                                       {.identifier = 0x12345678, .extended = true, .dlc = 0},
                                       can::remote_frame(0x705, 1)};
const Bytes three_bytes = {2,    0,    7,    0,    3,              //
                           0,    0,    0x01, 0x81, 3, 1, 2, 0xFF,  //
                           0x92, 0x34, 0x56, 0x78, 0,              //
                           0x40, 0,    0x07, 0x05, 1};

TEST(CannelloniRecords, DatagramIsWrittenAsCannelloniHasIt) {
  EXPECT_EQ(bytes_of(write_cannelloni_datagram(7, three)), three_bytes);
}

TEST(CannelloniRecords, DatagramIsRead) {
  const auto datagram = read_cannelloni_datagram(three_bytes);
  ASSERT_TRUE(datagram);
  EXPECT_EQ(datagram->sequence, 7);
  EXPECT_EQ(datagram->mistake, "");
  ASSERT_EQ(datagram->records.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(datagram->records[i].kind, Kind::frame);
    EXPECT_EQ(datagram->records[i].frame, three[i]);
  }
}

TEST(CannelloniRecords, CanFdRecord_IsPassedOver) {
  Bytes bytes = {2, 0, 0, 0, 2, 0, 0, 0x01, 0x81, 0x8C, 1};
  bytes.insert(bytes.end(), 12, 0xAA);
  for (const int byte : {0, 0, 0, 0x80, 0}) bytes.push_back(static_cast<std::uint8_t>(byte));
  const auto datagram = read_cannelloni_datagram(bytes);
  ASSERT_TRUE(datagram);
  ASSERT_EQ(datagram->records.size(), 2U);
  EXPECT_EQ(datagram->records[0].kind, Kind::fd_frame);
  EXPECT_EQ(datagram->records[1].frame, can::data_frame(0x80));
}

TEST(CannelloniRecords, ErrorFrame_IsToldApart) {
  const auto datagram =
      read_cannelloni_datagram(Bytes{2, 0, 0, 0, 1, 0x20, 0, 0, 0x40, 8, 0, 0, 0, 0, 0, 0, 0, 0});
  ASSERT_TRUE(datagram);
  EXPECT_EQ(datagram->records.at(0).kind, Kind::error_frame);
  EXPECT_EQ(datagram->records.at(0).frame.identifier, 0x40U);
}

TEST(CannelloniRecords, CutDatagram_GivesWhatIsWholeAndSaysSo) {
  for (std::size_t size = 5; size < three_bytes.size(); ++size) {
    const auto datagram = read_cannelloni_datagram(std::span(three_bytes).first(size));
    ASSERT_TRUE(datagram);
    EXPECT_EQ(datagram->records.size(), size < 13 ? 0U : size < 18 ? 1U : 2U) << size;
    EXPECT_EQ(datagram->mistake, "it ends before its records do");
  }
  Bytes longer = three_bytes;
  longer.push_back(0);
  EXPECT_EQ(read_cannelloni_datagram(longer)->mistake, "there are bytes behind its records");
}

TEST(CannelloniRecords, WhatIsNoDatagram_IsNone) {
  EXPECT_FALSE(read_cannelloni_datagram({}));
  EXPECT_FALSE(read_cannelloni_datagram(Bytes{2, 0, 0, 0}));
  EXPECT_FALSE(read_cannelloni_datagram(Bytes{1, 0, 0, 0, 0})) << "another version";
  EXPECT_FALSE(read_cannelloni_datagram(Bytes{2, 1, 0, 0, 0})) << "another operation";
}

TEST(CannelloniRecords, WhatIsNoFrame_IsWrong) {
  for (const Bytes& record : {Bytes{0, 0, 0x08, 0x00, 0}, Bytes{0, 0, 0, 1, 9}, Bytes{0, 0, 0, 1, 0xC1}}) {
    std::span<const std::uint8_t> rest(record);
    const auto taken = next_cannelloni_record(rest);
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->kind, Kind::wrong);
  }
}

RC_GTEST_PROP(CannelloniRecordsProperties, AnyBytes_AreWellFormedFrames, (Bytes bytes)) {
  bytes.insert(bytes.begin(), {2, 0, 0, 0});
  const auto datagram = read_cannelloni_datagram(bytes);
  if (!datagram) return;
  for (const CannelloniRecord& record : datagram->records) {
    if (record.kind != Kind::frame) continue;
    RC_ASSERT(record.frame.dlc <= 8);
    RC_ASSERT(record.frame.identifier <=
              (record.frame.extended ? can::max_extended_identifier : can::max_base_identifier));
  }
}

using Finding = CannelloniSequence::Finding;

TEST(CannelloniSequence, LostDatagrams_AreCounted) {
  CannelloniSequence sequence;
  EXPECT_EQ(sequence.classify(254), Finding::in_order);
  EXPECT_EQ(sequence.classify(255), Finding::in_order);
  EXPECT_EQ(sequence.classify(0), Finding::in_order);
  EXPECT_EQ(sequence.classify(4), Finding::lost);
  EXPECT_EQ(sequence.lost(), 3U);
  EXPECT_EQ(sequence.classify(5), Finding::in_order);
}

TEST(CannelloniSequence, OneThatCameLate_DoesNotMoveTheCount) {
  CannelloniSequence sequence;
  sequence.classify(7);
  sequence.classify(9);
  EXPECT_EQ(sequence.classify(8), Finding::another_order);
  EXPECT_EQ(sequence.classify(10), Finding::in_order);
}

TEST(CannelloniSequence, PeerThatWasStartedAnew_IsFollowedFromItsSecondDatagramOn) {
  CannelloniSequence sequence;
  for (std::uint8_t i = 0; i < 100; ++i) sequence.classify(i);
  EXPECT_EQ(sequence.classify(0), Finding::another_order);
  EXPECT_EQ(sequence.classify(1), Finding::started_anew);
  for (std::uint8_t i = 2; i < 100; ++i) EXPECT_EQ(sequence.classify(i), Finding::in_order) << int{i};
}

}  // namespace
}  // namespace canopus::link::cannelloni_records_test
