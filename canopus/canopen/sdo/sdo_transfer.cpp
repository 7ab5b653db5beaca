#include "canopus/canopen/sdo/sdo_transfer.hpp"

#include <algorithm>

#include "canopus/canopen/sdo/sdo_crc.hpp"

namespace canopus::canopen {

void SegmentSource::begin(std::span<const std::uint8_t> bytes) {
  window_ = bytes;
  stream_ = nullptr;
}

void SegmentSource::begin(ByteSource& stream) {
  buffer_.clear();
  window_ = {};
  stream_ = &stream;
  at_end_ = false;
}

std::span<const std::uint8_t> SegmentSource::own_copy(std::span<const std::uint8_t> value) {
  buffer_.assign(value.begin(), value.end());
  return buffer_;
}

AbortCode SegmentSource::refill(std::size_t bytes) {
  if (at_end_) return AbortCode::none;
  constexpr std::size_t piece = 1024;
  const std::size_t wanted = std::max(bytes + 1, piece);
  const std::size_t left = window_.size();
  // What is left moves to the front of the buffer; the stream fills the rest.
  std::copy(window_.begin(), window_.end(), buffer_.begin());
  buffer_.resize(wanted);
  const auto count = stream_->read(std::span(buffer_).subspan(left));
  if (!count) return count.error();
  const std::size_t got = std::min(*count, wanted - left);
  at_end_ = got < wanted - left;
  buffer_.resize(left + got);
  window_ = buffer_;
  return AbortCode::none;
}

void SegmentCollector::begin(ByteSink* stream, std::size_t maximum, AbortCode too_many,
                             std::optional<std::size_t> announced, std::size_t slack) {
  used_ = 0;
  stream_ = stream;
  handed_on_ = 0;
  announced_ = announced;
  slack_ = slack;
  limit_ = announced ? *announced : maximum;
  limit_code_ = announced ? AbortCode::length_too_high : too_many;
  crc_ = 0;
  counts_crc_ = false;
  const std::size_t room =
      stream != nullptr ? hand_on_at + kept : std::min(announced.value_or(0) + kept, largest_reservation);
  if (memory_.size() < room + 1) memory_.resize(room + 1);
  prefetch();
}

void SegmentCollector::grow() { memory_.resize(std::max<std::size_t>(2 * memory_.size(), 64)); }

void SegmentCollector::prefetch() noexcept {
  const auto before = [](std::size_t end, std::size_t bytes) { return end > bytes ? end - bytes : 0; };
  plain_until_ = std::min(before(memory_.size(), 7), before(limit_ + slack_, handed_on_ + 6));
  if (stream_ != nullptr) plain_until_ = std::min(plain_until_, before(hand_on_at, 7));
}

AbortCode SegmentCollector::add_with_care(const can::Frame& segment, std::size_t count) {
  if (handed_on_ + used_ + count > limit_ + slack_) return limit_code_;
  if (memory_.size() < used_ + 8) grow();
  put(segment, count);
  const AbortCode code = stream_ != nullptr && used_ >= hand_on_at ? hand_on(kept) : AbortCode::none;
  prefetch();
  return code;
}

AbortCode SegmentCollector::hand_on(std::size_t keep) {
  const std::size_t count = used_ - std::min(keep, used_);
  const auto bytes = std::span<const std::uint8_t>(memory_).first(count);
  if (counts_crc_) crc_ = sdo::crc16(crc_, bytes);
  if (stream_ == nullptr) return AbortCode::none;
  const AbortCode code = bytes.empty() ? AbortCode::none : stream_->write(bytes);
  used_ -= count;
  handed_on_ += count;
  std::memmove(memory_.data(), memory_.data() + count, used_);
  return code;
}

AbortCode SegmentCollector::finish(std::size_t unused) {
  if (unused > used_) return AbortCode::length_too_low;
  used_ -= unused;
  const std::size_t total = handed_on_ + used_;
  if (total > limit_) return limit_code_;
  if (announced_ && total < *announced_) return AbortCode::length_too_low;
  return hand_on(0);
}

}  // namespace canopus::canopen
