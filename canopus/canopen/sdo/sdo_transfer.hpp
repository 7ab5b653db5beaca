#pragma once
// The two ends of an SDO transfer's data, the same for server and client: SegmentSource gives the bytes to be
// sent, SegmentCollector takes the received ones; each from or to memory as a whole, or a stream through a
// window of at most about two sub-blocks.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "canopus/can/frame.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/dictionary/object_stream.hpp"

namespace canopus::canopen {

class SegmentSource {
 public:
  /// Sends these bytes, which must stay where they are.
  void begin(std::span<const std::uint8_t> bytes);
  /// Sends what the stream gives.
  void begin(ByteSource& stream);
  /// A buffer of this source's own for a value that may change meanwhile: begin(own_copy(value)).
  std::span<const std::uint8_t> own_copy(std::span<const std::uint8_t> value);

  /// Sees to it that more than `bytes` are at hand, if there are as many left.
  AbortCode prepare(std::size_t bytes) {
    return stream_ == nullptr || window_.size() > bytes ? AbortCode::none : refill(bytes);
  }
  /// What is at hand, from the first byte not yet done with.
  [[nodiscard]] std::span<const std::uint8_t> window() const noexcept { return window_; }
  /// True when window() is all that is left.
  [[nodiscard]] bool ends_in_window() const noexcept { return stream_ == nullptr || at_end_; }
  /// The first `bytes` have arrived and are not needed again.
  void advance(std::size_t bytes) noexcept { window_ = window_.subspan(bytes); }

 private:
  AbortCode refill(std::size_t bytes);

  std::span<const std::uint8_t> window_;
  ByteSource* stream_ = nullptr;
  bool at_end_ = false;
  std::vector<std::uint8_t> buffer_;
};

class SegmentCollector {
 public:
  /// Collects in memory (stream nullptr) or hands on. `maximum`: more bytes than that are `too_many`.
  /// `slack`: bytes beyond the announced size that may come and be trimmed (7 in block transfers).
  void begin(ByteSink* stream, std::size_t maximum, AbortCode too_many, std::optional<std::size_t> announced,
             std::size_t slack);
  /// Adds the first `count` (0..7) bytes after the command byte of a segment.
  AbortCode add(const can::Frame& segment, std::size_t count) {
    return add_plain(segment, count) ? AbortCode::none : add_with_care(segment, count);
  }
  /// The same, if there is nothing to see to; false: there is, and nothing was added.
  bool add_plain(const can::Frame& segment, std::size_t count) noexcept {
    if (used_ >= plain_until_) return false;
    put(segment, count);
    return true;
  }
  /// A whole value of 1..4 bytes that came at once, for memory, after make_room(): instead of all the rest.
  void append(std::uint32_t value, std::size_t count) {
    std::memcpy(memory_.data(), &value, 4);
    used_ = count;
  }
  /// The transfer is complete but for the last `unused` bytes, which are padding. Checks the size.
  AbortCode finish(std::size_t unused);
  /// CRC of all bytes, after finish().
  [[nodiscard]] std::uint16_t crc() const noexcept { return crc_; }
  void count_crc(bool on) noexcept { counts_crc_ = on; }
  /// What was collected in memory.
  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept { return {memory_.data(), used_}; }
  void clear() noexcept { used_ = 0; }
  /// For what append() brings.
  void make_room() {
    if (memory_.empty()) grow();
  }

 private:
  static constexpr std::size_t hand_on_at = 1024;
  static constexpr std::size_t kept = 7;                        // the last segment may still be trimmed
  static constexpr std::size_t largest_reservation = 1U << 16;  // what an announcement makes us allocate
  /// There is room for eight bytes.
  void put(const can::Frame& segment, std::size_t count) noexcept {
    const std::uint64_t bytes = std::bit_cast<std::uint64_t>(segment.data) >> 8;
    std::memcpy(&memory_[used_], &bytes, 8);  // always eight: one store; what is too many is overwritten
    used_ += count;
  }
  AbortCode add_with_care(const can::Frame& segment, std::size_t count);
  AbortCode hand_on(std::size_t keep);
  void grow();
  void prefetch() noexcept;

  std::vector<std::uint8_t> memory_;  // what is used of it is a value; grown, never shrunk
  std::size_t used_ = 0;
  std::size_t plain_until_ =
      0;  // while used_ is below, a segment has room, no limit is near, nothing goes on
  ByteSink* stream_ = nullptr;
  std::size_t handed_on_ = 0;  // bytes before those in memory_
  std::size_t limit_ = 0;
  std::size_t slack_ = 0;
  std::optional<std::size_t> announced_;
  AbortCode limit_code_ = AbortCode::none;
  std::uint16_t crc_ = 0;
  bool counts_crc_ = false;
};

}  // namespace canopus::canopen
