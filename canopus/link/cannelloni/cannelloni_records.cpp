#include "canopus/link/cannelloni/cannelloni_records.hpp"

#include <algorithm>

namespace canopus::link {
namespace {

constexpr std::uint32_t extended_flag = 0x8000'0000, remote_flag = 0x4000'0000, error_flag = 0x2000'0000;
constexpr std::uint8_t version = 2, data_operation = 0;
constexpr std::uint8_t fd_flag = 0x80;
constexpr std::size_t record_head = 5;
constexpr std::size_t most_fd_data = 64;

}  // namespace

void append_cannelloni_record(std::string& out, const can::Frame& frame) {
  const std::uint32_t identifier =
      frame.identifier | (frame.extended ? extended_flag : 0U) | (frame.remote ? remote_flag : 0U);
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<char>(identifier >> shift & 0xFFU));
  out.push_back(static_cast<char>(std::min<std::uint8_t>(frame.dlc, 8)));
  for (const std::uint8_t byte : frame.bytes()) out.push_back(static_cast<char>(byte));
}

void write_cannelloni_datagram(std::string& out, std::uint8_t sequence, std::span<const can::Frame> frames) {
  frames = frames.first(std::min(frames.size(), cannelloni_max_count));
  out.clear();
  for (const std::uint8_t byte :
       {version, data_operation, sequence, static_cast<std::uint8_t>(frames.size() >> 8),
        static_cast<std::uint8_t>(frames.size() & 0xFF)}) {
    out.push_back(static_cast<char>(byte));
  }
  for (const can::Frame& frame : frames) append_cannelloni_record(out, frame);
}

std::optional<CannelloniRecord> next_cannelloni_record(std::span<const std::uint8_t>& bytes) noexcept {
  using Kind = CannelloniRecord::Kind;
  if (bytes.size() < record_head) return std::nullopt;
  std::uint32_t head = 0;
  for (const std::uint8_t byte : bytes.first(4)) head = head << 8 | byte;
  const std::uint8_t length = bytes[4];
  const bool remote = (head & remote_flag) != 0;
  if ((length & fd_flag) != 0) {
    const std::size_t data = length & 0x7FU;
    if (data > most_fd_data) return CannelloniRecord{.kind = Kind::wrong};
    const std::size_t size = record_head + 1 + (remote ? 0 : data);
    if (bytes.size() < size) return std::nullopt;
    bytes = bytes.subspan(size);
    return CannelloniRecord{.kind = Kind::fd_frame};
  }
  if (length > 8) return CannelloniRecord{.kind = Kind::wrong};
  CannelloniRecord record{.kind = (head & error_flag) != 0 ? Kind::error_frame : Kind::frame};
  can::Frame& frame = record.frame;
  frame.extended = (head & extended_flag) != 0;
  frame.remote = remote;
  frame.identifier = head & can::max_extended_identifier;
  frame.dlc = length;
  const bool fits =
      frame.extended || record.kind == Kind::error_frame || frame.identifier <= can::max_base_identifier;
  if (!fits) return CannelloniRecord{.kind = Kind::wrong};
  if (bytes.size() < record_head + frame.length()) return std::nullopt;
  std::ranges::copy(bytes.subspan(record_head, frame.length()), frame.data.begin());
  bytes = bytes.subspan(record_head + frame.length());
  return record;
}

bool read_cannelloni_datagram(std::span<const std::uint8_t> bytes, CannelloniDatagram& datagram) {
  if (bytes.size() < cannelloni_header || bytes[0] != version || bytes[1] != data_operation) return false;
  datagram.sequence = bytes[2];
  datagram.records.clear();
  datagram.mistake = {};
  const unsigned count = bytes[3] * 256U + bytes[4];
  bytes = bytes.subspan(cannelloni_header);
  for (unsigned number = 0; number < count; ++number) {
    const auto record = next_cannelloni_record(bytes);
    if (!record) {
      datagram.mistake = "it ends before its records do";
      return true;
    }
    if (record->kind == CannelloniRecord::Kind::wrong) {
      datagram.mistake = "a record is no CAN frame";
      return true;
    }
    datagram.records.push_back(*record);
  }
  if (!bytes.empty()) datagram.mistake = "there are bytes behind its records";
  return true;
}

CannelloniSequence::Finding CannelloniSequence::classify(std::uint8_t sequence) noexcept {
  const std::uint8_t expected = expected_.value_or(sequence);
  const auto ahead = static_cast<std::uint8_t>(sequence - expected);
  const auto next = static_cast<std::uint8_t>(sequence + 1);
  if (ahead >= 128 && behind_ != sequence) {
    behind_ = next;
    return Finding::another_order;
  }
  expected_ = next;
  behind_.reset();
  lost_ = ahead;
  if (ahead >= 128) return Finding::started_anew;
  return ahead == 0 ? Finding::in_order : Finding::lost;
}

}  // namespace canopus::link
