#pragma once
// SDO client: one transfer at a time with one server [CiA 301 7.2.4]. The request goes out on one COB-ID, the
// answers come on another; both belong to the channel. A time-out or a protocol error is answered with an
// abort frame.
//
// Memory: a download reads the caller's bytes (they must stay valid until the transfer ends), an upload grows
// one buffer that is kept from transfer to transfer, so that after the first use of a size nothing is
// allocated.

#include <cstdint>
#include <span>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/abort_code.hpp"

namespace canopus::canopen {

class SdoClient;

/// Told when a transfer ended, well or not; may start the next one on the same client from inside the call.
class SdoClientUser {
 public:
  virtual void sdo_finished(SdoClient& client, can::Time now) = 0;

 protected:
  ~SdoClientUser() = default;
};

class SdoClient {
 public:
  /// Local code, never on the bus: the value is longer than set_maximum_size() allows [ME3CAN1-Q 8.2.3].
  static constexpr auto buffer_too_small = static_cast<AbortCode>(0x60600000);
  static constexpr can::Duration default_time_out = std::chrono::milliseconds(500);

  explicit SdoClient(can::Sink& sink) : sink_(&sink) {}

  /// Uses the default channel of a server: requests on 600H + node-ID, answers on 580H + node-ID. Not while
  /// busy().
  void set_server(std::uint8_t node_id);
  /// Uses these COB-IDs (1280H-12FFH). Not while busy().
  void set_channel(std::uint32_t request, std::uint32_t response);
  [[nodiscard]] std::uint8_t server() const noexcept { return server_; }

  /// Starts reading. False when busy() or the frame could not be queued.
  bool upload(std::uint16_t index, std::uint8_t sub, SdoClientUser& user, can::Time now,
              can::Duration time_out = default_time_out);
  /// Starts writing; `data` must stay valid until the end. Up to 4 bytes go expedited, more segmented. False
  /// as above.
  bool download(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> data,
                SdoClientUser& user, can::Time now, can::Duration time_out = default_time_out);
  /// Gives the running transfer up with an abort frame; its user is not called.
  void cancel(AbortCode code);

  [[nodiscard]] bool busy() const noexcept { return state_ != State::idle; }
  /// Limits what an upload may bring, in bytes; 0 = no limit. More is aborted with 05040005H, as soon as it
  /// is announced or comes, and reported as buffer_too_small.
  void set_maximum_size(std::size_t bytes) noexcept { maximum_size_ = bytes; }

  // The last transfer, from sdo_finished() on until the next one starts.
  [[nodiscard]] AbortCode abort_code() const noexcept { return abort_code_; }              ///< none = success
  [[nodiscard]] std::span<const std::uint8_t> data() const noexcept { return received_; }  ///< of an upload
  [[nodiscard]] std::uint16_t index() const noexcept { return index_; }
  [[nodiscard]] std::uint8_t sub() const noexcept { return sub_; }

  /// True when the frame was an answer on this channel (whether or not it was of use).
  bool receive(const can::Frame& frame, can::Time now);
  void tick(can::Time now);
  [[nodiscard]] can::Time deadline() const noexcept { return deadline_; }

 private:
  enum class State : std::uint8_t {
    idle,
    initiate_upload,
    upload_segment,
    initiate_download,
    download_segment
  };

  static constexpr std::size_t largest_reservation = 1U << 16;  // what a size alone makes us allocate

  bool start(State state, const can::Frame& request, SdoClientUser& user, can::Time now,
             can::Duration time_out);
  void finish(AbortCode code, can::Time now);
  void give_up(AbortCode code, can::Time now);
  void too_long(can::Time now);
  [[nodiscard]] bool is_about_this_object(const can::Frame& frame) const noexcept;
  void upload_initiated(const can::Frame& frame, can::Time now);
  void request_segment(can::Time now);
  void segment_uploaded(const can::Frame& frame, can::Time now);
  void download_initiated(const can::Frame& frame, can::Time now);
  void send_segment(can::Time now);
  void segment_downloaded(const can::Frame& frame, can::Time now);

  can::Sink* sink_;
  SdoClientUser* user_ = nullptr;
  std::uint32_t request_cob_id_ = 0;
  std::uint32_t response_cob_id_ = 0;
  std::uint8_t server_ = 0;
  State state_ = State::idle;
  std::uint16_t index_ = 0;
  std::uint8_t sub_ = 0;
  bool toggle_ = false;
  bool size_known_ = false;  // of an upload
  AbortCode abort_code_ = AbortCode::none;
  std::size_t maximum_size_ = 0;
  std::size_t size_ = 0;  // as announced
  std::size_t sent_ = 0;
  std::span<const std::uint8_t> source_;
  std::vector<std::uint8_t> received_;
  can::Duration time_out_ = default_time_out;
  can::Time deadline_ = can::never;
};

}  // namespace canopus::canopen
