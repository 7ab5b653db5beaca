#pragma once
// The two sides of an SDO block transfer [CiA 301 7.2.4.2.9, 7.2.4.2.13], the same in a client and in a
// server: who downloads from a server's point of view receives, who uploads sends.
//
//   sender    segments 1..blksize, bit 7 of the last one's number set; C1H n crc when all are confirmed
//   receiver  A2H ackseq blksize: all up to ackseq are here, the next sub-block has blksize segments
//
// The receiver takes segments in order only and confirms, at the last one of the sub-block, the last one it
// has; the sender goes on from there. When the segment that asks for the confirmation is lost, the receiver
// confirms after a pause. While nothing of a sub-block came, that pause may as well mean that the
// confirmation of the sub-block before was lost, and to confirm "0" would make the sender repeat what was
// taken. The CRC would show it; without one the receiver keeps silent and the transfer times out.

#include <cstdint>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/sdo_frame.hpp"
#include "canopus/canopen/sdo_transfer.hpp"

namespace canopus::canopen {

class BlockSender {
 public:
  /// After this long a segment is offered again to a transmit queue that was full.
  static constexpr can::Duration full_queue_retry = std::chrono::microseconds(500);

  /// The receiver wants sub-blocks of `block_size` segments (1..127, else 05040002H).
  AbortCode begin(std::uint8_t block_size, bool with_crc) noexcept;
  /// The transfer has ended.
  void stop() noexcept { phase_ = Phase::idle; }
  /// Segments are to go out: the transmit queue was full.
  [[nodiscard]] bool is_sending() const noexcept { return phase_ == Phase::sending; }

  /// Sends what the sub-block still lacks. On a bus that is a function call, confirmations and even the next
  /// transfer come from inside: a call from there returns at once, and the outer one goes on with it.
  AbortCode send(SegmentSource& source, can::Sink& sink, FrameHead head);
  /// A2H came. send() is to follow, or end() if the value is_complete().
  AbortCode confirmed(const can::Frame& answer, SegmentSource& source);
  [[nodiscard]] bool is_complete() const noexcept { return phase_ == Phase::complete; }
  /// C1H, with the bytes unused in the last segment and the CRC.
  [[nodiscard]] can::Frame end(FrameHead head) const noexcept;

 private:
  enum class Phase : std::uint8_t {
    idle,
    ready,     // begun: send() is to come
    sending,   // segments go out
    waiting,   // a sub-block is out, A2H is to come
    complete,  // all is confirmed
  };

  Phase phase_ = Phase::idle;
  bool is_inside_send_ = false;
  bool with_crc_ = false;
  std::uint8_t block_size_ = 0;
  std::uint8_t sequence_ = 0;       // of the last segment that was sent
  std::uint8_t last_sequence_ = 0;  // of the segment with the end of the value, 0: not in this sub-block
  std::uint8_t unused_ = 0;         // bytes in that segment
  std::uint16_t crc_ = 0;
};

class BlockReceiver {
 public:
  enum class Next : std::uint8_t { segment, confirmation };

  /// The first sub-block shall have `block_size` segments, 1..127.
  void begin(std::uint8_t block_size, bool with_crc) noexcept;
  /// A segment came: hands its bytes on if it is the one that is due. Says whether it is now time to confirm.
  AbortCode take(const can::Frame& segment, SegmentCollector& collector, Next& next) {
    const unsigned sequence = segment.data[0] & 0x7FU;
    const bool last = (segment.data[0] & sdo::last_segment) != 0;
    if (sequence == 0 || sequence > block_size_) return AbortCode::sequence_number;
    confirmed_early_ = false;
    if (sequence == sequence_ + 1U) {
      const AbortCode code = collector.add(segment, sdo::segment_size);
      if (code != AbortCode::none) return code;
      sequence_ = static_cast<std::uint8_t>(sequence);
      took_any_ = true;
      has_all_ = last;
    }
    next = last || sequence == block_size_ ? Next::confirmation : Next::segment;
    return AbortCode::none;
  }
  /// A2H with what came of this sub-block; the next one shall have `block_size` segments.
  [[nodiscard]] can::Frame confirmation(FrameHead head, std::uint8_t block_size) noexcept;
  /// The same after a pause, once per sub-block; not when it could do harm.
  [[nodiscard]] bool may_confirm_early() const noexcept {
    return !confirmed_early_ && (sequence_ != 0 || with_crc_ || !took_any_);
  }
  void note_early_confirmation() noexcept { confirmed_early_ = true; }
  /// The last segment is here: C1H is to come.
  [[nodiscard]] bool has_all() const noexcept { return has_all_; }
  /// C1H came: completes the value.
  AbortCode finish(const can::Frame& end, SegmentCollector& collector) const;

 private:
  bool with_crc_ = false;
  bool has_all_ = false;
  bool took_any_ = false;         // since the transfer began
  bool confirmed_early_ = false;  // and no segment since
  std::uint8_t block_size_ = 0;
  std::uint8_t sequence_ = 0;  // of the last segment that was taken
};

}  // namespace canopus::canopen
