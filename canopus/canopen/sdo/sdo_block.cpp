#include "canopus/canopen/sdo/sdo_block.hpp"

#include <utility>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/sdo/sdo_crc.hpp"
#include "canopus/canopen/sdo/sdo_frame.hpp"

namespace canopus::canopen {
namespace {

constexpr bool is_block_size(std::uint8_t segments) noexcept { return segments >= 1 && segments <= 127; }

}  // namespace

AbortCode BlockSender::begin(std::uint8_t block_size, bool with_crc) noexcept {
  if (!is_block_size(block_size)) return AbortCode::block_size;
  phase_ = Phase::ready;
  with_crc_ = with_crc;
  block_size_ = block_size;
  sequence_ = 0;
  last_sequence_ = 0;
  confirmed_ = 0;
  crc_ = 0;
  return AbortCode::none;
}

AbortCode BlockSender::send(SegmentSource& source, can::Sink& sink, FrameHead head) {
  if (phase_ == Phase::ready) phase_ = Phase::sending;
  if (is_inside_send_) return AbortCode::none;
  is_inside_send_ = true;
  AbortCode code = AbortCode::none;
  while (phase_ == Phase::sending) {
    code = source.prepare(block_size_ * sdo::segment_size);
    if (code != AbortCode::none) break;
    const auto rest = source.window().subspan(sequence_ * sdo::segment_size);
    const bool last = rest.size() <= sdo::segment_size && source.ends_in_window();
    const auto sequence = static_cast<std::uint8_t>(sequence_ + 1);
    sequence_ = sequence;
    if (last) {
      last_sequence_ = sequence;
      unused_ = static_cast<std::uint8_t>(sdo::segment_size - rest.size());
    }
    if (last || sequence == block_size_) phase_ = Phase::waiting;
    if (sink.send(sdo::block_segment(head, sequence | (last ? sdo::last_segment : 0U), rest))) continue;
    if (sequence_ != sequence) break;  // it was out, for it is confirmed
    --sequence_;
    if (last) last_sequence_ = 0;
    phase_ = Phase::sending;
    break;
  }
  is_inside_send_ = false;
  return code;
}

AbortCode BlockSender::confirmed(const can::Frame& answer, SegmentSource& source) {
  const std::uint8_t confirmed = answer.data[1];
  const std::uint8_t block_size = answer.data[2];
  if (!is_block_size(block_size)) return AbortCode::block_size;
  if (confirmed > sequence_) {
    return confirmed == confirmed_ ? AbortCode::none : AbortCode::sequence_number;
  }
  const bool complete = last_sequence_ != 0 && confirmed == last_sequence_;
  const std::size_t bytes = confirmed * sdo::segment_size - (complete ? unused_ : 0U);
  if (with_crc_) crc_ = sdo::crc16(crc_, source.window().first(bytes));
  source.advance(bytes);
  block_size_ = block_size;
  confirmed_ = confirmed;
  sequence_ = 0;
  last_sequence_ = 0;
  phase_ = complete ? Phase::complete : Phase::sending;
  return AbortCode::none;
}

can::Frame BlockSender::end(FrameHead head) const noexcept {
  return frame_of(head, 0xC1U | std::uint64_t{unused_} << 2 | std::uint64_t{crc_} << 8);
}

void BlockReceiver::begin(std::uint8_t block_size, bool with_crc, const can::Frame& initiation) noexcept {
  *this = {};
  just_confirmed_ = true;
  answered_ = std::bit_cast<std::uint64_t>(initiation.data);
  block_size_ = block_size;
  with_crc_ = with_crc;
}

can::Frame BlockReceiver::confirmation(FrameHead head, std::uint8_t block_size) noexcept {
  const std::uint64_t came = sequence_;
  just_confirmed_ = true;
  sequence_ = 0;
  block_size_ = block_size;
  return frame_of(head, 0xA2U | came << 8 | std::uint64_t{block_size} << 16);
}

can::Frame BlockReceiver::early_confirmation(FrameHead head) noexcept {
  rest_may_come_ = true;
  return confirmation(head, block_size_);
}

/// A segment is here that asks for a confirmation.
bool BlockReceiver::is_to_be_answered(const can::Frame& segment) noexcept {
  const bool is_late = std::exchange(rest_may_come_, false);
  const bool is_repeated = just_confirmed_ && is_answered(segment);
  if (sequence_ == 0 && (is_late || is_repeated)) return false;
  answered_ = std::bit_cast<std::uint64_t>(segment.data);
  return true;
}

AbortCode BlockReceiver::finish(const can::Frame& end, SegmentCollector& collector) const {
  const AbortCode code = collector.finish(end.data[0] >> 2 & 7U);
  const auto crc = can::load_as<std::uint16_t>(&end.data[1]);
  return code == AbortCode::none && with_crc_ && crc != collector.crc() ? AbortCode::crc : code;
}

}  // namespace canopus::canopen
