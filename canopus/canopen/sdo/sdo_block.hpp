#pragma once
// The two sides of an SDO block transfer [CiA 301 7.2.4.2.9, 7.2.4.2.13], the same in a client and in a
// server: who downloads from a server's point of view receives, who uploads sends.
//
//   sender    segments 1..blksize, bit 7 of the last one's number set; C1H n crc when all are confirmed
//   receiver  A2H ackseq blksize: all up to ackseq are here, the next sub-block has blksize segments
//
// The receiver takes segments in order only and confirms, at the last one of the sub-block, the last one it
// has; the sender goes on from there. So a segment that is lost in the midst of a sub-block is repeated.
//
// When the segment that asks for the confirmation is lost, or the confirmation, both sides wait. The standard
// knows only the time-out then. With a CRC, and only then, a receiver that has something of the sub-block
// confirms it early, after a pause: it guesses that the rest was lost and not merely late, and only a CRC
// shows a wrong guess. If the rest comes after all it is not answered: the sender repeats it. A receiver that
// has nothing of the sub-block keeps silent: to say the last confirmation again would help if that was lost,
// but ends the transfer with a sender that is merely slow.
//
// CAN may deliver a frame twice: the segment that asks for a confirmation is answered once, and a
// confirmation that comes again is passed over if its number is more than what was sent since. When the
// number fits, and when a segment comes twice in sub-blocks of one, it cannot be distinguished from a new one: the CRC
// judges, or the size.

#include <bit>
#include <cstdint>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/sdo/sdo_frame.hpp"
#include "canopus/canopen/sdo/sdo_transfer.hpp"

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
  /// While A1H is to come: this is the last confirmation once more, which changes nothing.
  [[nodiscard]] bool is_confirmed_again(const can::Frame& answer) const noexcept {
    return answer.data[1] == confirmed_;
  }
  /// A2H came. send() is to follow, or end() if the value is_complete(). The one before, once more, changes
  /// nothing.
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
  std::uint8_t confirmed_ = 0;      // by the confirmation before
  std::uint16_t crc_ = 0;
};

class BlockReceiver {
 public:
  enum class Next : std::uint8_t { segment, confirmation };

  /// The first sub-block shall have `block_size` segments, 1..127. `initiation` is the frame that opened the
  /// transfer: C0H.. would pass for a last segment if it came again.
  void begin(std::uint8_t block_size, bool with_crc, const can::Frame& initiation) noexcept;
  /// A segment came: hands its bytes on if it is the one that is due. Says whether it is now time to confirm.
  AbortCode receive(const can::Frame& segment, SegmentCollector& collector, Next& next) {
    const unsigned sequence = segment.data[0] & 0x7FU;
    const bool last = (segment.data[0] & sdo::last_segment) != 0;
    if (sequence == 0 || sequence > block_size_) return AbortCode::sequence_number;
    if (sequence == sequence_ + 1U) {
      const AbortCode code = collector.add(segment, sdo::segment_size);
      if (code != AbortCode::none) return code;
      sequence_ = static_cast<std::uint8_t>(sequence);
      has_all_ = last;
    }
    const bool asks = last || sequence == block_size_;
    next = asks && is_to_be_answered(segment) ? Next::confirmation : Next::segment;
    just_confirmed_ = false;
    return AbortCode::none;
  }
  /// A2H with what came of this sub-block; the next one shall have `block_size` segments.
  [[nodiscard]] can::Frame confirmation(FrameHead head, std::uint8_t block_size) noexcept;
  /// After a pause: something of the sub-block came, and a CRC shows when a confirmation did harm.
  [[nodiscard]] bool may_confirm_early() const noexcept { return with_crc_ && sequence_ != 0; }
  /// A2H after a pause.
  [[nodiscard]] can::Frame early_confirmation(FrameHead head) noexcept;
  /// The last segment is here: C1H is to come.
  [[nodiscard]] bool has_all() const noexcept { return has_all_; }
  /// While C1H is to come: this is the last segment once more, which changes nothing.
  [[nodiscard]] bool is_last_segment_again(const can::Frame& frame) const noexcept {
    const bool may_be_the_end = (frame.data[0] & 0xE3U) == 0xC1 && answered_ >> 24 == 0;
    return is_answered(frame) && !may_be_the_end;
  }
  /// C1H came: completes the value.
  AbortCode finish(const can::Frame& end, SegmentCollector& collector) const;

 private:
  [[nodiscard]] bool is_to_be_answered(const can::Frame& segment) noexcept;
  [[nodiscard]] bool is_answered(const can::Frame& segment) const noexcept {
    return std::bit_cast<std::uint64_t>(segment.data) == answered_;
  }

  bool with_crc_ = false;
  bool has_all_ = false;
  bool rest_may_come_ = false;   // of a sub-block that was confirmed early
  bool just_confirmed_ = false;  // no segment has come since
  std::uint8_t block_size_ = 0;
  std::uint8_t sequence_ = 0;   // of the last segment that was taken
  std::uint64_t answered_ = 0;  // the bytes of the frame that was answered last
};

}  // namespace canopus::canopen
