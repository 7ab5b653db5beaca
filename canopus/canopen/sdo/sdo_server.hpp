#pragma once
// SDO server [CiA 301 7.2.4]: answers a client's requests to read and write the dictionary, one transfer at a
// time. Requests come on one COB-ID (600H + node-ID), answers go on another (580H + node-ID); always 8 bytes,
// frames of another length are ignored.
//
//   download  2xH index sub data|size -> 60H;  segments 00H/10H.. 7 bytes -> 20H/30H, the last one with bit 0
//   upload    40H index sub -> 4xH data|size;  60H/70H -> segments 00H/10H.., the last one with bit 0
//   block download  C0H.. -> A0H; segments 1..blksize -> A2H ackseq blksize; ...; C1H crc -> A1H
//   block upload    A0H.. -> C0H; A3H -> segments 1..blksize; A2H ackseq blksize -> ...; -> C1H crc; A1H
//   abort     80H index sub code, from either side, never answered
//
// A value of up to 4 bytes goes in the initiate frame (expedited), a longer one in segments whose toggle bit
// alternates from 0. A download is collected and written when it is complete, so an aborted one changes
// nothing (an object that streams is notified that it was incomplete). What does not fit the state is aborted
// with 05040001H and ends the transfer; a client that is silent for the time-out ends it with 05040000H.
//
// Lost segments of a block: see sdo_block.hpp.

#include <cstdint>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/canopen/sdo/sdo_block.hpp"
#include "canopus/canopen/sdo/sdo_transfer.hpp"
#include "canopus/canopen/service/frame_of.hpp"
#include "canopus/canopen/service/timer_queue.hpp"

namespace canopus::canopen {

class SdoServer {
 public:
  /// Makes itself a timer among `timers`.
  SdoServer(ObjectDictionary& dictionary, can::Sink& sink, TimerQueue& timers)
      : dictionary_(&dictionary), sink_(&sink), timer_(timers.add()), timers_(&timers) {}
  SdoServer(const SdoServer&) = delete;
  SdoServer& operator=(const SdoServer&) = delete;
  ~SdoServer() = default;

  /// Where answers go: identifier, bit 29 = extended. Gives a running transfer up in silence.
  void set_response_identifier(std::uint32_t identifier_key);
  /// A client's silence that ends a transfer; 0 = never.
  void set_time_out(can::Duration time_out) noexcept { time_out_ = time_out; }
  /// Longest value of variable length that a download may bring; more is aborted with 05040005H. Does not
  /// concern objects that stream.
  void set_maximum_size(std::size_t bytes) noexcept { maximum_size_ = bytes; }
  /// Segments asked for in each sub-block of a block download, 1..127.
  void set_block_size(std::uint8_t segments) noexcept { own_block_size_ = segments; }

  /// Whether requests of fewer than 8 bytes count, which CiA 301 does not allow: those that have the bytes that their command
  /// needs. At first they are ignored.
  void set_accepts_short_requests(bool accepts) noexcept { accepts_short_requests_ = accepts; }

  /// A frame with the request identifier came.
  void receive(const can::Frame& frame, can::Time now);
  /// Its timer has ended: looks whether the client is silent, which may be too early.
  void tick(can::Time now);
  [[nodiscard]] TimerQueue::Number timer() const noexcept { return timer_; }
  [[nodiscard]] bool busy() const noexcept { return state_ != State::idle; }
  /// Forgets a running transfer in silence.
  void stop();

 private:
  enum class State : std::uint8_t {
    idle,
    download_segment,
    upload_segment,
    block_download,      // segments come
    block_download_end,  // all are here, C1H is to come
    block_upload_start,  // A3H is to come
    block_upload,        // segments go out, A2H come
    block_upload_end,    // C1H is out, A1H is to come
  };

  [[gnu::noinline]] void receive_short(const can::Frame& frame, can::Time now);
  [[nodiscard]] std::size_t needed_bytes(const can::Frame& request) const noexcept;
  [[gnu::noinline]] void receive_other(const can::Frame& frame, can::Time now);
  void receive_in_block(const can::Frame& frame, can::Time now);
  void download_expedited(const can::Frame& frame, can::Time now);
  void short_written(std::uint32_t multiplexer, ObjectDictionary::Location place, can::Time now);
  void initiate_other_download(const can::Frame& frame, can::Time now);
  void expedited_download(const can::Frame& frame, const Entry& entry, can::Time now);
  void download_segment(const can::Frame& frame, can::Time now);
  [[gnu::noinline]] void receive_segment_checked(const can::Frame& frame, can::Time now);
  [[nodiscard]] AbortCode begin_download(const can::Frame& frame, State state, bool size_indicated,
                                         std::size_t slack, can::Time now);
  [[nodiscard]] AbortCode store_download(can::Time now);

  void initiate_upload(const can::Frame& frame, can::Time now);
  void upload_segment(const can::Frame& frame, can::Time now);
  void upload_last_segment();
  void initiate_other_upload(const can::Frame& frame, can::Time now);
  void answer_expedited(std::uint32_t multiplexer, ObjectDictionary::ShortValue value);
  [[nodiscard]] AbortCode begin_upload(const Entry& entry, can::Time now);
  void answer_upload(can::Time now);

  void initiate_block_download(const can::Frame& frame, can::Time now);
  void block_segment(const can::Frame& frame, can::Time now);
  void confirm_block();
  void end_block_download(const can::Frame& frame, can::Time now);
  void initiate_block_upload(const can::Frame& frame, can::Time now);
  void send_block(can::Time now);
  void block_confirmed(const can::Frame& frame, can::Time now);

  void enter(State state, std::uint32_t multiplexer, can::Time now);
  void close(bool complete);
  void abort(AbortCode code);
  void abort(std::uint32_t multiplexer, AbortCode code);
  void set_deadline(can::Time deadline) {
    if (deadline != timers_->deadline(timer_)) timers_->set(timer_, deadline);
  }
  [[nodiscard]] can::Duration pause() const noexcept;

  ObjectDictionary* dictionary_;
  can::Sink* sink_;
  FrameHead response_;
  std::uint32_t multiplexer_ = 0;  // index and sub-index of the transfer, as in its frames
  State state_ = State::idle;
  std::uint8_t toggle_ = 0;  // the toggle bit that is due
  std::uint8_t own_block_size_ = 127;
  bool accepts_short_requests_ = false;
  TimerQueue::Number timer_;
  can::Time last_heard_{};
  SegmentCollector collector_;
  BlockReceiver block_receiver_;
  BlockSender block_sender_;
  TimerQueue* timers_;
  std::size_t maximum_size_ = 1U << 20;
  std::optional<std::size_t> size_;  // of an upload
  Entry entry_;                      // of a stream
  ObjectStream* stream_ = nullptr;
  SegmentSource source_;
  can::Duration time_out_{};
};

}  // namespace canopus::canopen
