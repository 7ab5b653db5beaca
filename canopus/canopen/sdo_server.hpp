#pragma once
// SDO server [CiA 301 7.2.4]: answers a client's requests to read and write the dictionary, one transfer at a
// time. Requests come on one COB-ID (600H + node-ID), answers go on another (580H + node-ID); always 8 bytes,
// frames of another length are ignored.
//
//   download  2xH index sub data|size -> 60H;  segments 00H/10H.. 7 bytes -> 20H/30H, the last one with bit 0
//   upload    40H index sub -> 4xH data|size;  60H/70H -> segments 00H/10H.., the last one with bit 0
//   abort     80H index sub code, from either side, never answered
//
// A value of up to 4 bytes goes in the initiate frame (expedited), a longer one in segments whose toggle bit
// alternates from 0. A download in segments is collected and written when it is complete, so an aborted one
// changes nothing. What does not fit the state is aborted with 05040001H and ends the transfer; a client that
// is silent for the time-out ends it with 05040000H.

#include <cstdint>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/object_dictionary.hpp"

namespace canopus::canopen {

class SdoServer {
 public:
  SdoServer(ObjectDictionary& dictionary, can::Sink& sink) : dictionary_(&dictionary), sink_(&sink) {}

  /// Where answers go: identifier, bit 29 = extended. Gives a running transfer up in silence.
  void set_response_identifier(std::uint32_t identifier_key) noexcept;
  /// A client's silence that ends a transfer; 0 = never.
  void set_time_out(can::Duration time_out) noexcept { time_out_ = time_out; }
  /// Longest value of variable length that a download may bring; more is aborted with 05040005H.
  void set_maximum_size(std::size_t bytes) noexcept { maximum_size_ = bytes; }

  /// A frame with the request identifier came.
  void receive(const can::Frame& frame, can::Time now);
  void tick(can::Time now);
  /// Moment to look whether the client is silent; may be earlier than the time-out itself.
  [[nodiscard]] can::Time deadline() const noexcept { return deadline_; }
  [[nodiscard]] bool busy() const noexcept { return state_ != State::idle; }
  /// Forgets a running transfer in silence.
  void stop() noexcept;

 private:
  enum class State : std::uint8_t { idle, download_segment, upload_segment };

  void initiate_download(const can::Frame& frame, can::Time now);
  void download_segment(const can::Frame& frame, can::Time now);
  void initiate_upload(const can::Frame& frame, can::Time now);
  void upload_segment(const can::Frame& frame, can::Time now);
  void begin(State state, const can::Frame& frame, can::Time now);
  void abort(AbortCode code);
  void abort(std::uint16_t index, std::uint8_t sub, AbortCode code);
  [[nodiscard]] std::size_t maximum_size(const Entry& entry) const noexcept;

  ObjectDictionary* dictionary_;
  can::Sink* sink_;
  std::uint32_t response_ = 0;
  State state_ = State::idle;
  bool toggle_ = false;
  bool size_known_ = false;
  std::uint8_t sub_ = 0;
  std::uint16_t index_ = 0;
  std::size_t maximum_size_ = 1U << 20;
  std::size_t size_ = 0;      // announced, or of the value that is read
  std::size_t position_ = 0;  // sent of an upload
  std::vector<std::uint8_t> buffer_;
  can::Duration time_out_{};
  can::Time last_heard_{};
  can::Time deadline_ = can::never;
};

}  // namespace canopus::canopen
