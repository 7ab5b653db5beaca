#pragma once
// SDO client: one transfer at a time with one server [CiA 301 7.2.4]. The request goes out on one COB-ID, the
// answers come on another; both belong to the channel. A time-out or a protocol error is answered with an
// abort frame.
//
// Block transfers (Mode::block) send up to 127 segments before a confirmation is awaited and repeat what was
// lost; a server that does not know them aborts with 05040001H.
//
// Memory: a download reads the caller's bytes (they must stay valid until the transfer ends) or a stream, an
// upload grows one buffer that is kept from transfer to transfer, so that after the first use of a size
// nothing is allocated, or goes into a stream.

#include <cstdint>
#include <optional>
#include <span>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/sdo/sdo_block.hpp"
#include "canopus/canopen/sdo/sdo_transfer.hpp"
#include "canopus/canopen/service/frame_of.hpp"

namespace canopus::canopen {

// SDO has no transaction numbers: the late answer to a transfer that has timed out passes for the answer to the next one of
// the same object. On an overloaded bus wait some seconds before the node is asked again.
class SdoClient;

/// Notified when a transfer ended, well or not; may start the next one on the same client from inside the call.
class SdoClientListener {
 public:
  virtual void sdo_finished(SdoClient& client, can::Time now) = 0;

 protected:
  ~SdoClientListener() = default;
};

class SdoClient {
 public:
  /// Local code, never on the bus: the value is longer than set_maximum_size() allows [ME3CAN1-Q 8.2.3].
  static constexpr auto buffer_too_small = static_cast<AbortCode>(0x60600000);
  static constexpr can::Duration default_time_out = std::chrono::milliseconds(500);
  /// Bytes. A server can send without end: what no object of a usual device needs is not kept.
  static constexpr std::size_t default_maximum_size = std::size_t{16} << 20;

  explicit SdoClient(can::Sink& sink) : sink_(&sink) { collector_.make_room(); }

  /// Uses the default channel of a server: requests on 600H + node-ID, answers on 580H + node-ID. Not while
  /// busy().
  void set_server(std::uint8_t node_id);
  /// Uses these COB-IDs (1280H-12FFH). Not while busy().
  void set_channel(std::uint32_t request, std::uint32_t response);
  [[nodiscard]] std::uint8_t server() const noexcept { return server_; }

  enum class Mode : std::uint8_t { segmented, block };

  /// Starts reading. False when busy() or the frame could not be queued. With `into`, the bytes go there as
  /// they come, and data() stays empty.
  bool upload(std::uint16_t index, std::uint8_t sub, SdoClientListener& listener, can::Time now,
              can::Duration time_out = default_time_out, Mode mode = Mode::segmented,
              ByteSink* into = nullptr);
  /// Starts writing; `data` must stay valid until the end. Up to 4 bytes go expedited, more segmented or in
  /// blocks. False as above.
  bool download(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> data,
                SdoClientListener& listener, can::Time now, can::Duration time_out = default_time_out,
                Mode mode = Mode::segmented);
  /// Starts writing what `source` gives, whose size is indicated to the server if it is known.
  bool download(std::uint16_t index, std::uint8_t sub, ByteSource& source, std::optional<std::uint32_t> size,
                SdoClientListener& listener, can::Time now, can::Duration time_out = default_time_out,
                Mode mode = Mode::segmented);
  /// Gives the running transfer up with an abort frame; its listener is not called.
  void cancel(AbortCode code);
  /// The same without a frame: the node has to keep silent (Stopped).
  void drop(AbortCode code) noexcept;

  [[nodiscard]] bool busy() const noexcept { return state_ != State::idle; }
  /// Limits what an upload may bring, in bytes, at first default_maximum_size. More is aborted with 05040005H,
  /// as soon as it is announced or comes, and reported as buffer_too_small.
  void set_maximum_size(std::size_t bytes) noexcept { maximum_size_ = bytes; }
  [[nodiscard]] std::size_t maximum_size() const noexcept { return maximum_size_; }

  /// Block uploads: a server may answer a value of up to this many bytes expedited or segmented instead; 0 =
  /// never, one that does so is aborted with 05040001H. 4 at first: what fits comes expedited.
  void set_switch_threshold(std::uint8_t bytes) noexcept { switch_threshold_ = bytes; }

  // The last transfer, from sdo_finished() on until the next one starts.
  [[nodiscard]] AbortCode abort_code() const noexcept { return abort_code_; }  ///< none = success
  /// The code is this client's own finding, a time-out for one, not the server's abort.
  [[nodiscard]] bool gave_up() const noexcept { return end_ != End::by_server; }
  /// The answer that ended the transfer because it has fewer than 8 bytes [CiA 301 7.2.4.3]; nullptr: another end. The code is
  /// 06070013H then, which the server gets, too, unless the answer was its abort.
  [[nodiscard]] const can::Frame* short_answer() const noexcept {
    return end_ == End::short_answer ? &short_answer_ : nullptr;
  }
  /// False: the value came expedited without its number of bytes, and data() has all four (uploaded_value.hpp).
  [[nodiscard]] bool is_size_indicated() const noexcept { return is_size_indicated_; }
  [[nodiscard]] std::span<const std::uint8_t> data() const noexcept {
    return collector_.bytes();
  }  ///< of an upload
  [[nodiscard]] std::uint16_t index() const noexcept { return static_cast<std::uint16_t>(multiplexer_ >> 8); }
  [[nodiscard]] std::uint8_t sub() const noexcept { return static_cast<std::uint8_t>(multiplexer_ >> 24); }

  /// Counts the time-out from `now` on: the request got out on the bus only now, or is still waiting for it.
  void count_from(can::Time now) noexcept {
    if (busy()) last_heard_ = now;  // tick() looks at it when the present deadline comes
  }
  /// True when the frame was an answer on this channel (whether or not it was of use).
  bool receive(const can::Frame& frame, can::Time now) {
    if (head_without_dlc(frame) != response_) return false;
    if (frame.dlc >= 8) [[likely]] {
      process(frame, now);
    } else {
      receive_short(frame, now);
    }
    return true;
  }
  void tick(can::Time now);
  [[nodiscard]] can::Time deadline() const noexcept { return alarm_.deadline(); }
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

 private:
  enum class State : std::uint8_t {
    idle,
    initiate_upload,
    upload_segment,
    initiate_download,
    download_segment,
    initiate_block_upload,
    block_upload,      // segments come
    block_upload_end,  // all are here, C1H is to come
    initiate_block_download,
    block_download,      // segments go out, A2H come
    block_download_end,  // C1H is out, A1H is to come
  };

  enum class End : std::uint8_t { by_server, gave_up, short_answer };

  void process(const can::Frame& frame, can::Time now);
  void receive_short(const can::Frame& frame, can::Time now);
  bool start(State state, const can::Frame& request, SdoClientListener& listener, can::Time now,
             can::Duration time_out);
  bool start_download(State state, std::uint16_t index, std::uint8_t sub, std::optional<std::uint32_t> size,
                      SdoClientListener& listener, can::Time now, can::Duration time_out);
  bool start_long_download(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> data,
                           SdoClientListener& listener, can::Time now, can::Duration time_out, Mode mode);
  void unexpected(const can::Frame& frame, can::Time now);
  void aborted(const can::Frame& frame, can::Time now);
  void finish(AbortCode code, can::Time now);
  void give_up(AbortCode code, can::Time now);
  void refuse(AbortCode code, can::Time now);
  [[nodiscard]] bool is_about_this_object(const can::Frame& frame) const noexcept;
  void restart_time_out(can::Time now) noexcept {
    last_heard_ = now;
    alarm_ = can::later(now, time_out_);
  }

  void upload_initiated(const can::Frame& frame, can::Time now);
  void object_uploaded(const can::Frame& frame, can::Time now);
  void long_upload_initiated(const can::Frame& frame, can::Time now);
  void receive_expedited(const can::Frame& frame, can::Time now);
  void request_segment(can::Time now);
  void segment_uploaded(const can::Frame& frame, can::Time now);
  void receive_segment_checked(const can::Frame& frame, can::Time now);
  void download_initiated(const can::Frame& frame, can::Time now);
  void send_segment(can::Time now);
  void send_last_segment(can::Time now);
  void segment_downloaded(const can::Frame& frame, can::Time now);

  void receive_in_block(const can::Frame& frame, can::Time now);
  void block_upload_initiated(const can::Frame& frame, can::Time now);
  void block_segment(const can::Frame& frame, can::Time now);
  void confirm_block();
  void end_block_upload(const can::Frame& frame, can::Time now);
  void block_download_initiated(const can::Frame& frame, can::Time now);
  void send_block(can::Time now);
  void block_confirmed(const can::Frame& frame, can::Time now);

  static constexpr std::uint8_t own_block_size = 127;

  can::Sink* sink_;
  SdoClientListener* listener_ = nullptr;
  FrameHead request_;
  std::uint64_t response_ = 0;     // head_without_dlc() of the answers
  std::uint32_t multiplexer_ = 0;  // index and sub-index of the transfer, as in its frames
  std::uint8_t server_ = 0;
  std::uint8_t switch_threshold_ = 4;
  bool expedited_ = false;  // of a download
  bool is_size_indicated_ = true;
  // What a transfer begins with is one word, and one store.
  alignas(8) State state_ = State::idle;
  std::uint8_t toggle_ = 0;  // the toggle bit that is due
  bool all_sent_ = false;    // of a segmented download
  End end_ = End::by_server;
  AbortCode abort_code_ = AbortCode::none;
  std::size_t maximum_size_ = default_maximum_size;
  ByteSink* into_ = nullptr;
  SegmentSource source_;
  SegmentCollector collector_;
  BlockSender block_sender_;
  BlockReceiver block_receiver_;
  can::Duration time_out_ = default_time_out;
  can::Time last_heard_{};
  can::Alarm alarm_;
  can::Frame short_answer_{};
};

}  // namespace canopus::canopen
